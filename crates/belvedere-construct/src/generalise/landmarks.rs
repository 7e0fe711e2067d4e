//! Landmarks: buildings that stand out of their cell, which keep their shape.

use belvedere_core::quantile::{Rank, quantile};
use belvedere_scene::city::Keep;

/// Footprint, height and mark of a building.
#[derive(Debug, Clone, Copy)]
pub(super) struct Volume {
    /// Footprint, m^2.
    pub area_m2: f64,
    /// Height, metres.
    pub height_m: f64,
    /// Whether its attributes make it a landmark.
    pub tagged: bool,
    /// Whether it is one of the tallest of the town.
    pub tall: bool,
}

/// Least number of buildings whose heights say what is usual.
const LEAST: usize = 5;
/// A landmark is higher than what is usual by so many deviations, at least so many metres, and so many times as high.
const DEVIATIONS: f64 = 3.0;
const LEAST_OVER_M: f64 = 6.0;
const TIMES: f64 = 1.5;
/// Standard deviation of a normal distribution over its median deviation.
const OF_MEDIAN: f64 = 1.4826;
/// The tallest of a town keep their height to this share, and how many they are: so many, of a small town one in twenty.
const TALL_OFF: f64 = 0.1;
const TALLEST: usize = 20;
const TALLEST_OF: usize = 20;

/// Mean height weighted by area, metres; 0 without buildings.
pub(super) fn mean_height(buildings: impl Iterator<Item = Volume>) -> f64 {
    let (area, volume) = buildings.fold((0.0, 0.0), |(a, v), b| (a + b.area_m2, v + b.area_m2 * b.height_m));
    if area > 0.0 { volume / area } else { 0.0 }
}

/// Marks the tallest of a town, where they are higher than is usual.
pub(super) fn mark_tallest(buildings: &mut [Volume], usual: Usual) {
    let mut order: Vec<usize> = (0..buildings.len()).collect();
    order.sort_by(|a, b| buildings[*b].height_m.total_cmp(&buildings[*a].height_m));
    let count = TALLEST.min(buildings.len() / TALLEST_OF);
    let is_high = |height_m: f64| height_m * (1.0 - TALL_OFF) > usual.median_m;
    order[..count].iter().for_each(|i| buildings[*i].tall = is_high(buildings[*i].height_m));
}

/// What heights are usual. Outliers move a mean and a standard deviation, but no median.
#[derive(Debug, Clone, Copy)]
pub(super) struct Usual {
    median_m: f64,
    deviation_m: f64,
}

impl Usual {
    /// Those of some buildings.
    pub(super) fn of(buildings: impl Iterator<Item = Volume>) -> Self {
        let mut heights: Vec<f64> = buildings.map(|b| b.height_m).collect();
        let median_m = quantile(&mut heights, 0.5, Rank::Nearest);
        let mut off: Vec<f64> = heights.iter().map(|h| (h - median_m).abs()).collect();
        Self { median_m, deviation_m: OF_MEDIAN * quantile(&mut off, 0.5, Rank::Nearest) }
    }

    fn is_left_by(self, height_m: f64) -> bool {
        height_m > self.median_m + (DEVIATIONS * self.deviation_m).max(LEAST_OVER_M) && height_m > TIMES * self.median_m
    }
}

/// The landmarks among the buildings `cell` of a cell: indices in `buildings`. A building is a landmark by its attributes, if it
/// stands out of what is usual in the cell (in the whole town where the cell holds few), or if it is one of the tallest and a block of
/// the rest of the cell would not show its height to a tenth.
pub(super) fn landmarks(buildings: &[Volume], cell: &[usize], town: Usual, keep: Keep) -> Vec<usize> {
    let of = |list: &[usize]| list.iter().map(|i| buildings[*i]).collect::<Vec<_>>();
    let usual = if cell.len() < LEAST { town } else { Usual::of(of(cell).into_iter()) };
    let out = |i: &usize| buildings[*i].tagged || usual.is_left_by(buildings[*i].height_m);
    let mut rest: Vec<usize> = cell.iter().copied().filter(|i| !out(i)).collect();
    loop {
        let block_m = match keep {
            Keep::Height => mean_height(of(&rest).into_iter()),
            // How low the block will be is not known before it has its footprint.
            Keep::Volume => 0.0,
        };
        let hidden = |i: &usize| {
            buildings[*i].tall && (buildings[*i].height_m - block_m).abs() > TALL_OFF * buildings[*i].height_m
        };
        let stay: Vec<usize> = rest.iter().copied().filter(|i| !hidden(i)).collect();
        if stay.len() == rest.len() {
            return cell.iter().copied().filter(|i| !rest.contains(i)).collect();
        }
        rest = stay;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: [usize; 0] = [];

    fn heights(heights: &[f64]) -> Vec<Volume> {
        heights.iter().map(|h| Volume { area_m2: 100.0, height_m: *h, tagged: false, tall: false }).collect()
    }

    fn found(buildings: &[Volume], cell: &[usize]) -> Vec<usize> {
        landmarks(buildings, cell, Usual::of(buildings.iter().copied()), Keep::Height)
    }

    #[test]
    fn outliers_and_tagged_buildings_are_landmarks() {
        let all = |n: usize| (0..n).collect::<Vec<_>>();
        let tower = heights(&[9.0, 10.0, 9.5, 10.5, 9.0, 10.0, 40.0]);
        assert_eq!(found(&tower, &all(7)), [6]);
        assert_eq!(found(&tower, &[0, 6]), [6], "the town tells what is usual in a small cell");
        let even = heights(&[9.0, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0, 14.0]);
        assert_eq!(found(&even, &all(8)), NONE, "half as high again, by less than two storeys");
        let mut church = heights(&[9.0, 10.0]);
        church[0].tagged = true;
        assert_eq!(found(&church, &all(2)), [0]);
        assert_eq!(found(&[], &[]), NONE);
    }

    #[test]
    fn a_group_of_towers_does_not_hide_itself() {
        let mut group = heights(&[9.0; 12]);
        group.extend(heights(&[120.0; 4]));
        assert_eq!(found(&group, &(0..16).collect::<Vec<_>>()), [12, 13, 14, 15]);
    }

    #[test]
    fn the_tallest_keep_their_height() {
        let mut town = heights(&(0..60).map(|i| 6.0 + 0.1 * f64::from(i)).collect::<Vec<_>>());
        let usual = Usual::of(town.iter().copied());
        mark_tallest(&mut town, usual);
        assert_eq!(town.iter().filter(|b| b.tall).count(), 3);
        assert_eq!(found(&town, &(0..60).collect::<Vec<_>>()), [57, 58, 59]);
        let high: Vec<usize> = (50..60).collect();
        assert_eq!(found(&town, &high), NONE, "a block of their own height shows them");
        assert_eq!(landmarks(&town, &high, usual, Keep::Volume), [57, 58, 59], "a lower block hides them");
    }
}
