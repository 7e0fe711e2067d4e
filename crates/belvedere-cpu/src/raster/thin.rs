//! Triangles of which only some samples are shown.

use crate::geometry::screen::{SUB, ScreenVertex};
use crate::raster::band::Band;
use crate::raster::triangle::Setup;

impl Band {
    /// Draws the samples of a triangle that `shows` at a value given at its corners and linear on the triangle itself.
    ///
    /// * `shows`: by sample, pixel and value.
    #[inline(never)]
    pub(crate) fn draw_thin(
        &mut self,
        tri: [ScreenVertex; 3],
        values: [f32; 3],
        ortho: bool,
        prim: u32,
        shows: &dyn Fn(usize, [i32; 2], f64) -> bool,
    ) {
        let [a, b, c] = tri;
        let x = [a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x)];
        let y = [a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y)];
        if self.misses(x, y) {
            return;
        }
        let Some(setup) = Setup::new(a, b, c) else { return };
        // On the image the product with nearness is linear, in parallel projection the value itself.
        let weighted = |i: usize| if ortho { values[i] } else { values[i] * tri[i].q };
        let Some(value) = Setup::new(
            ScreenVertex { q: weighted(0), ..a },
            ScreenVertex { q: weighted(1), ..b },
            ScreenVertex { q: weighted(2), ..c },
        ) else {
            return;
        };
        for s in 0..self.offsets.len() {
            let [ox, oy] = self.offsets[s];
            let [xa, xb, ya, yb] = self.pixels([ox, oy], x, y);
            for py in ya..=yb {
                let ys = py * SUB + oy;
                let (x0, x1) = setup.span(ys, ox, xa, xb);
                for px in x0..=x1 {
                    let xs = px * SUB + ox;
                    let at = self.index(s, px, py);
                    let q = setup.nearness(xs, ys);
                    if (q as f32) < self.q[at] {
                        continue;
                    }
                    let here = if ortho { value.nearness(xs, ys) } else { value.nearness(xs, ys) / q };
                    if shows(s, [px, py], here) {
                        self.write(at, q as f32, prim);
                    }
                }
            }
        }
    }
}
