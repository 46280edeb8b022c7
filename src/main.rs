//! The fogbow command.

fn main() -> std::process::ExitCode {
    match fogbow::cpu::check() {
        Ok(()) => fogbow::cli::run(std::env::args_os()),
        Err(error) => fogbow::cli::fail(&error),
    }
}
