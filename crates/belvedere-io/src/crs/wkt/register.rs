//! The EPSG code of a system that a text gives by its parameters: the one on the same datum whose projection is the same.

use super::super::tables;
use super::{GEOGRAPHIC, Node, PROJECTED, plain};
use crate::crs::CoordinateSystem;
use std::collections::BTreeMap;

/// Largest difference of equal numbers: angles in degrees, lengths in metres, factors.
const SAME_DEG: f64 = 1e-6;
const SAME_M: f64 = 0.01;
const SAME_FACTOR: f64 = 1e-8;

/// EPSG code of the geographic system of a text, by its own name or that of its datum.
fn geographic(system: &Node) -> Option<u32> {
    let geographic = if system.is(&PROJECTED) { system.child(&GEOGRAPHIC)? } else { system };
    let datum = geographic.child(&["DATUM", "GEODETICDATUM", "TRF", "ENSEMBLE"]);
    let meridian = geographic.child(&["PRIMEM", "PRIMEMERIDIAN"]).and_then(|m| m.numbers.first()).copied();
    let by_name = tables::geographic(&format!("={}", plain(geographic.name())));
    let by_datum = || datum.and_then(|d| tables::geographic(&plain(d.name())));
    // Datums have the prime meridian of Greenwich; systems of other meridians have names of their own.
    by_name.or_else(|| if meridian.unwrap_or(0.0) == 0.0 { by_datum() } else { None })
}

/// EPSG code of a text with this PROJ string; `None` if no code fits, or if the text has a datum shift of its own.
pub(super) fn code_of(system: &Node, proj_string: &str) -> Option<u32> {
    if proj_string.contains("+towgs84=") && !proj_string.contains("+towgs84=0,0,0") {
        return None;
    }
    let base = geographic(system)?;
    if !system.is(&PROJECTED) {
        return Some(base);
    }
    code_of_parameters(base, proj_string)
}

/// EPSG code of the projected system on a geographic one that has the projection of a PROJ string.
pub(crate) fn code_of_parameters(base: u32, proj_string: &str) -> Option<u32> {
    let wanted = Parameters::of(proj_string);
    let same = |code: &u32| tables::definition(*code).is_ok_and(|text| Parameters::of(&text).same(&wanted));
    // UTM on ETRS 89 has codes of its own for axes to the north and east.
    tables::projected_on(base).filter(same).min_by_key(|code| (3038..=3051).contains(code))
}

/// The PROJ string with the shift of a known datum, where the text gives none.
pub(super) fn on_known_datum(system: &Node, proj_string: &str) -> String {
    let has_shift = ["+towgs84=", "+datum=", "+nadgrids="].iter().any(|k| proj_string.contains(k));
    let base = if has_shift { None } else { geographic(system) };
    let base = base.and_then(|code| CoordinateSystem::from_epsg(code).ok());
    let shift = base.as_ref().and_then(|b| b.proj_string().split(' ').find(|p| p.starts_with("+towgs84=")));
    match shift {
        Some(shift) => format!("{proj_string} {shift}"),
        None => proj_string.to_owned(),
    }
}

/// Method and parameters of a projection in a PROJ string, without the datum.
#[derive(Debug)]
struct Parameters {
    method: String,
    numbers: BTreeMap<String, f64>,
}

impl Parameters {
    fn of(text: &str) -> Self {
        let (mut method, mut numbers) = (String::new(), BTreeMap::new());
        let (mut south, mut axes) = (false, "");
        for part in text.split_whitespace().map(|p| p.trim_start_matches('+')) {
            let (key, value) = part.split_once('=').unwrap_or((part, ""));
            let key = match key {
                "k_0" => "k",
                "proj" => {
                    method = value.to_owned();
                    continue;
                }
                "units" => {
                    let metres = match value {
                        "us-ft" => 1200.0 / 3937.0,
                        "ft" => 0.3048,
                        "km" => 1000.0,
                        _ => 1.0,
                    };
                    numbers.insert("to_meter".into(), metres);
                    continue;
                }
                "south" => {
                    south = true;
                    continue;
                }
                "axis" => {
                    axes = value;
                    continue;
                }
                "lat_0" | "lat_1" | "lat_2" | "lat_ts" | "lon_0" | "lonc" | "alpha" | "gamma" | "k" | "x_0" | "y_0"
                | "zone" | "to_meter" => key,
                "no_uoff" => {
                    numbers.insert(key.into(), 1.0);
                    continue;
                }
                _ => continue,
            };
            if let Ok(number) = value.parse::<f64>() {
                numbers.insert(key.into(), number);
            }
        }
        let mut out = Self { method, numbers };
        out.simplify(south);
        if axes != "enu" {
            out.method.push_str(axes); // such as wsu
        }
        out
    }

    /// Normal form: UTM as transverse Mercator, and standard parallels in one order.
    fn simplify(&mut self, south: bool) {
        if self.method == "utm"
            && let Some(zone) = self.numbers.remove("zone")
        {
            self.method = "tmerc".into();
            let y_0 = if south { 1e7 } else { 0.0 };
            for (key, value) in [("lon_0", 6.0 * zone - 183.0), ("k", 0.9996), ("x_0", 5e5), ("y_0", y_0)] {
                self.numbers.insert(key.into(), value);
            }
        }
        if self.method == "lcc" && !self.numbers.contains_key("lat_2") {
            let only = self.numbers.get("lat_1").or(self.numbers.get("lat_0")).copied().unwrap_or(0.0);
            self.numbers.insert("lat_1".into(), only);
            self.numbers.insert("lat_2".into(), only);
        }
        if let (Some(a), Some(b)) = (self.numbers.get("lat_1").copied(), self.numbers.get("lat_2").copied())
            && a > b
        {
            self.numbers.insert("lat_1".into(), b);
            self.numbers.insert("lat_2".into(), a);
        }
        if self.method == "omerc" && !self.numbers.contains_key("gamma") {
            let alpha = self.numbers.get("alpha").copied().unwrap_or(90.0);
            self.numbers.insert("gamma".into(), alpha);
        }
    }

    fn same(&self, other: &Self) -> bool {
        let near = |key: &str| {
            let [a, b] = [self, other].map(|p| p.numbers.get(key).copied());
            let usual = if matches!(key, "k" | "to_meter") { 1.0 } else { 0.0 };
            let tolerance = match key {
                "k" | "to_meter" => SAME_FACTOR,
                "x_0" | "y_0" => SAME_M,
                _ => SAME_DEG,
            };
            (a.unwrap_or(usual) - b.unwrap_or(usual)).abs() <= tolerance
        };
        self.method == other.method && self.numbers.keys().chain(other.numbers.keys()).all(|key| near(key))
    }
}
