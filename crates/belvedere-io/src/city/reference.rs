//! Names of coordinate systems in city models.

use crate::crs::CoordinateSystem;
use belvedere_core::{Warning, WarningKind};

/// Compound systems and their horizontal parts.
const COMPOUND: [(u32, u32); 9] = [
    (7415, 28992),
    (5554, 25831),
    (5555, 25832),
    (5556, 25833),
    (7405, 27700),
    (6696, 6668),
    (6697, 6668),
    (5972, 25832),
    (5973, 25833),
];

/// A system as a file names it.
#[derive(Debug)]
pub(super) struct Reference {
    /// The horizontal system, if it is known.
    pub(super) crs: Option<CoordinateSystem>,
    /// `EPSG:n`, or the name in the file, possibly empty.
    pub(super) said: String,
    /// Why the system is not known, if one is named.
    pub(super) warning: Option<Warning>,
    /// Whether latitudes come first, as the name demands.
    pub(super) north_first: bool,
}

impl Reference {
    /// * `name`: such as `EPSG:25833`, `urn:ogc:def:crs:EPSG::25832`, `urn:ogc:def:crs,crs:EPSG:6.12:3068,crs:EPSG:6.12:5783`,
    ///   `https://www.opengis.net/def/crs/EPSG/0/7415` or `urn:adv:crs:ETRS89_UTM32*DE_DHHN92_NH`; possibly empty.
    pub(super) fn of(name: &str) -> Self {
        let unknown = |why: Option<String>| {
            let warning = why.map(|why| Warning::new(WarningKind::Assumed, why));
            Self { crs: None, said: name.to_owned(), warning, north_first: false }
        };
        let Some(code) = code(name) else {
            let why = (!name.is_empty()).then(|| format!("its system \"{name}\" is not known; set crs"));
            return unknown(why);
        };
        let flat = COMPOUND.iter().find(|(compound, _)| *compound == code).map_or(code, |(_, flat)| *flat);
        match CoordinateSystem::from_epsg(flat) {
            Ok(crs) => {
                // Files with the short form have the order x, y.
                let north_first = crs.is_geographic() && !name.to_ascii_uppercase().starts_with("EPSG:");
                Self { crs: Some(crs), said: format!("EPSG:{code}"), warning: None, north_first }
            }
            Err(e) => unknown(Some(format!("its system EPSG:{code} is not known ({e}); set crs"))),
        }
    }
}

/// The first EPSG code that a name holds.
fn code(name: &str) -> Option<u32> {
    let of_epsg = |part: &&str| part.to_ascii_lowercase().contains("epsg");
    let last_number = |part: &str| part.rsplit([':', '/', '#']).next().and_then(|n| n.trim().parse().ok());
    let zone = |mark: &str| {
        let rest = &name[name.find(mark)? + mark.len()..];
        rest.split(|c: char| !c.is_ascii_digit()).next()?.parse::<u32>().ok()
    };
    name.split(',')
        .filter(of_epsg)
        .find_map(last_number)
        .or_else(|| zone("ETRS89_UTM").filter(|z| (28..=38).contains(z)).map(|z| 25800 + z))
        .or_else(|| zone("DE_DHDN_3GK").filter(|z| (2..=5).contains(z)).map(|z| 31464 + z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_systems_are_understood() {
        for (name, want) in [
            ("EPSG:25833", Some(25833)),
            ("urn:ogc:def:crs:EPSG::25832", Some(25832)),
            ("urn:ogc:def:crs,crs:EPSG:6.12:3068,crs:EPSG:6.12:5783", Some(3068)),
            ("https://www.opengis.net/def/crs/EPSG/0/7415", Some(7415)),
            ("http://www.opengis.net/gml/srs/epsg.xml#4326", Some(4326)),
            ("urn:adv:crs:ETRS89_UTM32*DE_DHHN92_NH", Some(25832)),
            ("urn:adv:crs:DE_DHDN_3GK4*DE_DHN92_NH", Some(31468)),
            ("ETRS89_UTM99", None),
            ("EPSG:", None),
            ("local", None),
            ("", None),
        ] {
            assert_eq!(code(name), want, "{name}");
        }
        assert_eq!(Reference::of("urn:ogc:def:crs:EPSG::7415").crs.and_then(|c| c.epsg()), Some(28992));
        assert!(Reference::of("").warning.is_none() && Reference::of("local").warning.is_some());
        assert!(Reference::of("urn:ogc:def:crs:EPSG::4326").north_first && !Reference::of("EPSG:4326").north_first);
    }
}
