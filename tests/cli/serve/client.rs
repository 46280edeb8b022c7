//! Who looks at the page of a running render.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, ChildStderr, Command};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use super::super::support::{Folder, program};

/// Longer than any answer takes, even on a busy machine.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// A render and the address of its page.
pub struct Served {
    pub child: Child,
    pub stderr: BufReader<ChildStderr>,
    pub address: String,
}

/// An answer.
#[derive(Debug)]
pub struct Answer {
    pub code: u16,
    pub head: String,
    pub body: Vec<u8>,
}

impl Served {
    pub fn start(folder: &Folder, flags: &[&str]) -> Self {
        Self::start_to(folder, "a.exr", flags)
    }

    pub fn start_to(folder: &Folder, output: &str, flags: &[&str]) -> Self {
        let (served, message) = Self::start_at(folder, "0", &[&["-o", output], flags].concat());
        assert!(served.address.starts_with("127.0.0.1:"), "{message}");
        assert_eq!(message["listens_at"], served.address);
        served
    }

    /// One that listens at `place`, and what it says of that.
    pub fn start_at(folder: &Folder, place: &str, flags: &[&str]) -> (Self, Value) {
        let base = ["render", "scene.toml", "--serve", place, "--progress", "json", "--threads", "1"];
        let mut child = program(folder).args(base).args(flags).spawn().expect("the program starts");
        let mut stderr = BufReader::new(child.stderr.take().expect("a pipe"));
        let mut line = String::new();
        stderr.read_line(&mut line).expect("a line");
        let message: Value = serde_json::from_str(&line).unwrap_or_else(|error| panic!("{error}: {line}"));
        assert_eq!(message["event"], "serving", "{line}");
        let url = message["url"].as_str().expect("an address");
        let address =
            url.strip_prefix("http://").and_then(|url| url.strip_suffix('/')).expect("an address").to_string();
        (Self { child, stderr, address }, message)
    }

    /// Says that the last picture has arrived; what ends then may not answer any more.
    pub fn confirm(&self) {
        if let Ok(mut stream) = TcpStream::connect(&self.address) {
            let _ = stream.write_all(b"GET /status HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
            let _ = stream.read_to_end(&mut Vec::new());
        }
    }

    pub fn ask(&self, method: &str, path: &str, host: &str) -> Answer {
        let mut stream = TcpStream::connect(&self.address).expect("a page");
        stream.set_read_timeout(Some(PATIENCE)).expect("a socket");
        let request = format!("{method} {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n");
        stream.write_all(request.as_bytes()).expect("a request");
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).expect("an answer");
        let end = bytes.windows(4).position(|window| window == b"\r\n\r\n").expect("a head");
        let head = String::from_utf8(bytes[..end].to_vec()).expect("a head");
        let code = head.split(' ').nth(1).and_then(|code| code.parse().ok()).expect("a code");
        Answer { code, head, body: bytes[end + 4..].to_vec() }
    }

    pub fn get(&self, path: &str) -> Answer {
        self.ask("GET", path, &self.address)
    }

    /// The picture, once there is one: a frame that has just begun has none.
    pub fn picture(&self) -> Answer {
        let start = Instant::now();
        loop {
            let answer = self.get("/picture");
            if answer.code != 503 {
                return answer;
            }
            assert!(start.elapsed() < PATIENCE, "{}", answer.head);
            sleep(Duration::from_millis(5));
        }
    }

    pub fn status(&self) -> Value {
        serde_json::from_slice(&self.get("/status").body).expect("JSON")
    }

    /// The first status that is as wanted.
    pub fn wait(&self, what: &str, is_so: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        loop {
            let status = self.status();
            if is_so(&status) {
                return status;
            }
            assert!(start.elapsed() < PATIENCE, "{what}: {status:#}");
            sleep(Duration::from_millis(5));
        }
    }

    /// Ends it as Ctrl-C does: exit code, and what else was told.
    pub fn interrupted(self) -> (Option<i32>, String) {
        let status = Command::new("kill").args(["-INT", &self.child.id().to_string()]).status().expect("kill");
        assert!(status.success());
        self.end()
    }

    /// Waits for the end: exit code, and what else was told.
    pub fn end(mut self) -> (Option<i32>, String) {
        let mut rest = String::new();
        self.stderr.read_to_string(&mut rest).expect("UTF-8");
        (self.child.wait().expect("a child").code(), rest)
    }
}

/// First column and row, width, height, samples, exposure, and the values of all pixels.
pub fn picture(bytes: &[u8]) -> ([u32; 4], f64, f64, Vec<[f32; 4]>) {
    let (head, rest) = bytes.split_at(32);
    let u32_at = |at: usize| u32::from_le_bytes(head[at..at + 4].try_into().expect("four bytes"));
    let f64_at = |at: usize| f64::from_le_bytes(head[at..at + 8].try_into().expect("eight bytes"));
    let value = |bytes: &[u8]| f32::from_le_bytes(bytes.try_into().expect("four bytes"));
    let pixel = |bytes: &[u8]| core::array::from_fn(|i| value(&bytes[4 * i..4 * i + 4]));
    ([0, 4, 8, 12].map(u32_at), f64_at(16), f64_at(24), rest.chunks(16).map(pixel).collect())
}
