//! The largest height of displaced ground over lines of sight, against the height at many points of them.

use belvedere_core::grid::Grid;
use belvedere_core::{DVec2, TerrainDisocclusion};
use belvedere_scene::Heightfield;
use belvedere_sight::{DisplacedGround, Field, SightVertex};
use belvedere_testkit::Random;

const SPACING: f64 = 10.0;

/// * `step`: cells of the ground per cell of the displacement; its first node lies `shift` cells beside a node of the ground.
fn ground(random: &mut Random, [cols, rows]: [usize; 2], (step, shift): (f64, f64)) -> (Field, Grid) {
    let heights = (0..cols * rows).map(|_| random.range(0.0, 12.0) as f32).collect();
    let hf = Heightfield::measured(DVec2::ZERO, DVec2::splat(SPACING), cols, rows, heights).expect("ground");
    // Wider by a cell on every side: beside the grid nothing is displaced, and the ground would jump at its border.
    let [cols, rows] = [cols, rows].map(|n| ((n as f64 + 1.0 + shift) / step).ceil() as usize + 1);
    let delta = (0..cols * rows).map(|_| random.range(-12.0, 12.0)).collect();
    let north_west = DVec2::new(-1.0 - shift, 1.0 + shift) * SPACING;
    let delta = Grid::new(north_west, DVec2::splat(step * SPACING), cols, rows, delta).expect("grid");
    (Field::new(&hf, |_| 0.0).expect("heights"), delta)
}

/// A line of two parts that leads away from its start, grid coordinates and heights; it may leave the ground.
fn line(random: &mut Random, [cols, rows]: [usize; 2]) -> [SightVertex; 3] {
    let mut place = || DVec2::new(random.range(-0.5, cols as f64 - 0.5), random.range(-0.5, rows as f64 - 0.5));
    let [a, b] = [place(), place()];
    let c = b + random.range(0.2, 1.0) * DVec2::from_angle(random.range(-0.7, 0.7)).rotate(b - a);
    [a, b, c].map(|at| (at, random.range(-2.0, 20.0)))
}

/// Largest height over 600 points of each part, beyond `guard` cells of the start.
fn dense(ground: &DisplacedGround<'_>, line: &[SightVertex], guard: f64) -> f64 {
    let parts = line.windows(2).flat_map(|pair| {
        let [a, b] = [pair[0], pair[1]];
        (0..=600).map(move |k| {
            let t = f64::from(k) / 600.0;
            (a.0.lerp(b.0, t), a.1 + t * (b.1 - a.1))
        })
    });
    let over =
        parts.filter(|(at, _)| at.distance(line[0].0) >= guard).filter_map(|(at, z)| Some(ground.height_at(at)? - z));
    over.fold(f64::NEG_INFINITY, f64::max)
}

/// With tables and without, near and far from the point: never less than at any point of the line, and as much at
/// the place that is told. Small grounds, for on large ones the highest cell hides what is missed elsewhere.
#[test]
fn the_largest_excess_is_that_of_many_points() {
    let random = &mut Random::new(21);
    let (mut hidden, mut free) = (0, 0);
    for n in 0..200 {
        let size = [[2, 2], [3, 2], [4, 3], [20, 11]][n % 4];
        let (step, shift) = [(1.0, 0.0), (3.0, 1.0), (0.3, 0.0), (1.7, 0.4)][n / 4 % 4];
        let (field, delta) = ground(random, size, (step, shift));
        let (line, guard) = (line(random, size), [0.0, 0.4, 1.5][random.below(3)]);
        let grounds = [DisplacedGround::new(&field, &delta), DisplacedGround::new(&field, &delta).prepared()];
        for (kind, ground) in grounds.iter().enumerate() {
            let (found, want) = (ground.excess(&line, guard), dense(ground, &line, guard));
            if want <= -1.0 {
                assert!(found.over < 0.05, "{n} {kind}: {found:?}, {want}");
                free += 1;
                continue;
            }
            // The points lie 0.04 cells apart at most on large grounds, on slopes below 50 m a cell.
            assert!(found.over > want - 1e-6 && found.over < want + 1.5, "{n} {kind}: {found:?}, {want}");
            let there =
                ground.height_at(found.at.clamp(DVec2::ZERO, DVec2::new(size[0] as f64 - 1.0, size[1] as f64 - 1.0)));
            assert!(there.is_some() && found.at.distance(line[0].0) > guard - 1e-6, "{n} {kind}: {found:?}");
            hidden += 1;
        }
    }
    assert!(hidden > 150 && free > 20, "{hidden} {free}");
}

/// One surface: the ground of the judge stands where the stage moves the ground of the terrain, between nodes as well.
#[test]
fn the_stage_moves_ground_to_where_the_judge_has_it() {
    let random = &mut Random::new(4);
    for n in 0..60 {
        let size = [[2, 2], [5, 3], [20, 11]][n % 3];
        let (field, delta) = ground(random, size, [(1.0, 0.0), (3.0, 1.0), (1.7, 0.4)][n / 3 % 3]);
        let stage = TerrainDisocclusion::new(delta.clone().on_facets(field.places()));
        let (mut most, judged) = (0.0f64, DisplacedGround::new(&field, &delta));
        for _ in 0..200 {
            let at = DVec2::new(random.range(0.0, size[0] as f64 - 1.0), random.range(0.0, size[1] as f64 - 1.0));
            let moved = stage.delta_at(field.scene_from_grid(at).extend(0.0));
            let height = field.surface_at(at).expect("ground") + moved;
            assert!((height - judged.height_at(at).expect("ground")).abs() < 1e-9, "{n}: {at}");
            most = most.max((moved - delta.sample(field.scene_from_grid(at)).expect("inside")).abs());
        }
        assert!(most > 0.01, "{n}: bilinear ground is another one");
    }
}
