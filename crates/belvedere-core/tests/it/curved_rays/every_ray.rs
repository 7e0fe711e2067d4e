//! The law of curved rays, for valid cameras of every kind: each point of a ray has the ray's pixel and the point's depth among its
//! images.

use belvedere_core::map::curved_rays::CurvedRays;
use belvedere_core::map::split_rays::ImageRegion;
use belvedere_core::{Aabb, DVec2, Stage, View};
use belvedere_testkit::Random;
use belvedere_testkit::rays::{MODELS, RandomRays, random_split};

const IMAGE: [u32; 2] = [640, 480];
/// More than the cameras: some seeds give no valid one.
const SEEDS: u64 = 16_800;
/// Pixels per camera.
const PIXELS: usize = 4;

/// Counts and errors of what was checked.
#[derive(Debug, Default)]
struct Tried {
    points: usize,
    /// Points beyond the common line of the turn before or after their segment; `before` counts those on the segment before the turn.
    beyond_line: usize,
    before: usize,
    /// Points with more than one image.
    twice: usize,
    worst_px: f64,
    worst_depth: f64,
    /// Images of random points that were traced back along their rays.
    back: usize,
    /// Messages on points whose images lack the expected pixel and depth.
    wrong: Vec<String>,
}

impl Tried {
    fn add(&mut self, other: Self) {
        self.points += other.points;
        self.beyond_line += other.beyond_line;
        self.before += other.before;
        self.twice += other.twice;
        self.back += other.back;
        self.worst_px = self.worst_px.max(other.worst_px);
        self.worst_depth = self.worst_depth.max(other.worst_depth);
        self.wrong.extend(other.wrong);
    }
}

/// A random position in the picture, often a corner or on a side.
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

/// * `region`: the part of the picture that the rays draw.
fn check(
    view: &View,
    rays: &CurvedRays,
    region: Option<&ImageRegion>,
    random: &mut Random,
    tried: &mut Tried,
    name: &str,
) {
    for _ in 0..PIXELS {
        let pixel = pixel(random);
        if region.is_some_and(|region| !region.contains(pixel)) {
            continue;
        }
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
            let beyond =
                |k: &usize| turns.get(*k).is_some_and(|t| t.a.at(seen.point) < 0.0 && t.b.at(seen.point) < 0.0);
            if seen.segment % 2 == 0 && near.iter().any(beyond) {
                tried.beyond_line += 1;
                tried.before += usize::from(beyond(&near[0]));
            }
        }
    }
}

fn rays_of(view: &View) -> CurvedRays {
    view.curved_rays().cloned().expect("curved rays")
}

/// The converse: the ray of every image of a point passes through the point.
fn check_back(view: &View, random: &mut Random, tried: &mut Tried, name: &str) {
    let around = Aabb { min: view.pinhole().eye - 600.0, max: view.pinhole().eye + 600.0 };
    for _ in 0..10 {
        let p = random.point(&around);
        for image in view.project_all(p).iter().filter(|image| view.pinhole().contains(image.pixel)) {
            let seen = view.ray(image.pixel).at(image.depth);
            let off = seen.map_or(f64::INFINITY, |seen| seen.point.distance(p));
            if !(off < 1e-6) {
                tried.wrong.push(format!("{name}: {p} has the image {image:?}, whose ray passes it by {off}"));
            }
            tried.back += 1;
        }
    }
}

/// Cameras from `seeds`, chains of 1 to 6 turns of all models, and every sixth one with rays that part.
fn try_cameras(seeds: std::ops::Range<u64>) -> ([usize; 7], Tried) {
    let (mut tried, mut cameras) = (Tried::default(), [0; 7]);
    for seed in seeds {
        let mut random = Random::new(seed);
        let (model, turns) = (MODELS[seed as usize % 5], seed as usize / 5 % 7);
        let name = format!("camera {seed}, {model:?}");
        let view = if turns == 0 {
            let Some((view, _)) = random_split(&mut random, model, IMAGE) else { continue };
            for branch in view.split_rays().expect("rays that part").branches() {
                check(&view, &branch.rays, Some(&branch.region), &mut random, &mut tried, &name);
            }
            view
        } else {
            let Some(made) = RandomRays::new(&mut random, model, turns, IMAGE) else { continue };
            let view = made.view();
            check(&view, &rays_of(&view), None, &mut random, &mut tried, &name);
            view
        };
        check_back(&view, &mut random, &mut tried, &name);
        cameras[turns] += 1;
    }
    (cameras, tried)
}

/// 10 000 cameras.
#[test]
fn every_point_of_a_ray_has_its_pixel_and_depth() {
    let threads = 4;
    let part = |i: u64| std::thread::spawn(move || try_cameras(SEEDS * i / threads..SEEDS * (i + 1) / threads));
    let parts: Vec<_> = (0..threads).map(part).collect();
    let (mut cameras, mut tried) = ([0; 7], Tried::default());
    for part in parts {
        let (some, more) = part.join().expect("no panic");
        (0..7).for_each(|k| cameras[k] += some[k]);
        tried.add(more);
    }
    let (count, some) = (tried.wrong.len(), &tried.wrong[..tried.wrong.len().min(8)]);
    let figures = format!(
        "{cameras:?} cameras, {} points, {} beyond a common line ({} before the turn), {} seen twice, {} gone back; worst {:e} px, depth {:e}",
        tried.points, tried.beyond_line, tried.before, tried.twice, tried.back, tried.worst_px, tried.worst_depth
    );
    assert!(count == 0, "{count} wrong of {figures}: {some:#?}");
    assert!(cameras.iter().sum::<usize>() >= 10_000 && cameras.iter().all(|n| *n > 500), "{cameras:?}");
    assert!(
        tried.beyond_line > 1000 && tried.before > 200 && tried.twice > 100 && tried.back > 3000,
        "the cameras are too tame: {figures}"
    );
}
