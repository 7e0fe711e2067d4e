//! Built-in preset documents.

use super::{BendFrame, DepthUnits, Ease, Preset, PresetDocument, PresetError, names::BUILTINS, one_section};
use crate::sections::TagPoint;
use glam::DVec2;

/// Field of view that passes for a parallel projection, degrees: heights of a twentieth of the distance to the pivot lean by 0.04 of 720 pixels.
const PARALLEL_FOV_DEG: f64 = 0.1;

impl PresetDocument {
    /// A built-in document by name or alias, see [`BUILTINS`]. Underscores and hyphens are the same.
    ///
    /// Source of the curves: ours, after the figures of Pasewaldt et al. 2011 (which print no control points).
    ///
    /// # Errors
    /// [`PresetError::UnknownName`]; [`PresetError::Range`] for an angle outside -90..=90.
    ///
    /// ```
    /// use belvedere_core::presets::PresetDocument;
    /// let document = PresetDocument::builtin("progressive")?;
    /// assert_eq!(document.presets[0].phi, 40.0);
    /// # Ok::<(), belvedere_core::presets::PresetError>(())
    /// ```
    pub fn builtin(name: &str) -> Result<Self, PresetError> {
        let key = name.trim().replace('_', "-");
        let named = BUILTINS.iter().find(|b| b.aliases.contains(&key.as_str()));
        let document = match named.map_or(key.as_str(), |b| b.name) {
            "progressive" => document(vec![progressive(40.0)]),
            "degressive" => document(vec![degressive(25.0)]),
            "hybrid-flat-steep-flat" => document(vec![flat_steep_flat()]),
            "hybrid-steep-flat-steep" => document(vec![steep_flat_steep()]),
            "map" => document(vec![map()]),
            "identity" => Self { frame: BendFrame::Plane, ..document(vec![straight(0.0)]) },
            "demo" => demo(),
            "demo-orthographic" => {
                let mut document = demo();
                if let Some(map) = document.presets.iter_mut().find(|p| p.name == "high") {
                    map.fov_y_deg = Some(PARALLEL_FOV_DEG);
                }
                document
            }
            _ => document(vec![straight(angle_of(&key).ok_or(PresetError::UnknownName { name: name.to_owned() })?)]),
        };
        document.validate()?;
        Ok(document)
    }
}

fn angle_of(key: &str) -> Option<f64> {
    key.strip_prefix("identity(")?.strip_suffix(')')?.trim().parse().ok()
}

fn document(presets: Vec<Preset>) -> PresetDocument {
    PresetDocument {
        version: PresetDocument::VERSION,
        frame: BendFrame::Camera,
        units: DepthUnits::Distance,
        pin: true,
        ease: Ease::Linear,
        follow: true,
        presets,
    }
}

fn preset(name: &str, phi: f64, [s, e]: [f64; 2], control: &[[f64; 2]]) -> Preset {
    Preset {
        name: name.to_owned(),
        phi,
        tau: 0.0,
        s,
        e,
        a: 0.1,
        b: 0.6,
        control: control.to_vec(),
        angles: None,
        knots: None,
        tags: Vec::new(),
        sections: one_section(),
        fov_y_deg: None,
    }
}

/// Steep in front, flat behind: a map in the foreground under a horizon.
fn progressive(phi: f64) -> Preset {
    preset("progressive", phi, [0.5, 1.9], &[[0.0, -0.42], [0.17, -0.08], [0.42, 0.03], [1.0, 0.20]])
}

/// Flat in front, steep behind: a close view in front of a map of what lies ahead.
fn degressive(phi: f64) -> Preset {
    preset("degressive", phi, [0.4, 1.6], &[[0.0, -0.22], [0.45, -0.12], [0.80, 0.05], [0.98, 0.62]])
}

fn flat_steep_flat() -> Preset {
    let control = [[0.0, -0.26], [0.26, -0.19], [0.26, -0.19], [0.46, 0.08], [0.46, 0.08], [1.0, 0.24]];
    preset("hybrid-flat-steep-flat", 35.0, [0.4, 1.6], &control)
}

fn steep_flat_steep() -> Preset {
    let control = [[0.0, -0.45], [0.20, -0.10], [0.20, -0.10], [0.80, 0.12], [0.80, 0.12], [1.0, 0.55]];
    preset("hybrid-steep-flat-steep", 35.0, [0.4, 1.6], &control)
}

/// A plane seen under 80 degrees.
fn map() -> Preset {
    let run = 0.6 / 80f64.to_radians().tan();
    let control = [0.0, 1.0, 2.0, 3.0].map(|i| [0.4 + i * run, -0.9 + i * 0.6]);
    preset("map", 80.0, [0.4, 1.6], &control)
}

/// A straight curve of slope `phi`: the ordinary perspective at that viewing angle.
fn straight(phi: f64) -> Preset {
    let (sin, cos) = phi.to_radians().sin_cos();
    let control = [-0.5, -0.5 + 1.0 / 3.0, 0.5 - 1.0 / 3.0, 0.5].map(|l| [0.5 + l * cos, l * sin]);
    preset("identity", phi, [0.4, 1.6], &control)
}

/// A curve for level views: the degressive one, turned down by 10 degrees; a hundredth larger, for curves between turned ones are smaller
/// and would fold at lower heights.
fn horizon() -> Preset {
    let low = degressive(25.0);
    let turn = DVec2::from_angle(-10f64.to_radians());
    let control = low.control.iter().map(|p| (1.01 * turn.rotate(DVec2::from(*p))).to_array()).collect();
    Preset { name: "horizon".into(), phi: 0.0, control, ..low }
}

/// A plane seen under 80 degrees; its control points are placed so that the interpolation from the progressive curve is even.
fn even_map() -> Preset {
    let along = DVec2::from_angle(80f64.to_radians());
    let control = [-0.34, 0.31, 0.43, 0.85].map(|l| (DVec2::X * 0.7 + l * along).to_array());
    preset("map", 80.0, [0.2, 1.4], &control)
}

/// Three presets and one for level views, with levels of abstraction `loa0` (detailed) to `loa2`.
///
/// They hold at their angles alone (tau 0): a picture that does not change over a range of angles turns faster beside it. Angles and
/// control points are such that the picture changes about as fast at every angle; a test over all angles keeps it so.
fn demo() -> PresetDocument {
    let styled = |name: &str, preset: Preset, sections: [&str; 3], borders: [[f64; 2]; 2]| Preset {
        name: name.to_owned(),
        tags: borders.map(|[u, delta]| TagPoint { u, delta }).to_vec(),
        sections: sections.map(str::to_owned).to_vec(),
        ..preset
    };
    let thirds = [1.0, 2.0].map(|i| [i / 3.0, 0.05]);
    let levels = ["loa0", "loa1", "loa2"];
    document(vec![
        styled("low", degressive(25.0), levels, thirds),
        styled("medium", progressive(50.0), levels, thirds),
        styled("high", even_map(), ["loa1", "loa1", "loa2"], [[0.5, 0.05], [0.85, 0.025]]),
        styled("horizon", horizon(), levels, thirds),
    ])
}
