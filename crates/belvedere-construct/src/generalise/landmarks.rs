//! Landmarks: buildings that stand out of their cell, which keep their shape.

/// Footprint, height and mark of a building.
#[derive(Debug, Clone, Copy)]
pub(super) struct Volume {
    /// Footprint, m^2.
    pub area_m2: f64,
    /// Height, metres.
    pub height_m: f64,
    /// Whether its attributes make it a landmark.
    pub tagged: bool,
}

/// Least number of buildings among which outliers are sought.
const LEAST: usize = 5;

/// Mean height weighted by area, metres; 0 without buildings.
pub(super) fn mean_height(buildings: impl Iterator<Item = Volume>) -> f64 {
    let (area, volume) = buildings.fold((0.0, 0.0), |(a, v), b| (a + b.area_m2, v + b.area_m2 * b.height_m));
    if area > 0.0 { volume / area } else { 0.0 }
}

/// The landmarks among `candidates`, which are some of the buildings `cell` of a cell: indices in `buildings`. A building is a
/// landmark by its attributes, or if it is higher than the mean by two standard deviations and half as high again as the mean by
/// area.
pub(super) fn landmarks(buildings: &[Volume], cell: &[usize], candidates: impl Fn(usize) -> bool) -> Vec<usize> {
    let n = cell.len() as f64;
    let mean = cell.iter().map(|i| buildings[*i].height_m).sum::<f64>() / n.max(1.0);
    let variance = cell.iter().map(|i| (buildings[*i].height_m - mean).powi(2)).sum::<f64>() / n.max(1.0);
    let weighted = mean_height(cell.iter().map(|i| buildings[*i]));
    let stands_out =
        |height: f64| cell.len() >= LEAST && height > mean + 2.0 * variance.sqrt() && height > 1.5 * weighted;
    cell.iter()
        .copied()
        .filter(|i| candidates(*i) && (buildings[*i].tagged || stands_out(buildings[*i].height_m)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: [usize; 0] = [];

    fn heights(heights: &[f64]) -> Vec<Volume> {
        heights.iter().map(|h| Volume { area_m2: 100.0, height_m: *h, tagged: false }).collect()
    }

    #[test]
    fn outliers_and_tagged_buildings_are_landmarks() {
        let all = |n: usize| (0..n).collect::<Vec<_>>();
        let tower = heights(&[9.0, 10.0, 9.5, 10.5, 9.0, 10.0, 40.0]);
        assert_eq!(landmarks(&tower, &all(7), |_| true), [6]);
        assert_eq!(landmarks(&tower, &all(7), |i| i != 6), NONE, "no candidate");
        assert_eq!(landmarks(&tower, &[0, 1, 2, 6], |_| true), NONE, "too few buildings");
        let even = heights(&[9.0, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0, 10.0]);
        assert_eq!(landmarks(&even, &all(8), |_| true), NONE, "two deviations higher, but not half as high again");
        let mut church = heights(&[9.0, 10.0]);
        church[0].tagged = true;
        assert_eq!(landmarks(&church, &all(2), |_| true), [0]);
        assert_eq!(landmarks(&[], &[], |_| true), NONE);
    }
}
