//! What a loader returns.

use crate::InputFile;

/// A value, the warnings of reading it, and what was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded<T> {
    /// The value.
    pub value: T,
    /// One sentence each: what was odd, measured value, what was done about it.
    pub warnings: Vec<String>,
    /// The files that were read for it, by the same reading.
    pub files: Vec<InputFile>,
}

impl<T> Loaded<T> {
    /// A value without warnings.
    pub fn clean(value: T) -> Self {
        Self::new(value, Vec::new())
    }

    /// A value with warnings.
    pub fn new(value: T, warnings: Vec<String>) -> Self {
        Self { value, warnings, files: Vec::new() }
    }

    /// This, read from another file.
    pub fn with_file(mut self, file: InputFile) -> Self {
        self.files.push(file);
        self
    }

    /// Applies `f` to the value, keeping the rest.
    pub fn map<U>(self, f: impl FnOnce(T) -> U) -> Loaded<U> {
        Loaded { value: f(self.value), warnings: self.warnings, files: self.files }
    }
}
