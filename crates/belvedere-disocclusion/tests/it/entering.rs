//! Films: ground moves gradually for points that come into the picture, and returns gradually when they have left it.

use belvedere_core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere_disocclusion::{TerrainMemory, TerrainReport, TerrainSettings, TerrainSolver};
use belvedere_scene::{Heightfield, NodeState, Progress, Scene};
use belvedere_testkit::synthetic::{point_layer, terrain_layer};

const EYE: DVec3 = DVec3::new(6000.0, 6000.0, 400.0);

/// A round wall 250 m high, 2.5 km around the eye, on a plain; a hut 1.5 km behind it in the north-east.
fn scene() -> Scene {
    let n = 121usize;
    let height = |i: usize| {
        let p = DVec2::new((i % n) as f64, (n - 1 - i / n) as f64) * 100.0;
        (250.0 * (-((p.distance(EYE.truncate()) - 2500.0) / 400.0).powi(2)).exp()) as f32
    };
    let heights = (0..n * n).map(height).collect();
    let states = vec![NodeState::Measured; n * n];
    let north_west = DVec2::new(0.0, (n - 1) as f64 * 100.0);
    let hf = Heightfield::new(north_west, DVec2::splat(100.0), n, n, heights, states).unwrap();
    let hut = EYE.truncate() + 4000.0 * DVec2::new(0.5f64.sqrt(), 0.5f64.sqrt());
    Scene { layers: vec![terrain_layer(hf), point_layer("hut", hut.extend(0.0))], ..Scene::default() }
}

/// Level from the eye, `heading` degrees east of north.
fn view(heading: f64) -> View {
    let (sin, cos) = heading.to_radians().sin_cos();
    let lens = Projection::Perspective { fov_y: 30f64.to_radians() };
    let target = EYE + DVec3::new(sin, cos, 0.0);
    View::straight(Pinhole::look_at(EYE, target, DVec3::Z, lens, [480, 480], 1.0, None).unwrap())
}

fn film(scene: &Scene, headings: impl Iterator<Item = f64>) -> Vec<TerrainReport> {
    let solver = TerrainSolver::new(TerrainSettings::default()).unwrap().with_time_step(0.04);
    let mut memory = TerrainMemory::default();
    headings.map(|h| solver.solve(scene, &view(h), &mut memory, &Progress::silent()).unwrap().report).collect()
}

#[test]
fn what_comes_into_the_picture_moves_its_ground_by_degrees() {
    let scene = scene();
    // The hut comes in from the right at 30 degrees, is left behind at 60, and is 20 degrees beside the picture at either end.
    let frames = film(&scene, (0..=320).map(|k| 10.0 + 0.25 * f64::from(k)));
    let seen: Vec<&TerrainReport> = frames.iter().filter(|r| r.asked > 0).collect();
    assert!((115..=125).contains(&seen.len()), "{}", seen.len());
    for report in &seen {
        assert!(report.guaranteed && report.metrics.visible == 1.0 && report.unresolved.is_empty(), "{report:?}");
    }
    let most = seen.iter().map(|r| r.metrics.max_m).fold(0.0, f64::max);
    assert!(most > 50.0, "{most}");
    let step = frames.iter().filter_map(|r| r.metrics.frame).map(|f| f.max_m).fold(0.0, f64::max);
    // Beside the picture by d of 15 degrees the line passes the wall 3000 m (d / 15)^3 higher, so 106 m of need end at 4.9 degrees, and
    // a quarter of a degree changes at most 3 x 0.25 / 4.9 of them.
    assert!(step < 0.16 * most, "{step} of {most} from one frame to the next");
    // There is no displacement long before the hut comes in, and none is left in the end.
    let [first, last] = [&frames[0], &frames[320]].map(|r| r.metrics.max_m);
    assert!(first == 0.0 && last < 0.01 * most, "{first} and {last}");
}

#[test]
fn pictures_by_themselves_ask_for_nothing_beside_them() {
    let scene = scene();
    let solver = TerrainSolver::new(TerrainSettings::default()).unwrap();
    let of = |heading| solver.solve(&scene, &view(heading), &mut TerrainMemory::default(), &Progress::silent());
    let (beside, inside) = (of(28.0).unwrap().report, of(32.0).unwrap().report);
    assert_eq!((beside.asked, beside.metrics.max_m, beside.guaranteed), (0, 0.0, false));
    assert!(inside.asked > 0 && inside.guaranteed && inside.metrics.max_m > 50.0, "{inside:?}");
}
