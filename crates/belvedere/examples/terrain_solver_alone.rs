//! The terrain solver without scene file, session or picture: computes where and how far the ground moves.

use belvedere::builtin::massif;
use belvedere::core::{DVec3, Pinhole, Projection, View};
use belvedere::disocclusion::{TerrainMemory, TerrainReport, TerrainSettings, TerrainSolver};
use belvedere::scene::Progress;

/// Solves for the trail of a generated massif of `nodes` x `nodes` nodes.
pub fn run(nodes: usize) -> Result<TerrainReport, Box<dyn std::error::Error>> {
    let (scene, camera) = massif(7, nodes)?;
    let lens = Projection::Perspective { fov_y: camera.fov_y };
    let pinhole = Pinhole::look_at(camera.eye, camera.look_at, DVec3::Z, lens, [640, 360], 1.0, None)?;
    let solver = TerrainSolver::new(TerrainSettings::default())?;
    let mut memory = TerrainMemory::default();
    let solved = solver.solve(&scene, &View::straight(pinhole), &mut memory, &Progress::silent())?;
    Ok(solved.report)
}

#[allow(clippy::print_stdout, reason = "a program, not a library")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let report = run(257)?;
    println!(
        "{} points: {:.1} % visible before, {:.1} % after; the ground moves by {:.1} m rms, {:.1} m at most",
        report.points,
        100.0 * report.visible_dense_before,
        100.0 * report.metrics.visible_dense,
        report.metrics.rms_m,
        report.metrics.max_m
    );
    Ok(())
}
