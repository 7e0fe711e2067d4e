//! The certificate of a written elevation model: lines of sight that are checked against the file alone.

use super::written_ground::HeightsToWrite;
use crate::BelvedereError;
use belvedere_core::View;
use belvedere_disocclusion::TerrainSolver;
use belvedere_disocclusion::report::CertifiedLine;
use belvedere_io::atomic::contents_of;
use belvedere_io::raster::Raster;
use belvedere_io::sha256_of_file;
use belvedere_io::terrain::OriginalTerrain;
use belvedere_scene::Scene;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::Path;

/// Lines of a certificate at most, about.
const MOST_LINES: usize = 5000;
/// Height by which the ground may rise over a line that counts as clear, metres: heights are written as 32-bit numbers.
const TOLERANCE_M: f64 = 0.01;

/// Content of a certificate.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub(super) struct Certificate {
    program: String,
    /// Name of the elevation model, and its SHA-256.
    file: String,
    sha256: String,
    /// Columns and rows of its samples.
    samples: [usize; 2],
    /// Corners between which cells are cut into two flat triangles.
    diagonal: &'static str,
    /// Height by which the ground may rise over a line that counts as clear, metres.
    tolerance_m: f64,
    /// Visible share of what the lines stand for that is claimed, 0..=1: the least of lines by length, areas by area and points by number.
    visible_share: f64,
    lines: Vec<CertifiedLine>,
}

/// What a certificate is made of, besides the written heights.
pub(super) struct Evidence {
    pub(super) original: OriginalTerrain,
    pub(super) solver: TerrainSolver,
    /// The level camera, without the displacement.
    pub(super) view: View,
}

impl Certificate {
    /// * `out`: the written file; `visible`: share that is claimed.
    pub(super) fn of(
        (scene, heights): (&Scene, &Raster),
        to_write: &HeightsToWrite<'_>,
        evidence: &Evidence,
        (out, visible_share): (&Path, f64),
    ) -> Result<Self, BelvedereError> {
        let grid = to_write.grid()?;
        let lines = grid.lines((scene, &evidence.view), &evidence.solver, heights, MOST_LINES)?;
        Ok(Self {
            program: format!("belvedere {}", crate::VERSION),
            file: out.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            sha256: sha256_of_file(&contents_of(out))?,
            samples: grid.nodes(),
            diagonal: "north-west to south-east",
            tolerance_m: TOLERANCE_M,
            visible_share,
            lines,
        })
    }
}
