//! Watches what the program holds, and ends it in one line where memory passes the budget.
//!
//! Loaders, solvers and renderers ask before they begin (`belvedere::io::budget`). This is the last door, for what no estimate foresaw: without
//! it the system would end the process, or others. Where the system limits the address space (`ulimit -v`), that is watched as well.

use crate::interrupt;
use belvedere::core::plain;
use belvedere::io::{atomic, budget};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Time between two looks. In it a program writes some tens of MiB that are new to it.
const EVERY: Duration = Duration::from_millis(4);
/// Most characters of the name of a file in the message.
const LONGEST_NAME: usize = 240;
/// Address space that must be free, bytes, so that the next request does not fail before the next look.
const SPARE: u64 = 128 << 20;

/// Sets the budget of the process, bytes, and watches it; `None` = that of the machine.
pub(crate) fn begin(most: Option<u64>) {
    budget::set(most.unwrap_or(0));
    end_where_the_system_refuses();
    let Some(now) = budget::pages().filter(|_| budget::count_own()) else {
        // This system does not tell; estimates must do.
        return;
    };
    let folder = std::env::current_dir().unwrap_or_default();
    let most = budget::bytes();
    let space = now.space.saturating_add(budget::address_space_left());
    let space_most = space - SPARE.min(space / 16);
    // Without a thread estimates must do, too.
    let _ = std::thread::Builder::new().name("memory".into()).spawn(move || {
        // Address space that is reserved and not used, as for heaps of threads, is no reason to end.
        let has_room = |now: budget::Pages| now.held <= most && (now.space <= space_most || now.held <= most / 2);
        while budget::pages().is_none_or(has_room) {
            std::thread::sleep(EVERY);
        }
        end(&folder);
    });
}

/// Makes a request for memory that the system refuses, which no code of ours saw coming, end the process with 2. The standard library says
/// in one line how many bytes failed, and aborts; a process cannot go on from there.
#[cfg(unix)]
fn end_where_the_system_refuses() {
    let always = Arc::new(AtomicBool::new(true));
    // Without it the signal ends the process.
    let _ = signal_hook::flag::register_conditional_shutdown(signal_hook::consts::SIGABRT, 2, always);
}

#[cfg(not(unix))]
fn end_where_the_system_refuses() {}

/// Says in one line what failed, and ends the process with 2.
fn end(folder: &Path) -> ! {
    let mut line = String::from("belvedere: ");
    budget::file_in_work(|file| {
        if let Some(file) = file {
            let inside: PathBuf = file.strip_prefix(folder).unwrap_or(file).into();
            line += &format!("{}: ", plain::shortened(&plain::escaped(&inside.display().to_string()), LONGEST_NAME));
        }
    });
    line += &format!(
        "the budget of memory is {} MiB and does not suffice; allow more memory (--max-mem), or use a smaller file, --size or --samples",
        budget::bytes() >> 20
    );
    interrupt::claim_end();
    // Outputs that are not whole go.
    let _ = atomic::abandon();
    let _ = writeln!(std::io::stderr().lock(), "{line}");
    std::process::exit(2)
}
