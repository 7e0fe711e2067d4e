//! Classes of land cover maps, and what covers the ground by them.

use crate::vector::VectorFeature;
use belvedere_scene::Cover::{self, Bare, BuiltUp, Fields, Forest, Grass, Ice, Shrubs, Unknown, Water, Wetland};

/// A legend of numbered classes.
pub(super) struct Legend {
    pub(super) name: &'static str,
    /// First and last number of a run of classes, and what they are.
    classes: &'static [(u16, u16, Cover)],
}

/// ESA WorldCover 10 m, product user manual v200, table 2.
const WORLD_COVER: Legend = Legend {
    name: "ESA WorldCover",
    classes: &[
        (10, 10, Forest),
        (20, 20, Shrubs),
        (30, 30, Grass),
        (40, 40, Fields),
        (50, 50, BuiltUp),
        (60, 60, Bare),
        (70, 70, Ice),
        (80, 80, Water),
        (90, 90, Wetland),
        (95, 95, Forest),
        (100, 100, Grass),
    ],
};

/// National Land Cover Database of the United States, legend of 2021.
const NLCD: Legend = Legend {
    name: "NLCD",
    classes: &[
        (11, 11, Water),
        (12, 12, Ice),
        (21, 24, BuiltUp),
        (31, 31, Bare),
        (41, 43, Forest),
        (51, 52, Shrubs),
        (71, 74, Grass),
        (81, 82, Fields),
        (90, 90, Forest),
        (95, 95, Wetland),
    ],
};

/// CORINE Land Cover, the numbers 1 to 44 of its rasters (nomenclature of the European Environment Agency).
const CORINE_RASTER: Legend = Legend {
    name: "CORINE Land Cover",
    classes: &[
        (1, 9, BuiltUp),
        (10, 11, Grass),
        (12, 17, Fields),
        (18, 18, Grass),
        (19, 22, Fields),
        (23, 25, Forest),
        (26, 26, Grass),
        (27, 29, Shrubs),
        (30, 33, Bare),
        (34, 34, Ice),
        (35, 38, Wetland),
        (39, 39, Bare),
        (40, 44, Water),
    ],
};

/// The same by its codes of three digits.
const CORINE_CODES: Legend = Legend {
    name: "CORINE Land Cover",
    classes: &[
        (111, 133, BuiltUp),
        (141, 142, Grass),
        (211, 223, Fields),
        (231, 231, Grass),
        (241, 244, Fields),
        (311, 313, Forest),
        (321, 321, Grass),
        (322, 324, Shrubs),
        (331, 334, Bare),
        (335, 335, Ice),
        (411, 422, Wetland),
        (423, 423, Bare),
        (511, 523, Water),
    ],
};

/// Numbers that mean no data in every legend.
const NO_DATA: [u16; 4] = [0, 48, 128, 255];

impl Legend {
    /// What a number means; `None` if the legend lacks it.
    pub(super) fn cover(&self, number: u16) -> Option<Cover> {
        if let Some(found) = self.classes.iter().find(|(from, to, _)| (*from..=*to).contains(&number)) {
            return Some(found.2);
        }
        NO_DATA.contains(&number).then_some(Unknown)
    }

    /// The legend to which all numbers belong.
    ///
    /// # Errors
    /// One sentence, if there is none, or if all is no data.
    pub(super) fn of(numbers: &[u16]) -> Result<&'static Self, String> {
        let known: Vec<u16> = numbers.iter().copied().filter(|number| !NO_DATA.contains(number)).collect();
        let Some(largest) = known.iter().max() else {
            return Err("holds no class over the terrain, only no data; give land cover of the same place".into());
        };
        // The numbers of CORINE and of NLCD overlap up to 43, where NLCD hardly ever has all of its classes.
        let legends: [&Self; 4] = match largest {
            ..=44 => [&WORLD_COVER, &CORINE_RASTER, &NLCD, &CORINE_CODES],
            _ => [&WORLD_COVER, &NLCD, &CORINE_CODES, &CORINE_RASTER],
        };
        let holds = |legend: &&&Self| known.iter().all(|number| legend.cover(*number).is_some());
        legends.iter().find(holds).copied().ok_or_else(|| {
            let strange: Vec<String> = known.iter().take(8).map(u16::to_string).collect();
            format!(
                "its classes ({}{}) belong to no legend of ESA WorldCover, CORINE Land Cover or NLCD; give such a raster, or areas of OpenStreetMap",
                strange.join(", "),
                if known.len() > 8 { ", ..." } else { "" }
            )
        })
    }
}

/// Tags of OpenStreetMap, with what they mean: land use comes before what grows there, water above all.
const TAGS: [(&str, &[&str], Cover); 15] = [
    ("landuse", &["residential", "commercial", "industrial", "retail", "railway", "construction"], BuiltUp),
    ("landuse", &["farmland", "orchard", "vineyard", "greenhouse_horticulture", "plant_nursery"], Fields),
    ("landuse", &["meadow", "grass", "village_green", "recreation_ground"], Grass),
    ("natural", &["grassland", "fell", "tundra"], Grass),
    ("leisure", &["golf_course", "pitch"], Grass),
    ("natural", &["scrub", "heath", "shrubbery"], Shrubs),
    ("landuse", &["forest"], Forest),
    ("natural", &["wood"], Forest),
    ("landcover", &["trees"], Forest),
    ("natural", &["bare_rock", "scree", "sand", "shingle", "beach", "rock"], Bare),
    ("landuse", &["quarry"], Bare),
    ("natural", &["wetland"], Wetland),
    ("natural", &["glacier"], Ice),
    ("natural", &["water", "bay"], Water),
    ("landuse", &["reservoir", "basin"], Water),
];

/// Properties that hold a class of CORINE Land Cover.
const CORINE_KEYS: [&str; 6] = ["code_18", "code_12", "code_06", "code_00", "code_90", "clc_code"];

/// What an area covers, with its rank: areas of higher ranks lie above; `None` if its properties do not tell.
pub(super) fn of_area(feature: &VectorFeature) -> Option<(usize, Cover)> {
    let tag = |key: &str| {
        let found = feature.properties.iter().find(|(name, _)| name.eq_ignore_ascii_case(key));
        found.map(|(_, value)| value.trim().to_lowercase())
    };
    for (rank, (key, values, cover)) in TAGS.iter().enumerate().rev() {
        if tag(key).is_some_and(|value| values.contains(&value.as_str())) {
            return Some((rank, *cover));
        }
    }
    let code = CORINE_KEYS.iter().find_map(|key| tag(key)?.parse().ok())?;
    CORINE_CODES.cover(code).filter(|cover| *cover != Unknown).map(|cover| (0, cover))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legends_are_told_apart_by_their_numbers() {
        let of = |numbers: &[u16]| Legend::of(numbers).map(|legend| legend.name);
        assert_eq!(of(&[0, 10, 30, 60, 80]), Ok("ESA WorldCover"));
        assert_eq!(of(&[10, 20, 30, 40]), Ok("ESA WorldCover"));
        assert_eq!(of(&[2, 12, 23, 24, 25, 31, 48]), Ok("CORINE Land Cover"));
        assert_eq!(of(&[112, 211, 312, 335, 512]), Ok("CORINE Land Cover"));
        assert_eq!(of(&[11, 21, 42, 52, 71, 90]), Ok("NLCD"));
        let error = of(&[7, 99, 190]).unwrap_err();
        assert!(error.contains("7, 99, 190") && error.contains("WorldCover"), "{error}");
        assert!(of(&[0, 255]).unwrap_err().contains("no data"));
    }

    #[test]
    fn tags_of_areas_tell_what_covers_them_and_which_lies_above() {
        let area = |tags: &[(&str, &str)]| {
            let properties = tags.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
            of_area(&VectorFeature {
                name: String::new(),
                properties,
                style: None,
                geometry: crate::vector::Geometry::Polygons(Vec::new()),
            })
        };
        let cover = |tags: &[(&str, &str)]| area(tags).map(|(_, cover)| cover);
        assert_eq!(cover(&[("natural", "wood")]), Some(Forest));
        assert_eq!(cover(&[("Landuse", "Residential")]), Some(BuiltUp));
        assert_eq!(cover(&[("landuse", "forest"), ("natural", "water")]), Some(Water));
        assert_eq!(cover(&[("Code_18", "335")]), Some(Ice));
        assert_eq!(cover(&[("name", "forest")]), None, "names tell nothing");
        let rank = |tags: &[(&str, &str)]| area(tags).expect("an area").0;
        assert!(rank(&[("natural", "water")]) > rank(&[("landuse", "residential")]));
    }
}
