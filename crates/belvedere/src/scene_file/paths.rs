//! Which files a scene may name: those in its own folder or below, unless the user allows more.

use super::{Document, LayerDoc, PaletteDoc, PresetsDoc, StageDoc, names_a_preset_file};
use crate::BelvedereError;
use belvedere_io::{fs, join_table, split_table};
use std::path::{Component, Path, PathBuf};

impl Document {
    /// Calls `change` with every name of a file in the document; built-in scenes are no files.
    pub fn for_each_path(&mut self, change: &mut dyn FnMut(&mut String)) {
        let mut one = |name: &mut String| {
            if !name.starts_with("builtin:") {
                change(name);
            }
        };
        for layer in &mut self.layer {
            match layer {
                LayerDoc::Terrain(l) => {
                    l.source.each(&mut one);
                    l.drape.iter_mut().for_each(|drape| drape.each(&mut one));
                    if let PaletteDoc::File(name) = &mut l.style.palette {
                        one(name);
                    }
                }
                LayerDoc::Line(l) => l.source.iter_mut().for_each(|source| source.each(&mut one)),
                LayerDoc::Area(l) => l.source.each(&mut one),
                LayerDoc::Point(l) => l.source.each(&mut one),
                LayerDoc::Boxes(l) => l.source.iter_mut().chain(&mut l.motion).for_each(&mut one),
                LayerDoc::Mesh(l) => {
                    l.source.each(&mut one);
                    l.motion.iter_mut().for_each(&mut one);
                }
                LayerDoc::City(l) => l.source.each(&mut one),
                LayerDoc::Molecule(l) => one(&mut l.source),
                LayerDoc::Volume(l) => {
                    one(&mut l.source);
                    if names_a_document(&l.transfer) {
                        one(&mut l.transfer);
                    }
                }
            }
        }
        for stage in &mut self.stage {
            match stage {
                StageDoc::TerrainDisocclusion(stage) => stage.delta.iter_mut().for_each(&mut one),
                StageDoc::SplineBend(stage) => match &mut stage.presets {
                    PresetsDoc::Named(name) if names_a_preset_file(name) => one(name),
                    _ => {}
                },
                StageDoc::Strip(_) | StageDoc::Relief(_) | StageDoc::CurvedRays(_) => {}
            }
        }
        self.animation.iter_mut().filter_map(|a| a.camera.as_mut()).for_each(&mut one);
        let ids: Vec<&str> = self.layer.iter().map(LayerDoc::id).collect();
        let paths = self.constructor.iter_mut().filter_map(|c| c.path.as_mut());
        paths.filter(|path| !ids.contains(&path.as_str())).for_each(&mut one);
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
}

impl Roots {
    /// The file that a scene means by `name`.
    ///
    /// It is looked for beside the scene file, then (relative names) in each allowed folder. After links are
    /// followed it must lie in one of these folders. The table behind the name of a GeoPackage stays behind it.
    ///
    /// # Errors
    /// [`BelvedereError::Path`] if the name is refused or nothing is found.
    pub fn resolve(&self, name: &str) -> Result<PathBuf, BelvedereError> {
        let refused = |reason: String, root_missing: bool| BelvedereError::Path {
            name: super::doc_error::shorten(name),
            reason,
            root_missing,
        };
        let refuse = |reason: String| refused(reason, false);
        let outside = "use a path below that folder, or allow a folder";
        check_name(name).map_err(refuse)?;
        let (path, table) = split_table(Path::new(name));
        let leaves = path.is_absolute() || looks_absolute(name) || path.components().any(|c| c == Component::ParentDir);
        if leaves && self.allowed.is_empty() {
            return Err(refused(format!("leaves the folder of the scene file; {outside}"), true));
        }
        let bases = std::iter::once(&self.scene_dir).chain(self.allowed.iter().filter(|_| !path.is_absolute()));
        let Some(found) = bases.map(|base| base.join(path)).find(|p| fs::symlink_metadata(p).is_ok()) else {
            let folders: Vec<String> =
                std::iter::once(&self.scene_dir).chain(&self.allowed).map(|p| shown(p)).collect();
            let folders = folders.join(", ");
            return Err(refused(
                format!("is not there (looked in {folders}); check the name, or allow its folder"),
                true,
            ));
        };
        let real = fs::canonicalize(&found).map_err(|e| refuse(format!("cannot be followed: {e}; check the name")))?;
        let inside = std::iter::once(&self.scene_dir)
            .chain(&self.allowed)
            .filter_map(|base| fs::canonicalize(if base.as_os_str().is_empty() { Path::new(".") } else { base }).ok())
            .any(|base| real.starts_with(base));
        if !inside {
            let real = real.display();
            return Err(refused(format!("leads to {real}, outside the folder of the scene file; {outside}"), true));
        }
        match fs::metadata(&real) {
            Ok(meta) if meta.is_file() => Ok(join_table(real, table)),
            _ => Err(refuse("is not a regular file; give a file".into())),
        }
    }
}

fn shown(dir: &Path) -> String {
    if dir.as_os_str().is_empty() { ".".into() } else { dir.display().to_string() }
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
mod tests {
    use super::*;

    #[test]
    fn names_that_leave_the_folder_are_refused() {
        let roots = Roots { scene_dir: env!("CARGO_MANIFEST_DIR").into(), allowed: vec![] };
        for name in ["../belvedere-core/Cargo.toml", "src/../../x", "/etc/passwd", "C:\\x", "\\\\host\\x", "..\\x"] {
            let refused = roots.resolve(name).expect_err(name);
            assert!(matches!(refused, BelvedereError::Path { root_missing: true, .. }), "{name}: {refused}");
        }
        assert!(roots.resolve("Cargo.toml").is_ok());
        assert!(roots.resolve("src/lib.rs").is_ok());
    }

    #[test]
    fn addresses_and_devices_are_always_refused() {
        let roots = Roots { scene_dir: env!("CARGO_MANIFEST_DIR").into(), allowed: vec!["/".into()] };
        for name in [
            "file:///etc/passwd",
            "http://x/y.tif",
            "HTTPS://x",
            "s3:x",
            "CON",
            "a/nul.tif",
            "com1.txt",
            "",
            "a\0b",
            "src",
        ] {
            assert!(roots.resolve(name).is_err(), "{name:?} was accepted");
        }
        assert!(roots.resolve("/dev/zero").is_err());
    }

    #[test]
    fn an_allowed_root_is_searched_and_enough() {
        let dir = Path::new(env!("CARGO_MANIFEST_DIR"));
        let roots = Roots { scene_dir: dir.join("src"), allowed: vec![dir.to_owned()] };
        assert_eq!(roots.resolve("Cargo.toml").ok(), dir.join("Cargo.toml").canonicalize().ok());
        assert!(roots.resolve("../Cargo.toml").is_ok());
        assert!(roots.resolve("../../belvedere-core/Cargo.toml").is_err());
    }
}
