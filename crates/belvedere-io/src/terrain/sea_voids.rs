//! Detection of seas that are void in a raster.

/// Fewest nodes of such a sea, and their least share of the ground.
const FEWEST: usize = 100;
const LEAST_SHARE: f64 = 0.05;
/// Nine of ten nodes of its shore lie within this of the datum, metres.
const SHORE_M: f32 = 5.0;

/// Sets holes (NaN, joined along rows and columns) that are sea to height 0; returns their nodes. A hole is sea if it reaches
/// the edge of the ground or of the data (beside infinite nodes), is large, and has a low shore.
pub(super) fn fill(cols: usize, heights: &mut [f32]) -> Vec<usize> {
    let mut seen = vec![false; heights.len()];
    let mut filled = Vec::new();
    let known = heights.iter().filter(|h| !h.is_infinite()).count();
    let least = FEWEST.max((LEAST_SHARE * known as f64).ceil() as usize);
    for start in 0..heights.len() {
        if seen[start] || !heights[start].is_nan() {
            continue;
        }
        seen[start] = true;
        let (mut hole, mut shore, mut next, mut at_edge) = (vec![start], Vec::new(), 0, false);
        while let Some(&i) = hole.get(next) {
            next += 1;
            let (c, last) = (i % cols, heights.len() - cols);
            at_edge |= c == 0 || c + 1 == cols || i < cols || i >= last;
            let beside = [
                (c > 0).then(|| i - 1),
                (c + 1 < cols).then(|| i + 1),
                i.checked_sub(cols),
                (i < last).then(|| i + cols),
            ];
            for k in beside.into_iter().flatten() {
                match heights[k] {
                    h if h.is_nan() && !seen[k] => {
                        seen[k] = true;
                        hole.push(k);
                    }
                    h if h.is_infinite() => at_edge = true,
                    h if h.is_finite() => shore.push(h),
                    _ => {}
                }
            }
        }
        if at_edge && hole.len() >= least && is_low(&shore) {
            hole.iter().for_each(|i| heights[*i] = 0.0);
            filled.extend(hole);
        }
    }
    filled
}

fn is_low(shore: &[f32]) -> bool {
    let within = shore.iter().filter(|h| h.abs() <= SHORE_M).count();
    !shore.is_empty() && 10 * within >= 9 * shore.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 60;

    /// How many nodes of a ground become sea: void left of column `shore`, land from `low` up beside it.
    fn sea(shore: usize, low: f32, change: impl Fn(usize, usize, f32) -> f32) -> usize {
        let height = |c: usize| if c < shore { f32::NAN } else { low + 3.0 * (c - shore) as f32 };
        let mut heights: Vec<f32> = (0..SIDE * SIDE).map(|i| change(i % SIDE, i / SIDE, height(i % SIDE))).collect();
        let holes = heights.iter().filter(|h| h.is_nan()).count();
        let filled = fill(SIDE, &mut heights);
        assert!(filled.iter().all(|i| heights[*i] == 0.0));
        assert_eq!(heights.iter().filter(|h| h.is_nan()).count() + filled.len(), holes);
        filled.len()
    }

    #[test]
    fn large_voids_at_the_edge_with_a_low_shore_are_sea_and_no_others() {
        let same = |_: usize, _: usize, h: f32| h;
        assert_eq!(sea(20, 2.0, same), 20 * SIDE);
        assert_eq!(sea(20, 45.0, same), 0, "a high shore");
        assert_eq!(sea(20, 6.0, same), 0, "a shore over 5 m");
        assert_eq!(sea(20, -4.0, same), 20 * SIDE, "low land");
        assert_eq!(sea(20, -9.0, same), 0, "land below sea level");
        let cliffs = |c: usize, r: usize, h: f32| if c == 20 && r.is_multiple_of(8) { h + 30.0 } else { h };
        assert_eq!(sea(20, 2.0, cliffs), 0, "an eighth of the shore is cliffs");
        assert_eq!(sea(2, 2.0, same), 0, "small");
        let dike = |c: usize, r: usize, h: f32| if c == 0 || r == 0 || r == SIDE - 1 { 2.0 } else { h };
        assert_eq!(sea(20, 2.0, dike), 0, "a hole inside the ground");
        let outside = |c: usize, _: usize, h: f32| if c < 5 { f32::INFINITY } else { h };
        assert_eq!(sea(20, 2.0, outside), 15 * SIDE, "what lies outside the data stays outside");
        let frame = |c: usize, r: usize, h: f32| if c > 55 || r > 50 { f32::NAN } else { h };
        assert_eq!(sea(20, 2.0, frame), 0, "a frame that also cuts through high land");
    }
}
