//! Stylisation of a drawn picture from its depths and points, before lines and names: dark edges and depth unsharp masking.
//!
//! Source: edges in reciprocal depth, which is affine on planes, are ours; depth unsharp masking after Luft, Colditz and Deussen 2006.

use crate::buffers::Buffers;
use crate::color::{Packed, smoothstep};
use belvedere_scene::{LayerKind, RenderJob, Stylisation};
use glam::DVec3;
use rayon::prelude::*;

/// Relative second difference of the reciprocal depth at which an edge begins to show, and at which it is full.
const DEPTH_EDGE: [f32; 2] = [0.02, 0.06];
/// The same for `1 - n n'` between faces.
const NORMAL_EDGE: [f32; 2] = [0.15, 0.4];
/// Share of light that an edge removes.
const INK: f32 = 0.7;
/// Standard deviation of the average of depths, as a share of the picture's diagonal.
const SIGMA: f32 = 0.01;
/// Largest share of light that unsharp masking removes.
const DARKEST: f32 = 0.35;

/// Whether the job asks for stylisation.
pub fn is_on(job: &RenderJob<'_>) -> bool {
    job.options.stylisation != Stylisation::default()
}

/// Input of the edges: depths and faces of the samples of every pixel, so that edges are as smooth as outlines.
#[derive(Debug, Default)]
pub struct Relief {
    /// Number of sample positions per pixel.
    places: usize,
    /// Nearness of the samples of each pixel in turn, row by row: 1 / depth, in parallel projection -depth.
    near: Vec<f32>,
    face: Vec<Face>,
}

/// Whether a sample shows a solid, and the unit normal of its face in 127ths where edges between faces are drawn, else 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Face {
    normal: [i8; 3],
    solid: bool,
}

/// Nearness of the sky.
pub const SKY_NEAR: f32 = f32::NAN;

impl Face {
    /// A face of a solid, its normal towards the eye.
    pub fn solid(normal: DVec3) -> Self {
        let n = normal.normalize_or_zero();
        Self { normal: n.to_array().map(|v| (127.0 * v).round() as i8), solid: true }
    }

    /// 1 - n n' of two faces; 0 unless both are known.
    fn turn(self, other: Self) -> f32 {
        let known = |f: Self| f.normal != [0; 3];
        if !(known(self) && known(other)) {
            return 0.0;
        }
        let dot =
            |a: Self, b: Self| (0..3).map(|k| i32::from(a.normal[k]) * i32::from(b.normal[k])).sum::<i32>() as f32;
        1.0 - dot(self, other) / (dot(self, self) * dot(other, other)).sqrt()
    }
}

/// Part of a [`Relief`] that a band fills.
#[derive(Debug)]
pub struct ReliefRows<'r> {
    /// Number of sample positions per pixel.
    pub places: usize,
    /// Nearness of the samples of each pixel in turn, row by row: 1 / depth, in parallel projection -depth.
    pub near: &'r mut [f32],
    /// Faces of the samples.
    pub face: &'r mut [Face],
}

impl Relief {
    /// Buffers for a picture whose edges are to be drawn; `None` if none are.
    /// * `places`: number of sample positions per pixel.
    pub fn room(job: &RenderJob<'_>, places: usize) -> Option<Self> {
        let n = job.view.pinhole().image.map(|s| s as usize).iter().product::<usize>() * places;
        let wanted = job.options.stylisation.edges > 0.0;
        wanted.then(|| Self { places, near: vec![SKY_NEAR; n], face: vec![Face::default(); n] })
    }

    /// Bytes per pixel.
    pub fn bytes(places: u64) -> u64 {
        places * (size_of::<f32>() + size_of::<Face>()) as u64
    }

    /// Bands of `pixels` pixels each.
    pub fn bands(&mut self, pixels: usize) -> Vec<Option<ReliefRows<'_>>> {
        let (places, n) = (self.places, pixels * self.places);
        let rows = self.near.chunks_mut(n).zip(self.face.chunks_mut(n));
        rows.map(|(near, face)| Some(ReliefRows { places, near, face })).collect()
    }

    /// From the samples at the pixel centres; normals of faces from the world points of neighbours.
    fn of_centres(buffers: &Buffers, width: usize, ortho: bool, kinds: &[Kind]) -> Self {
        let nearness = nearness(&buffers.depth, ortho);
        let world = buffers.world.as_deref().unwrap_or_default();
        let solid = |i: usize| kind_of(kinds, buffers.id[i]) == Some(Kind::Solid);
        let height = nearness.len() / width;
        let face = (0..nearness.len()).into_par_iter().map(|i| {
            if world.is_empty() || !solid(i) {
                return Face::default();
            }
            let (x, y) = (i % width, i / width);
            let place = |i: usize| DVec3::from_array(world[i]);
            // Of the two neighbours, the one whose depth differs less lies on the same face.
            let step = |before: Option<usize>, after: Option<usize>| {
                let off = |j: Option<usize>| {
                    j.filter(|j| solid(*j)).map_or(f32::INFINITY, |j| (nearness[j] - nearness[i]).abs())
                };
                let (a, b) = (off(before), off(after));
                if a < b {
                    before.map(|j| place(i) - place(j))
                } else {
                    after.filter(|_| b.is_finite()).map(|j| place(j) - place(i))
                }
            };
            let across = step((x > 0).then(|| i - 1), (x + 1 < width).then(|| i + 1));
            let down = step((y > 0).then(|| i - width), (y + 1 < height).then(|| i + width));
            let normal = across.zip(down).map_or(DVec3::ZERO, |(a, d)| d.cross(a));
            Face::solid(if normal.is_finite() { normal } else { DVec3::ZERO })
        });
        let near = |d: &f32| match (d.is_finite(), ortho) {
            (false, _) => SKY_NEAR,
            (true, true) => -d,
            (true, false) => 1.0 / d.max(f32::MIN_POSITIVE),
        };
        Self { places: 1, near: buffers.depth.iter().map(near).collect(), face: face.collect() }
    }
}

/// Draws edges and unsharp masking into the linear colours of surfaces.
/// * `relief`: depths and faces of all samples, if they are known.
pub fn apply(job: &RenderJob<'_>, width: usize, relief: Option<Relief>, buffers: &mut Buffers) {
    let Stylisation { edges, unsharp } = job.options.stylisation;
    let ortho = job.view.pinhole().is_orthographic();
    let n = buffers.color.len();
    let mut light = vec![1.0f32; n];
    if edges > 0.0 {
        let kinds: Vec<Kind> = job.scene.layers.iter().map(|l| Kind::of(&l.kind)).collect();
        let relief = relief.unwrap_or_else(|| Relief::of_centres(buffers, width, ortho, &kinds));
        let cloud = buffers.id.iter().map(|id| kind_of(&kinds, *id) == Some(Kind::Cloud)).collect();
        let seen = Seen::new(relief, width, ortho, cloud);
        light.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
            for (x, light) in row.iter_mut().enumerate() {
                *light = 1.0 - edges * INK * seen.edge(x, y);
            }
        });
    }
    if unsharp > 0.0 {
        let behind = behind(&buffers.depth, width, ortho);
        light.par_iter_mut().zip(&behind).for_each(|(light, off)| *light *= 1.0 + (unsharp * off).clamp(-DARKEST, 0.0));
    }
    buffers.color.par_iter_mut().zip(&light).for_each(|(color, light)| {
        if *light < 1.0 {
            *color = Packed::new(color.rgb() * *light);
        }
    });
    if !job.options.aux.world {
        buffers.world = None;
    }
}

/// How edges of a layer are detected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// By depth and by the normals of faces.
    Solid,
    /// By depth alone: faces of ground are too small, and atoms are round.
    Depth,
    /// Volumes have no edges.
    Cloud,
}

impl Kind {
    fn of(kind: &LayerKind) -> Self {
        match kind {
            LayerKind::Boxes(_) | LayerKind::Mesh(_) => Self::Solid,
            LayerKind::Volume(_) => Self::Cloud,
            _ => Self::Depth,
        }
    }
}

fn kind_of(kinds: &[Kind], id: u32) -> Option<Kind> {
    kinds.get((id as usize).wrapping_sub(1)).copied()
}

/// Data from which edges are detected.
struct Seen {
    width: usize,
    height: usize,
    places: usize,
    /// Reciprocal depth, in parallel projection the reversed depth: affine on planes; 0 in the sky. As in [`Relief`].
    nearness: Vec<f32>,
    face: Vec<Face>,
    cloud: Vec<bool>,
}

impl Seen {
    fn new(relief: Relief, width: usize, ortho: bool, cloud: Vec<bool>) -> Self {
        let Relief { places, near: mut nearness, face } = relief;
        let height = cloud.len() / width;
        if ortho {
            let of_depth: Vec<f32> = nearness.par_iter().map(|q| if q.is_nan() { f32::INFINITY } else { -q }).collect();
            let range = depth_range(&of_depth);
            nearness.par_iter_mut().zip(&of_depth).for_each(|(near, depth)| *near = near_of(*depth, true, range));
        } else {
            nearness.par_iter_mut().filter(|near| near.is_nan()).for_each(|near| *near = 0.0);
        }
        Self { width, height, places, nearness, face, cloud }
    }

    /// Strength of the edge on a pixel, 0..=1: the mean over its samples.
    fn edge(&self, x: usize, y: usize) -> f32 {
        if self.cloud[y * self.width + x] {
            return 0.0;
        }
        (0..self.places).map(|place| self.edge_at(x, y, place)).sum::<f32>() / self.places as f32
    }

    /// Strength of the edge at one sample position: on the nearer side alone, so that edges are a pixel wide.
    fn edge_at(&self, x: usize, y: usize, place: usize) -> f32 {
        let (step, row) = (self.places, self.width * self.places);
        let i = y * row + x * step + place;
        let at = self.nearness[i];
        if !(at > 0.0) {
            return 0.0;
        }
        let bend = |before: Option<usize>, after: Option<usize>| match (before, after) {
            (Some(a), Some(b)) => (2.0 * at - self.nearness[a] - self.nearness[b]).max(0.0),
            _ => 0.0,
        };
        let right = (x + 1 < self.width).then(|| i + step);
        let below = (y + 1 < self.height).then(|| i + row);
        let bends = bend((x > 0).then(|| i - step), right) + bend((y > 0).then(|| i - row), below);
        let turn = |j: Option<usize>| j.map_or(0.0, |j| self.face[i].turn(self.face[j]));
        let turns = if self.face[i].solid { turn(right).max(turn(below)) } else { 0.0 };
        let [depth, normal] = [(DEPTH_EDGE, bends / at), (NORMAL_EDGE, turns)].map(|([a, b], v)| smoothstep(a, b, v));
        depth.max(normal)
    }
}

/// Least and largest depth without the sky; `None` if all is sky.
fn depth_range(depth: &[f32]) -> Option<[f32; 2]> {
    let finite = depth.par_iter().copied().filter(|d| d.is_finite());
    let [lo, hi] = finite
        .fold(|| [f32::INFINITY, f32::NEG_INFINITY], |[lo, hi], d| [lo.min(d), hi.max(d)])
        .reduce(|| [f32::INFINITY, f32::NEG_INFINITY], |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    (lo <= hi).then_some([lo, hi])
}

fn nearness(depth: &[f32], ortho: bool) -> Vec<f32> {
    let range = if ortho { depth_range(depth) } else { None };
    depth.par_iter().map(|d| near_of(*d, ortho, range)).collect()
}

/// * `range`: of the depths of a parallel projection.
fn near_of(d: f32, ortho: bool, range: Option<[f32; 2]>) -> f32 {
    let [lo, hi] = range.unwrap_or([0.0, 1.0]);
    match (d.is_finite(), ortho) {
        (false, _) => 0.0,
        (true, true) => 1.0 + (hi - d) / (hi - lo).max(f32::MIN_POSITIVE),
        (true, false) => 1.0 / d.max(f32::MIN_POSITIVE),
    }
}

/// Mean depth of the surroundings minus the depth of each pixel, as a share of the range of depths; 0 in the sky.
///
/// The logarithm of the depth is used, so that a doubling counts the same everywhere; in parallel projection the depth itself.
fn behind(depth: &[f32], width: usize, ortho: bool) -> Vec<f32> {
    let Some([lo, hi]) = depth_range(depth) else { return vec![0.0; depth.len()] };
    let scale = |d: f32| if ortho { d } else { d.max(f32::MIN_POSITIVE).ln() };
    let (from, size) = (scale(lo), (scale(hi) - scale(lo)).max(1e-6));
    let height = depth.len() / width;
    // The sky counts as far as the farthest surface, so that there are no halos against it.
    let share = |d: f32| if d.is_finite() { (scale(d) - from) / size } else { 1.0 };
    let shares: Vec<f32> = depth.par_iter().map(|d| share(*d)).collect();
    let [half_width, half_height] = [width.div_ceil(2), height.div_ceil(2)];
    let halves: Vec<f32> = (0..half_width * half_height)
        .into_par_iter()
        .map(|i| {
            let (x, y) = (2 * (i % half_width), 2 * (i / half_width));
            let (right, below) = ((x + 1).min(width - 1), (y + 1).min(height - 1));
            0.25 * [(x, y), (right, y), (x, below), (right, below)]
                .map(|(x, y)| shares[y * width + x])
                .iter()
                .sum::<f32>()
        })
        .collect();
    let sigma = 0.5 * SIGMA * ((width * width + height * height) as f32).sqrt();
    let weights = gaussian(sigma);
    let mean = blurred(&blurred(&halves, half_width, &weights), half_height, &weights);
    let at = |x: usize, y: usize| {
        // Position of the pixel's centre in the picture of half the size.
        let place = |p: usize, n: usize| {
            let g = (0.5 * (p as f32 + 0.5) - 0.5).clamp(0.0, (n - 1) as f32);
            let i = (g as usize).min(n.saturating_sub(2));
            (i, (i + 1).min(n - 1), g - i as f32)
        };
        let ((x0, x1, u), (y0, y1, v)) = (place(x, half_width), place(y, half_height));
        let line = |y: usize| mean[y * half_width + x0] * (1.0 - u) + mean[y * half_width + x1] * u;
        line(y0) * (1.0 - v) + line(y1) * v
    };
    let off = |i: usize| if depth[i].is_finite() { at(i % width, i / width) - shares[i] } else { 0.0 };
    (0..depth.len()).into_par_iter().map(off).collect()
}

/// One half of a Gaussian; the sum over both halves is 1.
fn gaussian(sigma: f32) -> Vec<f32> {
    let reach = (3.0 * sigma).ceil().max(1.0) as usize;
    let weights: Vec<f32> = (0..=reach).map(|i| (-0.5 * (i as f32 / sigma.max(1e-3)).powi(2)).exp()).collect();
    let sum = 2.0 * weights.iter().sum::<f32>() - weights[0];
    weights.into_iter().map(|w| w / sum).collect()
}

/// Weighted sums along rows of `width`, with the rim repeated; the result is transposed.
fn blurred(of: &[f32], width: usize, weights: &[f32]) -> Vec<f32> {
    let (height, reach) = (of.len() / width, weights.len() - 1);
    let mut lines = vec![0.0; of.len()];
    lines.par_chunks_mut(width).zip(of.par_chunks(width)).for_each(|(out, row)| {
        let at = |i: isize| row[i.clamp(0, width as isize - 1) as usize];
        for (x, out) in out.iter_mut().enumerate() {
            let x = x as isize;
            let sides = (1..=reach as isize).map(|k| weights[k as usize] * (at(x - k) + at(x + k)));
            *out = weights[0] * at(x) + sides.sum::<f32>();
        }
    });
    let mut turned = vec![0.0; of.len()];
    turned.par_chunks_mut(height).enumerate().for_each(|(x, out)| {
        for (y, out) in out.iter_mut().enumerate() {
            *out = lines[y * width + x];
        }
    });
    turned
}

#[cfg(test)]
mod tests {
    use super::*;

    const W: usize = 120;
    const H: usize = 80;

    fn seen(depth: Vec<f32>, ortho: bool) -> Seen {
        let n = depth.len();
        Seen {
            width: W,
            height: H,
            places: 1,
            nearness: nearness(&depth, ortho),
            face: vec![Face::default(); n],
            cloud: vec![false; n],
        }
    }

    fn picture(depth: impl Fn(usize, usize) -> f32) -> Vec<f32> {
        (0..W * H).map(|i| depth(i % W, i / W)).collect()
    }

    #[test]
    fn grazing_ground_has_no_edges_and_a_wall_has_one_a_pixel_wide() {
        // Level ground up to the horizon: depth grows to infinity with the row.
        let ground = |y: usize| 100.0 / (y as f32 + 0.5);
        let all = |seen: &Seen| (0..W * H).map(|i| seen.edge(i % W, i / W)).collect::<Vec<_>>();
        assert!(all(&seen(picture(|_, y| ground(y)), false)).iter().all(|e| *e == 0.0));
        assert!(all(&seen(picture(|x, y| 50.0 + x as f32 + 3.0 * y as f32), true)).iter().all(|e| *e < 1e-3));
        let wall = picture(|x, y| if (30..60).contains(&x) && y > 20 { 0.9 } else { ground(y).max(2.0) });
        let edges = all(&seen(wall, false));
        assert!(edges[50 * W + 30] == 1.0 && edges[50 * W + 59] == 1.0 && edges[21 * W + 45] == 1.0);
        assert!(
            [29, 31, 45, 58, 60].iter().all(|x| edges[50 * W + x] == 0.0),
            "{:?}",
            &edges[50 * W + 25..50 * W + 65]
        );
        let against_sky = picture(|_, y| if y < 40 { f32::INFINITY } else { 500.0 });
        let edges = all(&seen(against_sky, false));
        assert!(edges[40 * W + 7] == 1.0 && edges[39 * W + 7] == 0.0 && edges[41 * W + 7] == 0.0);
    }

    #[test]
    fn what_lies_behind_is_shaded_and_the_sky_is_not() {
        let step = picture(|x, y| {
            if y < 10 {
                f32::INFINITY
            } else if x < 60 {
                10.0
            } else {
                80.0
            }
        });
        let off = behind(&step, W, false);
        assert!(off[40 * W + 60] < -0.2 && off[40 * W + 59] > 0.2, "{} {}", off[40 * W + 59], off[40 * W + 60]);
        assert!(off[40 * W + 100].abs() < 1e-4 && off[3 * W + 20] == 0.0);
        assert!(behind(&vec![f32::INFINITY; W * H], W, false).iter().all(|v| *v == 0.0));
        assert!(behind(&vec![5.0; W * H], W, true).iter().all(|v| v.abs() < 1e-5));
    }

    #[test]
    fn averages_keep_what_is_even_and_have_their_width() {
        let weights = gaussian(2.0);
        let mut dot = vec![0.0; W * H];
        dot[40 * W + 60] = 1.0;
        let out = blurred(&blurred(&dot, W, &weights), H, &weights);
        assert!((out.iter().sum::<f32>() - 1.0).abs() < 1e-5);
        let variance: f32 = (0..W * H).map(|i| out[i] * ((i % W) as f32 - 60.0).powi(2)).sum();
        assert!((variance - 4.0).abs() < 0.2, "{variance}");
    }
}
