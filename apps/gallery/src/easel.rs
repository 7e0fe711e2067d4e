//! Tools for figures: scenes opened, bent, and drawn as panels.

use crate::sheet::Panel;
use anyhow::{Context, Result};
use belvedere::construct::rays::Target;
use belvedere::core::map::curved_rays::{Model, TurnSpec};
use belvedere::core::map::split_rays::{Fork, Seam, SplitSpec};
use belvedere::core::{CurvedRays, DVec2, DVec3, Pinhole, Projection, SplitRays, Stage, View};
use belvedere::scene::{
    BoxLayer, BoxShape, Color, Frame, Hidden, Layer, LineFeature, LineLayer, PointFeature, PointLayer, PointStyle,
    Scene,
};
use belvedere::sight::trace::Tracer;
use belvedere::{CameraPicture, OpenOptions, PictureOptions, Session, fallback};
use std::path::Path;

/// Points of a sampled ray.
const RAY_POINTS: usize = 320;

pub(crate) struct Easel<'a> {
    options: &'a OpenOptions,
    scale: f64,
}

impl<'a> Easel<'a> {
    /// * `scale`: factor of the width and height of all pictures, in (0, 1].
    pub(crate) fn new(options: &'a OpenOptions, scale: f64) -> Self {
        Self { options, scale }
    }

    /// Factor of the width and height of all pictures.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// A scene as its text says, in pictures of `image` pixels times the scale.
    pub(crate) fn open(&self, text: &str, image: [u32; 2]) -> Result<Session> {
        let image = image.map(|n| (f64::from(n) * self.scale).round().max(1.0) as u32);
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

/// A picture, and the visible share of a layer.
pub(crate) struct Shown {
    /// Share of the pixels of the layer, drawn alone, that show it in this picture.
    pub(crate) share: f64,
    pub(crate) frame: Frame,
}

impl Easel<'_> {
    /// The picture of a session, and the visible share of a layer; of a molecule, that of its required part.
    pub(crate) fn shown(&self, session: &Session, layer: &str) -> Result<Shown> {
        let (scene, view) = (session.scene(), session.view());
        let at = scene.layers.iter().position(|l| l.id == layer);
        let target = at.and_then(|at| Target::layer(scene, at)).with_context(|| format!("no {layer}"))?;
        let frame = session.render(&self.request())?.frame;
        let draw = |other: &Scene, view: &View| {
            if std::ptr::eq(other, scene) {
                return Ok(frame.clone());
            }
            let session = Session::from_parts(other.clone(), view.clone()).with_light(*session.light());
            Ok(session.render(&self.request())?.frame)
        };
        let plan = fallback::plan(scene, view, (layer, &target), &[])?;
        let picture = fallback::FallbackPicture { frame: frame.clone(), pixels_opened: None };
        let share = plan.measured(view, (scene, &picture), &draw)?.visible;
        Ok(Shown { share, frame })
    }
}

/// The session from straight above in parallel projection; the picture shows `size` scene units of ground, top to bottom, around a point.
pub(crate) fn above(session: &Session, middle: DVec3, size: f64) -> Result<Session> {
    let lens = Projection::Orthographic { height: size };
    let eye = middle + 2.0 * size.max(500.0) * DVec3::Z;
    let camera = Pinhole::look_at(eye, middle, DVec3::Y, lens, session.view().pinhole().image, 1.0, None)?;
    Ok(session.clone().with_view(View::straight(camera)))
}

/// The session with rays bent by these turns, in place of its own stages.
pub(crate) fn bent(session: &Session, model: Model, turns: &[TurnSpec]) -> Result<Session> {
    let pinhole = session.view().pinhole().clone();
    let rays = CurvedRays::new(&pinhole, model, turns)?;
    Ok(session.clone().with_view(View::new(pinhole, vec![Stage::CurvedRays(rays)])?))
}

/// The session with rays that part in the middle of the picture, the left and the right half with turns of their own.
pub(crate) fn parted(session: &Session, model: Model, turns: [Vec<TurnSpec>; 2]) -> Result<Session> {
    let pinhole = session.view().pinhole().clone();
    let sides = turns.map(|turns| SplitSpec { turns, fork: None });
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
    let layer = |(id, boxes)| Layer { id, must_see: false, kind: BoxLayer::new(boxes).into() };
    scene.layers.extend(boxes.into_iter().map(layer));
    Session::from_parts(scene, session.view().clone()).with_light(*session.light())
}

/// The session with lines of its own, each set in a layer of its name, drawn over everything.
pub(crate) fn with_lines(
    session: &Session,
    lines: impl IntoIterator<Item = (&'static str, Vec<Vec<DVec3>>, Color, f64)>,
) -> Session {
    let mut scene = session.scene().clone();
    let layer = |(id, lines, color, width_px): (&str, Vec<Vec<DVec3>>, _, _)| {
        let feature = |points| LineFeature { style: None, name: String::new(), points };
        let features = lines.into_iter().map(feature).collect();
        let layer = LineLayer { width_px, hidden: Hidden::Show, lift_m: 0.0, ..LineLayer::new(features, color) };
        Layer { id: id.to_owned(), must_see: false, kind: layer.into() }
    };
    scene.layers.extend(lines.into_iter().map(layer));
    Session::from_parts(scene, session.view().clone()).with_light(*session.light())
}

/// The session with named points, drawn over everything.
pub(crate) fn with_points(session: &Session, points: &[(&str, DVec3)], color: Color) -> Session {
    let mut scene = session.scene().clone();
    let feature =
        |(name, position): &(&str, DVec3)| PointFeature { style: None, name: (*name).to_owned(), position: *position };
    let layer = PointLayer {
        features: points.iter().map(feature).collect(),
        color,
        size_px: 9.0,
        style: PointStyle { label_px: Some(13.0), ..PointStyle::default() },
        hidden: Hidden::Show,
        lift_m: 0.0,
        beyond: 0.0,
    };
    scene.layers.push(Layer { id: "marks".into(), must_see: false, kind: layer.into() });
    Session::from_parts(scene, session.view().clone()).with_light(*session.light())
}

/// Points of the ray of a pixel, up to the first hit or to depth `far`.
pub(crate) fn ray_points(view: &View, tracer: &Tracer<'_>, pixel: DVec2, far: f64) -> Vec<DVec3> {
    let depth = tracer.first_hit(pixel).map_or(far, |hit| hit.depth.min(far));
    view.ray(pixel).samples(1e-4 * depth, depth, RAY_POINTS).map_while(Result::ok).map(|p| p.point).collect()
}

/// Pixels that show a layer.
pub(crate) fn pixels_of(frame: &Frame, session: &Session, layer: &str) -> usize {
    let at = session.scene().layers.iter().position(|l| l.id == layer);
    at.map_or(0, |at| frame.id.iter().filter(|id| **id as usize == at + 1).count())
}
