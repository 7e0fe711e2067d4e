//! Undo and redo.

use super::{EditError, PresetOperation};
use crate::presets::PresetDocument;

/// A preset document with undo and redo.
#[derive(Debug, Clone, PartialEq)]
pub struct PresetHistory {
    past: Vec<PresetDocument>,
    present: PresetDocument,
    future: Vec<PresetDocument>,
}

impl PresetHistory {
    /// Most undo steps.
    pub const DEPTH: usize = 256;

    /// Starts a history with `document`.
    pub fn new(document: PresetDocument) -> Self {
        Self { past: Vec::new(), present: document, future: Vec::new() }
    }

    /// The document as it is.
    pub fn document(&self) -> &PresetDocument {
        &self.present
    }

    /// Applies an operation and clears the redo steps.
    ///
    /// # Errors
    /// Every [`EditError`]; then nothing changes.
    pub fn apply(&mut self, operation: &PresetOperation) -> Result<(), EditError> {
        let next = self.present.edited(operation)?;
        self.past.push(std::mem::replace(&mut self.present, next));
        if self.past.len() > Self::DEPTH {
            self.past.remove(0);
        }
        self.future.clear();
        Ok(())
    }

    /// Undoes the last operation; `false` if there is nothing to undo.
    pub fn undo(&mut self) -> bool {
        let Some(before) = self.past.pop() else { return false };
        self.future.push(std::mem::replace(&mut self.present, before));
        true
    }

    /// Redoes the operation undone last; `false` if there is nothing to redo.
    pub fn redo(&mut self) -> bool {
        let Some(after) = self.future.pop() else { return false };
        self.past.push(std::mem::replace(&mut self.present, after));
        true
    }
}
