//! Runs tests one by one, with or without a fault.

use crate::build::Suite;
use crate::plant::{REACHED, SWITCH};
use anyhow::{Context, Result, ensure};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// Address space that a test may use, in KiB. A fault may otherwise allocate all memory.
const MEMORY_KIB: u64 = 12 << 20;

/// The multiple of its usual running time after which a test counts as failed, and the time that every test is allowed.
const PATIENCE: (f64, Duration) = (5.0, Duration::from_secs(5));

/// How a run of a test ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ending {
    Passed,
    Failed,
    Late,
}

/// A test and how it behaves without a fault.
#[derive(Debug, Clone)]
pub(crate) struct Baseline {
    pub(crate) passed: bool,
    pub(crate) seconds: f64,
    /// Faults whose code the test reaches.
    pub(crate) reached: BTreeSet<usize>,
}

/// The names of the tests of a suite.
pub(crate) fn tests(suite: &Suite) -> Result<Vec<String>> {
    let out = Command::new(&suite.program).args(["--list", "--format", "terse"]).current_dir(&suite.folder).output()?;
    ensure!(out.status.success(), "{} lists no tests", suite.program.display());
    let text = String::from_utf8(out.stdout)?;
    Ok(text.lines().filter_map(|l| l.strip_suffix(": test").map(str::to_owned)).collect())
}

/// Runs a test without a fault and records which faults it reaches.
pub(crate) fn usual(suite: &Suite, test: &str, scratch: &Path) -> Result<Baseline> {
    let temporary = Temporary::new(scratch)?;
    let record = temporary.0.join("reached");
    let started = Instant::now();
    let ending = run(suite, test, &temporary, (REACHED, &record.display().to_string()), Duration::from_secs(1800))?;
    let text = std::fs::read_to_string(&record).unwrap_or_default();
    Ok(Baseline {
        passed: ending == Ending::Passed,
        seconds: started.elapsed().as_secs_f64(),
        reached: text.lines().filter_map(|l| l.parse().ok()).collect(),
    })
}

/// Runs a test with a fault switched on.
pub(crate) fn with_fault(suite: &Suite, test: &str, usual: &Baseline, fault: usize, scratch: &Path) -> Result<Ending> {
    let limit = Duration::from_secs_f64(PATIENCE.0 * usual.seconds) + PATIENCE.1;
    run(suite, test, &Temporary::new(scratch)?, (SWITCH, &fault.to_string()), limit)
}

fn run(suite: &Suite, test: &str, temporary: &Temporary, variable: (&str, &str), limit: Duration) -> Result<Ending> {
    let mut command = Command::new("sh");
    command
        .args(["-c", &format!("ulimit -v {MEMORY_KIB}; exec \"$0\" \"$@\"")])
        .arg(&suite.program)
        .args(["--exact", test])
        .current_dir(&suite.folder)
        .env(variable.0, variable.1)
        .env("TMPDIR", &temporary.0)
        .env("CARGO_MANIFEST_DIR", &suite.folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    if std::env::var_os("BELVEDERE_DATA").is_none() {
        // Tests look for their data next to the workspace, but the copy is in another place.
        command.env("BELVEDERE_DATA", concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"));
    }
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut child = command.spawn().with_context(|| suite.program.display().to_string())?;
    let started = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(if status.success() { Ending::Passed } else { Ending::Failed });
        }
        if started.elapsed() > limit {
            // Kill the whole group: a test of the command line waits for a program that it started.
            Command::new("kill").args(["-KILL", "--", &format!("-{}", child.id())]).status()?;
            child.wait()?;
            return Ok(Ending::Late);
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// A folder for the temporary files of one test. It is removed afterwards, whatever the result of the test.
struct Temporary(PathBuf);

impl Temporary {
    fn new(scratch: &Path) -> Result<Self> {
        static NUMBER: AtomicUsize = AtomicUsize::new(0);
        let path = scratch.join(format!("{}", NUMBER.fetch_add(1, Relaxed)));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path)?;
        Ok(Self(path))
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
