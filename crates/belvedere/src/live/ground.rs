//! Ground that makes way while something moves: solved beside the drawing.

use crate::session::Resolved;
use crate::{BelvedereError, Session};
use belvedere_core::{Stage, View};
#[cfg(not(target_family = "wasm"))]
use belvedere_scene::Scene;
#[cfg(not(target_family = "wasm"))]
use std::sync::Arc;

/// Displaced ground during a motion.
#[derive(Debug, Default)]
pub(super) struct Ground {
    #[cfg(not(target_family = "wasm"))]
    live: Option<(crate::scene_file::TerrainStageDoc, Arc<Scene>, belvedere_disocclusion::LiveTerrain)>,
    /// That of the last picture at rest.
    pub(super) last: Option<Stage>,
}

impl Ground {
    /// The newest solved ground for the view of a session without displaced ground; before the first one that of the last picture
    /// at rest.
    #[cfg(not(target_family = "wasm"))]
    pub(super) fn under(&mut self, session: &Session) -> Result<Option<Stage>, BelvedereError> {
        use belvedere_disocclusion::{LiveTerrain, TerrainSolver};
        let Some(stated) = session.stated_terrain() else { return Ok(None) };
        let fits = |(doc, scene, _): &(_, Arc<Scene>, _)| *doc == stated && Arc::ptr_eq(scene, &session.loaded.scene);
        if !self.live.as_ref().is_some_and(fits) {
            let solver = TerrainSolver::new(session.terrain_settings()?)?;
            self.live =
                Some((stated, session.loaded.scene.clone(), LiveTerrain::apart(solver, session.loaded.scene.clone())));
        }
        let Some((.., live)) = &mut self.live else { return Ok(None) };
        Ok(live.newest(session.view())?.map(Stage::TerrainDisocclusion).or_else(|| self.last.clone()))
    }

    /// The ground of the last picture at rest: there is no thread to solve in the background.
    #[cfg(target_family = "wasm")]
    pub(super) fn under(&mut self, _: &Session) -> Result<Option<Stage>, BelvedereError> {
        Ok(self.last.clone())
    }
}

/// The session with a stage of displaced ground in its chain.
pub(super) fn with_ground(session: Session, ground: Stage) -> Result<Session, BelvedereError> {
    let (pinhole, mut stages) = (session.view().pinhole().clone(), session.view().stages().to_vec());
    let at = stages.iter().take_while(|stage| stage.rank() < ground.rank()).count();
    stages.insert(at, ground);
    let view = View::new(pinhole, stages).map_err(|e| BelvedereError::Setting(e.to_string()))?;
    Ok(Session { resolved: Resolved { view, ..session.resolved }, ..session })
}
