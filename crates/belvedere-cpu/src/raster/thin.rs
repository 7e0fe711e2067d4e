//! Rasterises triangles of which only some samples are shown.

use crate::raster::band::Band;
use crate::raster::triangle::Setup;
use crate::screen::{SUB, ScreenVertex};

/// Decides which samples show a surface, by a value interpolated on it.
pub(crate) trait ThinShow {
    /// Data derived from a value, for all samples at one position.
    type At;
    fn at(&self, value: f64) -> Self::At;
    fn shows(&self, at: &Self::At, sample: usize, pixel: [i32; 2]) -> bool;
}

impl Band {
    /// Draws the samples of a triangle that `show` shows, by a value that is given at the corners and linear on the triangle.
    ///
    /// * `places`: number of distinct sample positions apart from the centre; later samples repeat these positions.
    #[inline(never)]
    pub(crate) fn draw_thin(
        &mut self,
        tri: [ScreenVertex; 3],
        values: [f32; 3],
        (ortho, places): (bool, usize),
        prim: u32,
        show: &impl ThinShow,
    ) {
        let [a, b, c] = tri;
        let x = [a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x)];
        let y = [a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y)];
        if self.misses(x, y) {
            return;
        }
        let Some(setup) = Setup::new(a, b, c) else { return };
        // The product with nearness is linear on the image; in parallel projection the value itself is.
        let weighted = |i: usize| if ortho { values[i] } else { values[i] * tri[i].q };
        let Some(value) = Setup::new(
            ScreenVertex { q: weighted(0), ..a },
            ScreenVertex { q: weighted(1), ..b },
            ScreenVertex { q: weighted(2), ..c },
        ) else {
            return;
        };
        let all = self.offsets.len();
        for first in 0..all.min(1 + places) {
            let [ox, oy] = self.offsets[first];
            let [xa, xb, ya, yb] = self.pixels([ox, oy], x, y);
            // The centre alone, or all samples at one position.
            let samples = (first..if first == 0 { 1 } else { all }).step_by(places.max(1));
            for py in ya..=yb {
                let ys = py * SUB + oy;
                let (x0, x1) = setup.span(ys, ox, xa, xb);
                for px in x0..=x1 {
                    let xs = px * SUB + ox;
                    let q = setup.nearness(xs, ys);
                    // Most samples are hidden, and need no value.
                    let mut at = None;
                    for s in samples.clone() {
                        let i = self.index(s, px, py);
                        let here = || if ortho { value.nearness(xs, ys) } else { value.nearness(xs, ys) / q };
                        if q as f32 >= self.q[i] && show.shows(at.get_or_insert_with(|| show.at(here())), s, [px, py]) {
                            self.write(i, q as f32, prim);
                        }
                    }
                }
            }
        }
    }
}
