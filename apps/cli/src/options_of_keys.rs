//! Options of the command line for what the library names by its own keys and arguments.

use belvedere::Warning;
use belvedere::io::LiftedBy;

/// The option that a mistake in data without a scene file comes from, by the key that data have instead.
pub(crate) fn of_data(key: &str) -> Option<&'static str> {
    Some(match key {
        "crs" => "--crs",
        "source_crs" => "--source-crs",
        "name_field" => "--name-field",
        "class" => "--line-class",
        "palette" => "--palette",
        "drape" => "--drape",
        _ => return None,
    })
}

/// The option of an argument of a call.
pub(crate) fn of_argument(name: &'static str) -> String {
    match name {
        "ground_nodes" => "--nodes".into(),
        name => format!("--{}", name.replace('_', "-")),
    }
}

/// End of a message: the options that lift a fault of a file.
pub(crate) fn lifting(by: LiftedBy) -> Option<&'static str> {
    match by {
        LiftedBy::Memory => Some(" (--max-mem)"),
        LiftedBy::Keys(["source_crs"]) => Some(" (--source-crs)"),
        LiftedBy::Keys(["source_crs", "crs"]) => Some(" (--source-crs, --crs local)"),
        _ => None,
    }
}

/// What a run says beside its result.
pub(crate) trait Told {
    /// The sentence, with the option that settles it.
    fn told(&self) -> String;
}

impl Told for String {
    fn told(&self) -> String {
        self.clone()
    }
}

impl Told for Warning {
    fn told(&self) -> String {
        let option = match self.key() {
            Some("source_crs") => " (--source-crs)",
            Some("nodata") => " (--nodata)",
            Some("vertical_unit") => " (--vertical-unit)",
            Some("fonts") => " (--font)",
            Some("assembly") => " (--assembly)",
            Some("model") => " (--model)",
            Some("limits") => " (--no-limits)",
            Some("show") => " (--show)",
            Some("ground_nodes") => " (--nodes)",
            Some("palette") => " (--palette)",
            Some("materials") => " (--plain)",
            Some("grid") => " (--grid scene)",
            _ => "",
        };
        format!("{self}{option}")
    }
}
