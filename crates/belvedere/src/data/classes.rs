//! What the lines of files are, as the caller states it.

use crate::scene_file::request::class_of_file;
use crate::{Advice, BelvedereError};
use belvedere_scene::LineClass;
use std::collections::BTreeMap;
use std::path::Path;

/// The classes of files, by the names that the caller gives them.
///
/// * `stated`: `FILE=CLASS`, the file as it is given, or by its name alone; `files`: those that are given.
pub(super) fn of<'a>(
    stated: &[String],
    files: &'a [String],
) -> Result<BTreeMap<&'a String, LineClass>, BelvedereError> {
    let refused = |text: String| BelvedereError::Argument(Advice::new("{}: ", &["line_class"]).then(text));
    let mut classes = BTreeMap::new();
    for text in stated {
        let (file, class) = class_of_file(text).map_err(refused)?;
        let is_meant = |name: &&String| {
            let path = Path::new(name.as_str());
            name.as_str() == file || [path.file_name(), path.file_stem()].into_iter().flatten().any(|part| part == file)
        };
        let meant: Vec<&String> = files.iter().filter(is_meant).collect();
        if meant.is_empty() {
            return Err(refused(format!("no file of features is called \"{file}\"; give one that is drawn")));
        }
        classes.extend(meant.into_iter().map(|name| (name, class)));
    }
    Ok(classes)
}
