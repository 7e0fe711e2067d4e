//! Mistakes in the words of a command line, as one line each.

use crate::args::Cli;
use crate::report::fail;
use belvedere::core::plain as plain_text;
use belvedere::io::formats::Reader;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Command, CommandFactory};
use std::path::Path;

/// Most characters of a mistake, before the way to the help.
const LONGEST: usize = 420;

/// Help and version on standard output, a mistake as one line.
pub(crate) fn report(error: &clap::Error) -> u8 {
    if !error.use_stderr() {
        let _ = error.print();
        return 0;
    }
    let given: Vec<String> = crate::given_words().collect();
    let cli = Cli::command();
    let (command, names) = meant(&cli, &given);
    let help = [&["belvedere"], &names[..], &["--help"]].concat().join(" ");
    let what = words(error, command);
    fail(&format!("{}; see {help}", plain_text::shortened(&what, LONGEST)));
    2
}

/// The command that the words name, and its names: a verb, and what it does.
fn meant<'c>(cli: &'c Command, given: &[String]) -> (&'c Command, Vec<&'c str>) {
    let (mut command, mut names) = (cli, Vec::new());
    for word in given {
        if let Some(found) = command.get_subcommands().find(|c| c.get_name() == word) {
            command = found;
            names.push(found.get_name());
        } else if !names.is_empty() || !word.starts_with('-') {
            break;
        }
    }
    (command, names)
}

fn words(error: &clap::Error, command: &Command) -> String {
    let choices = || command.get_subcommands().map(Command::get_name).collect::<Vec<_>>().join(", ");
    match (error.kind(), error.get(ContextKind::InvalidSubcommand)) {
        (ErrorKind::MissingSubcommand | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand, _) => {
            let (name, of) = (command.get_name(), command.has_subcommands());
            let what = if name == "belvedere" || !of {
                "a verb is missing".to_owned()
            } else {
                format!("{name}: what to do is missing")
            };
            format!("{what}; possible: {}", choices())
        }
        (ErrorKind::InvalidSubcommand, Some(ContextValue::String(word))) => {
            if Path::new(word).exists() {
                let document = [".toml", ".json"].iter().any(|ending| word.ends_with(ending));
                let verb = if document { "check" } else { "info" };
                return format!(
                    "\"{word}\" is a file, not a verb; the verb comes first, as in belvedere {verb} {word}"
                );
            }
            let near = match error.get(ContextKind::SuggestedSubcommand) {
                // The likeliest comes last.
                Some(ContextValue::Strings(near)) => near.last().map(|near| format!("did you mean \"{near}\"?")),
                _ => None,
            };
            format!("there is no verb \"{word}\"; {}", near.unwrap_or_else(|| format!("possible: {}", choices())))
        }
        (ErrorKind::UnknownArgument, _) if command.get_name() == "render" && is_of_features(error) => {
            format!("{}; features and their terrain are drawn by the verb reveal", rendered(error))
        }
        _ => rendered(error),
    }
}

/// Whether the word that is too much is a file of routes, areas or points.
fn is_of_features(error: &clap::Error) -> bool {
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidArg) else { return false };
    let format = belvedere::io::readable(Path::new(word)).ok().flatten();
    Path::new(word).is_file() && format.is_some_and(|format| format.reader == Some(Reader::Features))
}

/// The text that clap makes, on one line and in our words.
fn rendered(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let lines = text.lines().map(|line| line.trim().trim_start_matches("error: ").trim_start_matches("tip: "));
    let lines = lines.take_while(|line| !line.starts_with("Usage") && !line.starts_with("For more information"));
    // A value that begins with a hyphen is not what was meant.
    let lines = lines.filter(|line| !line.is_empty() && !line.starts_with("to pass ")).map(plain);
    lines.collect::<Vec<_>>().join("; ").replace(":; ", ": ")
}

/// A line of clap in the words of the other messages.
fn plain(line: &str) -> String {
    let quoted = |rest: &str| rest.split('\'').next().unwrap_or_default().to_owned();
    for start in [
        "a similar value exists: '",
        "a similar argument exists: '",
        "some similar values exist: '",
        "some similar arguments exist: '",
    ] {
        if let Some(rest) = line.strip_prefix(start) {
            return format!("did you mean \"{}\"?", quoted(rest));
        }
    }
    if let Some(values) = line.strip_prefix("[possible values: ") {
        return format!("possible: {}", values.trim_end_matches(']'));
    }
    let mut line = line.to_owned();
    for (code, plain) in [
        ("invalid float literal", "give a number"),
        ("invalid digit found in string", "give a whole number"),
        ("number too large to fit in target type", "give a smaller whole number"),
        ("cannot parse integer from empty string", "give a whole number"),
        ("cannot parse float from empty string", "give a number"),
    ] {
        line = line.replace(code, plain);
    }
    match line.split_once(": ").and_then(|(what, range)| Some((what, range.split_once(" is not in ")?.1))) {
        Some((what, range)) if range.contains("..=") => format!("{what}: give a whole number in {range}"),
        _ => line,
    }
}
