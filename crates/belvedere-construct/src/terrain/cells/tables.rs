//! Heights of each cell, sorted.

use super::super::Field;
use super::NO_CELL;

/// For each cell its heights over the datum, ascending, and the sums of everything from each of them upwards.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tables {
    /// First entry of each cell, and the end.
    start: Vec<u32>,
    heights: Vec<f64>,
    /// Same length as `heights`: the sum of the heights of the cell from here on.
    from_here: Vec<f64>,
}

impl Tables {
    pub(super) fn new(field: &Field, labels: &[u32], cells: usize) -> Self {
        let start = starts(labels, cells);
        let mut heights = grouped(field, labels, &start);
        let mut from_here = vec![0.0; heights.len()];
        let mut spare = Vec::new();
        for cell in start.windows(2) {
            let range = cell[0] as usize..cell[1] as usize;
            sort(&mut heights[range.clone()], &mut spare);
            let mut sum = 0.0;
            for i in range.rev() {
                sum += heights[i];
                from_here[i] = sum;
            }
        }
        Self { start, heights, from_here }
    }

    fn range(&self, cell: usize) -> std::ops::Range<usize> {
        self.start[cell] as usize..self.start[cell + 1] as usize
    }

    pub(super) fn sorted(&self, cell: usize) -> &[f64] {
        &self.heights[self.range(cell)]
    }

    pub(super) fn mean(&self, cell: usize) -> f64 {
        let range = self.range(cell);
        self.from_here[range.start] / range.len() as f64
    }

    pub(super) fn higher(&self, cell: usize, h: f64) -> (f64, f64) {
        let range = self.range(cell);
        let sorted = &self.heights[range.clone()];
        let first = sorted.partition_point(|&x| x <= h);
        let count = sorted.len() - first;
        if count == 0 {
            return (0.0, sorted[first - 1]);
        }
        (count as f64 / sorted.len() as f64, self.from_here[range.start + first] / count as f64)
    }
}

fn starts(labels: &[u32], cells: usize) -> Vec<u32> {
    let mut start = vec![0u32; cells + 1];
    for &cell in labels {
        if cell != NO_CELL {
            start[cell as usize + 1] += 1;
        }
    }
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

/// Sorts by spreading the values over as many drawers as there are values, and insertion inside them: heights of a
/// mountain are spread evenly enough.
fn sort(values: &mut [f64], spare: &mut Vec<(u32, f64)>) {
    let [low, high] = values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &v| [a.min(v), b.max(v)]);
    let n = values.len();
    let per_height = (n - 1) as f64 / (high - low);
    if n < 32 || !per_height.is_finite() {
        values.sort_unstable_by(f64::total_cmp);
        return;
    }
    let mut end = vec![0u32; n];
    spare.clear();
    spare.extend(values.iter().map(|&v| (((v - low) * per_height) as u32, v)));
    let mut fullest = 0;
    for &(drawer, _) in spare.iter() {
        end[drawer as usize] += 1;
        fullest = fullest.max(end[drawer as usize]);
    }
    if fullest > 64 {
        values.sort_unstable_by(f64::total_cmp);
        return;
    }
    for i in 1..n {
        end[i] += end[i - 1];
    }
    for &(drawer, v) in spare.iter().rev() {
        end[drawer as usize] -= 1;
        values[end[drawer as usize] as usize] = v;
    }
    for i in 1..n {
        let v = values[i];
        let mut j = i;
        while j > 0 && values[j - 1] > v {
            values[j] = values[j - 1];
            j -= 1;
        }
        values[j] = v;
    }
}
