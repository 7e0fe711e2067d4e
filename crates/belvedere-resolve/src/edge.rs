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
        Mesh::new(&self.points, self.triangles, MeshColors::Layer).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_scene::NodeState;

    fn ground(void: impl Fn(usize, usize) -> bool) -> Heightfield {
        let (cols, rows) = (9, 7);
        let heights = (0..cols * rows).map(|i| 100.0 + (i % cols) as f32 * 3.0 + (i / cols) as f32).collect();
        let state = |i: usize| if void(i % cols, i / cols) { NodeState::Void } else { NodeState::Measured };
        let states = (0..cols * rows).map(state).collect();
        Heightfield::new(DVec2::new(500.0, 900.0), DVec2::splat(10.0), cols, rows, heights, states).expect("ground")
    }

    #[test]
    fn sides_stand_around_all_data_face_outwards_and_reach_from_the_ground_to_the_base() {
        let hf = ground(|_, _| false);
        let mesh = sides(&hf, 50.0).expect("sides");
        assert_eq!(mesh.triangles().len(), 2 * 2 * (8 + 6));
        let middle = hf.bounds().center();
        for t in 0..mesh.triangles().len() {
            let corners = mesh.corners(t);
            let outward = (corners[0] - middle).truncate();
            let normal = mesh.face_normal(t);
            assert!(normal.z.abs() < 1e-6 && normal.truncate().dot(outward) > 0.0, "{corners:?} {normal}");
            for p in corners {
                let on_ground = hf.surface_at(p.truncate()).is_some_and(|z| (z - p.z).abs() < 1e-3);
                assert!((p.z - 50.0).abs() < 1e-3 || on_ground, "{p}");
            }
        }
    }

    #[test]
    fn sides_follow_the_rim_of_voids() {
        // A corner without data: the cells that touch it have none either.
        let mesh = sides(&ground(|c, r| c < 2 && r < 2), 0.0).expect("sides");
        assert_eq!(mesh.triangles().len(), 2 * 2 * (8 + 6), "a notch is as long as what it cuts off");
        // One node alone has no cell.
        assert!(sides(&ground(|c, r| c > 0 || r > 0), 0.0).is_none());
    }

    #[test]
    fn a_mat_lies_below_the_ground_and_goes_on_beyond_it() {
        let hf = ground(|_, _| false);
        let mesh = mat(&hf).expect("a mat");
        let (all, own) = (mesh.bounds(), hf.bounds());
        assert!(all.min.z < own.min.z && all.min.z > own.min.z - 1.0);
        assert!(all.min.x < own.min.x - 79.0 && all.max.y > own.max.y + 79.0);
    }
}
