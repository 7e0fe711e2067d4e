//! Styles by a property: colours and sizes of single features.

mod classes;
mod fields;
mod scales;

pub use classes::{Class, Coloring, Counted};
pub use classes::{check, check_size};
pub use fields::{Field, fields};
pub use scales::{CATEGORIES, SCALES};

use super::color::{Complaint, color};
use super::loader::Loader;
use crate::BelvedereError;
use belvedere_document::{ColorByDoc, LayerDoc, SizeByDoc, suggestion};
use belvedere_io::vector::{Geometry, VectorFeature, Vectors};
use belvedere_overlay::notes::ClassNote;
use belvedere_scene::{Color, FeatureStyle};
use classes::Sizing;
use std::collections::{BTreeMap, BTreeSet};

/// What a layer says of its features' own styles.
#[derive(Clone, Copy)]
struct Stated<'a> {
    color: Option<&'a ColorByDoc>,
    /// With its key.
    size: Option<(&'static str, &'a SizeByDoc)>,
    /// Width or diameter of the layer, pixels.
    px: f64,
    draws: Draws,
}

/// Whether a layer draws features of a geometry; lines also draw outlines of areas.
type Draws = fn(&Geometry) -> bool;

/// Geometries that a layer draws; `None` for layers without features.
fn draws(layer: &LayerDoc) -> Option<Draws> {
    match layer {
        LayerDoc::Line(_) => Some(|g| !matches!(g, Geometry::Points(_))),
        LayerDoc::Area(_) => Some(|g| matches!(g, Geometry::Polygons(_))),
        LayerDoc::Point(_) => Some(|g| matches!(g, Geometry::Points(_))),
        _ => None,
    }
}

fn stated(layer: &LayerDoc) -> Option<Stated<'_>> {
    let (color, size, px) = match layer {
        LayerDoc::Line(l) => {
            let size = l.style.width_by.as_ref().map(|by| ("width_by", by));
            (l.style.color_by.as_ref(), size, l.style.width_px)
        }
        LayerDoc::Area(l) => (l.style.color_by.as_ref(), None, 1.0),
        LayerDoc::Point(l) => {
            let size = l.style.size_by.as_ref().map(|by| ("size_by", by));
            (l.style.color_by.as_ref(), size, l.style.size_px)
        }
        _ => return None,
    };
    let draws = draws(layer)?;
    (color.is_some() || size.is_some()).then_some(Stated { color, size, px, draws })
}

/// Key of a layer's style by a property, if it has one: only files have properties.
pub(super) fn key_of(layer: &LayerDoc) -> Option<&'static str> {
    let stated = stated(layer)?;
    stated.color.map(|_| "color_by").or(stated.size.map(|(key, _)| key))
}

/// Checks the tables of a layer without its files.
pub(super) fn check_layer(layer: &LayerDoc) -> Result<(), (&'static str, Complaint)> {
    if let LayerDoc::City(city) = layer {
        return city.style.color_by.as_ref().map_or(Ok(()), check).map_err(|complaint| ("color_by", complaint));
    }
    let Some(stated) = stated(layer) else { return Ok(()) };
    stated.color.map_or(Ok(()), check).map_err(|complaint| ("color_by", complaint))?;
    stated.size.map_or(Ok(()), |(key, size)| check_size(size).map_err(|complaint| (key, complaint)))
}

/// Gives the features of a layer's files the styles that it states.
pub(super) fn style(loader: &mut Loader<'_>, index: usize, files: &mut [Vectors]) -> Result<(), BelvedereError> {
    let layers = loader.layers;
    let Some(stated) = layers.get(index).and_then(stated) else { return Ok(()) };
    let fail = |loader: &Loader<'_>, table: &str, complaint| complain(loader, index, table, complaint);
    if let Some(doc) = stated.color {
        let note = color_features(doc, stated.draws, files);
        let mut note = note.map_err(|complaint| fail(loader, "color_by", complaint))?;
        loader.id(index).clone_into(&mut note.layer);
        loader.notes.classes.push(note);
    }
    if let Some((table, doc)) = stated.size {
        size_features(doc, stated, files).map_err(|complaint| fail(loader, table, complaint))?;
    }
    Ok(())
}

/// The error of a table of a layer's style.
pub(super) fn complain(loader: &Loader<'_>, index: usize, table: &str, (key, reason): Complaint) -> BelvedereError {
    let keys = ["layer", &index.to_string(), "style", table, key];
    loader.origin.error(&keys, format!("layer \"{}\": {table}: {reason}", loader.id(index))).into()
}

fn color_features(doc: &ColorByDoc, draws: Draws, files: &mut [Vectors]) -> Result<ClassNote, Complaint> {
    let property = property(&doc.property, draws, files)?;
    let coloring = Coloring::new(doc, &counted(&property, draws, files))?;
    let others = doc.others.as_deref().map(|text| color("others", text)).transpose()?;
    each(draws, files, |feature| {
        let own = feature.properties.get(&property).and_then(|value| coloring.color_of(value)).or(others);
        feature.style.get_or_insert_default().color = own;
    });
    let counted = coloring.classes.iter().filter(|class| class.count > 0);
    Ok(ClassNote {
        layer: String::new(),
        property,
        classes: counted.map(|class| (class.name.clone(), class.color)).collect(),
        smooth: coloring.is_smooth(),
        others: (coloring.others > 0).then_some(others),
    })
}

fn size_features(doc: &SizeByDoc, stated: Stated<'_>, files: &mut [Vectors]) -> Result<(), Complaint> {
    let property = property(&doc.property, stated.draws, files)?;
    let sizing = Sizing::new(doc, &counted(&property, stated.draws, files))?;
    each(stated.draws, files, |feature| {
        let px = feature.properties.get(&property).and_then(|value| sizing.px_of(value));
        feature.style.get_or_insert_default().scale = px.map_or(1.0, |px| px / stated.px);
    });
    Ok(())
}

fn each(draws: Draws, files: &mut [Vectors], change: impl FnMut(&mut VectorFeature)) {
    files.iter_mut().flat_map(|f| &mut f.features).filter(|f| draws(&f.geometry)).for_each(change);
}

/// The property of that name, however it is capitalised.
fn property(name: &str, draws: Draws, files: &[Vectors]) -> Result<String, Complaint> {
    let drawn = files.iter().flat_map(|f| &f.features).filter(|f| draws(&f.geometry));
    let known: BTreeSet<&String> = drawn.flat_map(|f| f.properties.keys()).collect();
    let same = |key: &&&String| key.to_lowercase() == name.to_lowercase();
    if let Some(found) = known.iter().find(|key| **key == name).or_else(|| known.iter().find(same)) {
        return Ok((*found).clone());
    }
    let names: Vec<&str> = known.iter().map(|key| key.as_str()).collect();
    let reason = match names.is_empty() {
        true => format!("no feature has the property \"{name}\", for the file has none; remove it"),
        false => format!("no feature has the property \"{name}\"; {}", suggestion(name, &names)),
    };
    Err(("property", reason))
}

/// Distinct values of a property.
fn counted(property: &str, draws: Draws, files: &[Vectors]) -> Vec<Counted> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let drawn = files.iter().flat_map(|f| &f.features).filter(|f| draws(&f.geometry));
    for value in drawn.filter_map(|f| f.properties.get(property)) {
        *counts.entry(value).or_default() += 1;
    }
    counts.into_iter().map(|(value, count)| (value.to_owned(), count)).collect()
}

/// A colour with the opacity of another, unless it states its own.
pub(super) fn as_opaque_as(layer: Color, own: Option<FeatureStyle>) -> Option<FeatureStyle> {
    let thinned = |c: Color| if c.a == 255 { c.with_alpha(layer.a) } else { c };
    own.map(|style| FeatureStyle { color: style.color.map(thinned), ..style })
}
