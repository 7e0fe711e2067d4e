//! Pictures of branching rays: each side equals the picture of its own branch, and both renderers and the tracer agree.

use crate::exact::difference;
use crate::support::{hills, layer, options, pinhole, render, scene, terrain};
use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::map::split_rays::{Fork, Seam, SplitSpec};
use belvedere_core::{DVec2, DVec3, SplitRays, Stage, View};
use belvedere_scene::{LayerKind, Scene};
use belvedere_sight::trace::Tracer;

const IMAGE: [u32; 2] = [160, 120];

fn ground() -> Scene {
    scene(vec![layer("ground", LayerKind::Terrain(terrain(hills(129, 25.0, 260.0, 11))))])
}

/// The rays of the left half of the picture bend to the west, those of the right half to the east.
fn parting(model: Model) -> View {
    let ph = pinhole(DVec3::new(0.0, -1500.0, 700.0), DVec3::ZERO, 40.0, IMAGE);
    let side = |x: f64| {
        let at = |y: f64| DVec3::new(0.0, y, 0.0);
        let viewpoint = DVec3::new(x, -1500.0, 700.0);
        let pencil = Pencil::Parallel { normal: DVec3::Y };
        let turn = TurnSpec { viewpoint, t0: at(-200.0), t1: at(0.0), t2: at(200.0), pencil, m: Sharpness::Bend };
        SplitSpec { turns: vec![turn], fork: None }
    };
    let fork = Fork { seam: Seam::MIDDLE, sides: [side(420.0), side(-420.0)], merge: None };
    let spec = SplitSpec { turns: Vec::new(), fork: Some(Box::new(fork)) };
    let rays = SplitRays::new(&ph, model, &spec).unwrap_or_else(|e| panic!("{e}"));
    View::new(ph, vec![Stage::SplitRays(rays)]).expect("one stage is in order")
}

#[test]
fn each_side_of_the_seam_is_the_picture_of_its_branch() {
    let (scene, view) = (ground(), parting(Model::Modified));
    let whole = render(&scene, &view, &options(1));
    let split = view.split_rays().expect("rays part");
    let parts: Vec<_> = split.branches().iter().map(|b| render(&scene, &view.along(b), &options(1))).collect();
    assert_eq!(parts.len(), 2);
    let mut apart = 0;
    for i in 0..whole.color.len() {
        let own = usize::from(i % IMAGE[0] as usize >= IMAGE[0] as usize / 2);
        assert_eq!(whole.color[i], parts[own].color[i], "pixel {i}");
        assert_eq!(whole.depth[i].to_bits(), parts[own].depth[i].to_bits(), "pixel {i}");
        assert_eq!(whole.id[i], parts[own].id[i], "pixel {i}");
        apart += usize::from(whole.color[i] != parts[1 - own].color[i]);
    }
    assert!(apart > 3000, "the branches see different things: {apart} pixels");
}

#[test]
fn smoothed_pictures_differ_from_their_branches_along_the_seam_alone() {
    let (scene, view) = (ground(), parting(Model::Modified));
    let whole = render(&scene, &view, &options(4));
    let split = view.split_rays().expect("rays part");
    let parts: Vec<_> = split.branches().iter().map(|b| render(&scene, &view.along(b), &options(4))).collect();
    let mut blended = 0;
    for i in 0..whole.color.len() {
        let x = i % IMAGE[0] as usize;
        if whole.color[i] != parts[usize::from(x >= IMAGE[0] as usize / 2)].color[i] {
            assert!((78..82).contains(&x), "pixel {i} in column {x}");
            blended += 1;
        }
    }
    assert!(blended > 20, "{blended}");
}

#[test]
fn rasteriser_and_tracer_agree_where_rays_part() {
    for model in [Model::Modified, Model::Original, Model::C0] {
        let d = difference(&ground(), &parting(model));
        assert!(d.judged > d.pixels / 2 && d.is_small(), "{model:?}: {d:?}");
    }
}

#[test]
fn what_the_tracer_meets_projects_to_where_it_looked() {
    let (scene, view) = (ground(), parting(Model::Modified));
    let tracer = Tracer::new(&scene, &view);
    let mut met = 0;
    for k in 0..40 {
        let pixel = DVec2::new(4.0 * f64::from(k) + 1.3, 90.0);
        let Some(hit) = tracer.first_hit(pixel) else { continue };
        let back = view.project(hit.point).expect("in the domain");
        assert!(back.pixel.distance(pixel) < 1e-6, "{pixel} came back as {}", back.pixel);
        met += 1;
    }
    assert!(met >= 36, "{met}");
}
