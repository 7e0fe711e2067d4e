//! How far the bend moves what a pixel shows within the picture, which part of the chain moves it most, and whether the straight
//! camera shows it too.

use belvedere_core::map::curved_rays::CurvedRays;
use belvedere_core::{DVec2, DVec3, Stage, View};
use belvedere_scene::Frame;
use rayon::prelude::*;

/// Turns of curved rays are told apart up to so many: a longer chain is one part.
const MOST_TURNS: usize = 24;
/// Room for them beside the other stages.
const MOST_PARTS: usize = 32;
/// A turn reaches a point that it moves by more than this, pixels.
const REACHES_PX: f64 = 1.0;
/// What the straight camera sees must be nearer than a point by this share of its depth to hide it: depths of a picture are no better.
const NEARER: f64 = 1e-3;
/// A point that moves by less than this, pixels, stays where it is.
const STILL_PX: f64 = 0.01;

/// The parts of a chain of stages: every stage but the earth's curvature, and every turn of curved rays.
pub(super) struct Parts {
    /// What they are called, in order of application.
    pub(super) names: Vec<String>,
    /// Number of the stage that each belongs to.
    stages: Vec<usize>,
    /// `views[k]` is the camera with the first k parts.
    views: Vec<View>,
}

impl Parts {
    pub(super) fn of(view: &View) -> Self {
        let (mut names, mut numbers, mut views) = (Vec::new(), Vec::new(), vec![view.straightened()]);
        let stages = view.stages();
        for (i, stage) in stages.iter().enumerate() {
            let mut add = |name: String, last: Stage| {
                let chain = stages[..i].iter().cloned().chain([last]).collect();
                // The beginning of a chain is a chain.
                if let Ok(view) = View::new(view.pinhole().clone(), chain) {
                    names.push(name);
                    numbers.push(i);
                    views.push(view);
                }
            };
            match stage {
                stage if stage.is_of_world() => {}
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
        Self { names, stages: numbers, views }
    }

    /// The camera without any part.
    pub(super) fn straight(&self) -> &View {
        &self.views[0]
    }

    /// How far each part moves `p` from where the parts before it leave it, pixels: infinite where they leave it without an image.
    /// * `pixel`: where all of them leave it.
    fn moves(&self, p: DVec3, pixel: DVec2) -> Moves {
        let image = |view: &View| view.project(p).ok().map(|image| image.pixel);
        let first = image(self.straight());
        let (mut moves, mut before) = (Moves { by: [0.0; MOST_PARTS], mover: None }, first);
        // The start of the stage that a part belongs to, and the stage that moved farthest: how far, its parts.
        let (mut start, mut most) = (first, (STILL_PX, 0..0));
        let far = |from: Option<DVec2>, to: DVec2| from.map_or(f64::INFINITY, |from| from.distance(to));
        for (part, view) in self.views[1..].iter().enumerate() {
            let begins = part == 0 || self.stages[part] != self.stages[part - 1];
            start = if begins { before } else { start };
            let last = part + 1 == self.names.len();
            if let Some(after) = if last { Some(pixel) } else { image(view) } {
                moves.by[part] = far(before, after);
                before = Some(after);
            }
            let ends = last || self.stages[part] != self.stages[part + 1];
            let Some(end) = before.filter(|_| ends) else { continue };
            if far(start, end) > most.0 {
                let begin = self.stages.iter().position(|s| *s == self.stages[part]).unwrap_or(part);
                most = (far(start, end), begin..part + 1);
            }
        }
        // Of the turns of a stage the last that reaches the point stands for it: so the stretches of the rays are told apart.
        let reaches = |part: &usize| moves.by[*part] > REACHES_PX;
        moves.mover = most.1.clone().rev().find(reaches).or(most.1.last());
        moves
    }
}

/// How far each part moves a point, and which of them stands for its move.
struct Moves {
    by: [f64; MOST_PARTS],
    mover: Option<usize>,
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
    /// The part that stands for the move: of the stage that moved the point farthest; of the turns of curved rays the last that reaches it.
    pub(super) part: Option<u8>,
    /// What the straight camera makes of it.
    pub(super) straight: Straight,
}

/// What became of all pixels.
pub(super) struct Survey {
    /// Pixel by pixel; `None` where the picture shows nothing.
    pub(super) pixels: Vec<Option<Moved>>,
    /// For each part how many pixels it reaches, and how far it moves them at most, pixels.
    pub(super) parts: Vec<(usize, f64)>,
}

/// Follows the point of every pixel through the parts.
/// * `bare`: the bent picture with world positions of pixel centres; `straight`: the straight one, with depths.
pub(super) fn survey(parts: &Parts, bare: &Frame, straight: Option<&Frame>) -> Survey {
    let width = bare.width.max(1);
    let Some(world) = &bare.world else {
        return Survey { pixels: vec![None; bare.color.len()], parts: vec![(0, 0.0); parts.names.len()] };
    };
    let mut pixels = vec![None; world.len()];
    let row = |y: usize, pixels: &mut [Option<Moved>], world: &[[f64; 3]]| {
        let mut reached = [(0, 0.0); MOST_PARTS];
        for (x, (out, p)) in pixels.iter_mut().zip(world).enumerate() {
            let p = DVec3::from_array(*p);
            if !p.is_finite() {
                continue;
            }
            let pixel = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let moves = parts.moves(p, pixel);
            for (sum, by) in reached.iter_mut().zip(moves.by) {
                *sum = joined(*sum, (usize::from(by > REACHES_PX), if by.is_finite() { by } else { 0.0 }));
            }
            *out = Some(of_point(parts, p, pixel, moves.mover, straight));
        }
        reached
    };
    let rows = pixels.par_chunks_mut(width).zip(world.par_chunks(width)).enumerate();
    let rows = rows.map(|(y, (pixels, world))| row(y, pixels, world));
    let all = rows.reduce(|| [(0, 0.0); MOST_PARTS], |a, b| std::array::from_fn(|k| joined(a[k], b[k])));
    Survey { pixels, parts: all[..parts.names.len()].to_vec() }
}

fn joined(a: (usize, f64), b: (usize, f64)) -> (usize, f64) {
    (a.0 + b.0, a.1.max(b.1))
}

fn of_point(parts: &Parts, p: DVec3, pixel: DVec2, mover: Option<usize>, straight: Option<&Frame>) -> Moved {
    let part = mover.and_then(|part| u8::try_from(part).ok());
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
