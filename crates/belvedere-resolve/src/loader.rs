//! State and helpers common to reading all layers: files, built-in scenes, warnings, errors with their line.

use super::builtin;
use super::color::{color, optional_color};
use crate::city_ground::OwnGround;
use crate::record::AreaRecord;
use crate::{BelvedereError, OpenOptions};
use belvedere_core::Warning;
use belvedere_document::paths::Roots;
use belvedere_document::{LayerDoc, Origin, Paths};
use belvedere_io::arrays::{self, Array};
use belvedere_io::terrain::OriginalTerrain;
use belvedere_io::vector::Vectors;
use belvedere_io::{CityFile, InputFile, IoError, Loaded};
use belvedere_overlay::notes::LayerNotes;
use belvedere_scene::{Color, Drawing, LayerKind};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Inputs of reading layers, and its records.
pub(super) struct Loader<'a> {
    pub(super) origin: &'a Origin,
    pub(super) layers: &'a [LayerDoc],
    pub(super) roots: &'a Roots,
    pub(super) options: &'a OpenOptions,
    pub(super) builtins: builtin::Builtins,
    pub(super) inputs: Vec<InputFile>,
    pub(super) warnings: Vec<Warning>,
    /// Surfaces found for areas.
    pub(super) areas: Vec<AreaRecord>,
    /// What furniture tells of the layers.
    pub(super) notes: LayerNotes,
    /// Vector files that were read already.
    pub(super) vectors: BTreeMap<PathBuf, Loaded<Vectors>>,
    /// Cities that were read already, by the number of their layer.
    pub(super) cities: BTreeMap<usize, Vec<CityFile>>,
    /// Ground of the cities where there is no terrain, which features without heights lie on, too.
    pub(super) own_ground: Option<OwnGround>,
    /// Whether to keep the unchanged samples of the terrain's file, and these samples.
    pub(super) keep_original: bool,
    pub(super) original: Option<OriginalTerrain>,
    /// Symbols of the scene's own, by their numbers.
    pub(super) drawings: Vec<Arc<Drawing>>,
    /// Whether heights below names are written in feet.
    pub(super) in_feet: bool,
}

impl Loader<'_> {
    /// An error at a key of layer `index`.
    pub(super) fn fail(&self, index: usize, key: &str, reason: impl std::fmt::Display) -> BelvedereError {
        self.origin.error(&["layer", &index.to_string(), key], format!("layer \"{}\": {reason}", self.id(index))).into()
    }

    /// The path of a file that a key names.
    pub(super) fn file(&self, index: usize, key: &str, name: &str) -> Result<PathBuf, BelvedereError> {
        let about = format!("layer \"{}\": ", self.id(index));
        Ok(self.roots.resolve(name).map_err(|e| self.origin.refusal(&["layer", &index.to_string(), key], &about, e))?)
    }

    /// The file or the array (`array:NAME`) that the source of a layer names.
    pub(super) fn source(&self, index: usize, name: &str) -> Result<PathBuf, BelvedereError> {
        if arrays::is_name(name) { Ok(PathBuf::from(name)) } else { self.file(index, "source", name) }
    }

    /// As [`Self::source`], also a folder.
    pub(super) fn source_or_folder(&self, index: usize, name: &str) -> Result<PathBuf, BelvedereError> {
        if arrays::is_name(name) {
            return Ok(PathBuf::from(name));
        }
        let about = format!("layer \"{}\": ", self.id(index));
        let found = self.roots.resolve_or_folder(name);
        Ok(found.map_err(|e| self.origin.refusal(&["layer", &index.to_string(), "source"], &about, e))?)
    }

    /// The files and arrays that the source of a layer names.
    pub(super) fn sources(&self, index: usize, paths: &Paths) -> Result<Vec<PathBuf>, BelvedereError> {
        self.some(index, "source", paths)?.iter().map(|name| self.source(index, name)).collect()
    }

    /// As [`Self::sources`], also folders.
    pub(super) fn sources_or_folders(&self, index: usize, paths: &Paths) -> Result<Vec<PathBuf>, BelvedereError> {
        self.some(index, "source", paths)?.iter().map(|name| self.source_or_folder(index, name)).collect()
    }

    /// The value of an array; keeps its record.
    pub(super) fn of_array<T>(&mut self, index: usize, array: &Array, loaded: Loaded<T>) -> T {
        self.take(index, loaded.with_file(array.record().clone()))
    }

    /// An error in words, in which files of the scene's folder are named relative to it.
    pub(super) fn shown(&self, error: &dyn std::fmt::Display) -> String {
        let text = error.to_string();
        let folder = match self.roots.scene_dir.as_os_str().is_empty() {
            true => belvedere_io::fs::canonicalize(Path::new(".")),
            false => belvedere_io::fs::canonicalize(&self.roots.scene_dir),
        };
        match folder {
            Ok(folder) => text.replacen(&format!("{}{}", folder.display(), std::path::MAIN_SEPARATOR), "", 1),
            Err(_) => text,
        }
    }

    /// The error of a file of a layer, with the line of the document that names the file.
    pub(super) fn in_layer(&self, index: usize, error: BelvedereError) -> BelvedereError {
        let BelvedereError::Io(io @ (IoError::Format { .. } | IoError::Os { .. })) = error else { return error };
        if self.origin.is_memory() {
            return io.into();
        }
        let about = format!("layer \"{}\": {}", self.id(index), self.shown(&io));
        self.origin.caused(&["layer", &index.to_string(), "source"], about, io.into()).into()
    }

    pub(super) fn id(&self, index: usize) -> &str {
        self.layers.get(index).map_or("", LayerDoc::id)
    }

    /// Result of `pick` on a layer of a built-in scene.
    pub(super) fn builtin<T>(
        &mut self,
        index: usize,
        name: &str,
        pick: impl Fn(&LayerKind) -> Option<T>,
    ) -> Result<T, BelvedereError> {
        let found = self.builtins.find(name, self.options.seed, pick);
        found.map_err(|e| self.fail(index, "source", e))
    }

    /// The files that a key names.
    pub(super) fn files(&self, index: usize, key: &str, paths: &Paths) -> Result<Vec<PathBuf>, BelvedereError> {
        self.some(index, key, paths)?.iter().map(|name| self.file(index, key, name)).collect()
    }

    fn some<'p>(&self, index: usize, key: &str, paths: &'p Paths) -> Result<&'p [String], BelvedereError> {
        match paths.as_slice() {
            [] => Err(self.fail(index, key, format!("{key} is an empty list; name at least one file"))),
            names => Ok(names),
        }
    }

    /// The value read for a layer; keeps its warnings and files.
    pub(super) fn take<T>(&mut self, index: usize, loaded: Loaded<T>) -> T {
        self.note(index, loaded.warnings);
        self.inputs.extend(loaded.files);
        loaded.value
    }

    /// Keeps warnings, about their layer, whose id stands first.
    pub(super) fn note(&mut self, index: usize, warnings: impl IntoIterator<Item = Warning>) {
        let id = self.layers.get(index).map_or("", LayerDoc::id);
        self.warnings.extend(warnings.into_iter().map(|w| w.placed(format_args!("layer \"{id}\"")).about(id)));
    }

    pub(super) fn color(&self, index: usize, text: &str) -> Result<Color, BelvedereError> {
        color("color", text).map_err(|(key, reason)| self.fail(index, key, reason))
    }

    pub(super) fn optional_color(&self, index: usize, text: &str) -> Result<Option<Color>, BelvedereError> {
        optional_color("casing", text).map_err(|(key, reason)| self.fail(index, key, reason))
    }
}
