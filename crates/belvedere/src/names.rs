//! Names of files in outputs: pictures, records and reports travel, and say nothing about the machine they were made on.

use crate::record::InputFile;
use crate::scene_file::Document;
use crate::scene_file::paths::{Roots, relative, stays_below};
use belvedere_core::Warning;
use belvedere_io::{fs, join_table, split_table};
use std::path::{Path, PathBuf};

/// The name of every file that was read, as outputs give it: as the scene names it or relative to the folder of the scene where it lies
/// below, else the bare name, with as many folders before it as tell it from others. A hash stands beside every name.
#[derive(Debug, Clone, Default)]
pub(crate) struct PublicNames {
    /// Paths as they were read, and names.
    known: Vec<(PathBuf, String)>,
    /// Paths in texts and what stands for them, the longest first.
    texts: Vec<(String, String)>,
}

impl PublicNames {
    /// * `scene_dir`: folder of the scene file; `None` without one. `named`: files that a scene names relatively, and these names.
    ///   `files`: paths of the files as they were read.
    pub(crate) fn new(scene_dir: Option<&Path>, named: Vec<(PathBuf, String)>, files: &[PathBuf]) -> Self {
        let folder = scene_dir.and_then(|dir| fs::canonicalize(dir).ok());
        let mut known: Vec<(PathBuf, String)> = Vec::new();
        let mut bare = Vec::new();
        for path in files {
            let real = fs::canonicalize(path).unwrap_or_else(|_| path.clone());
            let below = folder.as_ref().filter(|folder| real.starts_with(folder)).and_then(|f| relative(f, &real));
            let written = named.iter().find(|(file, _)| *file == real).map(|(_, name)| name.clone());
            match written.or(below) {
                Some(name) => known.push((path.clone(), name)),
                None => bare.push((path.clone(), real)),
            }
        }
        let reals: Vec<&PathBuf> = bare.iter().map(|(_, real)| real).collect();
        let mut short: Vec<(PathBuf, String)> =
            bare.iter().map(|(path, real)| (path.clone(), shortest(real, &reals))).collect();
        let same = short.iter().zip(&bare).filter(|((path, _), (_, real))| path != real);
        let same: Vec<_> = same.map(|((_, name), (_, real))| (real.clone(), name.clone())).collect();
        known.append(&mut short);
        known.extend(same);
        let folders = known.iter().filter_map(|(path, _)| path.parent()).chain(folder.as_deref());
        let folders = folders.filter(|folder| folder.is_absolute() && folder.components().count() > 1);
        let separated = |folder: &Path| folder.display().to_string() + std::path::MAIN_SEPARATOR_STR;
        let folders = folders.map(|folder| (separated(folder), String::new()));
        let mut texts: Vec<(String, String)> =
            known.iter().map(|(path, name)| (path.display().to_string(), name.clone())).chain(folders).collect();
        texts.sort_by(|a, b| b.0.len().cmp(&a.0.len()).then_with(|| a.cmp(b)));
        texts.dedup();
        Self { known, texts }
    }

    /// The name of a file.
    pub(crate) fn file(&self, path: &Path) -> String {
        let known = |path: &Path| self.known.iter().find(|(file, _)| file == path).map(|(_, name)| name.clone());
        let bare = || path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        known(path).or_else(|| known(&fs::canonicalize(path).ok()?)).unwrap_or_else(bare)
    }

    /// The records of files under these names.
    pub(crate) fn inputs(&self, inputs: &[InputFile]) -> Vec<InputFile> {
        inputs.iter().map(|input| InputFile { path: self.file(&input.path).into(), ..input.clone() }).collect()
    }

    /// A text with these names in place of the paths.
    pub(crate) fn text(&self, text: &str) -> String {
        self.texts.iter().fold(text.to_owned(), |text, (path, name)| replaced(&text, path, name))
    }

    /// Warnings with these names in place of the paths.
    pub(crate) fn warnings(&self, warnings: &[Warning]) -> Vec<Warning> {
        warnings.iter().map(|warning| self.warning(warning).unwrap_or_else(|| warning.clone())).collect()
    }

    fn warning(&self, warning: &Warning) -> Option<Warning> {
        let mut value = serde_json::to_value(warning).ok()?;
        for key in ["text", "subject"] {
            if let Some(text) = value.get(key).and_then(|text| text.as_str()).map(|text| self.text(text)) {
                value[key] = text.into();
            }
        }
        serde_json::from_value(value).ok()
    }

    /// A document with these names: it opens where its files lie beside it, or in a folder that is allowed.
    pub(crate) fn document(&self, document: &Document, roots: &Roots) -> Document {
        let mut document = document.clone();
        document.for_each_path(&mut |name| {
            if !stays_below(name) {
                let file = roots.resolve(name).unwrap_or_else(|_| PathBuf::from(name.as_str()));
                let (file, table) = split_table(&file);
                *name = join_table(self.file(file).into(), table).to_string_lossy().into_owned();
            }
        });
        document
    }
}

/// The end of a path that tells it from the others: its name, with folders before it where others have the same name. The name of a
/// user is not told: where only that would tell two files apart a number stands for their folders.
fn shortest(path: &Path, all: &[&PathBuf]) -> String {
    let parts: Vec<_> = path.components().collect();
    let end = |n: usize| parts[parts.len() - n.min(parts.len())..].iter().collect::<PathBuf>();
    let is_its_own = |n: &usize| all.iter().filter(|other| **other != path && other.ends_with(end(*n))).count() == 0;
    let told = parts.len().saturating_sub(of_a_user(path)).max(1);
    let n = (1..=told).filter(|n| *n < parts.len().max(2)).find(is_its_own);
    let names: Vec<String> =
        end(n.unwrap_or(1)).components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
    let name = names.join("/");
    let same = |other: &&&PathBuf| other.file_name() == path.file_name();
    let number = all.iter().filter(same).position(|other| *other == path).filter(|_| n.is_none());
    number.map_or(name.clone(), |number| format!("{}/{name}", number + 1))
}

/// Number of the first parts of a path up to the name of a user.
fn of_a_user(path: &Path) -> usize {
    let homes = ["home", "users"];
    let parts = path.components().map(|part| part.as_os_str().to_string_lossy().to_lowercase());
    let by_name = parts.take(4).position(|part| homes.contains(&part.as_str())).map_or(0, |at| at + 2);
    let home = ["HOME", "USERPROFILE"].iter().find_map(std::env::var_os).map(PathBuf::from);
    let own = home.filter(|home| path.starts_with(home)).map_or(0, |home| home.components().count());
    by_name.max(own)
}

/// `text` with `name` in place of `path` wherever a path can begin.
fn replaced(text: &str, path: &str, name: &str) -> String {
    if path.is_empty() {
        return text.to_owned();
    }
    let (mut out, mut rest) = (String::with_capacity(text.len()), text);
    while let Some(at) = rest.find(path) {
        let before = rest[..at].chars().next_back().or_else(|| out.chars().next_back());
        let begins = before.is_none_or(|c| !c.is_alphanumeric() && !"._-/\\".contains(c));
        out += &rest[..at];
        out += if begins { name } else { path };
        rest = &rest[at + path.len()..];
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_core::WarningKind;

    #[test]
    fn files_are_named_from_the_scene_or_barely() {
        let dir = tempfile::tempdir().expect("folder");
        let root = dir.path().canonicalize().expect("folder");
        let [scene, a, b, c] = ["scene", "scene/sub", "one", "two"].map(|name| root.join(name));
        [&scene, &a, &b, &c].into_iter().for_each(|folder| std::fs::create_dir_all(folder).expect("folder"));
        let files = [scene.join("s.toml"), a.join("x.tif"), b.join("x.tif"), c.join("x.tif"), c.join("y.tif")];
        files.iter().for_each(|file| std::fs::write(file, "").expect("file"));
        let names = PublicNames::new(Some(&scene), Vec::new(), &files);
        let found: Vec<String> = files.iter().map(|file| names.file(file)).collect();
        assert_eq!(found, ["s.toml", "sub/x.tif", "one/x.tif", "two/x.tif", "y.tif"]);
        assert_eq!(names.file(&scene.join("../two/y.tif")), "y.tif");
        assert_eq!(names.file(Path::new("/elsewhere/z.tif")), "z.tif");
        let text = format!("layer \"g\": {}: 3 holes; {} has no .prj", files[4].display(), c.join("z.shp").display());
        let warning = Warning::new(WarningKind::Ignored, text).about(files[4].display().to_string()).with("count", 3.0);
        let [said] = &names.warnings(&[warning])[..] else { panic!("one warning") };
        assert_eq!((said.text(), said.subject()), ("layer \"g\": y.tif: 3 holes; z.shp has no .prj", Some("y.tif")));
        assert_eq!(said.kind(), WarningKind::Ignored);
    }

    #[test]
    fn names_of_users_are_not_told() {
        let all =
            ["/home/ann/dem.tif", "/home/bob/dem.tif", "/home/bob/a/dem.tif", "/Users/eve/dem.tif", "/data/dem.tif"];
        let all = all.map(PathBuf::from);
        let all: Vec<&PathBuf> = all.iter().collect();
        let names: Vec<String> = all.iter().map(|path| shortest(path, &all)).collect();
        assert_eq!(names, ["1/dem.tif", "2/dem.tif", "a/dem.tif", "4/dem.tif", "data/dem.tif"]);
    }

    #[test]
    fn paths_are_replaced_where_they_begin() {
        assert_eq!(replaced("a /x/y, b/x/y: '/x/y'", "/x/y", "y"), "a y, b/x/y: 'y'");
    }
}
