//! Sessions bent by preset documents, and their curves as panels.

use crate::easel::Easel;
use crate::sheet::Panel;
use anyhow::Result;
use belvedere::Session;
use belvedere::core::map::spline::{ReferencePlane, SplineBend, default_pivot};
use belvedere::core::presets::PresetDocument;
use belvedere::core::{Stage, View};
use belvedere::scene::Frame;
use belvedere::verbs::preset::{self, Plot};

/// Size of the panels: that of plots of presets.
pub(super) const TILE: [u32; 2] = [720, 600];

/// A built-in document after operations, see `preset set`.
pub(super) fn document(name: &str, operations: &[&str]) -> Result<PresetDocument> {
    let operations = operations.iter().map(|text| text.parse()).collect::<Result<Vec<_>, _>>()?;
    Ok(preset::set(&PresetDocument::builtin(name)?, &operations)?.0)
}

/// Operations that divide a preset of one section into three equal ones.
pub(super) const IN_THREE: [&str; 7] = [
    "1.split=1",
    "1.split=2",
    "1.tag.1=0.333",
    "1.tag.2=0.667",
    "1.section.1=loa0",
    "1.section.2=loa1",
    "1.section.3=loa2",
];

/// The session bent by a document over level ground at `height`.
pub(super) fn bent(session: &Session, document: &PresetDocument, height: f64) -> Result<Session> {
    let pinhole = session.view().pinhole();
    let plane = ReferencePlane::level(height);
    let bend = SplineBend::new(pinhole, document, &plane, default_pivot(pinhole, &plane))?;
    let view = View::new(bend.adapted_pinhole(pinhole), vec![Stage::SplineBend(bend)])?;
    Ok(session.clone().with_view(view))
}

/// A panel of the session bent by a document.
pub(super) fn panel(
    easel: &Easel<'_>,
    session: &Session,
    document: &PresetDocument,
    height: f64,
    title: &str,
) -> Result<Panel> {
    let session = bent(session, document, height)?;
    let note = session.view().stages().iter().find_map(|s| match s {
        Stage::SplineBend(bend) => Some(format!(
            "viewing angle {:.0}°, ground seen under {:.0}° near and {:.0}° far",
            bend.resolved().phi_deg,
            bend.curve().at(0.0).1.to_angle().to_degrees(),
            bend.curve().at(bend.curve().length()).1.to_angle().to_degrees()
        )),
        _ => None,
    });
    easel.panel(&session, title, note.unwrap_or_default())
}

/// The curve of a document at a viewing angle.
pub(super) fn curve(document: &PresetDocument, phi_deg: f64, title: &str) -> Panel {
    let Plot { pixels, width } = preset::plot(document, Some(phi_deg));
    let frame = Frame { width, height: pixels.len() / width, color: pixels, ..Frame::default() };
    Panel {
        title: title.into(),
        note: "curve, control points, tag points and the eye with its field of view".into(),
        frame,
    }
}
