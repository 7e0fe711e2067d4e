//! Laws of the highlights, tested on small drawn scenes.

use super::shift::{Moved, Parts, Straight, survey};
use super::*;
use belvedere_core::grid::Grid;
use belvedere_core::map::curved_rays::{CurvedRays, Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::{DVec2, DVec3, EarthCurvature, Pinhole, Projection, Stage, TerrainDisocclusion};
use belvedere_cpu::CpuRenderer;
use belvedere_scene::{Aux, BoxLayer, BoxShape, Color, LayerKind, Light, Progress, RenderJob, RenderOptions, Renderer};
use belvedere_sight::{Obstacles, SightOptions};

const SIZE: [u32; 2] = [160, 120];

/// A wall 50 in front of the eye and a block 110 in front of it, half hidden by the wall.
fn scene() -> Scene {
    let shape = |base: [f64; 3], size: [f64; 3]| BoxShape {
        base: DVec3::from_array(base),
        size: DVec3::from_array(size),
        yaw: 0.3,
        color: Color::rgb(180, 60, 60),
    };
    let layer = |shape| LayerKind::Boxes(BoxLayer::new(vec![shape]));
    let mut scene = Scene::default().with_layer("wall", layer(shape([-4.0, 50.0, -12.0], [16.0, 3.0, 20.0])));
    scene = scene.with_layer("block", layer(shape([6.0, 110.0, -12.0], [24.0, 8.0, 30.0])));
    scene.layers[1].must_see = true;
    // Outside the straight picture, inside the bent one.
    scene = scene.with_layer("aside", layer(shape([-62.0, 116.0, -12.0], [12.0, 8.0, 30.0])));
    scene
}

fn pinhole() -> Pinhole {
    let lens = Projection::Perspective { fov_y: 40f64.to_radians() };
    Pinhole::look_at(DVec3::ZERO, DVec3::new(0.0, 100.0, -2.0), DVec3::Z, lens, SIZE, 1.0, None).unwrap()
}

/// Turns to viewpoints at the side, at these distances.
fn view(turns: &[(f64, f64)]) -> View {
    let turn = |&(aside, y): &(f64, f64)| TurnSpec {
        viewpoint: DVec3::new(aside, 0.0, 0.0),
        t0: DVec3::new(0.0, y, 0.0),
        t1: DVec3::new(0.0, y + 6.0, 0.0),
        t2: DVec3::new(0.0, y + 12.0, 0.0),
        pencil: Pencil::Parallel { normal: DVec3::Y },
        m: Sharpness::Bend,
    };
    let turns: Vec<TurnSpec> = turns.iter().map(turn).collect();
    let rays = CurvedRays::new(&pinhole(), Model::Modified, &turns).unwrap();
    View::new(pinhole(), vec![Stage::CurvedRays(rays)]).unwrap()
}

fn drawn(scene: &Scene, view: &View) -> Frame {
    let options = RenderOptions { marks: false, aux: Aux { world: true, exact: true }, ..RenderOptions::default() };
    let (light, progress) = (Light::default(), Progress::default());
    CpuRenderer::default()
        .render(&RenderJob { scene, view, light: &light, options: &options, progress: &progress })
        .unwrap()
}

fn moved(parts: &Parts, bent: &Frame, straight: Option<&Frame>) -> Vec<Option<Moved>> {
    survey(parts, bent, straight).pixels
}

#[test]
fn nothing_moves_and_nothing_is_revealed_without_a_bend() {
    let earth = Stage::EarthCurvature(EarthCurvature { eye: DVec3::ZERO, radius: 6_371_000.0, refraction: 0.13 });
    for view in [View::straight(pinhole()), View::new(pinhole(), vec![earth]).unwrap()] {
        let frame = drawn(&scene(), &view);
        let parts = Parts::of(&view);
        assert_eq!(parts.names, [] as [String; 0]);
        let all = moved(&parts, &frame, Some(&frame));
        assert!(all.iter().flatten().count() > 1000);
        for m in all.iter().flatten() {
            assert!(m.px < 1e-2 && m.part.is_none() && m.straight == Straight::Shown, "{m:?}");
        }
    }
}

#[test]
fn distances_are_those_of_the_straight_image_and_nothing_moves_before_the_turn() {
    let view = view(&[(20.0, 70.0)]);
    let frame = drawn(&scene(), &view);
    let all = moved(&Parts::of(&view), &frame, None);
    let world = frame.world.as_ref().unwrap();
    let (mut near, mut far) = (0, 0);
    for (i, m) in all.iter().enumerate() {
        let Some(m) = m else { continue };
        let p = DVec3::from_array(world[i]);
        let pixel = DVec2::new((i % 160) as f64 + 0.5, (i / 160) as f64 + 0.5);
        let truth = view.straightened().project(p).unwrap().pixel.distance(pixel);
        assert!((f64::from(m.px) - truth).abs() < 1e-4 * (1.0 + truth), "{m:?} {truth}");
        if p.y < 60.0 {
            near += 1;
            assert!(m.px < 1e-2 && m.part.is_none(), "{m:?}");
        } else {
            far += 1;
            assert!(m.px > 1.0 && m.part == Some(0), "{m:?}");
        }
    }
    assert!(near > 500 && far > 500, "{near} {far}");
}

#[test]
fn the_last_turn_that_reaches_a_point_is_told_and_how_far_each_moves_it() {
    // The first turn, in front of the wall, shifts the rays a little to one side; the second, behind the wall, to the other.
    let view = view(&[(2.0, 20.0), (-24.0, 70.0)]);
    let parts = Parts::of(&view);
    assert_eq!(parts.names, ["turn 1", "turn 2"]);
    let frame = drawn(&scene(), &view);
    let found = survey(&parts, &frame, None);
    let first = self::view(&[(2.0, 20.0)]);
    let (mut seen, mut most) = (0usize, [0.0f64; 2]);
    for (i, (p, m)) in frame.world.as_ref().unwrap().iter().zip(&found.pixels).enumerate() {
        let Some(m) = m else { continue };
        assert_eq!(m.part, Some(if p[1] < 60.0 { 0 } else { 1 }), "{p:?} {m:?}");
        let p = DVec3::from_array(*p);
        let [before, middle] = [&view.straightened(), &first].map(|v| v.project(p).unwrap().pixel);
        let end = DVec2::new((i % 160) as f64 + 0.5, (i / 160) as f64 + 0.5);
        most = [most[0].max(before.distance(middle)), most[1].max(middle.distance(end))];
        seen += 1;
    }
    let record = record(&parts, &found, &[HighlightMark::Stages], 200.0);
    for (part, most) in record.parts.iter().zip(most) {
        assert!((part.max_px - most).abs() < 1e-9 && most > 1.0, "{part:?} {most}");
    }
    let shown: f64 = record.parts.iter().map(|p| p.shown_share).sum();
    assert!((shown - 1.0).abs() < 1e-12 && record.parts[0].share > record.parts[1].share, "{seen}: {record:?}");
    assert_eq!((record.revealed_share, record.outside_share), (None, None));
    assert!(record.max_px >= record.mean_px && record.mean_px > 0.0);
}

#[test]
fn the_stage_that_moves_a_point_farthest_is_told() {
    // Everything is lowered by 6, then a turn moves everything behind it a little.
    let delta = Grid::new(DVec2::new(-80.0, 160.0), DVec2::splat(20.0), 9, 9, vec![-6.0; 81]).unwrap();
    let lowered = TerrainDisocclusion::new(delta);
    let Some(Stage::CurvedRays(rays)) = view(&[(1.0, 70.0)]).stages().last().cloned() else { panic!("rays") };
    let view = View::new(pinhole(), vec![Stage::TerrainDisocclusion(lowered), Stage::CurvedRays(rays)]).unwrap();
    let parts = Parts::of(&view);
    assert_eq!(parts.names, ["terrain disocclusion", "curved rays"]);
    let frame = drawn(&scene(), &view);
    let found = survey(&parts, &frame, None);
    for m in found.pixels.iter().flatten() {
        assert_eq!(m.part, Some(0), "6 down at a distance of 110 at most is more than 1 aside beyond 76: {m:?}");
    }
    assert!(found.parts[0].1 > found.parts[1].1 && found.parts[1].1 > 0.0, "{:?}", found.parts);
}

#[test]
fn what_is_revealed_is_what_straight_lines_of_sight_do_not_reach() {
    let (scene, view) = (scene(), view(&[(20.0, 70.0)]));
    let straight = view.straightened();
    let (bent, plain) = (drawn(&scene, &view), drawn(&scene, &straight));
    let all = moved(&Parts::of(&view), &bent, Some(&plain));
    let obstacles = Obstacles::new(&scene);
    let sight = SightOptions { chord_m: 0.01, cap_m: 0.0, guard_m: 0.0 };
    let (mut agree, mut hidden, mut outside, mut count) = (0, 0, 0, 0);
    for (p, m) in bent.world.as_ref().unwrap().iter().zip(&all) {
        let Some(m) = m else { continue };
        let p = DVec3::from_array(*p);
        let Ok(image) = straight.project(p) else { panic!("all of it lies before the eye") };
        if !straight.pinhole().contains(image.pixel) {
            assert_eq!(m.straight, Straight::Outside);
            outside += 1;
            continue;
        }
        // A little in front of the surface, so that the surface does not hide itself.
        let before = p * (1.0 - 1e-3);
        let clear = obstacles.clearance(&straight, (before, 0.0), (image.pixel, image.depth * (1.0 - 1e-3)), &sight);
        count += 1;
        hidden += usize::from(clear < 0.0);
        agree += usize::from((clear < 0.0) == (m.straight == Straight::Hidden));
    }
    assert!(hidden > 100 && count - hidden > 500 && outside > 20, "{hidden} of {count} hidden, {outside} outside");
    assert!(agree as f64 > 0.98 * count as f64, "{agree} of {count} agree");
}

#[test]
fn leaders_run_from_the_bent_to_the_straight_image() {
    let (scene, view) = (scene(), view(&[(20.0, 70.0)]));
    let mut frame = drawn(&scene, &view);
    let bare = frame.clone();
    let bare = Bare { bent: &bare, straight: None };
    let record = paint(&mut frame, &bare, &scene, &view, &[HighlightMark::GhostBox], 200.0);
    let [ghost] = &record.ghosts[..] else { panic!("only the block must be seen: {record:?}") };
    let middle = scene.layers[1].bounds().center();
    let [bent, straight] = [&view, &view.straightened()].map(|v| v.project(middle).unwrap().pixel);
    assert_eq!(ghost.layer, "block");
    assert_eq!((ghost.bent_px, ghost.straight_px), (Some(bent.to_array()), Some(straight.to_array())));
    assert_eq!(ghost.shift_px, Some(bent.distance(straight)));
    assert!(frame.color != bare.bent.color, "and are drawn");
}

#[test]
fn colours_saturate_at_the_end_of_the_ramp() {
    let (scene, view) = (scene(), view(&[(20.0, 70.0)]));
    let bent = drawn(&scene, &view);
    let bare = Bare { bent: &bent, straight: None };
    let all = moved(&Parts::of(&view), &bent, None);
    let (mut frame, ramp) = (bent.clone(), 5.0);
    paint(&mut frame, &bare, &scene, &view, &[HighlightMark::Shift], ramp);
    for ((after, before), m) in frame.color.iter().zip(&bent.color).zip(&all) {
        let expected = match m {
            None => *before,
            Some(m) => heat::tinted(*before, heat::ramp((f64::from(m.px) / ramp).min(1.0))),
        };
        assert_eq!(*after, expected, "{m:?}");
    }
    assert!(all.iter().flatten().any(|m| f64::from(m.px) > ramp), "some move farther than the ramp goes");
}

#[test]
fn surfaces_are_coloured_in_one_way() {
    use HighlightMark::{GhostBox, Revealed, Shift, Stages};
    let scene = OverlayDoc { heatmap: true, highlight: vec![Revealed], ..OverlayDoc::default() };
    let chosen = |asked: &[HighlightMark], heat, scene: &OverlayDoc| chosen((asked, heat), scene);
    assert_eq!(chosen(&[], false, &scene).unwrap(), (vec![Revealed], true));
    assert_eq!(chosen(&[Shift], false, &scene).unwrap(), (vec![Shift], false), "what is asked for comes first");
    assert_eq!(chosen(&[GhostBox], false, &scene).unwrap(), (vec![GhostBox], true));
    let coloured = OverlayDoc { highlight: vec![Stages, Revealed], ..OverlayDoc::default() };
    assert_eq!(chosen(&[], true, &coloured).unwrap(), (vec![Revealed], true));
    for (asked, heat) in [(&[Shift, Stages][..], false), (&[Shift], true), (&[Stages], true)] {
        let refused = chosen(asked, heat, &OverlayDoc::default()).unwrap_err().to_string();
        assert!(refused.contains("choose one"), "{refused}");
    }
}
