//! How far the bend moves what a pixel shows within the picture, which part of the chain moves it most, and whether the straight
//! camera shows it too.

use belvedere_core::map::curved_rays::CurvedRays;
use belvedere_core::{DVec2, DVec3, Stage, View};
use belvedere_scene::Frame;
use rayon::prelude::*;

/// Turns of curved rays are told apart up to so many: a longer chain is one part.
const MOST_TURNS: usize = 24;
/// What the straight camera sees must be nearer than a point by this share of its depth to hide it: depths of a picture are no better.
const NEARER: f64 = 1e-3;
/// A point that moves by less than this, pixels, stays where it is.
const STILL_PX: f64 = 0.01;

/// The parts of a chain of stages: every stage but the earth's curvature, and every turn of curved rays.
pub(super) struct Parts {
    /// What they are called, in order of application.
    pub(super) names: Vec<String>,
    /// `views[k]` is the camera with the first k parts.
    views: Vec<View>,
}

impl Parts {
    pub(super) fn of(view: &View) -> Self {
        let (mut names, mut views) = (Vec::new(), vec![view.straightened()]);
        let stages = view.stages();
        for (i, stage) in stages.iter().enumerate() {
            let mut add = |name: String, last: Stage| {
                let chain = stages[..i].iter().cloned().chain([last]).collect();
                // The beginning of a chain is a chain.
                if let Ok(view) = View::new(view.pinhole().clone(), chain) {
                    names.push(name);
                    views.push(view);
                }
            };
            match stage {
                Stage::EarthCurvature(_) => {}
                Stage::CurvedRays(rays) if (2..=MOST_TURNS).contains(&rays.turn_count()) => {
                    for k in 1..rays.turn_count() {
                        if let Ok(first) = CurvedRays::new(rays.root(), rays.model(), &rays.spec()[..k]) {
                            add(format!("turn {k}"), Stage::CurvedRays(first));
                        }
                    }
                    add(format!("turn {}", rays.turn_count()), stage.clone());
                }
                _ => add(stage.name().replace('_', " "), stage.clone()),
            }
        }
        Self { names, views }
    }

    /// The camera without any part.
    pub(super) fn straight(&self) -> &View {
        &self.views[0]
    }

    /// The part that moves `p` farthest from where the parts before it leave it; `None` if it stays where it is.
    /// * `pixel`: where all of them leave it.
    fn mover(&self, p: DVec3, pixel: DVec2) -> Option<usize> {
        let mut before = self.straight().project(p).ok().map(|image| image.pixel);
        let mut most = (STILL_PX, None);
        for (part, view) in self.views[1..].iter().enumerate() {
            let last = part + 1 == self.names.len();
            let after = if last { Some(pixel) } else { view.project(p).ok().map(|image| image.pixel) };
            let Some(after) = after else { continue };
            let by = before.map_or(f64::INFINITY, |before| before.distance(after));
            if by > most.0 {
                most = (by, Some(part));
            }
            before = Some(after);
        }
        most.1
    }
}

/// What the straight camera makes of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Straight {
    /// It shows the point, or nobody asked.
    Shown,
    /// Something nearer hides the point.
    Hidden,
    /// The point lies beside its picture, or behind it.
    Outside,
}

/// What became of the point that a pixel shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moved {
    /// Distance from its straight image, pixels; infinite if it has none.
    pub(super) px: f32,
    /// The part that moved it most.
    pub(super) part: Option<u8>,
    /// What the straight camera makes of it.
    pub(super) straight: Straight,
}

/// For every pixel what became of the point that it shows, `None` where it shows none.
/// * `bare`: the bent picture with world positions of pixel centres; `straight`: the straight one, with depths.
pub(super) fn moved(parts: &Parts, bare: &Frame, straight: Option<&Frame>) -> Vec<Option<Moved>> {
    let width = bare.width.max(1);
    let Some(world) = &bare.world else { return vec![None; bare.color.len()] };
    let at = |(i, p): (usize, &[f64; 3])| {
        let p = DVec3::from_array(*p);
        let pixel = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        p.is_finite().then(|| of_point(parts, p, pixel, straight))
    };
    world.par_iter().enumerate().map(at).collect()
}

fn of_point(parts: &Parts, p: DVec3, pixel: DVec2, straight: Option<&Frame>) -> Moved {
    let part = parts.mover(p, pixel).and_then(|part| u8::try_from(part).ok());
    let Ok(image) = parts.straight().project(p) else {
        return Moved { px: f32::INFINITY, part, straight: Straight::Outside };
    };
    let straight = match straight {
        Some(_) if !parts.straight().pinhole().contains(image.pixel) => Straight::Outside,
        Some(frame) if is_hidden(frame, image.pixel, image.depth) => Straight::Hidden,
        _ => Straight::Shown,
    };
    Moved { px: image.pixel.distance(pixel) as f32, part, straight }
}

/// Whether all four pixels around an image are nearer than its depth: on a slope one of them is not.
fn is_hidden(frame: &Frame, pixel: DVec2, depth: f64) -> bool {
    let corner = (pixel - 0.5).floor();
    let inside = |v: f64, end: usize| v.clamp(0.0, end.saturating_sub(1) as f64) as usize;
    [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].iter().all(|(dx, dy)| {
        let (x, y) = (inside(corner.x + dx, frame.width), inside(corner.y + dy, frame.height));
        f64::from(frame.depth[y * frame.width + x]) * (1.0 + NEARER) < depth
    })
}
