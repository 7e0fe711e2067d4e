//! Edges of volumes in the picture: outlines, and inside them steps of depth, or strong contrast.
//!
//! Weak contrast alone tells no edge: in noise and texture light differs from pixel to pixel, and more rays change little there. What lies
//! behind the volumes counts for nothing, so edges over a white and over a black background are the same.

use super::Gathered;
use belvedere_composite::color::{Packed, Rgb};
use belvedere_core::{DVec2, Pinhole};

/// Least difference of absorbed shares of light between neighbours at an outline, of 255.
const OUTLINE: u8 = 30;
/// Least difference of square roots of linear light between neighbours where depths differ, of 255.
const VISIBLE: u8 = 18;
/// The same where they do not.
const STRONG: u8 = 40;
/// Least step of depth between neighbours, in widths of a pixel there: that of a plane seen at 10 degrees.
const STEEP: f64 = 6.0;
/// The same in edges of a voxel, below which surfaces are smooth.
const VOXELS: f64 = 1.0;

/// What the volumes add to a pixel: square roots of their linear light, and the absorbed share of light.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Cover {
    roots: [u8; 3],
    alpha: u8,
}

impl Cover {
    /// Cover of what lies one behind the other, the farthest first.
    pub(super) fn of<'g>(gathered: impl Iterator<Item = &'g Gathered>) -> Self {
        let over = |(light, left): (Rgb, f32), g: &Gathered| (g.over(light), left * (1.0 - g.alpha));
        let (light, left) = gathered.fold((Rgb::ZERO, 1.0), over);
        let byte = |root: u16| (root >> 8) as u8;
        Self { roots: Packed::new(light).roots().map(byte), alpha: (255.0 * (1.0 - left) + 0.5) as u8 }
    }

    fn is_clear(self) -> bool {
        self.alpha == 0
    }

    /// Largest difference of light.
    fn off(self, other: Self) -> u8 {
        self.roots.iter().zip(other.roots).map(|(a, b)| a.abs_diff(b)).max().unwrap_or(0)
    }
}

/// Direction across an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Across {
    Columns,
    Rows,
}

impl Across {
    /// The unit vector of the picture.
    pub(super) fn unit(self) -> DVec2 {
        match self {
            Self::Columns => DVec2::X,
            Self::Rows => DVec2::Y,
        }
    }
}

/// Finds edges in what was drawn at the pixel centres.
pub(super) struct Edges<'a> {
    pub(super) pinhole: &'a Pinhole,
    pub(super) cover: &'a [Cover],
    /// Depths at which rays end.
    pub(super) ends: &'a [f32],
    pub(super) depth: &'a [f32],
    /// The longest edge of a voxel of all volumes, scene units.
    pub(super) voxel: f64,
}

impl Edges<'_> {
    /// The direction across the edge at a pixel, if there is one.
    pub(super) fn at(&self, [x, y]: [usize; 2]) -> Option<Across> {
        let [width, height] = self.pinhole.image.map(|n| n as usize);
        let at = y * width + x;
        let beside = [(x > 0).then(|| at - 1), (x + 1 < width).then(|| at + 1)];
        let above_below = [(y > 0).then(|| at - width), (y + 1 < height).then(|| at + width)];
        let cover = self.cover;
        if cover[at].is_clear() && beside.iter().chain(&above_below).flatten().all(|i| cover[*i].is_clear()) {
            return None;
        }
        let is_edge = beside.iter().chain(&above_below).flatten().any(|i| self.parts(at, *i));
        let change = |pair: [Option<usize>; 2]| pair.iter().flatten().map(|i| self.change(at, *i)).sum::<u32>();
        is_edge.then(|| if change(beside) >= change(above_below) { Across::Columns } else { Across::Rows })
    }

    /// Whether an edge lies between two pixels.
    fn parts(&self, a: usize, b: usize) -> bool {
        let [p, q] = [a, b].map(|i| self.cover[i]);
        let off = p.off(q);
        p.alpha.abs_diff(q.alpha) > OUTLINE || off > STRONG || (off > VISIBLE && self.is_step(a, b))
    }

    fn change(&self, a: usize, b: usize) -> u32 {
        let [a, b] = [a, b].map(|i| self.cover[i]);
        u32::from(a.off(b).max(a.alpha.abs_diff(b.alpha))).pow(2)
    }

    /// Whether the depth of a volume steps between two pixels.
    fn is_step(&self, a: usize, b: usize) -> bool {
        let shows = |i: usize| self.depth[i] != self.ends[i];
        if !(shows(a) || shows(b)) {
            return false;
        }
        let [a, b] = [a, b].map(|i| f64::from(self.depth[i]));
        let nearer = if self.pinhole.is_orthographic() { 1.0 } else { a.min(b) };
        (a - b).abs() > (STEEP * nearer / self.pinhole.scale_px()).max(VOXELS * self.voxel)
    }
}
