//! Colours of buildings and blocks by a property: height, use, population, or an attribute of the file.

use crate::by_property::Coloring;
use crate::color::{Complaint, color};
use belvedere_core::plain::number;
use belvedere_document::{ColorByDoc, suggestion};
use belvedere_io::city::CityAbout;
use belvedere_overlay::notes::ClassNote;
use belvedere_scene::{Building, City, Color};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Names of a property, and the attributes of files that hold it, the first that is there.
const HEIGHT: &str = "height";
const KNOWN: [(&str, &[&str]); 2] = [
    ("use", &["use", "usage", "building:use", "function", "class", "building"]),
    ("population", &["population", "inhabitants", "residents", "pop"]),
];
/// Words of properties whose numbers add up; of others a block shows the mean.
const COUNTS: [&str; 6] = ["population", "inhabitants", "residents", "pop", "dwellings", "flats"];

/// The value of a property for each building of a city; `None` where it has none.
pub(super) struct Values {
    property: String,
    of: Vec<Option<String>>,
}

impl Values {
    /// * `about`: what files say of buildings, by their ids.
    ///
    /// # Errors
    /// No building has the property.
    pub(super) fn of(doc: &ColorByDoc, city: &City, about: &[CityAbout]) -> Result<Self, Complaint> {
        let asked = doc.property.trim().to_lowercase();
        if asked == HEIGHT {
            let of = city.buildings.iter().map(|b| Some(number((10.0 * b.height_m).round() / 10.0))).collect();
            return Ok(Self { property: HEIGHT.into(), of });
        }
        let about: HashMap<&str, &BTreeMap<String, String>> =
            about.iter().map(|a| (a.id.as_str(), &a.attributes)).collect();
        let attributes: Vec<_> = city.buildings.iter().map(|b| about.get(b.id.as_str()).copied()).collect();
        let keys: BTreeSet<&String> = attributes.iter().flatten().flat_map(|a| a.keys()).collect();
        let named = |name: &str| keys.iter().find(|key| key.to_lowercase() == name).map(|key| (*key).clone());
        let others = KNOWN.iter().find(|(name, _)| *name == asked).map(|(_, names)| *names).unwrap_or_default();
        let Some(key) = named(&asked).or_else(|| others.iter().find_map(|name| named(name))) else {
            let known: Vec<&str> = keys.iter().map(|key| key.as_str()).chain([HEIGHT]).collect();
            let reason = format!("no building has the property \"{}\"; {}", doc.property, suggestion(&asked, &known));
            return Err(("property", reason));
        };
        // OpenStreetMap's `yes` says only that it is a building.
        let says = |value: &&String| !(value.trim().is_empty() || key == "building" && value.trim() == "yes");
        let of = attributes.iter().map(|a| a.and_then(|a| a.get(&key)).filter(says).cloned()).collect();
        Ok(Self { property: key, of })
    }

    /// Those of blocks: of counts the sum, of other numbers the mean by footprint, of texts the one that most of the volume has.
    ///
    /// * `members`: for each building of a level those of `city` that it stands for.
    /// * `sizes`: footprint and volume of each building of the city.
    pub(super) fn joined(self, members: &[Vec<usize>], sizes: &[[f64; 2]]) -> Self {
        let adds_up = COUNTS.contains(&self.property.to_lowercase().as_str());
        let of = members.iter().map(|members| joined(&self.of, members, sizes, adds_up)).collect();
        Self { of, ..self }
    }

    /// Colours of the buildings, and what the legend says of them. `layer`: id of the layer.
    ///
    /// # Errors
    /// A key of the table and a sentence.
    pub(super) fn colors(&self, doc: &ColorByDoc, layer: &str) -> Result<(Vec<Option<Color>>, ClassNote), Complaint> {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        self.of.iter().flatten().for_each(|value| *counts.entry(value).or_default() += 1);
        let counted: Vec<_> = counts.into_iter().map(|(value, count)| (value.to_owned(), count)).collect();
        let coloring = Coloring::new(doc, &counted)?;
        let others = doc.others.as_deref().map(|text| color("others", text)).transpose()?;
        let of = |value: &Option<String>| value.as_ref().and_then(|value| coloring.color_of(value)).or(others);
        let shown = coloring.classes.iter().filter(|class| class.count > 0);
        let without = self.of.iter().any(Option::is_none) || coloring.others > 0;
        let note = ClassNote {
            layer: layer.to_owned(),
            property: if self.property == HEIGHT { "height, m".into() } else { self.property.clone() },
            classes: shown.map(|class| (class.name.clone(), class.color)).collect(),
            smooth: coloring.is_smooth(),
            others: without.then_some(others),
        };
        Ok((self.of.iter().map(of).collect(), note))
    }
}

fn joined(of: &[Option<String>], members: &[usize], sizes: &[[f64; 2]], adds_up: bool) -> Option<String> {
    let stated: Vec<(&str, [f64; 2])> =
        members.iter().filter_map(|i| Some((of.get(*i)?.as_deref()?, *sizes.get(*i)?))).collect();
    let numbers: Option<Vec<(f64, f64)>> =
        stated.iter().map(|(text, [area, _])| Some((text.trim().parse().ok()?, *area))).collect();
    match numbers.filter(|numbers| !numbers.is_empty()) {
        Some(numbers) if adds_up => Some(number(numbers.iter().map(|(value, _)| value).sum())),
        Some(numbers) => {
            let area: f64 = numbers.iter().map(|(_, area)| area).sum();
            let mean = numbers.iter().map(|(value, area)| value * area).sum::<f64>() / area.max(f64::MIN_POSITIVE);
            Some(number((10.0 * mean).round() / 10.0))
        }
        None => {
            let mut volumes: BTreeMap<&str, f64> = BTreeMap::new();
            stated.iter().for_each(|(text, [_, volume])| *volumes.entry(text).or_default() += volume);
            volumes.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(text, _)| text.to_owned())
        }
    }
}

/// Footprint and volume of buildings, m^2 and m^3.
pub(super) fn sizes(buildings: &[Building]) -> Vec<[f64; 2]> {
    let twice = |ring: &[belvedere_core::DVec2]| -> f64 {
        (0..ring.len()).map(|k| ring[k].perp_dot(ring[(k + 1) % ring.len()])).sum()
    };
    let area = |b: &Building| -> f64 {
        let rings =
            b.footprint.iter().map(|p| twice(&p.outer).abs() - p.holes.iter().map(|h| twice(h).abs()).sum::<f64>());
        0.5 * rings.sum::<f64>()
    };
    buildings.iter().map(|b| [area(b), belvedere_construct::generalise::volume_m3(b)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_show_sums_of_counts_means_of_heights_and_the_use_of_most_of_their_volume() {
        let texts = |list: &[&str]| list.iter().map(|t| (!t.is_empty()).then(|| (*t).to_owned())).collect::<Vec<_>>();
        let sizes = [[100.0, 900.0], [300.0, 2700.0], [50.0, 9000.0]];
        let of = |property: &str, values: &[&str]| {
            let values = Values { property: property.into(), of: texts(values) };
            values.joined(&[vec![0, 1], vec![2], vec![0, 1, 2]], &sizes).of
        };
        assert_eq!(of("population", &["3", "5", ""]), texts(&["8", "", "8"]));
        assert_eq!(of("height", &["10", "20", "40"]), texts(&["17.5", "40", "20"]));
        assert_eq!(of("use", &["homes", "shop", "tower"]), texts(&["shop", "tower", "tower"]));
    }
}
