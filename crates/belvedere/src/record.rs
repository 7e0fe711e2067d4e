//! Where a picture comes from: hashes of what was read.

use crate::BelvedereError;
use belvedere_core::{Projection, View};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::io::Read;
use std::path::{Path, PathBuf};

/// sha256 of a file, lower-case hexadecimal.
///
/// # Errors
/// [`BelvedereError::Io`].
pub(crate) fn sha256(path: &Path) -> Result<String, BelvedereError> {
    let os = |e| belvedere_io::IoError::os(path, e);
    let mut file = std::fs::File::open(path).map_err(os)?;
    let mut hasher = Sha256::new();
    let mut buffer = vec![0u8; 1 << 16];
    loop {
        let read = file.read(&mut buffer).map_err(os)?;
        if read == 0 {
            return Ok(hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect());
        }
        hasher.update(&buffer[..read]);
    }
}

/// sha256 of bytes, lower-case hexadecimal.
pub(crate) fn sha256_of(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// One file that was read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFile {
    /// Its path, as found.
    pub path: String,
    /// Its size, bytes.
    pub bytes: u64,
    /// Its sha256, hexadecimal.
    pub sha256: String,
}

/// The record of every file, in order, each once.
///
/// # Errors
/// [`BelvedereError::Io`].
pub(crate) fn inputs(paths: &[PathBuf]) -> Result<Vec<InputFile>, BelvedereError> {
    let mut seen = std::collections::HashSet::new();
    paths
        .iter()
        .filter(|p| seen.insert((*p).clone()))
        .map(|path| {
            let bytes = std::fs::metadata(path).map_err(|e| belvedere_io::IoError::os(path, e))?.len();
            Ok(InputFile { path: path.display().to_string(), bytes, sha256: sha256(path)? })
        })
        .collect()
}

/// What the areas of a layer are drawn as, and why.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AreaRecord {
    /// Id of the layer.
    pub layer: String,
    /// What covers them: water, forest, glacier, park, outline, plain.
    pub kind: &'static str,
    /// Number of areas.
    pub areas: usize,
    /// Who says so.
    pub why: String,
}

/// The pinhole in numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    /// NIST's long test vector, a million times the letter a: sixteen fillings of the buffer.
    #[test]
    fn the_whole_file_is_hashed() {
        let path = std::env::temp_dir().join(format!("belvedere_sha256_{}", std::process::id()));
        std::fs::write(&path, "a".repeat(1_000_000)).expect("written");
        let found = super::sha256(&path);
        std::fs::remove_file(&path).expect("removed");
        assert_eq!(found.expect("read"), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    }
}
