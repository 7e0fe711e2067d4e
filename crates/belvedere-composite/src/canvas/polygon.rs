//! Filled polygons: the exact area of every pixel inside (signed area accumulation).

use super::Canvas;
use belvedere_core::DVec2;
use belvedere_scene::Color;

/// Coverage of the pixels of a box by a polygon.
struct Coverage {
    width: usize,
    height: usize,
    /// Change of the coverage from the pixel before, one more column than pixels.
    change: Vec<f64>,
}

impl Coverage {
    fn new(width: usize, height: usize) -> Self {
        Self { width, height, change: vec![0.0; (width + 1) * height] }
    }

    /// Adds the area to the right of an edge, signed by its direction.
    fn edge(&mut self, a: DVec2, b: DVec2) {
        if a.y == b.y {
            return;
        }
        let (top, bottom, sign) = if a.y < b.y { (a, b, 1.0) } else { (b, a, -1.0) };
        let slope = (bottom.x - top.x) / (bottom.y - top.y);
        let x_at = |y: f64| top.x + (y - top.y) * slope;
        let rows = top.y.max(0.0).floor() as usize..bottom.y.clamp(0.0, self.height as f64).ceil() as usize;
        for row in rows {
            let (y0, y1) = (top.y.max(row as f64), bottom.y.min(row as f64 + 1.0));
            if y1 > y0 {
                self.piece(row, [x_at(y0), x_at(y1)], sign * (y1 - y0));
            }
        }
    }

    /// A piece of an edge within one row, `tall` pixels high: cut at the columns.
    fn piece(&mut self, row: usize, [x0, x1]: [f64; 2], tall: f64) {
        let (low, high) = (x0.min(x1), x0.max(x1));
        let edge = self.width as f64;
        let share = |from: f64, to: f64| if high > low { tall * (to - from) / (high - low) } else { tall };
        let start = row * (self.width + 1);
        if low < 0.0 {
            self.change[start] += if high > low { share(low, high.min(0.0)) } else { tall };
        }
        let (mut at, end) = (low.max(0.0), high.min(edge));
        if high == low {
            if (0.0..edge).contains(&low) {
                self.inside(start, low, low, tall);
            }
            return;
        }
        while at < end {
            let next = (at.floor() + 1.0).min(end);
            self.inside(start, at, next, share(at, next));
            at = next;
        }
    }

    /// A piece within one pixel.
    fn inside(&mut self, start: usize, from: f64, to: f64, tall: f64) {
        let column = from.floor();
        let left = 0.5 * (from + to) - column;
        self.change[start + column as usize] += tall * (1.0 - left);
        self.change[start + column as usize + 1] += tall * left;
    }
}

impl Canvas<'_> {
    /// Fills a polygon: outer rings and holes, closed implicitly, holes oriented against their outer ring.
    pub fn polygon<'r>(&mut self, rings: impl IntoIterator<Item = &'r [DVec2]> + Clone, color: Color) {
        let scale = self.scale;
        let points = || rings.clone().into_iter().flatten().map(|p| *p * scale);
        if points().any(|p| !p.is_finite()) {
            return;
        }
        let Some(first) = points().next() else { return };
        let scaled = || rings.clone().into_iter().map(|ring| ring.iter().map(|p| *p * scale).collect()).collect();
        if self.records(|| super::CanvasShape::Polygon { rings: scaled(), color }) {
            return;
        }
        let (low, high) = points().fold((first, first), |(low, high), p| (low.min(p), high.max(p)));
        let (low, high) = (low.floor().max(DVec2::ZERO), high.ceil().min(self.extent()));
        if !low.cmplt(high).all() {
            return;
        }
        let [width, height] = [high.x - low.x, high.y - low.y].map(|side| side as usize);
        let mut coverage = Coverage::new(width, height);
        for ring in rings {
            for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                coverage.edge(*a * scale - low, *b * scale - low);
            }
        }
        for (row, changes) in coverage.change.chunks(width + 1).enumerate() {
            let mut inside = 0.0;
            for (column, change) in changes[..width].iter().enumerate() {
                inside += change;
                self.blend(
                    low.x as i64 + column as i64,
                    low.y as i64 + row as i64,
                    color,
                    inside.abs().min(1.0) as f32,
                );
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Black on white: 1 - coverage.
    fn drawn(rings: &[Vec<DVec2>]) -> Vec<f64> {
        let mut pixels = vec![[255u8; 3]; 20 * 10];
        Canvas::new(&mut pixels, 20).polygon(rings.iter().map(Vec::as_slice), Color::rgb(0, 0, 0));
        pixels.iter().map(|p| 1.0 - f64::from(p[0]) / 255.0).collect()
    }

    fn ring(points: &[[f64; 2]]) -> Vec<DVec2> {
        points.iter().map(|p| DVec2::from(*p)).collect()
    }

    #[test]
    fn the_inked_area_is_that_of_the_polygon() {
        let slanted = ring(&[[2.3, 1.2], [17.7, 3.4], [11.1, 8.9]]);
        let area = 0.5 * (slanted[1] - slanted[0]).perp_dot(slanted[2] - slanted[0]);
        assert!((drawn(std::slice::from_ref(&slanted)).iter().sum::<f64>() - area).abs() < 0.2);
        let hole = ring(&[[10.0, 5.0], [10.0, 4.0], [12.0, 4.0], [12.0, 5.0]]);
        let turned: Vec<DVec2> = slanted.iter().rev().copied().collect();
        for (outer, hole) in [(slanted, hole.iter().rev().copied().collect::<Vec<_>>()), (turned, hole)] {
            let sum = drawn(&[outer.clone(), hole.clone()]).iter().sum::<f64>();
            let other = drawn(&[outer, hole.iter().rev().copied().collect()]).iter().sum::<f64>();
            assert!((sum.min(other) - (area - 2.0)).abs() < 0.3, "{sum} or {other} instead of {}", area - 2.0);
        }
    }

    #[test]
    fn what_lies_outside_is_cut_off() {
        let large = ring(&[[-30.0, -20.0], [50.0, -20.0], [50.0, 40.0], [-30.0, 40.0]]);
        assert!(drawn(&[large]).iter().all(|ink| *ink > 0.99));
        let left = ring(&[[-30.0, 2.0], [4.5, 2.0], [4.5, 6.0], [-30.0, 6.0]]);
        assert!((drawn(&[left]).iter().sum::<f64>() - 18.0).abs() < 0.1);
        assert_eq!(drawn(&[ring(&[[30.0, 1.0], [40.0, 1.0], [35.0, 9.0]])]).iter().sum::<f64>(), 0.0);
        assert_eq!(drawn(&[ring(&[[f64::NAN, 1.0], [4.0, 1.0], [3.0, 9.0]])]).iter().sum::<f64>(), 0.0);
        assert_eq!(drawn(&[]).iter().sum::<f64>(), 0.0);
    }
}
