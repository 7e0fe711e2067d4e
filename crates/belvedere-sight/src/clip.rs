//! Clipping of segments to boxes.

/// Part of a segment inside a box, as parameters in 0..=1 (0 at `start`, 1 at `start + dir`).
///
/// The box is given by its smallest and largest corner and holds its rim. Where the segment misses it, the first
/// parameter is larger than the second. In any number of dimensions.
#[inline]
pub fn clip_segment<const N: usize>(start: [f64; N], dir: [f64; N], [low, high]: [[f64; N]; 2]) -> [f64; 2] {
    let [mut t0, mut t1] = [0.0f64, 1.0f64];
    for axis in 0..N {
        let (p, d) = (start[axis], dir[axis]);
        if d == 0.0 {
            if !(low[axis] <= p && p <= high[axis]) {
                return [f64::INFINITY, f64::NEG_INFINITY];
            }
            continue;
        }
        let (s0, s1) = ((low[axis] - p) / d, (high[axis] - p) / d);
        t0 = t0.max(s0.min(s1));
        t1 = t1.min(s0.max(s1));
        // Most boxes are missed, and most of these along the first axis already.
        if t0 > t1 {
            break;
        }
    }
    [t0, t1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_part_inside_is_that_of_a_thousand_points() {
        let (low, high) = ([-1.0, 0.0, 2.0], [1.0, 3.0, 2.5]);
        let mut met = 0;
        for i in 0..300 {
            let r = |k: usize| 5.0 * ((i * 7 + k) as f64 * 0.618_033_988_749_895).fract() - 1.0;
            let start = [r(0), r(1), r(2)];
            let mut dir = [r(3) - start[0], r(4) - start[1], r(5) - start[2]];
            dir[i % 3] *= f64::from(u8::from(i % 4 > 0));
            let inside = |t: f64| (0..3).all(|a| (low[a]..=high[a]).contains(&(start[a] + t * dir[a])));
            let [t0, t1] = clip_segment(start, dir, [low, high]);
            for k in 0..=1000 {
                let t = f64::from(k) / 1000.0;
                if (t - t0).abs() > 1e-9 && (t - t1).abs() > 1e-9 {
                    assert_eq!(inside(t), (t0..=t1).contains(&t), "segment {i} at {t}, inside from {t0} to {t1}");
                }
            }
            met += usize::from(t0 <= t1);
        }
        assert!((20..250).contains(&met), "{met} of 300 meet the box");
    }

    #[test]
    fn the_rim_is_inside() {
        let square = [[0.0, 0.0], [2.0, 1.0]];
        assert_eq!(clip_segment([-1.0, 1.0], [4.0, 0.0], square), [0.25, 0.75]);
        assert_eq!(clip_segment([2.0, 1.0], [0.0, 0.0], square), [0.0, 1.0]);
        let [t0, t1] = clip_segment([-1.0, 1.1], [4.0, 0.0], square);
        assert!(t0 > t1);
    }
}
