//! The application: a program of its own, started here.

use crate::args::ViewArgs;
use crate::goal::Goal;
use crate::inputs;
use crate::interrupt;
use crate::report::Context;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{Command, exit};

/// Name of the program, without the ending of the system.
const PROGRAM: &str = "belvedere-view";

/// Starts the application and ends with its status.
pub(crate) fn view(args: &ViewArgs, context: &Context) -> anyhow::Result<Goal> {
    // Files that do not exist are reported on standard error rather than in a window.
    inputs::exist(&args.files)?;
    let mut command = Command::new(program());
    for root in &context.common.allow_root {
        command.arg("--allow-root").arg(root);
    }
    if context.common.no_remember {
        command.arg("--no-remember");
    }
    let status = interrupt::run(command.arg("--").args(&args.files)).map_err(|e| {
        anyhow::anyhow!(
            "the application, {PROGRAM}, cannot be started: {e}; it is found beside this program or on the PATH: \
             cargo install --path apps/viewer, or cargo build --release -p belvedere-viewer"
        )
    })?;
    if status.success() {
        return Ok(Goal::Reached);
    }
    // The application has printed its reason.
    let interrupted = context.progress.is_cancelled().then(|| i32::from(interrupt::code()));
    exit(interrupted.or(status.code()).unwrap_or(2))
}

/// The application beside this program, else the one on the PATH.
fn program() -> PathBuf {
    let name: OsString = format!("{PROGRAM}{}", std::env::consts::EXE_SUFFIX).into();
    let beside = std::env::current_exe().ok().map(|own| own.with_file_name(&name));
    beside.filter(|path| path.is_file()).unwrap_or_else(|| name.into())
}
