//! Space divided into cells: solid cells, and the clearance of the others.

use crate::distance::{Around, squared};
use belvedere_core::{Aabb, DVec2, DVec3};
use belvedere_scene::{BoxShape, Heightfield, LayerKind, Mesh, Scene};
use belvedere_sight::{LayerPart, Solids};

/// Cells there are at most, and along the longest side.
const MOST_CELLS: f64 = 262_144.0;
const LONGEST_SIDE: f64 = 128.0;

/// A box of cubic cells over a part of a scene. A cell is solid if a surface passes through it, or it lies under ground or in a box.
#[derive(Debug, Clone)]
pub(super) struct Voxels {
    low: DVec3,
    cell: f64,
    size: [usize; 3],
    solid: Vec<bool>,
    /// Clearance of the middle of each cell, scene units.
    clearance: Vec<f32>,
}

impl Voxels {
    /// * `region`: what is divided, not empty.
    pub(super) fn new(scene: &Scene, region: &Aabb) -> Self {
        let extent = (region.max - region.min).max(DVec3::splat(1e-9));
        let cell = (extent.x * extent.y * extent.z / MOST_CELLS).cbrt().max(extent.max_element() / LONGEST_SIDE);
        let size = (extent / cell).to_array().map(|n| (n.ceil() as usize).clamp(1, LONGEST_SIDE as usize));
        let count = size[0] * size[1] * size[2];
        let mut voxels = Self { low: region.min, cell, size, solid: vec![false; count], clearance: Vec::new() };
        for (i, layer) in scene.layers.iter().enumerate() {
            let part = Solids::Opaque.of(i, &layer.kind);
            match (&layer.kind, part, layer.kind.triangles()) {
                (_, LayerPart::Nothing, _) => {}
                (LayerKind::Terrain(t), ..) => voxels.add_ground(&t.heightfield),
                (LayerKind::Boxes(b), ..) => b.boxes.iter().for_each(|shape| voxels.add_box(shape)),
                (_, LayerPart::Everything, Some(m)) => voxels.add_mesh(&m.mesh),
                (_, _, Some(m)) => voxels.add_mesh(&m.mesh.only(&|t| part.holds(m, t))),
                _ => {}
            }
        }
        // The solid part of a cell reaches half a cell from its middle, on the average.
        let open: Vec<bool> = voxels.solid.iter().map(|solid| !solid).collect();
        let free = squared(&open, size, [1.0; 3], Around::Nothing).into_iter();
        let free = free.map(|d| ((f64::from(d.sqrt()) - 0.5) * cell).max(0.0) as f32);
        voxels.clearance = free.collect();
        voxels
    }

    /// Edge of a cell, scene units.
    pub(super) fn cell(&self) -> f64 {
        self.cell
    }

    /// Cells along x, y, z.
    pub(super) fn size(&self) -> [usize; 3] {
        self.size
    }

    pub(super) fn len(&self) -> usize {
        self.solid.len()
    }

    pub(super) fn is_solid(&self, index: usize) -> bool {
        self.solid[index]
    }

    pub(super) fn coordinates(&self, index: usize) -> [usize; 3] {
        let [nx, ny, _] = self.size;
        [index % nx, index / nx % ny, index / nx / ny]
    }

    /// The cell that lies `step` cells from another; `None` outside.
    pub(super) fn neighbour(&self, index: usize, step: [isize; 3]) -> Option<usize> {
        let at = self.coordinates(index);
        let mut to = [0; 3];
        for axis in 0..3 {
            to[axis] = at[axis].checked_add_signed(step[axis]).filter(|v| *v < self.size[axis])?;
        }
        Some(self.index(to))
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.size[1] + y) * self.size[0] + x
    }

    pub(super) fn center(&self, index: usize) -> DVec3 {
        self.low + self.cell * (DVec3::from_array(self.coordinates(index).map(|v| v as f64)) + 0.5)
    }

    /// The cell that holds a point; `None` outside.
    pub(super) fn at(&self, p: DVec3) -> Option<usize> {
        let at = ((p - self.low) / self.cell).to_array();
        let inside = (0..3).all(|k| at[k] >= 0.0 && at[k] < self.size[k] as f64);
        inside.then(|| self.index(at.map(|v| v as usize)))
    }

    /// Clearance of the middle of a cell, scene units: no surface comes nearer, but for half a cell.
    pub(super) fn clearance(&self, index: usize) -> f64 {
        f64::from(self.clearance[index])
    }

    /// Whether a straight path keeps a clearance that grows with the length of the path, which is `length` at its beginning; outside
    /// the cells everything is free.
    ///
    /// * `per_length`: clearance needed for a unit of length.
    pub(super) fn is_free(&self, from: DVec3, to: DVec3, length: f64, per_length: f64) -> bool {
        let way = from.distance(to);
        let steps = (2.0 * way / self.cell).ceil().clamp(1.0, 4096.0) as usize;
        (1..=steps).all(|k| {
            let share = k as f64 / steps as f64;
            let Some(cell) = self.at(from.lerp(to, share)) else { return true };
            !self.solid[cell] && self.clearance(cell) >= per_length * (length + share * way)
        })
    }

    /// Whether nothing solid lies between two points, but for the cells next to them.
    pub(super) fn sees(&self, from: DVec3, to: DVec3) -> bool {
        let way = from.distance(to);
        let steps = (1.4 * way / self.cell).ceil().clamp(1.0, 4096.0);
        let margin = (2.0 * self.cell / way).min(0.5);
        let mut share = margin;
        while share < 1.0 - margin {
            if self.at(from.lerp(to, share)).is_some_and(|cell| self.solid[cell]) {
                return false;
            }
            share += 1.0 / steps;
        }
        true
    }

    /// Ranges of cells that meet a box; `None` if none does.
    fn cells_in(&self, bounds: &Aabb) -> Option<[[usize; 2]; 3]> {
        let (low, high) = ((bounds.min - self.low) / self.cell, (bounds.max - self.low) / self.cell);
        let mut out = [[0; 2]; 3];
        for axis in 0..3 {
            let last = (self.size[axis] - 1) as f64;
            if !(low[axis] <= last + 1.0 && high[axis] >= 0.0) {
                return None;
            }
            out[axis] = [low[axis].floor().clamp(0.0, last) as usize, high[axis].floor().clamp(0.0, last) as usize];
        }
        Some(out)
    }

    fn fill(&mut self, [xs, ys, zs]: [[usize; 2]; 3], mut is_solid: impl FnMut(DVec3) -> bool) {
        for z in zs[0]..=zs[1] {
            for y in ys[0]..=ys[1] {
                for x in xs[0]..=xs[1] {
                    let index = self.index([x, y, z]);
                    if !self.solid[index] && is_solid(self.center(index)) {
                        self.solid[index] = true;
                    }
                }
            }
        }
    }

    fn add_box(&mut self, shape: &BoxShape) {
        let Some(cells) = self.cells_in(&Aabb::of(shape.corners())) else { return };
        let (half, (sin, cos)) = (0.5 * shape.size, shape.yaw.sin_cos());
        let middle = shape.base + half.z * DVec3::Z;
        // Reach of a cell along the axes of the box.
        let turned = 0.5 * self.cell * (sin.abs() + cos.abs());
        let reach = DVec3::new(turned, turned, 0.5 * self.cell);
        self.fill(cells, |p| {
            let d = p - middle;
            let local = DVec3::new(cos * d.x + sin * d.y, cos * d.y - sin * d.x, d.z);
            local.abs().cmplt(half + reach).all()
        });
    }

    fn add_mesh(&mut self, mesh: &Mesh) {
        for t in 0..mesh.triangles().len() {
            let corners = mesh.corners(t);
            let Some(cells) = self.cells_in(&Aabb::of(corners)) else { continue };
            let half = 0.5 * self.cell;
            self.fill(cells, |p| meets_cube(corners.map(|c| c - p), half));
        }
    }

    /// Cells under the highest node around their column, and under the surface at its corners.
    fn add_ground(&mut self, ground: &Heightfield) {
        let [nx, ny, nz] = self.size;
        let mut top = vec![f64::NEG_INFINITY; nx * ny];
        let low = self.low.truncate();
        let column = |p: DVec2| {
            let at = (p - low) / self.cell;
            let inside = at.x >= 0.0 && at.y >= 0.0 && at.x < nx as f64 && at.y < ny as f64;
            inside.then(|| at.y as usize * nx + at.x as usize)
        };
        let far = low + self.cell * DVec2::new(nx as f64, ny as f64);
        let corners = [low, far].map(|p| ground.grid_from_scene(p));
        let nodes = |from: f64, to: f64, n: usize| {
            let [from, to] = [from.floor(), to.ceil() + 1.0].map(|v| v.clamp(0.0, n as f64) as usize);
            from..to
        };
        let cols = nodes(corners[0].x, corners[1].x, ground.cols());
        let rows = nodes(corners[1].y, corners[0].y, ground.rows());
        for row in rows {
            for col in cols.clone() {
                if let Some(i) = column(ground.node_xy(col, row))
                    && let Some(node) = ground.node(col, row)
                {
                    top[i] = top[i].max(node.z);
                }
            }
        }
        for (i, top) in top.iter_mut().enumerate() {
            let [x, y] = [i % nx, i / nx].map(|v| v as f64);
            for (u, v) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (0.5, 0.5)] {
                let height = ground.surface_at(low + self.cell * DVec2::new(x + u, y + v));
                *top = top.max(height.unwrap_or(f64::NEG_INFINITY));
            }
            let solid = ((*top - self.low.z) / self.cell).ceil().clamp(0.0, nz as f64) as usize;
            (0..solid).for_each(|z| self.solid[z * nx * ny + i] = true);
        }
    }
}

/// Whether a triangle meets the cube of half an edge `half` around the origin: no axis separates them (Akenine-Moeller 2001).
fn meets_cube([a, b, c]: [DVec3; 3], half: f64) -> bool {
    let edges = [b - a, c - b, a - c];
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let normal = [edges[0].cross(edges[1])];
    let crosses = edges.into_iter().flat_map(|e| axes.map(|axis| axis.cross(e)));
    axes.into_iter().chain(normal).chain(crosses).all(|axis| {
        let along = [a, b, c].map(|p| p.dot(axis));
        let reach = half * axis.abs().element_sum() * (1.0 + 1e-12);
        let (low, high) = along.into_iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        low <= reach && high >= -reach
    })
}

#[cfg(test)]
mod tests;
