//! From an intent to a view: what every constructor has in common.

use crate::ConstructError;
use crate::reveal::{Goal, RevealMemory, RevealOptions, reveal};
use belvedere_core::{Stage, View};
use belvedere_disocclusion::{TerrainMemory, TerrainSolver};
use belvedere_scene::{Progress, Scene};

/// What a constructor came to.
#[derive(Debug, Clone)]
pub struct Constructed {
    /// The view, with the stages that were made.
    pub view: View,
    /// Whether what was wanted is reached; missing it is a result, not an error.
    pub goal: Goal,
    /// Oddities, one sentence each.
    pub warnings: Vec<String>,
}

/// Turns an intent into stages of a view.
pub trait Constructor {
    /// What is remembered between frames, and nowhere else: same inputs and same memory, same result.
    type Memory: Default;

    /// Makes stages for `scene` in the picture of `base`.
    ///
    /// # Errors
    /// [`ConstructError`] if no view is possible at all.
    fn construct(
        &self,
        scene: &Scene,
        base: &View,
        memory: &mut Self::Memory,
        progress: &Progress,
    ) -> Result<Constructed, ConstructError>;
}

/// A spline bend for the camera of `base`; other stages but the earth's curvature are left out.
impl Constructor for RevealOptions {
    type Memory = RevealMemory;

    fn construct(
        &self,
        scene: &Scene,
        base: &View,
        memory: &mut RevealMemory,
        progress: &Progress,
    ) -> Result<Constructed, ConstructError> {
        let found = reveal(scene, Some(base), self, memory, progress)?;
        Ok(Constructed { view: found.view, goal: found.report.goal, warnings: found.report.warnings })
    }
}

/// Terrain that makes way, before the later stages of `base` and seen through them.
impl Constructor for TerrainSolver {
    type Memory = TerrainMemory;

    fn construct(
        &self,
        scene: &Scene,
        base: &View,
        memory: &mut TerrainMemory,
        progress: &Progress,
    ) -> Result<Constructed, ConstructError> {
        let solved = self.solve(scene, base, memory, progress)?;
        let ground = Stage::TerrainDisocclusion(solved.stage);
        let rank = ground.rank();
        let mut stages: Vec<Stage> = base.stages().iter().filter(|s| s.rank() != rank).cloned().collect();
        stages.insert(stages.iter().take_while(|s| s.rank() < rank).count(), ground);
        let report = &solved.report;
        let goal = if report.metrics.visible < 1.0 {
            let percent = 100.0 * report.metrics.visible;
            Goal::Missed(vec![format!(
                "{percent:.2} % of {} reference points are visible, all were wanted",
                report.points
            )])
        } else {
            Goal::Reached
        };
        Ok(Constructed { view: View::new(base.pinhole().clone(), stages)?, goal, warnings: Vec::new() })
    }
}
