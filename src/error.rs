//! Errors for the person at the terminal.

use core::fmt;

/// What went wrong: where, what was found there, and what would be right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    /// The place: a file with line and column, or a flag.
    pub place: String,
    /// What was found there.
    pub finding: String,
    /// What would be right, or what to do.
    pub remedy: String,
    /// Whose fault it is.
    pub kind: Kind,
}

/// What sort of failure an error is; decides the exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The command line is wrong: exit code 2.
    Usage,
    /// Something else failed: exit code 1.
    Failure,
    /// The disk is full, which may pass: exit code 1.
    NoSpace,
    /// A signal ended a wait: the exit code is that of the signal, or else 1.
    Interrupted,
}

impl Error {
    /// A failure at `place`.
    pub fn failure(place: impl fmt::Display, finding: impl fmt::Display, remedy: impl fmt::Display) -> Self {
        let [place, finding, remedy] = [place.to_string(), finding.to_string(), remedy.to_string()];
        Self { place, finding, remedy, kind: Kind::Failure }
    }

    /// A wrong flag.
    pub fn usage(place: impl fmt::Display, finding: impl fmt::Display, remedy: impl fmt::Display) -> Self {
        Self { kind: Kind::Usage, ..Self::failure(place, finding, remedy) }
    }

    /// The exit code of the program.
    pub fn exit_code(&self) -> u8 {
        match self.kind {
            Kind::Usage => 2,
            Kind::Failure | Kind::NoSpace | Kind::Interrupted => 1,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "error: {}: {}\n  help: {}", self.place, self.finding, self.remedy)
    }
}

impl core::error::Error for Error {}

/// A result whose error is an [`Error`].
pub type Result<T> = core::result::Result<T, Error>;
