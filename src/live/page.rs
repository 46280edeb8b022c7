//! The page that a browser shows of a running render.

use std::io::{self, Cursor};
use std::net::{IpAddr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::thread;

use tiny_http::{Header, Method, Request, Response, Server, StatusCode};

use super::{Board, Picture};

/// Threads that answer: a browser that does not read its answer keeps one of them waiting.
const THREADS: usize = 4;

/// All of the page: it asks nobody else for anything.
const HTML: &str = include_str!("page.html");

/// What answers say besides their content. Nothing is kept, and the page can load nothing from elsewhere.
const HEADERS: [(&str, &str); 3] = [
    ("Cache-Control", "no-store"),
    ("X-Content-Type-Options", "nosniff"),
    (
        "Content-Security-Policy",
        "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; connect-src 'self'",
    ),
];

/// A web server that shows a render, until it is dropped.
///
/// | path | |
/// |---|---|
/// | `/` | the page |
/// | `/status` | JSON: scene, `frame` of an animation, `phase` (preparing, rendering, writing; in the end finished, stopped or failed), progress, and statistics per stage and technique, of the `share_counted` of the samples |
/// | `/picture` | the image so far, little-endian: u32 first column, first row, width, height; f64 samples of all pixels together, exposure in stops; then for every pixel, row by row from the top, f32 red, green, blue `[W/(m^2 sr)]`, NaN where there is no sample yet, and standard error over mean, NaN where that is unknown. 503 before the first sample |
///
/// On the loopback interface it answers only those who call it by an address or `localhost`: a page from elsewhere whose
/// name has been made to lead here learns nothing.
pub struct Page {
    server: Arc<Server>,
    address: SocketAddr,
}

impl Page {
    /// Listens at `address`; port 0 is any that is free.
    ///
    /// # Errors
    /// If somebody else does, it is no address of this machine, or may not be listened at.
    pub fn open(address: SocketAddr, board: &Arc<Board>) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        let address = listener.local_addr()?;
        let server = Arc::new(Server::from_listener(listener, None).map_err(io::Error::other)?);
        let page = Self { server, address };
        for _ in 0..THREADS {
            let (server, board) = (Arc::clone(&page.server), Arc::clone(board));
            let serve = move || server.incoming_requests().for_each(|request| answer(request, address, &board));
            thread::Builder::new().spawn(serve)?;
        }
        Ok(page)
    }

    /// Where it is.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        (0..THREADS).for_each(|_| self.server.unblock());
    }
}

type Answer = Response<Cursor<Arc<[u8]>>>;

/// Answers one request; whoever goes away meanwhile is not missed.
fn answer(request: Request, address: SocketAddr, board: &Board) {
    let (answer, picture) = match (request.method(), request.url().split('?').next().unwrap_or("/")) {
        _ if address.ip().to_canonical().is_loopback() && !is_called_by_address(&request) => {
            (text(403, "this page is to be called by its address, or as localhost"), None)
        }
        (Method::Get | Method::Head, "/") => (content("text/html; charset=utf-8", HTML.as_bytes()), None),
        (Method::Get | Method::Head, "/status") => {
            (content("application/json", board.status().to_string().into_bytes()), None)
        }
        (Method::Get | Method::Head, "/picture") => picture(board),
        (Method::Get | Method::Head, _) => (text(404, "there is no such page"), None),
        _ => (text(405, "this page can only be looked at"), None),
    };
    if request.respond(answer).is_ok()
        && let Some(picture) = picture
    {
        board.note_sent(&picture);
    }
}

fn picture(board: &Board) -> (Answer, Option<Arc<Picture>>) {
    match board.picture() {
        Some(picture) => (content("application/octet-stream", picture.bytes()), Some(picture)),
        None => (text(503, "there is no sample yet"), None),
    }
}

/// Whether the name that the browser knows the page by is an address, or that of this machine.
fn is_called_by_address(request: &Request) -> bool {
    let host = request.headers().iter().find(|header| header.field.equiv("Host"));
    host.is_none_or(|host| {
        let host = host.value.as_str().to_ascii_lowercase();
        let host = host.as_str();
        let is_port = |port: &str| port.parse::<u16>().is_ok();
        let name = host.rsplit_once(':').filter(|(_, port)| is_port(port)).map_or(host, |(name, _)| name);
        name == "localhost" || name.trim_matches(['[', ']']).parse::<IpAddr>().is_ok()
    })
}

fn content(kind: &str, bytes: impl Into<Arc<[u8]>>) -> Answer {
    let bytes = bytes.into();
    let length = bytes.len();
    let answer = Response::new(StatusCode(200), Vec::new(), Cursor::new(bytes), Some(length), None);
    let headers = HEADERS.into_iter().chain([("Content-Type", kind)]);
    headers.fold(answer, |answer, (name, value)| {
        answer.with_header(Header::from_bytes(name, value).expect("names and values of ASCII"))
    })
}

fn text(code: u16, line: &str) -> Answer {
    content("text/plain; charset=utf-8", format!("{line}\n").into_bytes()).with_status_code(code)
}
