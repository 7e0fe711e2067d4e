//! What stands around ground whose data end: the sides of a block, or a surface that goes on. They are meshes, which bends carry like any
//! other.

use super::loader::Loader;
use belvedere_core::{DVec2, DVec3};
use belvedere_document::TerrainDoc;
use belvedere_scene::{Color, Edge, Heightfield, Layer, Mesh, MeshColors, MeshLayer, TerrainLayer};
use std::collections::HashMap;

/// Colours of the sides, and of the surface.
const SIDES: Color = Color::rgb(168, 152, 132);
const MAT: Color = Color::rgb(222, 219, 212);
/// Depth of the base of a block below the lowest ground: shares of the range of heights and of the shorter side.
const DEEPER: [f64; 2] = [0.12, 0.012];
/// Width of a mat beyond the data as a share of their longer side, and the cells along a side of it.
const BEYOND: f64 = 1.0;
const CELLS: usize = 96;
/// Steps by which the direction of a rim is averaged, each over a node's neighbours.
const STEPS: usize = 24;
/// Distance of a mat from the lowest ground as a share of the longer side.
const BELOW: f64 = 2e-4;

/// The sides or the surface that a terrain layer asks for; `None` for other edges.
pub(super) fn layer(loader: &Loader<'_>, doc: &TerrainDoc, terrain: &TerrainLayer) -> Option<Layer> {
    let ground = &terrain.heightfield;
    let (mesh, color) = match terrain.edge {
        Edge::Plain | Edge::Soft => return None,
        Edge::Block => (sides(ground, base_of_block(ground))?, SIDES),
        Edge::Mat => (mat(ground)?, MAT),
    };
    let taken = loader.layers.iter().any(|l| l.id() == Edge::LAYER);
    let id = if taken { format!("{} of {}", Edge::LAYER, doc.id) } else { Edge::LAYER.to_owned() };
    Some(Layer { id, must_see: false, kind: MeshLayer::new(mesh, color).into() })
}

fn base_of_block(ground: &Heightfield) -> f64 {
    let ([low, high], bounds) = (ground.z_range(), ground.bounds());
    let side = (bounds.max - bounds.min).truncate().min_element();
    low - (DEEPER[0] * (high - low)).max(DEEPER[1] * side)
}

/// Upright sides from the rim of the data down to a base; `None` for ground without a cell.
fn sides(ground: &Heightfield, base: f64) -> Option<Mesh> {
    let mut build = Build::default();
    build.sides(ground, base);
    build.mesh()
}

/// A level surface under and around the ground, and the sides that stand on it.
fn mat(ground: &Heightfield) -> Option<Mesh> {
    let bounds = ground.bounds();
    let (lo, size) = (bounds.min.truncate(), (bounds.max - bounds.min).truncate());
    let base = ground.z_range()[0] - BELOW * size.max_element();
    let mut build = Build::default();
    build.sides(ground, base);
    let margin = BEYOND * size.max_element();
    let (from, step) = (lo - margin, (size + 2.0 * margin) / CELLS as f64);
    let first = build.points.len() as u32;
    for row in 0..=CELLS {
        for col in 0..=CELLS {
            build.points.push((from + step * DVec2::new(col as f64, row as f64)).extend(base));
        }
    }
    for row in 0..CELLS {
        for col in 0..CELLS {
            let corner = |c: usize, r: usize| first + ((row + r) * (CELLS + 1) + col + c) as u32;
            build.quad([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]);
        }
    }
    build.mesh()
}

/// A mesh in the making.
#[derive(Default)]
struct Build {
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// Points on the ground and below them, by node.
    walls: HashMap<[usize; 2], [u32; 2]>,
    /// Points below the ground from which a side goes, and those to which it goes.
    along: Vec<[u32; 2]>,
}

impl Build {
    fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        self.triangles.extend([[a, b, c], [a, c, d]]);
    }

    /// Sides along every edge of a cell with data beside which there is none.
    fn sides(&mut self, ground: &Heightfield, base: f64) {
        let (cols, rows) = (ground.cols() as i64 - 1, ground.rows() as i64 - 1);
        let is_cell = |c: i64, r: i64| {
            let inside = c >= 0 && r >= 0 && c < cols && r < rows;
            inside
                && [[0, 0], [1, 0], [0, 1], [1, 1]]
                    .iter()
                    .all(|[i, j]| ground.node((c + i) as usize, (r + j) as usize).is_some())
        };
        for r in 0..rows {
            for c in 0..cols {
                if !is_cell(c, r) {
                    continue;
                }
                // Neighbour, and the edge towards it so that the side faces it; row 0 is the northernmost.
                let edges = [
                    ([0, -1], [[1, 0], [0, 0]]),
                    ([0, 1], [[0, 1], [1, 1]]),
                    ([-1, 0], [[0, 0], [0, 1]]),
                    ([1, 0], [[1, 1], [1, 0]]),
                ];
                for ([dc, dr], ends) in edges {
                    if is_cell(c + dc, r + dr) {
                        continue;
                    }
                    let [a, b] = ends.map(|[i, j]| self.wall(ground, [(c + i) as usize, (r + j) as usize], base));
                    if let (Some([top_a, low_a]), Some([top_b, low_b])) = (a, b) {
                        self.quad([low_a, low_b, top_b, top_a]);
                        self.along.push([low_a, low_b]);
                    }
                }
            }
        }
    }

    /// The point on the ground at a node, and the one below it.
    fn wall(&mut self, ground: &Heightfield, node: [usize; 2], base: f64) -> Option<[u32; 2]> {
        let p = ground.node(node[0], node[1])?;
        let points = &mut self.points;
        Some(*self.walls.entry(node).or_insert_with(|| {
            let first = points.len() as u32;
            points.extend([p, p.truncate().extend(base)]);
            [first, first + 1]
        }))
    }

    fn mesh(self) -> Option<Mesh> {
        if self.triangles.is_empty() {
            return None;
        }
        let normals = self.normals();
        Mesh::new(&self.points, self.triangles, MeshColors::Layer).ok()?.with_normals(&normals).ok()
    }

    /// Normals by which points are lit: up on level surfaces; on sides those of the rim without the steps that it has from node to node
    /// where it crosses the lattice aslant.
    fn normals(&self) -> Vec<DVec3> {
        let mut outward = vec![DVec2::ZERO; self.points.len()];
        for [a, b] in self.along.iter().map(|ends| ends.map(|i| i as usize)) {
            let along = (self.points[b] - self.points[a]).truncate();
            for end in [a, b] {
                outward[end] -= along.perp();
            }
        }
        for _ in 0..STEPS {
            let mut next = outward.clone();
            for [a, b] in self.along.iter().map(|ends| ends.map(|i| i as usize)) {
                next[a] += outward[b];
                next[b] += outward[a];
            }
            outward = next.into_iter().map(DVec2::normalize_or_zero).collect();
        }
        for [top, low] in self.walls.values().map(|points| points.map(|i| i as usize)) {
            outward[top] = outward[low];
        }
        let of = |n: DVec2| if n == DVec2::ZERO { DVec3::Z } else { n.normalize().extend(0.0) };
        outward.into_iter().map(of).collect()
    }
}

#[cfg(test)]
mod tests;
