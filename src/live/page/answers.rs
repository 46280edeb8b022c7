//! What the page answers to requests.

use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;

use http_body_util::Full;
use hyper::body::{Body as _, Bytes, Incoming};
use hyper::header::{CONNECTION, CONTENT_TYPE, HOST, HeaderValue};
use hyper::{Method, Request, Response, StatusCode};

use super::super::{Board, Picture};

/// All of the page: it asks nobody else for anything.
const HTML: &[u8] = include_bytes!("page.html");

/// What answers say besides their content. Nothing is kept, and the page can load nothing from elsewhere.
const HEADERS: [(&str, &str); 3] = [
    ("Cache-Control", "no-store"),
    ("X-Content-Type-Options", "nosniff"),
    (
        "Content-Security-Policy",
        "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; connect-src 'self'",
    ),
];

type Answer = Response<Full<Bytes>>;

/// The answer to one request to a page at `address`.
pub fn answer(request: &Request<Incoming>, address: SocketAddr, board: &Arc<Board>) -> Answer {
    if address.ip().to_canonical().is_loopback() && !is_called_by_address(request) {
        return text(StatusCode::FORBIDDEN, "this page is to be called by its address, or as localhost");
    }
    if !request.body().is_end_stream() {
        // Nobody reads what is to come.
        let mut answer = text(StatusCode::PAYLOAD_TOO_LARGE, "nothing can be sent to this page");
        answer.headers_mut().insert(CONNECTION, HeaderValue::from_static("close"));
        return answer;
    }
    let is_get = request.method() == Method::GET;
    if !is_get && request.method() != Method::HEAD {
        return text(StatusCode::METHOD_NOT_ALLOWED, "this page can only be looked at");
    }
    match request.uri().path() {
        "/" => content("text/html; charset=utf-8", Bytes::from_static(HTML)),
        "/status" => content("application/json", board.status().to_string()),
        "/picture" => match board.picture() {
            Some(picture) if is_get => content("application/octet-stream", sent(picture, board)),
            Some(picture) => content("application/octet-stream", Bytes::from_owner(picture.bytes())),
            None => text(StatusCode::SERVICE_UNAVAILABLE, "there is no sample yet"),
        },
        _ => text(StatusCode::NOT_FOUND, "there is no such page"),
    }
}

/// Whether the name that the browser knows the page by is an address, or that of this machine.
fn is_called_by_address(request: &Request<Incoming>) -> bool {
    let named = request.uri().authority().map(|authority| authority.as_str().as_bytes());
    let mut hosts = request.headers().get_all(HOST).iter().map(HeaderValue::as_bytes).chain(named);
    hosts.all(|host| str::from_utf8(host).is_ok_and(is_address))
}

/// Whether a host, perhaps with its port, is an address, or this machine.
fn is_address(host: &str) -> bool {
    let is_port = |port: &str| port.parse::<u16>().is_ok();
    let name = host.rsplit_once(':').filter(|(_, port)| is_port(port)).map_or(host, |(name, _)| name);
    name.eq_ignore_ascii_case("localhost") || name.trim_matches(['[', ']']).parse::<IpAddr>().is_ok()
}

/// The bytes of `picture`, of which `board` is told once they are sent, or will not be any more.
fn sent(picture: Arc<Picture>, board: &Arc<Board>) -> Bytes {
    Bytes::from_owner(Sent { bytes: picture.bytes(), picture, board: Arc::clone(board) })
}

struct Sent {
    bytes: Arc<[u8]>,
    picture: Arc<Picture>,
    board: Arc<Board>,
}

impl AsRef<[u8]> for Sent {
    fn as_ref(&self) -> &[u8] {
        &self.bytes
    }
}

impl Drop for Sent {
    fn drop(&mut self) {
        self.board.note_sent(&self.picture);
    }
}

fn content(kind: &'static str, bytes: impl Into<Bytes>) -> Answer {
    let mut answer = Response::new(Full::new(bytes.into()));
    let headers = HEADERS.into_iter().map(|(name, value)| (name.parse().expect("a name of ASCII"), value));
    for (name, value) in headers.chain([(CONTENT_TYPE, kind)]) {
        answer.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    answer
}

fn text(code: StatusCode, line: &str) -> Answer {
    let mut answer = content("text/plain; charset=utf-8", format!("{line}\n"));
    *answer.status_mut() = code;
    answer
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_and_this_machine_are_told_from_names() {
        for host in ["localhost", "LocalHost:80", "127.0.0.1", "127.0.0.1:8080", "[::1]", "[::1]:80"] {
            assert!(is_address(host), "{host}");
        }
        for host in ["", "elsewhere.example", "elsewhere.example:80", "localhost.example", "localhost:x", "1.2.3.4.5"] {
            assert!(!is_address(host), "{host}");
        }
    }
}
