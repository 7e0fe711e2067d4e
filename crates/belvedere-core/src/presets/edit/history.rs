//! Undo and redo.

use super::{EditError, PresetOperation};
use crate::presets::PresetDocument;

/// A document and what it was before: operations are undone and done again.
#[derive(Debug, Clone, PartialEq)]
pub struct PresetHistory {
    past: Vec<PresetDocument>,
    present: PresetDocument,
    future: Vec<PresetDocument>,
}

impl PresetHistory {
    /// Documents that are remembered.
    pub const DEPTH: usize = 256;

    /// A document without a past.
    pub fn new(document: PresetDocument) -> Self {
        Self { past: Vec::new(), present: document, future: Vec::new() }
    }

    /// The document as it is.
    pub fn document(&self) -> &PresetDocument {
        &self.present
    }

    /// Carries an operation out; what was undone before is forgotten.
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

    /// Takes the last operation back; `false` if there is none.
    pub fn undo(&mut self) -> bool {
        let Some(before) = self.past.pop() else { return false };
        self.future.push(std::mem::replace(&mut self.present, before));
        true
    }

    /// Does again what was undone last; `false` if there is nothing.
    pub fn redo(&mut self) -> bool {
        let Some(after) = self.future.pop() else { return false };
        self.past.push(std::mem::replace(&mut self.present, after));
        true
    }
}
