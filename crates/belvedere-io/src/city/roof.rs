//! Blocks on slopes: roofs that follow the ground, and walls from the roof down to it.

use super::tin::Tin;
use belvedere_scene::{CityFace, Polygon, Surface};
use earcut::Earcut;
use glam::{DMat3, DVec2, DVec3};

/// Spacing of the samples of the ground, metres.
const LOOK_EVERY_M: f64 = 6.0;
/// Largest error of a roof's height over its ground: the greater of a share of the height, and metres.
const OFF: [f64; 2] = [0.25, 1.0];
/// Least height of a roof over its ground anywhere, as a share of the block's height.
const CLEAR: f64 = 0.5;
/// Area per triangle that a roof may have beyond those of its outline, m^2.
const LEAST_TRIANGLE_M2: f64 = 250.0;

/// A prism on ground that is not level, closed: its roof lies `height_m` over the ground on average, on one plane where that is near
/// enough, else in facets; its floor follows the ground `foot_m` or more below it.
///
/// * `ground`: height of the ground at a position; where it is `None` the mean is taken.
/// * `foot_m`: least depth of the walls in the ground, metres, >= 0.
///
/// `None` if no height of the ground under it is known.
pub fn prism_on(
    footprint: &[Polygon],
    height_m: f64,
    foot_m: f64,
    ground: &dyn Fn(DVec2) -> Option<f64>,
) -> Option<Vec<CityFace>> {
    let mut earcut = Earcut::new();
    let mut faces = Vec::new();
    for polygon in footprint {
        if let Some(tin) = Tin::of(polygon, &mut earcut) {
            faces.extend(part_on(polygon, tin, height_m, foot_m, ground)?);
        } else {
            let rim = polygon.outer.iter().filter_map(|p| ground(*p));
            let [low, high] = rim.fold([f64::MAX, f64::MIN], |[a, b], z| [a.min(z), b.max(z)]);
            if low > high {
                return None;
            }
            faces.extend(between(polygon, &|_| low - foot_m, &|_| high + height_m));
        }
    }
    Some(faces)
}

/// Mean of the known ground heights, and the least-squares plane through them.
struct Under {
    mean: f64,
    origin: DVec2,
    /// Slopes along x and y, and height at the origin.
    plane: DVec3,
}

impl Under {
    fn of(tin: &Tin, ground: &dyn Fn(DVec2) -> Option<f64>) -> Option<Self> {
        let origin = tin.points[0];
        let (mut matrix, mut right, mut sum) = (DMat3::ZERO, DVec3::ZERO, [0.0; 2]);
        for sample in (0..tin.triangles.len()).flat_map(|t| tin.samples(t, LOOK_EVERY_M)) {
            let Some(z) = ground(sample.at) else { continue };
            let (row, weight) = ((sample.at - origin).extend(1.0), sample.area_m2.max(1e-6));
            matrix += DMat3::from_cols(row * row.x, row * row.y, row * row.z) * weight;
            right += row * z * weight;
            sum = [sum[0] + weight, sum[1] + weight * z];
        }
        let mean = (sum[0] > 0.0).then(|| sum[1] / sum[0])?;
        // Too steep, or known along a line only: level.
        let solved = matrix.inverse() * (right - matrix * DVec3::new(0.0, 0.0, mean));
        let plane = if solved.is_finite() && solved.truncate().length() < 4.0 { solved } else { DVec3::ZERO };
        Some(Self { mean, origin, plane: plane + DVec3::new(0.0, 0.0, mean) })
    }

    fn plane_at(&self, p: DVec2) -> f64 {
        self.plane.dot((p - self.origin).extend(1.0))
    }
}

/// The prism over one polygon of a block.
fn part_on(
    polygon: &Polygon,
    mut tin: Tin,
    height_m: f64,
    foot_m: f64,
    ground: &dyn Fn(DVec2) -> Option<f64>,
) -> Option<Vec<CityFace>> {
    let under = Under::of(&tin, ground)?;
    let tolerance = (OFF[0] * height_m).max(OFF[1]);
    // Least, largest and mean height of the ground over a surface.
    let range = |tin: &Tin, surface: &dyn Fn(usize, [f64; 3], DVec2) -> f64| {
        let samples = (0..tin.triangles.len()).flat_map(|t| tin.samples(t, LOOK_EVERY_M));
        let ([below, above], [sum, area]) = samples.fold(([0.0f64; 2], [0.0; 2]), |([low, high], [sum, area]), s| {
            let off = ground(s.at).map_or(0.0, |z| z - surface(s.triangle, s.shares, s.at));
            ([low.min(off), high.max(off)], [sum + s.area_m2 * off, area + s.area_m2])
        });
        [below, above, sum / area.max(f64::MIN_POSITIVE)]
    };
    let heights = |[below, above, mean]: [f64; 3]| {
        let roof = (height_m + mean).max(above + CLEAR * height_m);
        [below - foot_m, roof]
    };
    let plane = range(&tin, &|_, _, at| under.plane_at(at));
    if plane[1] - plane[0] <= 2.0 * tolerance && plane[1].max(-plane[0]) <= 1.5 * tolerance {
        let [floor, roof] = heights(plane);
        return Some(between(polygon, &|p| under.plane_at(p) + floor, &|p| under.plane_at(p) + roof));
    }
    let at = |p: DVec2| ground(p).unwrap_or(under.mean);
    let area: f64 = (0..tin.triangles.len()).flat_map(|t| tin.samples(t, f64::MAX)).map(|s| s.area_m2).sum();
    let most = tin.triangles.len() + (area / LEAST_TRIANGLE_M2) as usize;
    tin.refine(tolerance, most, |tin, number| {
        let z = tin.triangles[number].map(|v| at(tin.points[v as usize]));
        let off = |s: super::tin::Sample| {
            ground(s.at).map_or(0.0, |g| (g - (0..3).map(|k| s.shares[k] * z[k]).sum::<f64>()).abs())
        };
        tin.samples(number, LOOK_EVERY_M).map(off).fold(0.0, f64::max)
    });
    let z: Vec<f64> = tin.points.iter().map(|p| at(*p)).collect();
    let off = range(&tin, &|t, shares, _| (0..3).map(|k| shares[k] * z[tin.triangles[t][k] as usize]).sum());
    Some(faceted(&tin, &z, heights(off)))
}

/// A prism between two heights over a polygon.
fn between(polygon: &Polygon, low: &dyn Fn(DVec2) -> f64, high: &dyn Fn(DVec2) -> f64) -> Vec<CityFace> {
    let rings = || std::iter::once(&polygon.outer).chain(&polygon.holes);
    let lifted = |z: &dyn Fn(DVec2) -> f64| -> Vec<Vec<DVec3>> {
        rings().map(|ring| ring.iter().map(|p| p.extend(z(*p))).collect()).collect()
    };
    let mut floor = lifted(low);
    floor.iter_mut().for_each(|ring| ring.reverse());
    let mut faces = vec![
        CityFace { surface: Surface::Ground, rings: floor, picture: None },
        CityFace { surface: Surface::Roof, rings: lifted(high), picture: None },
    ];
    for ring in rings() {
        for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            faces.push(wall([a.extend(low(*a)), b.extend(low(*b))], [high(*a), high(*b)]));
        }
    }
    faces
}

fn wall([a, b]: [DVec3; 2], [top_a, top_b]: [f64; 2]) -> CityFace {
    let ring = vec![a, b, b.truncate().extend(top_b), a.truncate().extend(top_a)];
    CityFace { surface: Surface::Wall, rings: vec![ring], picture: None }
}

/// A prism of triangles: its floor and roof lie at the heights `z` of their corners plus `floor` and `roof`.
fn faceted(tin: &Tin, z: &[f64], [floor, roof]: [f64; 2]) -> Vec<CityFace> {
    let corner = |v: u32, by: f64| tin.points[v as usize].extend(z[v as usize] + by);
    let mut faces = Vec::new();
    for [a, b, c] in &tin.triangles {
        let of = |corners: [u32; 3], by: f64| vec![corners.map(|v| corner(v, by)).to_vec()];
        faces.push(CityFace { surface: Surface::Ground, rings: of([*a, *c, *b], floor), picture: None });
        faces.push(CityFace { surface: Surface::Roof, rings: of([*a, *b, *c], roof), picture: None });
    }
    for [a, b] in tin.rim() {
        let tops = [a, b].map(|v| z[v as usize] + roof);
        faces.push(wall([corner(a, floor), corner(b, floor)], tops));
    }
    faces
}

#[cfg(test)]
mod tests;
