//! Terrain disocclusion on a thread beside drawing: the ground of each picture, and its age.

use belvedere_core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere_disocclusion::DisocclusionError;
use belvedere_disocclusion::{LiveTerrain, TerrainMemory, TerrainSettings, TerrainSolver};
use belvedere_scene::{Progress, Scene};
use belvedere_testkit::synthetic::{line_layer, mountains, terrain_layer, trail};
use std::sync::Arc;

fn scene() -> Arc<Scene> {
    let hf = mountains(65, 3);
    let way = trail(&hf);
    Arc::new(Scene { layers: vec![terrain_layer(hf), line_layer("trail", way)], ..Scene::default() })
}

/// The picture of a walker's camera after `step` steps of 4 m.
fn view(scene: &Scene, step: f64, above: f64) -> View {
    let at = DVec2::new(1500.0 + 4.0 * step, 200.0);
    let ground = scene.terrain().and_then(|t| t.surface_at(at)).expect("over the terrain");
    let lens = Projection::Perspective { fov_y: 50f64.to_radians() };
    let target = DVec3::new(1600.0, 1900.0, ground);
    let camera = Pinhole::look_at(at.extend(ground + above), target, DVec3::Z, lens, [320, 180], 1.0, None);
    View::straight(camera.expect("a camera"))
}

fn live(scene: &Arc<Scene>) -> LiveTerrain {
    let solver = TerrainSolver::new(TerrainSettings::default()).expect("settings").with_time_step(0.04);
    LiveTerrain::new(solver, scene.clone())
}

#[test]
fn the_first_picture_waits_for_the_ground_that_the_solver_makes() {
    let scene = scene();
    let base = view(&scene, 0.0, 250.0);
    let first = live(&scene).frame(&base).expect("ground");
    let solver = TerrainSolver::new(TerrainSettings::default()).expect("settings").with_time_step(0.04);
    let alone = solver.solve(&scene, &base, &mut TerrainMemory::default(), &Progress::silent()).expect("ground");
    assert!(alone.report.visible_before < 0.9, "nothing to do: {}", alone.report.visible_before);
    assert_eq!((first.lag, first.hidden), (0, 0));
    assert!(first.points > 10, "{} points", first.points);
    assert_eq!(first.stage, alone.stage);
}

#[test]
fn ground_is_never_older_than_the_limit_and_what_it_hides_is_said() {
    let scene = scene();
    let mut live = live(&scene);
    let mut late = 0;
    for k in 0..24 {
        let frame = live.frame(&view(&scene, f64::from(k), 250.0)).expect("ground");
        assert!(frame.lag <= LiveTerrain::LAG, "picture {k} lags by {}", frame.lag);
        late += u64::from(frame.lag > 0);
    }
    assert!(late > 0, "24 pictures without any drawing between them, and no solution came too late for one");
    // The eye sinks from one picture to the next: old ground cannot show everything, and the frame must report that.
    let far = live.frame(&view(&scene, 24.0, 60.0)).expect("ground");
    assert_eq!(far.hidden > 0, far.hidden_worst_m > 0.0);
    assert!(far.lag == 0 || far.hidden > 0, "ground for an eye 190 m higher hides nothing, lag {}", far.lag);
    // The eye stays: the ground catches up.
    let still = (0..6).map(|_| live.frame(&view(&scene, 24.0, 60.0)).expect("ground")).last().expect("frames");
    assert_eq!(still.hidden, 0);
}

#[test]
fn an_eye_under_the_ground_is_an_error_from_which_it_goes_on() {
    let scene = scene();
    let mut live = live(&scene);
    assert!(matches!(live.frame(&view(&scene, 0.0, -30.0)), Err(DisocclusionError::Eye(_))));
    assert!(live.frame(&view(&scene, 0.0, 250.0)).is_ok());
}

#[test]
fn pictures_that_do_not_wait_get_the_newest_ground_there_is() {
    let scene = scene();
    let mut live = live(&scene);
    let began = std::time::Instant::now();
    assert!(live.newest(&view(&scene, 0.0, 250.0)).expect("no ground yet").is_none());
    let first = loop {
        if let Some(stage) = live.newest(&view(&scene, 0.0, 250.0)).expect("ground") {
            break stage;
        }
        assert!(began.elapsed() < std::time::Duration::from_secs(60), "it is never solved");
        std::thread::sleep(std::time::Duration::from_millis(2));
    };
    // Whatever view is requested next, the newest solved ground comes at once: at first that for the view before.
    let next = live.newest(&view(&scene, 40.0, 250.0)).expect("ground").expect("there is some");
    let moves = |stage: &belvedere_core::TerrainDisocclusion| stage.grid().range() != [0.0; 2];
    assert!(moves(&first) && moves(&next), "nothing makes way");
}
