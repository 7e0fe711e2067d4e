//! Heights of each cell in bins, with sums from each bin upwards.

use super::super::Field;
use super::NO_CELL;
use rayon::prelude::*;

/// Heights per drawer, on average.
const DRAWER: usize = 16;

/// For each cell its heights over the datum, in drawers (bins) of equal range from the lowest to the highest, and the sum of all
/// heights in and above each drawer. Heights within a drawer are not sorted: sorting would cost more than all searches.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tables {
    /// First entry of each cell, and the end.
    start: Vec<u32>,
    heights: Vec<f64>,
    cells: Vec<Drawers>,
}

#[derive(Debug, Clone, PartialEq)]
struct Drawers {
    low: f64,
    high: f64,
    per_height: f64,
    /// First entry (from the first of the cell) of each drawer and the end, and the sum of all heights from there on.
    from: Vec<(u32, f64)>,
}

impl Tables {
    pub(super) fn new(field: &Field, labels: &[u32], cells: usize) -> Self {
        let start = starts(labels, cells);
        let mut heights = grouped(field, labels, &start);
        let mut rest = &mut heights[..];
        let mut parts = Vec::with_capacity(cells);
        for cell in start.windows(2) {
            let (part, behind) = rest.split_at_mut((cell[1] - cell[0]) as usize);
            parts.push(part);
            rest = behind;
        }
        let cells = parts.into_par_iter().map_init(Vec::new, |spare, part| Drawers::sort_into(part, spare)).collect();
        Self { start, heights, cells }
    }

    pub(super) fn size(&self, cell: usize) -> usize {
        (self.start[cell + 1] - self.start[cell]) as usize
    }

    pub(super) fn mean(&self, cell: usize) -> f64 {
        self.cells[cell].from[0].1 / self.size(cell) as f64
    }

    pub(super) fn higher(&self, cell: usize, h: f64) -> (f64, f64) {
        let drawers = &self.cells[cell];
        if h >= drawers.high || h.is_nan() {
            return (0.0, drawers.high);
        }
        let size = self.size(cell);
        let drawer = drawers.of(h);
        let ((first, _), (end, mut sum)) = (drawers.from[drawer], drawers.from[drawer + 1]);
        let mut count = size - end as usize;
        let base = self.start[cell] as usize;
        for &x in self.heights[base + first as usize..base + end as usize].iter().filter(|&&x| x > h) {
            count += 1;
            sum += x;
        }
        (count as f64 / size as f64, sum / count as f64)
    }
}

impl Drawers {
    /// Drawer of a height; nothing in a higher drawer is lower.
    fn of(&self, h: f64) -> usize {
        (((h - self.low) * self.per_height) as usize).min(self.from.len() - 2)
    }

    fn sort_into(values: &mut [f64], spare: &mut Vec<(u32, f64)>) -> Self {
        let [low, high] = values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &v| [a.min(v), b.max(v)]);
        let drawers = values.len().div_ceil(DRAWER);
        let per_height = drawers as f64 / (high - low);
        let per_height = if per_height.is_finite() { per_height } else { 0.0 };
        let mut out = Self { low, high, per_height, from: vec![(0, 0.0); drawers + 1] };
        spare.clear();
        spare.extend(values.iter().map(|&v| (out.of(v) as u32, v)));
        for &(drawer, v) in spare.iter() {
            let entry = &mut out.from[drawer as usize];
            *entry = (entry.0 + 1, entry.1 + v);
        }
        let (mut end, mut sum) = (values.len() as u32, 0.0);
        out.from[drawers].0 = end;
        for entry in out.from[..drawers].iter_mut().rev() {
            end -= entry.0;
            sum += entry.1;
            *entry = (end, sum);
        }
        let mut next: Vec<u32> = out.from.iter().map(|f| f.0).collect();
        for &(drawer, v) in spare.iter() {
            let at = &mut next[drawer as usize];
            values[*at as usize] = v;
            *at += 1;
        }
        out
    }
}

fn starts(labels: &[u32], cells: usize) -> Vec<u32> {
    let counts = labels.par_chunks(1 << 15).map(|part| {
        let mut counts = vec![0u32; cells + 1];
        for &cell in part.iter().filter(|&&c| c != NO_CELL) {
            counts[cell as usize + 1] += 1;
        }
        counts
    });
    let mut start = counts.reduce(
        || vec![0; cells + 1],
        |mut a, b| {
            a.iter_mut().zip(&b).for_each(|(a, b)| *a += b);
            a
        },
    );
    for i in 0..cells {
        start[i + 1] += start[i];
    }
    start
}

/// Heights over the datum, cell by cell.
fn grouped(field: &Field, labels: &[u32], start: &[u32]) -> Vec<f64> {
    let mut next = start.to_vec();
    let mut heights = vec![0.0; start[start.len() - 1] as usize];
    for (&cell, &h) in labels.iter().zip(field.heights()) {
        if cell != NO_CELL {
            let at = &mut next[cell as usize];
            heights[*at as usize] = h - field.datum();
            *at += 1;
        }
    }
    heights
}
