//! Files of letters, for names that the letters of the program itself do not set.

use std::sync::Arc;

/// One font of a file.
#[derive(Clone, PartialEq, Eq)]
pub struct FontFile {
    /// Name of the file, for messages.
    pub name: String,
    /// The whole file: TrueType, OpenType or a collection of them.
    pub bytes: Arc<Vec<u8>>,
    /// Number of the font in a collection, else 0.
    pub index: u32,
}

impl std::fmt::Debug for FontFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "FontFile({} #{}, {} bytes)", self.name, self.index, self.bytes.len())
    }
}
