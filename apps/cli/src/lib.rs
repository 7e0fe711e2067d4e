//! The `belvedere` command line: arguments in, one verb of the library, one line about failures out.
// Doc comments of arguments are help texts, and those hold JSON.
#![allow(rustdoc::broken_intra_doc_links)]

mod animate;
mod args;
mod bench;
mod bench_args;
mod city;
mod common_args;
mod disocclude;
mod drafts;
mod export;
mod goal;
mod info_args;
mod inputs;
mod interrupt;
mod memory;
mod options_of_keys;
mod outputs;
mod pack;
mod parse;
mod picture_names;
mod point_args;
mod preset;
mod render;
mod report;
mod reveal;
mod scene_keys;
mod schemas;
mod shell;
mod shell_args;
mod stdin;
mod timings;
mod trust;
mod usage;
mod verbs;
mod view;

use args::Cli;
use clap::Parser;
use report::Context;
use std::ffi::OsString;
use std::sync::OnceLock;

/// Stack of the thread that works: deep enough for any document that passes the limits.
const STACK_BYTES: usize = 64 << 20;

/// Words of the command line, the first the program's own name.
static WORDS: OnceLock<Vec<OsString>> = OnceLock::new();

/// Runs the program with the words of a command line, of which the first is its own name; once in a process. Returns the exit code; Ctrl-C, SIGTERM and
/// memory beyond the budget end the process.
pub fn command_line(words: Vec<OsString>) -> u8 {
    std::panic::set_hook(Box::new(|_| {}));
    let cli = match Cli::try_parse_from(WORDS.get_or_init(|| words)) {
        Ok(cli) => cli,
        Err(e) => return usage::report(&e),
    };
    memory::begin(cli.common.max_mem);
    let worker = std::thread::Builder::new().stack_size(STACK_BYTES).spawn(|| run(cli));
    match worker.map(std::thread::JoinHandle::join) {
        Ok(Ok(code)) => code,
        Ok(Err(panic)) => broken(&*panic),
        Err(e) => {
            report::fail(&format!("no thread could be started: {e}"));
            2
        }
    }
}

/// The words that the user gave after the name of the program.
fn given_words() -> impl Iterator<Item = String> {
    WORDS.get().into_iter().flatten().skip(1).map(|word| word.to_string_lossy().into_owned())
}

/// Reports a panic in one line on standard error.
fn broken(panic: &(dyn std::any::Any + Send)) -> u8 {
    let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
    let what = text.unwrap_or("no message").lines().next().unwrap_or_default();
    report::fail(&format!("internal error ({what}); please report this with the command line and the files"));
    2
}

fn run(cli: Cli) -> u8 {
    belvedere::threads::start();
    let verb = cli.verb.name();
    let context = Context::new(cli.common, cli.verb.makes_many_pictures());
    interrupt::install(context.progress.cancel_flag(), verb);
    let end =
        verbs::run(cli.verb, &context).and_then(|goal| context.timings.write(verb, &context.common).map(|()| goal));
    interrupt::claim_end();
    match end {
        Ok(goal) => {
            context.finish();
            u8::from(goal.is_missed() && context.common.strict)
        }
        Err(e) if context.progress.is_cancelled() => {
            context.finish();
            report::fail(&interrupt::told(&e, verb));
            interrupt::code()
        }
        Err(e) => {
            context.finish();
            report::fail(&report::one_line(&e));
            2
        }
    }
}
