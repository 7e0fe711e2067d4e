//! `bench`: cost of bends, anti-aliasing and level of detail on this machine.
//!
//! Cases are drawn in turn, forth and back, so that a busy machine disturbs all of them alike; ratios are medians of ratios of
//! frames of one round. Processor time of all threads counts where the system tells it (Linux), wall time elsewhere.

mod against;
pub mod clock;
pub mod collection;
pub mod dragging;
mod flight;
mod frames;
mod over_collection;
pub mod scene;
pub mod sizes;
mod smooth;
pub mod volume;
mod vtk;

pub use flight::FlightCost;
pub use frames::{FrameCost, Growth, ProjectionCost};
pub use over_collection::{CollectionReport, CollectionRequest, SceneCost, bench_collection};
pub use smooth::{SmoothCost, SparseCost};

use anyhow::{Result, ensure};
use belvedere::scene::Progress;
use flight::fly;
use frames::{Case, grow_pixels, grow_triangles, grow_turns, measure, project};
use scene::{ground, views};
use schemars::JsonSchema;
use serde::Serialize;
use smooth::smooth;

/// Pictures of a flight per round.
const FLIGHT: usize = 8;

/// What to measure.
#[derive(Debug, Clone, PartialEq)]
pub struct BenchRequest {
    /// Times that every case is drawn, one more to warm up.
    pub rounds: usize,
    /// Nodes along a side of the ground.
    pub nodes: usize,
    /// Size of the picture.
    pub image: [u32; 2],
    /// Worker threads; 0 = all cores.
    pub threads: usize,
}

impl Default for BenchRequest {
    fn default() -> Self {
        Self { rounds: 7, nodes: 1025, image: [1280, 720], threads: 0 }
    }
}

/// The measurements.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct BenchReport {
    /// Program and version.
    pub program: String,
    /// Processor, as the system names it.
    pub processor: String,
    /// Worker threads used.
    pub threads: usize,
    /// What is measured as `cpu_ms`.
    pub clock: &'static str,
    /// Load average of the system over the last minute, before and after; `None` where the system does not tell.
    pub load: [Option<f64>; 2],
    /// Nodes along a side of the ground.
    pub nodes: usize,
    /// Size of the picture.
    pub image: [u32; 2],
    /// Rounds.
    pub rounds: usize,
    /// Frames.
    pub frames: Vec<FrameCost>,
    /// Projection alone.
    pub projection: Vec<ProjectionCost>,
    /// A flight over terrain that is solved for every picture, or in the background.
    pub flight: Vec<FlightCost>,
    /// The smooth pass of terrain disocclusion by cosine transforms, and by the paper's factorisation.
    pub smooth: Vec<SmoothCost>,
    /// Growth.
    pub growth: Vec<Growth>,
}

/// Measures.
///
/// # Errors
/// A request out of range, a renderer or solver that fails, cancellation.
pub fn bench(request: &BenchRequest, progress: &Progress) -> Result<BenchReport> {
    let BenchRequest { rounds, nodes, threads, .. } = *request;
    ensure!(
        (33..=8193).contains(&nodes) && (1..=1000).contains(&rounds),
        "a ground of {nodes} x {nodes} nodes and {rounds} rounds: give 33..=8193 nodes and 1..=1000 rounds"
    );
    // One pool for all frames: the processor time of threads that have ended is lost.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    pool.install(|| report(request, progress))
}

fn report(request: &BenchRequest, progress: &Progress) -> Result<BenchReport> {
    let BenchRequest { rounds, nodes, image, .. } = *request;
    let before = clock::load();
    let scene = ground(nodes)?;
    let views = views(image)?;
    let mut cases = Vec::new();
    for (lod_px, samples) in [(0.0, 1), (0.0, 4), (0.5, 1), (0.5, 4)] {
        cases.extend(views.iter().map(|(name, view)| Case { name, scene: &scene, view, samples, lod_px }));
    }
    let frames = measure(&cases, rounds, progress)?;
    let growth = vec![
        grow_triangles(request, &views[1].1, 0.0, progress)?,
        grow_triangles(request, &views[1].1, 0.5, progress)?,
        grow_pixels(request, &scene, progress)?,
        grow_turns(request, &scene, 0.0, progress)?,
        grow_turns(request, &scene, 0.5, progress)?,
    ];
    Ok(BenchReport {
        program: format!("belvedere {}", belvedere::VERSION),
        processor: clock::processor(),
        threads: rayon::current_num_threads(),
        clock: clock::name(),
        load: [before, clock::load()],
        nodes,
        image,
        rounds,
        frames,
        projection: project(&views, rounds)?,
        flight: fly(nodes, image, FLIGHT * rounds)?,
        smooth: smooth(nodes, rounds)?,
        growth,
    })
}

impl std::fmt::Display for BenchReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [w, h] = self.image;
        let load = self.load.map(|l| l.map_or_else(|| "unknown".into(), |l| format!("{l:.1}")));
        writeln!(f, "{}, {}, {} threads, load {} to {}", self.program, self.processor, self.threads, load[0], load[1])?;
        let n = self.nodes;
        writeln!(f, "ground of {n} x {n} nodes, {w} x {h} pixels, {} rounds, cpu = {}\n", self.rounds, self.clock)?;
        writeln!(
            f,
            "{:<12} {:>7} {:>6} {:>10} {:>8} {:>8} {:>6}",
            "view", "samples", "lod", "triangles", "cpu ms", "wall ms", "ratio"
        )?;
        for c in &self.frames {
            let FrameCost { view, samples, lod_px, triangles, cpu_ms, wall_ms, ratio } = c;
            writeln!(
                f,
                "{view:<12} {samples:>7} {lod_px:>6.1} {triangles:>10} {cpu_ms:>8.1} {wall_ms:>8.1} {ratio:>6.2}"
            )?;
        }
        writeln!(f)?;
        for p in &self.projection {
            writeln!(
                f,
                "projection, {}: {:.0} million points per second and core ({} points)",
                p.view, p.mpts_per_core_s, p.points
            )?;
        }
        for cost in &self.flight {
            let FlightCost { method, pictures, points, ground_ms: [g50, g95], picture_ms: [p50, p95], lag, hidden } =
                cost;
            writeln!(
                f,
                "flight, {points:.0} points, {method}: ground after {g50:.1} ms (95 % {g95:.1}), picture after {p50:.1} ms \
                 (95 % {p95:.1}), {lag} pictures late at most, {:.1} % hidden at most ({pictures} pictures)",
                100.0 * hidden
            )?;
        }
        self.smooth.iter().try_for_each(|cost| writeln!(f, "{cost}"))?;
        for g in &self.growth {
            let at: Vec<String> = g.sizes.iter().zip(&g.cpu_ms).map(|(s, t)| format!("{s:.2e}: {t:.1}")).collect();
            writeln!(f, "growth with {}: exponent {:.2} (cpu ms at {})", g.of, g.exponent, at.join(", "))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_measurement_is_complete() {
        let request = BenchRequest { rounds: 1, nodes: 65, image: [64, 36], threads: 1 };
        let report = bench(&request, &Progress::silent()).unwrap();
        assert_eq!((report.frames.len(), report.projection.len(), report.growth.len()), (12, 2, 5));
        assert!(report.flight.iter().all(|f| f.pictures == FLIGHT && f.points > 1.0 && f.ground_ms[0] > 0.0));
        assert!((report.flight.len(), report.flight[0].lag) == (2, 0) && report.flight[0].hidden < 0.05);
        assert!(report.frames.iter().all(|c| c.cpu_ms > 0.0 && c.triangles > 0));
        assert!(report.frames[0].ratio == 1.0 && report.projection.iter().all(|p| p.mpts_per_core_s > 0.0));
        assert!(
            ["pixels", "turns"].iter().all(|of| report.to_string().contains(&format!("growth with {of}: exponent")))
        );
        let absurd = BenchRequest { nodes: 2, ..request };
        assert!(bench(&absurd, &Progress::silent()).unwrap_err().to_string().contains("33..=8193"));
    }
}
