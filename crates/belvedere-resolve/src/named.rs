//! What names are written for: the property that holds them, what points are, how important each is, and heights beside names.

use super::loader::Loader;
use crate::BelvedereError;
use belvedere_document::{LayerDoc, PointStyleDoc, SymbolDoc, suggestion};
use belvedere_io::vector::{Geometry, Vectors, number, place_kind, stated_height, stated_people};
use belvedere_scene::{FeatureStyle, Heightfield, PlaceKind, PointFeature, WrittenHeight};
use belvedere_sight::{Standing, standings};
use std::collections::BTreeSet;

/// What `rank` of a layer may say besides a property.
const RANKS: [&str; 5] = ["auto", "file", "prominence", "dominance", "population"];

/// The property that `label` of a layer names.
fn label(layer: &LayerDoc) -> Option<&str> {
    match layer {
        LayerDoc::Line(l) => l.style.label.as_deref(),
        LayerDoc::Area(l) => l.style.label.as_deref(),
        LayerDoc::Point(l) => l.style.label.as_deref(),
        _ => None,
    }
}

/// What `rank` of a layer says, if it is not left to the program.
fn rank(layer: &LayerDoc) -> Option<&str> {
    match layer {
        LayerDoc::Area(l) => l.style.rank.as_deref().filter(|rank| *rank != "area"),
        LayerDoc::Point(l) => l.style.rank.as_deref(),
        _ => None,
    }
    .filter(|rank| *rank != "auto")
}

/// Key of a layer's style that asks for a property, if it has one: only files have properties.
pub(super) fn key_of(layer: &LayerDoc) -> Option<&'static str> {
    let by_property = |rank: &&str| !RANKS.contains(rank) || *rank == "population";
    label(layer).map(|_| "label").or(rank(layer).filter(by_property).map(|_| "rank"))
}

/// Gives the features of a layer's files their names, what they are, and their ranks by properties.
pub(super) fn tell(loader: &Loader<'_>, index: usize, files: &mut [Vectors]) -> Result<(), BelvedereError> {
    let Some(layer) = loader.layers.get(index) else { return Ok(()) };
    let fail = |key: &str, reason: String| {
        let reason = format!("layer \"{}\": {key}: {reason}", loader.id(index));
        loader.origin.error(&["layer", &index.to_string(), "style", key], reason)
    };
    if let Some(field) = label(layer) {
        let named: Vec<Result<(), String>> = files.iter_mut().map(|file| file.name_where(field)).collect();
        if !named.iter().any(Result::is_ok) {
            let reason = named.into_iter().find_map(Result::err).unwrap_or_else(|| "there are no features".into());
            return Err(fail("label", reason).into());
        }
    }
    if let LayerDoc::Point(point) = layer {
        files.iter_mut().for_each(|file| tell_points(&point.style, file));
    }
    let property = rank(layer).filter(|rank| !RANKS.contains(rank) || (*rank == "population" && has(files, rank)));
    match property {
        Some(property) => Ok(rank_by(property, files).map_err(|reason| fail("rank", reason))?),
        None => Ok(()),
    }
}

fn has(files: &[Vectors], property: &str) -> bool {
    files.iter().flat_map(|file| &file.features).any(|f| f.properties.contains_key(property))
}

/// What the points of a file are, and their symbols, colours and sizes where the layer states none.
fn tell_points(style: &PointStyleDoc, file: &mut Vectors) {
    let is_usual = style.color == PointStyleDoc::default().color && style.color_by.is_none();
    for feature in file.features.iter_mut().filter(|f| matches!(f.geometry, Geometry::Points(_))) {
        let Some(kind) = place_kind(&feature.properties) else { continue };
        let people = stated_people(&feature.properties);
        let own = feature.style.get_or_insert_default();
        own.kind = Some(kind);
        if style.symbol == SymbolDoc::Auto {
            own.symbol = Some(kind.symbol());
            if is_usual {
                own.color = Some(kind.color());
            }
            if style.size_by.is_none() {
                own.scale = scale(kind, people);
            }
        }
        own.rank = place_rank(kind, people);
        let stated = stated_height(&feature.properties);
        own.height = stated.map(|metres| WrittenHeight { metres, in_feet: false });
    }
}

/// Size of a symbol in that of the layer.
fn scale(kind: PlaceKind, people: Option<f64>) -> f64 {
    let usual = match kind {
        PlaceKind::City => 1.5,
        PlaceKind::Town => 1.25,
        PlaceKind::Village => 0.95,
        PlaceKind::Hamlet => 0.65,
        PlaceKind::Locality => 0.5,
        PlaceKind::Peak | PlaceKind::Hut | PlaceKind::Parking => 1.1,
        PlaceKind::Pass | PlaceKind::Lift | PlaceKind::Viewpoint => 1.2,
    };
    // A hundred people: 0.75, a million: 1.55.
    let settled = matches!(kind, PlaceKind::City | PlaceKind::Town | PlaceKind::Village | PlaceKind::Hamlet);
    people.filter(|_| settled).map_or(usual, |people| (0.35 + 0.2 * people.log10()).clamp(0.5, 1.8))
}

/// Importance of a place without ground: of settlements by the number of people, or that which their class has as a rule. Peaks of a few
/// hundred metres of prominence rank with villages, see [`peak_rank`].
fn place_rank(kind: PlaceKind, people: Option<f64>) -> Option<f64> {
    let by_people = |people: f64| 0.7 * (people / 30.0).max(1.0).log2();
    Some(match kind {
        PlaceKind::Peak => return None,
        PlaceKind::City => by_people(people.unwrap_or(100_000.0)),
        PlaceKind::Town => by_people(people.unwrap_or(10_000.0)),
        PlaceKind::Village => by_people(people.unwrap_or(1000.0)),
        PlaceKind::Hamlet => by_people(people.unwrap_or(100.0)),
        PlaceKind::Hut => 2.2,
        PlaceKind::Pass => 2.0,
        PlaceKind::Viewpoint => 1.0,
        PlaceKind::Lift => 0.9,
        PlaceKind::Locality => 0.5,
        PlaceKind::Parking => 0.2,
    })
}

/// Importance of a peak: by prominence and dominance alike.
fn peak_rank(standing: Standing) -> f64 {
    0.5 * ((1.0 + standing.prominence / 20.0).log2() + (1.0 + standing.dominance / 500.0).log2())
}

/// Ranks by the numbers of a property.
fn rank_by(property: &str, files: &mut [Vectors]) -> Result<(), String> {
    let known: BTreeSet<&String> = files.iter().flat_map(|f| &f.features).flat_map(|f| f.properties.keys()).collect();
    let same = |key: &&&String| key.to_lowercase() == property.to_lowercase();
    let found = known.iter().find(|key| key.as_str() == property).or_else(|| known.iter().find(same));
    let Some(found) = found.map(|key| (*key).clone()) else {
        let names: Vec<&str> = RANKS.into_iter().chain(known.iter().map(|key| key.as_str())).collect();
        return Err(format!("no feature has the property \"{property}\"; {}", suggestion(property, &names)));
    };
    let mut count = 0;
    for feature in files.iter_mut().flat_map(|file| &mut file.features) {
        let value = feature.properties.get(&found).and_then(|value| number(value));
        feature.style.get_or_insert_default().rank = value;
        count += usize::from(value.is_some());
    }
    match count {
        0 => Err(format!("the property \"{found}\" holds no numbers; give one that does, or auto")),
        _ => Ok(()),
    }
}

/// Ranks peaks by how they stand out of the ground, and gives points the heights that are written below their names.
///
/// * `in_feet`: whether heights are written in feet.
pub(super) fn stand_out(
    style: &PointStyleDoc,
    features: &mut [PointFeature],
    ground: Option<&Heightfield>,
    in_feet: bool,
) {
    let rank = style.rank.as_deref().unwrap_or("auto");
    if let (Some(ground), true) = (ground, ["auto", "prominence", "dominance"].contains(&rank)) {
        rank_peaks(rank, features, ground);
    }
    if rank == "file" {
        features.iter_mut().filter_map(|f| f.style.as_mut()).for_each(|own| own.rank = None);
    }
    for feature in features {
        let kind = feature.style.and_then(|own| own.kind);
        let written = style.label_elevation.unwrap_or(kind == Some(PlaceKind::Peak));
        let stated = feature.style.and_then(|own| own.height).map(|height| height.metres);
        // Without ground, heights are those of the file, if it has any.
        let found = stated.or_else(|| ground.map(|_| feature.position.z)).filter(|_| written);
        if found.is_some() || feature.style.is_some_and(|own| own.height.is_some()) {
            let height = found.map(|metres| WrittenHeight { metres, in_feet });
            feature.style = Some(FeatureStyle { height, ..feature.style.unwrap_or_default() });
        }
    }
}

fn rank_peaks(rank: &str, features: &mut [PointFeature], ground: &Heightfield) {
    let is_peak = |f: &PointFeature| f.style.is_some_and(|own| own.kind == Some(PlaceKind::Peak));
    // Asked for, all points are summits; else those that say so.
    let chosen: Vec<usize> = (0..features.len()).filter(|i| rank != "auto" || is_peak(&features[*i])).collect();
    let places: Vec<_> = chosen.iter().map(|i| features[*i].position.truncate()).collect();
    if places.is_empty() {
        return;
    }
    for (i, standing) in chosen.into_iter().zip(standings(ground, &places)) {
        features[i].style.get_or_insert_default().rank = Some(match rank {
            "prominence" => standing.prominence,
            "dominance" => standing.dominance,
            _ => peak_rank(standing),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_peaks_rank_on_one_scale() {
        let peak = |prominence, dominance| peak_rank(Standing { prominence, dominance });
        let place = |kind, people| place_rank(kind, people).expect("ranked");
        assert!(peak(1500.0, 20_000.0) > place(PlaceKind::Village, None));
        assert!(place(PlaceKind::Town, None) > peak(300.0, 3000.0));
        assert!(place(PlaceKind::Village, Some(5000.0)) > place(PlaceKind::Village, Some(50.0)));
        assert!(peak(0.0, 100.0) < place(PlaceKind::Hamlet, None));
        assert!(scale(PlaceKind::Village, Some(1e9)) <= 1.8 && scale(PlaceKind::Hamlet, Some(1.0)) >= 0.5);
    }
}
