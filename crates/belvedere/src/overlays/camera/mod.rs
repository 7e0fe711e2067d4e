//! Pictures of the camera itself, on its scene: rays as they really run, viewpoints, transition planes, the deformation curve.

mod legend;
mod place;
mod rays;
mod spline;
mod turns;

pub(crate) use legend::draw as draw_legend;

use crate::verbs::points::far_depth;
use crate::{BelvedereError, Session};
use belvedere_core::{DVec3, Stage, View};
use belvedere_cpu::Tracer;
use belvedere_scene::{Color, Hidden, Overlay, OverlayLine, OverlayPoint, Symbol};

/// Where a picture of the camera is taken from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CameraPicture {
    /// From above, north up, without perspective.
    Overhead,
    /// From a place of one's own: eye and point looked at, scene coordinates; `None` = from beside the camera.
    Outside(Option<[[f64; 3]; 2]>),
}

impl CameraPicture {
    /// Name in records.
    pub fn name(self) -> &'static str {
        match self {
            Self::Overhead => "overhead",
            Self::Outside(_) => "outside",
        }
    }
}

/// Colours by segment of a ray: straight parts and transitions in turn (after Okabe and Ito, told apart with any colour vision).
const SEGMENTS: [Color; 5] = [
    Color::rgb(0, 96, 168),
    Color::rgb(230, 150, 0),
    Color::rgb(200, 60, 130),
    Color::rgb(240, 200, 40),
    Color::rgb(0, 140, 110),
];
const DARK: Color = Color::rgb(30, 34, 44);
const CURVE: Color = Color::rgb(200, 60, 130);
const PLANE: Color = Color::rgb(0, 140, 110);

fn segment_color(segment: u32) -> Color {
    SEGMENTS[segment as usize % SEGMENTS.len()]
}

/// What is drawn over the scene, and from where.
pub(crate) struct CameraFigure {
    /// The camera that draws the figure; straight.
    pub(crate) view: View,
    pub(crate) overlay: Overlay,
    /// Colour and meaning, top down.
    pub(crate) legend: Vec<(Color, String)>,
}

/// The view of a session, and how far its rays are followed.
struct Subject<'a> {
    view: &'a View,
    tracer: Tracer<'a>,
    /// Depth at which rays end that meet nothing.
    far: f64,
    /// Size of what is shown, scene units.
    extent: f64,
}

/// Draws the camera of a session.
///
/// # Errors
/// [`BelvedereError::Usage`] if nothing says where rays end, or eye and target of the figure are no camera.
pub(crate) fn figure(session: &Session, picture: CameraPicture) -> Result<CameraFigure, BelvedereError> {
    let view = session.view();
    let reach = far_depth(session, None)?;
    let tracer = Tracer::new(session.scene(), view);
    let hits = rays::hits(view, &tracer);
    let far = if hits.is_empty() { reach } else { hits.iter().fold(0.0f64, |m, h| m.max(h.depth)).min(reach) * 1.02 };
    let bounds = session.scene().bounds();
    let extent = if bounds.is_empty() { far } else { (bounds.max - bounds.min).truncate().max_element() };
    let subject = Subject { view, tracer, far, extent };
    let mut overlay = Overlay::default();
    let mut legend = vec![(DARK, "eye and image".to_owned())];
    subject.eye(&mut overlay);
    rays::draw(&subject, &mut overlay, &mut legend);
    for stage in view.stages() {
        match stage {
            Stage::SplineBend(bend) => spline::draw(&subject, bend, &mut overlay, &mut legend),
            Stage::CurvedRays(rays) => turns::draw(&subject, rays, &mut overlay, &mut legend),
            Stage::EarthCurvature(_) | Stage::TerrainDisocclusion(_) => {}
        }
    }
    let view = place::view(session, picture, &overlay)?;
    Ok(CameraFigure { view, overlay, legend })
}

impl Subject<'_> {
    /// The eye and a small pyramid to its image.
    fn eye(&self, overlay: &mut Overlay) {
        let p = self.view.pinhole();
        let depth = 0.05 * self.extent.min(self.far);
        let [w, h] = p.image.map(f64::from);
        let corners = [[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]].map(|c| p.unproject(c.into(), depth));
        for corner in corners {
            overlay.over.push(line(vec![p.unproject(p.center_px(), 0.0), corner], DARK, 1.6));
        }
        overlay.over.push(line([&corners[..], &corners[..1]].concat(), DARK, 1.6));
        overlay.points.push(point(p.eye, Symbol::Dot, 9.0, DARK, "eye"));
        // A bend that begins at the eye moves it as well: rays over the true ground start where it came from.
        if let Ok((origin, _)) = self.view.undisplace(p.unproject(p.center_px(), 1e-4 * self.far))
            && origin.distance(p.eye) > 0.01 * self.far
        {
            overlay.points.push(point(origin, Symbol::Dot, 7.0, segment_color(0), "eye, for the true ground"));
        }
    }
}

fn line(points: Vec<DVec3>, color: Color, width_px: f64) -> OverlayLine {
    OverlayLine { points, on_ground: false, color, width_px, casing: None, hidden: Hidden::Fade, label: String::new() }
}

fn point(position: DVec3, symbol: Symbol, size_px: f64, color: Color, label: &str) -> OverlayPoint {
    OverlayPoint { position, symbol, size_px, color, hidden: Hidden::Show, label: label.to_owned() }
}
