//! Index of cells by squares of the plane: the cell that holds a point, and the cells with an edge near a box.

use super::shapes::Land;
use belvedere_core::DVec2;
use geo::{Contains, Point};

/// A box, least and largest corner.
pub(super) type Box2 = [DVec2; 2];

/// Edges of cells by squares of the plane.
#[derive(Debug)]
pub(super) struct CellIndex<'a> {
    cells: &'a [Land],
    low: DVec2,
    size: f64,
    columns: usize,
    rows: usize,
    /// Edges of every square, (edge, cell).
    squares: Vec<Vec<(u32, u32)>>,
    edges: Vec<[DVec2; 2]>,
    /// Cell of the centre of every square.
    centres: Vec<Option<u32>>,
}

/// Box of points.
pub(super) fn bounds(points: impl Iterator<Item = DVec2>) -> Option<Box2> {
    points.fold(None, |found: Option<Box2>, p| Some(found.map_or([p, p], |[low, high]| [low.min(p), high.max(p)])))
}

/// Box of a piece of land.
pub(super) fn bounds_of(land: &Land) -> Option<Box2> {
    bounds(land.iter().flat_map(|p| p.exterior().coords()).map(|c| DVec2::new(c.x, c.y)))
}

fn edges_of(land: &Land) -> impl Iterator<Item = [DVec2; 2]> {
    let rings = land.iter().flat_map(|p| std::iter::once(p.exterior()).chain(p.interiors()));
    rings.flat_map(|ring| ring.lines()).map(|l| [DVec2::new(l.start.x, l.start.y), DVec2::new(l.end.x, l.end.y)])
}

impl<'a> CellIndex<'a> {
    /// Side of the squares, metres; they are larger where there would be too many.
    const SIDE_M: f64 = 24.0;
    const MOST_SQUARES: f64 = 1e6;

    /// `cells` do not overlap.
    pub(super) fn new(cells: &'a [Land]) -> Self {
        let [low, high] = cells
            .iter()
            .filter_map(bounds_of)
            .fold([DVec2::MAX, DVec2::MIN], |[low, high], [a, b]| [low.min(a), high.max(b)]);
        let span = (high - low).max(DVec2::ONE);
        let size = Self::SIDE_M.max((span.x * span.y / Self::MOST_SQUARES).sqrt());
        let [columns, rows] = [span.x, span.y].map(|s| (s / size) as usize + 1);
        let mut index = Self {
            cells,
            low,
            size,
            columns,
            rows,
            squares: vec![Vec::new(); columns * rows],
            edges: Vec::new(),
            centres: Vec::new(),
        };
        for (cell, land) in cells.iter().enumerate() {
            for edge in edges_of(land) {
                index.add(edge, cell as u32);
            }
        }
        index.centres = index.label_centres();
        index
    }

    fn add(&mut self, edge: [DVec2; 2], cell: u32) {
        let number = self.edges.len() as u32;
        self.edges.push(edge);
        // Long edges are walked piece by piece, so that slanted ones do not fill their whole box.
        let pieces = (edge[0].distance(edge[1]) / self.size).ceil().max(1.0) as usize;
        for piece in 0..pieces {
            let ends = [piece, piece + 1].map(|i| edge[0].lerp(edge[1], i as f64 / pieces as f64));
            for square in self.squares_of([ends[0].min(ends[1]), ends[0].max(ends[1])]) {
                if self.squares[square].last() != Some(&(number, cell)) {
                    self.squares[square].push((number, cell));
                }
            }
        }
    }

    fn square_of(&self, p: DVec2) -> [usize; 2] {
        let at = (p - self.low) / self.size;
        [(at.x.max(0.0) as usize).min(self.columns - 1), (at.y.max(0.0) as usize).min(self.rows - 1)]
    }

    fn squares_of(&self, [low, high]: Box2) -> impl Iterator<Item = usize> + use<> {
        let (a, b, columns) = (self.square_of(low), self.square_of(high), self.columns);
        (a[1]..=b[1]).flat_map(move |row| (a[0]..=b[0]).map(move |column| row * columns + column))
    }

    /// Crossings of the rows' centre lines, walked from west to east.
    fn label_centres(&self) -> Vec<Option<u32>> {
        let mut crossings = vec![Vec::new(); self.rows];
        let mut number = 0;
        for (cell, land) in self.cells.iter().enumerate() {
            for [a, b] in edges_of(land) {
                let rows = [a.y.min(b.y), a.y.max(b.y)].map(|y| self.square_of(DVec2::new(a.x, y))[1]);
                for (row, list) in crossings.iter_mut().enumerate().take(rows[1] + 1).skip(rows[0]) {
                    let y = self.low.y + (row as f64 + 0.5) * self.size;
                    if (a.y <= y) != (b.y <= y) {
                        list.push((a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x), cell as u32));
                    }
                }
                number += 1;
            }
        }
        debug_assert_eq!(number, self.edges.len());
        let mut labels = vec![None; self.columns * self.rows];
        for (row, list) in crossings.iter_mut().enumerate() {
            list.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut inside: Vec<u32> = Vec::new();
            let mut next = list.iter().peekable();
            for column in 0..self.columns {
                let x = self.low.x + (column as f64 + 0.5) * self.size;
                while let Some((_, cell)) = next.next_if(|(at, _)| *at <= x) {
                    match inside.iter().position(|c| c == cell) {
                        Some(at) => drop(inside.swap_remove(at)),
                        None => inside.push(*cell),
                    }
                }
                labels[row * self.columns + column] = inside.first().copied();
            }
        }
        labels
    }

    /// The cell that holds `p`.
    pub(super) fn cell_at(&self, p: DVec2) -> Option<usize> {
        let [column, row] = self.square_of(p);
        let square = row * self.columns + column;
        if self.squares[square].is_empty() {
            return self.centres[square].map(|c| c as usize);
        }
        let mut near: Vec<u32> =
            self.squares[square].iter().map(|(_, cell)| *cell).chain(self.centres[square]).collect();
        near.sort_unstable();
        near.dedup();
        near.into_iter().map(|c| c as usize).find(|c| self.cells[*c].contains(&Point::new(p.x, p.y)))
    }

    /// Cells with an edge whose box meets this one.
    pub(super) fn cells_near(&self, area: Box2) -> Vec<usize> {
        let meets =
            |edge: &[DVec2; 2]| edge[0].min(edge[1]).cmple(area[1]).all() && edge[0].max(edge[1]).cmpge(area[0]).all();
        let mut found: Vec<usize> = self
            .squares_of(area)
            .flat_map(|square| &self.squares[square])
            .filter(|(edge, _)| meets(&self.edges[*edge as usize]))
            .map(|(_, cell)| *cell as usize)
            .collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// The cell nearest to `p` within `reach`, other than `own`.
    pub(super) fn nearest(&self, p: DVec2, reach: f64, own: Option<usize>) -> Option<usize> {
        let squares = self.squares_of([p - reach, p + reach]);
        let edges = squares.flat_map(|square| &self.squares[square]).filter(|(_, c)| Some(*c as usize) != own);
        edges
            .map(|(edge, cell)| (distance_to(p, self.edges[*edge as usize]), *cell as usize))
            .filter(|(distance, _)| *distance <= reach)
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
            .map(|(_, cell)| cell)
    }
}

fn distance_to(p: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let along = b - a;
    let t = ((p - a).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
    p.distance(a + t * along)
}

#[cfg(test)]
mod tests {
    use super::*;
    use geo::{MultiPolygon, Rect};

    fn block(x: f64, y: f64, width: f64, height: f64) -> Land {
        MultiPolygon(vec![Rect::new((x, y), (x + width, y + height)).to_polygon()])
    }

    #[test]
    fn points_are_found_in_the_cell_that_holds_them() {
        let cells = [block(0.0, 0.0, 200.0, 90.0), block(0.0, 100.0, 95.0, 300.0), block(105.0, 100.0, 5.0, 5.0)];
        let index = CellIndex::new(&cells);
        for (x, y, expected) in [
            (1.0, 1.0, Some(0)),
            (199.0, 89.0, Some(0)),
            (100.0, 95.0, None),
            (50.0, 250.0, Some(1)),
            (107.0, 103.0, Some(2)),
            (150.0, 300.0, None),
        ] {
            assert_eq!(index.cell_at(DVec2::new(x, y)), expected, "at {x}, {y}");
        }
        assert_eq!(index.cells_near([DVec2::new(20.0, 85.0), DVec2::new(30.0, 105.0)]), [0, 1]);
        assert_eq!(index.cells_near([DVec2::new(20.0, 20.0), DVec2::new(30.0, 30.0)]), [0usize; 0]);
        assert_eq!(
            index.nearest(DVec2::new(107.0, 104.0), 30.0, Some(2)),
            Some(1),
            "12 m to the second, 14 m to the first"
        );
        assert_eq!(index.nearest(DVec2::new(107.0, 300.0), 5.0, None), None);
    }
}
