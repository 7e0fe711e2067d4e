//! Names of the built-in documents.

/// Names of the built-in documents; `identity` also takes an angle in degrees, as in `identity(35)`.
pub const BUILTIN_NAMES: [&str; 8] = {
    let mut names = [""; 8];
    let mut i = 0;
    while i < names.len() {
        names[i] = BUILTINS[i].name;
        i += 1;
    }
    names
};

/// Names and effect of a built-in document.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Builtin {
    /// Name.
    pub name: &'static str,
    /// Other names, by effect: authors do not agree on which of the two is progressive.
    pub aliases: &'static [&'static str],
    /// Description of the picture, from near to far.
    pub effect: &'static str,
}

/// The built-in documents.
pub const BUILTINS: [Builtin; 8] = [
    Builtin { name: "progressive", aliases: &["steep-flat", "panorama"], effect: "a map in front, a horizon behind" },
    Builtin {
        name: "degressive",
        aliases: &["flat-steep", "map-ahead"],
        effect: "a close view in front, a map of what lies ahead",
    },
    Builtin {
        name: "hybrid-flat-steep-flat",
        aliases: &["flat-steep-flat"],
        effect: "a map between a close view and a horizon",
    },
    Builtin {
        name: "hybrid-steep-flat-steep",
        aliases: &["steep-flat-steep"],
        effect: "a close view between two maps",
    },
    Builtin { name: "map", aliases: &["steep"], effect: "a plane seen under 80 degrees" },
    Builtin { name: "identity", aliases: &["straight", "perspective"], effect: "the ordinary perspective" },
    Builtin {
        name: "demo",
        aliases: &[],
        effect: "degressive, progressive, map by viewing angle, turning evenly, with levels of abstraction",
    },
    Builtin {
        name: "demo-orthographic",
        aliases: &["demo-parallel"],
        effect: "the same with a parallel projection at the steep end",
    },
];
