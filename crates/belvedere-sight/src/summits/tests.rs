use super::*;

fn grid(cols: usize, rows: usize, height: impl Fn(usize, usize) -> f32) -> Grid {
    let heights = (0..rows).flat_map(|r| (0..cols).map(move |c| (c, r))).map(|(c, r)| height(c, r)).collect();
    Grid { cols, rows, heights, north_west: DVec2::ZERO, spacing: DVec2::new(30.0, 20.0) }
}

/// By definition: floods the ground above ever lower levels until something higher is reached.
fn searched(grid: &Grid, summit: usize) -> f32 {
    let mut levels: Vec<f32> = grid.heights.iter().copied().filter(|h| *h > f32::NEG_INFINITY).collect();
    levels.sort_by(|a, b| b.total_cmp(a));
    for level in &levels {
        let (mut seen, mut open) = (vec![false; grid.heights.len()], vec![summit]);
        while let Some(node) = open.pop().filter(|n| grid.heights[*n] >= *level) {
            if std::mem::replace(&mut seen[node], true) {
                continue;
            }
            if grid.is_higher(node, summit) {
                return grid.heights[summit] - level;
            }
            open.extend(grid.around(node).filter(|n| grid.heights[*n] >= *level && !seen[*n]));
        }
    }
    grid.heights[summit] - levels.last().copied().unwrap_or(0.0)
}

#[test]
fn prominence_is_that_of_its_definition() {
    let mut seed = 3u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 58) as f32
    };
    for _ in 0..6 {
        // Heights of few values: ties and flat tops; some voids.
        let values: Vec<f32> = (0..17 * 13).map(|_| random()).collect();
        let grid = grid(17, 13, |c, r| match values[r * 17 + c] {
            v if v < 3.0 => f32::NEG_INFINITY,
            v => v,
        });
        let found = grid.prominences();
        let mut summits = 0;
        for node in (0..grid.heights.len()).filter(|n| grid.heights[*n] > f32::NEG_INFINITY) {
            let is_summit = !grid.around(node).any(|n| grid.is_higher(n, node));
            summits += usize::from(is_summit);
            let wanted = if is_summit { searched(&grid, node) } else { 0.0 };
            assert_eq!(found[node], wanted, "node {node}");
        }
        assert!(summits > 5);
    }
}

#[test]
fn summits_are_found_beside_their_points_and_belong_to_the_nearest() {
    // Two cones: 1000 high at (40, 20), 600 high at (10, 20), the pass between them at about 300.
    let cone = |c: usize, r: usize, at: [f64; 2], top: f64| {
        top - 20.0 * DVec2::new(c as f64 - at[0], r as f64 - at[1]).length()
    };
    let grid = grid(60, 40, |c, r| cone(c, r, [40.0, 20.0], 1000.0).max(cone(c, r, [10.0, 20.0], 600.0)) as f32);
    let at = |c: f64, r: f64| DVec2::new(30.0 * c, -20.0 * r);
    let points = [at(41.0, 21.0), at(10.0, 20.0), at(12.0, 20.0), at(-5.0, 3.0), at(25.0, 39.0)];
    let found = standings_on(&grid, &points);
    let lowest = grid.heights.iter().copied().fold(f32::INFINITY, f32::min);
    assert_eq!(found[0].prominence, f64::from(1000.0 - lowest));
    assert!((found[0].dominance - (1800.0f64.powi(2) + 800.0f64.powi(2)).sqrt()).abs() < 1.0);
    let node = 20 * 60 + 10;
    assert_eq!(found[1].prominence, f64::from(searched(&grid, node)));
    assert!((80.0..120.0).contains(&found[1].prominence), "{:?}", found[1]);
    // The nearest ground higher than 600 lies 10 columns before the other summit, 20 columns away.
    assert!((found[1].dominance - 30.0 * 11.0).abs() <= 30.0, "{:?}", found[1]);
    assert_eq!(found[2], Standing::default());
    assert_eq!(found[3], Standing::default());
    assert!(standings_on(&grid, &[at(-9.0, 0.0)]) == [Standing::default()]);
}

#[test]
fn blocks_of_fine_ground_keep_their_summits() {
    let height = |i: usize| {
        let (c, r) = ((i % 100) as f32, (i / 100) as f32);
        1000.0 - 3.0 * (c - 50.0).abs() - 3.0 * (r - 50.0).abs()
    };
    let heights = (0..10_000).map(height).collect();
    let ground =
        Heightfield::measured(DVec2::new(500.0, 900.0), DVec2::splat(10.0), 100, 100, heights).expect("ground");
    let grid = Grid::of(&ground, 700);
    assert!(grid.heights.len() <= 700 && grid.heights.contains(&1000.0));
    let summit = DVec2::new(1000.0, 400.0);
    let found = standings_on(&grid, &[summit]);
    assert!(found[0].prominence > 250.0, "{found:?}");
}
