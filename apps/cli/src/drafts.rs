//! `reveal --drafts`: the sheet, and one line per draft with the command that makes it.

use crate::goal::Goal;
use crate::report::{Context, print};
use belvedere::verbs::reveal::{Draft, DraftsAnswer};
use belvedere::verbs::schemas::{DraftWithCommand, Drafts};
use std::path::{Path, PathBuf};

/// Options of the sheet that its commands leave out, with a value of their own.
const LEFT_OUT: [&str; 7] = ["--drafts", "--out", "-o", "--report", "--before", "--scene", "--fov"];

/// Writes the sheet and prints the commands.
pub(crate) fn sheet(found: &DraftsAnswer, out: &Path, context: &Context) -> anyhow::Result<Goal> {
    found.write(out, context.common.overwrite)?;
    context.finish();
    let commands: Vec<String> = found.drafts.iter().enumerate().map(|(i, draft)| command(draft, i, out)).collect();
    if context.common.json {
        let drafts = found.drafts.iter().cloned().zip(commands);
        let drafts = drafts.map(|(draft, command)| DraftWithCommand { draft, command }).collect();
        context.print("reveal", &[out.to_owned()], &Drafts { drafts, warnings: found.warnings.clone() })?;
    } else {
        for (i, (draft, command)) in found.drafts.iter().zip(&commands).enumerate() {
            print(&format!("{}: {}: {command}\n", i + 1, draft.words()))?;
        }
    }
    context.warn(&found.warnings);
    Ok(Goal::Reached)
}

/// This command line with the draft's view in place of the drafts.
fn command(draft: &Draft, index: usize, out: &Path) -> String {
    let mut words = vec!["belvedere".to_owned()];
    let mut given = crate::given_words();
    while let Some(word) = given.next() {
        let name = word.split_once('=').map_or(word.as_str(), |(name, _)| name);
        let is_short = word.starts_with("-o") && !word.starts_with("--");
        match word.as_str() {
            "--json" | "--overwrite" => {}
            _ if is_short && word != "-o" => {}
            _ if LEFT_OUT.contains(&name) => {
                if name == word {
                    given.next();
                }
            }
            _ => words.push(quoted(&word)),
        }
    }
    let list = |values: [f64; 3]| values.map(|v| v.to_string()).join(",");
    let stem = out.file_stem().and_then(|stem| stem.to_str()).unwrap_or("draft");
    let name = PathBuf::from(out).with_file_name(format!("{stem}-{}.png", index + 1));
    words.extend(["--eye".into(), list(draft.eye), "--look".into(), list(draft.look)]);
    words.extend(["--fov".into(), draft.fov_y_deg.to_string(), "-o".into(), quoted(&name.display().to_string())]);
    words.join(" ")
}

/// A word for a shell.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+=:,@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_with_signs_of_shells_are_quoted() {
        assert_eq!(
            [quoted("a/b.tif"), quoted("my dem.tif"), quoted("it's"), quoted("x?y=1")],
            ["a/b.tif", "'my dem.tif'", "'it'\\''s'", "'x?y=1'"]
        );
    }
}
