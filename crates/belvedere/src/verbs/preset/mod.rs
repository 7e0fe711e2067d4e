//! `preset`: lists, reads, edits, checks and plots preset documents.

mod check;
mod plot;
mod sketch;

pub use check::{PresetCheck, Usable, Verdict, check};
pub use plot::{Plot, plot};
pub use sketch::{Sketch, SketchPoint, SketchTag, sketch};

use crate::scene_file;
use crate::scene_file::DocumentKind;
use crate::{BelvedereError, output};
use belvedere_core::map::spline::{ReferencePlane, SplineBend};
use belvedere_core::presets::edit::{Clamped, PresetOperation};
use belvedere_core::presets::{BUILTINS, PresetDocument, PresetError};
use belvedere_core::{DVec3, Pinhole, Projection};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::Path;

/// Distance from the eye to the pivot in plots and checks, scene units: that of the figures in the documentation.
const DISTANCE: f64 = 1000.0;
/// Vertical field of view of the camera of plots and checks, degrees.
const FOV_Y_DEG: f64 = 50.0;

/// Heights beyond this do not count as limits: straight curves bend only by rounding.
const NO_LIMIT: f64 = 1e3 * DISTANCE;

/// A built-in document at its own viewing angle.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct Listed {
    /// Name.
    pub name: &'static str,
    /// Other names.
    pub aliases: &'static [&'static str],
    /// Description of the effect.
    pub effect: &'static str,
    /// Its presets.
    pub presets: Vec<Shape>,
}

/// The curve of a preset in figures.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct Shape {
    /// Name, possibly empty.
    pub name: String,
    /// Viewing angle, degrees.
    pub phi: f64,
    /// Slope at the near end, the pivot and the far end, degrees.
    pub slopes_deg: [f64; 3],
    /// Length, curve units.
    pub length: f64,
    /// Smallest sine of the angle under which the ground is seen; it must be above 0.
    pub facing: f64,
    /// Heights within which nothing folds if the eye is 1000 scene units from the pivot; null where there is no limit.
    pub fold_heights: [Option<f64>; 2],
}

/// The document of a file, or a built-in one by name or alias.
///
/// A built-in name means the built-in document, even if a file or folder has the same name; `./demo` means the file.
///
/// # Errors
/// [`BelvedereError::Document`], [`BelvedereError::Io`], [`BelvedereError::Preset`].
pub fn load(source: &str) -> Result<PresetDocument, BelvedereError> {
    let path = Path::new(source);
    if !scene_file::names_a_preset_file(source) {
        match PresetDocument::builtin(source) {
            Ok(document) => return Ok(document),
            Err(_) if belvedere_io::fs::metadata(path).is_ok_and(|m| m.is_file()) => {}
            Err(PresetError::UnknownName { name }) => {
                return Err(BelvedereError::Builtin(scene_file::no_preset(&name)));
            }
            Err(e) => return Err(e.into()),
        }
    }
    let read = scene_file::read_text(path).and_then(|(text, _)| scene_file::parse_presets(path, &text));
    let document = read.map_err(|e| scene_file::other_kind::explained(path, DocumentKind::Presets, e))?;
    document.validate().map_err(|e| scene_file::DocError::whole(e.to_string()).in_file(path))?;
    Ok(document)
}

/// Text of a document for a file with this name: JSON for `.json`, else TOML.
///
/// # Errors
/// [`BelvedereError::Text`], which no document gives.
pub fn text(document: &PresetDocument, path: &Path) -> Result<String, BelvedereError> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")) {
        return output::pretty(document);
    }
    toml::to_string(document).map_err(|e| BelvedereError::Text { what: "the preset document", reason: e.to_string() })
}

/// The document after all operations (all of them or none), and notes on values that were limited.
///
/// # Errors
/// [`BelvedereError::PresetEdit`].
pub fn set(
    document: &PresetDocument,
    operations: &[PresetOperation],
) -> Result<(PresetDocument, Vec<Clamped>), BelvedereError> {
    let mut clamped = Vec::new();
    let mut document = document.clone();
    for operation in operations {
        let (next, said) = document.edited_saying(operation)?;
        document = next;
        clamped.extend(said);
    }
    Ok((document, clamped))
}

/// The built-in documents.
///
/// # Errors
/// [`BelvedereError::Preset`], which no built-in gives.
pub fn list() -> Result<Vec<Listed>, BelvedereError> {
    let listed = |b: &belvedere_core::presets::Builtin| {
        let presets = shapes(&PresetDocument::builtin(b.name)?);
        Ok(Listed { name: b.name, aliases: b.aliases, effect: b.effect, presets })
    };
    BUILTINS.iter().map(listed).collect()
}

fn shapes(document: &PresetDocument) -> Vec<Shape> {
    document.sorted().iter().filter_map(|p| Some(Shape::of(&p.name, &seen_at(document, p.phi)?.1))).collect()
}

impl Shape {
    fn of(name: &str, bend: &SplineBend) -> Self {
        let curve = bend.curve();
        let slope = |l: f64| curve.at(l).1.to_angle().to_degrees();
        let pivot = bend.coordinates(bend.pivot()).l;
        Self {
            name: name.to_owned(),
            // Avoids a negative zero.
            phi: bend.resolved().phi_deg + 0.0,
            slopes_deg: [0.0, pivot, curve.length()].map(slope),
            length: curve.length(),
            facing: bend.facing(),
            fold_heights: bend.fold_heights().map(|h| Some(h).filter(|h| h.abs() < NO_LIMIT)),
        }
    }
}

/// The document for a camera at a viewing angle, [`DISTANCE`] from the pivot.
fn seen_at(document: &PresetDocument, phi_deg: f64) -> Option<(Pinhole, SplineBend)> {
    seen_from(document, phi_deg, DISTANCE)
}

/// The same for any distance, scene units.
fn seen_from(document: &PresetDocument, phi_deg: f64, distance: f64) -> Option<(Pinhole, SplineBend)> {
    let (sin, cos) = phi_deg.to_radians().sin_cos();
    let (eye, up) = (distance * DVec3::new(0.0, -cos, sin), DVec3::new(0.0, sin, cos));
    let screen = Projection::Perspective { fov_y: FOV_Y_DEG.to_radians() };
    let camera = Pinhole::look_at(eye, DVec3::ZERO, up, screen, [1280, 720], 1.0, None).ok()?;
    let bend = SplineBend::new(&camera, document, &ReferencePlane::level(0.0), DVec3::ZERO).ok()?;
    Some((bend.adapted_pinhole(&camera), bend))
}

/// The viewing angle of a scene's camera over its reference plane, degrees, for which a preset can be made.
///
/// # Errors
/// [`BelvedereError::Setting`] for scenes without a spline bend.
pub fn viewing_angle(session: &crate::Session) -> Result<f64, BelvedereError> {
    let bend = session.view().stages().iter().find_map(|s| match s {
        belvedere_core::Stage::SplineBend(bend) => Some(bend),
        _ => None,
    });
    bend.map(|b| b.resolved().phi_deg).ok_or_else(|| {
        BelvedereError::Setting(
            "the scene has no spline_bend stage, whose plane and camera give the viewing angle".into(),
        )
    })
}
