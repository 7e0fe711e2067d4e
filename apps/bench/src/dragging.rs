//! Dragging as the window does it, without a window: a script of a pointer orders pictures at 60 Hz from the painter that the window
//! uses, and every picture is timed from the input to its arrival.

use crate::clock::{process_ms, quantile};
use anyhow::{Context, Result, bail, ensure};
use belvedere::core::DVec2;
use belvedere::live::{Order, Pace, Quality, Shown, Sides};
use belvedere::scene_file::Document;
use belvedere::scene_file::camera::{frame_factor, navigation, set_camera};
use belvedere_studio::{Answer, Editor, Painter, above_ground};
use schemars::JsonSchema;
use serde::Serialize;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Time between two inputs.
const INPUT: Duration = Duration::from_micros(16_667);
/// Longest wait for a picture.
const PATIENCE: Duration = Duration::from_secs(300);
/// Inputs of one of the three gestures: turning, moving, nearing.
const INPUTS: usize = 40;
/// Pictures before [`least`] measures, which prepare what is made once.
const WARM: usize = 4;

/// Cost of dragging one scene.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct DragCost {
    /// Name of the scene.
    pub scene: String,
    /// Moving pictures that arrived.
    pub pictures: usize,
    /// Time from input to picture: median, 95th percentile, longest, milliseconds.
    pub latency_ms: [f64; 3],
    /// The time of drawing alone, without waiting for the picture before: median, milliseconds.
    pub drawing_ms: f64,
    /// Processor time of all threads per moving picture, solvers and judges beside it included, milliseconds.
    pub cpu_ms: f64,
    /// Time to the first picture, which is one at rest, reading included, milliseconds.
    pub first_ms: f64,
    /// Time of a picture at rest after the drag, milliseconds.
    pub rest_ms: f64,
    /// Width of the last moving picture as a share of the full width.
    pub width_share: f64,
    /// Coarseness of the detail of the last moving picture, 0..=3.
    pub coarseness: u8,
    /// Triangles of the last moving picture.
    pub triangles: u64,
    /// Triangles per pixel, the most of all moving pictures.
    pub triangles_per_px: f64,
}

/// A document that a pointer drags.
struct Dragged {
    editor: Editor,
    painter: Painter,
    image: [u32; 2],
    shown: Box<Shown>,
    /// Documents that were ordered and when.
    awaited: Vec<(Arc<Document>, Instant)>,
    latencies: Vec<f64>,
    drawing: Vec<f64>,
    densest: f64,
}

/// Drags a scene: turns, moves and nears the camera.
///
/// * `image`: size of the picture on the screen, pixels.
///
/// # Errors
/// A scene that cannot be drawn.
pub fn drag(name: &str, editor: Editor, image: [u32; 2]) -> Result<DragCost> {
    let began = Instant::now();
    let mut painter = Painter::new(|| ());
    painter.order(order(&editor, image, Pace::Resting));
    let shown = picture(&mut painter)?;
    let first_ms = began.elapsed().as_secs_f64() * 1e3;
    let (awaited, latencies, drawing) = (Vec::new(), Vec::new(), Vec::new());
    let cpu = process_ms();
    let mut dragged = Dragged { editor, painter, image, shown, awaited, latencies, drawing, densest: 0.0 };
    for gesture in 0..3 {
        dragged.gesture(gesture)?;
    }
    let cpu_ms = process_ms() - cpu;
    let Dragged { editor, mut painter, shown, latencies, drawing, densest, .. } = dragged;
    ensure!(!latencies.is_empty(), "{name}: no moving picture arrived");
    let frame = shown.bent.as_ref().context("no picture")?;
    let (width_share, coarseness, triangles) =
        (shown.quality.width(), shown.quality.coarseness(), frame.stats.triangles_drawn);
    let began = Instant::now();
    painter.order(order(&editor, image, Pace::Resting));
    while picture(&mut painter)?.pace != Pace::Resting {}
    let rest_ms = began.elapsed().as_secs_f64() * 1e3;
    let of = |share: f64| quantile(latencies.clone(), share);
    Ok(DragCost {
        scene: name.to_owned(),
        pictures: latencies.len(),
        latency_ms: [of(0.5), of(0.95), of(1.0)],
        drawing_ms: quantile(drawing, 0.5),
        cpu_ms: cpu_ms / latencies.len() as f64,
        first_ms,
        rest_ms,
        width_share,
        coarseness,
        triangles,
        triangles_per_px: densest,
    })
}

/// Cost of moving pictures of the least quality, one after the other: the least that dragging a scene costs, whatever else the machine does.
#[derive(Debug, Clone, Serialize)]
pub struct LeastCost {
    /// Name of the scene.
    pub scene: String,
    /// Processor time of all threads per picture, solvers beside it included, milliseconds.
    pub cpu_ms: f64,
    /// Wall time per picture: median, milliseconds.
    pub wall_ms: f64,
    /// Triangles of the last picture.
    pub triangles: u64,
}

/// Turns the camera of a scene and draws pictures of the least quality.
///
/// * `image`: size of the picture on the screen, pixels. `pictures`: their number.
///
/// # Errors
/// A scene that cannot be drawn.
pub fn least(name: &str, mut editor: Editor, image: [u32; 2], pictures: usize) -> Result<LeastCost> {
    let mut painter = Painter::new(|| ());
    painter.order(order(&editor, image, Pace::Resting));
    let mut shown = picture(&mut painter)?;
    let session = shown.session.clone();
    let resolved = session.resolved().context("no document")?.camera.clone();
    let factor = frame_factor(editor.document(), image);
    let written = editor.document().camera.clone();
    let held = navigation(&written, &resolved, session.view(), session.scene(), (image, factor));
    let (mut wall, mut before) = (Vec::new(), 0.0);
    for k in 0..pictures + WARM {
        if k == WARM {
            before = process_ms();
        }
        let share = k as f64 / (pictures + WARM) as f64;
        let next = above_ground(held.orbited(-0.5 * share, 0.12 * share)?, session.scene());
        editor.edit_within(1, |document| set_camera(document, &next));
        let began = Instant::now();
        painter.order(order(&editor, image, Pace::Moving { quality: Some(Quality::LEAST) }));
        shown = picture(&mut painter)?;
        if k >= WARM {
            wall.push(began.elapsed().as_secs_f64() * 1e3);
        }
    }
    let triangles = shown.bent.as_ref().context("no picture")?.stats.triangles_drawn;
    let cpu_ms = (process_ms() - before) / pictures.max(1) as f64;
    Ok(LeastCost { scene: name.to_owned(), cpu_ms, wall_ms: quantile(wall, 0.5), triangles })
}

fn order(editor: &Editor, image: [u32; 2], pace: Pace) -> Order {
    let (document, place) = (editor.document().clone(), editor.place.clone());
    Order { document, place, image, pace, sides: Sides::Bent, bend: 1.0, overhead: false }
}

/// The next picture.
fn picture(painter: &mut Painter) -> Result<Box<Shown>> {
    loop {
        match painter.answer_within(PATIENCE).context("no picture")? {
            Answer::Shown(shown) => return Ok(shown),
            Answer::Judged(_) => {}
            Answer::Failed(_, reason) => bail!(reason),
        }
    }
}

impl Dragged {
    /// A gesture of the pointer: 0 turns, 1 moves, 2 nears.
    fn gesture(&mut self, kind: usize) -> Result<()> {
        let (written, session) = (self.editor.document().camera.clone(), self.shown.session.clone());
        let resolved = session.resolved().context("no document")?.camera.clone();
        let factor = frame_factor(self.editor.document(), self.image);
        let held = navigation(&written, &resolved, session.view(), session.scene(), (self.image, factor));
        let size = DVec2::new(f64::from(self.image[0]), f64::from(self.image[1]));
        let began = Instant::now();
        for k in 1..=INPUTS {
            let share = k as f64 / INPUTS as f64;
            let next = match kind {
                0 => held.orbited(-0.5 * share, 0.12 * share),
                1 => held.dragged(held.target, 0.5 * size, (0.5 + DVec2::new(0.25, 0.15) * share) * size),
                _ => held.zoomed(held.target, 1.6f64.powf(share)),
            }?;
            let next = above_ground(next, session.scene());
            self.editor.edit_within(kind as u64 + 1, |document| set_camera(document, &next));
            self.order();
            while let Some(left) = (INPUT * k as u32).checked_sub(began.elapsed()).filter(|left| !left.is_zero()) {
                if let Some(answer) = self.painter.answer_within(left) {
                    self.take(answer)?;
                }
            }
        }
        while !self.awaited.is_empty() {
            let answer = self.painter.answer_within(PATIENCE).context("no picture")?;
            self.take(answer)?;
        }
        Ok(())
    }

    fn order(&mut self) {
        self.awaited.push((self.editor.document().clone(), Instant::now()));
        self.painter.order(order(&self.editor, self.image, Pace::Moving { quality: None }));
    }

    fn take(&mut self, answer: Answer) -> Result<()> {
        let shown = match answer {
            Answer::Shown(shown) => shown,
            Answer::Judged(_) => return Ok(()),
            Answer::Failed(_, reason) => bail!(reason),
        };
        let at = self.awaited.iter().position(|(document, _)| Arc::ptr_eq(document, &shown.document));
        if let Some((_, since)) = at.and_then(|at| self.awaited.drain(..=at).next_back()) {
            self.latencies.push(since.elapsed().as_secs_f64() * 1e3);
            self.drawing.push(shown.milliseconds);
        }
        if let Some(frame) = &shown.bent {
            self.densest = self.densest.max(frame.stats.triangles_drawn as f64 / (frame.width * frame.height) as f64);
        }
        self.shown = shown;
        Ok(())
    }
}

impl std::fmt::Display for DragCost {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { scene, pictures, latency_ms: [p50, p95, worst], drawing_ms, cpu_ms, first_ms, rest_ms, .. } = self;
        write!(
            f,
            "{scene:<28} {pictures:>4} {p50:>8.0} {p95:>8.0} {worst:>8.0} {drawing_ms:>8.0} {cpu_ms:>7.0} {first_ms:>8.0} {rest_ms:>8.0} {:>6.2} {:>2} {:>9} {:>6.2}",
            self.width_share, self.coarseness, self.triangles, self.triangles_per_px
        )
    }
}

impl std::fmt::Display for LeastCost {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { scene, cpu_ms, wall_ms, triangles } = self;
        write!(f, "{scene:<28} {cpu_ms:>8.1} {wall_ms:>8.1} {triangles:>9}")
    }
}
