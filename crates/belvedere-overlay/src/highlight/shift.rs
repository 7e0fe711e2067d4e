//! Displacement of the point at every pixel within the picture, the part of the chain that moves it most, and whether the straight
//! camera shows it too.

use belvedere_core::map::curved_rays::CurvedRays;
use belvedere_core::{DVec2, DVec3, Stage, View};
use belvedere_scene::Frame;
use rayon::prelude::*;

/// Largest number of turns of curved rays that are distinguished; a longer chain is one part.
const MOST_TURNS: usize = 24;
/// Largest number of parts, with the other stages.
const MOST_PARTS: usize = 32;
/// A turn reaches a point that it moves by more than this, pixels.
const REACHES_PX: f64 = 1.0;
/// Share of its depth by which a surface must be nearer than a point to hide it, the accuracy of depths in a picture.
const NEARER: f64 = 1e-3;
/// Displacement below which a point counts as at rest, pixels.
const STILL_PX: f64 = 0.01;

/// The parts of a chain of stages: every stage but the earth's curvature, and every turn of curved rays.
pub(super) struct Parts {
    /// Names, in order of application.
    pub(super) names: Vec<String>,
    /// Number of the stage of each part.
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
                // The beginning of a valid chain is valid.
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

    /// The camera without stages that bend.
    pub(super) fn straight(&self) -> &View {
        &self.views[0]
    }

    /// Displacement of `p` on the image by each part, pixels, from its image after the parts before; infinite where it had none.
    /// * `pixel`: image after all parts.
    fn moves(&self, p: DVec3, pixel: DVec2) -> Moves {
        let image = |view: &View| view.project(p).ok().map(|image| image.pixel);
        let first = image(self.straight());
        let (mut moves, mut before) = (Moves { by: [0.0; MOST_PARTS], mover: None }, first);
        // Image before the current stage; largest displacement by a stage so far, and the parts of that stage.
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
        // The last turn of a stage that reaches the point stands for it, so that stretches of the rays are distinguished.
        let reaches = |part: &usize| moves.by[*part] > REACHES_PX;
        moves.mover = most.1.clone().rev().find(reaches).or(most.1.last());
        moves
    }
}

/// Displacement of a point by each part, and the part that stands for it.
struct Moves {
    by: [f64; MOST_PARTS],
    mover: Option<usize>,
}

/// Visibility of a point for the straight camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Straight {
    /// The point is shown, or was not tested.
    Shown,
    /// A nearer surface hides the point.
    Hidden,
    /// The point lies outside the picture or behind the camera.
    Outside,
}

/// Displacement of the point at a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moved {
    /// Distance from its straight image, pixels; infinite if it has none.
    pub(super) px: f32,
    /// The part that stands for the displacement: of the stage that moved the point farthest; of turns of curved rays the last that reaches it.
    pub(super) part: Option<u8>,
    /// Visibility for the straight camera.
    pub(super) straight: Straight,
    /// Whether the straight picture holds the point, hidden or not.
    pub(super) in_both: bool,
}

/// Displacements of all pixels.
pub(super) struct Survey {
    /// One entry per pixel; `None` where the picture shows no surface.
    pub(super) pixels: Vec<Option<Moved>>,
    /// For each part the number of pixels that it reaches, and its largest displacement of a point that lies in the straight picture too,
    /// pixels.
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
            let moved = of_point(parts, p, pixel, moves.mover, straight);
            for (sum, by) in reached.iter_mut().zip(moves.by) {
                let far = if by.is_finite() && moved.in_both { by } else { 0.0 };
                *sum = joined(*sum, (usize::from(by > REACHES_PX), far));
            }
            *out = Some(moved);
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
        return Moved { px: f32::INFINITY, part, straight: Straight::Outside, in_both: false };
    };
    let pinhole = parts.straight().pinhole();
    let in_both = image.depth >= pinhole.near && pinhole.contains(image.pixel);
    let straight = match straight {
        Some(_) if !in_both => Straight::Outside,
        Some(frame) if is_hidden(frame, image.pixel, image.depth) => Straight::Hidden,
        _ => Straight::Shown,
    };
    Moved { px: image.pixel.distance(pixel) as f32, part, straight, in_both }
}

/// Whether all four pixels around an image are nearer than its depth; on a slope at least one is not.
fn is_hidden(frame: &Frame, pixel: DVec2, depth: f64) -> bool {
    let corner = (pixel - 0.5).floor();
    let inside = |v: f64, end: usize| v.clamp(0.0, end.saturating_sub(1) as f64) as usize;
    [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].iter().all(|(dx, dy)| {
        let (x, y) = (inside(corner.x + dx, frame.width), inside(corner.y + dy, frame.height));
        f64::from(frame.depth[y * frame.width + x]) * (1.0 + NEARER) < depth
    })
}
