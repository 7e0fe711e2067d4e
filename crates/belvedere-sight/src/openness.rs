//! Ambient occlusion, computed once: the share of the light from all around that reaches a mesh.

use crate::MeshTree;
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{Cancelled, Mesh, Progress, triangle_lattice};
use rayon::prelude::*;

/// Settings of ambient occlusion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OpennessSettings {
    /// Distance beyond which surfaces take no light, scene units, > 0; at a distance r they take `1 - (r / reach)^2`.
    pub reach: f64,
    /// Largest spacing of the sample points on a triangle, scene units, > 0.
    pub step: f64,
    /// Rays per sample point.
    pub rays: usize,
}

impl OpennessSettings {
    /// Points a fifth of the reach apart, 32 rays each.
    pub fn reaching(reach: f64) -> Self {
        Self { reach, step: 0.2 * reach, rays: 32 }
    }
}

/// Most steps along an edge.
const MOST_STEPS: f64 = 255.0;
/// Most sample points of a triangle per point that its area and its longest edge need; this limits the steps of slivers.
const SURPLUS: f64 = 4.0;
/// Distance of ray origins from the surface, share of the reach.
const LIFT: f64 = 1e-3;
/// Shift of sample points towards the middle of their triangle: a share of that distance, and its limit as a share of the reach.
const INWARDS: f64 = 0.02;
const MOST_INWARDS: f64 = 0.01;
/// A side with a smaller share may be the inside of a closed surface: then the other side is sampled, too.
const INSIDE: f64 = 0.3;
/// Triangles that are computed at a time.
const BATCH: usize = 256;
/// Most sample points of a mesh: so many times its triangles, and so many more, which show all that a picture has room for.
const MOST_POINTS: [usize; 2] = [64, 1 << 17];
/// Factor by which points move apart until there are no more than that.
const APART: f64 = 1.25;

/// Height of the ground at a position in plan; `None` beside the ground.
pub type GroundHeight<'a> = dyn Fn(DVec2) -> Option<f64> + Sync + 'a;

/// A mesh with ambient occlusion, and how it was sampled.
#[derive(Debug, Clone)]
pub struct Occluded {
    /// The mesh.
    pub mesh: Mesh,
    /// Spacing of the sample points, scene units: that of the settings, or a larger one where there would be too many points.
    pub step: f64,
    /// Triangles that take all light, because the time was up before they were sampled.
    pub left_out: usize,
}

/// The mesh with the share of the light from all around that reaches it past itself and the ground, on the lighter side of each triangle.
/// The sample points are at most 64 times as many as triangles, and 131,072 more. When the time of `progress` is up, the other triangles
/// take all light.
///
/// Rays are spread by the cosine to the normal; their lengths are spread so that a hit at r counts `1 - (r / reach)^2` on average, and each
/// ray is only a yes-or-no test. Source: Pasewaldt et al. 2011, section 6; the rule in our specification, section 7.
///
/// # Errors
/// [`Cancelled`].
pub fn with_ambient_occlusion(
    mesh: Mesh,
    ground: Option<&GroundHeight<'_>>,
    settings: &OpennessSettings,
    progress: &Progress,
) -> Result<Occluded, Cancelled> {
    let rays = rays(settings);
    let step = spacing(&mesh, settings.step);
    let tree = MeshTree::new(&mesh);
    let count = mesh.triangles().len();
    let batches: Vec<(Vec<u8>, Vec<u8>, usize)> = (0..count.div_ceil(BATCH))
        .into_par_iter()
        .map(|batch| {
            progress.tick("ambient occlusion", batch as f64 * BATCH as f64 / count as f64)?;
            let (mut steps, mut shares, mut left_out) = (Vec::new(), Vec::new(), 0);
            for triangle in batch * BATCH..count.min((batch + 1) * BATCH) {
                if progress.is_cancelled() {
                    return Err(Cancelled);
                }
                if progress.is_late() {
                    steps.push(1);
                    shares.extend([u8::MAX; 3]);
                    left_out += 1;
                    continue;
                }
                let [a, b, c] = mesh.corners(triangle);
                let n = steps_of([a, b, c], step);
                steps.push(n);
                let around = Around { tree: &tree, ground, rays: &rays, lift: LIFT * settings.reach };
                let normal = mesh.face_normal(triangle);
                let middle = (a + b + c) / 3.0;
                shares.extend(triangle_lattice(n).map(|w| {
                    let p = a * w[0] + b * w[1] + c * w[2];
                    let inwards =
                        INWARDS.min(MOST_INWARDS * settings.reach / p.distance(middle).max(f64::MIN_POSITIVE));
                    let open = around.openness(p.lerp(middle, inwards), normal);
                    (255.0 * open).round() as u8
                }));
            }
            Ok((steps, shares, left_out))
        })
        .collect::<Result<_, Cancelled>>()?;
    let (mut steps, mut shares, mut left_out) = (Vec::new(), Vec::new(), 0);
    for (of_batch, open, late) in batches {
        steps.extend(of_batch);
        shares.extend(open);
        left_out += late;
    }
    // The lengths fit by construction.
    let mesh = mesh.clone().with_open_lattices(&steps, shares).unwrap_or(mesh);
    Ok(Occluded { mesh, step, left_out })
}

/// Spacing at which a mesh has no more sample points than [`MOST_POINTS`] allow: `step` or more.
fn spacing(mesh: &Mesh, step: f64) -> f64 {
    let count = mesh.triangles().len();
    let most = MOST_POINTS[0] * count + MOST_POINTS[1];
    let points = |step: f64| {
        let of = |t: usize| {
            let n = usize::from(steps_of(mesh.corners(t), step));
            (n + 1) * (n + 2) / 2
        };
        (0..count).into_par_iter().map(of).sum::<usize>()
    };
    if points(step) <= most {
        return step;
    }
    // Below this spacing every triangle has the most steps.
    let longest = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        a.distance(b).max(b.distance(c)).max(c.distance(a))
    };
    let shortest = (0..count).map(longest).filter(|length| *length > 0.0).fold(f64::INFINITY, f64::min);
    let mut step = if shortest.is_finite() { step.max(shortest / MOST_STEPS) } else { step };
    while points(step) > most {
        step *= APART;
    }
    step
}

/// Steps along the edges of a triangle.
fn steps_of([a, b, c]: [DVec3; 3], step: f64) -> u8 {
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a)) / step;
    let area = 0.5 * (b - a).cross(c - a).length() / (step * step);
    let asked = 2.0 * area + longest + 3.0;
    longest.ceil().min((2.0 * SURPLUS * asked).sqrt()).clamp(1.0, MOST_STEPS) as u8
}

/// The surfaces that take light away, and the rays that sample them.
struct Around<'a> {
    tree: &'a MeshTree<'a>,
    ground: Option<&'a GroundHeight<'a>>,
    /// Rays about +z, each as long as its reach.
    rays: &'a [DVec3],
    lift: f64,
}

impl Around<'_> {
    /// Share of the light that reaches a point of a face, 0..=1.
    fn openness(&self, p: DVec3, normal: DVec3) -> f64 {
        let front = self.one_side(p, normal);
        if front >= INSIDE { front } else { front.max(self.one_side(p, -normal)) }
    }

    fn one_side(&self, p: DVec3, normal: DVec3) -> f64 {
        let [across, along] = [normal.any_orthonormal_vector(), normal.cross(normal.any_orthonormal_vector())];
        let from = p + self.lift * normal;
        let open = self.rays.iter().filter(|ray| {
            let by = ray.x * across + ray.y * along + ray.z * normal;
            !self.is_under(from, by) && !self.tree.is_crossed(from, from + by)
        });
        open.count() as f64 / self.rays.len() as f64
    }

    /// Whether a ray meets the ground. A point slightly under ground counts as on it.
    fn is_under(&self, from: DVec3, by: DVec3) -> bool {
        let Some(ground) = self.ground.filter(|_| by.z < 0.0) else { return false };
        let height = |share: f64| ground((from + share * by).truncate()).map(|z| from.z - z);
        let Some(over) = height(0.0) else { return false };
        let first = (over.max(0.0) / -by.z).min(1.0);
        height(first).is_some_and(|over| over.max(0.0) <= -by.z)
    }
}

/// Rays about +z, spread by the cosine rule, each as long as its reach.
fn rays(settings: &OpennessSettings) -> Vec<DVec3> {
    let n = settings.rays.max(1);
    let directions = (0..n).map(|i| {
        let (u, v) = ((i as f64 + 0.5) / n as f64, radical_inverse(i, 2));
        let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
        let length = settings.reach * (1.0 - radical_inverse(i, 3)).sqrt();
        length * DVec3::new(u.sqrt() * cos, u.sqrt() * sin, (1.0 - u).sqrt())
    });
    directions.collect()
}

/// Radical inverse (van der Corput sequence): evenly spread over 0..1.
fn radical_inverse(mut number: usize, base: usize) -> f64 {
    let (mut sum, mut digit) = (0.0, 1.0 / base as f64);
    while number > 0 {
        sum += (number % base) as f64 * digit;
        number /= base;
        digit /= base as f64;
    }
    sum
}

#[cfg(test)]
mod tests;
