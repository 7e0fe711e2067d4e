//! Nodes of the ground with the light on them, a patch at a time: each step is a plain loop over short arrays, which
//! compilers turn into vector instructions.

use super::ground::{Means, Surface};
use super::palette::Tint;
use super::relief::ReliefLight;
use super::shadow::Shadows;
use crate::vector::{self, Kernel};
use glam::Vec4;

/// Nodes that are lit together.
pub(super) const LANES: usize = 32;
pub(super) type Lanes = [f32; LANES];

/// Everything that the tiles of a ground are made from.
pub(crate) struct Making<'a> {
    pub(crate) surface: &'a Surface<'a>,
    pub(crate) means: &'a Means,
    pub(crate) shadows: Option<&'a Shadows>,
    pub(crate) tint: &'a Tint,
    pub(crate) light: &'a ReliefLight,
    pub(crate) exaggeration: f32,
}

/// What nodes look like.
#[derive(Clone)]
pub(super) struct LitNodes {
    /// Square roots of linear red, green, blue without light.
    pub(super) root: [Lanes; 3],
    /// Amounts of direct light and of light from the sky.
    pub(super) direct: Lanes,
    pub(super) sky: Lanes,
}

/// What the light on nodes depends on.
#[derive(Clone)]
struct Shapes {
    /// dz/dx, dz/dy, height.
    shape: [Lanes; 3],
    /// Height of the near surroundings and what the wider ones ask for, see [`Means::openness`].
    near: [Lanes; 2],
    /// Share of the sun that no shadow takes.
    sun: Lanes,
}

const NOTHING: Lanes = [0.0; LANES];

impl Shapes {
    const EMPTY: Self = Self { shape: [NOTHING; 3], near: [NOTHING; 2], sun: [1.0; LANES] };
}

/// Nodes of a level with the light on them, row by row.
pub(super) struct Patch {
    nodes: Vec<LitNodes>,
}

impl Patch {
    /// The nodes where rows and columns meet, both in rising order; some may be there twice.
    pub(super) fn new(
        m: &Making<'_>,
        k: usize,
        columns: impl Iterator<Item = usize> + Clone,
        rows: impl Iterator<Item = usize>,
    ) -> Self {
        let (first, last) = columns.clone().fold((usize::MAX, 0), |(lo, hi), c| (lo.min(c), hi.max(c)));
        let mut row = Row::new(first, last + 1 - first.min(last));
        let mut shapes = Vec::new();
        let mut n = 0;
        for r in rows {
            row.fill(m, k, r);
            for c in columns.clone() {
                let (i, lane) = (c - first, n % LANES);
                if lane == 0 {
                    shapes.push(Shapes::EMPTY);
                }
                if let Some(to) = shapes.last_mut() {
                    row.write(i, to, lane);
                }
                n += 1;
            }
        }
        Self { nodes: vector::run(LightUp { m, shapes: &shapes }) }
    }

    /// The nodes, [`LANES`] at a time; those past the last one mean nothing.
    pub(super) fn nodes(&self) -> &[LitNodes] {
        &self.nodes
    }
}

impl LitNodes {
    /// Square roots of the lit colour.
    #[inline(always)]
    pub(super) fn lit_roots(&self, light: &ReliefLight) -> [Lanes; 3] {
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
    shape: Vec<Vec4>,
    near: Vec<Vec4>,
    sun: Vec<f32>,
}

impl Row {
    fn new(first: usize, n: usize) -> Self {
        Self { first, shape: vec![Vec4::ZERO; n], near: vec![Vec4::ZERO; n], sun: vec![1.0; n] }
    }

    fn fill(&mut self, m: &Making<'_>, k: usize, row: usize) {
        let Self { first, shape, near, sun } = self;
        if k >= m.means.first {
            m.means.row(k, row, *first, shape);
            near.copy_from_slice(shape);
        } else {
            m.surface.mean_row(k, row, *first, shape);
            m.means.row_between(k, row, *first, near);
        }
        if let Some(shadows) = m.shadows {
            shadows.share_row(k, row, *first, sun);
        }
    }

    #[inline(always)]
    fn write(&self, i: usize, to: &mut Shapes, lane: usize) {
        let near = self.near[i];
        // A hole looks like the ground around it.
        let [x, y, z, _] = if self.shape[i].w == 0.0 { near } else { self.shape[i] }.to_array();
        (to.shape[0][lane], to.shape[1][lane], to.shape[2][lane]) = (x, y, z);
        (to.near[0][lane], to.near[1][lane]) = (near.z, near.w);
        to.sun[lane] = self.sun[i];
    }
}

/// Lights nodes.
struct LightUp<'a> {
    m: &'a Making<'a>,
    shapes: &'a [Shapes],
}

impl Kernel for LightUp<'_> {
    type Output = Vec<LitNodes>;

    #[inline(always)]
    fn run(self) -> Vec<LitNodes> {
        let mut out = Vec::with_capacity(self.shapes.len());
        for nodes in self.shapes {
            out.push(light_up(self.m, nodes));
        }
        out
    }
}

#[inline(always)]
fn light_up(m: &Making<'_>, nodes: &Shapes) -> LitNodes {
    let ([x, y, z], openness) = (&nodes.shape, m.means.openness());
    let (mut open, mut steep, mut normal) = (NOTHING, NOTHING, [NOTHING; 3]);
    for i in 0..LANES {
        open[i] = openness.at(z[i], nodes.near[0][i], nodes.near[1][i]);
        steep[i] = (x[i] * x[i] + y[i] * y[i]).sqrt();
        let (a, b) = (x[i] * -m.exaggeration, y[i] * -m.exaggeration);
        let scale = 1.0 / (a * a + b * b + 1.0).sqrt();
        (normal[0][i], normal[1][i], normal[2][i]) = (a * scale, b * scale, scale);
    }
    let [direct, sky] = m.light.parts_of(&normal, &open, &nodes.sun);
    let mut root = m.tint.colors(z, &steep);
    for plane in &mut root {
        for v in plane {
            *v = v.sqrt();
        }
    }
    LitNodes { root, direct, sky }
}
