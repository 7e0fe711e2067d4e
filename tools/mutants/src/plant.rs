//! Writes a copy of the source that contains every fault, each behind a switch that the program reads from the environment when it
//! starts.

use crate::find::Fault;
use anyhow::{Context, Result, ensure};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Environment variable with the number of the fault that is switched on. Without it no fault is.
pub(crate) const SWITCH: &str = "BELVEDERE_MUTANT";

/// Environment variable with the path of a file. The program appends to it the number of every fault whose code it reaches.
pub(crate) const REACHED: &str = "BELVEDERE_MUTANTS_REACHED";

/// The place of each fault in the written files, by the number of the fault.
pub(crate) type Planted = BTreeMap<usize, (PathBuf, Range<usize>)>;

/// Copies the tracked files of `workspace` to `tree` with the faults of these numbers planted. Unchanged files keep their
/// modification time.
pub(crate) fn plant(
    workspace: &Path,
    tree: &Path,
    faults: &[Fault],
    chosen: &BTreeSet<usize>,
    roots: &BTreeMap<String, PathBuf>,
) -> Result<Planted> {
    let listed = Command::new("git").args(["ls-files", "-z"]).current_dir(workspace).output()?;
    ensure!(listed.status.success(), "git ls-files: {}", String::from_utf8_lossy(&listed.stderr));
    let mut planted = Planted::new();
    for name in String::from_utf8(listed.stdout)?.split('\0').filter(|n| !n.is_empty()) {
        let (file, from, to) = (PathBuf::from(name), workspace.join(name), tree.join(name));
        let Ok(mut bytes) = std::fs::read(&from) else { continue };
        let mut here: Vec<usize> = chosen.iter().copied().filter(|&id| faults[id].file == file).collect();
        let root = roots.iter().find(|(_, root)| root.strip_prefix(workspace).is_ok_and(|r| r == file));
        if !here.is_empty() || root.is_some() {
            here.sort_by_key(|&id| faults[id].bytes.start);
            let mut text = String::from_utf8(bytes).context("source is UTF-8")?;
            for (id, range) in rewrite(&mut text, faults, &here) {
                planted.insert(id, (file.clone(), range));
            }
            if root.is_some() {
                text += &switch(faults.len());
            }
            bytes = text.into_bytes();
        }
        if std::fs::read(&to).ok().as_ref() != Some(&bytes) {
            std::fs::create_dir_all(to.parent().context("a file lies in a folder")?)?;
            std::fs::write(&to, bytes).with_context(|| to.display().to_string())?;
            std::fs::set_permissions(&to, std::fs::metadata(&from)?.permissions())?;
        }
    }
    Ok(planted)
}

/// Writes the faults of these numbers into the text and returns the place of each. The faults must be sorted and must not overlap.
fn rewrite(text: &mut String, faults: &[Fault], here: &[usize]) -> Vec<(usize, Range<usize>)> {
    let (mut out, mut copied, mut ranges) = (String::new(), 0, Vec::new());
    for &id in here {
        let Fault { bytes, original, mutated, statement, .. } = &faults[id];
        out += &text[copied..bytes.start];
        let start = out.len();
        out += &if *statement {
            format!("if crate::mutant_switch::on({id}) {{ {mutated} }} else {{ {original} }}")
        } else {
            format!("(if crate::mutant_switch::on({id}) {{ ({mutated}) }} else {{ ({original}) }})")
        };
        ranges.push((id, start..out.len()));
        copied = bytes.end;
    }
    out += &text[copied..];
    *text = out;
    ranges
}

/// The module that is added to every crate with faults.
fn switch(faults: usize) -> String {
    format!(
        r#"
/// Whether a planted fault is on.
pub mod mutant_switch {{
    use std::sync::atomic::{{AtomicBool, AtomicUsize, Ordering::Relaxed}};

    const UNREAD: usize = usize::MAX;
    const RECORDS: usize = usize::MAX - 1;
    static ON: AtomicUsize = AtomicUsize::new(UNREAD);
    static REACHED: [AtomicBool; {faults}] = [const {{ AtomicBool::new(false) }}; {faults}];

    /// Whether the fault `id` is on.
    #[inline(always)]
    pub fn on(id: usize) -> bool {{
        let on = ON.load(Relaxed);
        on == id || on >= RECORDS && first(on, id)
    }}

    #[cold]
    fn first(on: usize, id: usize) -> bool {{
        if on == UNREAD {{
            let number = std::env::var("{SWITCH}").ok().and_then(|v| v.parse().ok());
            let records = std::env::var_os("{REACHED}").is_some();
            ON.store(number.unwrap_or(if records {{ RECORDS }} else {{ {faults} }}), Relaxed);
            return self::on(id);
        }}
        if !REACHED[id].load(Relaxed) && !REACHED[id].swap(true, Relaxed) {{
            let path = std::env::var_os("{REACHED}").expect("set");
            let mut file = std::fs::File::options().append(true).create(true).open(path).expect("a file");
            std::io::Write::write_all(&mut file, format!("{{id}}\n").as_bytes()).expect("written");
        }}
        false
    }}
}}
"#
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_stands_beside_what_it_replaces() {
        let fault = |bytes: Range<usize>, original: &str, mutated: &str, statement| Fault {
            package: String::new(),
            file: PathBuf::new(),
            line: 1,
            module: String::new(),
            bytes,
            original: original.into(),
            mutated: mutated.into(),
            statement,
        };
        let faults = [fault(7..8, "1", "2", false), fault(10..14, "f();", "", true)];
        let mut text = "let a =1; f();".to_owned();
        let ranges = rewrite(&mut text, &faults, &[0, 1]);
        assert_eq!(
            text,
            "let a =(if crate::mutant_switch::on(0) { (2) } else { (1) }); if crate::mutant_switch::on(1) {  } else { f(); }"
        );
        assert!(ranges.iter().all(|(id, r)| text[r.clone()].contains(&format!("on({id})"))));
    }
}
