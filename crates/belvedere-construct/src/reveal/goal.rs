//! Goals of a revealing picture.

use super::options::RevealOptions;
use crate::measure::{Shares, percent};
use serde::Serialize;

/// Whether the goals were reached. Missing one is a result, not an error.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "result", content = "reasons", rename_all = "snake_case")]
pub enum Goal {
    /// All of them.
    Reached,
    /// Not all; one sentence for each that was missed.
    Missed(Vec<String>),
}

impl Goal {
    /// Whether the shares of the whole features reach the goals.
    ///
    /// * `straight`, `bent`: shares in either picture. The gain is demanded only where the straight picture leaves room for it.
    pub fn of([straight, bent]: [Shares; 2], options: &RevealOptions) -> Self {
        let mut missed = Vec::new();
        if bent.visible < options.goal_share {
            missed.push(shortfall(bent, options.goal_share));
        }
        if let Some(gain) = gain([straight, bent])
            && gain < options.goal_gain
            && options.goal_gain * straight.visible <= 1.0
        {
            missed.push(format!(
                "{gain:.2} times the share of the straight picture is visible, {:.2} times were wanted",
                options.goal_gain
            ));
        }
        if bent.in_frame < KEPT_IN_FRAME * straight.in_frame {
            let kept = 100.0 * bent.in_frame / straight.in_frame;
            missed.push(format!("only {kept:.0} % of what the straight picture holds stays in it"));
        }
        if missed.is_empty() { Self::Reached } else { Self::Missed(missed) }
    }
}

/// Share of what the straight picture holds that the bent one must hold.
const KEPT_IN_FRAME: f64 = 0.9;

/// A sentence about a visible share of the whole features that is less than wanted.
pub fn shortfall(shares: Shares, wanted: f64) -> String {
    format!(
        "{} of all that must be seen is visible and {} lies in the frame, {:.0} % were wanted",
        percent(shares.visible),
        percent(shares.in_frame),
        100.0 * wanted
    )
}

/// Visible share bent over visible share straight; `None` if the straight picture shows nothing.
pub fn gain([straight, bent]: [Shares; 2]) -> Option<f64> {
    (straight.visible > 0.0).then(|| bent.visible / straight.visible)
}
