//! A landscape that makes way stays like itself: by default what would change it is given up, and summits keep their order.

use belvedere_core::{DVec2, View};
use belvedere_disocclusion::report::{LikenessReport, UnresolvedReason};
use belvedere_disocclusion::{Solved, TerrainMemory, TerrainSettings, TerrainSolver};
use belvedere_scene::{Heightfield, Progress, Scene};
use belvedere_testkit::synthetic;

const NODES: usize = 97;
const SEEDS: std::ops::Range<u64> = 1..10;

fn case(seed: u64) -> (Scene, View) {
    let scene = synthetic::scene(NODES, seed);
    // The lower over the ground, the more is asked of it.
    let over_m = [150.0, 700.0, 2500.0][seed as usize % 3];
    let view = View::straight(synthetic::camera(&scene, over_m, [640, 400]));
    (scene, view)
}

fn solved((scene, view): &(Scene, View), show: Option<f64>) -> Solved {
    let settings = TerrainSettings { show, ..TerrainSettings::default() };
    let solver = TerrainSolver::new(settings).expect("settings");
    solver.solve(scene, view, &mut TerrainMemory::default(), &Progress::silent()).expect("a solution")
}

fn likeness(solved: &Solved) -> LikenessReport {
    solved.report.likeness.expect("a still")
}

/// Heights before and after, and the angle between the normals, of each inner node in the picture; by the stage alone.
fn nodes(hf: &Heightfield, view: &View, solved: &Solved) -> Vec<([f64; 2], f64)> {
    let place = |c: usize, r: usize| hf.north_west() + DVec2::new(c as f64, -(r as f64)) * hf.spacing();
    let before = |c: usize, r: usize| hf.node(c, r).expect("a height").z;
    let after = |c: usize, r: usize| before(c, r) + solved.stage.delta_at(place(c, r).extend(0.0));
    let slope = |h: &dyn Fn(usize, usize) -> f64, c: usize, r: usize| {
        DVec2::new(h(c + 1, r) - h(c - 1, r), h(c, r - 1) - h(c, r + 1)) / (2.0 * hf.spacing())
    };
    let mut out = Vec::new();
    for (c, r) in (1..hf.rows() - 1).flat_map(|r| (1..hf.cols() - 1).map(move |c| (c, r))) {
        let p = place(c, r).extend(before(c, r));
        let [width, height] = view.pinhole().image.map(f64::from);
        let shown = view.project(p).is_ok_and(|image| {
            (-0.05 * width..=1.05 * width).contains(&image.pixel.x) && (-height..=2.0 * height).contains(&image.pixel.y)
        });
        if shown {
            let [was, is] = [slope(&before, c, r), slope(&after, c, r)].map(|s| (-s).extend(1.0).normalize());
            out.push(([before(c, r), after(c, r)], was.angle_between(is).to_degrees()));
        }
    }
    out
}

#[test]
fn the_turn_of_the_normals_is_that_of_the_drawn_ground() {
    let mut tried = 0;
    for seed in SEEDS.step_by(3) {
        let case = case(seed);
        let found = solved(&case, Some(1.0));
        let all = nodes(case.0.terrain().expect("terrain"), &case.1, &found);
        let mean = |turns: &mut dyn Iterator<Item = f64>| {
            let (sum, count) = turns.fold((0.0, 0.0), |(sum, count), turn| (sum + turn, count + 1.0));
            (sum / f64::max(count, 1.0), count)
        };
        let (turn, count) = mean(&mut all.iter().map(|n| n.1));
        let (turn_moved, moved) = mean(&mut all.iter().filter(|n| (n.0[1] - n.0[0]).abs() > 1.0).map(|n| n.1));
        let said = likeness(&found);
        assert!((said.picture.turn_mean_deg - turn).abs() < 0.05 * turn + 0.02, "{seed}: {said:?}, {turn}");
        assert!(
            (said.moved.turn_mean_deg - turn_moved).abs() < 0.05 * turn_moved + 0.05,
            "{seed}: {said:?}, {turn_moved}"
        );
        assert!((said.moved_share - moved / count).abs() < 0.03, "{seed}: {said:?}, {}", moved / count);
        tried += usize::from(turn_moved > 1.0);
    }
    assert!(tried >= 3, "{tried}");
}

#[test]
fn by_default_a_landscape_stays_like_itself_and_what_is_given_up_is_named() {
    let (mut changed, mut kept, mut pairs, mut swapped) = (0, 0, 0, 0);
    for seed in SEEDS {
        let case = case(seed);
        let (found, all) = (solved(&case, None), solved(&case, Some(1.0)));
        let (of_found, of_all) = (likeness(&found), likeness(&all));
        assert!(of_found.strain <= 1.0 && of_found.summits_swapped == 0, "{seed}: {of_found:?}");
        (pairs, swapped) = (pairs + of_found.summits.saturating_sub(1), swapped + of_all.summits_swapped);
        let price = found.report.price.as_ref().expect("a price");
        let named = found.report.hidden.iter().any(|run| matches!(run.reason, UnresolvedReason::GivenUp { .. }));
        let [some, whole] = [&found, &all].map(|s| s.report.metrics.visible_dense);
        if price.given_up.is_empty() {
            assert!(some > whole - 0.002, "{seed}: {some} of {whole} although nothing was given up");
            kept += 1;
        } else {
            assert!(of_all.strain > 0.8 || of_all.summits_swapped > 0, "{seed}: {of_all:?}");
            assert!(named && price.curve[0].strain > Some(0.97) && some < whole + 0.01, "{seed}: {price:?}");
            assert!(some >= found.report.visible_dense_before - 0.02, "{seed}: {some}");
            changed += 1;
        }
    }
    assert!(changed >= 3 && kept >= 2, "{changed} changed, {kept} kept");
    assert!(pairs > 50 && swapped >= 3, "{pairs} pairs of summits, {swapped} swapped where nobody asks");
}

#[test]
fn what_is_given_up_for_very_many_points_is_chosen_roughly_and_the_rest_is_shown_as_well() {
    let mut changed = 0;
    for seed in SEEDS {
        let case = case(seed);
        let settings = TerrainSettings { candidates: 0.04, ..TerrainSettings::default() };
        let solver = TerrainSolver::new(settings).expect("settings");
        let many =
            solver.solve(&case.0, &case.1, &mut TerrainMemory::default(), &Progress::silent()).expect("a solution");
        assert!(likeness(&many).strain <= 1.0, "{seed}: {:?}", likeness(&many));
        let price = many.report.price.as_ref().expect("a price");
        let shares: Vec<f64> = price.dearest.iter().map(|stretch| stretch.share).collect();
        assert!(shares.windows(2).all(|pair| pair[0] >= pair[1]) && shares.iter().sum::<f64>() <= 1.0 + 1e-9);
        if many.report.asked <= 2000 || price.given_up.is_empty() {
            continue;
        }
        changed += 1;
        let few = solved(&case, None);
        let [rough, exact] = [&many, &few].map(|s| s.report.metrics.visible_dense);
        assert!(rough > exact - 0.1, "{seed}: {rough} instead of {exact}");
        // All that stays hidden was given up.
        let is_given = |reason: &UnresolvedReason| matches!(reason, UnresolvedReason::GivenUp { .. });
        let hidden: f64 =
            many.report.hidden.iter().filter(|run| !is_given(&run.reason)).map(|run| run.to_m - run.from_m).sum();
        assert!(hidden < 60.0, "{seed}: {hidden} m hidden that were not given up: {:?}", many.report.hidden);
        assert!(price.dearest.iter().all(|stretch| !price.given_up.contains(stretch)));
    }
    assert!(changed >= 2, "{changed}");
}
