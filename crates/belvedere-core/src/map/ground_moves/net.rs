//! A displacement in three components on a net of cubic B-splines.

use crate::Aabb;
use glam::{DVec2, DVec3};

/// Coefficients of one axis that a place depends on.
pub(super) const ORDER: usize = 4;

/// Cells above which a bound is taken over the whole net: few edges are so long.
const MANY_CELLS: usize = 256;

/// Where the coefficients of a [`MoveNet`] stand: coefficient (column, row) is that of the B-spline which is largest at
/// `first + step (column, row)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NetPlace {
    /// Scene x, y of coefficient (0, 0), the south-west one.
    pub first: DVec2,
    /// Scene units between coefficients, > 0.
    pub step: f64,
    /// Coefficients along x and along y, at least 7 each.
    pub size: [usize; 2],
}

/// The coefficients that a place depends on, and their weights along x and y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NetWeights {
    /// Column and row of the first coefficient.
    pub first: [usize; 2],
    /// Weights along x.
    pub x: [f64; ORDER],
    /// Weights along y.
    pub y: [f64; ORDER],
}

impl NetPlace {
    /// Cells along x and y: each depends on 4 x 4 coefficients.
    pub(super) fn cells(&self) -> [usize; 2] {
        self.size.map(|n| n - 3)
    }

    /// Coordinates in cells, from the south-west corner of the first one.
    fn in_cells(&self, p: DVec2) -> DVec2 {
        (p - self.first) / self.step - DVec2::ONE
    }

    /// The cell at a place and the place in it, 0..=1; `None` beside the net.
    fn cell_at(&self, p: DVec2) -> Option<([usize; 2], DVec2)> {
        let at = self.in_cells(p);
        let cells = self.cells();
        let last = DVec2::new(cells[0] as f64, cells[1] as f64);
        if !(at.cmpge(DVec2::ZERO).all() && at.cmple(last).all()) {
            return None;
        }
        let cell = [(at.x as usize).min(cells[0] - 1), (at.y as usize).min(cells[1] - 1)];
        Some((cell, at - DVec2::new(cell[0] as f64, cell[1] as f64)))
    }

    /// Which coefficients the displacement at a place is made of; `None` beside the net, where it is zero.
    pub fn weights(&self, p: DVec2) -> Option<NetWeights> {
        let (first, t) = self.cell_at(p)?;
        Some(NetWeights { first, x: cubic(t.x), y: cubic(t.y) })
    }

    /// Index of a coefficient.
    pub fn index(&self, column: usize, row: usize) -> usize {
        row * self.size[0] + column
    }
}

/// Values of the four cubic B-splines over a cell.
fn cubic(t: f64) -> [f64; ORDER] {
    let s = 1.0 - t;
    [s * s * s, 4.0 - 6.0 * t * t + 3.0 * t * t * t, 4.0 - 6.0 * s * s + 3.0 * s * s * s, t * t * t].map(|b| b / 6.0)
}

/// Their derivatives.
fn slopes(t: f64) -> [f64; ORDER] {
    let s = 1.0 - t;
    [-0.5 * s * s, 1.5 * t * t - 2.0 * t, 2.0 * s - 1.5 * s * s, 0.5 * t * t]
}

/// Displacement and its derivatives along x and y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moved {
    /// Displacement, scene units.
    pub by: DVec3,
    /// Change of the displacement along x.
    pub along_x: DVec3,
    /// Change of the displacement along y.
    pub along_y: DVec3,
}

impl Moved {
    pub(super) const NOTHING: Self = Self { by: DVec3::ZERO, along_x: DVec3::ZERO, along_y: DVec3::ZERO };
}

/// Displacements over the plan, three components, as tensor products of uniform cubic B-splines: twice continuously differentiable,
/// zero at its rim and beside it.
#[derive(Debug, Clone, PartialEq)]
pub struct MoveNet {
    place: NetPlace,
    coefficients: Vec<DVec3>,
    /// Largest second derivative along x, along x and y, and along y over each cell, all components.
    bends: Vec<[f32; 3]>,
    largest_bend: [f32; 3],
    range: Aabb,
}

impl MoveNet {
    /// * `coefficients`: row by row from the south, finite; the three at each side must be zero.
    ///
    /// `None` where they are not.
    pub fn new(place: NetPlace, coefficients: Vec<DVec3>) -> Option<Self> {
        let [cols, rows] = place.size;
        let fits = cols >= 7 && rows >= 7 && cols.checked_mul(rows) == Some(coefficients.len());
        let is_placed = place.first.is_finite() && place.step > 0.0 && place.step.is_finite();
        if !(fits && is_placed && coefficients.iter().all(|c| c.is_finite())) {
            return None;
        }
        let is_rim = |i: usize| {
            let (column, row) = (i % cols, i / cols);
            column.min(row).min(cols - 1 - column).min(rows - 1 - row) < 3
        };
        if coefficients.iter().enumerate().any(|(i, c)| *c != DVec3::ZERO && is_rim(i)) {
            return None;
        }
        let range = Aabb::of(coefficients.iter().copied());
        let mut net = Self { place, coefficients, bends: Vec::new(), largest_bend: [0.0; 3], range };
        let [across, up] = place.cells();
        net.bends = (0..across * up).map(|i| net.bend_of([i % across, i / across])).collect();
        net.largest_bend = net.bends.iter().fold([0.0; 3], |most, b| [0, 1, 2].map(|k| b[k].max(most[k])));
        Some(net)
    }

    /// Where its coefficients stand.
    pub fn place(&self) -> &NetPlace {
        &self.place
    }

    /// Its coefficients, row by row from the south, scene units.
    pub fn coefficients(&self) -> &[DVec3] {
        &self.coefficients
    }

    /// Largest displacement in plan and in height at the places of the coefficients, scene units.
    pub fn largest(&self) -> [f64; 2] {
        let places = (0..self.coefficients.len()).map(|i| [i % self.place.size[0], i / self.place.size[0]]);
        let by = places.map(|[x, y]| self.at(self.place.first + self.place.step * DVec2::new(x as f64, y as f64)));
        by.fold([0.0, 0.0], |[plan, height], d| [plan.max(d.truncate().length()), d.z.abs().max(height)])
    }

    /// The same net, all displacements times `share`.
    pub fn scaled(&self, share: f64) -> Option<Self> {
        Self::new(self.place, self.coefficients.iter().map(|c| share * *c).collect())
    }

    /// The coefficients of a cell, row by row from the south.
    pub(super) fn patch(&self, [column, row]: [usize; 2]) -> [DVec3; ORDER * ORDER] {
        std::array::from_fn(|k| self.coefficients[self.place.index(column + k % ORDER, row + k / ORDER)])
    }

    /// Displacement at a place in plan, scene units.
    pub fn at(&self, p: DVec2) -> DVec3 {
        let Some(w) = self.place.weights(p) else { return DVec3::ZERO };
        let start = self.place.index(w.first[0], w.first[1]);
        let lines = self.coefficients[start..].chunks(self.place.size[0]).zip(w.y);
        lines.map(|(line, y)| y * line.iter().zip(w.x).map(|(c, x)| x * *c).sum::<DVec3>()).sum()
    }

    /// Displacement and derivatives at a place in plan.
    pub fn moved(&self, p: DVec2) -> Moved {
        let Some((cell, t)) = self.place.cell_at(p) else { return Moved::NOTHING };
        let (x, y) = (cubic(t.x), cubic(t.y));
        let [dx, dy] = [slopes(t.x), slopes(t.y)].map(|d| d.map(|v| v / self.place.step));
        let mut out = Moved::NOTHING;
        for (k, c) in self.patch(cell).into_iter().enumerate() {
            let (i, j) = (k % ORDER, k / ORDER);
            out.by += x[i] * y[j] * c;
            out.along_x += dx[i] * y[j] * c;
            out.along_y += x[i] * dy[j] * c;
        }
        out
    }

    /// The cells under a rectangle in plan; `None` if it lies beside the net.
    fn cells_under(&self, min: DVec2, max: DVec2) -> Option<[std::ops::Range<usize>; 2]> {
        let (low, high) = (self.place.in_cells(min), self.place.in_cells(max));
        let cells = self.place.cells();
        let range = |k: usize| {
            let n = cells[k] as f64;
            (high[k] >= 0.0 && low[k] <= n)
                .then(|| (low[k].max(0.0) as usize).min(cells[k] - 1)..(high[k].min(n) as usize).min(cells[k] - 1) + 1)
        };
        Some([range(0)?, range(1)?])
    }

    /// A box that holds the displacement of every point over a rectangle in plan.
    pub(super) fn range_over(&self, min: DVec2, max: DVec2) -> Aabb {
        let nothing = Aabb::of([DVec3::ZERO]);
        let Some([columns, rows]) = self.cells_under(min, max) else { return nothing };
        if columns.len() * rows.len() > MANY_CELLS {
            return self.range.union(nothing);
        }
        let (columns, rows) = (columns.start..columns.end + ORDER - 1, rows.start..rows.end + ORDER - 1);
        let of_row = |row: usize| columns.clone().map(move |column| self.coefficients[self.place.index(column, row)]);
        Aabb::of(rows.flat_map(of_row).chain([DVec3::ZERO]))
    }

    /// Bound on the second derivative of the displacement along a step in plan, times the squared step, over the rectangle that the step
    /// spans: a chord is off by no more than an eighth of it.
    pub(super) fn bend_along(&self, from: DVec2, to: DVec2) -> f64 {
        let Some([columns, rows]) = self.cells_under(from.min(to), from.max(to)) else { return 0.0 };
        let mut most = [0.0f32; 3];
        if columns.len() * rows.len() > MANY_CELLS {
            most = self.largest_bend;
        } else {
            for row in rows {
                for bend in &self.bends[row * self.place.cells()[0]..][columns.clone()] {
                    most = [0, 1, 2].map(|k| most[k].max(bend[k]));
                }
            }
        }
        let step = (to - from).abs();
        let [xx, xy, yy] = most.map(f64::from);
        step.x * step.x * xx + 2.0 * step.x * step.y * xy + step.y * step.y * yy
    }

    /// Second derivatives of a cubic B-spline lie among the differences of its coefficients.
    fn bend_of(&self, cell: [usize; 2]) -> [f32; 3] {
        let c = self.patch(cell);
        if c.iter().all(|c| *c == DVec3::ZERO) {
            return [0.0; 3];
        }
        let at = |i: usize, j: usize| c[j * ORDER + i];
        let mut most = [0.0f64; 3];
        for a in 0..ORDER {
            for b in 0..ORDER - 2 {
                most[0] = most[0].max((at(b, a) - 2.0 * at(b + 1, a) + at(b + 2, a)).length());
                most[2] = most[2].max((at(a, b) - 2.0 * at(a, b + 1) + at(a, b + 2)).length());
            }
        }
        for i in 0..ORDER - 1 {
            for j in 0..ORDER - 1 {
                most[1] = most[1].max((at(i + 1, j + 1) - at(i, j + 1) - at(i + 1, j) + at(i, j)).length());
            }
        }
        // Rounded up.
        most.map(|v| (v / (self.place.step * self.place.step) * (1.0 + 1e-6)) as f32)
    }
}
