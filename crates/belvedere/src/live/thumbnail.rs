//! Small pictures of variants of a document, such as presets to choose from.

use super::moving::quick;
use super::rate::Quality;
use super::thin::Thin;
use crate::placed::Place;
use crate::scene_file::{Document, camera};
use crate::{BelvedereError, OpenOptions, Session};
use belvedere_resolve::solving::Memory;
use belvedere_scene::{Frame, LayerKind, Progress};
use std::sync::Arc;

/// Least width of a line, pixels.
const LEAST_PX: f64 = 1.2;

/// Draws small pictures of documents that have the layers of a session, which are not read again.
///
/// The pictures have one sample per pixel and lines as wide as their size asks for; ground that makes way and constructors are left out, for
/// they take long.
#[derive(Debug, Clone)]
pub struct Thumbnails {
    session: Session,
    options: OpenOptions,
    /// Width of the small picture as a share of that in which lines have their width.
    scale: f64,
}

impl Thumbnails {
    /// * `session`: it has the layers of all documents. `scale`: width of the small pictures in that of the usual one, above 0.
    pub fn new(session: &Session, place: &Place, scale: f64) -> Self {
        let options = OpenOptions { unsolved: true, ..place.options(&Progress::silent()) };
        Self { session: session.clone(), options, scale: scale.clamp(1e-3, 1.0) }
    }

    /// The picture of a document.
    ///
    /// * `image`: its size, pixels.
    ///
    /// # Errors
    /// As [`Session::from_document`] and [`Session::render`].
    pub fn draw(&self, document: &Document, image: [u32; 2], progress: &Progress) -> Result<Frame, BelvedereError> {
        let mut document = document.clone();
        document.constructor = None;
        camera::fit(&mut document, image);
        let session = self.session.edited(document, &self.options, &mut Memory::default())?;
        session.check_drawable()?;
        let mut scene = Thin::default().scene(session.loaded.scene.clone(), Quality::FULL, self.scale);
        if self.scale < 1.0 {
            // The rim of a line thinner than a pixel would be all that is seen of it.
            for layer in &mut Arc::make_mut(&mut scene).layers {
                match &mut layer.kind {
                    LayerKind::Line(line) => (line.casing, line.width_px) = (None, line.width_px.max(LEAST_PX)),
                    LayerKind::Point(point) => point.style.casing = None,
                    _ => {}
                }
            }
        }
        quick(&session, &scene, session.view(), (Quality::FULL, self.scale), progress)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene_file::{PresetsDoc, SplineStageDoc, StageDoc, parse};
    use std::path::Path;

    const SCENE: &str = "format = 1\n[camera]\neye = [6000.0, -5200.0, 3600.0]\nlook_at = [0.0, 0.0, 300.0]\n\
        [[layer]]\nkind = 'terrain'\nid = 'ground'\nsource = 'builtin:massif?seed=7&size=65'\n\
        [[layer]]\nkind = 'line'\nid = 'trail'\nsource = 'builtin:massif?seed=7&size=65'\nmust_see = true\n";

    #[test]
    fn variants_are_drawn_from_one_session_and_a_refusal_is_told() {
        let source = parse(Path::new("s.toml"), SCENE).expect("scene");
        let session = Session::from_document(source.clone(), &OpenOptions::default()).expect("session");
        let thumbnails = Thumbnails::new(&session, &Place::default(), 0.2);
        let draw = |presets: &str| {
            let mut document = source.document.clone();
            let presets = PresetsDoc::Named(presets.to_owned());
            document.stage = vec![StageDoc::SplineBend(SplineStageDoc { presets, pivot: None, plane: None })];
            thumbnails.draw(&document, [96, 54], &Progress::silent())
        };
        let [a, b] = ["progressive", "map"].map(|name| draw(name).expect("picture"));
        assert_eq!((a.width, a.height), (96, 54));
        assert!(a.color != b.color, "both presets give one picture");
        let progress = Progress::silent();
        progress.cancel_flag().store(true, std::sync::atomic::Ordering::Relaxed);
        assert!(thumbnails.draw(&source.document, [96, 54], &progress).is_err_and(|e| e.is_cancelled()));
        assert!(draw("no such preset").is_err());
    }
}
