//! Hundreds of wrong usages: each gives one clear line that names what is at fault, and every remedy that the line gives is tried.
//! The lines are listed in `target/messages`.

mod arguments;
mod damaged;
mod files;
mod good;
mod hints;
mod keys;
mod no_materials;
mod outputs;
mod references;
mod terminal;
mod usage;
mod values;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::process::Command;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use usage::{Answer, Usage};

/// The help of every verb, which names all options.
static HELP: LazyLock<String> = LazyLock::new(|| {
    let help = |words: &[&str]| {
        let out = Command::new(env!("CARGO_BIN_EXE_belvedere")).args(words).arg("--help").output();
        String::from_utf8_lossy(&out.expect("the program starts").stdout).into_owned()
    };
    let all = help(&[]);
    let listed = all.split("Commands:").nth(1).and_then(|rest| rest.split("Options:").next()).unwrap_or_default();
    let verbs: Vec<&str> = listed.lines().filter_map(|line| line.split_whitespace().next()).collect();
    let presets = ["list", "show", "new", "set", "check", "plot"].map(|work| help(&["preset", work]));
    let verbs = verbs.iter().filter(|verb| **verb != "help").map(|verb| help(&[verb]));
    verbs.chain(presets).collect()
});

/// Runs all usages, several at a time.
fn answers(usages: &[Usage]) -> Vec<(Answer, Vec<String>)> {
    let threads = std::thread::available_parallelism().map_or(2, |n| n.get());
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        while let Some(usage) = usages.get(next.fetch_add(1, Ordering::Relaxed)) {
            let answer = usage.run();
            let faults = usage.faults(&answer, &HELP);
            let index = usages.iter().position(|other| std::ptr::eq(other, usage)).expect("it is there");
            done.push((index, (answer, faults)));
        }
        done
    };
    let mut all: Vec<_> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("no panic")).collect()
    });
    all.sort_by_key(|(index, _)| *index);
    all.into_iter().map(|(_, answer)| answer).collect()
}

/// Tries a table, lists its messages, and fails with everything that is wrong with them.
fn check(table: &str, least: usize, usages: &[Usage]) {
    assert!(usages.len() >= least, "{table} has {} usages, at least {least} are wanted", usages.len());
    let (mut list, mut wrong) = (String::new(), String::new());
    let mut same: BTreeMap<String, &Usage> = BTreeMap::new();
    for (usage, (answer, mut faults)) in usages.iter().zip(answers(usages)) {
        let said = answer.said.trim();
        if usage.names.is_empty() {
            faults.push("the table does not say what the message must name".into());
        }
        match same.get(said) {
            Some(other) if other.names != usage.names => faults.push(format!("the same as of: {}", other.title())),
            _ => {
                same.insert(said.to_owned(), usage);
            }
        }
        let _ = writeln!(list, "{}\n    {said}", usage.title());
        for fault in faults {
            let _ = writeln!(wrong, "{}\n    {said}\n    FAULT: {fault}", usage.title());
        }
    }
    let folder = belvedere_testkit::workspace_root().join("target/messages");
    std::fs::create_dir_all(&folder).expect("folder");
    std::fs::write(folder.join(format!("{table}.txt")), list).expect("list");
    assert!(wrong.is_empty(), "{table}:\n{wrong}");
}

#[test]
fn arguments_are_refused_in_one_clear_line() {
    check("arguments", 60, &arguments::table());
}

#[test]
fn files_of_the_wrong_kind_are_refused_in_one_clear_line() {
    check("files", 60, &files::table());
}

#[test]
fn damaged_files_are_refused_in_one_clear_line() {
    check("damaged", 40, &damaged::table());
}

#[test]
fn wrong_keys_are_refused_in_one_clear_line() {
    check("keys", 40, &keys::table());
}

#[test]
fn wrong_values_are_refused_in_one_clear_line() {
    check("values", 60, &values::table());
}

#[test]
fn wrong_references_are_refused_in_one_clear_line() {
    check("references", 20, &references::table());
}

#[test]
fn wrong_outputs_are_refused_in_one_clear_line() {
    check("outputs", 10, &outputs::table());
}
