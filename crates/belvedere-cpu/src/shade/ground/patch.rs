//! Nodes of the ground with the light on them, a patch at a time: each step is a plain loop over short arrays, which
//! compilers turn into vector instructions.

use crate::shade::ground::palette::Tint;
use crate::shade::ground::planes::Planes;
use crate::shade::ground::rows::Between;
use crate::shade::ground::shadow::Shadows;
use crate::shade::ground::surface::{MipPyramid, Surface};
use crate::shade::ground::tiles::Line;
use crate::shade::relief::ReliefLight;
use crate::simd::{self, Kernel, LANES, Lanes};

/// Everything that the tiles of a ground are made from.
pub(crate) struct LightingInputs<'a> {
    pub(crate) surface: &'a Surface<'a>,
    pub(crate) means: &'a MipPyramid,
    pub(crate) shadows: Option<&'a Shadows>,
    pub(crate) tint: &'a Tint,
    pub(crate) light: &'a ReliefLight,
    pub(crate) exaggeration: f32,
}

/// What nodes look like.
#[derive(Clone)]
pub(crate) struct LitNodes {
    /// Square roots of linear red, green, blue without light.
    pub(crate) root: [Lanes; 3],
    /// Amounts of direct light and of light from the sky.
    pub(crate) direct: Lanes,
    pub(crate) sky: Lanes,
}

/// What the light on nodes depends on, plane by plane, padded to whole lanes.
struct Shapes {
    /// dz/dx, dz/dy, height.
    shape: [Vec<f32>; 3],
    /// Height of the near surroundings and what the wider ones ask for, see [`MipPyramid::openness`].
    near: [Vec<f32>; 2],
    /// Share of the sun that no shadow takes.
    sun: Vec<f32>,
}

const NOTHING: Lanes = [0.0; LANES];

impl Shapes {
    fn new(nodes: usize) -> Self {
        let n = nodes.next_multiple_of(LANES);
        let plane = || vec![0.0; n];
        Self { shape: [plane(), plane(), plane()], near: [plane(), plane()], sun: vec![1.0; n] }
    }
}

/// Nodes of a level with the light on them, row by row.
pub(crate) struct Patch {
    nodes: Vec<LitNodes>,
}

impl Patch {
    /// The nodes where rows and columns meet.
    pub(crate) fn new(m: &LightingInputs<'_>, k: usize, columns: Line, rows: Line) -> Self {
        let mut shapes = Shapes::new(columns.count * rows.count);
        let (first, inside) = columns.inside();
        let mut row = Row::new(m, k, first, inside.len());
        for (n, r) in rows.iter().enumerate() {
            let all = n * columns.count..(n + 1) * columns.count;
            row.fill(m, k, r, &mut shapes, all.start + inside.start);
            let Shapes { shape: [x, y, z], near: [height, asked], sun } = &mut shapes;
            for plane in [x, y, z, height, asked, sun] {
                columns.repeat(&mut plane[all.clone()]);
            }
        }
        Self { nodes: simd::run(LightUp { m, shapes: &shapes }) }
    }

    /// The nodes, [`LANES`] at a time; those past the last one mean nothing.
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

/// A row of nodes in the making, from column `first` on.
struct Row {
    first: usize,
    shape: Planes,
    near: Planes,
    /// The surroundings of levels finer than those stored.
    between: Option<Between>,
}

impl Row {
    fn new(m: &LightingInputs<'_>, k: usize, first: usize, n: usize) -> Self {
        let between = (k < m.means.first).then(|| Between::new(m.means, k, first, n));
        Self { first, shape: Planes::new(n), near: Planes::new(n), between }
    }

    /// Writes row `row` of level `k` from place `at` on.
    fn fill(&mut self, m: &LightingInputs<'_>, k: usize, row: usize, to: &mut Shapes, at: usize) {
        let Self { first, shape, near, between } = self;
        let places = at..at + shape.w.len();
        if let Some(shadows) = m.shadows {
            shadows.share_row(k, row, *first, &mut to.sun[places.clone()]);
        }
        let surroundings = if let Some(between) = between {
            m.surface.mean_row(k, row, *first, shape);
            between.row(m.means, row, near);
            near
        } else {
            m.means.row(k, row, *first, shape);
            &*shape
        };
        let Shapes { shape: [x, y, z], near: [height, asked], .. } = to;
        let to = [x, y, z, height, asked].map(|plane| &mut plane[places.clone()]);
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
                // A hole looks like the ground around it.
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
        let Shapes { shape: [x, y, z], near: [height, asked], sun } = self.shapes;
        let mut out = Vec::with_capacity(x.len() / LANES);
        for n in (0..x.len()).step_by(LANES) {
            let (Some(x), Some(y), Some(z)) = (lanes(x, n), lanes(y, n), lanes(z, n)) else { break };
            let (Some(height), Some(asked), Some(sun)) = (lanes(height, n), lanes(asked, n), lanes(sun, n)) else {
                break;
            };
            out.push(light_up(self.m, [x, y, z], [height, asked], sun));
        }
        out
    }
}

#[inline(always)]
fn lanes(plane: &[f32], n: usize) -> Option<&Lanes> {
    plane.get(n..)?.first_chunk()
}

#[inline(always)]
fn light_up(m: &LightingInputs<'_>, [x, y, z]: [&Lanes; 3], near: [&Lanes; 2], sun: &Lanes) -> LitNodes {
    let openness = m.means.openness();
    let (mut open, mut steep, mut normal) = (NOTHING, NOTHING, [NOTHING; 3]);
    for i in 0..LANES {
        open[i] = openness.at(z[i], near[0][i], near[1][i]);
        steep[i] = (x[i] * x[i] + y[i] * y[i]).sqrt();
        let (a, b) = (x[i] * -m.exaggeration, y[i] * -m.exaggeration);
        let scale = 1.0 / (a * a + b * b + 1.0).sqrt();
        (normal[0][i], normal[1][i], normal[2][i]) = (a * scale, b * scale, scale);
    }
    let [direct, sky] = m.light.parts_of(&normal, &open, sun);
    let mut root = m.tint.colors(z, &steep);
    for plane in &mut root {
        for v in plane {
            *v = v.sqrt();
        }
    }
    LitNodes { root, direct, sky }
}
