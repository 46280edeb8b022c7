//! What a test says if it cannot run here.

use std::io::Write;

/// Says on standard error that a test did not run, or not all of it, and why: past what captures the output of tests
/// that pass.
pub fn not_run(reason: impl core::fmt::Display) {
    // Nobody may be there to read it.
    let _ = std::io::stderr().write_all(format!("not run: {reason}\n").as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Set for the copy of these tests whose output is looked at.
    const INNER: &str = "FOGBOW_TEST_NOT_RUN";

    #[test]
    fn what_was_not_run_is_told_although_the_test_passes() {
        if std::env::var_os(INNER).is_some() {
            eprintln!("captured");
            return not_run("there is no example");
        }
        let mut tests = std::process::Command::new(std::env::current_exe().expect("these tests"));
        let output = tests.arg("what_was_not_run_is_told").env(INNER, "1").output().expect("a run");
        let text = String::from_utf8(output.stderr).expect("UTF-8");
        assert!(output.status.success() && text.contains("not run: there is no example\n"), "{text}");
        assert!(!text.contains("captured"), "{text}");
    }
}
