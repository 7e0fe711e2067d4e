//! Properties of the files of a layer, for interfaces that offer them.

use super::draws;
use super::{Counted, classes};
use crate::BelvedereError;
use belvedere_document::paths::Roots;
use belvedere_document::{LayerDoc, Paths};
use belvedere_io::city::is_meant;
use belvedere_io::load_vectors;
use belvedere_io::vector::{VectorFeature, name_field};
use std::collections::BTreeMap;

/// A property of the features of a layer.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// Its distinct values and how many features have each, the most frequent first.
    pub values: Vec<Counted>,
    /// Lowest and highest value, if all are numbers.
    pub range: Option<[f64; 2]>,
    /// Whether names are taken from it where the layer states no `name_field`.
    pub is_name: bool,
}

/// Properties of the features that a layer draws, by name; none for kinds of layers without properties and for built-in sources.
///
/// # Errors
/// As reading the layer: [`BelvedereError::Document`], [`BelvedereError::Io`].
pub fn fields(layer: &LayerDoc, roots: &Roots) -> Result<Vec<Field>, BelvedereError> {
    let (Some(draws), Some(paths)) = (draws(layer), source(layer)) else { return Ok(Vec::new()) };
    let select = match layer {
        LayerDoc::Line(l) => l.select.as_deref(),
        _ => None,
    };
    let mut counts: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
    for name in paths.as_slice().iter().filter(|name| !name.starts_with("builtin:")) {
        let vectors = load_vectors(&roots.resolve(name)?)?.value;
        let meant = |f: &&VectorFeature| select.is_none_or(|by| is_meant(by, &f.name, &f.properties));
        for feature in vectors.features.iter().filter(|f| draws(&f.geometry)).filter(meant) {
            for (key, value) in feature.properties.iter().filter(|(_, value)| !value.trim().is_empty()) {
                *counts.entry(key.clone()).or_default().entry(value.clone()).or_default() += 1;
            }
        }
    }
    let names = name_field(counts.keys().map(String::as_str)).map(str::to_owned);
    let field = |(name, counts): (String, BTreeMap<String, usize>)| {
        let mut values: Vec<Counted> = counts.into_iter().collect();
        let range = classes::range(&values);
        values.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
        Field { is_name: names.as_deref() == Some(&name), name, values, range }
    };
    Ok(counts.into_iter().map(field).collect())
}

fn source(layer: &LayerDoc) -> Option<&Paths> {
    match layer {
        LayerDoc::Line(l) => l.source.as_ref(),
        LayerDoc::Area(l) => Some(&l.source),
        LayerDoc::Point(l) => Some(&l.source),
        _ => None,
    }
}
