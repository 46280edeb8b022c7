//! The image viewer tev, which is sent the image as it gets better.
//!
//! tev (<https://github.com/Tom94/tev>) listens for packets: one that creates an image, and others that fill parts of
//! it.

use std::io;
use std::net::{SocketAddr, TcpStream, ToSocketAddrs};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread;
use std::time::{Duration, Instant};

use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

use super::{Board, Picture};

/// Time between two pictures.
const INTERVAL: Duration = Duration::from_secs(1);
/// How long tev may take to answer the call, and to take a packet.
const PATIENCE: Duration = Duration::from_secs(5);
/// The same of one packet at the end of the render, which waits for it, and of all packets then.
const LAST_PATIENCE: Duration = Duration::from_secs(1);
const LONGEST_END: Duration = Duration::from_secs(10);
/// About how many pixels a packet has.
const PIXELS_PER_PACKET: usize = 1 << 15;
/// What is said of a tev that does not read.
const SLOW: &str = "tev takes too long to read what it is sent";
/// What is said of one that has not answered by the end.
const SILENT: &str = "nobody has answered there so far";
/// Names of the channels, as they are in EXR images.
const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// An image in tev, from the first picture of a board to its last.
pub struct Preview {
    /// Ends the thread that sends, once the last picture is sent.
    end: Option<Sender<()>>,
    /// Why nothing is shown any more, if so; closed when the thread ends.
    failure: Receiver<String>,
    /// How many things tev has done: it has answered, and taken packets.
    steps: Arc<AtomicU64>,
}

impl Preview {
    /// Shows the pictures of `board` in the tev at `address` as an image of this name.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn start(address: &str, name: String, board: &Arc<Board>) -> io::Result<Self> {
        let (end, ended) = mpsc::channel();
        let (tell, failure) = mpsc::channel();
        let (address, board) = (address.to_string(), Arc::clone(board));
        let steps = Arc::<AtomicU64>::default();
        let told = Arc::clone(&steps);
        thread::Builder::new().spawn(move || {
            if let Err(error) = send_all(&address, &name, &board, &ended, &told) {
                // Nobody listens once the render has ended.
                let _ = tell.send(error);
            }
        })?;
        Ok(Self { end: Some(end), failure, steps })
    }

    /// Why nothing is shown any more, told once.
    pub fn failure(&self) -> Option<String> {
        self.failure.try_recv().ok()
    }

    /// Sends the last picture, and waits for that as long as tev reads on; why it was not sent, unless that was told
    /// before.
    pub fn finish(&mut self) -> Option<String> {
        self.end = None;
        let start = Instant::now();
        loop {
            let steps = self.steps.load(Ordering::Relaxed);
            match self.failure.recv_timeout(LAST_PATIENCE) {
                Ok(failure) => return Some(failure),
                Err(RecvTimeoutError::Disconnected) => return None,
                Err(RecvTimeoutError::Timeout) if steps == 0 => return Some(SILENT.into()),
                Err(RecvTimeoutError::Timeout) => {
                    let is_read = self.steps.load(Ordering::Relaxed) > steps && start.elapsed() < LONGEST_END;
                    if !is_read {
                        return Some(SLOW.into());
                    }
                }
            }
        }
    }
}

/// Sends a picture now and then, and a last one when `ended` is closed.
fn send_all(address: &str, name: &str, board: &Board, ended: &Receiver<()>, steps: &AtomicU64) -> Result<(), String> {
    let mut tev = TevClient::wrap(connect(address)?);
    steps.fetch_add(1, Ordering::Relaxed);
    let lost = |error: io::Error| match error.kind() {
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut => SLOW.to_string(),
        _ => format!("the connection was lost: {error}"),
    };
    // Those of the image that is there. Frames may have as many samples as each other.
    let (mut size, mut shown) = (None, None);
    loop {
        let is_last = ended.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Disconnected);
        if let Some(picture) = board.picture() {
            let own = board.size().unwrap_or([picture.region().x1, picture.region().y1]);
            if size != Some(own) {
                create(&mut tev, name, own).map_err(lost)?;
                size = Some(own);
            }
            let own = Some((picture.frame(), picture.samples()));
            if shown != own {
                update(&mut tev, name, &picture, steps).map_err(lost)?;
                shown = own;
            }
        }
        if is_last {
            return Ok(());
        }
    }
}

/// A connection to one of the addresses that `address` stands for, or why there is none.
fn connect(address: &str) -> Result<TcpStream, String> {
    let unknown = |error: io::Error| format!("the host cannot be found: {error}");
    let mut last = "the host has no address".to_string();
    for address in address.to_socket_addrs().map_err(unknown)? {
        match connect_to(&address) {
            Ok(stream) => return Ok(stream),
            Err(error) => last = format!("nobody answers there: {error}"),
        }
    }
    Err(last)
}

fn connect_to(address: &SocketAddr) -> io::Result<TcpStream> {
    let stream = TcpStream::connect_timeout(address, PATIENCE)?;
    stream.set_write_timeout(Some(PATIENCE))?;
    stream.set_nodelay(true)?;
    Ok(stream)
}

fn create(tev: &mut TevClient, name: &str, [width, height]: [u32; 2]) -> io::Result<()> {
    let channel_names = &CHANNELS;
    tev.send(PacketCreateImage { image_name: name, grab_focus: true, width, height, channel_names })
}

/// Sends all of a picture, a few rows at a time, and counts them.
fn update(tev: &mut TevClient, name: &str, picture: &Picture, steps: &AtomicU64) -> io::Result<()> {
    let (region, values) = (picture.region(), picture.radiance().collect::<Vec<_>>());
    let width = region.width() as usize;
    let rows = (PIXELS_PER_PACKET / width).max(1);
    for (index, data) in values.chunks(rows * width).enumerate() {
        tev.send(PacketUpdateImage {
            image_name: name,
            grab_focus: false,
            channel_names: &CHANNELS,
            channel_offsets: &[0, 1, 2],
            channel_strides: &[3, 3, 3],
            x: region.x0,
            y: region.y0 + (index * rows) as u32,
            width: region.width(),
            height: (data.len() / width) as u32,
            data: data.as_flattened(),
        })?;
        steps.fetch_add(1, Ordering::Relaxed);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_host_that_is_unknown_is_told_from_one_that_does_not_answer() {
        // No name is that long, so that nobody is asked.
        let unknown = connect(&format!("{}:14158", "x".repeat(64))).expect_err("no name");
        assert!(unknown.starts_with("the host cannot be found: "), "{unknown}");
        let silent = connect("127.0.0.1:1").expect_err("nobody there");
        assert!(silent.starts_with("nobody answers there: "), "{silent}");
    }
}
