//! A renderer that only this test knows: it draws one ball by its equation, and has lines, names and edges from the crate.

use belvedere_composite::color::{Packed, Rgb};
use belvedere_composite::depths::Depths;
use belvedere_composite::drawn::{Drawn, Sight};
use belvedere_composite::finish::{buffers, finish};
use belvedere_composite::marks::Marks;
use belvedere_composite::{branches, layers};
use belvedere_core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere_scene::{
    Color, Frame, Hidden, Layer, LayerKind, Light, LineFeature, LineLayer, PointFeature, PointLayer, PointStyle,
    Progress, RenderError, RenderJob, RenderOptions, Renderer, Scene, Stylisation, Symbol,
};
use belvedere_sight::pass::Pass;
use belvedere_sight::screen::Screen;

/// A ball of this radius about the origin.
const RADIUS: f64 = 10.0;
const EYE: DVec3 = DVec3::new(0.0, -60.0, 0.0);
/// The line runs behind the ball at this distance, at this height.
const BEHIND: f64 = 20.0;
const HEIGHT: f64 = 2.0;

/// Draws the ball.
struct Ball;

struct Rays<'a>(&'a Pinhole);

impl Sight for Rays<'_> {
    fn first_depth(&self, pixel: DVec2) -> Option<f64> {
        let (o, d) = (self.0.eye, (self.0.unproject(pixel, 1.0) - self.0.eye).normalize());
        let (half, rest) = (o.dot(d), o.length_squared() - RADIUS * RADIUS);
        let root = half * half - rest;
        let hit = (root >= 0.0).then(|| (d * (-half - root.sqrt())).dot(self.0.forward));
        Some(hit.unwrap_or(f64::INFINITY))
    }
}

fn marks(job: &RenderJob<'_>, screen: &Screen, depth: &[f32]) -> Marks {
    let passes = Pass::all(job.view);
    let passes: Vec<&Pass<'_>> = passes.iter().collect();
    let sight = Rays(job.view.pinhole());
    Marks::new(job, &Drawn { passes: &passes, screen, tolerance_px: 0.5, depth: Depths::Whole(depth), sight: &sight })
}

fn draw(job: &RenderJob<'_>) -> Result<Frame, RenderError> {
    let screen = Screen::new(job.view.pinhole());
    let rays = Rays(job.view.pinhole());
    let mut buffers = buffers(job);
    let (width, height) = (screen.width as usize, screen.height as usize);
    for (i, (depth, color)) in buffers.depth.iter_mut().zip(&mut buffers.color).enumerate() {
        let pixel = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        *depth = rays.first_depth(pixel).unwrap_or(f64::INFINITY) as f32;
        *color = Packed::new(Rgb::splat(if depth.is_finite() { 0.5 } else { 0.9 }));
    }
    finish(job, &marks(job, &screen, &buffers.depth), &screen, None, &mut buffers);
    let (color, depth, id) = (buffers.out, buffers.depth, buffers.id);
    Ok(Frame { width, height, color, depth, id, ..Frame::default() })
}

impl Renderer for Ball {
    fn name(&self) -> &'static str {
        "ball"
    }

    fn render(&self, job: &RenderJob<'_>) -> Result<Frame, RenderError> {
        branches::draw(job, |job| layers::draw(job, draw, marks))
    }
}

fn layer(name: &str, kind: LayerKind) -> Layer {
    Layer { id: name.to_owned(), must_see: false, kind }
}

fn picture(hidden: Hidden, edges: f32, name: &str) -> (Frame, Pinhole) {
    let lens = Projection::Perspective { fov_y: 0.9 };
    let pinhole = Pinhole::look_at(EYE, DVec3::ZERO, DVec3::Z, lens, [320, 240], 1.0, None).expect("a camera");
    let points = [-30.0, 30.0].map(|x| DVec3::new(x, BEHIND, HEIGHT)).to_vec();
    let mut route = LineLayer::new(vec![LineFeature { style: None, name: String::new(), points }], Color::rgb(0, 0, 0));
    (route.hidden, route.lift_m) = (hidden, 0.0);
    let hut = PointLayer {
        features: vec![PointFeature { style: None, name: name.to_owned(), position: DVec3::new(22.0, BEHIND, -12.0) }],
        color: Color::rgb(200, 0, 0),
        size_px: 9.0,
        style: PointStyle { symbol: Symbol::Dot, casing: None, label_px: Some(14.0) },
        hidden: Hidden::Show,
        lift_m: 0.0,
        beyond: 0.0,
    };
    let scene = Scene {
        layers: vec![layer("route", LayerKind::Line(route)), layer("hut", LayerKind::Point(hut))],
        ..Scene::default()
    };
    let view = View::straight(pinhole.clone());
    let stylisation = Stylisation { edges, ..Stylisation::default() };
    let options = RenderOptions { stylisation, ..RenderOptions::default() };
    let (light, progress) = (Light::default(), Progress::silent());
    let job = RenderJob { scene: &scene, view: &view, light: &light, options: &options, progress: &progress };
    (Ball.render(&job).expect("drawn"), pinhole)
}

/// Columns in which the row of the line is black.
fn black(frame: &Frame, pinhole: &Pinhole) -> Vec<usize> {
    let row = pinhole.project(DVec3::new(0.0, BEHIND, HEIGHT)).expect("in front").0.y as usize;
    (0..frame.width).filter(|x| frame.color[row * frame.width + x].iter().all(|c| *c < 40)).collect()
}

#[test]
fn a_line_goes_into_hiding_where_the_rays_of_another_renderer_say_and_is_named() {
    let (frame, pinhole) = picture(Hidden::Cut, 0.0, "Hut");
    let columns = black(&frame, &pinhole);
    // The ray of a pixel of the line's row that touches the ball, by halving.
    let row = pinhole.project(DVec3::new(0.0, BEHIND, HEIGHT)).expect("in front").0.y;
    let (mut lo, mut hi) = (160.0, 320.0);
    for _ in 0..50 {
        let middle = 0.5 * (lo + hi);
        let hits = Rays(&pinhole).first_depth(DVec2::new(middle, row)).is_some_and(f64::is_finite);
        if hits { lo = middle } else { hi = middle }
    }
    let inner = columns.iter().map(|x| (*x as f64 + 0.5 - 160.0).abs()).fold(f64::INFINITY, f64::min);
    assert!(
        (inner - (lo - 160.0)).abs() < 1.5,
        "black from {inner} px off the middle, the ball ends at {}",
        lo - 160.0
    );
    assert!(columns.len() > 60, "{} columns of line", columns.len());
    let (shown, _) = picture(Hidden::Show, 0.0, "Hut");
    assert!(black(&shown, &pinhole).contains(&160), "a line that shines through is drawn on the ball");
    let red = |f: &Frame| f.color.iter().filter(|c| c[0] > c[1].saturating_add(30)).count();
    let nameless = picture(Hidden::Cut, 0.0, "").0;
    assert!(red(&nameless) > 30 && red(&frame) > red(&nameless) + 25, "{} after {}", red(&frame), red(&nameless));
}

#[test]
fn another_renderer_has_edges_from_its_depths() {
    let rim = |frame: &Frame| frame.color.iter().filter(|c| c.iter().all(|v| (60..185).contains(v))).count();
    let (plain, edged) = (picture(Hidden::Cut, 0.0, "Hut").0, picture(Hidden::Cut, 1.0, "Hut").0);
    assert!(rim(&edged) > rim(&plain) + 100, "{} after {}", rim(&edged), rim(&plain));
}
