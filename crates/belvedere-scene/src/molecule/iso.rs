//! The surface where a density is 1, as triangles: cells are cut into tetrahedra, so that it is closed whatever the values are.
//!
//! Source: marching tetrahedra (Doi and Koide 1991) on the six tetrahedra along the diagonal of a cell (Kuhn), whose faces fit together.

use super::density::{Ball, Density};
use super::shape::Shape;
use super::sky::Sky;
use crate::Color;
use belvedere_core::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::LazyLock;

/// Layers of cells that are made together.
const SLAB: usize = 16;
/// Share of an edge that corners of the surface keep from its ends, so that triangles have an area.
const OFF: f64 = 1e-3;

/// An edge of a cell: the corners at its ends, whose bits are x, y and z; the first holds fewer.
type Edge = [u8; 2];

/// For each tetrahedron and each choice of its corners that lie inside: triangles over edges, counter-clockwise from outside.
static CASES: LazyLock<[[Vec<[Edge; 3]>; 16]; 6]> = LazyLock::new(|| {
    const ORDERS: [[u8; 3]; 6] = [[1, 2, 4], [1, 4, 2], [2, 1, 4], [2, 4, 1], [4, 1, 2], [4, 2, 1]];
    ORDERS.map(|[a, b, _]| {
        let corners = [0, a, a | b, 7];
        std::array::from_fn(|inside| case(corners, inside))
    })
});

fn case(corners: [u8; 4], inside: usize) -> Vec<[Edge; 3]> {
    let is_in = |k: usize| inside >> k & 1 == 1;
    let (ins, outs): (Vec<usize>, Vec<usize>) = (0..4).partition(|&k| is_in(k));
    let edge = |a: usize, b: usize| [corners[a.min(b)], corners[a.max(b)]];
    let place = |c: u8| DVec3::new(f64::from(c & 1), f64::from(c >> 1 & 1), f64::from(c >> 2 & 1));
    let middle = |e: &Edge| 0.5 * (place(e[0]) + place(e[1]));
    let triangles: Vec<[Edge; 3]> = match (&ins[..], &outs[..]) {
        (&[a], &[b, c, d]) | (&[b, c, d], &[a]) => vec![[edge(a, b), edge(a, c), edge(a, d)]],
        (&[a, b], &[c, d]) => {
            let [p, q, r, s] = [edge(a, c), edge(a, d), edge(b, d), edge(b, c)];
            vec![[p, q, r], [p, r, s]]
        }
        _ => Vec::new(),
    };
    let mean = |list: &[usize]| list.iter().map(|&k| place(corners[k])).sum::<DVec3>() / list.len() as f64;
    let outwards = |t: [Edge; 3]| {
        let [p, q, r] = t.map(|e| middle(&e));
        if (q - p).cross(r - p).dot(mean(&outs) - mean(&ins)) > 0.0 { t } else { [t[0], t[2], t[1]] }
    };
    triangles.into_iter().map(outwards).collect()
}

/// The surface of balls; `atoms` and `colors` are theirs.
pub(super) fn build(balls: &[Ball], atoms: &[u32], colors: &[Color], detail: Option<u32>) -> Vec<Shape> {
    let density = Density::new(balls, detail);
    let sky = Sky::near(balls);
    let maker = Maker { density: &density, sky: &sky, atoms, colors };
    (0..(density.size[2] - 1).div_ceil(SLAB)).into_par_iter().map(|slab| maker.slab(slab)).collect()
}

struct Maker<'a> {
    density: &'a Density<'a>,
    sky: &'a Sky,
    atoms: &'a [u32],
    colors: &'a [Color],
}

/// Triangles of a slab, and the ball of each of its vertices.
#[derive(Default)]
struct Piece {
    shape: Shape,
    owners: Vec<u32>,
    /// Vertices by sample and direction of their edge.
    known: HashMap<[u32; 2], u32>,
}

impl Maker<'_> {
    fn slab(&self, slab: usize) -> Shape {
        let d = self.density;
        let [nx, ny, nz] = d.size;
        let mut piece = Piece::default();
        for z in slab * SLAB..((slab + 1) * SLAB).min(nz - 1) {
            for y in 0..ny - 1 {
                for x in 0..nx - 1 {
                    self.cell(&mut piece, [x, y, z]);
                }
            }
            // Edges of layers below are passed.
            let first = d.index([0, 0, z + 1]) as u32;
            piece.known.retain(|[sample, _], _| *sample >= first);
        }
        piece.shape
    }

    fn cell(&self, piece: &mut Piece, at: [usize; 3]) {
        let d = self.density;
        let first = d.index(at);
        let step = |c: u8| {
            let c = usize::from(c);
            (c & 1) + (c >> 1 & 1) * d.size[0] + (c >> 2) * d.size[0] * d.size[1]
        };
        let mut inside = 0u8;
        for c in 0..8 {
            inside |= u8::from(d.values[first + step(c)] > 0.0) << c;
        }
        if inside == 0 || inside == 255 {
            return;
        }
        const ORDERS: [[u8; 2]; 6] = [[1, 3], [1, 5], [2, 3], [2, 6], [4, 5], [4, 6]];
        for (k, [b, c]) in ORDERS.into_iter().enumerate() {
            let mask =
                [0, b, c, 7].into_iter().enumerate().map(|(n, c)| usize::from(inside >> c & 1) << n).sum::<usize>();
            for triangle in &CASES[k][mask] {
                let corners = triangle.map(|edge| self.vertex(piece, at, edge));
                let middle = corners.iter().map(|&v| piece.shape.positions[v as usize]).sum::<DVec3>() / 3.0;
                let owner = d.largest(middle, corners.map(|v| piece.owners[v as usize])).unwrap_or(0);
                piece.shape.triangle(corners, self.atoms[owner as usize]);
            }
        }
    }

    fn vertex(&self, piece: &mut Piece, at: [usize; 3], [from, to]: Edge) -> u32 {
        let d = self.density;
        let corner = |c: u8| [at[0] + usize::from(c & 1), at[1] + usize::from(c >> 1 & 1), at[2] + usize::from(c >> 2)];
        let (a, b) = (corner(from), corner(to));
        let samples = [d.index(a), d.index(b)];
        let key = [samples[0] as u32, u32::from(to ^ from)];
        if let Some(&known) = piece.known.get(&key) {
            return known;
        }
        let [va, vb] = samples.map(|s| f64::from(d.values[s]));
        let f = (va / (va - vb)).clamp(OFF, 1.0 - OFF);
        let p = d.place(a).lerp(d.place(b), f);
        let normal = -d.gradient(a).lerp(d.gradient(b), f).normalize_or_zero();
        let owner = d.owner(p, samples).unwrap_or(0);
        let open = self.sky.open(p, normal);
        let number = piece.shape.vertex(p, normal, open, self.colors[owner as usize]);
        piece.owners.push(owner);
        piece.known.insert(key, number);
        number
    }
}

#[cfg(test)]
mod tests;
