//! What of a picture is taken, found fast by a grid of squares.

use belvedere_core::DVec2;
use std::collections::HashMap;

/// Upper left and lower right corner, pixels.
pub(crate) type Rect = [DVec2; 2];

pub(crate) fn overlap(a: &Rect, b: &Rect) -> bool {
    a[0].x < b[1].x && b[0].x < a[1].x && a[0].y < b[1].y && b[0].y < a[1].y
}

/// Rectangles with a number that tells whose each is.
#[derive(Debug, Default)]
pub(crate) struct Occupied {
    rects: Vec<(Rect, usize)>,
    squares: HashMap<[i32; 2], Vec<u32>>,
    side: f64,
}

/// Most squares that one rectangle is entered into.
const MOST_SQUARES: usize = 100_000;

impl Occupied {
    /// * `side`: of a square, pixels, > 0.
    pub(crate) fn new(side: f64) -> Self {
        Self { side: side.max(1.0), ..Self::default() }
    }

    fn squares_of(&self, rect: &Rect) -> impl Iterator<Item = [i32; 2]> + use<> {
        let square = |v: f64| (v / self.side).floor().clamp(-1e6, 1e6) as i32;
        let [[x0, y0], [x1, y1]] = rect.map(|p| p.to_array().map(square));
        (y0..=y1).flat_map(move |y| (x0..=x1).map(move |x| [x, y])).take(MOST_SQUARES)
    }

    /// Takes a rectangle; one that is not finite takes nothing.
    pub(crate) fn take(&mut self, rect: Rect, whose: usize) {
        if !rect.iter().all(|p| p.is_finite()) {
            return;
        }
        let number = self.rects.len() as u32;
        self.rects.push((rect, whose));
        for square in self.squares_of(&rect) {
            self.squares.entry(square).or_default().push(number);
        }
    }

    /// Whether nothing but what is of `own` lies in a rectangle.
    pub(crate) fn is_free(&self, rect: &Rect, own: usize) -> bool {
        let hit = |number: &u32| {
            let (other, whose) = &self.rects[*number as usize];
            *whose != own && overlap(other, rect)
        };
        !self.squares_of(rect).any(|square| self.squares.get(&square).is_some_and(|list| list.iter().any(hit)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_finds_what_a_search_of_all_finds() {
        let mut seed = 7u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f64 / f64::from(1u32 << 24)
        };
        let mut rect = || {
            let at = DVec2::new(1000.0 * random() - 100.0, 1000.0 * random() - 100.0);
            [at, at + DVec2::new(120.0 * random(), 30.0 * random())]
        };
        let (mut grid, mut all) = (Occupied::new(50.0), Vec::new());
        let mut free = 0;
        for own in 0..600 {
            let rect = rect();
            let wanted = !all.iter().any(|(other, whose)| *whose != own / 2 && overlap(other, &rect));
            assert_eq!(grid.is_free(&rect, own / 2), wanted, "{rect:?}");
            free += usize::from(wanted);
            if own % 3 == 0 {
                all.push((rect, own / 2));
                grid.take(rect, own / 2);
            }
        }
        assert!((100..500).contains(&free), "{free} of 600 free");
        grid.take([DVec2::NAN, DVec2::ONE], 0);
        assert!(grid.is_free(&[DVec2::splat(-5e9), DVec2::splat(-4e9)], 9));
    }
}
