//! Where the sky begins over each column of a picture.

use belvedere_core::DVec2;

/// How far below the skyline a point may stand and still belong to it, units.
const NEAR: f64 = 8.0;
/// Columns to each side whose ground is looked at, units.
const BESIDE: f64 = 60.0;

/// Rows of the highest ground.
#[derive(Debug, Clone, Default)]
pub struct Skyline {
    /// By column; the height of the picture where there is sky alone.
    rows: Vec<u32>,
    height: u32,
    /// Columns whose ground was not met.
    open: usize,
}

impl Skyline {
    /// The skyline of a picture of which no row is known.
    pub fn unknown([width, height]: [usize; 2]) -> Self {
        Self { rows: vec![height as u32; width], height: height as u32, open: width }
    }

    /// Takes note of a row, from above; whether there are columns whose ground was not met.
    /// * `depth`: not finite in the sky.
    pub fn note(&mut self, row: usize, depth: &[f32]) -> bool {
        for (first, depth) in self.rows.iter_mut().zip(depth) {
            if *first == self.height && depth.is_finite() {
                *first = row as u32;
                self.open -= 1;
            }
        }
        self.open > 0
    }

    /// * `depth`: row-major, not finite in the sky.
    pub(crate) fn of(depth: &[f32], width: usize) -> Self {
        let mut skyline = Self::unknown([width, depth.len().checked_div(width).unwrap_or(0)]);
        let mut rows = depth.chunks_exact(width.max(1)).enumerate();
        while rows.next().is_some_and(|(row, depth)| skyline.note(row, depth)) {}
        skyline
    }

    /// Row of the highest ground around a point that stands on the skyline; `None` for others, and where no sky is above.
    ///
    /// * `density`: pixels per unit.
    pub(crate) fn over(&self, at: DVec2, density: f64) -> Option<f64> {
        let highest = |reach: f64| {
            let last = self.rows.len().checked_sub(1)? as f64;
            let [from, to] = [at.x - reach, at.x + reach].map(|x| x.clamp(0.0, last) as usize);
            self.rows[from..=to].iter().min().map(|row| f64::from(*row))
        };
        let inside = at.is_finite() && at.x >= 0.0 && at.x < self.rows.len() as f64;
        let own = highest(2.0 * density).filter(|_| inside)?;
        let stands = own >= 1.0 && at.y - own <= NEAR * density;
        stands.then(|| highest(BESIDE * density)).flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_the_skyline_are_told_from_those_below_it() {
        // A ridge that falls from row 20 to row 60; sky alone in the last columns.
        let (width, height) = (300, 100);
        let ground = |x: usize| if x < 280 { 20 + x / 7 } else { height };
        let depth: Vec<f32> =
            (0..width * height).map(|i| if i / width >= ground(i % width) { 5.0 } else { f32::INFINITY }).collect();
        let skyline = Skyline::of(&depth, width);
        assert_eq!(skyline.over(DVec2::new(140.0, 41.0), 1.0), Some((20 + 80 / 7) as f64));
        assert_eq!(skyline.over(DVec2::new(140.0, 60.0), 1.0), None);
        assert_eq!(skyline.over(DVec2::new(-3.0, 20.0), 1.0), None);
        assert_eq!(Skyline::of(&[1.0; 50], 10).over(DVec2::new(5.0, 0.0), 1.0), None);
        assert_eq!(Skyline::of(&[], 0).over(DVec2::ZERO, 1.0), None);
    }
}
