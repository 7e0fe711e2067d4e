//! What covers the ground, from data: classes on a lattice.

use belvedere_core::DVec2;

/// What covers a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, PartialOrd, Ord)]
#[repr(u8)]
pub enum Cover {
    /// Nothing is known of it.
    #[default]
    Unknown,
    /// Lakes, rivers, the sea.
    Water,
    /// Glaciers and snow that lies all year.
    Ice,
    /// Rock, scree, sand.
    Bare,
    /// Trees.
    Forest,
    /// Shrubs and heath.
    Shrubs,
    /// Meadows and pastures.
    Grass,
    /// Fields, orchards, vineyards.
    Fields,
    /// Houses and roads.
    BuiltUp,
    /// Bogs, marshes, mangroves.
    Wetland,
}

impl Cover {
    /// All of them, with their names.
    pub const ALL: [(&'static str, Self); 10] = [
        ("unknown", Self::Unknown),
        ("water", Self::Water),
        ("ice", Self::Ice),
        ("bare", Self::Bare),
        ("forest", Self::Forest),
        ("shrubs", Self::Shrubs),
        ("grass", Self::Grass),
        ("fields", Self::Fields),
        ("built up", Self::BuiltUp),
        ("wetland", Self::Wetland),
    ];
}

/// Classes of cells over a ground.
#[derive(Debug, Clone, PartialEq)]
pub struct CoverMap {
    /// Centre of the first cell: scene units east and south of the corner of the ground, half a node beyond its north-western node.
    pub from: [f32; 2],
    /// Distance of centres to the east and to the south, scene units, > 0.
    pub spacing: [f32; 2],
    /// Cells from west to east.
    pub cols: usize,
    /// Classes, row by row from the north.
    pub cells: Vec<Cover>,
    /// What the classes of the file are called, such as "ESA WorldCover".
    pub legend: &'static str,
}

/// All numbers are finite, so that a cover equals itself.
impl Eq for CoverMap {}

impl CoverMap {
    /// The class at a place, scene units east and south of the corner of the ground, half a node beyond its north-western node; unknown beyond the cells.
    #[inline]
    pub fn at(&self, [east, south]: [f32; 2]) -> Cover {
        let x = (east - self.from[0]) / self.spacing[0] + 0.5;
        let y = (south - self.from[1]) / self.spacing[1] + 0.5;
        if !(x >= 0.0 && y >= 0.0) || x >= self.cols as f32 {
            return Cover::Unknown;
        }
        self.cells.get(y as usize * self.cols + x as usize).copied().unwrap_or_default()
    }

    /// Takes what another cover of the same ground knows, where this one knows nothing.
    pub fn add(&mut self, other: &Self) {
        let (from, spacing, cols) = (self.from, self.spacing, self.cols);
        for (i, cell) in self.cells.iter_mut().enumerate().filter(|(_, cell)| **cell == Cover::Unknown) {
            let at = [(i % cols) as f32, (i / cols) as f32];
            *cell = other.at([0, 1].map(|axis| from[axis] + at[axis] * spacing[axis]));
        }
    }

    /// Shares of the classes among the cells, the largest first, without those that do not occur.
    pub fn shares(&self) -> Vec<(Cover, f64)> {
        let mut counts = [0usize; Cover::ALL.len()];
        self.cells.iter().for_each(|cover| counts[*cover as usize] += 1);
        let of = |(_, cover): &(&str, Cover)| (*cover, counts[*cover as usize] as f64 / self.cells.len().max(1) as f64);
        let mut shares: Vec<(Cover, f64)> = Cover::ALL.iter().map(of).filter(|(_, share)| *share > 0.0).collect();
        shares.sort_by(|a, b| b.1.total_cmp(&a.1));
        shares
    }

    /// Share of a class among the cells, 0..=1.
    pub fn share(&self, cover: Cover) -> f64 {
        self.shares().iter().find(|(found, _)| *found == cover).map_or(0.0, |(_, share)| *share)
    }

    /// Fills cells of a polygon whose centres lie inside an odd number of its rings.
    ///
    /// * `rings`: scene units east and south of the corner of the ground, half a node beyond its north-western node.
    pub fn fill(&mut self, rings: &[Vec<DVec2>], cover: Cover) {
        let ([x0, y0], [dx, dy]) = (self.from.map(f64::from), self.spacing.map(f64::from));
        let rows = self.cells.len() / self.cols.max(1);
        let corners = || rings.iter().flatten().map(|p| (p.y - y0) / dy);
        let [top, bottom] = corners().fold([f64::INFINITY, 0.0], |[a, b], y: f64| [a.min(y), b.max(y)]);
        let mut crossings = Vec::new();
        for row in top.max(0.0).ceil() as usize..(bottom.floor() as usize + 1).min(rows) {
            let y = y0 + row as f64 * dy;
            crossings.clear();
            for ring in rings {
                for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                    if (a.y <= y) != (b.y <= y) {
                        crossings.push((a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x) - x0) / dx);
                    }
                }
            }
            crossings.sort_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                let [from, to] = [pair[0].ceil().max(0.0) as usize, (pair[1].ceil().max(0.0) as usize).min(self.cols)];
                if from < to {
                    self.cells[row * self.cols + from..row * self.cols + to].fill(cover);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn empty() -> CoverMap {
        CoverMap { from: [5.0, 5.0], spacing: [10.0; 2], cols: 8, cells: vec![Cover::Unknown; 48], legend: "test" }
    }

    #[test]
    fn a_polygon_with_a_hole_covers_the_cells_whose_centres_it_holds() {
        let square = |a: f64, b: f64| [(a, a), (b, a), (b, b), (a, b)].map(DVec2::from).to_vec();
        let mut land = empty();
        land.fill(&[square(-20.0, 41.0), square(12.0, 28.0)], Cover::Forest);
        for row in 0..6 {
            for col in 0..8 {
                let inside = row < 4 && col < 4 && !((1..3).contains(&row) && (1..3).contains(&col));
                let wanted = if inside { Cover::Forest } else { Cover::Unknown };
                assert_eq!(land.at([col as f32 * 10.0 + 5.0, row as f32 * 10.0 + 5.0]), wanted, "{col} {row}");
            }
        }
        assert_eq!(land.shares(), [(Cover::Unknown, 36.0 / 48.0), (Cover::Forest, 12.0 / 48.0)]);
        land.fill(&[vec![]], Cover::Ice);
        land.fill(&[square(900.0, 990.0)], Cover::Ice);
        assert_eq!(land.shares().len(), 2, "nothing outside is filled");
    }

    #[test]
    fn beyond_the_cells_nothing_is_known() {
        let mut land = empty();
        land.cells.fill(Cover::Grass);
        for at in [[-0.1, 5.0], [5.0, -0.1], [80.1, 5.0], [5.0, 60.1], [f32::NAN, 5.0]] {
            assert_eq!(land.at(at), Cover::Unknown, "{at:?}");
        }
        assert_eq!(land.at([79.9, 59.9]), Cover::Grass);
    }
}
