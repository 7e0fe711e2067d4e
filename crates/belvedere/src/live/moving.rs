//! Drawing of moving pictures.

use super::rate::Quality;
use crate::{BelvedereError, Session, fallback, kept};
use belvedere_core::View;
use belvedere_io::budget;
use belvedere_overlay::{grid, widths};
use belvedere_scene::{Compositing, Frame, Instant, Layer, Progress, RenderJob, RenderOptions, Scene, Stylisation};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

/// Detail of moving pictures from which on edges and shades are left out, and shadows of models.
const UNSTYLED: u8 = 1;
const UNSHADED: u8 = 2;

/// Progress that is cancelled after a time, or with `progress`.
pub(super) fn within(limit: Duration, progress: &Progress) -> Progress {
    let (began, outer) = (Instant::now(), progress.unheard());
    let own: Arc<OnceLock<Arc<AtomicBool>>> = Arc::default();
    let flag = own.clone();
    let limited = Progress::new(move |_, _| {
        if (began.elapsed() > limit || outer.is_cancelled())
            && let Some(flag) = flag.get()
        {
            flag.store(true, Ordering::Relaxed);
        }
    });
    let _ = own.set(limited.cancel_flag());
    limited
}

/// Draws with one sample per pixel, level of detail, and no marks that need further pictures.
///
/// * `scene`: the session's scene for pictures of this quality.
/// * `density`: pixels of the full picture per point of the screen.
pub(super) fn quick(
    session: &Session,
    scene: &Scene,
    view: &View,
    (quality, density): (Quality, f64),
    progress: &Progress,
) -> Result<Frame, BelvedereError> {
    let mut options = RenderOptions {
        samples: 1,
        lod_px: quality.ground_px(),
        tolerance_px: quality.edge_px(),
        stylisation: session.resolved.stylisation,
        max_bytes: session.bytes_for_picture(budget::bytes()),
        ..RenderOptions::default()
    };
    if quality.coarseness() >= UNSTYLED {
        // Representations that are drawn one by one take a picture each.
        (options.stylisation, options.compositing) = (Stylisation::default(), Compositing::Dither);
    }
    let mut light = *session.light();
    let casts = |layer: &Layer| layer.kind.boxes().is_some() || layer.kind.triangles().is_some();
    if quality.coarseness() >= UNSHADED && light.altitude > 0.0 && scene.layers.iter().any(casts) {
        light.shadows = false;
    }
    let plan = if view.is_bent() { fallback::of_session(session, view, None)? } else { None };
    let scene = plan.as_ref().map_or(scene, |plan| plan.scene());
    let grid = grid::wanted(scene, grid::stated(&session.resolved.overlay));
    options.overlay.under.extend(grid.into_iter().map(|line| widths::line(line, quality.width() * density)));
    let draw = |scene: &Scene, view: &View| {
        let job = RenderJob { scene, view, light: &light, options: &options, progress };
        let before = budget::held();
        let frame = session.renderer(&crate::RendererName::AUTO)?.render(&job)?;
        session.kept.drawn([before, budget::held()], kept::bytes_of(&frame));
        Ok::<_, BelvedereError>(frame)
    };
    match &plan {
        Some(plan) => plan.draw(view, &draw).map(|picture| picture.frame),
        None => draw(scene, view),
    }
}
