//! Meshes as blocks of triangles.

use crate::geometry::block::{Block, Counts, Job, SoupTriangle, SoupVertex};
use crate::geometry::pass::Pass;
use crate::geometry::project::Batch;
use crate::geometry::refine::{Refiner, is_short};
use crate::screen::{SUB, ScreenVertex, Snap};
use belvedere_core::{Aabb, DVec3, EdgePoint};
use belvedere_scene::Mesh;
use belvedere_sight::CarriedLayer;
use belvedere_sight::sections::{Sections, Shown};
use rayon::prelude::*;
use std::borrow::Cow;
use std::cmp::Ordering;
use std::ops::Range;

/// Number of triangles of a block.
const TRIANGLES: usize = Mesh::BOX;
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

    /// Bounds of the blocks as they are displaced, bodies as they are carried.
    pub(crate) fn chunks(self) -> Cow<'a, [Aabb]> {
        let Self::Bodies(mesh, _) = self else { return Cow::Borrowed(self.mesh().boxes()) };
        let chunks = (0..mesh.boxes().len()).into_par_iter();
        let bounds = |chunk| Aabb::of(self.corners(self.part(chunk)).1.iter().flatten().map(|&key| self.place(key)[1]));
        chunks.map(bounds).collect::<Vec<_>>().into()
    }
}

/// A vertex of a mesh on the image.
struct Vertex {
    p: DVec3,
    /// Its image if it needs no clipping, and its outcode (`Screen::outcode`).
    image: Option<(ScreenVertex, u8)>,
    missed: bool,
}

/// Vertices of a block.
struct Vertices {
    list: Vec<Vertex>,
    /// Data for the errors of edges, `None` where they are not known; empty if edges are not judged.
    edges: Vec<Option<EdgePoint>>,
}

impl Job<'_> {
    /// Displaces, projects, subdivides and clips a part of a mesh, every vertex once.
    pub(crate) fn mesh_block(&self, pass: &Pass<'_>, drawn: Drawn<'_>, chunk: usize) -> Option<Block> {
        let (part, mesh) = (drawn.part(chunk), drawn.mesh());
        let first = part.start;
        let (triangles, corners) = drawn.corners(part);
        let (keys, corners) = distinct(&corners);
        let bounds = &mesh.boxes()[chunk];
        let shown = self.shown(bounds);
        if keys.is_empty() || shown == Shown::Nothing {
            return None;
        }
        let thin = self.sections.filter(|_| shown == Shown::Partly);
        // Positions of the corners along the deformation curve.
        let along: Vec<f64> =
            thin.iter().flat_map(|s| keys.iter().map(|&key| s.parameter(drawn.place(key)[0]))).collect();
        let places: Vec<DVec3> = keys.iter().map(|&key| drawn.place(key)[1]).collect();
        let judge = match drawn {
            Drawn::Bodies(..) => !pass.plain.is_straight_in(&Aabb::of(places.iter().copied()), self.tolerance_px),
            _ => !pass.plain.is_straight_in(bounds, self.tolerance_px),
        };
        let vertices = self.mesh_vertices(pass, &places, judge);
        let missed = vertices.list.iter().filter(|v| v.missed).count() as u64;
        let mut refiner = Refiner::new(&pass.plain, self.screen, self.tolerance_px, self.spare.soup());
        for (t, corners) in triangles.iter().zip(&corners) {
            let of_corners = |s: &Sections<'_>| s.of_corners(self.layer as usize, corners.map(|c| along[c as usize]));
            if thin.is_some_and(|s| of_corners(s) == Shown::Nothing) {
                continue;
            }
            let (parent, numbers) = (t - first as u32, corners.map(|c| c as usize));
            match self.whole(pass, &vertices, numbers) {
                Some([a, b, c]) => {
                    let vertex = |screen, corner: usize| SoupVertex { screen, weights: WEIGHTS[corner] };
                    refiner.out.push(SoupTriangle { v: [vertex(a, 0), vertex(b, 1), vertex(c, 2)], parent });
                }
                None => {
                    // Images of corners are shared with triangles that are drawn whole.
                    let corners = numbers.map(|i| &vertices.list[i]);
                    let corners = corners.map(|v| refiner.node(v.p, v.image.map(|(image, _)| image)));
                    refiner.triangle(corners, WEIGHTS, [judge; 3], parent);
                }
            }
        }
        let counts = Counts { drawn: refiner.out.len() as u64, split: refiner.splits, missed };
        let block = Block::soup(self.layer, pass.plain.numbers(), first, refiner.out, counts)?;
        let block = Block { bodies: matches!(drawn, Drawn::Bodies(..)), ..block };
        let Some(sections) = thin else { return Some(block) };
        Some(block.thinned(|k| mesh.corners(first + k as usize).map(|p| sections.parameter(p))))
    }

    /// The vertices at the given places, most of them in single precision.
    fn mesh_vertices(&self, pass: &Pass<'_>, places: &[DVec3], judge: bool) -> Vertices {
        let edges = if judge { places.iter().map(|&p| pass.plain.edge_point(p)).collect() } else { Vec::new() };
        let mut batch = Batch::default();
        if !pass.batch(places.iter().copied(), &mut batch) {
            return Vertices { list: places.iter().map(|&p| self.mesh_vertex(pass, p)).collect(), edges };
        }
        let [xs, ys] = &batch.images;
        let vertex = |(i, &p): (usize, &DVec3)| {
            if batch.missed[i] != 0 || !pass.plain.margins(p).iter().all(|m| *m >= 0.0) {
                return self.mesh_vertex(pass, p);
            }
            let image = ScreenVertex { x: xs[i], y: ys[i], q: batch.nearness[i] };
            Vertex { p, image: Some((image, self.beyond(image))), missed: false }
        };
        Vertices { list: places.iter().enumerate().map(vertex).collect(), edges }
    }

    /// Bit set of the image borders beyond which an image lies by more than the tolerance.
    fn beyond(&self, image: ScreenVertex) -> u8 {
        let margin = (self.tolerance_px * f64::from(SUB)) as i32;
        let [width, height] = [self.screen.width * SUB, self.screen.height * SUB];
        let tests = [image.x > width + margin, image.x < -margin, image.y > height + margin, image.y < -margin];
        tests.iter().enumerate().fold(0, |code, (i, &out)| code | (u8::from(out) << (i + 2)))
    }

    fn mesh_vertex(&self, pass: &Pass<'_>, p: DVec3) -> Vertex {
        let v = pass.plain.displace(p).map(|d| self.screen.view_from(d)).filter(|v| v.is_finite());
        let whole = |v: &DVec3| self.screen.is_drawable(*v) && pass.plain.margins(p).iter().all(|m| *m >= 0.0);
        let image = v.filter(whole).map(|v| (self.screen.snap(v), self.screen.outcode(v, self.tolerance_px)));
        Vertex { p, image, missed: v.is_none_or(|v| !(v.z > 0.0)) }
    }

    /// The image of a triangle that may lie in the picture and needs neither clipping nor subdivision; `None` for any other.
    /// * `numbers`: of its corners.
    fn whole(&self, pass: &Pass<'_>, vertices: &Vertices, numbers: [usize; 3]) -> Option<[ScreenVertex; 3]> {
        let corners = numbers.map(|i| &vertices.list[i]);
        let [(a, beyond_a), (b, beyond_b), (c, beyond_c)] = [corners[0].image?, corners[1].image?, corners[2].image?];
        let images = [a, b, c];
        let straight = |i: usize| {
            let k = (i + 1) % 3;
            if is_short(images[i], images[k], self.tolerance_px) {
                return true;
            }
            // Always in the same direction: two triangles must judge their common edge alike to the last bit.
            let later = corners[i].p.to_array().partial_cmp(&corners[k].p.to_array()) == Some(Ordering::Greater);
            let (from, to) = if later { (k, i) } else { (i, k) };
            let [from, to] = [from, to].map(|i| vertices.edges[numbers[i]].as_ref());
            pass.plain.edge_error_between(from, to).is_some_and(|error| error <= self.tolerance_px)
        };
        let judged = !vertices.edges.is_empty();
        let whole = beyond_a & beyond_b & beyond_c == 0 && (!judged || (0..3).all(straight));
        whole.then_some(images)
    }
}

/// Keys of the corners of triangles without repetition, in the order in which they come, and the index of the key of every corner.
fn distinct(triangles: &[[u64; 3]]) -> (Vec<u64>, Vec<[u32; 3]>) {
    const EMPTY: u32 = u32::MAX;
    // At most half full, so that few probes are needed.
    let slots = (6 * triangles.len()).next_power_of_two();
    let mut table = vec![EMPTY; slots];
    let mut keys: Vec<u64> = Vec::with_capacity(3 * triangles.len());
    let mut index = |key: u64| {
        // Multiplication by an odd number spreads neighbouring keys; its upper bits depend on all of the key.
        let mut slot = (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize % slots;
        loop {
            match table[slot] {
                EMPTY => {
                    table[slot] = keys.len() as u32;
                    keys.push(key);
                    return table[slot];
                }
                known if keys[known as usize] == key => return known,
                _ => slot = (slot + 1) % slots,
            }
        }
    };
    let corners = triangles.iter().map(|keys| keys.map(&mut index)).collect();
    (keys, corners)
}

#[cfg(test)]
mod tests {
    use super::distinct;

    #[test]
    fn every_corner_finds_its_key_and_none_is_kept_twice() {
        let body = 7 << 32;
        for triangles in [
            vec![],
            vec![[0, 1, 2], [2, 1, 3], [3, 3, 3]],
            (0..512).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
            (0..512).map(|t| [(t * 7919) % 300, body | ((t * 104_729) % 300), (t * 31) << 20]).collect(),
        ] {
            let (keys, corners) = distinct(&triangles);
            let found: Vec<[u64; 3]> = corners.iter().map(|c| c.map(|i| keys[i as usize])).collect();
            assert_eq!(found, triangles);
            let mut sorted = keys.clone();
            sorted.sort_unstable();
            sorted.dedup();
            assert_eq!(sorted.len(), keys.len());
        }
    }
}
