//! Random chains, twice-seen points, identities and edge cases of the chain.

use super::cameras::{self, Spec, pinhole};
use belvedere_core::map::curved_rays::{CurvedRays, Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::{Aabb, DVec2, DVec3, Miss, SpaceMap, Stage, View};
use belvedere_testkit::Random;
use belvedere_testkit::laws::Similarity;
use glam::DQuat;

const MODELS: [Model; 5] = [Model::Modified, Model::Original, Model::C0, Model::C2, Model::Circular];

fn random_chains(turns: usize, model: Model, count: usize) -> Vec<Spec> {
    let mut random = Random::new(0xc4a1 + turns as u64);
    let mut found = Vec::new();
    for _ in 0..20_000 {
        found.extend(cameras::random_chain(&mut random, turns, model, 0.35));
        if found.len() == count {
            return found;
        }
    }
    panic!("only {} valid chains of {turns} turns", found.len());
}

/// Goal 1e-9 px; the image is 1280 px wide and scenes are some hundred units large.
#[test]
fn round_trips_of_random_chains() {
    let mut worst = 0.0f64;
    for turns in 1..=5 {
        for model in MODELS {
            for spec in random_chains(turns, model, 12) {
                let view = spec.view(model, &Similarity::IDENTITY);
                let mut random = Random::new(turns as u64);
                for _ in 0..60 {
                    let pixel = DVec2::new(random.range(0.0, 1280.0), random.range(0.0, 720.0));
                    let depth = random.range(2.0, 3000.0);
                    let x = view.ray(pixel).at(depth).unwrap().point;
                    let images = view.project_all(x);
                    let error = images.iter().map(|i| (i.pixel - pixel).length()).fold(f64::INFINITY, f64::min);
                    assert!(error < 1e-9, "{model:?}, {turns} turns: {pixel} at {depth} off by {error:e}\n{spec:?}");
                    let error_depth = images.iter().map(|i| (i.depth - depth).abs()).fold(f64::INFINITY, f64::min);
                    assert!(error_depth < 1e-10 * depth, "{model:?}, {turns} turns: depth off by {error_depth:e}");
                    worst = worst.max(error);
                }
            }
        }
    }
    assert!(worst > 0.0 && worst < 2e-10, "worst round trip {worst:e} px");
}

#[test]
fn determinant_is_positive_in_random_chains() {
    for model in MODELS {
        for spec in random_chains(3, model, 20) {
            let rays = spec.rays(model, &Similarity::IDENTITY);
            let view = spec.view(model, &Similarity::IDENTITY);
            for i in 0..200 {
                let pixel = DVec2::new(64.0 * f64::from(i % 21), 72.0 * f64::from(i % 11));
                let x = view.ray(pixel).at(5.0 + 4.0 * f64::from(i)).unwrap().point;
                assert!(rays.jacobian(x).unwrap().determinant() > 0.0, "{model:?} at {x}");
            }
        }
    }
}

/// A turn whose viewpoint is the one before it does nothing, whatever its planes and sharpness.
#[test]
fn equal_viewpoints_give_the_pinhole() {
    for model in MODELS {
        for m in [0.2, 1.0, 20.0] {
            for spec in [cameras::street_corner(), cameras::sideways()] {
                let turn = TurnSpec { viewpoint: DVec3::ZERO, m: Sharpness::Value(m), ..spec.turns[0] };
                let view = Spec { turns: vec![turn] }.view(model, &Similarity::IDENTITY);
                let mut random = Random::new(5);
                for _ in 0..500 {
                    let pixel = DVec2::new(random.range(0.0, 1280.0), random.range(0.0, 720.0));
                    let depth = random.range(2.0, 500.0);
                    let x = view.pinhole().unproject(pixel, depth);
                    let image = view.project(x).unwrap();
                    assert!((image.pixel - pixel).length() < 1e-10 && (image.depth - depth).abs() < 1e-10);
                    assert!((view.ray(pixel).at(depth).unwrap().point - x).length() < 1e-10);
                }
            }
        }
    }
}

#[test]
fn no_turn_is_the_pinhole() {
    let root = pinhole(&Similarity::IDENTITY, DVec3::ZERO, DVec3::Y);
    let rays = CurvedRays::new(&root, Model::Modified, &[]).unwrap();
    let view = View::new(root.clone(), vec![Stage::CurvedRays(rays)]).unwrap();
    let p = DVec3::new(3.0, 70.0, -9.0);
    assert_eq!(view.project(p).unwrap().pixel, root.project(p).unwrap().0);
    assert_eq!(view.displace_in(0, p).unwrap().point, p);
    assert_eq!((view.records(), view.edge_error(p, -p + 100.0).px), (1, 0.0));
}

/// Four narrow turns to the left by 30 to 70 degrees each; the far part may look across the near one.
fn random_spiral(random: &mut Random) -> Option<Spec> {
    let (mut bend, mut direction, mut turns) = (80.0 * DVec3::Y, DVec3::Y, Vec::new());
    for _ in 0..4 {
        let turned = DQuat::from_rotation_z(random.range(0.5, 1.2)) * direction;
        let normal = (direction + turned).normalize();
        let half = random.range(2.0, 8.0);
        turns.push(TurnSpec {
            viewpoint: bend - random.range(60.0, 600.0) * turned,
            t0: bend - half * normal,
            t1: bend,
            t2: bend + half * normal,
            pencil: Pencil::Parallel { normal },
            m: Sharpness::Bend,
        });
        bend += random.range(50.0, 150.0) * turned;
        direction = turned;
    }
    let root = pinhole(&Similarity::IDENTITY, DVec3::ZERO, DVec3::Y);
    CurvedRays::new(&root, Model::Modified, &turns).ok().map(|_| Spec { turns })
}

/// Every image of a point is listed, in ray order, and `project` gives the first.
#[test]
fn overlapping_cells_show_a_point_twice() {
    let mut random = Random::new(3);
    let specs: Vec<Spec> = (0..4000).filter_map(|_| random_spiral(&mut random)).collect();
    let mut twice = 0;
    for spec in &specs {
        let view = spec.view(Model::Modified, &Similarity::IDENTITY);
        for _ in 0..300 {
            let pixel = DVec2::new(random.range(0.0, 1280.0), random.range(0.0, 720.0));
            let seen = view.ray(pixel).at(random.range(2.0, 2000.0)).unwrap();
            let images = view.project_all(seen.point);
            assert!(images.iter().any(|i| (i.pixel - pixel).length() < 1e-8 && i.segment == seen.segment));
            assert!(images.is_sorted_by_key(|i| i.segment));
            assert_eq!(view.project(seen.point).unwrap(), images[0], "project gives the first cell in ray order");
            twice += usize::from(images.len() > 1);
        }
    }
    assert!(twice > 10, "only {twice} points of {} chains are seen twice: the case is too tame", specs.len());
}

/// Drawing once per record with the margins gives each image of a point exactly once, with the same numbers.
#[test]
fn records_share_the_work() {
    for spec in [cameras::zigzag(), cameras::long_bend()] {
        let view = spec.view(Model::Modified, &Similarity::IDENTITY);
        let mut random = Random::new(8);
        for _ in 0..3000 {
            let pixel = DVec2::new(random.range(0.0, 1280.0), random.range(0.0, 720.0));
            let seen = view.ray(pixel).at(random.range(2.0, 2000.0)).unwrap();
            let kept: Vec<_> = (0..view.records())
                .filter(|&r| view.record_margins(r, seen.point).iter().all(|&d| d > 0.0))
                .filter_map(|r| Some((r, view.displace_in(r, seen.point).ok()?)))
                .filter(|(_, d)| view.pinhole().project(d.point).is_ok_and(|(px, _)| (px - pixel).length() < 1e-9))
                .collect();
            assert_eq!(kept.len(), 1, "{pixel} sees {seen:?} through records {kept:?}");
            assert_eq!(kept[0].1.segment, seen.segment);
        }
    }
}

#[test]
fn neighbouring_records_agree_on_their_separator() {
    let spec = cameras::long_bend();
    let rays = spec.rays(Model::Modified, &Similarity::IDENTITY);
    for k in 0..rays.records() - 1 {
        let (point, normal) = rays.separator(k).unwrap().plane();
        let mut random = Random::new(k as u64);
        let mut checked = 0;
        for _ in 0..200 {
            let p = point + 30.0 * random.direction().reject_from(normal);
            assert!(rays.record_margins(k, p)[1].abs() < 1e-9);
            let (Ok(a), Ok(b)) = (rays.displace_in(k, p), rays.displace_in(k + 1, p)) else { continue };
            if rays.root().project(a.point).is_ok_and(|(px, _)| rays.root().contains(px)) {
                assert!((a.point - b.point).length() < 1e-9, "record {k} at {p}");
                checked += 1;
            }
        }
        assert!(checked > 10, "record {k}: {checked}");
    }
}

#[test]
fn misses_are_told_apart() {
    let view = cameras::street_corner().view(Model::Modified, &Similarity::IDENTITY);
    // Beyond the common line, and beside the picture: before the turn, by the sequential test.
    let beyond_line = view.project(DVec3::new(-120.0, 100.0, 0.0)).unwrap();
    assert!(!view.pinhole().contains(beyond_line.pixel) && beyond_line.segment == 0, "{beyond_line:?}");
    assert_eq!(view.project(DVec3::new(0.0, -10.0, 0.0)), Err(Miss::BehindEye));
    assert_eq!(view.project(DVec3::NAN).ok(), None);
    assert_eq!(view.displace(DVec3::new(0.0, -10.0, 0.0)).unwrap().point, DVec3::new(0.0, -10.0, 0.0));
    assert_eq!(view.displace_in(1, DVec3::Y), Err(Miss::OutsideDomain));
    assert_eq!(view.ray(DVec2::new(640.0, 360.0)).at(-1.0), Err(Miss::BehindEye));
}

#[test]
fn rays_of_another_camera_are_refused() {
    let spec = cameras::sideways();
    let rays = spec.rays(Model::Modified, &Similarity::IDENTITY);
    let other = pinhole(&Similarity::IDENTITY, DVec3::X, DVec3::Y);
    let error = View::new(other, vec![Stage::CurvedRays(rays)]).unwrap_err();
    assert!(error.to_string().contains("another camera"), "{error}");
}

/// A tiny move of a plane moves the picture only a little, down to turns of width 0.
#[test]
fn narrow_turns_tend_to_the_kink() {
    let spec = cameras::street_corner();
    let at = |share: f64| {
        let t = spec.turns[0];
        Spec { turns: vec![TurnSpec { t0: t.t1.lerp(t.t0, share), t2: t.t1.lerp(t.t2, share), ..t }] }
            .view(Model::Modified, &Similarity::IDENTITY)
    };
    let kink = at(0.0);
    assert_eq!(kink.curved_rays().unwrap().turns()[0].m, None);
    for share in [1e-2, 1e-4, 1e-5, 3e-6, 1e-7, 1e-9] {
        let narrow = at(share);
        for pixel in [DVec2::new(640.0, 360.0), DVec2::new(30.0, 700.0), DVec2::new(1279.0, 5.0)] {
            for depth in [20.0, 69.0, 71.0, 300.0] {
                let (a, b) = (kink.ray(pixel).at(depth).unwrap().point, narrow.ray(pixel).at(depth).unwrap().point);
                assert!((a - b).length() < 40.0 * share + 1e-9, "{share} {pixel} {depth}: {a} {b}");
            }
        }
    }
}

/// In a box whose records are continuous every point is past all turns before the record it belongs to, and before all later ones;
/// no record holds a point of a box that it may not hold.
#[test]
fn continuous_records_part_a_box_one_behind_the_other() {
    let mut random = Random::new(11);
    let (mut joined, mut parted) = (0, 0);
    let paths: Vec<Spec> = random_chains(4, Model::Modified, 30);
    let spirals = (0..4000).filter_map(|_| random_spiral(&mut random)).take(30).collect::<Vec<_>>();
    for spec in paths.iter().chain(&spirals) {
        let rays = spec.rays(Model::Modified, &Similarity::IDENTITY);
        let view = spec.view(Model::Modified, &Similarity::IDENTITY);
        for _ in 0..200 {
            let pixel = DVec2::new(random.range(-300.0, 1600.0), random.range(-300.0, 1000.0));
            let Ok(seen) = view.ray(pixel).at(random.range(2.0, 900.0)) else { continue };
            let half = DVec3::new(random.range(0.1, 60.0), random.range(0.1, 60.0), random.range(0.1, 20.0));
            let bounds = Aabb { min: seen.point - half, max: seen.point + half };
            let held: Vec<usize> = (0..rays.records()).filter(|&k| rays.may_hold(k, &bounds)).collect();
            let (Some(&first), Some(&last)) = (held.first(), held.last()) else { panic!("no record holds {bounds:?}") };
            let continuous = last - first + 1 == held.len() && rays.is_continuous(first..=last, &bounds);
            *(if continuous && last > first { &mut joined } else { &mut parted }) += 1;
            for _ in 0..30 {
                let t = DVec3::new(random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0));
                let p = seen.point + t * half;
                for k in 0..rays.records() {
                    let holds = rays.record_margins(k, p).iter().all(|m| *m >= 0.0);
                    assert!(!holds || held.contains(&k), "record {k} holds {p}");
                }
                if !continuous {
                    continue;
                }
                let own = rays.record_of(first..=last, p);
                for (k, turn) in rays.turns().iter().enumerate().take(last + 1).skip(first) {
                    let (a, b) = (turn.a.at(p), turn.b.at(p));
                    assert!(
                        k >= own || (a > 0.0 && b <= 1e-12),
                        "turn {k} is not over at {p} of record {own}: {a} {b}"
                    );
                    assert!(k <= own || a <= 1e-12, "turn {k} has begun at {p} of record {own}: {a} {b}");
                }
            }
        }
    }
    assert!(joined > 300 && parted > 300, "{joined} boxes of several records, {parted} others");
}
