//! Renders of fogbow that go on in turns.

use std::cell::OnceCell;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use super::turns::{Log, Renders, TURN, go_on};
use super::{Tell, bench};
use crate::error::Result;
use crate::film::Film;
use crate::scene::LoadedScene;
use crate::session::checkpoint::Checkpoint;
use crate::session::{Limits, Outcome, Session, Settings, Target};
use crate::truncation::Truncation;

/// Something to render in turn with others.
pub struct Contender {
    /// What it is called.
    pub name: String,
    /// What is rendered.
    pub scene: LoadedScene,
}

/// What a limit on the length of paths leaves out of the light of renders that are compared, once the first of them has
/// looked: it is the same for all, however they render it.
pub type LeftOut = OnceCell<Option<Truncation>>;

/// A render of fogbow that goes on in turns.
pub struct Run {
    /// What it is called.
    pub name: String,
    session: Session,
    last: Option<Outcome>,
    log: Log,
    /// Seconds that went before the first sample, but for the look at what is left out.
    pub preparation: f64,
}

impl Renders for Run {
    fn take(&mut self, samples: u32, tell: &dyn Tell) -> core::result::Result<(f64, f64), String> {
        let (start, level) = (Instant::now(), self.session.level());
        let stop = &self.session.monitor().stop;
        let look = |_| stop.store(tell.stops(), Ordering::Relaxed);
        let outcome = self.session.run(Limits::from(Target::Samples(level + samples)), || tell.stops(), look);
        stop.store(false, Ordering::Relaxed);
        self.last = Some(outcome);
        Ok((f64::from(self.session.level() - level), start.elapsed().as_secs_f64()))
    }

    fn means(&mut self) -> core::result::Result<Vec<[f32; 3]>, String> {
        Ok(self.film().pixels().map(|pixel| pixel.mean.map(|channel| channel as f32)).collect())
    }

    fn log(&mut self) -> &mut Log {
        &mut self.log
    }
}

impl Run {
    /// Prepares a render.
    ///
    /// # Errors
    /// If there is not enough memory.
    pub fn begin(contender: Contender, left_out: &LeftOut, threads: usize, tell: &dyn Tell) -> Result<Self> {
        let (Contender { name, scene }, start) = (contender, Instant::now());
        let mut session = Session::new(scene, Settings { threads, ..Settings::default() })?;
        let stop = std::sync::Arc::clone(&session.monitor().stop);
        let look = |_| stop.store(tell.stops(), Ordering::Relaxed);
        let opened = start.elapsed();
        let left_out = *left_out.get_or_init(|| session.find_left_out(look));
        let start = Instant::now();
        session.prepare_knowing(left_out, look);
        let preparation = (opened + start.elapsed()).as_secs_f64();
        // It stops what prepares; turns ask for themselves.
        stop.store(false, Ordering::Relaxed);
        Ok(Self { name, session, last: None, log: Log::default(), preparation })
    }

    /// Goes on from the sums of `checkpoint`.
    ///
    /// # Errors
    /// If they are of another render.
    pub fn resume(&mut self, checkpoint: &mut Checkpoint) -> Result<()> {
        self.session.resume(checkpoint)
    }

    /// What it has of the image.
    pub fn film(&self) -> &Film {
        &self.session.film
    }

    /// The render.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Samples per pixel, those that it went on from included.
    pub fn samples(&self) -> f64 {
        f64::from(self.session.level())
    }

    /// Seconds of rendering so far, without those of the run that it went on from.
    pub fn seconds(&self) -> f64 {
        self.log.seconds
    }

    /// Goes on until it has had `seconds`, at least for one sample of every pixel.
    pub fn until(&mut self, seconds: f64, tell: &dyn Tell) {
        while !self.log.has_had(seconds) && !tell.stops() {
            let until = seconds.min(self.log.seconds + TURN);
            // Our own renders do not fail.
            let _ = go_on(self, until, tell);
        }
    }

    /// Writes its image.
    ///
    /// # Errors
    /// If that is impossible.
    pub fn write(&self, path: &Path) -> Result<()> {
        let Some(outcome) = &self.last else { return Ok(()) };
        // Other renders had their turns meanwhile.
        let own = Duration::try_from_secs_f64(self.preparation + self.log.seconds).unwrap_or_default();
        let outcome = Outcome { elapsed: own, ..outcome.clone() };
        self.session.write(&outcome, path, bench::FORMAT, || false)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::scene;

    pub(crate) struct Quiet;

    impl Tell for Quiet {
        fn line(&self, _: &str) {}
        fn stops(&self) -> bool {
            false
        }
    }

    fn contender(name: &str, technique: &str) -> Contender {
        let text = format!(
            "[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, 1]\nvertical_fov_deg = 50\n\
             [film]\nsize = [16, 16]\n[medium]\nscattering = 1.0\n[[light]]\ntype = \"disk\"\ncenter = [0, 0, -3]\n\
             normal = [0, 0, 1]\nradius = 1.0\nradiance = 5.0\n[render]\nmax_segments = 8\ntechnique = \"{technique}\""
        );
        let scene = scene::parse("test.toml", &text).unwrap_or_else(|error| panic!("{error}"));
        Contender { name: name.into(), scene }
    }

    pub(crate) fn runs() -> Vec<Run> {
        let both = [contender("a", "path"), contender("b", "nee")];
        both.into_iter().map(|one| Run::begin(one, &LeftOut::new(), 1, &Quiet).expect("a run")).collect()
    }

    #[test]
    fn images_carry_their_own_time() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut run = runs().remove(0);
        run.until(0.05, &Quiet);
        std::thread::sleep(Duration::from_millis(400));
        let path = folder.path().join("a.exr");
        run.write(&path).expect("an image");
        let header = crate::image::exr::read_image(&path).expect("an image").header;
        let name = format!("{}seconds", crate::image::exr::PREFIX);
        let seconds =
            header.iter().find(|(entry, _)| *entry == name).map(|(_, text)| text.parse::<f64>().expect("a number"));
        assert!((seconds.expect("seconds") - run.preparation - run.seconds()).abs() < 2e-3, "{seconds:?}");
    }
}
