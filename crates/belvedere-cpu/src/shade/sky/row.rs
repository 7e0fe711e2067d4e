//! Stores rows of sky directly as sRGB pixels.

use crate::screen::SUB;
use crate::shade::painted::interleave;
use crate::shade::sky::{LANES, Sky};
use crate::simd::{self, Kernel};
use belvedere_composite::color::{Encoder, PIXELS};

impl Sky {
    /// Stores the sky of neighbouring pixels of a row, with the same result as [`Sky::paint`].
    /// * `at`: sample of the first pixel, fixed-point steps.
    pub(crate) fn store(&self, at: [i32; 2], out: &mut [[u8; 3]]) {
        simd::run(Store { sky: self, at, out });
    }
}

struct Store<'s> {
    sky: &'s Sky,
    at: [i32; 2],
    out: &'s mut [[u8; 3]],
}

impl Kernel for Store<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { sky, at: [x, y], out } = self;
        let (encoder, rows) = (Encoder::default(), [y; LANES]);
        let (mut planes, threshold) = ([[0; PIXELS]; 3], sky.thresholds(x, y));
        for (i, out) in out.chunks_mut(PIXELS).enumerate() {
            let points = sky.points(x + (i * PIXELS) as i32 * SUB, y);
            for j in 0..out.len().div_ceil(LANES) {
                let x = x + (i * PIXELS + j * LANES) as i32 * SUB;
                let whole = sky.clouds.is_none() && (j + 1) * LANES <= out.len();
                let mut roots = [[0.0; LANES]; 3];
                let [red, green, blue] = &mut roots;
                let line = if whole { points[j].line_to(&points[j + 1]) } else { None };
                let ends = match line {
                    Some(line) => {
                        line.paint(&threshold, [red, green, blue]);
                        line.ends()
                    }
                    None => {
                        let mut columns = [x; LANES];
                        for (k, column) in columns.iter_mut().enumerate() {
                            *column += k as i32 * SUB;
                        }
                        sky.paint_each(&columns, &rows, [red, green, blue]);
                        [[0.0, 1.0]; 3]
                    }
                };
                // No closures: they would be compiled separately, for the oldest processors.
                for ((plane, roots), ends) in planes.iter_mut().zip(&roots).zip(ends) {
                    plane[j * LANES..][..LANES].copy_from_slice(&encoder.encode_between(roots, ends));
                }
            }
            interleave(&planes, out);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_composite::color::{self, encoding};
    use belvedere_core::{Aabb, DVec3, Pinhole, Projection};

    #[test]
    fn stored_rows_are_the_painted_ones() {
        for (fov_y, roll) in [(0.8, 0.0), (0.8, 0.2), (1.9, 0.1)] {
            let (screen, up) = (Projection::Perspective { fov_y }, DVec3::new(f64::sin(roll), 0.0, f64::cos(roll)));
            let p = Pinhole::look_at(DVec3::ZERO, DVec3::Y, up, screen, [707, 400], 1.0, None).unwrap();
            let sky = Sky::new(&Aabb::EMPTY, &p);
            let x: Vec<i32> = (0..707).map(|x| x * SUB + SUB / 2).collect();
            let mut stored = vec![[0; 3]; 707];
            for row in 0..400 {
                let y = vec![row * SUB + SUB / 2; 707];
                let mut planes = [(); 3].map(|()| vec![0.0f32; 707]);
                sky.paint(&x, &y, planes.each_mut().map(Vec::as_mut_slice));
                sky.store([x[0], y[0]], &mut stored);
                for (i, stored) in stored.iter().enumerate() {
                    let root = planes.each_ref().map(|plane| color::sixteen_bits(plane[i]));
                    assert_eq!(*stored, color::Packed::of_roots(root).encode(encoding()), "pixel {i} of row {row}");
                }
            }
        }
    }
}
