//! Target tracking of what a selection chooses of a molecule, in a film round it, judged by pixels.

use belvedere_construct::rays::{FilmPlanner, Target, TrackingMemory, TrackingOptions, track_target};
use belvedere_core::{DVec3, Pinhole, Projection, View};
use belvedere_cpu::CpuRenderer;
use belvedere_scene::molecule::{MoleculeLayer, MoleculeStyle, Selection};
use belvedere_scene::{Frame, Light, Progress, RenderJob, RenderOptions, Renderer, Scene};

const SELECTED: &str = "chain A and resi 3";
const FRAMES: usize = 16;
const DT: f64 = 1.0 / 6.0;

fn draw(scene: &Scene, view: &View) -> Frame {
    let (light, progress) = (Light::default(), Progress::silent());
    let options = RenderOptions { samples: 1, ..RenderOptions::default() };
    CpuRenderer::default()
        .render(&RenderJob { scene, view, light: &light, options: &options, progress: &progress })
        .unwrap()
}

/// The helix, or what is selected of it alone.
fn scene(only_selected: bool) -> Scene {
    let (made, _) = belvedere_builtin::dna(7, 6).unwrap();
    let Some(dna) = made.layers[0].kind.molecule() else { panic!("a molecule") };
    let selected = Selection::parse(SELECTED).unwrap();
    let selection = if only_selected { selected.clone() } else { Selection::all() };
    let style = MoleculeStyle { selection, detail: Some(1), ..MoleculeStyle::default() };
    let layer = MoleculeLayer::new(dna.molecule.clone(), &style, dna.placement).unwrap().wanting(selected);
    Scene { unit: made.unit, ..Scene::default() }.with_layer("dna", layer)
}

/// The camera goes a third round.
fn view(scene: &Scene, frame: usize) -> View {
    let bounds = scene.bounds();
    let (sin, cos) = (2.4 * frame as f64 / FRAMES as f64).sin_cos();
    let eye = bounds.center() + 1.5 * (bounds.max - bounds.min).length() * DVec3::new(sin, -cos, 0.2);
    let lens = Projection::Perspective { fov_y: 40f64.to_radians() };
    View::straight(Pinhole::look_at(eye, bounds.center(), DVec3::Z, lens, [160, 90], 0.1, None).unwrap())
}

#[test]
fn a_film_round_a_helix_keeps_a_nucleotide_of_it_in_sight() {
    let (full, alone) = (scene(false), scene(true));
    let target = Target::layer(&full, 0).unwrap();
    assert!(target.own_parts.is_some() && target.radii.len() == target.points.len());
    let options = TrackingOptions { grow_px: 1.0, ..TrackingOptions::default() };
    let mut planner = FilmPlanner::new(options, DT).unwrap();
    loop {
        (0..FRAMES).for_each(|frame| planner.add(&full, &view(&full, frame), &target));
        if !planner.wants_more() {
            break;
        }
    }
    let bends = planner.finish();
    // Share of the pixels of the target alone that the whole molecule leaves.
    let share = |view: &View| {
        let (alone, full) = (draw(&alone, view), draw(&full, view));
        let own: Vec<usize> = (0..alone.id.len()).filter(|i| alone.id[*i] == 1).collect();
        let seen = own.iter().filter(|i| (full.depth[**i] - alone.depth[**i]).abs() <= 1e-3 * alone.depth[**i]).count();
        seen as f64 / own.len().max(1) as f64
    };
    let (mut straight, mut bent, mut memory) = (Vec::new(), Vec::new(), TrackingMemory::default());
    for (frame, bend) in bends.iter().enumerate() {
        let base = view(&full, frame);
        memory.follow(Some(*bend));
        let tracked = track_target(&full, &base, &target, &options, Some(DT), &mut memory).unwrap();
        straight.push(share(&base));
        bent.push(share(&tracked.view));
    }
    let hidden = |shares: &[f64]| shares.iter().filter(|s| **s < 0.95).count();
    let signs: Vec<bool> =
        bends.windows(2).map(|b| b[1].f - b[0].f).filter(|d| d.abs() > 1e-9).map(|d| d > 0.0).collect();
    let turns = signs.windows(2).filter(|s| s[0] != s[1]).count();
    assert!(hidden(&straight) >= FRAMES / 3, "the helix hides hardly anything: {straight:?}");
    assert!(8 * hidden(&bent) <= FRAMES, "straight {straight:?}, bent {bent:?}");
    assert!(turns <= 4, "f turns round {turns} times: {bends:?}");
}
