//! Ctrl-C, and the signal by which schedulers and containers end a program (SIGTERM): the work ends within a second, whatever it is at, and
//! the user is told what was written.
//!
//! Work that looks at the flag of cancellation ends by itself. Other work, as reading a large file, is given [`GRACE`], and then the process ends:
//! outputs are written beside their names and renamed, so that they are whole at any moment. A second signal ends the process at once.

use crate::report;
use belvedere::BelvedereError;
use belvedere::io::atomic;
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus};
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Exit code of an interrupted program: 128 and the number of the signal, as of shells. Of Ctrl-C 130, of SIGTERM 143.
static CODE: AtomicU8 = AtomicU8::new(130);
/// Time in which the work may end by itself.
const GRACE: Duration = Duration::from_millis(500);

/// Time between two looks at a program that runs.
const WATCH: Duration = Duration::from_millis(100);
/// The program that is ended with this one.
static CHILD: Mutex<Option<Child>> = Mutex::new(None);

/// Whether a thread ends the process.
static ENDING: AtomicBool = AtomicBool::new(false);
/// Whether a picture is written on standard output.
static ON_STDOUT: AtomicBool = AtomicBool::new(false);

/// Exit code of the program that was interrupted.
pub(crate) fn code() -> u8 {
    CODE.load(Ordering::SeqCst)
}

/// Sets what Ctrl-C and SIGTERM do.
pub(crate) fn install(flag: Arc<AtomicBool>, verb: &'static str) {
    let of_signal = Arc::clone(&flag);
    // Without a handler the signals still end the process, only less politely.
    let _ = ctrlc::set_handler(move || interrupted(&of_signal, verb));
    let _ = on_termination(move || interrupted(&flag, verb));
}

/// Calls `act` for each SIGTERM. The feature `termination` of `ctrlc` would take SIGHUP as well, which `nohup` ignores.
#[cfg(unix)]
fn on_termination(act: impl Fn() + Send + 'static) -> std::io::Result<()> {
    use std::io::Read;
    let (mut read, write) = std::os::unix::net::UnixStream::pair()?;
    std::thread::Builder::new().spawn(move || {
        while read.read_exact(&mut [0]).is_ok() {
            CODE.store(143, Ordering::SeqCst);
            act();
        }
    })?;
    signal_hook::low_level::pipe::register(signal_hook::consts::SIGTERM, write).map(|_| ())
}

#[cfg(not(unix))]
fn on_termination(_: impl Fn() + Send + 'static) -> std::io::Result<()> {
    Ok(())
}

/// The first signal cancels the work, and ends the process if the work does not; the second ends it at once.
fn interrupted(flag: &AtomicBool, verb: &'static str) {
    if flag.swap(true, Ordering::SeqCst) {
        // An end that waits for a slow disk is not waited for.
        if ENDING.load(Ordering::SeqCst) {
            std::process::exit(i32::from(code()));
        }
        end(verb);
    }
    let later = std::thread::Builder::new().spawn(move || {
        std::thread::sleep(GRACE);
        end(verb);
    });
    if later.is_err() {
        end(verb);
    }
}

/// Runs a program until it ends; it is ended with this one.
pub(crate) fn run(command: &mut Command) -> std::io::Result<ExitStatus> {
    *child() = Some(command.spawn()?);
    loop {
        let ended = child().as_mut().map_or(Ok(None), Child::try_wait)?;
        if let Some(status) = ended {
            return Ok(status);
        }
        std::thread::sleep(WATCH);
    }
}

fn child() -> MutexGuard<'static, Option<Child>> {
    CHILD.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Lets the calling thread alone end the process: another one that wants to waits for that end.
pub(crate) fn claim_end() {
    while ENDING.swap(true, Ordering::SeqCst) {
        std::thread::park();
    }
}

/// Notes that a picture is written on standard output.
pub(crate) fn note_stdout() {
    ON_STDOUT.store(true, Ordering::SeqCst);
}

fn end(verb: &str) {
    claim_end();
    if let Some(child) = child().as_mut() {
        // It may have ended already.
        let _ = child.kill();
    }
    report::fail(&said(&atomic::abandon(), verb));
    std::process::exit(i32::from(code()));
}

/// What is told of work that ended by itself.
pub(crate) fn told(error: &anyhow::Error, verb: &str) -> String {
    match error.downcast_ref() {
        Some(BelvedereError::Interrupted { .. }) => report::one_line(error),
        _ => said(&atomic::abandon(), verb),
    }
}

/// * `written`: the outputs, the oldest first.
fn said(written: &[PathBuf], verb: &str) -> String {
    let names: Vec<String> = written.iter().map(|path| path.display().to_string()).collect();
    let files = match names.as_slice() {
        [] if ON_STDOUT.load(Ordering::SeqCst) => "standard output may hold a part of the picture".into(),
        [] => "nothing was written".into(),
        [.., last] if names.len() > 4 => format!("{} files were written, the last of them {last}", names.len()),
        names => format!("written before: {}", names.join(", ")),
    };
    let resume = if verb == "animate" && !names.is_empty() { "; the same command with --resume goes on" } else { "" };
    report::relative(&format!("interrupted; {files}{resume}"))
}
