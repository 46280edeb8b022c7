//! The image viewer tev, which is sent the image as it gets better.
//!
//! tev (<https://github.com/Tom94/tev>) listens for packets: one that creates an image, and others that fill parts of
//! it.

use std::io;
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread;
use std::time::Duration;

use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

use super::{Board, Picture};

/// Time between two pictures.
const INTERVAL: Duration = Duration::from_secs(1);
/// How long tev may take to answer the call, and to take a packet.
const PATIENCE: Duration = Duration::from_secs(5);
/// About how many pixels a packet has.
const PIXELS_PER_PACKET: usize = 1 << 18;
/// What is said of a tev that does not read.
const SLOW: &str = "tev takes too long to read what it is sent";
/// Names of the channels, as they are in EXR images.
const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// An image in tev, from the first picture of a board to its last.
pub struct Preview {
    /// Ends the thread that sends, once the last picture is sent.
    end: Option<Sender<()>>,
    /// Why nothing is shown any more, if so; closed when the thread ends.
    failure: Receiver<String>,
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
        thread::Builder::new().spawn(move || {
            if let Err(error) = send_all(&address, &name, &board, &ended) {
                // Nobody listens once the render has ended.
                let _ = tell.send(error);
            }
        })?;
        Ok(Self { end: Some(end), failure })
    }

    /// Why nothing is shown any more, told once.
    pub fn failure(&self) -> Option<String> {
        self.failure.try_recv().ok()
    }

    /// Sends the last picture, but waits no longer for that than tev may take for a packet; why it was not sent, unless
    /// that was told before.
    pub fn finish(&mut self) -> Option<String> {
        self.end = None;
        match self.failure.recv_timeout(PATIENCE) {
            Ok(failure) => Some(failure),
            Err(RecvTimeoutError::Disconnected) => None,
            Err(RecvTimeoutError::Timeout) => Some(SLOW.into()),
        }
    }
}

/// Sends a picture now and then, and a last one when `ended` is closed.
fn send_all(address: &str, name: &str, board: &Board, ended: &Receiver<()>) -> Result<(), String> {
    let mut tev = TevClient::wrap(connect(address).map_err(|error| format!("nobody answers there: {error}"))?);
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
                update(&mut tev, name, &picture).map_err(lost)?;
                shown = own;
            }
        }
        if is_last {
            return Ok(());
        }
    }
}

/// A connection to one of the addresses that `address` stands for.
fn connect(address: &str) -> io::Result<TcpStream> {
    let mut last = io::Error::new(io::ErrorKind::NotFound, "the name is unknown");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, PATIENCE) {
            Ok(stream) => {
                stream.set_write_timeout(Some(PATIENCE))?;
                stream.set_nodelay(true)?;
                return Ok(stream);
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

fn create(tev: &mut TevClient, name: &str, [width, height]: [u32; 2]) -> io::Result<()> {
    let channel_names = &CHANNELS;
    tev.send(PacketCreateImage { image_name: name, grab_focus: true, width, height, channel_names })
}

/// Sends all of a picture, a few rows at a time.
fn update(tev: &mut TevClient, name: &str, picture: &Picture) -> io::Result<()> {
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
    }
    Ok(())
}
