//! Cameras that are not valid have a valid one near them, which errors name and `mended` returns.

use belvedere_core::DVec3;
use belvedere_core::map::curved_rays::{CurvedRays, Model, Pencil, Remedy, Sharpness, TurnSpec};
use belvedere_testkit::Random;
use belvedere_testkit::rays::{MODELS, RandomRays};

/// A camera that was valid, of which one turn was changed at random until it is not; and how far its points moved.
fn spoilt(random: &mut Random, model: Model, count: usize) -> Option<(RandomRays, f64)> {
    let made = RandomRays::new(random, model, count, [160, 90])?;
    for _ in 0..40 {
        let mut bad = made.clone();
        let turn = &mut bad.turns[random.below(count)];
        let by = random.range(5.0, 150.0) * random.direction();
        match random.below(6) {
            0 => turn.viewpoint += by,
            1 => turn.t0 += by,
            2 => turn.t1 += by,
            3 => turn.t2 += by,
            4 => turn.pencil = Pencil::Parallel { normal: random.direction() },
            _ => {
                if let Pencil::Line { point, .. } = &mut turn.pencil {
                    *point += by;
                }
            }
        }
        if CurvedRays::if_valid(&bad.pinhole, model, &bad.turns).is_none() {
            return Some((bad, by.length()));
        }
    }
    None
}

/// Largest distance between the points of two cameras.
fn moved(a: &[TurnSpec], b: &[TurnSpec]) -> f64 {
    let points = |turn: &TurnSpec| [turn.viewpoint, turn.t0, turn.t1, turn.t2];
    let pairs = a.iter().flat_map(points).zip(b.iter().flat_map(points));
    pairs.map(|(p, q)| p.distance(q)).fold(0.0, f64::max)
}

#[test]
fn every_spoilt_camera_is_told_values_and_is_mended_by_less_than_it_was_spoilt_by() {
    let (mut told, mut vague, mut ratios) = (0, 0, Vec::new());
    for seed in 0..600 {
        let mut random = Random::new(0x3e4d + seed);
        let (model, count) = (MODELS[seed as usize % 5], 1 + seed as usize / 5 % 3);
        let Some((bad, by)) = spoilt(&mut random, model, count) else { continue };
        let error = CurvedRays::new(&bad.pinhole, model, &bad.turns).expect_err("spoilt");
        match error.remedy() {
            Some(Remedy::Rebuild) => vague += 1,
            _ => told += 1,
        }
        let text = error.to_string();
        assert!(!text.contains("NaN") && text.len() < 500, "{text}");
        let mended = CurvedRays::mended(&bad.pinhole, model, &bad.turns).unwrap_or_else(|| panic!("{seed}: {error}"));
        assert_eq!(mended.changes[0], error);
        let again = CurvedRays::new(mended.rays.root(), mended.rays.model(), mended.rays.spec());
        assert!(again.is_ok_and(|rays| rays == mended.rays), "{seed}");
        ratios.push(moved(&bad.turns, mended.rays.spec()) / by);
    }
    assert!(told > 300 && vague * 50 <= told, "{told} told, {vague} vague");
    ratios.sort_by(f64::total_cmp);
    let [half, most] = [ratios.len() / 2, ratios.len() * 95 / 100].map(|k| ratios[k]);
    assert!(half < 1.0 && most < 12.0, "{half} {most}");
}

#[test]
fn a_valid_camera_stays_as_it_is() {
    for seed in 0..40 {
        let model = MODELS[seed as usize % 5];
        let Some(made) = RandomRays::new(&mut Random::new(seed), model, 2, [160, 90]) else { continue };
        let mended = CurvedRays::mended(&made.pinhole, model, &made.turns).expect("valid");
        assert!(mended.changes.is_empty() && mended.rays.spec() == made.turns && *mended.rays.root() == made.pinhole);
    }
}

#[test]
fn numbers_that_are_none_and_turns_without_a_shape_are_mended() {
    let made = (0..).find_map(|seed| RandomRays::new(&mut Random::new(seed), Model::Modified, 1, [160, 90]));
    let made = made.expect("one of them");
    let turn = made.turns[0];
    let all = DVec3::splat(1.0);
    for bad in [
        TurnSpec { viewpoint: DVec3::NAN, ..turn },
        TurnSpec { t1: DVec3::splat(f64::INFINITY), ..turn },
        TurnSpec { t0: turn.t1, ..turn },
        TurnSpec { t0: turn.t2, t2: turn.t0, ..turn },
        TurnSpec { pencil: Pencil::Parallel { normal: DVec3::ZERO }, ..turn },
        TurnSpec { pencil: Pencil::Line { point: turn.t1, dir: DVec3::X }, ..turn },
        TurnSpec { m: Sharpness::Value(400.0), ..turn },
        TurnSpec { viewpoint: all, t0: all, t1: all, t2: all, ..turn },
    ] {
        let mended = CurvedRays::mended(&made.pinhole, Model::Modified, &[bad]);
        assert!(mended.is_some_and(|m| !m.changes.is_empty()), "{bad:?}");
    }
}
