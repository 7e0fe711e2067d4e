//! Distance of every cell of a lattice to the nearest marked one.
//!
//! Source: Felzenszwalb, Huttenlocher, "Distance Transforms of Sampled Functions" (2012): squared distances axis by axis, each the
//! lower envelope of parabolas; exact, in time proportional to the number of cells.

/// Distance from the middle of every cell to the middle of the nearest marked one, in cells; infinite where none is marked.
///
/// * `size`: cells along x, y, z; `marked` is in this order, x fastest.
pub(super) fn distances(marked: &[bool], size: [usize; 3]) -> Vec<f32> {
    let mut squares: Vec<f64> = marked.iter().map(|m| if *m { 0.0 } else { f64::INFINITY }).collect();
    let strides = [1, size[0], size[0] * size[1]];
    for axis in 0..3 {
        let (n, stride) = (size[axis], strides[axis]);
        let mut line = vec![0.0; n];
        let mut envelope = Envelope::default();
        for start in (0..squares.len()).filter(|i| i / stride % n == 0) {
            for (k, value) in line.iter_mut().enumerate() {
                *value = squares[start + k * stride];
            }
            envelope.build(&line);
            for k in 0..n {
                squares[start + k * stride] = envelope.at(k);
            }
        }
    }
    squares.into_iter().map(|d| d.sqrt() as f32).collect()
}

/// Lower envelope of the parabolas `height + (x - vertex)^2`.
#[derive(Default)]
struct Envelope {
    /// Vertex, height, and where each begins to be the lowest.
    parabolas: Vec<(f64, f64, f64)>,
    /// The one that was lowest at the last place asked for; places rise.
    last: usize,
}

impl Envelope {
    fn build(&mut self, heights: &[f64]) {
        self.parabolas.clear();
        self.last = 0;
        for (vertex, &height) in heights.iter().enumerate().filter(|(_, h)| h.is_finite()) {
            let vertex = vertex as f64;
            let mut from = f64::NEG_INFINITY;
            while let Some(&(v, h, begin)) = self.parabolas.last() {
                from = 0.5 * ((height + vertex * vertex) - (h + v * v)) / (vertex - v);
                if from > begin {
                    break;
                }
                self.parabolas.pop();
                from = f64::NEG_INFINITY;
            }
            self.parabolas.push((vertex, height, from));
        }
    }

    fn at(&mut self, x: usize) -> f64 {
        let x = x as f64;
        while self.parabolas.get(self.last + 1).is_some_and(|(.., from)| *from < x) {
            self.last += 1;
        }
        self.parabolas.get(self.last).map_or(f64::INFINITY, |(v, h, _)| h + (x - v) * (x - v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_core::random::Random;

    #[test]
    fn distances_are_those_of_trying_every_marked_cell() {
        let mut random = Random::new(3);
        for (size, share) in [([7, 5, 9], 0.05), ([1, 12, 4], 0.2), ([6, 6, 6], 0.9), ([5, 4, 3], 0.0)] {
            let marked: Vec<bool> = (0..size[0] * size[1] * size[2]).map(|_| random.unit() < share).collect();
            let at = |i: usize| [i % size[0], i / size[0] % size[1], i / size[0] / size[1]].map(|v| v as f64);
            for (i, found) in distances(&marked, size).into_iter().enumerate() {
                let squares = (0..marked.len()).filter(|k| marked[*k]).map(|k| {
                    let (p, q) = (at(i), at(k));
                    (0..3).map(|axis| (p[axis] - q[axis]).powi(2)).sum::<f64>()
                });
                let expected = squares.fold(f64::INFINITY, f64::min).sqrt() as f32;
                assert!(found == expected || (found - expected).abs() < 1e-5, "{size:?} cell {i}: {found} {expected}");
            }
        }
    }
}
