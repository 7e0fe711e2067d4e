//! Documents with the places of their files.

use crate::scene_file::paths::{Roots, folder_of};
use crate::scene_file::{self, Document, SourceDocument};
use crate::{BelvedereError, OpenOptions, Session, Trust};
use belvedere_scene::Progress;
use std::path::{Path, PathBuf};

/// Paths of a document and its files.
#[derive(Debug, Clone, Default)]
pub struct Place {
    /// The scene file; `None` if it was never saved.
    pub scene: Option<PathBuf>,
    /// Folders that its files may lie in.
    pub roots: Roots,
}

impl Place {
    /// The session of a document in this place, as the command line opens it. If the scene file holds the same document, it is among the
    /// inputs.
    ///
    /// # Errors
    /// As [`Session::from_document`].
    pub fn session(&self, document: Document, progress: &Progress) -> Result<Session, BelvedereError> {
        let file = self.scene.as_deref().and_then(|path| scene_file::read(path).ok());
        let source = file.filter(|file| file.document == document);
        Session::from_document(source.unwrap_or_else(|| SourceDocument::new(document)), &self.options(progress))
    }

    /// Options that open a document in this place.
    pub(crate) fn options(&self, progress: &Progress) -> OpenOptions {
        let folder = Some(&self.roots.scene_dir).filter(|dir| !dir.as_os_str().is_empty());
        OpenOptions {
            allow_roots: folder.into_iter().chain(&self.roots.allowed).cloned().collect(),
            allow_files: self.roots.files.clone(),
            progress: progress.clone(),
            ..OpenOptions::default()
        }
    }
}

/// A document with its place.
#[derive(Debug, Clone)]
pub struct PlacedDocument {
    /// The document.
    pub document: Document,
    /// Path of its file, and folders of its files.
    pub place: Place,
    /// Text of the scene file; `None` if the document is in no file.
    pub text: Option<String>,
}

impl PlacedDocument {
    /// Reads a scene file, with the consent that was given to it.
    ///
    /// * `allowed`: folders beside that of the scene from which its files may come.
    ///
    /// # Errors
    /// As [`scene_file::read`].
    pub fn read(path: &Path, allowed: Vec<PathBuf>, trust: &Trust) -> Result<Self, BelvedereError> {
        let (source, text) = scene_file::read_with_text(path)?;
        let roots = Roots { scene_dir: folder_of(path), allowed, files: trust.files_of(path) };
        let place = Place { scene: Some(path.to_owned()), roots };
        Ok(Self { document: source.document, place, text: Some(text) })
    }
}
