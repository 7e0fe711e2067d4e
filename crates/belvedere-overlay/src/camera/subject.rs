//! Subject of a picture of the camera: the view, and the length of its rays.

use belvedere_core::{DVec3, View};
use belvedere_scene::{Color, Hidden, Overlay, OverlayLine, OverlayPoint, Symbol};
use belvedere_sight::trace::Tracer;

/// Position from which a picture of the camera is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CameraPicture {
    /// From above, north up, in parallel projection.
    Overhead,
    /// From a given position: eye and target, scene coordinates; `None`: from beside the camera.
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
pub(super) const DARK: Color = Color::rgb(30, 34, 44);
pub(super) const CURVE: Color = Color::rgb(200, 60, 130);
pub(super) const TAG: Color = Color::rgb(213, 94, 0);
pub(super) const PLANE: Color = Color::rgb(0, 140, 110);

pub(super) fn segment_color(segment: u32) -> Color {
    SEGMENTS[segment as usize % SEGMENTS.len()]
}

/// Marks over the scene, and the camera that draws them.
pub struct CameraFigure {
    /// The camera that draws the figure; straight.
    pub view: View,
    pub overlay: Overlay,
    /// Colour and meaning, top down.
    pub legend: Vec<(Color, String)>,
}

/// The view of a session, and the length of its rays.
pub(super) struct Subject<'a> {
    pub(super) view: &'a View,
    pub(super) tracer: Tracer<'a>,
    /// Depth at which rays without a hit end.
    pub(super) far: f64,
    /// Extent of the contents, scene units.
    pub(super) extent: f64,
}

impl Subject<'_> {
    /// Draws the eye and a small pyramid to its image.
    pub(super) fn eye(&self, overlay: &mut Overlay) {
        let p = self.view.pinhole();
        let depth = 0.05 * self.extent.min(self.far);
        let [w, h] = p.image.map(f64::from);
        let corners = [[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]].map(|c| p.unproject(c.into(), depth));
        for corner in corners {
            overlay.over.push(line(vec![p.unproject(p.center_px(), 0.0), corner], DARK, 1.6));
        }
        overlay.over.push(line([&corners[..], &corners[..1]].concat(), DARK, 1.6));
        overlay.points.push(point(p.eye, Symbol::Dot, 9.0, DARK, "eye"));
        // A stage may displace the eye itself: rays over the undisplaced ground start at its undisplaced position.
        if let Ok((origin, _)) = self.view.undisplace(p.unproject(p.center_px(), 1e-4 * self.far))
            && origin.distance(p.eye) > 0.01 * self.far
        {
            overlay.points.push(point(origin, Symbol::Dot, 7.0, segment_color(0), "eye, for the true ground"));
        }
    }
}

pub(super) fn line(points: Vec<DVec3>, color: Color, width_px: f64) -> OverlayLine {
    OverlayLine {
        points,
        on_ground: false,
        color,
        width_px,
        casing: None,
        hidden: Hidden::Fade,
        label: String::new(),
        label_px: belvedere_scene::SMALL_LETTERS_PX,
    }
}

pub(super) fn point(position: DVec3, symbol: Symbol, size_px: f64, color: Color, label: &str) -> OverlayPoint {
    OverlayPoint { position, symbol, size_px, color, hidden: Hidden::Show, label: label.to_owned() }
}
