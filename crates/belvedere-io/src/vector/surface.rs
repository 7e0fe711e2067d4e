//! What covers an area, by the tags of OpenStreetMap and the classes of Natural Earth.

use super::{Geometry, Vectors};
use belvedere_scene::AreaSurface;
use std::collections::BTreeMap;

/// What most of the tagged areas are; `None` where none of them is tagged as anything that is known.
pub fn surface_of(vectors: &Vectors) -> Option<AreaSurface> {
    let areas = vectors.features.iter().filter(|f| matches!(f.geometry, Geometry::Polygons(_)));
    let mut counts = [(AreaSurface::Water, 0usize), (AreaSurface::Forest, 0), (AreaSurface::Glacier, 0)];
    for found in areas.filter_map(|f| of_tags(&f.properties)) {
        counts.iter_mut().filter(|c| c.0 == found).for_each(|c| c.1 += 1);
    }
    // The first of equals.
    let most = counts.iter().rev().max_by_key(|c| c.1)?;
    (most.1 > 0).then_some(most.0)
}

fn of_tags(tags: &BTreeMap<String, String>) -> Option<AreaSurface> {
    let tag = |key: &str| tags.get(key).map_or("", String::as_str);
    let class = tag("featurecla").to_ascii_lowercase();
    if tag("natural") == "glacier" || class.contains("glacier") || class.contains("glaciated") {
        Some(AreaSurface::Glacier)
    } else if tag("natural") == "water"
        || !tag("water").is_empty()
        || tag("waterway") == "riverbank"
        || tag("landuse") == "reservoir"
        || ["lake", "reservoir", "ocean", "river"].iter().any(|w| class.contains(w))
    {
        Some(AreaSurface::Water)
    } else if tag("landuse") == "forest" || tag("natural") == "wood" {
        Some(AreaSurface::Forest)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_of_both_kinds_are_understood() {
        let of = |key: &str, value: &str| of_tags(&BTreeMap::from([(key.to_owned(), value.to_owned())]));
        assert_eq!(of("natural", "glacier"), Some(AreaSurface::Glacier));
        assert_eq!(of("featurecla", "Glaciated areas"), Some(AreaSurface::Glacier));
        assert_eq!(of("natural", "water"), Some(AreaSurface::Water));
        assert_eq!(of("featurecla", "Alkaline Lake"), Some(AreaSurface::Water));
        assert_eq!(of("landuse", "forest"), Some(AreaSurface::Forest));
        assert_eq!(of("natural", "wood"), Some(AreaSurface::Forest));
        assert_eq!((of("natural", "peak"), of("name", "water")), (None, None));
    }
}
