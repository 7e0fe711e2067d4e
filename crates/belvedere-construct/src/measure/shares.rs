//! The two shares of whole features that headlines, reports, goals and the window state.

use super::report::{FeatureMeasure, Measures, Visibility};
use serde::Serialize;

/// Shares of the whole required features in one picture: of lines by length, of areas and surfaces by area, of points by number. What lies
/// outside the picture is not visible. Source: ours.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Shares {
    /// Visible share, 0..=`in_frame`.
    pub visible: f64,
    /// Share inside the picture, hidden or not, 0..=1.
    pub in_frame: f64,
}

impl Shares {
    /// Visible share of what lies in the picture, 0..=1; `None` if nothing does.
    pub fn visible_in_frame(&self) -> Option<f64> {
        (self.in_frame > 0.0).then(|| (self.visible / self.in_frame).min(1.0))
    }

    /// The least of the visible shares, and the least of the shares in the picture.
    pub fn least(self, other: Self) -> Self {
        Self { visible: self.visible.min(other.visible), in_frame: self.in_frame.min(other.in_frame) }
    }
}

impl std::fmt::Display for Shares {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({} in the frame)", percent(self.visible), percent(self.in_frame))
    }
}

/// A share in per cent with one digit; less than everything is never rounded to 100, and more than nothing never to 0.
pub fn percent(share: f64) -> String {
    let (mut rounded, least) = ((1000.0 * share).round() / 10.0, 0.1);
    if share < 1.0 - 1e-9 {
        rounded = rounded.min(100.0 - least);
    }
    if share > 1e-9 {
        rounded = rounded.max(least);
    }
    format!("{rounded:.1} %")
}

impl FeatureMeasure {
    /// Shares of the whole feature in the straight and in the bent picture; `None` if it has no amount.
    pub fn shares(&self) -> Option<[Shares; 2]> {
        let of = |v: &Visibility| Shares {
            visible: (v.sight.visible / self.total).clamp(0.0, 1.0),
            in_frame: (v.in_frame / self.total).clamp(0.0, 1.0),
        };
        (self.total > 0.0).then(|| [of(&self.straight), of(&self.bent)])
    }
}

impl Measures {
    /// Shares of all required features in the straight and in the bent picture, by lines of sight: the least of those of lines, areas,
    /// points and surfaces. `None` without any of them.
    pub fn shares(&self) -> Option<[Shares; 2]> {
        let kinds = [&self.lines, &self.areas, &self.points, &self.surfaces];
        let all = kinds.into_iter().flatten().filter_map(FeatureMeasure::shares);
        all.reduce(|[a, b], [c, d]| [a.least(c), b.least(d)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn less_than_everything_is_not_100_and_more_than_nothing_is_not_0() {
        let said = [1.0, 0.9999, 0.978, 0.0004, 0.0].map(percent);
        assert_eq!(said, ["100.0 %", "99.9 %", "97.8 %", "0.1 %", "0.0 %"]);
        let shares = Shares { visible: 0.32, in_frame: 0.33 };
        assert_eq!(shares.to_string(), "32.0 % (33.0 % in the frame)");
        assert!((shares.visible_in_frame().unwrap() - 0.32 / 0.33).abs() < 1e-12);
        assert_eq!(Shares::default().visible_in_frame(), None);
    }
}
