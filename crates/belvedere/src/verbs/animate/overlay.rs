//! What a film along a route draws over its frames: the mark at the walker, the time, and the heights of the route.

use super::clock::RouteTimes;
use crate::Session;
use crate::film::{DrawnGround, Following};
use crate::scene_file::AnimationDoc;
use belvedere_composite::canvas::{Canvas, text_size};
use belvedere_core::{DVec2, View, Warning, WarningKind};
use belvedere_overlay::{INK, PAPER};
use belvedere_scene::{Color, Frame, Scene};
use serde::{Deserialize, Serialize};

/// Radius of the mark, pixels of a picture 720 high, and its colours.
const RADIUS: f64 = 11.0;
const SMALLEST: f64 = 0.3;
const BODY: Color = Color::rgb(0, 114, 178);
const RIM: Color = Color::rgb(255, 255, 255);
/// Opacity of the mark where ground hides the walker.
const HIDDEN: f64 = 0.45;
/// Depth of ground before the walker that hides him, as a share of his depth: the drawn ground is coarser than he is small.
const BEFORE: f64 = 0.02;
/// Points of the profile.
const PROFILE: usize = 240;

/// Overlays of a film.
pub(super) struct FilmOverlay {
    marker: bool,
    clock: Option<RouteTimes>,
    profile: Option<Profile>,
}

/// The mark at the walker in a frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MarkerRecord {
    /// Its place, pixels.
    pub pixel: [f64; 2],
    /// Share of it that ground hides: it is drawn the fainter.
    pub hidden: f64,
}

/// Heights along a route.
struct Profile {
    length: f64,
    heights: Vec<f64>,
}

impl FilmOverlay {
    /// Overlays that an animation asks for, and warnings.
    pub(super) fn new(session: &Session, following: &Following, animation: &AnimationDoc) -> (Self, Vec<Warning>) {
        let asked = |flag: Option<bool>| flag == Some(true);
        let mut warnings = Vec::new();
        let layer = animation.along.as_deref().unwrap_or_default();
        let clock = match asked(animation.clock).then(|| RouteTimes::of(session, layer, &following.route)) {
            Some(Err(reason)) => {
                warnings.push(Warning::new(WarningKind::Fallback, format!("layer \"{layer}\": {reason}")).about(layer));
                None
            }
            times => times.and_then(Result::ok),
        };
        let length = following.route.length();
        let heights = (0..PROFILE).filter_map(|i| {
            let p = following.route.at(length * i as f64 / (PROFILE - 1) as f64)?;
            Some(session.scene().terrain().and_then(|t| t.surface_at(p.truncate())).unwrap_or(p.z))
        });
        let profile = asked(animation.profile).then(|| Profile { length, heights: heights.collect() });
        (Self { marker: asked(animation.marker), clock, profile }, warnings)
    }

    /// Draws over a frame; `mark` tells whether the mark of bent pictures takes its lower right corner.
    pub(super) fn draw(
        &self,
        frame: &mut Frame,
        (scene, view): (&Scene, &View),
        (following, number): (&Following, usize),
        mark: bool,
    ) -> Option<MarkerRecord> {
        let walked = following.walked[number];
        let marker = self.marker.then(|| marker(frame, (scene, view), following, number)).flatten();
        if let Some(profile) = &self.profile {
            profile.draw(frame, walked, mark);
        }
        if let Some(clock) = &self.clock {
            draw_clock(frame, &clock.at(walked));
        }
        marker
    }
}

/// Draws the mark always on top. Its opacity follows the share of its pixels that ground hides, so it neither jumps nor vanishes.
fn marker(
    frame: &mut Frame,
    (scene, view): (&Scene, &View),
    following: &Following,
    number: usize,
) -> Option<MarkerRecord> {
    let walker = following.walkers[number];
    let drawn = DrawnGround::of(scene, view).and_then(|ground| ground.at(walker.truncate()));
    let at = drawn.or_else(|| view.displace(walker).ok().map(|d| d.point))?;
    let (pixel, depth) = view.pinhole().project(at).ok()?;
    if !view.pinhole().contains(pixel) || depth < view.pinhole().near {
        return None;
    }
    let scale = (frame.height as f64 / 720.0).max(SMALLEST);
    let radius = scale * RADIUS;
    let (mut all, mut hidden) = (0, 0);
    for dy in -4..=0 {
        for dx in -3..=3 {
            let p = pixel + DVec2::new(f64::from(dx) / 3.0, f64::from(dy) / 2.0) * radius;
            let (x, y) = (p.x.floor(), p.y.floor());
            if x >= 0.0 && y >= 0.0 && x < frame.width as f64 && y < frame.height as f64 {
                let before = f64::from(frame.depth[y as usize * frame.width + x as usize]);
                all += 1;
                hidden += usize::from(before < (1.0 - BEFORE) * depth);
            }
        }
    }
    let hidden = if all > 0 { f64::from(hidden as u32) / f64::from(all as u32) } else { 0.0 };
    let faint = |color: Color| Color { a: (255.0 * (1.0 + hidden * (HIDDEN - 1.0))).round() as u8, ..color };
    let mut canvas = Canvas::new(&mut frame.color, frame.width);
    canvas.disc(pixel, radius, faint(RIM));
    canvas.disc(pixel, 0.72 * radius, faint(BODY));
    canvas.disc(pixel, 0.25 * radius, faint(RIM));
    Some(MarkerRecord { pixel: pixel.to_array(), hidden })
}

fn letters(frame: &Frame) -> f64 {
    (frame.height as f64 / 720.0 * 22.0).max(9.0)
}

fn draw_clock(frame: &mut Frame, time: &str) {
    let letters = letters(frame);
    let margin = 0.6 * letters;
    // As wide for every time, so that the box does not change.
    let width = text_size(letters, "00:00:00").width;
    let mut canvas = Canvas::new(&mut frame.color, frame.width);
    let lo = DVec2::splat(margin);
    canvas.rect(lo, lo + DVec2::new(width + 1.2 * letters, 1.6 * letters), 0.3 * letters, PAPER);
    let left = lo.x + 0.6 * letters + width - text_size(letters, time).width;
    canvas.text(DVec2::new(left, lo.y + 1.17 * letters), letters, time, INK, None);
}

impl Profile {
    /// Draws the strip at the lower edge, in small pictures beside the mark of bent pictures at the upper one.
    fn draw(&self, frame: &mut Frame, walked: f64, mark: bool) {
        let (Some(&first), letters) = (self.heights.first(), letters(frame)) else { return };
        let [low, high] = self.heights.iter().fold([first; 2], |[a, b], h| [a.min(*h), b.max(*h)]);
        let (margin, (w, h)) = (0.6 * letters, (frame.width as f64, frame.height as f64));
        let beside = if mark { 140.0 } else { 0.0 };
        let height = (0.14 * h).max(16.0);
        let fits = beside <= 0.4 * w;
        let width = w - 2.0 * margin - if fits { beside } else { 0.0 };
        // Below the clock.
        let top = if fits { h - margin - height } else { 2.2 * letters + margin };
        let mut canvas = Canvas::new(&mut frame.color, frame.width);
        let lo = DVec2::new(margin, top);
        let hi = lo + DVec2::new(width, height);
        canvas.rect(lo, hi, 0.3 * letters, PAPER);
        let said = height >= 3.0 * letters;
        let (inner_lo, inner_hi) =
            (lo + 0.4 * letters + DVec2::Y * if said { 1.2 * letters } else { 0.0 }, hi - 0.4 * letters);
        let place = |share: f64, z: f64| {
            let up = (z - low) / (high - low).max(1.0);
            DVec2::new(
                inner_lo.x + share * (inner_hi.x - inner_lo.x),
                inner_hi.y - (0.1 + 0.9 * up) * (inner_hi.y - inner_lo.y),
            )
        };
        let last = (self.heights.len() - 1).max(1) as f64;
        let line: Vec<DVec2> = self.heights.iter().enumerate().map(|(i, z)| place(i as f64 / last, *z)).collect();
        let foot = |p: DVec2| DVec2::new(p.x, inner_hi.y);
        let under: Vec<DVec2> = line.iter().copied().chain([foot(line[line.len() - 1]), foot(line[0])]).collect();
        canvas.polygon([&under[..]], Color { a: 150, ..Color::rgb(150, 166, 140) });
        canvas.line(&line, (0.08 * letters).max(1.0), INK);
        let share = (walked / self.length.max(1e-9)).clamp(0.0, 1.0);
        let i = (share * last).floor().min(last - 1.0).max(0.0);
        let (a, b) = (self.heights[i as usize], self.heights[(i as usize + 1).min(self.heights.len() - 1)]);
        let z = a + (share * last - i) * (b - a);
        let here = place(share, z);
        canvas.line(&[here, foot(here)], (0.08 * letters).max(1.0), BODY);
        canvas.disc(here, (0.26 * letters).max(2.2), RIM);
        canvas.disc(here, (0.19 * letters).max(1.6), BODY);
        if said {
            let small = 0.72 * letters;
            let baseline = lo.y + 1.05 * letters;
            let heights = format!("{z:.0} m");
            canvas.text(DVec2::new(inner_lo.x, baseline), small, &heights, INK, None);
            let way = format!("{:.1} of {:.1} km", walked / 1000.0, self.length / 1000.0);
            let left = inner_hi.x - text_size(small, &way).width;
            canvas.text(DVec2::new(left, baseline), small, &way, INK, None);
        }
    }
}
