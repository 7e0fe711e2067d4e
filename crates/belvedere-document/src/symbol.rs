//! Symbols of points.

use belvedere_scene::Symbol;
use serde::de::Deserializer;
use serde::{Deserialize, Serialize, Serializer};

/// Shape of points: `auto`, a name, or an SVG file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum SymbolDoc {
    /// By what the properties say that a point is, as OpenStreetMap writes them: a triangle for a peak, a house for a hut, a ring for a
    /// village, and so on; else a dot. Colours and sizes follow, where the layer states none.
    #[default]
    Auto,
    /// One of the program's.
    Named(Symbol),
    /// An SVG file of filled shapes.
    File(String),
}

impl SymbolDoc {
    /// The symbol of that name, else a file.
    pub fn of(text: &str) -> Self {
        match Symbol::named(text) {
            _ if text == "auto" => Self::Auto,
            Some(symbol) => Self::Named(symbol),
            None => Self::File(text.to_owned()),
        }
    }

    /// Its name in a scene file.
    pub fn name(&self) -> &str {
        match self {
            Self::Auto => "auto",
            Self::Named(symbol) => Symbol::NAMED.iter().find(|(_, s)| s == symbol).map_or("dot", |(name, _)| name),
            Self::File(name) => name,
        }
    }

    /// Why a name means no symbol, and what to give.
    pub fn unknown(name: &str) -> String {
        let names: Vec<&str> = std::iter::once("auto").chain(Symbol::NAMED.map(|(name, _)| name)).collect();
        format!(
            "symbol \"{}\" is neither the name of a symbol nor an SVG file; {}",
            super::doc_error::shorten(name),
            super::suggestion(name, &names)
        )
    }
}

impl Serialize for SymbolDoc {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for SymbolDoc {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer).map(|text| Self::of(&text))
    }
}
