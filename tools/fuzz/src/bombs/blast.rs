//! A program under the bombs: each in a process of its own, whose memory is watched.

use super::Bomb;
use anyhow::{Context, Result};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// What one file may cost.
#[derive(Debug, Clone, Copy)]
pub struct Budget {
    /// `--max-mem` of the program, MiB; `None` for its default.
    pub max_mem: Option<u64>,
    /// Limit of the address space, MiB.
    pub address_space: u64,
    /// Longest time by the clock.
    pub time: Duration,
}

/// How the program ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fate {
    /// It read the file, or refused it in words.
    Answered,
    /// A signal or a panic ended it.
    Aborted,
    /// It took more than a tenth over its budget.
    Over,
    /// It was stopped after its time.
    Late,
}

/// One file and what became of it.
#[derive(Debug, Clone)]
pub struct Blast {
    /// Name of the file.
    pub name: String,
    /// How the program ended.
    pub fate: Fate,
    /// Most resident memory, MiB.
    pub peak: u64,
    /// Time by the clock.
    pub time: Duration,
}

/// What a program takes before it reads anything, MiB.
const BASE: u64 = 24;

/// Runs `program info FILE` on a bomb.
///
/// # Errors
/// If the file cannot be written or the program not be started.
pub fn blast(program: &Path, bomb: &Bomb, budget: &Budget) -> Result<Blast> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join(&bomb.name);
    std::fs::write(&file, &bomb.bytes)?;
    let mut command = Command::new("sh");
    let limit = format!("ulimit -v {}; exec \"$@\"", budget.address_space << 10);
    command.args(["-c", &limit, "sh"]).arg(program).arg("info").arg(&file).arg("-q");
    if let Some(max_mem) = budget.max_mem {
        command.arg("--max-mem").arg(format!("{max_mem}MiB"));
    }
    let begun = Instant::now();
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().context("sh cannot be started")?;
    let mut peak = 0;
    let code = loop {
        peak = peak.max(highest(child.id()));
        if let Some(status) = child.try_wait()? {
            break Some(status.code());
        }
        if begun.elapsed() > budget.time {
            child.kill()?;
            child.wait()?;
            break None;
        }
        std::thread::sleep(Duration::from_millis(3));
    };
    let fate = match code {
        None => Fate::Late,
        Some(Some(0..=2)) => match budget.max_mem {
            Some(most) if peak > BASE + most + most / 10 => Fate::Over,
            _ => Fate::Answered,
        },
        _ => Fate::Aborted,
    };
    Ok(Blast { name: bomb.name.clone(), fate, peak, time: begun.elapsed() })
}

/// Most resident memory of a process so far, MiB; 0 where the system does not tell.
fn highest(id: u32) -> u64 {
    let text = std::fs::read_to_string(format!("/proc/{id}/status")).unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|l| l.split_whitespace().next()?.parse::<u64>().ok()).unwrap_or(0) >> 10
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn programs_that_abort_hang_or_take_too_much_are_told() {
        let folder = tempfile::tempdir().expect("a folder");
        let bomb = Bomb::new("a.gpx", "<gpx/>");
        let budget = Budget { max_mem: Some(8), address_space: 4096, time: Duration::from_secs(5) };
        for (text, fate) in [
            ("exit 2", Fate::Answered),
            ("kill -6 $$", Fate::Aborted),
            ("exit 101", Fate::Aborted),
            ("sleep 60", Fate::Late),
            (
                "exec awk 'BEGIN { s = \"aaaaaaaa\"; while (length(s) < 90000000) s = s s; system(\"sleep 0.3\") }'",
                Fate::Over,
            ),
        ] {
            let program = folder.path().join("program");
            std::fs::write(&program, format!("#!/bin/sh\n{text}\n")).expect("written");
            std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).expect("made a program");
            assert_eq!(blast(&program, &bomb, &budget).expect("run").fate, fate, "{text}");
        }
    }
}
