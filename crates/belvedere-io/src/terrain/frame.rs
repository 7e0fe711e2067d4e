//! The samples of one value that reach the edge of a grid.

/// A run of samples in a row: row, first column, column after the last.
type Run = [u32; 3];

/// Number of samples that are `value` and hang together with samples of that value at the edge, side by side.
///
/// Memory: an eighth of a byte for each sample, and the runs of samples that wait.
pub(super) fn at_edge(heights: &[f32], cols: usize, rows: usize, value: f32) -> usize {
    let mut flood =
        Flood { heights, cols, value, seen: vec![0; heights.len().div_ceil(64)], count: 0, waiting: Vec::new() };
    for row in 0..rows {
        if row == 0 || row + 1 == rows {
            flood.row(row, 0, cols);
        } else {
            flood.row(row, 0, 1);
            flood.row(row, cols - 1, cols);
        }
    }
    while let Some([row, from, to]) = flood.waiting.pop() {
        let (row, from, to) = (row as usize, from as usize, to as usize);
        if row > 0 {
            flood.row(row - 1, from, to);
        }
        if row + 1 < rows {
            flood.row(row + 1, from, to);
        }
    }
    flood.count
}

struct Flood<'a> {
    heights: &'a [f32],
    cols: usize,
    value: f32,
    seen: Vec<u64>,
    count: usize,
    waiting: Vec<Run>,
}

impl Flood<'_> {
    fn is_new(&self, i: usize) -> bool {
        self.heights[i] == self.value && self.seen[i / 64] >> (i % 64) & 1 == 0
    }

    /// Takes the runs of the value that touch columns `from..to` of a row.
    fn row(&mut self, row: usize, from: usize, to: usize) {
        let first = row * self.cols;
        let mut col = from;
        while col < to {
            if !self.is_new(first + col) {
                col += 1;
                continue;
            }
            // A run is taken whole, so before its first column is another value.
            let (mut start, mut end) = (col, col + 1);
            while start > 0 && self.is_new(first + start - 1) {
                start -= 1;
            }
            while end < self.cols && self.is_new(first + end) {
                end += 1;
            }
            for i in first + start..first + end {
                self.seen[i / 64] |= 1 << (i % 64);
            }
            self.count += end - start;
            self.waiting.push([row, start, end].map(|n| n as u32));
            col = end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One sample at a time, on grids of two values.
    fn slowly(heights: &[f32], cols: usize, rows: usize, value: f32) -> usize {
        let edge = |i: usize| i.is_multiple_of(cols) || i % cols == cols - 1 || i / cols == 0 || i / cols == rows - 1;
        let mut seen: Vec<bool> = (0..heights.len()).map(|i| edge(i) && heights[i] == value).collect();
        loop {
            let near = |i: usize| {
                let (c, r) = (i % cols, i / cols);
                (c > 0 && seen[i - 1])
                    || (c + 1 < cols && seen[i + 1])
                    || (r > 0 && seen[i - cols])
                    || (r + 1 < rows && seen[i + cols])
            };
            let next: Vec<usize> = (0..heights.len()).filter(|&i| !seen[i] && heights[i] == value && near(i)).collect();
            if next.is_empty() {
                return seen.iter().filter(|s| **s).count();
            }
            next.into_iter().for_each(|i| seen[i] = true);
        }
    }

    #[test]
    fn runs_count_as_single_samples_do() {
        let mut state = 7u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            state >> 33
        };
        for _ in 0..300 {
            let (cols, rows) = (2 + random() as usize % 20, 2 + random() as usize % 20);
            let share = 1 + random() % 9;
            let heights: Vec<f32> = (0..cols * rows).map(|_| f32::from(u8::from(random() % 10 < share))).collect();
            assert_eq!(
                at_edge(&heights, cols, rows, 0.0),
                slowly(&heights, cols, rows, 0.0),
                "{cols} x {rows}: {heights:?}"
            );
        }
    }
}
