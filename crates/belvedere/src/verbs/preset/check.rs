//! Usability of a preset document.

use super::{DISTANCE, Shape, seen_at, shapes};
use belvedere_core::Warning;
use belvedere_core::map::spline::{EDGE_ON, check_presets};
use belvedere_core::presets::{BendFrame, PresetDocument};
use schemars::JsonSchema;
use serde::Serialize;

/// Answer of [`check`].
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct PresetCheck {
    /// Usability of the document.
    pub verdict: Verdict,
    /// The presets by ascending viewing angle.
    pub presets: Vec<Shape>,
    /// Ranges of viewing angles within 0..=90 degrees at which all ground faces the eye.
    pub usable: Vec<Usable>,
    /// Ranges at which the picture does not change while the camera tilts, degrees.
    pub still: Vec<Usable>,
    /// Warnings about the appearance.
    pub warnings: Vec<Warning>,
}

/// Usability of a valid document.
#[derive(Debug, Clone, Copy, PartialEq, Eq, JsonSchema, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// At every viewing angle.
    Valid,
    /// At some viewing angles.
    UsableInPart,
    /// At no viewing angle.
    NotUsable,
}

/// A range of viewing angles, degrees.
#[derive(Debug, Clone, Copy, PartialEq, JsonSchema, Serialize)]
pub struct Usable {
    /// Smallest.
    pub from_deg: f64,
    /// Largest.
    pub to_deg: f64,
}

/// Tested viewing angles per degree.
const PER_DEGREE: u32 = 4;

/// Checks at which viewing angles from the horizon to straight down a valid document is usable, and how it looks, for data without
/// heights.
pub fn check(document: &PresetDocument) -> PresetCheck {
    let warnings = check_presets(document, DISTANCE, None).iter().map(Warning::from).collect();
    let faces = |phi: f64| seen_at(document, phi).is_some_and(|(_, bend)| bend.facing() > -EDGE_ON);
    let usable = ranges(faces);
    let verdict = match usable.as_slice() {
        [] => Verdict::NotUsable,
        [Usable { from_deg: 0.0, to_deg: 90.0 }] => Verdict::Valid,
        _ => Verdict::UsableInPart,
    };
    PresetCheck { verdict, presets: shapes(document), usable, still: still(document), warnings }
}

impl PresetCheck {
    /// The usability in words.
    pub fn words(&self) -> String {
        match self.verdict {
            Verdict::Valid => "valid: usable at every viewing angle from 0 to 90 degrees".into(),
            Verdict::UsableInPart => {
                format!("usable at viewing angles of {} degrees; beyond, the ground faces away", listed(&self.usable))
            }
            Verdict::NotUsable => {
                "not usable: at every viewing angle some of the ground faces away; lower the far end of the curve"
                    .into()
            }
        }
    }

    /// Ranges at which the picture does not change, in words; `None` if there are none.
    pub fn still_words(&self) -> Option<String> {
        let all = listed(&self.still);
        (!self.still.is_empty())
            .then(|| format!("while the camera tilts through {all} degrees the picture stands still"))
    }
}

fn listed(ranges: &[Usable]) -> String {
    let words: Vec<String> = ranges.iter().map(|r| format!("{} to {}", r.from_deg, r.to_deg)).collect();
    words.join(", ")
}

/// Runs of viewing angles for which `holds` is true.
fn ranges(holds: impl Fn(f64) -> bool) -> Vec<Usable> {
    let mut out: Vec<Usable> = Vec::new();
    let mut before = false;
    for i in 0..=90 * PER_DEGREE {
        let phi = f64::from(i) / f64::from(PER_DEGREE);
        let now = holds(phi);
        match out.last_mut().filter(|_| before) {
            Some(last) if now => last.to_deg = phi,
            _ if now => out.push(Usable { from_deg: phi, to_deg: phi }),
            _ => {}
        }
        before = now;
    }
    out
}

/// Ranges in which tilting the camera has no effect: in the camera's frame plateaus, before the first preset and, without `follow`, after the last.
fn still(document: &PresetDocument) -> Vec<Usable> {
    if document.frame == BendFrame::Plane {
        return Vec::new();
    }
    let sorted = document.sorted();
    let last = sorted.len().saturating_sub(1);
    let plateau = |(i, preset): (usize, &&belvedere_core::presets::Preset)| {
        let shrink = |other: Option<&&belvedere_core::presets::Preset>| {
            other.map_or(1.0, |o| {
                let (gap, both) = ((o.phi - preset.phi).abs(), o.tau + preset.tau);
                if both >= gap { 0.98 * gap / both } else { 1.0 }
            })
        };
        let below = preset.tau * shrink(i.checked_sub(1).and_then(|k| sorted.get(k)));
        let above = preset.tau * shrink(sorted.get(i + 1));
        let from = if i == 0 { 0.0 } else { (preset.phi - below).max(0.0) };
        let to = if i == last && !document.follow { 90.0 } else { (preset.phi + above).min(90.0) };
        (to > from).then_some(Usable { from_deg: from, to_deg: to })
    };
    sorted.iter().enumerate().filter_map(plateau).collect()
}
