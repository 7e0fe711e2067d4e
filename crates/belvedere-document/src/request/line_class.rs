//! What the lines of a file are, as `FILE=CLASS`.

use crate::suggestion;
use belvedere_scene::LineClass;

/// File and class of a text.
///
/// # Errors
/// A sentence, where it is not of that form or the class is unknown.
pub fn class_of_file(text: &str) -> Result<(&str, LineClass), String> {
    let (file, name) = text
        .rsplit_once('=')
        .filter(|(file, _)| !file.trim().is_empty())
        .ok_or("give FILE=CLASS, such as water.geojson=river")?;
    let names = LineClass::NAMED.map(|(_, name, _)| name);
    let class = LineClass::named(name).ok_or_else(|| {
        format!("\"{}\" is not a class of lines; {}", crate::doc_error::shorten(name), suggestion(name, &names))
    })?;
    Ok((file.trim(), class))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_are_read_in_any_number_and_unknown_ones_refused() {
        assert_eq!(class_of_file("a=b.gpx=Rivers"), Ok(("a=b.gpx", LineClass::River)));
        assert_eq!(class_of_file("x.gpx=main roads"), Ok(("x.gpx", LineClass::MainRoad)));
        assert!(class_of_file("x.gpx").is_err() && class_of_file("=river").is_err());
        let refused = class_of_file("x.gpx=rivr").expect_err("unknown");
        assert!(refused.contains("did you mean \"river\"?"), "{refused}");
    }
}
