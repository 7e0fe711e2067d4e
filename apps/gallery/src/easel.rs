//! What every figure needs: scenes opened, bent, and drawn as panels.

use crate::sheet::Panel;
use anyhow::{Context, Result};
use belvedere::core::map::curved_rays::{Model, TurnSpec};
use belvedere::core::map::split_rays::{Fork, Seam, SplitSpec};
use belvedere::core::{CurvedRays, SplitRays, Stage, View};
use belvedere::scene::{BoxLayer, BoxShape, Frame, Layer, LayerKind};
use belvedere::{CameraPicture, OpenOptions, PictureOptions, Session};
use std::path::Path;

pub(crate) struct Easel<'a> {
    options: &'a OpenOptions,
}

impl<'a> Easel<'a> {
    pub(crate) fn new(options: &'a OpenOptions) -> Self {
        Self { options }
    }

    /// A scene as its text says, in pictures of `image` pixels.
    pub(crate) fn open(&self, text: &str, image: [u32; 2]) -> Result<Session> {
        let options = OpenOptions { image: Some(image), ..self.options.clone() };
        Ok(Session::from_text(Path::new("figure.toml"), text, &options)?)
    }

    fn request(&self) -> PictureOptions {
        PictureOptions { no_mark: true, progress: self.options.progress.clone(), ..PictureOptions::default() }
    }

    pub(crate) fn draw(&self, session: &Session) -> Result<Frame> {
        Ok(session.render(&self.request())?.frame)
    }

    pub(crate) fn panel(&self, session: &Session, title: &str, note: String) -> Result<Panel> {
        Ok(Panel { title: title.into(), note, frame: self.draw(session)? })
    }

    /// The camera itself, from outside or above.
    pub(crate) fn camera(&self, session: &Session, camera: CameraPicture, title: &str, note: String) -> Result<Panel> {
        let request = PictureOptions { camera: Some(camera), ..self.request() };
        Ok(Panel { title: title.into(), note, frame: session.render(&request)?.frame })
    }
}

/// The session with its rays bent by turns instead of what bent them.
pub(crate) fn bent(session: &Session, model: Model, turns: &[TurnSpec]) -> Result<Session> {
    let pinhole = session.view().pinhole().clone();
    let rays = CurvedRays::new(&pinhole, model, turns)?;
    Ok(session.clone().with_view(View::new(pinhole, vec![Stage::CurvedRays(rays)])?))
}

/// The session with rays that part in the middle of the picture, the left and the right half with a turn each.
pub(crate) fn parted(session: &Session, model: Model, turns: [TurnSpec; 2]) -> Result<Session> {
    let pinhole = session.view().pinhole().clone();
    let sides = turns.map(|turn| SplitSpec { turns: vec![turn], fork: None });
    let fork = Fork { seam: Seam::MIDDLE, sides, merge: None };
    let rays = SplitRays::new(&pinhole, model, &SplitSpec { turns: Vec::new(), fork: Some(Box::new(fork)) })?;
    Ok(session.clone().with_view(View::new(pinhole, vec![Stage::SplitRays(rays)])?))
}

/// The session with straight rays.
pub(crate) fn straight(session: &Session) -> Session {
    session.clone().with_view(session.view().straightened())
}

/// The turns of the session's curved rays as specified.
pub(crate) fn turns(session: &Session) -> Result<Vec<TurnSpec>> {
    Ok(session.view().curved_rays().context("the scene bends no rays")?.spec().to_vec())
}

/// The session with boxes of its own, each in a layer of its name.
pub(crate) fn with_boxes(session: &Session, boxes: impl IntoIterator<Item = (String, Vec<BoxShape>)>) -> Session {
    let mut scene = session.scene().clone();
    let layer = |(id, boxes)| Layer { id, must_see: false, kind: LayerKind::Boxes(BoxLayer::new(boxes)) };
    scene.layers.extend(boxes.into_iter().map(layer));
    Session::from_parts(scene, session.view().clone()).with_light(*session.light())
}

/// Pixels that show a layer.
pub(crate) fn pixels_of(frame: &Frame, session: &Session, layer: &str) -> usize {
    let at = session.scene().layers.iter().position(|l| l.id == layer);
    at.map_or(0, |at| frame.id.iter().filter(|id| **id as usize == at + 1).count())
}
