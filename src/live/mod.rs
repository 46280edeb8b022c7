//! A running render for whoever looks on: a page in a browser, an image viewer.
//!
//! Onlookers ask a [`Board`] for what there is, and no worker waits for them: pictures are copied from the tiles that no
//! worker is at, and no more often than costs a fiftieth of a processor. No sample depends on who looks.

mod page;
mod picture;
mod preview;

use std::sync::atomic::Ordering;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, Weak};
use std::time::{Duration, Instant};

use serde_json::{Map, Value, json};

use crate::session::{End, Session, State, report};
pub use page::Page;
pub use picture::Picture;
pub use preview::Preview;

/// Least time between two pictures.
const PICTURE_EVERY: Duration = Duration::from_millis(400);
/// The same in units of what a picture takes.
const PICTURE_SHARE: u32 = 50;
/// Pictures in memory, those that are being sent included: somebody who takes long has others wait for the next one.
const MOST_PICTURES: usize = 4;
/// Somebody who asked no longer ago than this still looks on.
const ATTENTION: Duration = Duration::from_secs(3);

/// The place of a frame in a sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn {
    /// The frame's number.
    pub frame: u32,
    /// Its place among those that are rendered, from 1.
    pub place: u32,
    /// How many these are.
    pub count: u32,
}

impl Turn {
    /// Its figures for other programs, as JSON.
    pub fn figures(self) -> Value {
        json!({ "number": self.frame, "place": self.place, "of": self.count })
    }
}

/// `frame 3 of 10`
impl core::fmt::Display for Turn {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "frame {} of {}", self.place, self.count)
    }
}

/// What a render is at once it has all its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Its results are being written.
    Writing,
    /// They are there: nothing more will be done.
    Finished,
    /// Somebody ended it early.
    Stopped,
    /// Something that was asked for is not there.
    Failed,
}

impl Phase {
    /// What it is called.
    fn name(self) -> &'static str {
        match self {
            Self::Writing => "writing",
            Self::Finished => "finished",
            Self::Stopped => "stopped",
            Self::Failed => "failed",
        }
    }
}

/// What there is to see of a render.
#[derive(Default)]
pub struct Board {
    shown: Mutex<Shown>,
    gallery: Mutex<Gallery>,
    /// Told when the last picture has been seen.
    seen: Condvar,
}

/// How a render stands.
#[derive(Default)]
struct Shown {
    name: String,
    turn: Option<Turn>,
    session: Option<Arc<Session>>,
    state: State,
    /// What it is at, once it has all its samples.
    phase: Option<Phase>,
    /// What ended it.
    end: Option<End>,
    /// When somebody last asked.
    asked: Option<Instant>,
    /// Whether somebody was told of the end, was sent the last picture, and has asked again since.
    is_told: bool,
    is_sent: bool,
    is_seen: bool,
}

impl Shown {
    /// Whether nothing more will be done.
    fn is_over(&self) -> bool {
        self.phase.is_some_and(|phase| phase != Phase::Writing)
    }
}

/// The last picture.
#[derive(Default)]
struct Gallery {
    picture: Option<Arc<Picture>>,
    /// When the next one may be taken.
    next: Option<Instant>,
    /// Those that somebody has.
    taken: Vec<Weak<Picture>>,
}

impl Board {
    fn shown(&self) -> MutexGuard<'_, Shown> {
        self.shown.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn gallery(&self) -> MutexGuard<'_, Gallery> {
        self.gallery.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// From now on it is about a render called `name`, which is loaded and prepared first.
    pub fn begin(&self, name: &str, turn: Option<Turn>) {
        let asked = self.shown().asked;
        let state = State { preparing: true, ..State::default() };
        *self.shown() = Shown { name: name.into(), turn, state, asked, ..Shown::default() };
    }

    /// Shows the images of `session`.
    pub fn show(&self, session: &Arc<Session>) {
        let mut gallery = self.gallery();
        (gallery.picture, gallery.next) = (None, None);
        drop(gallery);
        session.monitor().is_watched.store(true, Ordering::Relaxed);
        let mut shown = self.shown();
        shown.session = Some(Arc::clone(session));
        (shown.state.preparing, shown.state.step) = (false, None);
    }

    /// Notes how far the render is.
    pub fn note(&self, state: State) {
        self.shown().state = state;
    }

    /// Notes what ended the render.
    pub fn note_end(&self, end: End) {
        self.shown().end = Some(end);
    }

    /// There will be no more samples, and this comes next.
    pub fn enter(&self, phase: Phase) {
        self.shown().phase = Some(phase);
    }

    /// If somebody looks on, waits until they have the last picture, but no longer than `patience`.
    pub fn farewell(&self, patience: Duration) {
        let shown = self.shown();
        if shown.session.is_some() && shown.asked.is_some_and(|asked| asked.elapsed() < ATTENTION) {
            let is_unseen = |shown: &mut Shown| !shown.is_seen;
            drop(self.seen.wait_timeout_while(shown, patience, is_unseen));
        }
    }

    /// How the render stands, as JSON; see [`Page`].
    fn status(&self) -> Value {
        let mut shown = self.shown();
        shown.asked = Some(Instant::now());
        if shown.is_told && shown.is_sent && !shown.is_seen {
            shown.is_seen = true;
            self.seen.notify_all();
        }
        shown.is_told = shown.is_over();
        let turn = shown.turn.map(Turn::figures);
        let mut status = Map::from_iter([("scene".to_string(), json!(shown.name)), ("frame".to_string(), json!(turn))]);
        status.extend(shown.state.figures());
        if let Some(phase) = shown.phase {
            status.insert("phase".into(), phase.name().into());
        }
        status.insert("ended_by".into(), json!(shown.end.map(|end| end.to_string())));
        let session = shown.session.clone();
        drop(shown);
        if let Some(session) = session {
            let work = session.monitor().work();
            let all = session.monitor().samples.load(Ordering::Relaxed);
            let share = work.as_ref().map(|work| work.samples as f64 / all.max(1) as f64);
            status.extend([
                ("technique".to_string(), json!(session.techniques())),
                ("pixels".to_string(), json!(session.film.region().pixels())),
                ("threads".to_string(), json!(session.threads())),
                ("share_counted".to_string(), json!(share.map(|share| share.min(1.0)))),
                ("stages".to_string(), json!(work.as_ref().map(report::stages))),
                ("connections".to_string(), json!(work.as_ref().map(report::connections))),
            ]);
        }
        Value::Object(status)
    }

    /// The picture so far, not necessarily of this moment; all of the image once there will be no more samples. None
    /// before the first sample.
    pub fn picture(&self) -> Option<Arc<Picture>> {
        let (session, is_complete) = {
            let shown = self.shown();
            (shown.session.clone()?, shown.phase.is_some())
        };
        let mut gallery = self.gallery();
        let is_early = gallery.next.is_some_and(|next| Instant::now() < next);
        gallery.taken.retain(|taken| taken.strong_count() > 0);
        let is_early = is_early || gallery.taken.len() >= MOST_PICTURES;
        let is_last = || gallery.picture.as_ref().is_some_and(|last| last.samples() == session.film.samples());
        if if is_complete { is_last() } else { is_early } {
            return gallery.picture.clone();
        }
        let start = Instant::now();
        let picture = Arc::new(Picture::after(gallery.picture.as_deref(), &session));
        gallery.taken.push(Arc::downgrade(&picture));
        gallery.next = Some(start + PICTURE_EVERY.max(PICTURE_SHARE * start.elapsed()));
        gallery.picture = Some(Arc::clone(&picture)).filter(|picture| picture.samples() > 0);
        gallery.picture.clone()
    }

    /// Width and height of the whole image, if there is one yet.
    fn size(&self) -> Option<[u32; 2]> {
        Some(self.shown().session.as_ref()?.scene.scene.film.size)
    }

    /// Notes that somebody was sent `picture`.
    fn note_sent(&self, picture: &Picture) {
        let mut shown = self.shown();
        let is_all = shown.session.as_ref().is_some_and(|session| session.film.samples() == picture.samples());
        shown.is_sent |= shown.phase.is_some() && is_all;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;
    use crate::session::{Settings, Target};

    const SCENE: &str = "[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, 1]\nvertical_fov_deg = 60\n\
                         [film]\nsize = [8, 8]\n[medium]\nscattering = 1\n\
                         [[light]]\ntype = \"disk\"\ncenter = [0, 0, 3]\nnormal = [0, 0, -1]\nradius = 1\nradiance = 1\n";

    /// A board, and a session that it shows, of which nothing is rendered yet.
    fn shown() -> (Board, Arc<Session>) {
        let scene = scene::parse("scene.toml", SCENE).expect("a scene");
        let session = Arc::new(Session::new(scene, Settings::default()).expect("a session"));
        let board = Board::default();
        board.begin("scene", None);
        board.show(&session);
        (board, session)
    }

    fn render(session: &Session, samples: u32) {
        session.run(Target::Samples(samples), || false, |_| {});
    }

    #[test]
    fn a_picture_is_taken_and_encoded_once_for_all_who_ask() {
        let (board, session) = shown();
        render(&session, 1);
        let first = board.picture().expect("a picture");
        board.gallery().next = Some(Instant::now() + Duration::from_secs(3600));
        render(&session, 2);
        let again = board.picture().expect("a picture");
        assert!(Arc::ptr_eq(&first, &again), "it is too early for the next one");
        assert!(Arc::ptr_eq(&first.bytes(), &again.bytes()));
        board.enter(Phase::Writing);
        let [last, again] = [(); 2].map(|()| board.picture().expect("a picture"));
        assert_eq!((first.samples(), last.samples()), (64, 128), "the last picture has all samples at once");
        assert!(Arc::ptr_eq(&last, &again) && Arc::ptr_eq(&last.bytes(), &again.bytes()));
        assert!(last.bytes() != first.bytes(), "bytes are those of the picture");
    }

    #[test]
    fn no_more_pictures_are_taken_than_there_is_room_for() {
        let (board, session) = shown();
        let take = |samples: u32| {
            board.gallery().next = None;
            render(&session, samples);
            board.picture().expect("a picture")
        };
        let mut taken: Vec<_> = (1..=6).map(take).collect();
        let samples: Vec<_> = taken.iter().map(|picture| picture.samples()).collect();
        assert_eq!(samples, [64, 128, 192, 256, 256, 256]);
        taken.remove(0);
        assert_eq!(take(7).samples(), 448, "one has been sent");
        board.enter(Phase::Writing);
        assert_eq!(take(8).samples(), 512, "the last one is taken in any case");
    }

    #[test]
    fn pixels_without_samples_are_told_from_black_ones() {
        let (board, session) = shown();
        let mut picture = Picture::after(None, &session);
        let red = |picture: &Picture| f32::from_le_bytes(picture.bytes()[32..36].try_into().expect("four bytes"));
        assert!(red(&picture).is_nan());
        assert!(picture.radiance().all(|rgb| rgb == [0.0; 3]) && picture.noise().all(f32::is_nan));
        render(&session, 1);
        picture = Picture::after(Some(&picture), &session);
        assert!(picture.radiance().all(|rgb| rgb[0] >= 0.0) && red(&picture) >= 0.0);
        assert_eq!(board.picture().expect("a picture").bytes(), picture.bytes());
    }

    #[test]
    fn before_the_first_sample_pictures_are_not_taken_all_the_time() {
        let (board, session) = shown();
        assert!(board.picture().is_none());
        board.gallery().next = Some(Instant::now() + Duration::from_secs(3600));
        render(&session, 1);
        assert!(board.picture().is_none(), "it is too early");
        board.enter(Phase::Writing);
        assert!(board.picture().is_some());
    }
}
