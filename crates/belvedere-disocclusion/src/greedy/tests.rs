use super::super::cells::tests::{field_of, noise};
use super::super::in_view::EyeError;
use super::super::{Cells, Field, ReferencePoint, TerrainSettings};
use super::super::{LeftOut, NO_CELL, PointKind, Wedge, check_eye, in_view};
use super::hits::{Hit, Target, Tracer};
use super::reference::Reference;
use super::transform::CellTransform;
use super::*;
use belvedere_core::{DVec2, DVec3};

/// Smooth seeded mountains of about 900 m over a valley, a share `void` of the nodes without data.
fn mountains(cols: usize, rows: usize, spacing: DVec2, seed: u64, void: f64) -> Field {
    let lattice = |x: i64, y: i64| noise((x * 7919 + y * 104_729).unsigned_abs() as usize, seed);
    let smooth = |x: f64, y: f64| {
        let (cx, cy) = (x.floor(), y.floor());
        let ease = |t: f64| t * t * (3.0 - 2.0 * t);
        let (u, v) = (ease(x - cx), ease(y - cy));
        let at = |dx: i64, dy: i64| lattice(cx as i64 + dx, cy as i64 + dy);
        (1.0 - v) * ((1.0 - u) * at(0, 0) + u * at(1, 0)) + v * ((1.0 - u) * at(0, 1) + u * at(1, 1))
    };
    field_of(cols, rows, spacing, |c, r| {
        if noise(r * cols + c, seed + 5) < void {
            return f64::NAN;
        }
        let (x, y) = (c as f64, r as f64);
        let octaves =
            (0..4).map(|k| smooth(x * 0.09 * f64::from(1 << k), y * 0.09 * f64::from(1 << k)) * 0.5f64.powi(k));
        1000.0 + 500.0 * octaves.sum::<f64>()
    })
}

fn point(field: &Field, x: f64, y: f64) -> Option<ReferencePoint> {
    let grid = DVec2::new(x, y);
    let ground = field.surface_at(grid)?;
    Some(ReferencePoint {
        layer: 0,
        feature: 0,
        along_m: 0.0,
        grid,
        ground,
        lift: 1.0,
        kind: PointKind::Line,
        amount: 1.0,
    })
}

/// A winding route over the whole field.
fn route(field: &Field, count: usize) -> Vec<ReferencePoint> {
    let (w, h) = ((field.cols() - 1) as f64, (field.rows() - 1) as f64);
    let at = |t: f64| (w * (0.05 + 0.9 * t), h * (0.5 + 0.4 * (7.0 * t).sin()));
    (0..count).map(|i| at(i as f64 / count as f64)).filter_map(|(x, y)| point(field, x, y)).collect()
}

fn eye(field: &Field, x: f64, y: f64, z: f64) -> DVec3 {
    field.scene_from_grid(DVec2::new(x, y)).extend(z)
}

struct Case {
    field: Field,
    cells: Cells,
    eye: DVec3,
    points: Vec<ReferencePoint>,
}

impl Case {
    fn new(field: Field, cells: usize, eye_at: [f64; 3], count: usize) -> Self {
        let eye = eye(&field, eye_at[0], eye_at[1], eye_at[2]);
        check_eye(&field, eye).unwrap();
        let all = route(&field, count);
        let wedge = Wedge::all_around(eye.truncate());
        let points = in_view(&field, &all, &wedge, 1.5).0.into_iter().map(|i| all[i]).collect();
        Self { cells: Cells::new(&field, cells), field, eye, points }
    }

    fn naive(&self, settings: &TerrainSettings) -> Naive {
        Naive::new(&self.field, &self.cells, Some(&BlockMaxima::new(&self.field)), settings, self.eye, &self.points)
    }

    /// Eyes inside, outside, above a node, on a grid line and low, over square and oblong nodes, with and without voids.
    fn all() -> Vec<Self> {
        let (square, oblong) = (DVec2::splat(60.0), DVec2::new(70.0, 45.0));
        vec![
            Self::new(mountains(61, 53, square, 1, 0.0), 14, [30.3, 51.2, 2100.0], 90),
            Self::new(mountains(61, 53, oblong, 2, 0.0), 20, [-20.7, 70.2, 2300.0], 90),
            Self::new(mountains(61, 53, square, 3, 0.02), 12, [12.0, 40.0, 2000.0], 120),
            Self::new(mountains(45, 70, oblong, 4, 0.02), 25, [20.0, 3.5, 1990.0], 60),
            Self::new(mountains(64, 64, square, 5, 0.0), 8, [5.5, 60.5, 2050.0], 150),
            Self::new(mountains(50, 50, square, 6, 0.0), 1, [49.0, 0.0, 2100.0], 60),
        ]
    }
}

#[test]
fn the_fast_pass_does_what_the_obvious_one_does() {
    let settings = TerrainSettings::default();
    let mut total = GreedyCounters::default();
    for (i, case) in Case::all().iter().enumerate() {
        let naive = case.naive(&settings);
        let slow = Reference::run(&case.field, &case.cells, &settings, case.eye, &case.points);
        assert_eq!(naive.counters(), &slow.counters, "case {i}");
        let unresolved: Vec<usize> = (0..case.points.len()).filter(|&p| slow.unresolved[p]).collect();
        assert_eq!(naive.unresolved(), unresolved);
        let (displacement, scale) =
            (naive.displacement(&case.field, &case.cells), naive.scale(&case.field, &case.cells));
        for (node, &label) in case.cells.labels().iter().enumerate() {
            if label == NO_CELL {
                assert_eq!((displacement[node], scale[node]), (0.0, 1.0));
                continue;
            }
            let g = DVec2::new((node % case.field.cols()) as f64, (node / case.field.cols()) as f64);
            let rho = ((g - case.field.grid_from_scene(case.eye.truncate())) * case.field.spacing()).length();
            let (h, a) = (case.field.heights()[node] - case.field.datum(), slow.at(label as usize, rho));
            assert!((displacement[node] - (a.of(h) - h)).abs() < 1e-9 * case.field.relief(), "case {i}, node {node}");
            assert!((scale[node] - a.scale).abs() < 1e-9);
        }
        let c = naive.counters();
        total.regular += c.regular;
        total.backfacing += c.backfacing;
        total.backward += c.backward;
        total.splits += c.splits;
        total.aux += c.aux;
    }
    assert!(
        total.regular > 50 && total.backfacing > 20 && total.backward > 1 && total.splits > 20 && total.aux > 5,
        "{total:?}"
    );
}

#[test]
fn skipping_low_blocks_changes_nothing() {
    let settings = TerrainSettings::default();
    let mut hits = 0;
    for seed in 0..80usize {
        let r = |k: usize| noise(100 * seed + k, 3);
        let size = |k: usize| 24 + (60.0 * r(k)) as usize;
        let (cols, rows) = (size(0), size(1));
        let field = mountains(
            cols,
            rows,
            DVec2::new(30.0 + 60.0 * r(2), 30.0 + 60.0 * r(3)),
            seed as u64,
            [0.0, 0.02, 0.2][seed % 3],
        );
        // Over the middle, beside the ground, on a line of the grid.
        let at = match seed % 4 {
            0 => [0.5 * cols as f64, -20.0 * r(4)],
            1 => [(r(4) * cols as f64).floor(), (r(5) * rows as f64).floor()],
            _ => [r(4) * cols as f64, r(5) * rows as f64],
        };
        let case = Case::new(field, 1 + (40.0 * r(6)) as usize, [at[0], at[1], 1950.0 + 700.0 * r(7)], 60);
        let every = Naive::new(&case.field, &case.cells, None, &settings, case.eye, &case.points);
        let naive = case.naive(&settings);
        assert_eq!((naive.counters(), naive.unresolved()), (every.counters(), every.unresolved()), "seed {seed}");
        let moved = |n: &Naive| n.displacement(&case.field, &case.cells);
        assert_eq!(moved(&naive), moved(&every), "seed {seed}");
        hits += naive.counters().hits;
    }
    assert!(hits > 500, "{hits}");
}

#[test]
fn afterwards_the_tracer_sees_every_point_that_was_resolved() {
    let settings = TerrainSettings::default();
    for (i, case) in Case::all().iter().enumerate() {
        let slow = Reference::run(&case.field, &case.cells, &settings, case.eye, &case.points);
        let own = |p: &ReferencePoint| {
            let g = case.field.grid_from_scene(case.eye.truncate());
            (1.0 - belvedere_sight::guard_tau(p.grid, g, settings.guard))
                * ((p.grid - g) * case.field.spacing()).length()
        };
        let hidden: Vec<usize> = (0..case.points.len())
            .filter(|&p| !slow.unresolved[p] && !slow.over(p, own(&case.points[p])).is_empty())
            .collect();
        assert_eq!(hidden, [0usize; 0], "case {i}");
        assert!(slow.unresolved.iter().filter(|u| **u).count() * 10 <= case.points.len());
    }
}

#[test]
fn ground_is_never_raised_and_traces_are_bounded() {
    for case in Case::all() {
        let naive = case.naive(&TerrainSettings::default());
        let displacement = naive.displacement(&case.field, &case.cells);
        assert!(displacement.iter().all(|u| *u <= 0.0 && *u >= -2.0 * case.field.relief()));
        let c = naive.counters();
        assert!(c.traces - c.aux <= (1 + c.backward) * case.points.len(), "{c:?}, {} points", case.points.len());
        assert!(c.backward <= case.cells.len());
        assert_eq!(c.hits, c.regular + c.backfacing);
    }
}

/// The hits of a line of sight to the eye over untouched ground, which are the same whether low blocks are skipped or not.
fn hits(field: &Field, cells: &Cells, [from, eye]: [DVec2; 2], [foot, top]: [f64; 2]) -> usize {
    let point = ReferencePoint {
        layer: 0,
        feature: 0,
        along_m: 0.0,
        grid: from,
        ground: field.datum(),
        lift: foot,
        kind: PointKind::Line,
        amount: 1.0,
    };
    let blocks = BlockMaxima::new(field);
    let transforms = vec![CellTransform::default(); cells.len()];
    let find = |blocks: Option<&BlockMaxima>| {
        let target = Target::new(field, cells, &point, eye, 0.0);
        let tracer = Tracer { field, cells, blocks, eye: (eye, top), slack: 1e-9 };
        let mut out: Vec<Hit> = Vec::new();
        tracer.hits(&target, f64::INFINITY, &transforms, &mut out);
        out
    };
    let (every, found) = (find(None), find(Some(&blocks)));
    assert_eq!(every, found, "{from} to {eye}");
    found.len()
}

#[test]
fn a_hill_within_one_block_is_found_by_lines_through_corners_of_blocks() {
    let hill = |c: usize, r: usize| if (18..=22).contains(&c) && (18..=22).contains(&r) { 300.0 } else { 0.0 };
    let field = field_of(41, 41, DVec2::splat(30.0), hill);
    let cells = Cells::new(&field, 2);
    let places = [0.0, 8.0, 16.0, 20.0, 24.0, 32.0, 40.0];
    let corners: Vec<DVec2> = places.iter().flat_map(|&x| places.map(|y| DVec2::new(x, y))).collect();
    let mut high = 0;
    for (&from, &eye) in corners.iter().flat_map(|a| corners.iter().map(move |b| (a, b))).filter(|(a, b)| a != b) {
        high += hits(&field, &cells, [from, eye], [40.0, 90.0]);
    }
    assert!(high > 1000, "{high}");
}

#[test]
fn a_line_of_sight_meets_level_ground_where_it_goes_down_into_it_and_leaves_it() {
    let plateau = |c: usize, _| if (12..=52).contains(&c) { 300.0 } else { 0.0 };
    let field = field_of(65, 33, DVec2::splat(30.0), plateau);
    let cells = Cells::new(&field, 1);
    let mut high = 0;
    for k in 0..40 {
        let [a, b] = [DVec2::new(2.0, 3.0 + 0.7 * f64::from(k)), DVec2::new(62.0, 29.0 - 0.6 * f64::from(k))];
        let [foot, head] = [40.0 + 5.0 * f64::from(k), 420.0 + 17.0 * f64::from(k)];
        high += hits(&field, &cells, [a, b], [foot, head]);
        high += hits(&field, &cells, [a, b], [head, foot]);
    }
    assert!(high > 500, "{high}");
}

#[test]
fn low_blocks_hide_nothing_where_lines_run_along_the_grid_and_beside_it() {
    let places = [0.0, 4.0, 16.0, 33.5, 64.0, 66.0];
    let mut high = 0;
    // Beside voids too: there is ground at a node with data, although not on all edges from it.
    for void in [0.0, 0.1] {
        let field = mountains(70, 67, DVec2::splat(30.0), 9, void);
        let cells = Cells::new(&field, 3);
        for from in places.iter().flat_map(|&x| places.map(|y| DVec2::new(x, y))) {
            let nearly = DVec2::new(from.x + 40.0, from.y + 3e-7);
            for eye in [
                nearly,
                DVec2::new(from.x, -9.0),
                DVec2::new(90.0, from.y),
                DVec2::new(64.0, 16.0),
                DVec2::new(from.y, from.x) * 1.5,
            ] {
                // Up to the eye and down to it.
                for height in [[300.0, 500.0], [500.0, 40.0]] {
                    high += hits(&field, &cells, [from, eye], height);
                }
            }
        }
    }
    assert!(high > 2000, "{high}");
}

/// A single round hill of 400 m in the middle.
fn hill(n: usize) -> Field {
    let middle = 0.5 * (n - 1) as f64;
    field_of(n, n, DVec2::splat(50.0), |c, r| {
        let d = (c as f64 - middle).hypot(r as f64 - middle) / middle;
        800.0 + 400.0 * (1.0 - d * d).max(0.0) + 0.01 * (c + 3 * r) as f64
    })
}

#[test]
fn a_point_on_the_far_slope_is_cleared_by_lowering_what_is_nearer() {
    let field = hill(41);
    let cells = Cells::new(&field, 1);
    // From the south a radial route down the northern slope.
    let eye = eye(&field, 20.0, 60.0, 1250.0);
    let points: Vec<ReferencePoint> = (0..12).map(|i| point(&field, 20.0, 14.0 - f64::from(i)).unwrap()).collect();
    let settings = TerrainSettings::default();
    let naive = Naive::new(&field, &cells, Some(&BlockMaxima::new(&field)), &settings, eye, &points);
    let c = *naive.counters();
    assert!(c.regular == 0 && c.backfacing > 0 && c.splits > 0 && c.unresolved == 0, "{c:?}");
    let farthest = naive.displacement_at(&field, &cells, &points[11]);
    assert_eq!(farthest, 0.0, "its own ground stays");
    let slow = Reference::run(&field, &cells, &settings, eye, &points);
    assert_eq!(slow.counters, c);
    for (i, p) in points.iter().enumerate() {
        let rho = ((p.grid - DVec2::new(20.0, 60.0)) * 50.0).length();
        assert!(slow.over(i, rho - 75.0).is_empty());
    }
    // Nearer to the eye the hill is lower by what hid the points, and the far foot is as it was.
    let u = naive.displacement(&field, &cells);
    assert!(u[20 * 41 + 20] < -50.0 && u[20] == 0.0, "{} {}", u[20 * 41 + 20], u[20]);
}

#[test]
fn a_higher_datum_changes_nothing() {
    let h = |f: &Field, i: usize| f.heights()[i];
    let base = mountains(61, 53, DVec2::splat(60.0), 1, 0.0);
    let raised = field_of(61, 53, DVec2::splat(60.0), |c, r| h(&base, r * 61 + c) + 4096.0);
    // The same numbers after rounding to f32.
    let base = field_of(61, 53, DVec2::splat(60.0), |c, r| h(&raised, r * 61 + c) - 4096.0);
    let settings = TerrainSettings::default();
    let low = Case::new(base, 14, [30.3, 51.2, 2100.0], 90);
    let high = Case::new(raised, 14, [30.3, 51.2, 2100.0 + 4096.0], 90);
    let (a, b) = (low.naive(&settings), high.naive(&settings));
    assert_eq!(a.counters(), b.counters());
    let (a, b) = (a.displacement(&low.field, &low.cells), b.displacement(&high.field, &high.cells));
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-8));
    assert!(a.iter().any(|u| *u < -10.0));
}

#[test]
fn mirrored_and_transposed_scenes_give_mirrored_and_transposed_ground() {
    let (n, square) = (57, DVec2::splat(60.0));
    let base = mountains(n, n, square, 12, 0.0);
    let h = |c: usize, r: usize| base.heights()[r * n + c];
    let mirrored = field_of(n, n, square, |c, r| h(n - 1 - c, r));
    let transposed = field_of(n, n, square, |c, r| h(r, c));
    let settings = TerrainSettings::default();
    let last = (n - 1) as f64;
    let at = DVec2::new(25.3, 54.1);
    let solve = |field: &Field, map: &dyn Fn(DVec2) -> DVec2| {
        let cells = Cells::new(field, 12);
        let points: Vec<ReferencePoint> =
            route(&base, 70).iter().map(|p| ReferencePoint { grid: map(p.grid), ..*p }).collect();
        let g = map(at);
        let naive =
            Naive::new(field, &cells, Some(&BlockMaxima::new(field)), &settings, eye(field, g.x, g.y, 2100.0), &points);
        (naive.displacement(field, &cells), *naive.counters())
    };
    // Points inside cells may lie on the other triangle: give them the same height.
    let (u, c) = solve(&base, &|g| g);
    let (um, cm) = solve(&mirrored, &|g| DVec2::new(last - g.x, g.y));
    let (ut, ct) = solve(&transposed, &|g| DVec2::new(g.y, g.x));
    assert_eq!((c, c), (cm, ct));
    assert!(c.hits > 10);
    for (i, u) in u.iter().enumerate() {
        let (x, y) = (i % n, i / n);
        assert!((u - um[y * n + n - 1 - x]).abs() < 1e-7, "mirrored at {x}, {y}");
        assert!((u - ut[x * n + y]).abs() < 1e-7, "transposed at {x}, {y}");
    }
}

#[test]
fn flat_and_smallest_grounds_stay_as_they_are() {
    let settings = TerrainSettings::default();
    for (cols, rows) in [(30, 20), (2, 2)] {
        let field = field_of(cols, rows, DVec2::splat(30.0), |_, _| 500.0);
        let cells = Cells::new(&field, 5);
        let points: Vec<ReferencePoint> =
            (0..5).filter_map(|i| point(&field, 0.2 * f64::from(i), 0.1 * f64::from(i))).collect();
        let naive = Naive::new(
            &field,
            &cells,
            Some(&BlockMaxima::new(&field)),
            &settings,
            eye(&field, 25.0, 18.0, 900.0),
            &points,
        );
        assert_eq!((naive.counters().traces, naive.counters().hits), (5, 0));
        assert!(naive.displacement(&field, &cells).iter().all(|u| *u == 0.0));
    }
}

#[test]
fn what_the_pass_cannot_clear_is_named_and_stays_within_the_relief() {
    // A wall of 300 m right before points in a trench: the eye is too low to look over it without digging deep.
    let field = field_of(60, 20, DVec2::splat(30.0), |c, r| {
        let wall = if c == 30 { 300.0 } else { 0.0 };
        500.0 + wall + 0.5 * noise(r * 60 + c, 3) - if c > 50 { 250.0 } else { 0.0 }
    });
    let cells = Cells::new(&field, 3);
    let points: Vec<ReferencePoint> = (0..9).map(|i| point(&field, 53.5, 2.0 + 2.0 * f64::from(i)).unwrap()).collect();
    let eye = eye(&field, 5.5, 10.5, 505.0);
    let settings = TerrainSettings::default();
    let naive = Naive::new(&field, &cells, Some(&BlockMaxima::new(&field)), &settings, eye, &points);
    let u = naive.displacement(&field, &cells);
    assert!(u.iter().all(|u| u.is_finite() && *u >= -2.0 * field.relief()));
    let slow = Reference::run(&field, &cells, &settings, eye, &points);
    assert_eq!(naive.counters(), &slow.counters);
}

#[test]
fn a_point_under_the_eye_has_no_line_of_sight() {
    let field = hill(21);
    let cells = Cells::new(&field, 1);
    let points = [point(&field, 10.0, 10.0).unwrap()];
    let eye = eye(&field, 10.0, 10.0, 1500.0);
    let naive = Naive::new(&field, &cells, Some(&BlockMaxima::new(&field)), &TerrainSettings::default(), eye, &points);
    assert_eq!(naive.counters().hits, 0);
    let left_out = in_view(&field, &points, &Wedge::all_around(eye.truncate()), 1.5).1;
    assert_eq!(left_out, [(0, LeftOut::TooNear)]);
}

#[test]
fn eyes_must_be_over_the_ground() {
    let field = hill(21);
    let at = |x: f64, y: f64, z: f64| check_eye(&field, eye(&field, x, y, z));
    assert!(at(10.0, 10.0, 1201.0).is_ok());
    let error = at(10.0, 10.0, 1100.0).unwrap_err();
    assert!(error.to_string().contains("100.4 m below the ground"), "{error}");
    assert!(at(-5.0, 10.0, -50.0).is_ok(), "beside the terrain");
    assert!(matches!(at(10.0, 10.0, f64::NAN), Err(EyeError::NotFinite { .. })));
}

#[test]
fn the_wedge_is_horizontal_and_holds_the_picture() {
    use belvedere_core::{Pinhole, Projection};
    let camera = |look: DVec3, fov: f64| {
        let lens = Projection::Perspective { fov_y: fov.to_radians() };
        Pinhole::look_at(DVec3::new(0.0, 0.0, 1000.0), look, DVec3::Z, lens, [1600, 900], 1.0, Some(5e4)).unwrap()
    };
    let level = Wedge::of_pinhole(&camera(DVec3::new(0.0, 1000.0, 1000.0), 45.0));
    let half = (0.5f64 * 45f64.to_radians()).tan() * 16.0 / 9.0;
    assert!((level.half_angle - half.atan()).abs() < 1e-12);
    assert!(
        level.contains(DVec2::new(0.99 * half * 300.0, 300.0))
            && !level.contains(DVec2::new(1.01 * half * 300.0, 300.0))
    );
    assert!(!level.contains(DVec2::new(0.0, -300.0)) && !level.contains(DVec2::new(0.0, 6e4)));
    // Looking down every ray of the picture is in the wedge, and the lower corners are its rim.
    let down = camera(DVec3::new(300.0, 800.0, 0.0), 40.0);
    let wedge = Wedge::of_pinhole(&down);
    assert!(wedge.half_angle > level.half_angle && wedge.half_angle < 1.5);
    for i in 0..=20 {
        for j in 0..=20 {
            let pixel = DVec2::new(f64::from(i) * 80.0, f64::from(j) * 45.0);
            let p = down.unproject(pixel, 500.0);
            assert!(wedge.contains(p.truncate() * 0.999_999 + 1e-9), "{pixel}");
        }
    }
    let all = Wedge::of_pinhole(&camera(DVec3::new(10.0, 100.0, 0.0), 45.0));
    assert_eq!(all.half_angle, std::f64::consts::PI);
    assert!(all.contains(DVec2::new(-3.0, -4000.0)));
}

#[test]
fn a_higher_price_of_steps_makes_smaller_steps() {
    // Mean step at the borders of cells in the quarter of the ground nearest to the eye.
    let step = |case: &Case, eta: f64| {
        let naive = case.naive(&TerrainSettings { eta, ..TerrainSettings::default() });
        let u = naive.displacement(&case.field, &case.cells);
        let (cols, labels) = (case.field.cols(), case.cells.labels());
        let g = case.field.grid_from_scene(case.eye.truncate());
        let mut steps: Vec<(f64, f64)> = Vec::new();
        for i in 0..u.len() {
            for j in [i + 1, i + cols] {
                if j < u.len() && (j != i + 1 || j % cols != 0) && labels[i] != labels[j] {
                    let rho = ((DVec2::new((i % cols) as f64, (i / cols) as f64) - g) * case.field.spacing()).length();
                    steps.push((rho, (u[i] - u[j]).abs()));
                }
            }
        }
        steps.sort_by(|a, b| a.0.total_cmp(&b.0));
        let near = &steps[..steps.len() / 4];
        near.iter().map(|s| s.1).sum::<f64>() / near.len() as f64
    };
    let sums = [0.0, 1.0, 5.0].map(|eta| {
        let cases = Case::all();
        cases.iter().filter(|c| c.cells.len() > 1).map(|c| step(c, eta)).sum::<f64>()
    });
    assert!(sums[1] < sums[0] && sums[2] < sums[0], "{sums:?}");
}
