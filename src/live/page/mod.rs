//! The page that a browser shows of a running render.

mod answers;

use std::collections::VecDeque;
use std::convert::Infallible;
use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::oneshot;
use tokio::task::JoinHandle;
use tokio::{runtime, time};
use tokio_io_timeout::TimeoutStream;

use super::Board;

/// Connections at the same time: one more ends the oldest. Browsers open six.
const MOST_CONNECTIONS: usize = 16;
/// How long a request may take to arrive, and an answer to be read on.
const PATIENCE: Duration = Duration::from_secs(10);
/// Bytes of the longest request that is read; those with a body are refused unread.
const LONGEST_REQUEST: usize = 1 << 14;
/// Time between two tries to take a connection, where the system has no more files for one.
const PAUSE: Duration = Duration::from_millis(200);

/// A web server that shows a render, until it is dropped.
///
/// | path | |
/// |---|---|
/// | `/` | the page |
/// | `/status` | JSON: scene, `frame` of an animation, `phase` (preparing, rendering, writing; in the end finished, stopped or failed), `step` of the preparation, progress, what `ended_by` once it has all its samples, and statistics per stage and technique, of the `share_counted` of the samples |
/// | `/picture` | the image so far, little-endian: u32 first column, first row, width, height; f64 samples of all pixels together, exposure in stops; then for every pixel, row by row from the top, f32 red, green, blue `[W/(m^2 sr)]`, NaN where there is no sample yet, and standard error over mean, NaN where that is unknown. 503 before the first sample |
///
/// On the loopback interface it answers only those who call it by an address or `localhost`: a page from elsewhere whose
/// name has been made to lead here learns nothing.
///
/// One thread serves everybody. What a request can have it do is bounded, in time, memory and open files, whoever sends
/// it.
pub struct Page {
    address: SocketAddr,
    /// Ends the thread when it is dropped.
    end: Option<oneshot::Sender<()>>,
    thread: Option<thread::JoinHandle<()>>,
}

impl Page {
    /// Listens at `address`; port 0 is any that is free.
    ///
    /// # Errors
    /// If somebody else does, it is no address of this machine, or may not be listened at.
    pub fn open(address: SocketAddr, board: &Arc<Board>) -> io::Result<Self> {
        let listener = std::net::TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let runtime = runtime::Builder::new_current_thread().enable_all().build()?;
        let guard = runtime.enter();
        runtime.spawn(listen(TcpListener::from_std(listener)?, address, Arc::clone(board)));
        drop(guard);
        let (end, ended) = oneshot::channel();
        let serve = move || drop(runtime.block_on(ended));
        let thread = Some(thread::Builder::new().name("page".into()).spawn(serve)?);
        Ok(Self { address, end: Some(end), thread })
    }

    /// Where it is.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        self.end = None;
        self.thread.take().map(thread::JoinHandle::join);
    }
}

/// Takes connections for ever.
async fn listen(listener: TcpListener, address: SocketAddr, board: Arc<Board>) {
    let mut visits: VecDeque<JoinHandle<()>> = VecDeque::new();
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            time::sleep(PAUSE).await;
            continue;
        };
        visits.retain(|visit| !visit.is_finished());
        if visits.len() >= MOST_CONNECTIONS {
            visits.pop_front().iter().for_each(JoinHandle::abort);
        }
        visits.push_back(tokio::spawn(attend(stream, address, Arc::clone(&board))));
    }
}

/// Answers whatever is asked over one connection; whoever goes away meanwhile is not missed.
async fn attend(stream: TcpStream, address: SocketAddr, board: Arc<Board>) {
    let mut stream = TimeoutStream::new(stream);
    stream.set_write_timeout(Some(PATIENCE));
    let service = service_fn(|request| {
        let answer = answers::answer(&request, address, &board);
        async { Ok::<_, Infallible>(answer) }
    });
    let mut server = http1::Builder::new();
    server.timer(TokioTimer::new()).header_read_timeout(PATIENCE).max_buf_size(LONGEST_REQUEST);
    let _ = server.serve_connection(TokioIo::new(Box::pin(stream)), service).await;
}
