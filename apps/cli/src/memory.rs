//! Watches what the program holds, and ends it in one line where memory passes the budget.
//!
//! Loaders, solvers and renderers ask before they begin (`belvedere::io::budget`). This is the last door, for what no estimate foresaw: without
//! it the system would end the process, or others.

use crate::interrupt;
use belvedere::core::plain;
use belvedere::io::{atomic, budget};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Time between two looks. In it a program writes some tens of MiB that are new to it.
const EVERY: Duration = Duration::from_millis(4);
/// Size of a page of memory, bytes; [`held`] is right where pages are as large.
const PAGE: u64 = 4096;

/// Sets the budget of the process, bytes, and watches it; `None` = that of the machine.
pub(crate) fn begin(most: Option<u64>) {
    budget::set(most.unwrap_or(0));
    if held() == 0 {
        // This system does not tell; estimates must do.
        return;
    }
    budget::count_by(held);
    let folder = std::env::current_dir().unwrap_or_default();
    let most = budget::bytes();
    // Without a thread estimates must do, too.
    let _ = std::thread::Builder::new().name("memory".into()).spawn(move || {
        while held() <= most {
            std::thread::sleep(EVERY);
        }
        end(&folder);
    });
}

/// Bytes of memory that are the program's own: without those that it shares with others, such as its own code; 0 where the system does not tell.
fn held() -> u64 {
    let Ok(text) = std::fs::read_to_string("/proc/self/statm") else { return 0 };
    let mut pages = text.split_whitespace().skip(1).map_while(|field| field.parse::<u64>().ok());
    let (resident, shared) = (pages.next().unwrap_or(0), pages.next().unwrap_or(0));
    resident.saturating_sub(shared) * PAGE
}

/// Says in one line what failed, and ends the process with 2.
fn end(folder: &Path) -> ! {
    let mut line = String::from("belvedere: ");
    budget::file_in_work(|file| {
        if let Some(file) = file {
            let inside: PathBuf = file.strip_prefix(folder).unwrap_or(file).into();
            line += &format!("{}: ", plain::escaped(&inside.display().to_string()));
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
