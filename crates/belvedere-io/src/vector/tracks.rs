//! Recorded tracks and routes as lines, whatever their file: points alone are joined, jumps part them, and what is no line is counted.

use super::phantom::{self, Phantoms, Recorded};
use super::{Geometry, VectorFeature, Vectors, Vertex, vertex};
use crate::crs::CoordinateSystem;
use crate::{IoError, Loaded};
use belvedere_core::{Warning, WarningKind};
use glam::DVec2;
use std::collections::BTreeMap;
use std::path::Path;

/// Least number of consecutive tracks of one point each that are one line.
const LEAST_ALONE: usize = 3;

/// Features made of tracks, and counts of what is left out.
#[derive(Default)]
pub(super) struct Tracks {
    pub(super) features: Vec<VectorFeature>,
    pub(super) dropped_points: usize,
    empty_segments: usize,
    single_points: usize,
    /// Lines of equal points.
    one_position: usize,
    /// Segments, tracks and routes of one point each that were joined.
    joined: usize,
    /// Points of the last tracks or routes, each the only one of its own.
    alone: Vec<Recorded>,
    /// Name and properties of the first of them.
    alone_as: (String, BTreeMap<String, String>),
    phantoms: Phantoms,
    /// Longitude, latitude and time of every point of a track that has a time.
    pub(super) timed: Vec<(DVec2, f64)>,
}

impl Tracks {
    /// Adds the segments of a track or route as lines. Some programs put every point into a segment of its own.
    ///
    /// * `kind`: `track` for what was recorded, else the property `kind` of the feature.
    pub(super) fn add(
        &mut self,
        kind: &str,
        name: String,
        properties: BTreeMap<String, String>,
        segments: Vec<Vec<Recorded>>,
    ) {
        let mut lines: Vec<Vec<Recorded>> = Vec::new();
        let mut single = false;
        for segment in segments {
            self.timed.extend(segment.iter().filter_map(|(v, time)| Some((v.xy, (*time)?))));
            if segment.len() == 1 && single {
                self.joined += 1;
                if let Some(line) = lines.last_mut() {
                    self.joined += usize::from(line.len() == 1);
                    line.extend(segment);
                }
                continue;
            }
            single = segment.len() == 1;
            lines.push(segment);
        }
        let only = matches!(lines.as_slice(), [line] if line.len() == 1);
        if only {
            if self.alone.is_empty() {
                self.alone_as = (name.clone(), properties.clone());
            }
            self.alone.extend(lines.iter().flatten());
        } else {
            self.end_alone();
        }
        let mut kept = Vec::new();
        for line in lines {
            if line.is_empty() {
                self.empty_segments += 1;
                continue;
            }
            let runs = if kind == "track" { phantom::runs(&line, &mut self.phantoms) } else { vec![line] };
            let parted = runs.len() > 1;
            for run in runs {
                let run: Vec<Vertex> = run.into_iter().map(|(v, _)| v).collect();
                match run.as_slice() {
                    [_] if parted => {} // counted as a jump
                    [_] if only => {}   // kept in `alone`
                    [_] => self.single_points += 1,
                    [first, rest @ ..] if rest.iter().all(|v| v.xy == first.xy) => self.one_position += 1,
                    _ => kept.push(run),
                }
            }
        }
        if !kept.is_empty() {
            self.push(kind, name, properties, Geometry::Lines(kept));
        }
    }

    /// Tracks or routes of one point each, which some programs write for every position, as one line; two or fewer are dropped. To be called
    /// once more after the last.
    pub(super) fn end_alone(&mut self) {
        let points = std::mem::take(&mut self.alone);
        if points.len() < LEAST_ALONE {
            self.single_points += points.len();
            return;
        }
        self.joined += points.len();
        let runs = phantom::runs(&points, &mut self.phantoms);
        let lines = runs.into_iter().map(|run| run.into_iter().map(|(v, _)| v).collect::<Vec<Vertex>>());
        let lines: Vec<_> = lines.filter(|run| run.iter().any(|v| v.xy != run[0].xy)).collect();
        if !lines.is_empty() {
            let (name, properties) = std::mem::take(&mut self.alone_as);
            self.push("track", name, properties, Geometry::Lines(lines));
        }
    }

    /// Adds a feature.
    pub(super) fn push(
        &mut self,
        kind: &str,
        name: String,
        mut properties: BTreeMap<String, String>,
        geometry: Geometry,
    ) {
        properties.insert("kind".into(), kind.into());
        self.features.push(VectorFeature { style: None, name, properties, geometry });
    }

    /// What was left out, joined and parted.
    pub(super) fn warnings(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        let mut warn = |kind: WarningKind, count: usize, what: &str| {
            warnings.extend(Warning::counted(kind, count, what));
        };
        warn(WarningKind::Ignored, self.dropped_points, "points without a valid latitude and longitude were dropped");
        warn(WarningKind::Ignored, self.empty_segments, "segments without points were dropped");
        warn(
            WarningKind::Ignored,
            self.single_points,
            "tracks, segments or routes of a single point were dropped, a line needs 2",
        );
        warn(
            WarningKind::Ignored,
            self.one_position,
            "tracks, segments or routes of one position only were dropped, a line needs 2",
        );
        warn(
            WarningKind::Repaired,
            self.joined,
            "segments, tracks or routes of a single point each were joined to lines",
        );
        warnings.extend(self.phantoms.say());
        warnings
    }

    /// The content of a file in longitude and latitude.
    ///
    /// * `held`: what the file holds, in words, for the error of a file without a usable position.
    /// * `damage`: why it could not be read further.
    pub(super) fn loaded(
        self,
        path: &Path,
        format: &'static str,
        held: &str,
        damage: Option<String>,
    ) -> Result<Loaded<Vectors>, IoError> {
        let mut warnings = self.warnings();
        if self.features.is_empty() {
            let reason = match damage {
                Some(damage) => format!("{damage}, get it again"),
                None if self.one_position > 0 => format!(
                    "{format} holds {} lines of one position only and nothing else; a line needs 2 that differ, choose another file",
                    self.one_position
                ),
                None => format!(
                    "{format} holds {held}, but none with a usable position (a line needs 2); choose another file"
                ),
            };
            return Err(IoError::format(path, reason));
        }
        warnings.extend(damage.map(|damage| salvaged(&damage, &self.features)));
        let crs = CoordinateSystem::wgs84().map_err(|e| IoError::format(path, e.to_string()))?;
        let warnings = warnings.into_iter().map(|w| w.in_file(path)).collect();
        let (path, layer) = (path.into(), String::new());
        let value = Vectors { path, format, layer, crs, crs_stated: true, features: self.features };
        Ok(Loaded::new(value, warnings))
    }
}

/// What is said of a file that is damaged, and read up to there.
pub(super) fn salvaged(damage: &str, features: &[VectorFeature]) -> Warning {
    let points: usize = features.iter().map(|feature| feature.geometry.vertices().count()).sum();
    let text = format!("{damage}; what is whole before is drawn, {points} points");
    Warning::new(WarningKind::Repaired, text).with("points", points as f64)
}

/// A position in degrees; `None` if it lies nowhere on the earth.
pub(super) fn on_earth(lon: f64, lat: f64, height: Option<f64>) -> Option<Vertex> {
    vertex(lon, lat, height).filter(|v| v.xy.y.abs() <= 90.0 && v.xy.x.abs() <= 360.0)
}

/// Seconds from 1970 on of a time such as `2024-07-06T10:00:00.5Z`; time zones are ignored, for only differences count.
pub(super) fn seconds(text: &str) -> Option<f64> {
    let (date, time) = text.trim().split_once('T')?;
    let mut date = date.splitn(3, '-').map(|n| n.parse::<i64>().ok());
    let (year, month, day) = (date.next()??, date.next()??, date.next()??);
    let clock: String = time.chars().take_while(|c| c.is_ascii_digit() || matches!(c, ':' | '.')).collect();
    let mut clock = clock.splitn(3, ':').map(|n| n.parse::<f64>().ok());
    let (hours, minutes, seconds) = (clock.next()??, clock.next()??, clock.next().flatten().unwrap_or(0.0));
    let fine = (1..=12).contains(&month) && (1..=31).contains(&day) && (0..=9999).contains(&year);
    // Days from the first of March of year 0 on: months from March have 30.6 days when rounded down.
    let (y, m) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let days = 365 * y + y.div_euclid(4) - y.div_euclid(100) + y.div_euclid(400) + (153 * m + 2) / 5 + day;
    fine.then(|| 86_400.0 * (days - 719_469) as f64 + 3600.0 * hours + 60.0 * minutes + seconds)
}

/// A number, with a decimal point or comma.
pub(super) fn number(text: &str) -> Option<f64> {
    let text = text.trim();
    text.parse().ok().or_else(|| text.replacen(',', ".", 1).parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_seconds() {
        for (text, want) in [
            ("1970-01-01T00:00:00Z", 0.0),
            ("2024-03-01T00:00:00Z", 1_709_251_200.0),
            ("2024-02-29T23:59:59.5+02:00", 1_709_251_199.5),
            ("2000-12-31T12:00Z", 978_264_000.0),
        ] {
            assert_eq!(seconds(text), Some(want), "{text}");
        }
        for text in ["", "2024-03-01", "x-y-zT1:2:3", "2024-13-01T00:00:00Z"] {
            assert_eq!(seconds(text), None, "{text}");
        }
    }
}
