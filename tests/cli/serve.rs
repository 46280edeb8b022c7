//! `--serve`: the page of a running render, without a browser; tests/page looks at it with one.

mod client;

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::Instant;

use fogbow_testing::not_run::not_run;
use serde_json::Value;

use super::support::{Folder, assert_same_bits, header, plane};
use client::{PATIENCE, Served, picture};

#[test]
fn the_page_shows_a_render_from_its_first_samples_to_its_image() {
    let folder = Folder::with_scene();
    let flags = ["--size", "24x16", "--crop", "4,2,20,14", "--time", "1500ms", "--technique", "nee,mvnee"];
    let served = Served::start(&folder, &flags);
    let html = served.get("/");
    assert!(html.code == 200 && html.body.starts_with(b"<!DOCTYPE html>"), "{}", html.head);
    assert!(html.head.contains("default-src 'none'"), "{}", html.head);
    let text = String::from_utf8(html.body).expect("UTF-8");
    assert!(!text.contains("http://") && !text.contains("https://"), "the page asks nobody else for anything");

    let has_begun = |status: &Value| status["stages"].is_array() && status["fraction"].as_f64() > Some(0.0);
    let running = served.wait("statistics", has_begun);
    assert_eq!(running["phase"], "rendering", "{running:#}");
    let rows = |stage: &str| {
        let stages = running["stages"].as_array().expect("stages").iter();
        stages.filter(|work| work["stage"] == stage).map(|work| work["rows"].as_u64().expect("a number")).sum::<u64>()
    };
    let share = running["share_counted"].as_f64().expect("a number");
    assert!(share > 0.0 && share <= 1.0, "{share}");
    assert!(rows("generate") > 0 && rows("extend") >= rows("generate"), "{running:#}");
    for technique in ["nee", "mvnee"] {
        assert!(running["connections"][technique]["tried"].as_u64() > Some(0), "{running:#}");
    }
    assert_eq!((&running["pixels"], &running["until"]), (&(16 * 12).into(), &"time".into()));
    assert!(running["ended_by"].is_null(), "{running:#}");

    let end = served.wait("the end", |status| status["phase"] == "finished");
    assert_eq!((&end["phase"], &end["fraction"]), (&"finished".into(), &1.0.into()), "{end:#}");
    assert_eq!(end["ended_by"], "time", "{end:#}");
    let (region, samples, exposure, pixels) = picture(&served.get("/picture").body);
    served.confirm();
    let (code, _) = served.end();
    assert_eq!((code, region), (Some(0), [4, 2, 16, 12]));
    assert_eq!(Some(samples), end["samples"].as_f64());
    assert!((-20.0..20.0).contains(&exposure), "{exposure}");
    let image = folder.image("a.exr");
    assert_eq!(running["scene"], header(&image, "scene"));
    for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
        let shown: Vec<_> = pixels.iter().map(|pixel| pixel[channel]).collect();
        assert_eq!(shown, plane(&image, name), "{name} of the last picture is that of the image");
    }
    // All pixels see the light or much of the fog around it: none counts as darker than it is.
    for (pixel, (mean, error)) in pixels.iter().zip(plane(&image, "R").iter().zip(plane(&image, "SE.R"))) {
        assert!((pixel[3] / (error / mean) - 1.0).abs() < 1e-5, "{pixel:?}: {error} of {mean}");
    }
}

#[test]
fn whoever_looks_on_changes_no_bit() {
    let folder = Folder::with_scene();
    let flags = ["--samples", "300", "--size", "40x30"];
    let served = Served::start(&folder, &flags);
    served.wait("the end", |status| {
        served.get("/picture");
        status["phase"] == "finished"
    });
    served.confirm();
    assert_eq!(served.end().0, Some(0));
    folder.done(&[&["render", "scene.toml", "-o", "b.exr", "--progress", "none"], &flags[..]].concat());
    assert_same_bits(&folder, "a.exr", "b.exr");
}

#[test]
fn the_page_shows_the_frame_at_hand() {
    let folder = Folder::with_scene();
    let served = Served::start_to(&folder, "a.##.exr", &["--frames", "7-8", "--time", "3s"]);
    for (place, number) in [(1, 7), (2, 8)] {
        let status = served.wait("the frame", |status| status["frame"]["place"] == place && status["samples"] != 0);
        assert_eq!(status["frame"], serde_json::json!({ "number": number, "place": place, "of": 2 }));
        // On a busy machine, the next frame may have begun meanwhile.
        let picture = served.picture();
        assert!(picture.code == 200 && picture.body.len() == 32 + 16 * 64, "{}", picture.head);
    }
    let (code, rest) = served.end();
    assert_eq!(code, Some(0), "{rest}");
    assert!(folder.path("a.07.exr").is_file() && folder.path("a.08.exr").is_file());
}

#[test]
fn the_page_answers_only_what_it_is_asked_by_its_address() {
    let folder = Folder::with_scene();
    let served = Served::start(&folder, &["--time", "3s"]);
    let port = served.address.rsplit_once(':').expect("a port").1;
    let code = |method: &str, path: &str, host: &str| served.ask(method, path, host).code;
    for host in [&served.address, "localhost", "LocalHost", &format!("localhost:{port}"), "127.0.0.1", "[::1]"] {
        assert_eq!(code("GET", "/status", host), 200, "{host}");
    }
    for host in ["elsewhere.example", &format!("elsewhere.example:{port}"), "localhost.example"] {
        assert_eq!(code("GET", "/status", host), 403, "{host}");
        assert_eq!(code("GET", "/", host), 403, "{host}");
    }
    assert_eq!(code("GET", "/scene.toml", &served.address), 404);
    assert_eq!(code("GET", "/../scene.toml", &served.address), 404);
    assert_eq!(code("POST", "/status", &served.address), 405);
    assert_eq!(code("GET", "/status?x=1", &served.address), 200);
    assert_eq!(served.end().0, Some(0));
}

/// What it answers to these bytes, as far as anything comes.
fn answer_to(address: &str, bytes: &[u8]) -> String {
    let mut stream = TcpStream::connect(address).expect("a page");
    stream.set_read_timeout(Some(PATIENCE)).expect("a socket");
    let mut answer = Vec::new();
    // The page may close the connection before it has all of it.
    let _ = stream.write_all(bytes).and_then(|()| stream.read_to_end(&mut answer));
    String::from_utf8_lossy(&answer).lines().next().unwrap_or_default().to_string()
}

#[test]
fn no_request_harms_a_render() {
    let folder = Folder::with_scene();
    let served = Served::start(&folder, &["--time", "60s", "--checkpoint", "off"]);
    served.wait("samples", |status| status["samples"].as_u64() > Some(0));
    let with =
        |method: &str, header: &str| format!("{method} /status HTTP/1.1\r\nHost: localhost\r\n{header}\r\n\r\nxx");
    for (method, header, code) in [
        ("POST", "Content-Length: 99999999999", "413"),
        ("GET", "Content-Length: 9223372036854775807", "413"),
        ("GET", "Content-Length: 18446744073709551615", "4"),
        ("GET", "Content-Length: -5", "4"),
        ("POST", "Transfer-Encoding: chunked", "413"),
        ("GET", &format!("X: {}", "x".repeat(1 << 20)), "431"),
        ("GET", &"X: x\r\n".repeat(1000), "431"),
    ] {
        let line = answer_to(&served.address, with(method, header).as_bytes());
        // Where much is left unread, the connection may be reset before the answer is read.
        let is_long = header.len() > 1000 && line.is_empty();
        assert!(is_long || line.starts_with(&format!("HTTP/1.1 {code}")), "{method} {header:.40}: {line}");
        assert_eq!(served.get("/status").code, 200, "{method} {header:.40}");
    }
    for bytes in [&b"\x16\x03\x01\x02\0\x01\0\x01\xfc\x03\x03"[..], b"x", b"\r\n\r\n\r\n", &[0; 1 << 16]] {
        let mut stream = TcpStream::connect(&served.address).expect("a page");
        let _ = stream.write_all(bytes);
        assert_eq!(served.get("/status").code, 200, "{bytes:.8?}");
    }
    let (code, stderr) = served.interrupted();
    assert_eq!(code, Some(130), "{stderr}");
}

#[cfg(target_os = "linux")]
#[test]
fn whoever_keeps_connections_open_keeps_nobody_waiting() {
    let folder = Folder::with_scene();
    let served = Served::start(&folder, &["--time", "60s", "--size", "400x300", "--checkpoint", "off"]);
    served.wait("samples", |status| status["samples"].as_u64() > Some(0));
    let count =
        |what: &str| std::fs::read_dir(format!("/proc/{}/{what}", served.child.id())).expect("a process").count();
    let (threads, files) = (count("task"), count("fd"));
    let bodies = "GET /status HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100\r\n\r\n";
    let picture = "GET /picture HTTP/1.1\r\nHost: localhost\r\n\r\n";
    let mut open = Vec::new();
    for request in [bodies, picture, "", "GET "] {
        for _ in 0..100 {
            let mut stream = TcpStream::connect(&served.address).expect("a page");
            let _ = stream.write_all(request.as_bytes());
            open.push(stream);
        }
        let start = Instant::now();
        assert_eq!(served.get("/status").code, 200, "{request:?}");
        // Whoever came first would keep it waiting for ten seconds each.
        assert!(start.elapsed() < PATIENCE, "{request:?}: took {:?}", start.elapsed());
    }
    assert!(count("task") <= threads, "{} threads, {threads} before", count("task"));
    assert!(count("fd") <= files + 30, "{} files, {files} before", count("fd"));
    let (code, stderr) = served.interrupted();
    assert_eq!(code, Some(130), "{stderr}");
}

#[test]
fn an_address_that_is_taken_is_refused_before_anything_is_rendered() {
    let taken = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = taken.local_addr().expect("an address");
    let port = address.port().to_string();
    let flags = ["render", "scene.toml", "-o", "a.exr", "--serve", &port];
    let finding = format!("--serve {address}: the page cannot be served there: another program has port {port}\n");
    Folder::with_scene().refused(&flags, 1, &finding);
}

#[test]
fn an_address_of_another_machine_is_refused_before_anything_is_rendered() {
    // One of those that are for documentation.
    let flags = ["render", "scene.toml", "-o", "a.exr", "--serve", "192.0.2.1:8080"];
    let finding =
        "--serve 192.0.2.1:8080: the page cannot be served there: 192.0.2.1 is not an address of this machine\n";
    Folder::with_scene().refused(&flags, 1, finding);
}

#[test]
fn the_address_that_is_told_can_be_opened() {
    let has_ipv6 = TcpListener::bind("[::1]:0").is_ok();
    if !has_ipv6 {
        not_run("there is no IPv6; all of addresses but that was");
    }
    for (place, told, is_ipv6) in [
        ("127.0.0.1:0", "127.0.0.1:", false),
        ("0.0.0.0:0", "127.0.0.1:", false),
        ("[::1]:0", "[::1]:", true),
        ("[::]:0", "[::1]:", true),
    ] {
        if is_ipv6 && !has_ipv6 {
            continue;
        }
        let folder = Folder::with_scene();
        let (served, message) = Served::start_at(&folder, place, &["-o", "a.exr", "--time", "1s"]);
        let listens_at = message["listens_at"].as_str().expect("an address");
        let (host, port) = listens_at.rsplit_once(':').expect("a port");
        assert_eq!(format!("{host}:0"), place, "{message}");
        assert_eq!(served.address, format!("{told}{port}"), "{message}");
        assert_eq!(served.get("/status").code, 200, "{message}");
        served.wait("the end", |status| status["phase"] == "finished");
        served.get("/picture");
        served.confirm();
        assert_eq!(served.end().0, Some(0));
    }
    let run = Folder::with_scene().done(&["render", "scene.toml", "-o", "a.exr", "--serve", "0.0.0.0:0"]);
    let line = run.stderr.lines().next().expect("a line");
    let (url, others) = line.split_once(", ").expect("two ways");
    let port = url.strip_prefix("the render can be seen at http://127.0.0.1:").and_then(|url| url.strip_suffix('/'));
    let port: u16 = port.and_then(|port| port.parse().ok()).unwrap_or_else(|| panic!("{run}"));
    assert_eq!(others, format!("from elsewhere at port {port} of this machine"), "{run}");
}

#[cfg(unix)]
#[test]
fn the_page_says_finished_once_all_images_are_written() {
    let folder = Folder::with_scene();
    let made = std::process::Command::new("mkfifo").arg(folder.path("pipe")).status().expect("mkfifo");
    assert!(made.success());
    let flags = ["-o", "exr:pipe", "-o", "a##.png", "--frames", "7-8", "--samples", "2", "--exposure", "0"];
    let (served, _) = Served::start_at(&folder, "0", &flags);
    let read = || std::fs::read(folder.path("pipe")).expect("an image");
    for place in [1, 2] {
        let is_at = |status: &Value| status["frame"]["place"] == place && status["phase"] == "writing";
        let status = served.wait("the pipe that nobody reads", is_at);
        assert_eq!((&status["fraction"], &status["frame"]["of"]), (&1.0.into(), &2.into()), "{status:#}");
        assert_eq!(served.get("/picture").code, 200);
        assert!(!folder.path(&format!("a{}.png", 6 + place)).exists(), "images are written one after the other");
        assert!(read().starts_with(b"\x76\x2f\x31\x01"), "an EXR image");
        let status = served.wait("what comes next", |status| !is_at(status));
        assert_eq!(status["phase"] == "finished", place == 2, "{status:#}");
    }
    assert!(folder.path("a07.png").is_file() && folder.path("a08.png").is_file());
    served.confirm();
    assert_eq!(served.end().0, Some(0));
}

#[test]
fn the_page_says_that_a_result_is_missing() {
    let folder = Folder::with_scene();
    std::fs::create_dir(folder.path("sub")).expect("a folder");
    let (served, _) = Served::start_at(&folder, "0", &["-o", "sub/a.exr", "--time", "1500ms"]);
    served.wait("samples", |status| status["samples"].as_u64() > Some(0));
    std::fs::remove_dir_all(folder.path("sub")).expect("a folder");
    served.wait("the end", |status| status["phase"] == "failed");
    served.get("/picture");
    served.confirm();
    let (code, rest) = served.end();
    assert!(code == Some(1) && rest.contains("sub/a.exr"), "{rest}");
}

#[test]
fn what_is_no_port_is_refused() {
    for wrong in ["", "x", "65536", "-1", "1.2.3.4", "example.com:80", "localhost:x"] {
        let flag = format!("--serve={wrong}");
        let flags = ["render", "scene.toml", "-o", "a.exr", &flag];
        Folder::with_scene().refused(&flags, 2, &format!("--serve {wrong}: is not a port"));
    }
}
