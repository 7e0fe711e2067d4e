//! What documents of several kinds of layers and stages hold.

use schemars::JsonSchema;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserializer, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};

/// Whether a switch is off, as it is by default.
pub(super) fn is_false(value: &bool) -> bool {
    !value
}

/// Whether an opacity is 1, as it is by default.
pub(super) fn is_true(value: &bool) -> bool {
    *value
}

/// Whether an opacity is the usual one.
pub(super) fn is_opaque(opacity: &f64) -> bool {
    *opacity == 1.0
}

/// Placement of a model: scaled, then rotated about z (and x, y), then moved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TransformDoc {
    /// Added last, scene units.
    pub translate: [f64; 3],
    /// Rotations about x, y and z, degrees; boxes take z only.
    pub rotate_deg: [f64; 3],
    /// Scale, > 0.
    pub scale: f64,
}

impl Default for TransformDoc {
    fn default() -> Self {
        Self { translate: [0.0; 3], rotate_deg: [0.0; 3], scale: 1.0 }
    }
}

/// One path or several.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Paths {
    /// One.
    One(String),
    /// Several, read as one source.
    Many(Vec<String>),
}

impl Paths {
    /// All of them.
    pub fn as_slice(&self) -> &[String] {
        match self {
            Self::One(p) => std::slice::from_ref(p),
            Self::Many(p) => p,
        }
    }

    /// Calls `change` with each of them.
    pub fn each(&mut self, change: &mut dyn FnMut(&mut String)) {
        match self {
            Self::One(name) => change(name),
            Self::Many(names) => names.iter_mut().for_each(change),
        }
    }
}

impl<'de> Deserialize<'de> for Paths {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct PathsVisitor;
        impl<'de> Visitor<'de> for PathsVisitor {
            type Value = Paths;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a path or a list of paths")
            }

            fn visit_str<E: serde::de::Error>(self, path: &str) -> Result<Paths, E> {
                Ok(Paths::One(path.to_owned()))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Paths, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(seq)).map(Paths::Many)
            }
        }
        deserializer.deserialize_any(PathsVisitor)
    }
}

/// The reference plane: points `p` with `p . unit(normal) = height_m`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneDoc {
    /// Normal; `[0, 0, 1]` by default.
    #[serde(default = "z_up")]
    pub normal: [f64; 3],
    /// Height along the normal; by default the median height of the undeformed terrain, or that of `look_at`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
}

fn z_up() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}
