//! Phantom positions: exactly 0, 0 far from all other positions (a receiver without a fix, an empty field), and impossible jumps in
//! recorded tracks.

use super::{Geometry, Vectors, Vertex};
use belvedere_core::{Warning, WarningKind};
use glam::DVec2;

/// Mean radius of the earth, metres.
const EARTH_M: f64 = 6_371_008.8;
/// A position 0, 0 is valid if another position lies within this distance, degrees and metres.
const NEAR_DEG: f64 = 1.0;
const NEAR_M: f64 = 100_000.0;
/// A position 0, 0 is valid if the median step of the line's other vertices exceeds this share of their least distance to it.
const STEP_SHARE: f64 = 0.1;
/// Least speed of a jump in a recorded track: m/s, and as a multiple of the median speed.
const FASTEST: f64 = 150.0;
const FASTER: f64 = 8.0;
/// Least length of a jump: metres, and as a multiple of the median step.
const LEAST_M: f64 = 300.0;
const LEAST_STEPS: f64 = 20.0;
/// Least length of a jump without times: metres, and as a multiple of the median step.
const FAR_M: f64 = 5_000.0;
const FAR_STEPS: f64 = 50.0;
/// Without times: least distance of a false excursion, metres, and its most vertices.
const AWAY_M: f64 = 1_000.0;
const AWAY_VERTICES: usize = 3;
/// Least vertices of a line in which excursions are looked for.
const LEAST_OF_LINE: usize = 10;

/// Numbers of phantom positions and jumps.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(super) struct Phantoms {
    /// Positions at exactly 0, 0 that were dropped.
    pub(super) zeros: usize,
    /// Jumps at which lines were split.
    pub(super) jumps: usize,
    /// Length of the longest jump, metres.
    pub(super) longest_m: f64,
}

impl Phantoms {
    /// One sentence, if anything was found.
    pub(super) fn say(&self) -> Option<Warning> {
        let zeros = format!(
            "{} positions at exactly 0, 0, far from everything else, were dropped, and lines were split there",
            self.zeros
        );
        let jumps = format!(
            "{} jumps of up to {:.1} km that no walker makes split its tracks",
            self.jumps,
            self.longest_m / 1000.0
        );
        let text = match (self.zeros, self.jumps) {
            (0, 0) => return None,
            (_, 0) => zeros,
            (0, _) => jumps,
            _ => format!("{zeros}; {jumps}"),
        };
        let warning = Warning::new(WarningKind::Repaired, text).with("zeros", self.zeros as f64);
        Some(warning.with("jumps", self.jumps as f64).with("longest_jump_m", self.longest_m))
    }
}

/// A vertex of a recorded track, and its time, seconds.
pub(super) type Recorded = (Vertex, Option<f64>);

/// Metres between two positions in degrees.
fn metres(a: DVec2, b: DVec2) -> f64 {
    let lon = (b.x - a.x + 180.0).rem_euclid(360.0) - 180.0;
    DVec2::new(lon * (0.5 * (a.y + b.y)).to_radians().cos(), b.y - a.y).length().to_radians() * EARTH_M
}

fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Whether 0, 0 is a phantom in a line of these vertices. `near`: distance of another vertex within which it is valid.
fn is_phantom_zero(line: &[DVec2], near: f64) -> bool {
    let others = || line.iter().copied().filter(|p| *p != DVec2::ZERO);
    let nearest = others().map(DVec2::length).fold(f64::INFINITY, f64::min);
    if !nearest.is_finite() || nearest <= near {
        return false;
    }
    let known: Vec<DVec2> = others().collect();
    let step = median(known.windows(2).map(|w| w[0].distance(w[1])).collect());
    step <= STEP_SHARE * nearest
}

/// The runs of a line between phantom positions at exactly 0, 0.
fn between_zeros<T: Copy>(line: &[T], at: impl Fn(&T) -> DVec2, near: f64, found: &mut Phantoms) -> Vec<Vec<T>> {
    let places: Vec<DVec2> = line.iter().map(&at).collect();
    if !places.contains(&DVec2::ZERO) || !is_phantom_zero(&places, near) {
        return vec![line.to_vec()];
    }
    found.zeros += places.iter().filter(|p| **p == DVec2::ZERO).count();
    line.split(|v| at(v) == DVec2::ZERO).filter(|run| !run.is_empty()).map(<[T]>::to_vec).collect()
}

/// The runs of a recorded track, split at phantom positions and jumps; longitudes and latitudes.
pub(super) fn runs(track: &[Recorded], found: &mut Phantoms) -> Vec<Vec<Recorded>> {
    let runs = between_zeros(track, |(v, _)| v.xy, NEAR_DEG, found);
    runs.into_iter().flat_map(|run| without_jumps(&run, found)).collect()
}

fn without_jumps(track: &[Recorded], found: &mut Phantoms) -> Vec<Vec<Recorded>> {
    let steps: Vec<f64> = track.windows(2).map(|w| metres(w[0].0.xy, w[1].0.xy)).collect();
    let step = median(steps.iter().copied().filter(|s| *s > 0.0).collect());
    let seconds = |k: usize| track[k].1.zip(track[k + 1].1).map(|(a, b)| (b - a).abs());
    let speeds: Vec<Option<f64>> =
        steps.iter().enumerate().map(|(k, s)| seconds(k).map(|t| s / t.max(0.001))).collect();
    let speed = median(speeds.iter().flatten().copied().filter(|v| *v > 0.0).collect());
    let mut jumps: Vec<bool> = (0..steps.len())
        .map(|k| match speeds[k] {
            Some(v) => v > FASTEST.max(FASTER * speed) && steps[k] > LEAST_M.max(LEAST_STEPS * step),
            None => steps[k] > FAR_M.max(FAR_STEPS * step),
        })
        .collect();
    mark_excursions(track, &steps, step, &speeds, &mut jumps);
    let mut out = vec![Vec::new()];
    for (k, recorded) in track.iter().enumerate() {
        if k > 0 && jumps[k - 1] {
            found.jumps += 1;
            found.longest_m = found.longest_m.max(steps[k - 1]);
            out.push(Vec::new());
        }
        if let Some(run) = out.last_mut() {
            run.push(*recorded);
        }
    }
    out
}

/// Marks both ends of excursions: a few vertices far away from the track before and after them.
fn mark_excursions(track: &[Recorded], steps: &[f64], step: f64, speeds: &[Option<f64>], jumps: &mut [bool]) {
    let away = |k: usize| steps[k] > AWAY_M.max(LEAST_STEPS * step) && speeds[k].is_none();
    for k in (0..steps.len()).filter(|k| away(*k)) {
        let back = (k + 1..steps.len().min(k + 1 + AWAY_VERTICES)).find(|j| away(*j));
        if let Some(j) = back
            && metres(track[k].0.xy, track[j + 1].0.xy) < 0.25 * steps[k].min(steps[j])
        {
            (jumps[k], jumps[j]) = (true, true);
        }
    }
}

/// Splits lines in longitude and latitude that are no recorded tracks at false excursions: a few vertices far away, after which the line
/// goes on where it was. Other long pieces stay: ferries, borders, drawn lines.
pub(super) fn drop_excursions(vectors: &mut Vectors, found: &mut Phantoms) {
    if vectors.crs.is_local() || !vectors.crs.is_geographic() {
        return;
    }
    for feature in &mut vectors.features {
        if let Geometry::Lines(lines) = &mut feature.geometry
            && lines.iter().any(|line| line.len() >= LEAST_OF_LINE)
        {
            let runs = lines.iter().flat_map(|line| without_excursions(line, found));
            *lines = runs.filter(|run| run.len() >= 2).collect();
        }
    }
    vectors.features.retain(|f| f.geometry.vertices().next().is_some());
}

fn without_excursions(line: &[Vertex], found: &mut Phantoms) -> Vec<Vec<Vertex>> {
    let steps: Vec<f64> = line.windows(2).map(|w| metres(w[0].xy, w[1].xy)).collect();
    let step = median(steps.iter().copied().filter(|s| *s > 0.0).collect());
    let away = |k: usize| steps[k] > FAR_M.max(FAR_STEPS * step);
    let mut out = vec![Vec::new()];
    let mut until = 0;
    for (k, vertex) in line.iter().enumerate() {
        if k > 0 && k > until && away(k - 1) {
            let back = (k..steps.len().min(k + AWAY_VERTICES)).find(|j| away(*j));
            let returns = |j: &usize| metres(line[k - 1].xy, line[j + 1].xy) < 0.25 * steps[k - 1].min(steps[*j]);
            if let Some(j) = back.filter(returns) {
                found.jumps += 2;
                found.longest_m = found.longest_m.max(steps[k - 1]).max(steps[j]);
                until = j;
                out.push(Vec::new());
            }
        }
        if (k > until || until == 0)
            && let Some(run) = out.last_mut()
        {
            run.push(*vertex);
        }
    }
    out
}

/// Drops positions at exactly 0, 0 from everything in a file, splitting lines there. Files in unknown systems stay as they are.
pub(super) fn drop_zeros(vectors: &mut Vectors, found: &mut Phantoms) {
    let near = match (vectors.crs.is_local(), vectors.crs.metres_per_unit()) {
        (true, _) => return,
        (_, Some(m)) => NEAR_M / m,
        (_, None) => NEAR_DEG,
    };
    let others = vectors.features.iter().flat_map(|f| f.geometry.vertices()).map(|v| v.xy);
    let nearest = others.filter(|p| *p != DVec2::ZERO).map(DVec2::length).fold(f64::INFINITY, f64::min);
    let alone = nearest.is_finite() && nearest > near;
    if !alone {
        return;
    }
    for feature in &mut vectors.features {
        match &mut feature.geometry {
            Geometry::Points(points) => {
                let before = points.len();
                points.retain(|v| v.xy != DVec2::ZERO);
                found.zeros += before - points.len();
            }
            Geometry::Lines(lines) => {
                let runs = lines.iter().flat_map(|line| between_zeros(line, |v| v.xy, near, found));
                let runs: Vec<Vec<Vertex>> = runs.filter(|run| run.len() >= 2).collect();
                *lines = runs;
            }
            Geometry::Polygons(polygons) => {
                for ring in polygons.iter_mut().flatten() {
                    let places: Vec<DVec2> = ring.iter().map(|v| v.xy).collect();
                    if places.contains(&DVec2::ZERO) && is_phantom_zero(&places, near) {
                        let before = ring.len();
                        ring.retain(|v| v.xy != DVec2::ZERO);
                        found.zeros += before - ring.len();
                    }
                }
                polygons.retain_mut(|rings| {
                    let outer = rings.first().is_some_and(|ring| ring.len() >= 3);
                    rings.retain(|ring| ring.len() >= 3);
                    outer
                });
            }
        }
    }
    vectors.features.retain(|f| f.geometry.vertices().next().is_some());
}

#[cfg(test)]
mod tests;
