//! Meshes as blocks of triangles.

use crate::geometry::block::{Block, Counts, Job, SoupTriangle, SoupVertex};
use crate::geometry::pass::Pass;
use crate::geometry::project::Batch;
use crate::geometry::refine::{Refiner, is_short};
use crate::screen::{SUB, ScreenVertex, Snap};
use belvedere_composite::sections::{Sections, Shown};
use belvedere_core::{Aabb, DVec3, EdgePoint};
use belvedere_scene::Mesh;
use belvedere_sight::CarriedLayer;
use rayon::prelude::*;
use std::ops::Range;

/// Number of triangles of a block.
const TRIANGLES: usize = 512;
/// Weights of vertices 1 and 2 of a triangle at its corners.
const WEIGHTS: [[f32; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];

/// Part of a mesh that is drawn.
#[derive(Clone, Copy)]
pub(crate) enum Drawn<'a> {
    /// All triangles.
    All(&'a Mesh),
    /// Those that belong to no rigid body.
    Loose(&'a Mesh, &'a CarriedLayer),
    /// The rigid bodies, where a view carries them to.
    Bodies(&'a Mesh, &'a CarriedLayer),
}

impl<'a> Drawn<'a> {
    fn mesh(self) -> &'a Mesh {
        match self {
            Self::All(mesh) | Self::Loose(mesh, _) | Self::Bodies(mesh, _) => mesh,
        }
    }

    /// Upper half of the corner keys of a triangle: the number of its body; `None` if the triangle is not drawn.
    fn key(self, triangle: usize) -> Option<u64> {
        match self {
            Self::All(_) => Some(0),
            Self::Loose(_, bodies) => (!bodies.holds(triangle)).then_some(0),
            Self::Bodies(_, bodies) => bodies.body(triangle).map(|(body, _)| (body as u64) << 32),
        }
    }

    /// Numbers of the drawn triangles of a part, and the keys of their corners.
    fn corners(self, part: Range<usize>) -> (Vec<u32>, Vec<[u64; 3]>) {
        let mesh = self.mesh();
        let drawn = part.filter_map(|t| Some((t as u32, self.key(t)?)));
        drawn.map(|(t, key)| (t, mesh.triangles()[t as usize].map(|v| key | u64::from(v)))).unzip()
    }

    /// Position of a corner by its key: undisplaced, and as carried with its body.
    fn place(self, key: u64) -> [DVec3; 2] {
        let p = self.mesh().vertex(key as u32);
        match self {
            Self::Bodies(_, bodies) => [p, bodies.motion((key >> 32) as usize).map_or(p, |motion| motion.carry(p))],
            _ => [p; 2],
        }
    }

    fn part(self, chunk: usize) -> Range<usize> {
        let count = self.mesh().triangles().len();
        (chunk * TRIANGLES).min(count)..((chunk + 1) * TRIANGLES).min(count)
    }

    /// Bounds of the blocks.
    pub(crate) fn chunks(self) -> Vec<Aabb> {
        let chunks = (0..self.mesh().triangles().len().div_ceil(TRIANGLES)).into_par_iter();
        let bounds = |chunk| Aabb::of(self.corners(self.part(chunk)).1.iter().flatten().map(|&key| self.place(key)[1]));
        chunks.map(bounds).collect()
    }
}

/// A vertex of a mesh on the image.
struct Vertex {
    p: DVec3,
    /// Its image if it needs no clipping, and its outcode (`Screen::outcode`).
    image: Option<(ScreenVertex, u8)>,
    /// Data for the error of edges; `None` where it is not known.
    edge: Option<EdgePoint>,
    missed: bool,
}

impl Job<'_> {
    /// Displaces, projects, subdivides and clips a part of a mesh, every vertex once.
    pub(crate) fn mesh_block(&self, pass: &Pass<'_>, drawn: Drawn<'_>, chunk: usize) -> Option<Block> {
        let (part, mesh) = (drawn.part(chunk), drawn.mesh());
        let first = part.start;
        let (triangles, corners) = drawn.corners(part);
        let (keys, corners) = distinct(&corners);
        let places: Vec<[DVec3; 2]> = keys.iter().map(|&key| drawn.place(key)).collect();
        let [bounds, carried] = [0, 1].map(|k| Aabb::of(places.iter().map(|p| p[k])));
        if places.is_empty() || self.shown(&bounds) == Shown::Nothing {
            return None;
        }
        let thin = self.sections.filter(|_| self.shown(&bounds) == Shown::Partly);
        // Positions of the corners along the deformation curve.
        let along: Vec<f64> = thin.iter().flat_map(|s| places.iter().map(|p| s.parameter(p[0]))).collect();
        let judge = !pass.is_straight_in(&carried, self.tolerance_px);
        let vertices = self.mesh_vertices(pass, &places, judge);
        let missed = vertices.iter().filter(|v| v.missed).count() as u64;
        let mut refiner = Refiner::new(pass, self.screen, self.tolerance_px, self.spare.soup());
        for (t, corners) in triangles.iter().zip(&corners) {
            let of_corners = |s: &Sections<'_>| s.of_corners(self.layer as usize, corners.map(|c| along[c as usize]));
            if thin.is_some_and(|s| of_corners(s) == Shown::Nothing) {
                continue;
            }
            let (parent, corners) = (t - first as u32, corners.map(|c| &vertices[c as usize]));
            match self.whole(pass, corners, judge) {
                Some([a, b, c]) => {
                    let vertex = |screen, corner: usize| SoupVertex { screen, weights: WEIGHTS[corner] };
                    refiner.out.push(SoupTriangle { v: [vertex(a, 0), vertex(b, 1), vertex(c, 2)], parent });
                }
                None => {
                    // Images of corners are shared with triangles that are drawn whole.
                    let corners = corners.map(|v| refiner.node(v.p, v.image.map(|(image, _)| image)));
                    refiner.triangle(corners, WEIGHTS, [judge; 3], parent);
                }
            }
        }
        let counts = Counts { drawn: refiner.out.len() as u64, split: refiner.splits, missed };
        let block = Block::soup(self.layer, pass.numbers, first, refiner.out, counts)?;
        let block = Block { bodies: matches!(drawn, Drawn::Bodies(..)), ..block };
        let Some(sections) = thin else { return Some(block) };
        Some(block.thinned(|k| mesh.corners(first + k as usize).map(|p| sections.parameter(p))))
    }

    /// The vertices at the given places, most of them in single precision.
    fn mesh_vertices(&self, pass: &Pass<'_>, places: &[[DVec3; 2]], judge: bool) -> Vec<Vertex> {
        let mut batch = Batch::default();
        if !pass.batch(places.iter().map(|p| p[1]), &mut batch) {
            return places.iter().map(|p| self.mesh_vertex(pass, p[1], judge)).collect();
        }
        let [xs, ys] = &batch.images;
        let vertex = |(i, p): (usize, &[DVec3; 2])| {
            let p = p[1];
            if batch.missed[i] != 0 || !pass.margins(p).iter().all(|m| *m >= 0.0) {
                return self.mesh_vertex(pass, p, judge);
            }
            let image = ScreenVertex { x: xs[i], y: ys[i], q: batch.nearness[i] };
            let edge = if judge { pass.edge_point(p) } else { None };
            Vertex { p, image: Some((image, self.beyond(image))), edge, missed: false }
        };
        places.iter().enumerate().map(vertex).collect()
    }

    /// Bit set of the image borders beyond which an image lies by more than the tolerance.
    fn beyond(&self, image: ScreenVertex) -> u8 {
        let margin = (self.tolerance_px * f64::from(SUB)) as i32;
        let [width, height] = [self.screen.width * SUB, self.screen.height * SUB];
        let tests = [image.x > width + margin, image.x < -margin, image.y > height + margin, image.y < -margin];
        tests.iter().enumerate().fold(0, |code, (i, &out)| code | (u8::from(out) << (i + 2)))
    }

    fn mesh_vertex(&self, pass: &Pass<'_>, p: DVec3, judge: bool) -> Vertex {
        let v = pass.displace(p).map(|d| self.screen.view_from(d)).filter(|v| v.is_finite());
        let whole = |v: &DVec3| self.screen.is_drawable(*v) && pass.margins(p).iter().all(|m| *m >= 0.0);
        let image = v.filter(whole).map(|v| (self.screen.snap(v), self.screen.outcode(v, self.tolerance_px)));
        let edge = if judge { pass.edge_point(p) } else { None };
        Vertex { p, image, edge, missed: v.is_none_or(|v| !(v.z > 0.0)) }
    }

    /// The image of a triangle that may lie in the picture and needs neither clipping nor subdivision; `None` for any other.
    fn whole(&self, pass: &Pass<'_>, corners: [&Vertex; 3], judge: bool) -> Option<[ScreenVertex; 3]> {
        let [(a, beyond_a), (b, beyond_b), (c, beyond_c)] = [corners[0].image?, corners[1].image?, corners[2].image?];
        let images = [a, b, c];
        let straight = |i: usize| {
            if is_short(images[i], images[(i + 1) % 3], self.tolerance_px) {
                return true;
            }
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            // Always in the same direction: two triangles must judge their common edge alike to the last bit.
            let swap = a.p.to_array().partial_cmp(&b.p.to_array()) == Some(std::cmp::Ordering::Greater);
            let (a, b) = if swap { (b, a) } else { (a, b) };
            let error = pass.edge_error_between(a.edge.as_ref(), b.edge.as_ref());
            error.is_some_and(|error| error <= self.tolerance_px)
        };
        let whole = beyond_a & beyond_b & beyond_c == 0 && (!judge || (0..3).all(straight));
        whole.then_some([a, b, c])
    }
}

/// Keys of the corners of triangles without repetition, and the index of the key of every corner.
fn distinct(triangles: &[[u64; 3]]) -> (Vec<u64>, Vec<[u32; 3]>) {
    let mut order: Vec<(u64, u32)> =
        triangles.as_flattened().iter().enumerate().map(|(slot, &key)| (key, slot as u32)).collect();
    order.sort_unstable();
    let (mut keys, mut corners) = (Vec::new(), vec![[0; 3]; triangles.len()]);
    for (key, slot) in order {
        if keys.last() != Some(&key) {
            keys.push(key);
        }
        corners.as_flattened_mut()[slot as usize] = keys.len() as u32 - 1;
    }
    (keys, corners)
}
