//! Who looks on while a render runs: a page (`--serve`), a tev (`--preview`). Neither can stop it.

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use super::RenderArgs;
use super::progress::Reporter;
use crate::error::{Error, Result};
use crate::live::{Board, Page, Phase, Preview, Turn};
use crate::session::{End, Session, State};

/// How long a browser may take to fetch the last picture.
const PATIENCE: Duration = Duration::from_secs(4);

/// What comes of a tev that shows nothing while the render runs.
const GOES_ON: &str = "the render goes on without it";

/// What they see, and how; of all of it nothing if nobody is to look on.
pub struct Onlookers {
    board: Option<Arc<Board>>,
    /// Up as long as this is.
    page: Option<Page>,
    /// The address of a tev, and what it is sent, once there is something.
    tev: Option<(String, Option<Preview>)>,
}

impl Onlookers {
    /// Opens the page, and says where it is.
    ///
    /// # Errors
    /// If its address is taken.
    pub fn invite(args: &RenderArgs, reporter: &Reporter) -> Result<Self> {
        let tev = args.preview.clone().map(|address| (address, None));
        let board = (args.serve.is_some() || tev.is_some()).then(|| Arc::new(Board::default()));
        let page = args.serve.zip(board.as_ref()).map(|(address, board)| open(address, board)).transpose()?;
        page.iter().for_each(|page| reporter.serving(page.address()));
        Ok(Self { board, page, tev })
    }

    /// From now on it is about a render called `name`.
    pub fn begin(&self, name: &str, turn: Option<Turn>) {
        self.board.iter().for_each(|board| board.begin(name, turn));
    }

    /// Shows the images of `session`.
    pub fn show(&mut self, session: &Arc<Session>, reporter: &Reporter) {
        let Some(board) = &self.board else { return };
        board.show(session);
        let Some((address, preview @ None)) = &mut self.tev else { return };
        match Preview::start(address, session.scene.name.clone(), board) {
            Ok(started) => *preview = Some(started),
            Err(error) => self.warn(&format!("a thread cannot be started: {error}"), GOES_ON, reporter),
        }
    }

    /// Notes how far the render is.
    pub fn look(&self, state: State, reporter: &Reporter) {
        let Some(board) = &self.board else { return };
        board.note(state);
        let failure = self.tev.iter().find_map(|(_, preview)| preview.as_ref()?.failure());
        failure.iter().for_each(|failure| self.warn(failure, GOES_ON, reporter));
    }

    /// The render has all its samples, in this state, because of this `end`, and its results are written.
    pub fn write(&self, state: State, end: End) {
        let Some(board) = &self.board else { return };
        board.note(state);
        board.note_end(end);
        board.enter(Phase::Writing);
    }

    /// Tells them how all of it ended, and gives them the last picture.
    pub fn leave(mut self, end: Phase, reporter: &Reporter) {
        self.board.iter().for_each(|board| board.enter(end));
        let preview = self.tev.as_mut().and_then(|(_, preview)| preview.take());
        let failure = preview.and_then(|mut preview| preview.finish());
        failure.iter().for_each(|failure| self.warn(failure, "the last image is not shown there", reporter));
        let board = self.board.as_ref().filter(|_| self.page.is_some());
        board.iter().for_each(|board| board.farewell(PATIENCE));
    }

    /// Why tev does not show the image, or not any more, and what comes of that.
    fn warn(&self, failure: &str, consequence: &str, reporter: &Reporter) {
        let address = self.tev.as_ref().map_or("", |(address, _)| address);
        reporter.warn(format!("--preview {address}: {failure}; {consequence}"));
    }
}

fn open(address: SocketAddr, board: &Arc<Board>) -> Result<Page> {
    Page::open(address, board).map_err(|error| {
        let (reason, remedy) = obstacle(&error, address);
        Error::failure(format!("--serve {address}"), format!("the page cannot be served there: {reason}"), remedy)
    })
}

/// Why nobody can listen at `address`, and what to do.
fn obstacle(error: &io::Error, address: SocketAddr) -> (String, &'static str) {
    match error.kind() {
        io::ErrorKind::AddrInUse => {
            (format!("another program has port {}", address.port()), "give another port, or 0 for any that is free")
        }
        io::ErrorKind::AddrNotAvailable => (
            format!("{} is not an address of this machine", address.ip()),
            "give one of its addresses, 0.0.0.0 for all of them, or a port alone",
        ),
        io::ErrorKind::PermissionDenied => (
            format!("the system reserves port {}", address.port()),
            "give a port from 1024 on, or 0 for any that is free",
        ),
        _ => (error.to_string(), "give another address or port, or a port alone"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ports_that_only_the_system_may_have_are_named() {
        let error = io::Error::from(io::ErrorKind::PermissionDenied);
        let (reason, remedy) = obstacle(&error, SocketAddr::from(([127, 0, 0, 1], 80)));
        assert_eq!(reason, "the system reserves port 80");
        assert!(remedy.contains("1024"), "{remedy}");
    }
}
