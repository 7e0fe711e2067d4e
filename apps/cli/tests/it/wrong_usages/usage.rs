//! One wrong usage, and how it is tried.

use super::good;
use std::collections::HashMap;
use std::path::Path;
use std::process::Command;
use std::sync::{LazyLock, Mutex};
use std::time::{Duration, Instant};

/// No wrong usage may take longer; no measurement, for other work of the machine must not matter.
const SOON: Duration = Duration::from_secs(120);

/// Words and files of a usage.
type Key = (Vec<String>, Vec<(String, Option<Vec<u8>>)>);

/// Remedies that were tried, and how they were refused.
static TRIED: LazyLock<Mutex<HashMap<Key, Option<String>>>> = LazyLock::new(Mutex::default);

/// One wrong usage.
#[derive(Clone, Default)]
pub(super) struct Usage {
    /// Words behind the name of the program.
    pub(super) words: Vec<String>,
    /// Files that take the place of the good ones; `None` = removed.
    pub(super) files: Vec<(String, Option<Vec<u8>>)>,
    /// What is at fault, as it is written: the message names it.
    pub(super) names: Vec<String>,
    /// What is wrong as it is written, for suggestions that are put in its place.
    pub(super) wrong: Option<String>,
    /// Text of the first file with «» in place of what is wrong.
    template: Option<String>,
    /// Usages that must work: the remedies that the message gives.
    pub(super) remedies: Vec<Usage>,
}

/// A usage from a command line; `''` is an empty word.
pub(super) fn usage(line: &str) -> Usage {
    let words = line.split_whitespace().map(|word| if word == "''" { String::new() } else { word.to_owned() });
    Usage { words: words.collect(), ..Usage::default() }
}

impl Usage {
    pub(super) fn names(mut self, what: &str) -> Self {
        self.names.extend(what.split(" & ").filter(|name| !name.is_empty()).map(str::to_owned));
        self
    }

    pub(super) fn wrong(mut self, what: &str) -> Self {
        self.wrong = Some(what.to_owned());
        self.names(what)
    }

    pub(super) fn file(mut self, name: &str, content: impl Into<Vec<u8>>) -> Self {
        self.files.push((name.to_owned(), Some(content.into())));
        self
    }

    pub(super) fn without(mut self, name: &str) -> Self {
        self.files.push((name.to_owned(), None));
        self
    }

    /// Takes what stands between « and » in its files as what is wrong.
    pub(super) fn marked(mut self) -> Self {
        for (_, content) in &mut self.files {
            let text = String::from_utf8_lossy(content.as_deref().unwrap_or_default()).into_owned();
            if let Some((before, rest)) = text.split_once('«')
                && let Some((wrong, after)) = rest.split_once('»')
            {
                self.wrong = Some(wrong.to_owned());
                self.template = Some(format!("{before}«»{after}"));
                *content = Some(format!("{before}{wrong}{after}").into_bytes());
            }
        }
        self
    }

    /// A remedy: another usage that must work.
    pub(super) fn or(mut self, remedy: Usage) -> Self {
        self.remedies.push(remedy);
        self
    }

    /// A remedy: another command line on the same files.
    pub(super) fn or_line(self, line: &str) -> Self {
        let remedy = Usage { files: self.files.clone(), ..usage(line) };
        if line.is_empty() { self } else { self.or(remedy) }
    }

    /// This usage with `right` in place of what is wrong, in its words and files.
    fn mended(&self, right: &str) -> Self {
        if let (Some(template), Some((name, _))) = (&self.template, self.files.first()) {
            return Self { words: self.words.clone(), ..Self::default() }.file(name, template.replace("«»", right));
        }
        let wrong = self.wrong.clone().unwrap_or_default();
        let text = |bytes: &Vec<u8>| String::from_utf8_lossy(bytes).replacen(&wrong, right, 1).into_bytes();
        let is_in_words = self.words.iter().any(|word| word.contains(&wrong));
        let words = self.words.iter().map(|word| word.replacen(&wrong, right, 1)).collect();
        let files = self.files.iter().map(|(name, content)| (name.clone(), content.as_ref().map(text))).collect();
        Self { words, files: if is_in_words { self.files.clone() } else { files }, ..Self::default() }
    }

    /// This usage with its file under a name with another ending.
    fn renamed(&self, ending: &str) -> Self {
        let (name, content) = self.files[0].clone();
        let new = Path::new(&name).with_extension(ending.trim_start_matches('.')).to_string_lossy().into_owned();
        let words = self.words.iter().map(|word| word.replace(&name, &new)).collect();
        Self { words, files: vec![(new, content)], ..Self::default() }
    }

    /// This usage with another value of a key of its scene.
    fn with_key(&self, key: &str, value: &str) -> Option<Self> {
        let (name, content) = self.files.first()?;
        let text = String::from_utf8_lossy(content.as_deref()?).into_owned();
        let start = format!("{key} = ");
        let line =
            |line: &str| if line.starts_with(&start) { format!("{start}{value}\n") } else { format!("{line}\n") };
        let mended: String = text.lines().map(line).collect();
        Some(Self { words: self.words.clone(), ..Self::default() }.file(name, mended))
    }

    /// How it is listed.
    pub(super) fn title(&self) -> String {
        let words: Vec<&str> = self.words.iter().map(|w| if w.is_empty() { "''" } else { w.as_str() }).collect();
        let changed = |content: &Option<Vec<u8>>| {
            let text = String::from_utf8(content.clone()?).ok().filter(|text| text.len() < 2000)?;
            Some(text.lines().rev().take(3).collect::<Vec<_>>().into_iter().rev().collect::<Vec<_>>().join(" | "))
        };
        let files = self.files.iter().map(|(name, content)| match changed(content) {
            Some(text) => format!("   {name}: ... {text}"),
            None => format!("   {name}: {:?} bytes", content.as_ref().map(Vec::len)),
        });
        words.join(" ") + &files.collect::<String>()
    }

    /// Runs it in a folder of its own.
    pub(super) fn run(&self) -> Answer {
        let folder = tempfile::tempdir().expect("temporary folder");
        for (name, content) in good::FILES.iter() {
            std::fs::write(folder.path().join(name), content).expect("file");
        }
        std::fs::create_dir(folder.path().join("folder")).expect("folder");
        for (name, content) in &self.files {
            let path = folder.path().join(name);
            match content {
                Some(content) => std::fs::write(path, content).expect("file"),
                None => std::fs::remove_file(path).expect("file"),
            }
        }
        answer(folder.path(), &self.words)
    }

    /// What the program says if it refuses a usage that should work; each is tried once.
    fn refusal(&self) -> Option<String> {
        let key = (self.words.clone(), self.files.clone());
        let known = TRIED.lock().expect("no panic").get(&key).cloned();
        known.unwrap_or_else(|| {
            let answer = self.run();
            let refusal = (!matches!(answer.code, Some(0 | 1))).then(|| answer.said.trim().to_owned());
            TRIED.lock().expect("no panic").insert(key, refusal.clone());
            refusal
        })
    }

    /// Everything that is wrong with the answer of the program.
    pub(super) fn faults(&self, answer: &Answer, options: &str) -> Vec<String> {
        let mut faults = answer.faults();
        let said = &answer.said;
        for name in self.names.iter().filter(|name| !said.contains(name.as_str())) {
            faults.push(format!("does not name {name:?}"));
        }
        for option in super::hints::options(said).filter(|option| !options.contains(option.as_str())) {
            if !self.words.iter().any(|word| word.starts_with(&option)) {
                faults.push(format!("names {option}, which is no option"));
            }
        }
        let suggested = super::hints::values(said).into_iter().filter(|_| self.wrong.is_some());
        let commands = super::hints::commands(said).into_iter().map(|line| usage(&line));
        let commands = commands.map(|usage| Self { files: self.files.clone(), ..usage });
        let valid = super::hints::nearest(said).into_iter().filter_map(|(key, value)| self.with_key(&key, &value));
        let renamed = super::hints::ending(said).map(|ending| self.renamed(ending));
        let tried = suggested
            .map(|right| self.mended(&right))
            .chain(commands)
            .chain(valid)
            .chain(renamed)
            .chain(self.remedies.iter().cloned());
        for remedy in tried {
            if let Some(refusal) = remedy.refusal() {
                faults.push(format!("its remedy is refused: {}: {refusal}", remedy.title()));
            }
        }
        faults
    }
}

/// What the program answered.
pub(super) struct Answer {
    pub(super) code: Option<i32>,
    /// Standard error.
    pub(super) said: String,
    /// Standard output.
    pub(super) printed: String,
    took: Duration,
}

fn answer(folder: &Path, words: &[String]) -> Answer {
    let started = Instant::now();
    let out = Command::new(env!("CARGO_BIN_EXE_belvedere"))
        .current_dir(folder)
        .args(words)
        .stdin(std::process::Stdio::null())
        .output()
        .expect("the program starts");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (said, printed) = (text(&out.stderr), text(&out.stdout));
    // On a slow machine lines of progress come first.
    let is_progress = |line: &str| {
        line.split_once(" %: ").is_some_and(|(start, _)| start.starts_with("belvedere: ") && start.len() <= 14)
    };
    let said: String = said.split_inclusive('\n').filter(|line| !is_progress(line)).collect();
    Answer { code: out.status.code(), said, printed, took: started.elapsed() }
}

/// Words of the language that the program is written in, and others that say nothing to its user.
const CODE: &[&str] = &[
    "panicked",
    "internal error",
    "unwrap",
    "Some(",
    "None",
    "Ok(",
    "Err(",
    "ParseIntError",
    "ParseFloatError",
    "Utf8Error",
    "usize",
    "f64",
    "u32",
    "i64",
    "os error",
    "EOF",
    "serde",
    "tobj",
    "struct ",
    "enum ",
    "variant",
    "src/",
    ".rs:",
    "deserialize",
    "{}",
    "\\u{",
    "::",
];

impl Answer {
    fn faults(&self) -> Vec<String> {
        let said = self.said.as_str();
        let mut faults = Vec::new();
        let mut fault = |is: bool, what: String| {
            if is {
                faults.push(what);
            }
        };
        fault(self.code != Some(2), format!("exit code {:?}", self.code));
        fault(said.lines().count() != 1, format!("{} lines", said.lines().count()));
        fault(!said.starts_with("belvedere: "), "does not begin with the name of the program".into());
        let length = said.trim_end().chars().count();
        fault(length > 500, format!("{length} characters"));
        fault(said.trim_end().chars().any(char::is_control), "holds a control character".into());
        fault(says_twice(said), "says the same twice".into());
        fault(said.contains(std::env::temp_dir().to_string_lossy().as_ref()), "tells the working folder".into());
        fault(self.took > SOON, format!("took {:.1} s", self.took.as_secs_f64()));
        for word in CODE.iter().filter(|word| said.contains(**word)) {
            fault(true, format!("speaks of {word:?}"));
        }
        faults
    }
}

/// Whether forty characters stand in a text twice.
fn says_twice(text: &str) -> bool {
    let starts: Vec<usize> = text.char_indices().map(|(at, _)| at).collect();
    starts.iter().zip(starts.iter().skip(40)).any(|(&from, &to)| text[to..].contains(&text[from..to]))
}
