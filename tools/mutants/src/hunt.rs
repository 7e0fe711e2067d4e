//! Finds out which test notices which fault. It works level by level, so that an unfinished run is already informative.

use crate::build::Suite;
use crate::find::Fault;
use crate::run::{self, Baseline, Ending};
use crate::{Args, Plan};
use anyhow::Result;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// The entries of the log, one line each.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Line {
    /// The result of a test without a fault.
    Baseline { suite: String, test: String, passed: bool, seconds: f64, reached: BTreeSet<usize> },
    /// The result for a fault after the tests of one level.
    Tried { fault: usize, level: usize, tests: usize, noticed_by: Option<String> },
}

/// The results for the faults.
#[derive(Debug, Default)]
pub(crate) struct Results {
    /// For each fault, the test that noticed it.
    pub(crate) noticed: BTreeMap<usize, String>,
    /// For each fault, the number of tests that ran.
    pub(crate) tests: BTreeMap<usize, usize>,
    /// For each fault, the last level whose tests were run.
    pub(crate) levels: BTreeMap<usize, usize>,
    /// Tests that fail without a fault. They were left out.
    pub(crate) broken: Vec<String>,
    usual: BTreeMap<(String, String), Baseline>,
}

impl Results {
    fn take(&mut self, line: Line) {
        match line {
            Line::Baseline { suite, test, passed, seconds, reached } => {
                if !passed {
                    self.broken.push(format!("{suite} {test}"));
                }
                self.usual.insert((suite, test), Baseline { passed, seconds, reached });
            }
            Line::Tried { fault, level, tests, noticed_by } => {
                *self.tests.entry(fault).or_default() += tests;
                self.levels.insert(fault, level);
                if let Some(test) = noticed_by {
                    self.noticed.insert(fault, test);
                }
            }
        }
    }
}

/// The level of a suite for a fault; `None` if the suite is not linked with the code of the fault.
fn level(suite: &Suite, fault: &Fault) -> Option<usize> {
    match suite {
        _ if !suite.contains.contains(&fault.package) => None,
        _ if suite.package == fault.package => Some(usize::from(suite.kind != "lib")),
        _ => Some(if suite.of_application { 3 } else { 2 }),
    }
}

/// Runs all tests that are not in the log yet.
pub(crate) fn hunt(plan: &Plan, suites: &[Suite], home: &Path, args: &Args) -> Result<Results> {
    let path = home.join("results.jsonl");
    let scratch = home.join("tmp");
    let mut results = Results::default();
    for line in std::fs::read_to_string(&path).unwrap_or_default().lines() {
        // The last line of an interrupted run may be incomplete.
        if let Ok(line) = serde_json::from_str(line) {
            results.take(line);
        }
    }
    let file = Mutex::new(std::fs::File::options().append(true).create(true).open(&path)?);
    let note = |line: &Line| -> Result<()> {
        let text = serde_json::to_string(line)? + "\n";
        Ok(file.lock().expect("no panic").write_all(text.as_bytes())?)
    };
    for now in 0..=args.level {
        let open: Vec<usize> = plan.chosen.iter().copied().filter(|id| !results.noticed.contains_key(id)).collect();
        let open: Vec<usize> = open.into_iter().filter(|id| results.levels.get(id).is_none_or(|l| *l < now)).collect();
        let concerns = |suite: &Suite| open.iter().any(|&id| level(suite, &plan.faults[id]) == Some(now));
        let mut missing = Vec::new();
        for suite in suites.iter().filter(|s| concerns(s)) {
            for test in run::tests(suite)? {
                let skipped = args.skip.iter().any(|s| format!("{} {test}", suite.label()).contains(s));
                if !skipped && !results.usual.contains_key(&(suite.label(), test.clone())) {
                    missing.push((suite, test));
                }
            }
        }
        eprintln!("level {now}: {} faults, {} tests to run without a fault", open.len(), missing.len());
        let lines = in_parallel(args.jobs, &missing, |(suite, test)| {
            let usual = run::usual(suite, test, &scratch)?;
            let Baseline { passed, seconds, reached } = usual;
            let line = Line::Baseline { suite: suite.label(), test: test.clone(), passed, seconds, reached };
            note(&line)?;
            Ok(line)
        })?;
        lines.into_iter().for_each(|line| results.take(line));
        let lines = in_parallel(args.jobs, &open, |&id| {
            let line = attempt(plan, suites, &results, id, now, &scratch)?;
            note(&line)?;
            Ok(line)
        })?;
        lines.into_iter().for_each(|line| results.take(line));
        eprintln!("level {now}: {} of {} noticed", results.noticed.len(), plan.chosen.len());
    }
    Ok(results)
}

/// Runs the tests of a level that reach a fault until one fails: first those of the fault's module, then the others, each in order of
/// running time.
fn attempt(plan: &Plan, suites: &[Suite], results: &Results, id: usize, now: usize, scratch: &Path) -> Result<Line> {
    let fault = &plan.faults[id];
    let near: BTreeMap<String, &Suite> =
        suites.iter().filter(|s| level(s, fault) == Some(now)).map(|s| (s.label(), s)).collect();
    let candidates = results.usual.iter().filter(|(_, usual)| usual.passed && usual.reached.contains(&id));
    let mut tests: Vec<_> =
        candidates.filter_map(|((suite, test), usual)| Some((*near.get(suite)?, test, usual))).collect();
    let rank = |(_, test, usual): &(&Suite, &String, &Baseline)| (!test.starts_with(&fault.module), usual.seconds);
    tests.sort_by(|a, b| rank(a).partial_cmp(&rank(b)).expect("times are numbers"));
    for (k, (suite, test, usual)) in tests.iter().enumerate() {
        let late = match run::with_fault(suite, test, usual, id, scratch)? {
            Ending::Passed => continue,
            Ending::Failed => "",
            Ending::Late => " (late)",
        };
        return Ok(Line::Tried {
            fault: id,
            level: now,
            tests: k,
            noticed_by: Some(format!("{} {test}{late}", suite.label())),
        });
    }
    Ok(Line::Tried { fault: id, level: now, tests: tests.len(), noticed_by: None })
}

/// Calls a function for every item on `jobs` threads. The results come in any order.
fn in_parallel<T: Sync, R: Send>(jobs: usize, items: &[T], job: impl Fn(&T) -> Result<R> + Sync) -> Result<Vec<R>> {
    let next = AtomicUsize::new(0);
    let work = || -> Result<Vec<R>> {
        let mut done = Vec::new();
        while let Some(item) = items.get(next.fetch_add(1, Relaxed)) {
            done.push(job(item)?);
        }
        Ok(done)
    };
    let parts: Result<Vec<Vec<R>>> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..jobs.max(1)).map(|_| scope.spawn(work)).collect();
        threads.into_iter().map(|t| t.join().expect("no panic")).collect()
    });
    Ok(parts?.into_iter().flatten().collect())
}
