//! Nodes of the ground with the light on them, a patch at a time: each step is a plain loop over short arrays, which
//! compilers turn into vector instructions.

use crate::shade::ground::broad::Broad;
use crate::shade::ground::finer::Finer;
use crate::shade::ground::made;
use crate::shade::ground::planes::Planes;
use crate::shade::ground::rows::RefinedRows;
use crate::shade::ground::shadow::Shadows;
use crate::shade::ground::surface::{MipPyramid, Surface};
use crate::shade::ground::tiles::Line;
use crate::shade::relief::ReliefLight;
use crate::simd::{self, Kernel, LANES, Lanes};
use belvedere_composite::tint::{GroundNodes, GroundTint};

/// Inputs of the tiles of lit ground.
pub(crate) struct LightingInputs<'a> {
    pub(crate) surface: &'a Surface<'a>,
    pub(crate) means: &'a MipPyramid,
    /// The undisplaced ground, if the lit one is displaced: the tint uses its heights and slopes.
    pub(crate) map: Option<GroundShape<'a>>,
    /// Generalised relief of the undisplaced ground, where materials are drawn by rule.
    pub(crate) broad: Option<&'a Broad>,
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
    fn empty(nodes: usize, displaced: bool) -> Self {
        let n = nodes.next_multiple_of(LANES);
        let plane = || vec![0.0; n];
        let shape = || [plane(), plane(), plane()];
        Self { shape: shape(), near: [plane(), plane()], map: displaced.then(shape), sun: vec![1.0; n] }
    }

    /// The nodes of a level, 0 that of the ground, where rows and columns meet.
    fn new(m: &LightingInputs<'_>, k: usize, [columns, rows]: [Line; 2]) -> Self {
        let mut shapes = Self::empty(columns.count * rows.count, m.map.is_some());
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
        shapes
    }

    /// The nodes of a level between the nodes of the ground, `by` levels finer.
    fn between(m: &LightingInputs<'_>, by: u32, lines: [Line; 2]) -> Self {
        let nodes = [m.surface.hf.cols(), m.surface.hf.rows()];
        let around = [0, 1].map(|axis| lines[axis].around(by, nodes[axis] - 1));
        let coarse = Self::new(m, 0, around);
        let mut shapes = Self::empty(lines[0].count * lines[1].count, m.map.is_some());
        let finer = Finer::new(by, lines, around);
        let map = coarse.map.iter().flatten().zip(shapes.map.iter_mut().flatten());
        let planes =
            coarse.shape.iter().zip(&mut shapes.shape).chain(coarse.near.iter().zip(&mut shapes.near)).chain(map);
        for (from, to) in planes.chain([(&coarse.sun, &mut shapes.sun)]) {
            finer.plane(from, to);
        }
        shapes
    }
}

/// Places of nodes and generalised relief there, plane by plane, padded to whole lanes.
struct Places {
    /// Metres east and south of the corner.
    at_m: [Vec<f32>; 2],
    /// dz/dx, dz/dy, height of the surroundings.
    broad: [Vec<f32>; 3],
    spacing_m: f32,
}

impl Places {
    /// * `per_node`: spacing in nodes of the ground.
    fn new(m: &LightingInputs<'_>, per_node: f32, [columns, rows]: [Line; 2]) -> Self {
        let n = (columns.count * rows.count).next_multiple_of(LANES);
        let spacing = m.surface.hf.spacing().as_vec2() * per_node;
        let plane = || vec![0.0; n];
        let mut out =
            Self { at_m: [plane(), plane()], broad: [plane(), plane(), plane()], spacing_m: spacing.max_element() };
        let Some(broad) = m.broad else { return out };
        for (n, r) in rows.iter().enumerate() {
            let row = n * columns.count..(n + 1) * columns.count;
            let planes = out.broad.each_mut().map(|plane| &mut plane[row.clone()]);
            broad.row(per_node, r as f32, columns, planes);
            out.at_m[1][row.clone()].fill((r as f32 + 0.5) * spacing.y);
            for (x, c) in out.at_m[0][row].iter_mut().zip(columns.iter()) {
                *x = (c as f32 + 0.5) * spacing.x;
            }
        }
        out
    }
}

/// Nodes of a level with the light on them, row by row.
pub(crate) struct Patch {
    nodes: Vec<LitNodes>,
}

impl Patch {
    /// The nodes where rows and columns meet.
    /// * `k`: level of which that of the ground is number `finer`.
    pub(crate) fn new(m: &LightingInputs<'_>, (k, finer): (usize, u32), columns: Line, rows: Line) -> Self {
        let lines = [columns, rows];
        let by = finer.saturating_sub(k as u32);
        let shapes = if by > 0 { Shapes::between(m, by, lines) } else { Shapes::new(m, k - finer as usize, lines) };
        let places = Places::new(m, (k as f32 - finer as f32).exp2(), lines);
        Self { nodes: simd::run(LightUp { m, shapes: &shapes, places: &places }) }
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
                out[i] = light.film((root[i] * root[i] * (warm * self.direct[i] + cool * self.sky[i])).sqrt());
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
    places: &'a Places,
}

impl Kernel for LightUp<'_> {
    type Output = Vec<LitNodes>;

    #[inline(always)]
    fn run(self) -> Vec<LitNodes> {
        let Self { m, shapes, places } = self;
        let map = shapes.map.as_ref().unwrap_or(&shapes.shape);
        let mut out = Vec::with_capacity(map[0].len() / LANES);
        for n in (0..map[0].len()).step_by(LANES) {
            let of =
                |plane: &[f32]| -> Lanes { plane.get(n..).and_then(|p| p.first_chunk()).copied().unwrap_or(NOTHING) };
            let [x, y, z] = shapes.shape.each_ref().map(|p| of(p));
            let [near, wide] = shapes.near.each_ref().map(|p| of(p));
            let [map_x, map_y, map_z] = map.each_ref().map(|p| of(p));
            let [broad_x, broad_y, around] = places.broad.each_ref().map(|p| of(p));
            let [east, south] = places.at_m.each_ref().map(|p| of(p));
            let mut above = NOTHING;
            for i in 0..LANES {
                above[i] = map_z[i] - around[i];
            }
            let nodes = GroundNodes {
                height_m: &map_z,
                slope: [&map_x, &map_y],
                broad: [&broad_x, &broad_y],
                above_m: &above,
                at_m: [&east, &south],
                spacing_m: places.spacing_m,
            };
            out.push(light_up(m, ([&x, &y, &z], [&near, &wide], &of(&shapes.sun)), &nodes));
        }
        out
    }
}

/// Shares of the ground and of generalised relief in the slopes that are lit.
const BUMPING: [f32; 2] = [0.66, 0.34];
/// Strength of made relief, and how much darker the bottoms of its gullies are.
const MADE: f32 = 1.5;
const GULLY_INK: f32 = 0.5;

/// Spacing of nodes from which on averages are shaded steeper, metres, and the most that they are: averages of ground are gentler than it is.
const AVERAGED_M: f32 = 50.0;
const MOST_AVERAGED: f32 = 1.8;

/// How much steeper averages of this spacing are shaded than they are.
#[inline(always)]
fn averaged(spacing_m: f32) -> f32 {
    (spacing_m / AVERAGED_M).sqrt().sqrt().clamp(1.0, MOST_AVERAGED)
}

#[inline(always)]
fn light_up(
    m: &LightingInputs<'_>,
    ([x, y, z], [near, wide], sun): ([&Lanes; 3], [&Lanes; 2], &Lanes),
    nodes: &GroundNodes<'_, LANES>,
) -> LitNodes {
    let openness = m.means.openness();
    let cover = m.tint.cover(nodes);
    let (mut open, mut slope) = (NOTHING, [*x, *y]);
    let mut root = cover.color;
    if m.broad.is_some() {
        let made = made::relief(nodes, &cover, m.surface.hf.spacing().max_element() as f32);
        for ((slope, made), broad) in slope.iter_mut().zip(&made.slope).zip(nodes.broad) {
            for ((slope, made), broad) in slope.iter_mut().zip(made).zip(broad) {
                *slope = BUMPING[0] * (*slope + MADE * made) + BUMPING[1] * broad;
            }
        }
        for plane in &mut root {
            for (v, gully) in plane.iter_mut().zip(&made.gully) {
                *v *= 1.0 + GULLY_INK * gully;
            }
        }
    }
    let steeper = m.exaggeration * if m.broad.is_some() { averaged(nodes.spacing_m) } else { 1.0 };
    let mut normal = [NOTHING; 3];
    for i in 0..LANES {
        open[i] = openness.at(z[i], near[i], wide[i]);
        let (a, b) = (slope[0][i] * -steeper, slope[1][i] * -steeper);
        let scale = 1.0 / (a * a + b * b + 1.0).sqrt();
        (normal[0][i], normal[1][i], normal[2][i]) = (a * scale, b * scale, scale);
    }
    let [direct, sky] = m.light.parts_of(&normal, &open, sun);
    for plane in &mut root {
        for v in plane {
            *v = if *v > 0.0 { *v } else { 0.0 };
            *v = v.sqrt();
        }
    }
    LitNodes { root, direct, sky }
}
