//! Which files a scene may name: those in its own folder or below, unless the user allows more.

use super::{Document, LayerDoc, PaletteDoc, Paths, PresetsDoc, StageDoc, SymbolDoc, names_a_preset_file};
use crate::DocumentError;
use belvedere_io::{arrays, fs, join_table, split_table};
use std::path::{Component, Path, PathBuf};

impl LayerDoc {
    /// Files and built-in names that the layer's data come from.
    pub fn files(&self) -> Vec<&str> {
        fn of(paths: &Paths) -> Vec<&str> {
            paths.as_slice().iter().map(String::as_str).collect()
        }
        match self {
            Self::Terrain(l) => {
                let beside = [&l.drape, &l.land_cover].into_iter().flatten().flat_map(of);
                of(&l.source).into_iter().chain(beside).collect()
            }
            Self::Line(l) => l.source.as_ref().map(of).unwrap_or_default(),
            Self::Area(l) => of(&l.source),
            Self::Point(l) => of(&l.source),
            Self::City(l) => of(&l.source),
            _ => Vec::new(),
        }
    }
}

impl Document {
    /// Calls `change` with every name of a file in the document; built-in scenes and arrays are no files.
    pub fn for_each_path(&mut self, change: &mut dyn FnMut(&mut String)) {
        self.for_each_source(&mut |name| {
            if !name.starts_with("builtin:") && !arrays::is_name(name) {
                change(name);
            }
        });
    }

    /// Calls `change` with every name of an array in memory, `array:NAME`.
    pub fn for_each_array(&mut self, change: &mut dyn FnMut(&mut String)) {
        self.for_each_source(&mut |name| {
            if arrays::is_name(name) {
                change(name);
            }
        });
    }

    fn for_each_source(&mut self, mut one: &mut dyn FnMut(&mut String)) {
        for layer in &mut self.layer {
            match layer {
                LayerDoc::Terrain(l) => {
                    l.source.each(&mut one);
                    let beside = l.drape.iter_mut().chain(&mut l.land_cover);
                    beside.for_each(|files| files.each(&mut one));
                    if let PaletteDoc::File(name) = &mut l.style.palette {
                        one(name);
                    }
                }
                LayerDoc::Line(l) => l.source.iter_mut().for_each(|source| source.each(&mut one)),
                LayerDoc::Area(l) => l.source.each(&mut one),
                LayerDoc::Point(l) => {
                    l.source.each(&mut one);
                    if let SymbolDoc::File(name) = &mut l.style.symbol {
                        one(name);
                    }
                }
                LayerDoc::Boxes(l) => l.source.iter_mut().chain(&mut l.motion).for_each(&mut one),
                LayerDoc::Mesh(l) => {
                    l.source.each(&mut one);
                    l.motion.iter_mut().for_each(&mut one);
                }
                LayerDoc::City(l) => l.source.each(&mut one),
                LayerDoc::Molecule(l) => {
                    one(&mut l.source);
                    l.trajectory.iter_mut().chain(&mut l.motion).for_each(&mut one);
                }
                LayerDoc::Volume(l) => {
                    one(&mut l.source);
                    if names_a_document(&l.transfer) {
                        one(&mut l.transfer);
                    }
                }
            }
        }
        let ids: Vec<String> = self.layer.iter().map(|layer| layer.id().to_owned()).collect();
        for stage in &mut self.stage {
            match stage {
                StageDoc::Tube(stage) => stage.path.iter_mut().filter(|path| !ids.contains(path)).for_each(&mut one),
                StageDoc::TerrainDisocclusion(stage) => stage.delta.iter_mut().for_each(&mut one),
                StageDoc::SplineBend(stage) => match &mut stage.presets {
                    PresetsDoc::Named(name) if names_a_preset_file(name) => one(name),
                    _ => {}
                },
                StageDoc::GroundMoves(_)
                | StageDoc::Strip(_)
                | StageDoc::Unroll(_)
                | StageDoc::Relief(_)
                | StageDoc::CurvedRays(_) => {}
            }
        }
        self.text.iter_mut().filter_map(|text| text.fonts.as_mut()).for_each(|fonts| fonts.each(&mut one));
        self.animation.iter_mut().filter_map(|a| a.camera.as_mut()).for_each(&mut one);
        let paths = self.constructor.iter_mut().filter_map(|c| c.path.as_mut());
        paths.filter(|path| !ids.contains(path)).for_each(&mut one);
    }
}

/// Whether a name that may also be one of a built-in thing means a document.
fn names_a_document(name: &str) -> bool {
    let small = name.to_lowercase();
    small.ends_with(".toml") || small.ends_with(".json")
}

/// Where the files of a scene may lie.
#[derive(Debug, Clone, Default)]
pub struct Roots {
    /// Folder of the scene file.
    pub scene_dir: PathBuf,
    /// Folders that the user allowed.
    pub allowed: Vec<PathBuf>,
    /// Single files that the user allowed, as canonical paths.
    pub files: Vec<PathBuf>,
}

impl Roots {
    /// The file that a scene means by `name`.
    ///
    /// It is looked for beside the scene file, then (relative names) in each allowed folder, then among the allowed
    /// files. After links are followed it must lie in one of these folders or be one of these files. The table behind the name of a
    /// GeoPackage stays behind it.
    ///
    /// # Errors
    /// [`DocumentError::Path`] if the name is refused or nothing is found.
    pub fn resolve(&self, name: &str) -> Result<PathBuf, DocumentError> {
        self.find_of(name, "is not a regular file; give a file", fs::Metadata::is_file)
    }

    /// As [`Self::resolve`], also a folder, such as one of slices.
    ///
    /// # Errors
    /// As [`Self::resolve`].
    pub fn resolve_or_folder(&self, name: &str) -> Result<PathBuf, DocumentError> {
        let is_either = |meta: &fs::Metadata| meta.is_file() || meta.is_dir();
        self.find_of(name, "is neither a regular file nor a folder; give one of them", is_either)
    }

    /// * `otherwise`: the refusal of what `is_wanted` does not hold for.
    fn find_of(
        &self,
        name: &str,
        otherwise: &str,
        is_wanted: impl Fn(&fs::Metadata) -> bool,
    ) -> Result<PathBuf, DocumentError> {
        let refused = |reason: String, root_missing: bool| DocumentError::Path {
            name: super::doc_error::shorten(name),
            reason,
            root_missing,
        };
        let refuse = |reason: String| refused(reason, false);
        let outside = "use a path below that folder, or allow a folder";
        check_name(name).map_err(refuse)?;
        let (path, table) = split_table(Path::new(name));
        // Without anything that is allowed the answer does not depend on whether the file exists.
        if leaves(path, name) && self.allowed.is_empty() && !self.allows_file(path) {
            return Err(refused(format!("leaves the folder of the scene file; {outside}"), true));
        }
        let Some(found) = self.find(path) else {
            let folders: Vec<String> =
                std::iter::once(&self.scene_dir).chain(&self.allowed).map(|p| shown(p)).collect();
            let folders = folders.join(", ");
            return Err(refused(
                format!("is not there (looked in {folders}); check the name, or allow its folder"),
                true,
            ));
        };
        let real = fs::canonicalize(&found).map_err(|e| refuse(format!("cannot be followed: {e}; check the name")))?;
        if !self.contains(&real) && !self.files.contains(&real) {
            let real = real.display();
            return Err(refused(format!("leads to {real}, outside the folder of the scene file; {outside}"), true));
        }
        match fs::metadata(&real) {
            Ok(meta) if is_wanted(&meta) => Ok(join_table(self.as_named(&found, &real).unwrap_or(real), table)),
            _ => Err(refuse(otherwise.into())),
        }
    }

    /// A link by its own name, so that the files beside it are found (`dem.prj` beside `dem.asc`); `None` unless both its folder and the folder
    /// or store in which the file lies, with what may belong to it, are among those of the scene.
    fn as_named(&self, found: &Path, real: &Path) -> Option<PathBuf> {
        let named = folder_of(found).join(found.file_name()?);
        let is_own = named != real && self.contains(named.parent()?) && self.contains(&fs::shelf(real));
        is_own.then_some(named)
    }

    /// The file that a scene means by `name`, wherever it lies, as a canonical path without its table: to ask the user whether it may be
    /// read. `None` if it is not there, or if its name is one that nothing allows.
    pub fn locate(&self, name: &str) -> Option<PathBuf> {
        check_name(name).ok()?;
        let real = fs::canonicalize(self.find(split_table(Path::new(name)).0)?).ok()?;
        fs::metadata(&real).is_ok_and(|meta| meta.is_file()).then_some(real)
    }

    /// Whether a canonical path lies in the folder of the scene.
    pub fn is_beside(&self, real: &Path) -> bool {
        fs::canonicalize(or_here(&self.scene_dir)).is_ok_and(|folder| real.starts_with(folder))
    }

    /// Whether a canonical path lies in the folder of the scene or an allowed one.
    fn contains(&self, real: &Path) -> bool {
        let allowed = |folder: &PathBuf| fs::canonicalize(or_here(folder)).is_ok_and(|folder| real.starts_with(folder));
        self.is_beside(real) || self.allowed.iter().any(allowed)
    }

    fn allows_file(&self, path: &Path) -> bool {
        !self.files.is_empty()
            && fs::canonicalize(self.scene_dir.join(path)).is_ok_and(|real| self.files.contains(&real))
    }

    /// The first file of that name, without regard to where links lead.
    fn find(&self, path: &Path) -> Option<PathBuf> {
        let bases = std::iter::once(&self.scene_dir).chain(self.allowed.iter().filter(|_| !path.is_absolute()));
        let found = bases.map(|base| base.join(path)).find(|p| fs::symlink_metadata(p).is_ok());
        // A name that was found in an allowed folder when its file was allowed.
        found.or_else(|| self.files.iter().find(|file| !path.is_absolute() && file.ends_with(path)).cloned())
    }
}

/// Whether a name leads out of the folder that it is relative to.
fn leaves(path: &Path, name: &str) -> bool {
    path.is_absolute() || looks_absolute(name) || path.components().any(|c| c == Component::ParentDir)
}

/// Whether a name stays below the folder that it is relative to.
pub fn stays_below(name: &str) -> bool {
    !leaves(split_table(Path::new(name)).0, name)
}

/// The file `to` as a name seen from the folder `from`, both canonical: with `/`, and `..` upwards. `None` if they lie on
/// different drives, or if a part of the name is not UTF-8.
pub fn relative(from: &Path, to: &Path) -> Option<String> {
    let (from, to): (Vec<_>, Vec<_>) = (from.components().collect(), to.components().collect());
    let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    // In memory, as in a browser, paths have no root.
    let is_same_drive = common > 0 || matches!(from.first(), Some(Component::Normal(_)) | None);
    if to.len() == common || !is_same_drive {
        return None;
    }
    let up = from[common..].iter().map(|_| Some(".."));
    let down = to[common..].iter().map(|part| match part {
        Component::Normal(part) => part.to_str(),
        _ => None,
    });
    let name = up.chain(down).collect::<Option<Vec<&str>>>()?.join("/");
    // A colon in the first part would be read as a drive or an address.
    let first = name.split('/').next().unwrap_or_default();
    Some(if first.contains(':') { format!("./{name}") } else { name })
}

impl Document {
    /// The same for a scene file in `folder` (canonical): files are named relative to it wherever that is possible. Names that lead to no
    /// file stay as they are.
    ///
    /// * `roots`: where the files lie now.
    pub fn seen_from(&self, folder: &Path, roots: &Roots) -> Self {
        let moves = roots.scene_dir.as_os_str().is_empty()
            || fs::canonicalize(&roots.scene_dir).ok().as_deref() != Some(folder);
        let mut document = self.clone();
        document.for_each_path(&mut |name| {
            let beside = || fs::symlink_metadata(roots.scene_dir.join(split_table(Path::new(name.as_str())).0));
            if !moves && stays_below(name) && beside().is_ok() {
                return;
            }
            let Ok(file) = roots.resolve(name) else { return };
            let (file, table) = split_table(&file);
            let file = relative(folder, file).map_or_else(|| file.to_owned(), PathBuf::from);
            if let Some(new) = join_table(file, table).to_str() {
                new.clone_into(name);
            }
        });
        document
    }
}

/// The folder of a file, as an absolute path if possible.
pub fn folder_of(path: &Path) -> PathBuf {
    let folder = or_here(path.parent().unwrap_or(Path::new("")));
    fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned())
}

fn shown(dir: &Path) -> String {
    or_here(dir).display().to_string()
}

fn or_here(dir: &Path) -> &Path {
    if dir.as_os_str().is_empty() { Path::new(".") } else { dir }
}

/// Refusals that no option lifts.
fn check_name(name: &str) -> Result<(), String> {
    if name.is_empty() {
        return Err("is empty; give the path of a file".into());
    }
    if name.chars().any(char::is_control) {
        return Err("holds a control character; give a plain path".into());
    }
    let lower = name.to_lowercase();
    let scheme = lower
        .split_once(':')
        .map(|(s, _)| s)
        .filter(|s| s.len() > 1 && s.bytes().all(|b| b.is_ascii_alphanumeric() || b"+-.".contains(&b)));
    if arrays::is_name(name) {
        return Err("names an array in memory where a file is needed; give the path of a file".into());
    }
    if let Some(scheme) = scheme {
        return Err(format!("is a {scheme}: address; download it and give the path of the file"));
    }
    for part in name.split(['/', '\\']) {
        if is_device(part) {
            return Err(format!("names the device {part}; give the path of a file"));
        }
    }
    Ok(())
}

/// Windows roots and drives, whatever the system we run on.
fn looks_absolute(name: &str) -> bool {
    name.starts_with(['/', '\\']) || name.as_bytes().get(1) == Some(&b':') || name.split(['/', '\\']).any(|p| p == "..")
}

fn is_device(part: &str) -> bool {
    let stem = part.split('.').next().unwrap_or(part).trim_end().to_ascii_uppercase();
    let numbered = |prefix: &str| {
        stem.strip_prefix(prefix)
            .is_some_and(|n| n.chars().count() == 1 && n.chars().all(|c| "0123456789¹²³".contains(c)))
    };
    ["CON", "PRN", "AUX", "NUL", "CONIN$", "CONOUT$", "CLOCK$"].contains(&stem.as_str())
        || numbered("COM")
        || numbered("LPT")
}

#[cfg(test)]
mod tests;
