//! Times of frames: straight, with a kink, curved; scenes as in the first table of the paper.

use crate::easel::{Easel, bent, straight, with_boxes};
use crate::figure_set::{Facts, Figure, Table};
use crate::sheet::Panel;
use anyhow::Result;
use belvedere::Session;
use belvedere::core::DVec3;
use belvedere::core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere::cpu::CpuRenderer;
use belvedere::scene::{BoxShape, Color, Frame, Light, Progress, RenderJob, RenderOptions, Renderer};
use std::time::Instant;

const BLOCKS: &str = include_str!("scenes/mast.toml");
const DNA: &str = include_str!("../../../../scenes/dna.toml");
const CANYON: &str = include_str!("../../../../scenes/canyon_preview.toml");
const CITY: &str = include_str!("../../../../scenes/town.toml");
const ENGINE: &str = include_str!("../../../../scenes/engine_curved_rays.toml");

/// Size of the measured frames, pixels.
const IMAGE: [u32; 2] = [1280, 720];
/// Factor by which panels are smaller than the frames.
const SMALLER: usize = 3;
/// Rounds of frames, after one that fills the caches; the fastest frame of each camera counts.
const ROUNDS: usize = 1;
/// Houses along a side of the blocks.
const SIDE: u32 = 60;
/// Depths of the turn's planes, shares of the depth of the scene's middle; sideways distance of the second viewpoint, a share of it too.
const PLANES: [f64; 3] = [0.8, 1.0, 1.2];
const ASIDE: f64 = 0.25;

/// A scene of the table, with the figures of the paper for its own scene: load, and frames per second straight, with a kink, curved.
struct Load {
    name: &'static str,
    scene: &'static str,
    paper: &'static str,
    paper_hz: [f64; 3],
}

const LOADS: [Load; 5] = [
    Load { name: "blocks", scene: BLOCKS, paper: "43 thousand triangles", paper_hz: [153.0, 136.0, 137.0] },
    Load { name: "DNA", scene: DNA, paper: "4.11 million triangles", paper_hz: [48.0, 32.0, 23.0] },
    Load { name: "canyon", scene: CANYON, paper: "2.17 million triangles", paper_hz: [99.0, 56.0, 52.0] },
    Load { name: "city", scene: CITY, paper: "10.35 million triangles", paper_hz: [2.8, 2.8, 2.8] },
    Load { name: "engine", scene: ENGINE, paper: "256 x 256 x 110 voxels", paper_hz: [7.9, 6.7, 4.1] },
];

/// The table, and the curved picture of each scene.
pub(super) fn times(easel: &Easel<'_>) -> Result<Figure> {
    let head = ["scene", "size", "straight", "C0", "curved", "C0 to straight", "curved to straight"];
    let paper = ["paper: size", "paper: C0 to straight", "paper: curved to straight"];
    let (mut panels, mut rows, mut facts) = (Vec::new(), Vec::new(), Facts::new());
    for load in &LOADS {
        let (ms, frame) = measured(&cameras(&load.open(easel)?)?)?;
        let [straight, c0, curved] = ms;
        let [hz_straight, hz_c0, hz_curved] = load.paper_hz;
        let mut row = vec![load.name.to_owned(), size(&frame)];
        row.extend(ms.map(|ms| format!("{ms:.1} ms")));
        row.extend([c0 / straight, curved / straight].map(|r| format!("{r:.2}")));
        row.push(load.paper.to_owned());
        row.extend([hz_straight / hz_c0, hz_straight / hz_curved].map(|r| format!("{r:.2}")));
        rows.push(row);
        facts.insert(load.name, curved / straight);
        let note = format!("curved {curved:.0} ms, straight {straight:.0} ms");
        panels.push(Panel { title: load.name.into(), note, frame: smaller(&frame) });
    }
    let table = Table { head: head.iter().chain(&paper).map(|s| (*s).to_owned()).collect(), rows };
    Ok(Figure { panels, columns: 3, facts, table: Some(table), ..Figure::default() })
}

impl Load {
    /// The scene without stages and constructor, which would bend its view.
    fn open(&self, easel: &Easel<'_>) -> Result<Session> {
        let plain = |text: &'static str| {
            ["[[stage]]", "[constructor]"].iter().fold(text, |t, end| t.split(end).next().unwrap_or(t))
        };
        let session = easel.open(plain(self.scene), IMAGE)?;
        let blocks = || (0..SIDE * SIDE).map(|i| house(i % SIDE, i / SIDE)).collect();
        if self.scene != BLOCKS {
            return Ok(session);
        }
        let built = with_boxes(&session, [("blocks".to_owned(), blocks())]);
        let mut scene = built.scene().clone();
        scene.layers.retain(|layer| layer.id == "blocks");
        Ok(Session::from_parts(scene, session.view().clone()))
    }
}

/// A house of the blocks.
fn house(column: u32, row: u32) -> BoxShape {
    let mixed = (column * 7919 + row * 104_729) % 101;
    let shade = 190 + (mixed % 50) as u8;
    BoxShape {
        base: DVec3::new(6.0 * (f64::from(column) - 0.5 * f64::from(SIDE)), 6.0 * f64::from(row), 12.0),
        size: DVec3::new(4.0, 4.0, 3.0 + 0.12 * f64::from(mixed)),
        yaw: 0.0,
        color: Color::rgb(shade, shade - 10, shade - 24),
    }
}

/// Straight, with a kink, curved.
fn cameras(session: &Session) -> Result<[Session; 3]> {
    let pinhole = session.view().pinhole();
    // Without the ground, which may reach far beyond the models.
    let mut things = session.scene().layers.iter().filter(|l| l.id != "ground").map(belvedere::scene::Layer::bounds);
    let bounds = things.rfind(|b| !b.is_empty()).unwrap_or_else(|| session.scene().bounds());
    let middle = (bounds.center() - pinhole.eye).dot(pinhole.forward);
    let [t0, t1, t2] = PLANES.map(|share| pinhole.eye + share * middle * pinhole.forward);
    let pencil = Pencil::Parallel { normal: -pinhole.forward };
    let viewpoint = pinhole.eye + ASIDE * middle * pinhole.right;
    let turn = [TurnSpec { viewpoint, t0, t1, t2, pencil, m: Sharpness::Bend }];
    Ok([straight(session), bent(session, Model::C0, &turn)?, bent(session, Model::Modified, &turn)?])
}

/// Wall time of the fastest frame of each camera, milliseconds, without cast shadows; and the last curved frame.
fn measured(sessions: &[Session; 3]) -> Result<([f64; 3], Frame)> {
    let (renderer, progress, light) = (CpuRenderer::default(), Progress::silent(), Light::default());
    let options = RenderOptions { samples: 1, lod_px: 0.0, ..RenderOptions::default() };
    let mut best = [f64::INFINITY; 3];
    let mut frame = Frame::default();
    for round in 0..=ROUNDS {
        for (session, best) in sessions.iter().zip(&mut best) {
            let (scene, view) = (session.scene(), session.view());
            let job = RenderJob { scene, view, light: &light, options: &options, progress: &progress };
            let start = Instant::now();
            frame = renderer.render(&job)?;
            if round > 0 {
                *best = best.min(1e3 * start.elapsed().as_secs_f64());
            }
        }
    }
    Ok((best, frame))
}

/// The number of triangles or samples in words.
fn size(frame: &Frame) -> String {
    match (frame.stats.triangles_in, frame.stats.samples) {
        (0, samples) => format!("{:.1} million samples", 1e-6 * samples as f64),
        (n, _) if n < 1_000_000 => format!("{} thousand triangles", n / 1000),
        (n, _) => format!("{:.2} million triangles", 1e-6 * n as f64),
    }
}

/// A frame of a third of the width and height, each pixel the mean of nine.
fn smaller(frame: &Frame) -> Frame {
    let (width, height) = (frame.width / SMALLER, frame.height / SMALLER);
    let count = SMALLER * SMALLER;
    let mean = |x: usize, y: usize| {
        let at = |k: usize| (y * SMALLER + k / SMALLER) * frame.width + x * SMALLER + k % SMALLER;
        std::array::from_fn(|c| {
            ((0..count).map(|k| u32::from(frame.color[at(k)][c])).sum::<u32>() / count as u32) as u8
        })
    };
    let color = (0..width * height).map(|i| mean(i % width, i / width)).collect();
    Frame { width, height, color, ..Frame::default() }
}
