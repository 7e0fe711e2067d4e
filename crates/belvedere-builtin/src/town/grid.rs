//! The bent grid of streets, and the cells between them.

use crate::noise::{Noise, Random};
use belvedere_core::DVec2;
use belvedere_scene::{Polygon, Way, WayClass};

/// Width of the band between the streets along the river, metres.
const RIVER_BAND_M: f64 = 62.0;
/// Largest displacement of a crossing by the noise, metres, about.
const BEND_M: f64 = 38.0;

/// Kind of a cell between four streets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cell {
    Country,
    River,
    Square,
    Park,
    Core,
    Outskirts,
}

/// Crossings `cols + 1` by `rows + 1`, and the cells between them.
#[derive(Debug)]
pub(super) struct Grid {
    xs: Vec<f64>,
    ys: Vec<f64>,
    bend: [Noise; 2],
    edge: Noise,
    radius_m: f64,
    middle: [usize; 2],
    river: usize,
}

impl Grid {
    pub(super) fn new(seed: u64, size_m: f64, random: &mut Random) -> Self {
        // The odd count puts a cell, the market square, in the middle.
        let count = 2 * ((size_m / 2.0 - 40.0) / 86.0) as usize + 1;
        let middle = count / 2;
        let river = middle + 2;
        let xs = lines(count, random, |_| None);
        let ys = lines(count, random, |k| (k == river).then_some(RIVER_BAND_M));
        let bend = [Noise::new(seed ^ 1), Noise::new(seed ^ 2)];
        Self { xs, ys, bend, edge: Noise::new(seed ^ 3), radius_m: 0.5 * size_m, middle: [middle; 2], river }
    }

    pub(super) fn cols(&self) -> usize {
        self.xs.len() - 1
    }

    pub(super) fn rows(&self) -> usize {
        self.ys.len() - 1
    }

    /// Row of the river.
    pub(super) fn river(&self) -> usize {
        self.river
    }

    pub(super) fn node(&self, col: usize, row: usize) -> DVec2 {
        let p = DVec2::new(self.xs[col], self.ys[row]);
        p + BEND_M * DVec2::new(self.bend[0].at(p / 430.0), self.bend[1].at(p / 430.0))
    }

    pub(super) fn cell(&self, col: usize, row: usize) -> Cell {
        if row == self.river {
            return Cell::River;
        }
        if [col, row] == self.middle {
            return Cell::Square;
        }
        if row + 1 == self.river && [self.middle[0] + 1, self.middle[0] + 2].contains(&col) {
            return Cell::Park;
        }
        let centre = 0.5 * (self.node(col, row) + self.node(col + 1, row + 1));
        let from_middle = centre.length() / self.radius_m - 0.2 * self.edge.at(centre / 310.0);
        match from_middle {
            d if d < 0.42 => Cell::Core,
            d if d < 0.93 => Cell::Outskirts,
            _ => Cell::Country,
        }
    }

    fn settled(&self, col: usize, row: usize) -> bool {
        !matches!(self.cell(col, row), Cell::Country | Cell::River)
    }

    /// Class of the street along a line of the grid, by its distance from the main street.
    fn class(&self, line: usize, along: usize) -> WayClass {
        match line.abs_diff(self.middle[along]) {
            0 => WayClass::Primary,
            d if d % 6 == 3 => WayClass::Secondary,
            d if d % 3 == 0 => WayClass::Tertiary,
            _ => WayClass::Residential,
        }
    }

    /// Whether a street leads north from a crossing; at the river, whether a bridge does.
    pub(super) fn goes_north(&self, col: usize, row: usize) -> bool {
        let class = self.class(col, 0);
        if row == self.river {
            let north = (row + 1).min(self.rows() - 1);
            return class != WayClass::Residential && self.reaches(col, row - 1) && self.reaches(col, north);
        }
        class == WayClass::Primary || self.reaches(col, row)
    }

    fn reaches(&self, col: usize, row: usize) -> bool {
        self.class(col, 0) == WayClass::Primary
            || (col > 0 && self.settled(col - 1, row))
            || (col < self.cols() && self.settled(col, row))
    }

    fn goes_east(&self, col: usize, row: usize) -> bool {
        self.class(row, 1) == WayClass::Primary
            || (row > 0 && self.settled(col, row - 1))
            || (row < self.rows() && self.settled(col, row))
    }

    /// Width of the street along a line of the grid, kerb to kerb with its footways, metres.
    pub(super) fn width(&self, line: usize, along: usize) -> f64 {
        match self.class(line, along) {
            WayClass::Primary => 18.0,
            WayClass::Secondary => 15.0,
            WayClass::Tertiary => 13.0,
            _ => 10.0,
        }
    }

    /// Outline of the cell inside its streets, counter-clockwise.
    pub(super) fn lot(&self, col: usize, row: usize) -> Vec<DVec2> {
        let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| self.node(col + i, row + j));
        let insets = [self.width(row, 1), self.width(col + 1, 0), self.width(row + 1, 1), self.width(col, 0)];
        inset(&corners, &insets.map(|w| 0.5 * w))
    }

    /// Centre lines of the streets, one for each stretch without a gap.
    pub(super) fn ways(&self) -> Vec<Way> {
        let mut ways = Vec::new();
        for col in 0..=self.cols() {
            let steps = (0..self.rows()).map(|row| self.goes_north(col, row));
            stretches(steps, |from, to| {
                let points = (from..=to).map(|row| self.node(col, row)).collect();
                let name = street_name(col.abs_diff(self.middle[0]) * 2 + usize::from(col < self.middle[0]), "Street");
                ways.push(Way { name, class: self.class(col, 0), points });
            });
        }
        for row in 0..=self.rows() {
            let steps = (0..self.cols()).map(|col| self.goes_east(col, row));
            stretches(steps, |from, to| {
                let points = (from..=to).map(|col| self.node(col, row)).collect();
                let name = street_name(row.abs_diff(self.middle[1]) * 2 + usize::from(row < self.middle[1]), "Road");
                ways.push(Way { name, class: self.class(row, 1), points });
            });
        }
        ways
    }

    /// Surfaces of the streets on the ground.
    pub(super) fn street_polygons(&self) -> Vec<Polygon> {
        let mut polygons = Vec::new();
        for row in 0..=self.rows() {
            for col in 0..=self.cols() {
                let here = self.node(col, row);
                if row < self.rows() && row != self.river && self.goes_north(col, row) {
                    polygons.push(strip(here, self.node(col, row + 1), self.width(col, 0)));
                }
                if col < self.cols() && self.goes_east(col, row) {
                    polygons.push(strip(here, self.node(col + 1, row), self.width(row, 1)));
                }
            }
        }
        polygons
    }
}

/// Lines of the grid along one axis, the middle cell around 0.
fn lines(count: usize, random: &mut Random, fixed: impl Fn(usize) -> Option<f64>) -> Vec<f64> {
    let mut at = vec![0.0];
    for k in 0..count {
        let step = random.range(76.0, 98.0);
        at.push(at[k] + fixed(k).unwrap_or(step));
    }
    let shift = 0.5 * (at[count / 2] + at[count / 2 + 1]);
    at.iter().map(|v| v - shift).collect()
}

/// Runs of `true`, as first and last crossing.
fn stretches(steps: impl Iterator<Item = bool>, mut found: impl FnMut(usize, usize)) {
    let mut from = None;
    for (k, there) in steps.chain([false]).enumerate() {
        match (there, from) {
            (true, None) => from = Some(k),
            (false, Some(start)) => {
                found(start, k);
                from = None;
            }
            _ => {}
        }
    }
}

fn street_name(k: usize, kind: &str) -> String {
    const NAMES: [&str; 24] = [
        "Market", "Mill", "Church", "Bridge", "Castle", "Orchard", "Station", "School", "Well", "Garden", "Tanner",
        "Linden", "Meadow", "Quarry", "Hill", "Rose", "Baker", "Smith", "Forest", "Spring", "Lark", "Elm", "Stone",
        "Willow",
    ];
    match k / NAMES.len() {
        0 => format!("{} {kind}", NAMES[k]),
        more => format!("{} {kind} {}", NAMES[k % NAMES.len()], more + 1),
    }
}

fn strip(a: DVec2, b: DVec2, width: f64) -> Polygon {
    let side = (b - a).normalize_or_zero().perp() * (0.5 * width);
    Polygon { outer: vec![a - side, b - side, b + side, a + side], holes: Vec::new() }
}

/// The convex counter-clockwise quadrangle with side k moved inward by `by[k]`.
fn inset(corners: &[DVec2; 4], by: &[f64; 4]) -> Vec<DVec2> {
    let side = |k: usize| {
        let (a, b) = (corners[k % 4], corners[(k + 1) % 4]);
        let along = (b - a).normalize_or_zero();
        (a + along.perp() * by[k % 4], along)
    };
    (0..4)
        .map(|k| {
            let ((p, d), (q, e)) = (side(k + 3), side(k));
            p + d * ((q - p).perp_dot(e) / d.perp_dot(e))
        })
        .collect()
}
