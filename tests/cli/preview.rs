//! `--preview`: what a tev is sent, by one that only listens.

use std::io::Read;
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::mpsc;
use std::thread::{self, JoinHandle};

use super::support::{Folder, header, plane};

/// A packet, as tev reads it.
#[derive(Debug, PartialEq)]
enum Packet {
    Create {
        name: String,
        width: u32,
        height: u32,
        channels: Vec<String>,
    },
    Update {
        name: String,
        channels: Vec<String>,
        region: [u32; 4],
        offsets: Vec<i64>,
        strides: Vec<i64>,
        data: Vec<f32>,
    },
}

/// Takes the content of a packet apart.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (first, rest) = self.0.split_first_chunk().expect("the packet is long enough");
        self.0 = rest;
        *first
    }

    fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    fn text(&mut self) -> String {
        let end = self.0.iter().position(|byte| *byte == 0).expect("texts end with 0");
        let text = String::from_utf8(self.0[..end].to_vec()).expect("UTF-8");
        self.0 = &self.0[end + 1..];
        text
    }

    fn texts(&mut self, count: u32) -> Vec<String> {
        (0..count).map(|_| self.text()).collect()
    }

    fn i64s(&mut self, count: u32) -> Vec<i64> {
        (0..count).map(|_| i64::from_le_bytes(self.take())).collect()
    }

    fn packet(mut self) -> Packet {
        let kind = self.take::<1>()[0];
        let _grab_focus = self.take::<1>();
        let name = self.text();
        let packet = match kind {
            4 => {
                let [width, height, count] = [self.u32(), self.u32(), self.u32()];
                Packet::Create { name, width, height, channels: self.texts(count) }
            }
            6 => {
                let count = self.u32();
                let channels = self.texts(count);
                let region = [self.u32(), self.u32(), self.u32(), self.u32()];
                let (offsets, strides) = (self.i64s(count), self.i64s(count));
                let data = self.0.chunks(4).map(|x| f32::from_le_bytes(x.try_into().expect("whole numbers"))).collect();
                self.0 = &[];
                Packet::Update { name, channels, region, offsets, strides, data }
            }
            kind => panic!("packet of type {kind}"),
        };
        assert!(self.0.is_empty(), "{} bytes too many", self.0.len());
        packet
    }
}

/// The next packet; none once the connection is closed.
fn read(stream: &mut TcpStream) -> Option<Packet> {
    let mut length = [0; 4];
    stream.read_exact(&mut length).ok()?;
    let mut content = vec![0; u32::from_le_bytes(length) as usize - 4];
    stream.read_exact(&mut content).expect("a whole packet");
    Some(Reader(&content).packet())
}

/// Packets of tevclient 1.0.4, the Python client of tev's author: `create_image("small", 3, 2, ["R", "G", "B"])`, and
/// `update_image` of the same image at (1, 0) with two rows of two pixels.
const OF_TEVS_OWN_CLIENT: [&str; 2] = [
    "1e0000000401736d616c6c00030000000200000003000000520047004200",
    "860000000600736d616c6c000300000052004700420001000000000000000200000002000000\
     000000000000000001000000000000000200000000000000\
     030000000000000003000000000000000300000000000000\
     0000803f0000004000004040000080400000a0400000c040\
     0000003f0000803e0000003e00000000000080bf286b6e4e",
];

#[test]
fn packets_are_read_here_as_the_client_of_tev_writes_them() {
    let packets = OF_TEVS_OWN_CLIENT.map(|hex| {
        let byte = |pair: &[u8]| u8::from_str_radix(core::str::from_utf8(pair).expect("digits"), 16).expect("a byte");
        let bytes: Vec<_> = hex.as_bytes().chunks(2).map(byte).collect();
        let (length, content) = bytes.split_first_chunk().expect("a length");
        assert_eq!(u32::from_le_bytes(*length) as usize, bytes.len());
        Reader(content).packet()
    });
    let (name, channels) = (String::from("small"), ["R", "G", "B"].map(String::from).to_vec());
    let created = Packet::Create { name: name.clone(), width: 3, height: 2, channels: channels.clone() };
    let data = vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 0.5, 0.25, 0.125, 0.0, -1.0, 1e9];
    let (offsets, strides) = (vec![0, 1, 2], vec![3; 3]);
    let updated = Packet::Update { name, channels, region: [1, 0, 2, 2], offsets, strides, data };
    assert_eq!(packets, [created, updated]);
}

/// One that listens to a single render: its address, and what `listen` makes of the connection.
fn tev<T: Send + 'static>(listen: impl FnOnce(TcpStream) -> T + Send + 'static) -> (String, JoinHandle<T>) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address").to_string();
    (address, thread::spawn(move || listen(listener.accept().expect("a connection").0)))
}

fn all(mut stream: TcpStream) -> Vec<Packet> {
    core::iter::from_fn(|| read(&mut stream)).collect()
}

/// Name, width and height, and values of the image that the packets leave behind.
fn shown(packets: &[Packet]) -> (&str, [u32; 2], Vec<[f32; 3]>) {
    let [Packet::Create { name, width, height, channels }, updates @ ..] = packets else { panic!("{packets:?}") };
    assert_eq!(channels.join(""), "RGB");
    let mut image = vec![[0.0; 3]; (width * height) as usize];
    for packet in updates {
        let Packet::Update { name: updated, channels, region: [x, y, columns, rows], offsets, strides, data } = packet
        else {
            panic!("created twice: {packets:?}")
        };
        assert_eq!((updated, channels.len()), (name, 3));
        for pixel in 0..columns * rows {
            let place = ((y + pixel / columns) * width + x + pixel % columns) as usize;
            for channel in 0..3 {
                let at = offsets[channel] + i64::from(pixel) * strides[channel];
                image[place][channel] = data[at as usize];
            }
        }
    }
    (name, [*width, *height], image)
}

#[test]
fn tev_shows_the_image_when_the_render_is_done() {
    for flags in [&["--samples", "3"][..], &["--time", "2500ms"]] {
        let folder = Folder::with_edited_scene("absorption = 0.3", "absorption = [0.3, 0.2, 0.1]");
        let (address, tev) = tev(all);
        let base = ["render", "scene.toml", "-o", "a.exr", "--size", "20x12", "--crop", "3,2,19,11"];
        let run = folder.done(&[&base[..], &["--preview", &address], flags].concat());
        assert!(!run.stderr.contains("warning"), "{run}");
        let packets = tev.join().expect("packets");
        let (name, size, image) = shown(&packets);
        let expected = folder.image("a.exr");
        assert_eq!((name, size), (header(&expected, "scene"), [20, 12]), "a crop is where it is in the image");
        let crop = |channel: usize| {
            let rows = (2..11).flat_map(|y| (3..19).map(move |x| y * 20 + x));
            rows.map(|place| image[place][channel]).collect::<Vec<_>>()
        };
        for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
            assert_eq!(crop(channel), plane(&expected, name), "{name}");
        }
        assert!(image.iter().flatten().filter(|value| **value != 0.0).count() == 3 * 16 * 9);
        if flags[0] == "--time" {
            assert!(packets.len() > 2, "it is sent while it is rendered, too");
        }
    }
}

/// Runs a render beside the tev at `address`; one warning that begins like this, and all else as ever.
#[track_caller]
fn warned(address: &str, flags: &[&str], beginning: &str, end: &str) {
    let folder = Folder::with_scene();
    let run = folder.done(&[&["render", "scene.toml", "-o", "a.exr", "--preview", address], flags].concat());
    let warnings: Vec<_> = run.stderr.lines().filter(|line| line.starts_with("warning: ")).collect();
    let [warning] = warnings.as_slice() else { panic!("one warning\n{run}") };
    assert!(warning.starts_with(&format!("warning: --preview {address}: {beginning}")), "{run}");
    assert!(warning.ends_with(end), "{run}");
    assert!(plane(&folder.image("a.exr"), "R").iter().all(|value| *value > 0.0), "{run}");
}

#[test]
fn a_render_goes_on_without_a_tev() {
    let free = TcpListener::bind("127.0.0.1:0").expect("a port").local_addr().expect("an address").to_string();
    warned(&free, &["--samples", "4"], "nobody answers there: ", "");
    warned(&free, &["--time", "2500ms"], "nobody answers there: ", "; the render goes on without it");
}

#[test]
fn a_render_goes_on_when_tev_goes_away() {
    let (address, tev) = tev(|mut stream| {
        let first = read(&mut stream);
        stream.shutdown(Shutdown::Both).expect("a socket");
        first
    });
    let end = "; the render goes on without it";
    warned(&address, &["--time", "5s", "--size", "64x48"], "the connection was lost: ", end);
    assert!(matches!(tev.join().expect("a packet"), Some(Packet::Create { .. })));
}

#[test]
fn a_render_does_not_wait_for_a_tev_that_reads_nothing() {
    let (leave, left) = mpsc::channel::<()>();
    let (address, tev) = tev(move |stream| {
        assert!(left.recv().is_err(), "nothing is sent");
        drop(stream);
    });
    let folder = Folder::with_scene();
    let flags = ["-o", "png:/dev/null", "--size", "1024x1024", "--time", "2s", "--preview", &address];
    let run = folder.done(&[&["render", "scene.toml"], &flags[..]].concat());
    let warning = ": tev takes too long to read what it is sent; the last image is not shown there\n";
    assert!(run.stderr.contains(warning), "{run}");
    drop(leave);
    tev.join().expect("a tev");
}

#[test]
fn what_is_no_address_is_refused() {
    for wrong in ["", "14158", "localhost", "localhost:", ":14158", "localhost:0", "localhost:70000"] {
        let flag = format!("--preview={wrong}");
        let flags = ["render", "scene.toml", "-o", "a.exr", &flag];
        Folder::with_scene().refused(&flags, 2, &format!("--preview {wrong}: is not a host and a port"));
    }
}
