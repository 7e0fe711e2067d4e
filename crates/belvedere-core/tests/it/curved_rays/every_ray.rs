//! The law of curved rays, for cameras of every kind that the conditions let through: what a ray passes has the ray's pixel and depth
//! among its images.

use belvedere_core::map::curved_rays::{CurvedRays, Model};
use belvedere_core::map::split_rays::SplitRays;
use belvedere_core::{DVec2, Miss, Stage, View};
use belvedere_testkit::Random;
use belvedere_testkit::rays::{MODELS, RandomRays, random_split};

const IMAGE: [u32; 2] = [640, 480];

/// What has been looked at.
#[derive(Debug, Default)]
struct Tried {
    points: usize,
    /// Beyond the common line of a turn that their ray comes to, and of these before and after the turn.
    beyond_line: usize,
    before: usize,
    /// Seen more than once.
    twice: usize,
    worst_px: f64,
    worst_depth: f64,
    /// Points without their pixel and depth.
    wrong: Vec<String>,
}

/// A pixel of the picture; corners and sides too.
fn pixel(random: &mut Random) -> DVec2 {
    let size = DVec2::from_array(IMAGE.map(f64::from));
    let at = DVec2::new(random.unit(), random.unit());
    let at = match random.below(4) {
        0 => DVec2::new(at.x.round(), at.y.round()),
        1 => DVec2::new(at.x.round(), at.y),
        _ => at,
    };
    at * size
}

/// Depths on every piece of a ray, at its joints, and far behind the last one.
fn depths(view: &View, rays: &CurvedRays, pixel: DVec2, random: &mut Random) -> Vec<f64> {
    let single = View::new(view.pinhole().clone(), vec![Stage::CurvedRays(rays.clone())]).unwrap();
    let pieces = single.ray(pixel).pieces().expect("a ray through the picture of a valid camera");
    let mut depths = Vec::new();
    for piece in &pieces {
        let [from, to] = piece.depth;
        let to = if to.is_finite() { to } else { from + 10f64.powf(random.range(0.0, 4.0)) * (from + 100.0) };
        depths.extend([from + random.unit() * (to - from), to]);
    }
    depths.retain(|depth| *depth > 0.0);
    depths
}

fn check(view: &View, rays: &CurvedRays, random: &mut Random, tried: &mut Tried, name: &str) {
    for _ in 0..6 {
        let pixel = pixel(random);
        for depth in depths(view, rays, pixel, random) {
            let Ok(seen) = view.ray(pixel).at(depth) else { panic!("{name}: no point of {pixel} at {depth}") };
            let images = view.project_all(seen.point);
            let off = images.iter().map(|i| (i.pixel.distance(pixel), (i.depth / depth - 1.0).abs()));
            let (px, share) = off.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, f64::INFINITY));
            if !(px < 1e-6 && share < 1e-9) {
                tried.wrong.push(format!("{name}: {pixel} at {depth} sees {seen:?}, which is off by {px} px, {share}"));
                continue;
            }
            assert_eq!(view.project(seen.point).as_ref(), Ok(&images[0]), "{name}: the first image is the one");
            tried.points += 1;
            tried.twice += usize::from(images.len() > 1);
            (tried.worst_px, tried.worst_depth) = (tried.worst_px.max(px), tried.worst_depth.max(share));
            let turns = rays.turns();
            let near = [seen.segment as usize / 2, (seen.segment as usize / 2).wrapping_sub(1)];
            let beyond = |k: &usize| turns.get(*k).is_some_and(|t| t.a.at(seen.point) < 0.0 && t.b.at(seen.point) < 0.0);
            if seen.segment % 2 == 0 && near.iter().any(beyond) {
                tried.beyond_line += 1;
                tried.before += usize::from(beyond(&near[0]));
            }
        }
    }
}

/// 10 000 cameras: chains of 1 to 6 turns, all models.
#[test]
fn every_point_of_a_ray_has_its_pixel_and_depth() {
    let mut random = Random::new(0x0e0e);
    let (mut tried, mut cameras) = (Tried::default(), [0; 6]);
    for i in 0.. {
        let (model, turns) = (MODELS[i % 5], 1 + i / 5 % 6);
        let Some(made) = RandomRays::new(&mut random, model, turns, IMAGE) else { continue };
        let view = made.view();
        let name = format!("camera {i}, {model:?}");
        let Some(Stage::CurvedRays(rays)) = view.stages().last().cloned() else { panic!("curved rays") };
        check(&view, &rays, &mut random, &mut tried, &name);
        cameras[turns - 1] += 1;
        if cameras.iter().sum::<usize>() == 10_000 {
            break;
        }
        assert!(i < 40_000, "{cameras:?}");
    }
    let (count, some) = (tried.wrong.len(), &tried.wrong[..tried.wrong.len().min(8)]);
    assert!(count == 0, "{count} of {} points: {some:#?}", tried.points);
    println!("{cameras:?} {tried:?}");
    assert!(cameras.iter().all(|n| *n > 500), "{cameras:?}");
    assert!(tried.beyond_line > 1000 && tried.before > 200 && tried.twice > 100, "the cameras are too tame: {tried:?}");
}
