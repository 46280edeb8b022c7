//! How busy the machine was: what of its processors this program had, and what everything else had.

use serde::{Deserialize, Serialize};

/// Share of the processors that everything else may have before a report says that the machine was busy.
const BUSY: f64 = 0.05;

/// Who had the processors, over some time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Load {
    /// Processors of the machine.
    pub processors: f64,
    /// How many of them this program and those that it runs had, in the mean.
    pub own: f64,
    /// How many everything else had, a host of this machine included.
    pub others: f64,
}

impl Load {
    /// Whether others had so much that times are not those of the machine.
    pub fn is_busy(&self) -> bool {
        self.others > BUSY * self.processors
    }
}

/// A moment from which on load is measured.
pub struct Watch(Option<Ticks>);

impl Watch {
    /// Begins now.
    pub fn begin() -> Self {
        Self(Ticks::now())
    }

    /// The load since then; `None` where the system does not tell, or so little time has passed that it cannot.
    pub fn load(&self) -> Option<Load> {
        Ticks::now()?.since(self.0?)
    }
}

/// Time in ticks of the system's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ticks {
    processors: f64,
    /// Of all processors, since the system began.
    all: f64,
    /// When they were not idle.
    busy: f64,
    /// When they worked for this program, or for programs that it ran and waited for.
    own: f64,
}

/// Ticks below which their number is too coarse.
const FEWEST: f64 = 50.0;

impl Ticks {
    fn now() -> Option<Self> {
        let read = |path| std::fs::read_to_string(path).ok();
        Self::of(&read("/proc/stat")?, &read("/proc/self/stat")?)
    }

    /// As Linux tells them: of the system, and of the process.
    fn of(system: &str, process: &str) -> Option<Self> {
        let numbers = |line: &str| line.split_whitespace().filter_map(|word| word.parse().ok()).collect::<Vec<f64>>();
        let processors = system.lines().filter(|line| line.starts_with("cpu")).count().checked_sub(1)?;
        // User, nice, system, idle, waiting, interrupts, soft interrupts, stolen by the host; what guests had is in
        // user.
        let times = numbers(system.lines().next()?.strip_prefix("cpu ")?);
        let all: f64 = times.get(..8)?.iter().sum();
        // The name, in parentheses, may have blanks. Of the process, and of those that it waited for: user and system.
        let own = numbers(process.rsplit_once(')')?.1).get(10..14)?.iter().sum();
        Some(Self { processors: processors as f64, all, busy: all - times[3] - times[4], own })
    }

    fn since(self, earlier: Self) -> Option<Load> {
        let elapsed = (self.all - earlier.all) / self.processors;
        if elapsed < FEWEST {
            return None;
        }
        let own = (self.own - earlier.own) / elapsed;
        let others = ((self.busy - earlier.busy) / elapsed - own).max(0.0);
        Some(Load { processors: self.processors, own, others })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ticks(user: u32, idle: u32, stolen: u32, own: u32) -> Ticks {
        let system = format!(
            "cpu  {user} 10 20 {idle} 5 0 7 {stolen} 0 0\ncpu0 1 2 3 4 5 6 7 8 9 0\ncpu1 1 2 3 4 5 6 7 8 9 0\nintr 3\n"
        );
        let process = format!("77 (a (b) c) S 1 1 1 0 -1 4194560 1 2 3 4 {own} 30 200 100 20 0 3 0 859923 3133440");
        Ticks::of(&system, &process).expect("ticks")
    }

    #[test]
    fn what_others_have_is_what_is_left_of_busy_processors() {
        let start = ticks(1000, 500, 0, 100);
        assert_eq!((start.processors, start.own, start.busy), (2.0, 430.0, 1037.0));
        // Ten seconds of two processors: this program had 1500 ticks of the 1700 that were busy.
        let load = ticks(2600, 800, 100, 1600).since(start).expect("a load");
        assert_eq!((load.processors, load.own), (2.0, 1.5));
        assert!((load.others - 0.2).abs() < 1e-9, "{load:?}");
        assert!(load.is_busy() && !Load { others: 0.09, ..load }.is_busy());
        assert_eq!(ticks(1010, 520, 0, 100).since(start), None, "too short");
    }

    #[test]
    fn other_systems_do_not_tell() {
        assert_eq!(Ticks::of("", "77 (a) S"), None);
        assert_eq!(Ticks::of("cpu  1 2 3\ncpu0 1 2 3\n", "77 (a) S 1 1 1 0 -1 1 1 2 3 4 5 6 7 8"), None);
    }
}
