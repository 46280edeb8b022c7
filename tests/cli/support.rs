//! A folder of its own for every test, and the program run there.

use std::fs;
use std::io::Read;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
#[cfg(unix)]
use std::sync::{Arc, Once, atomic::AtomicBool};
use std::thread;
use std::time::{Duration, Instant};

use fogbow::image::Image;

/// A small scene that renders in milliseconds, with little noise, and needs no more than its 24 segments.
pub const SCENE: &str = r#"
[camera]
position = [0, 0, 0]
look_at = [0, 0, 1]
vertical_fov_deg = 60

[film]
size = [8, 8]

[medium]
scattering = 0.7
absorption = 0.3
phase = { type = "henyey_greenstein", g = 0.5 }

[[light]]
type = "disk"
center = [0, 0, 3]
normal = [0, 0, -1]
radius = 1.5
radiance = 10

[render]
technique = "mvnee"
max_segments = 24
mesc = 4
samples = 4
"#;

/// Longer than any run here takes, even on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// The program, started in `folder`.
pub fn program(folder: &Folder) -> Command {
    #[cfg(unix)]
    heed_ctrl_c();
    let mut command = Command::new(env!("CARGO_BIN_EXE_fogbow"));
    command.current_dir(folder.dir.path()).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// From now on programs started by tests end on Ctrl-C, even if the tests themselves were told to ignore it, as shells
/// tell what they put in the background: what one process ignores, those that it starts ignore too, but not what it
/// handles.
#[cfg(unix)]
fn heed_ctrl_c() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let ends = Arc::new(AtomicBool::new(true));
        signal_hook::flag::register_conditional_default(signal_hook::consts::SIGINT, ends).expect("a handler");
    });
}

/// A temporary folder, the current one of the programs that a test runs.
pub struct Folder {
    dir: tempfile::TempDir,
}

impl Folder {
    /// An empty one.
    pub fn empty() -> Self {
        Self { dir: tempfile::tempdir().expect("a temporary folder") }
    }

    /// One with the small scene as `scene.toml`.
    pub fn with_scene() -> Self {
        let folder = Self::empty();
        folder.write("scene.toml", SCENE);
        folder
    }

    /// One with the small scene where `from` is replaced.
    pub fn with_edited_scene(from: &str, to: &str) -> Self {
        assert!(SCENE.contains(from), "{from:?} is not in the scene");
        let folder = Self::empty();
        folder.write("scene.toml", SCENE.replacen(from, to, 1));
        folder
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, content).expect("a file");
    }

    /// Names of all files and folders, hidden ones too.
    pub fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.dir.path()).expect("a folder");
        let mut names: Vec<_> =
            entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8")).collect();
        names.sort();
        names
    }

    /// `scene.toml:line:column` of the first `text` in the scene.
    pub fn place(&self, text: &str) -> String {
        let scene = fs::read_to_string(self.path("scene.toml")).expect("a scene");
        let (line, column) = scene
            .lines()
            .enumerate()
            .find_map(|(index, line)| Some((index + 1, line.find(text)? + 1)))
            .unwrap_or_else(|| panic!("{text:?} is not in the scene"));
        format!("scene.toml:{line}:{column}")
    }

    /// Runs the program with `args` to its end.
    #[track_caller]
    pub fn run(&self, args: &[&str]) -> Run {
        Run::of(program(self).args(args))
    }

    /// Runs it and expects success.
    #[track_caller]
    pub fn done(&self, args: &[&str]) -> Run {
        let run = self.run(args);
        assert_eq!(run.code, Some(0), "{run}");
        run
    }

    /// Runs it and expects one error with this exit code that begins like this, a remedy, and no trace on disk.
    #[track_caller]
    pub fn refused(&self, args: &[&str], code: i32, beginning: &str) -> Run {
        let before = self.names();
        let run = self.run(args);
        assert_eq!(run.code, Some(code), "{run}");
        assert!(run.stderr.starts_with(&format!("error: {beginning}")), "expected {beginning:?}\n{run}");
        let lines: Vec<_> = run.stderr.lines().collect();
        assert!(lines.len() == 2 && lines[1].starts_with("  help: "), "one finding and one remedy\n{run}");
        assert_eq!(run.stdout, "", "{run}");
        assert_eq!(self.names(), before, "{run}");
        run
    }

    /// The EXR image called `name`.
    #[track_caller]
    pub fn image(&self, name: &str) -> Image {
        fogbow::image::exr::read_image(&self.path(name)).unwrap_or_else(|error| panic!("{error}"))
    }

    /// What the PNG image called `name` says of itself, and its pixels.
    #[track_caller]
    pub fn png(&self, name: &str) -> (png::Info<'static>, Vec<u8>) {
        let file = fs::File::open(self.path(name)).expect("a file");
        let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("a PNG");
        let mut pixels = vec![0; reader.output_buffer_size().expect("a small image")];
        reader.next_frame(&mut pixels).expect("pixels");
        (reader.info().clone(), pixels)
    }
}

/// What became of a run of the program.
#[derive(Debug)]
pub struct Run {
    pub command: String,
    /// None if a signal ended it.
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Run {
    /// Runs `command`, whose outputs are pipes, to its end.
    #[track_caller]
    pub fn of(command: &mut Command) -> Self {
        Self::until_end(command.spawn().expect("the program starts"), format!("{command:?}"))
    }

    /// Waits for the end of `child`, whose outputs are pipes, as long as no run here takes.
    #[track_caller]
    pub fn until_end(mut child: Child, command: String) -> Self {
        let (stdout, stderr) = (drain(child.stdout.take()), drain(child.stderr.take()));
        let start = Instant::now();
        let status = loop {
            if let Some(status) = child.try_wait().expect("a child") {
                break status;
            }
            if start.elapsed() > PATIENCE {
                child.kill().expect("a child");
                panic!("{command} hangs");
            }
            thread::sleep(Duration::from_millis(1));
        };
        let text = |thread: thread::JoinHandle<String>| thread.join().expect("a reader");
        let run = Self { command, code: status.code(), stdout: text(stdout), stderr: text(stderr) };
        assert!(!run.stderr.contains("panicked"), "{run}");
        run
    }
}

impl std::fmt::Display for Run {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { command, code, stdout, stderr } = self;
        write!(f, "{command} -> {code:?}\n--- stdout\n{stdout}\n--- stderr\n{stderr}")
    }
}

fn drain(pipe: Option<impl Read + Send + 'static>) -> thread::JoinHandle<String> {
    thread::spawn(move || {
        let mut text = String::new();
        if let Some(mut pipe) = pipe {
            pipe.read_to_string(&mut text).expect("the program writes UTF-8");
        }
        text
    })
}

/// The plane of `image` called `channel`.
#[track_caller]
pub fn plane<'a>(image: &'a Image, channel: &str) -> &'a [f32] {
    image.channel(channel).unwrap_or_else(|| panic!("no channel {channel}"))
}

/// Expects the same channels with the same bits in two images.
#[track_caller]
pub fn assert_same_bits(folder: &Folder, a: &str, b: &str) {
    let bits = |values: &Vec<f32>| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    let channels = |name: &str| {
        let image = folder.image(name);
        image.channels.iter().map(|(name, values)| (name.clone(), bits(values))).collect::<Vec<_>>()
    };
    assert!(channels(a) == channels(b), "{a} and {b} differ");
}

/// The mean of the plane called `channel`.
#[track_caller]
pub fn mean(image: &Image, channel: &str) -> f64 {
    let plane = plane(image, channel);
    plane.iter().map(|value| f64::from(*value)).sum::<f64>() / plane.len() as f64
}

/// What the header says under `name`.
#[track_caller]
pub fn header<'a>(image: &'a Image, name: &str) -> &'a str {
    let name = format!("fogbow.{name}");
    image.header.iter().find(|(entry, _)| *entry == name).map_or_else(|| panic!("no {name}"), |(_, text)| text)
}
