//! Nodes of the ground with the light on them, a patch at a time: each step is a plain loop over short arrays, which
//! compilers turn into vector instructions.

use crate::shade::ground::planes::Planes;
use crate::shade::ground::rows::RefinedRows;
use crate::shade::ground::shadow::Shadows;
use crate::shade::ground::surface::{MipPyramid, Surface};
use crate::shade::ground::tiles::Line;
use crate::shade::relief::ReliefLight;
use crate::simd::{self, Kernel, LANES, Lanes};
use belvedere_composite::tint::GroundTint;

/// Inputs of the tiles of lit ground.
pub(crate) struct LightingInputs<'a> {
    pub(crate) surface: &'a Surface<'a>,
    pub(crate) means: &'a MipPyramid,
    /// The undisplaced ground, if the lit one is displaced: the tint uses its heights and slopes.
    pub(crate) map: Option<GroundShape<'a>>,
    pub(crate) shadows: Option<&'a Shadows>,
    pub(crate) tint: &'a GroundTint,
    pub(crate) light: &'a ReliefLight,
    pub(crate) exaggeration: f32,
}

/// A ground and its averages.
#[derive(Clone, Copy)]
pub(crate) struct GroundShape<'a> {
    pub(crate) surface: &'a Surface<'a>,
    pub(crate) means: &'a MipPyramid,
}

/// Colour and light of nodes.
#[derive(Clone)]
pub(crate) struct LitNodes {
    /// Square roots of linear red, green, blue without light.
    pub(crate) root: [Lanes; 3],
    /// Amounts of direct light and of light from the sky.
    pub(crate) direct: Lanes,
    pub(crate) sky: Lanes,
    /// Strength of the texture, 0..=1.
    pub(crate) rough: Lanes,
}

/// Inputs of the light on nodes, plane by plane, padded to whole lanes.
struct Shapes {
    /// dz/dx, dz/dy, height.
    shape: [Vec<f32>; 3],
    /// Height of the near surroundings and weighted height of the wider ones, see [`MipPyramid::openness`].
    near: [Vec<f32>; 2],
    /// The undisplaced shape, if `shape` is displaced.
    map: Option<[Vec<f32>; 3]>,
    /// Share of the sun that no shadow takes.
    sun: Vec<f32>,
}

const NOTHING: Lanes = [0.0; LANES];

impl Shapes {
    fn new(nodes: usize, displaced: bool) -> Self {
        let n = nodes.next_multiple_of(LANES);
        let plane = || vec![0.0; n];
        let shape = || [plane(), plane(), plane()];
        Self { shape: shape(), near: [plane(), plane()], map: displaced.then(shape), sun: vec![1.0; n] }
    }
}

/// Nodes of a level with the light on them, row by row.
pub(crate) struct Patch {
    nodes: Vec<LitNodes>,
}

impl Patch {
    /// The nodes where rows and columns meet.
    pub(crate) fn new(m: &LightingInputs<'_>, k: usize, columns: Line, rows: Line) -> Self {
        let mut shapes = Shapes::new(columns.count * rows.count, m.map.is_some());
        let (first, inside) = columns.inside();
        let lit = GroundShape { surface: m.surface, means: m.means };
        let mut row = Row::new(lit, k, first, inside.len());
        let mut map_row = m.map.map(|map| Row::new(map, k, first, inside.len()));
        let mut unused = [0; 2].map(|_| vec![0.0; columns.count]);
        for (n, r) in rows.iter().enumerate() {
            let all = n * columns.count..(n + 1) * columns.count;
            let at = all.start + inside.start;
            let range = at..at + inside.len();
            let Shapes { shape, near: [height, asked], map, sun } = &mut shapes;
            if let Some(shadows) = m.shadows {
                shadows.share_row(k, r, first, &mut sun[range.clone()]);
            }
            let [x, y, z] = shape.each_mut().map(|plane| &mut plane[range.clone()]);
            row.fill(k, r, [x, y, z, &mut height[range.clone()], &mut asked[range.clone()]]);
            for plane in shape.iter_mut().chain([height, asked, sun]) {
                columns.repeat(&mut plane[all.clone()]);
            }
            if let (Some(row), Some(shape)) = (&mut map_row, map) {
                let [x, y, z] = shape.each_mut().map(|plane| &mut plane[range.clone()]);
                let [height, asked] = unused.each_mut().map(|plane| &mut plane[..inside.len()]);
                row.fill(k, r, [x, y, z, height, asked]);
                for plane in shape {
                    columns.repeat(&mut plane[all.clone()]);
                }
            }
        }
        Self { nodes: simd::run(LightUp { m, shapes: &shapes }) }
    }

    /// The nodes, [`LANES`] at a time; those past the last one are arbitrary.
    pub(crate) fn nodes(&self) -> &[LitNodes] {
        &self.nodes
    }
}

impl LitNodes {
    /// Square roots of the lit colour.
    #[inline(always)]
    pub(crate) fn lit_roots(&self, light: &ReliefLight) -> [Lanes; 3] {
        let mut out = [NOTHING; 3];
        for ((out, root), (warm, cool)) in
            out.iter_mut().zip(&self.root).zip(light.warm.to_array().into_iter().zip(light.cool.to_array()))
        {
            for i in 0..LANES {
                out[i] = (root[i] * root[i] * (warm * self.direct[i] + cool * self.sky[i])).sqrt();
            }
        }
        out
    }
}

/// Fills a row of nodes, from column `first` on.
struct Row<'a> {
    ground: GroundShape<'a>,
    first: usize,
    shape: Planes,
    near: Planes,
    /// The surroundings of levels finer than those stored.
    refined: Option<RefinedRows>,
}

impl<'a> Row<'a> {
    fn new(ground: GroundShape<'a>, k: usize, first: usize, n: usize) -> Self {
        let refined = (k < ground.means.first).then(|| RefinedRows::new(ground.means, k, first, n));
        Self { ground, first, shape: Planes::new(n), near: Planes::new(n), refined }
    }

    /// Writes row `row` of level `k`: dz/dx, dz/dy, height, and the two planes of the surroundings, see [`Shapes`].
    fn fill(&mut self, k: usize, row: usize, to: [&mut [f32]; 5]) {
        let Self { ground: GroundShape { surface, means }, first, shape, near, refined } = self;
        let surroundings = if let Some(refined) = refined {
            surface.mean_row(k, row, *first, shape);
            refined.row(means, row, near);
            near
        } else {
            means.row(k, row, *first, shape);
            &*shape
        };
        simd::run(Join { shape, surroundings, to });
    }
}

/// Joins nodes and their surroundings.
struct Join<'a> {
    shape: &'a Planes,
    surroundings: &'a Planes,
    to: [&'a mut [f32]; 5],
}

impl Kernel for Join<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { shape, surroundings, to: [x, y, z, height, asked] } = self;
        let n = shape.w.len();
        for (k, to) in [x, y, z].into_iter().enumerate() {
            let (to, here, near, w) = (&mut to[..n], &shape.xyz[k][..n], &surroundings.xyz[k][..n], &shape.w[..n]);
            for i in 0..n {
                // A void takes the average of the ground around it.
                let (here, near) = (here[i], near[i]);
                to[i] = if w[i] == 0.0 { near } else { here };
            }
        }
        height.copy_from_slice(&surroundings.xyz[2]);
        asked.copy_from_slice(&surroundings.w);
    }
}

/// Lights nodes.
struct LightUp<'a> {
    m: &'a LightingInputs<'a>,
    shapes: &'a Shapes,
}

impl Kernel for LightUp<'_> {
    type Output = Vec<LitNodes>;

    #[inline(always)]
    fn run(self) -> Vec<LitNodes> {
        let Shapes { shape, near: [height, asked], map, sun } = self.shapes;
        let [x, y, z] = shape;
        let [map_x, map_y, map_z] = map.as_ref().unwrap_or(shape);
        let mut out = Vec::with_capacity(x.len() / LANES);
        for n in (0..x.len()).step_by(LANES) {
            let (Some(x), Some(y), Some(z)) = (lanes(x, n), lanes(y, n), lanes(z, n)) else { break };
            let (Some(height), Some(asked), Some(sun)) = (lanes(height, n), lanes(asked, n), lanes(sun, n)) else {
                break;
            };
            let (Some(map_x), Some(map_y), Some(map_z)) = (lanes(map_x, n), lanes(map_y, n), lanes(map_z, n)) else {
                break;
            };
            out.push(light_up(self.m, [x, y, z], [height, asked], [map_x, map_y, map_z], sun));
        }
        out
    }
}

#[inline(always)]
fn lanes(plane: &[f32], n: usize) -> Option<&Lanes> {
    plane.get(n..)?.first_chunk()
}

#[inline(always)]
fn light_up(
    m: &LightingInputs<'_>,
    [x, y, z]: [&Lanes; 3],
    near: [&Lanes; 2],
    [map_x, map_y, map_z]: [&Lanes; 3],
    sun: &Lanes,
) -> LitNodes {
    let openness = m.means.openness();
    let (mut open, mut steep, mut normal) = (NOTHING, NOTHING, [NOTHING; 3]);
    for i in 0..LANES {
        open[i] = openness.at(z[i], near[0][i], near[1][i]);
        steep[i] = (map_x[i] * map_x[i] + map_y[i] * map_y[i]).sqrt();
        let (a, b) = (x[i] * -m.exaggeration, y[i] * -m.exaggeration);
        let scale = 1.0 / (a * a + b * b + 1.0).sqrt();
        (normal[0][i], normal[1][i], normal[2][i]) = (a * scale, b * scale, scale);
    }
    let [direct, sky] = m.light.parts_of(&normal, &open, sun);
    let mut north = NOTHING;
    for i in 0..LANES {
        north[i] = -map_y[i];
    }
    let [red, green, blue, rough] = m.tint.colors(map_z, &steep, &north);
    let mut root = [red, green, blue];
    for plane in &mut root {
        for v in plane {
            *v = v.sqrt();
        }
    }
    LitNodes { root, direct, sky, rough }
}
