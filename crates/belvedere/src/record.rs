//! Origin of a picture: input files, and the camera in numbers.

use crate::BelvedereError;
use belvedere_core::{Projection, View};
pub use belvedere_io::InputFile;
pub use belvedere_resolve::AreaRecord;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The record of every file, in order, each once.
///
/// # Errors
/// [`BelvedereError::Io`] for a file that was read twice and had changed in between.
pub(crate) fn inputs(files: &[InputFile]) -> Result<Vec<InputFile>, BelvedereError> {
    let mut out: Vec<InputFile> = Vec::with_capacity(files.len());
    for file in files {
        match out.iter().find(|known| known.path == file.path) {
            None => out.push(file.clone()),
            Some(known) if known == file => {}
            Some(_) => {
                let reason = "it changed while it was being read; let its writer finish and run this again";
                return Err(belvedere_io::IoError::format(&file.path, reason).into());
            }
        }
    }
    Ok(out)
}

/// The pinhole in numbers.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct ViewRecord {
    /// Eye, scene coordinates.
    pub eye: [f64; 3],
    /// Unit vector along the optical axis.
    pub forward: [f64; 3],
    /// Unit vector towards larger pixel x.
    pub right: [f64; 3],
    /// Unit vector towards larger pixel y.
    pub down: [f64; 3],
    /// Full vertical field of view, degrees; `None` if orthographic.
    pub fov_y_deg: Option<f64>,
    /// Pixels per unit tangent, or per scene unit if orthographic.
    pub scale_px: f64,
    /// Width and height, pixels.
    pub image: [u32; 2],
    /// Viewing angle over level ground, degrees.
    pub pitch_deg: f64,
}

impl ViewRecord {
    /// The record of a view's pinhole.
    pub fn of(view: &View) -> Self {
        let p = view.pinhole();
        Self {
            eye: p.eye.to_array(),
            forward: p.forward.to_array(),
            right: p.right.to_array(),
            down: p.down.to_array(),
            fov_y_deg: match p.projection {
                Projection::Perspective { fov_y } => Some(fov_y.to_degrees()),
                Projection::Orthographic { .. } => None,
            },
            scale_px: p.scale_px(),
            image: p.image,
            pitch_deg: (-p.forward.z).clamp(-1.0, 1.0).asin().to_degrees(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn a_file_that_changed_between_two_readings_is_refused() {
        let [a, b, changed] =
            [("a", "1"), ("b", "1"), ("a", "2")].map(|(p, c)| InputFile::of(Path::new(p), c.as_bytes()));
        assert_eq!(inputs(&[b.clone(), a.clone(), b.clone()]).expect("unchanged"), [b, a.clone()]);
        let refused = inputs(&[a, changed]).expect_err("changed").to_string();
        assert!(refused.starts_with("a: it changed while it was being read"), "{refused}");
    }
}
