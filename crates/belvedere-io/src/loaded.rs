//! Result of a loader.

use crate::InputFile;
use belvedere_core::Warning;

/// A value, the warnings of reading it, and the files that were read.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded<T> {
    /// The value.
    pub value: T,
    /// One sentence each: the oddity, its measured value, and how it was handled.
    pub warnings: Vec<Warning>,
    /// The files that were read for it, by the same reading.
    pub files: Vec<InputFile>,
}

impl<T> Loaded<T> {
    /// A value without warnings.
    pub fn clean(value: T) -> Self {
        Self::new(value, Vec::new())
    }

    /// A value with warnings.
    pub fn new(value: T, warnings: Vec<Warning>) -> Self {
        Self { value, warnings, files: Vec::new() }
    }

    /// Adds a file that was read for the value.
    pub fn with_file(mut self, file: InputFile) -> Self {
        self.files.push(file);
        self
    }

    /// Applies `f` to the value, keeping the rest.
    pub fn map<U>(self, f: impl FnOnce(T) -> U) -> Loaded<U> {
        Loaded { value: f(self.value), warnings: self.warnings, files: self.files }
    }
}
