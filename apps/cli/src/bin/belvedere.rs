//! The `belvedere` program.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(belvedere_cli::command_line(std::env::args_os().collect()))
}
