//! Stylisation of a drawn picture from its depths and points, before lines and names: dark edges and depth unsharp masking.
//!
//! Source: edges in reciprocal depth, which is affine on planes, are ours; depth unsharp masking after Luft, Colditz and Deussen 2006.

use crate::buffers::Buffers;
use crate::color::{Packed, smoothstep};
use crate::unsharp::Surroundings;
use belvedere_scene::{LayerKind, RenderJob, Stylisation};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// Relative second difference of the reciprocal depth at which an edge begins to show, and at which it is full.
const DEPTH_EDGE: [f32; 2] = [0.02, 0.06];
/// The same for `1 - n n'` between faces.
const NORMAL_EDGE: [f32; 2] = [0.15, 0.4];
/// Share of light that an edge removes.
const INK: f32 = 0.7;
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
        wanted.then(|| Self::of_rows(places, n / places.max(1)))
    }

    /// Bytes per pixel.
    pub fn bytes(places: u64) -> u64 {
        places * (size_of::<f32>() + size_of::<Face>()) as u64
    }

    /// Bands of `pixels` pixels each.
    pub fn bands(&mut self, pixels: usize) -> Vec<Option<ReliefRows<'_>>> {
        self.bands_of(0..usize::MAX, pixels)
    }

    /// Bands of `pixels` pixels each, of some of the pixels.
    pub fn bands_of(&mut self, of: Range<usize>, pixels: usize) -> Vec<Option<ReliefRows<'_>>> {
        let (places, n) = (self.places, pixels * self.places);
        let of = of.start * places..of.end.saturating_mul(places).min(self.near.len());
        let rows = self.near[of.clone()].chunks_mut(n).zip(self.face[of].chunks_mut(n));
        rows.map(|(near, face)| Some(ReliefRows { places, near, face })).collect()
    }

    /// Room for some rows, all of it sky.
    pub fn of_rows(places: usize, pixels: usize) -> Self {
        let n = places * pixels;
        Self { places, near: vec![SKY_NEAR; n], face: vec![Face::default(); n] }
    }

    /// Least and largest depth of all samples in a parallel projection; `None` if all is sky.
    pub fn depths(&self) -> Option<[f32; 2]> {
        let depth: Vec<f32> = self.near.par_iter().map(|q| depth_of(*q)).collect();
        depth_range(&depth)
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

/// What the stylisation of every row needs to know of the whole picture.
#[derive(Debug, Default)]
pub struct Survey {
    /// Least and largest depth of all samples, for edges in a parallel projection.
    pub depths: Option<[f32; 2]>,
    /// Surroundings of the pixels, for unsharp masking.
    pub around: Option<Surroundings>,
}

/// Rows of a picture to stylise.
#[derive(Debug)]
pub struct StyledRows {
    /// Width of the picture, pixels.
    pub width: usize,
    /// Number of the first row.
    pub first: usize,
    /// Whether the relief begins with the row above the first.
    pub above: bool,
}

/// Draws edges and unsharp masking into the linear colours of surfaces.
/// * `relief`: depths and faces of all samples, if they are known.
pub fn apply(job: &RenderJob<'_>, width: usize, relief: Option<Relief>, buffers: &mut Buffers) {
    let Stylisation { edges, unsharp } = job.options.stylisation;
    let ortho = job.view.pinhole().is_orthographic();
    let relief = (edges > 0.0)
        .then(|| relief.unwrap_or_else(|| Relief::of_centres(buffers, width, ortho, &Kind::of_layers(job))));
    let survey = Survey {
        depths: relief.as_ref().filter(|_| ortho).and_then(|relief| relief.depths()),
        around: (unsharp > 0.0).then(|| Surroundings::of_picture(&buffers.depth, width, ortho)),
    };
    apply_to_rows(job, &StyledRows { width, first: 0, above: false }, &survey, relief, buffers);
}

/// [`apply`] to some rows of a picture.
/// * `relief`: of these rows and their neighbours above and below, where there are any; `None` without edges.
pub fn apply_to_rows(
    job: &RenderJob<'_>,
    rows: &StyledRows,
    survey: &Survey,
    relief: Option<Relief>,
    buffers: &mut Buffers,
) {
    let Stylisation { edges, unsharp } = job.options.stylisation;
    let ortho = job.view.pinhole().is_orthographic();
    let width = rows.width;
    let mut light = vec![1.0f32; buffers.color.len()];
    if let Some(relief) = relief {
        let kinds = Kind::of_layers(job);
        let seen = Seen::new(relief, width, ortho, survey.depths);
        let from = usize::from(rows.above);
        light.par_chunks_mut(width).zip(buffers.id.par_chunks(width)).enumerate().for_each(|(y, (row, id))| {
            for (x, light) in row.iter_mut().enumerate() {
                if kind_of(&kinds, id[x]) != Some(Kind::Cloud) {
                    *light = 1.0 - edges * INK * seen.edge(x, y + from);
                }
            }
        });
    }
    if let Some(around) = &survey.around {
        light.par_chunks_mut(width).zip(buffers.depth.par_chunks(width)).enumerate().for_each(|(y, (row, depth))| {
            for (x, light) in row.iter_mut().enumerate() {
                let off = around.behind([x, rows.first + y], depth[x]);
                *light *= 1.0 + (unsharp * off).clamp(-DARKEST, 0.0);
            }
        });
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
            LayerKind::Boxes(_) | LayerKind::Mesh(_) | LayerKind::Own(_) => Self::Solid,
            LayerKind::Volume(_) => Self::Cloud,
            _ => Self::Depth,
        }
    }

    fn of_layers(job: &RenderJob<'_>) -> Vec<Self> {
        job.scene.layers.iter().map(|l| Self::of(&l.kind)).collect()
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
}

impl Seen {
    /// * `range`: of the depths of a parallel projection.
    fn new(relief: Relief, width: usize, ortho: bool, range: Option<[f32; 2]>) -> Self {
        let Relief { places, near: mut nearness, face } = relief;
        let height = nearness.len() / (width * places).max(1);
        if ortho {
            nearness.par_iter_mut().for_each(|near| *near = near_of(depth_of(*near), true, range));
        } else {
            nearness.par_iter_mut().filter(|near| near.is_nan()).for_each(|near| *near = 0.0);
        }
        Self { width, height, places, nearness, face }
    }

    /// Strength of the edge on a pixel, 0..=1: the mean over its samples.
    fn edge(&self, x: usize, y: usize) -> f32 {
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

/// Depth of a nearness in parallel projection.
fn depth_of(q: f32) -> f32 {
    if q.is_nan() { f32::INFINITY } else { -q }
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

#[cfg(test)]
mod tests {
    use super::*;

    const W: usize = 120;
    const H: usize = 80;

    fn seen(depth: Vec<f32>, ortho: bool) -> Seen {
        let n = depth.len();
        Seen { width: W, height: H, places: 1, nearness: nearness(&depth, ortho), face: vec![Face::default(); n] }
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
}
