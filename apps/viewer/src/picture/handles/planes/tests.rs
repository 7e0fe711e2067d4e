use super::*;
use belvedere::scene::Heightfield;

fn turn() -> TurnDoc {
    let text = "format = 1\n[camera]\neye = [0, 0, 10]\nlook_at = [0, 1, 0]\n[[stage]]\nkind = 'curved_rays'\n[[stage.turn]]\n\
            viewpoint = [40, 10, 60]\nt0 = [0, 100, 30]\nt1 = [0, 120, 28]\nt2 = [0, 140, 26]\nnormal = [0, 0.8, -0.6]\n";
    let document = belvedere::scene_file::parse(std::path::Path::new("s.toml"), text).expect("scene").document;
    match document.stage.into_iter().next() {
        Some(StageDoc::CurvedRays(stage)) => stage.turn[0].clone(),
        other => panic!("{other:?}"),
    }
}

fn scene() -> Scene {
    // Ground that rises by a tenth to the north.
    let heights = (0..41 * 41).map(|i| 20.0 - (i / 41) as f32).collect();
    let ground = Heightfield::measured(DVec2::new(-200.0, 300.0), DVec2::splat(10.0), 41, 41, heights);
    Scene::default().with_terrain("ground", ground.expect("ground"))
}

#[test]
fn the_foot_and_the_line_of_a_plane_lie_on_it_and_on_the_ground() {
    let (scene, turn) = (scene(), turn());
    for point in points(&turn) {
        let normal = normal(&turn, point);
        let foot = foot(&scene, point, normal).expect("a foot");
        for p in line(&scene, point, normal, foot, 60.0).into_iter().chain([foot]) {
            assert!((p - point).dot(normal).abs() < 0.05, "{p} is off the plane of {point}");
            assert!((p.z - ground(&scene, p.truncate())).abs() < 0.05, "{p} is off the ground");
        }
    }
    assert!(foot(&scene, points(&turn)[0], DVec3::Z).is_none(), "a level plane has no foot");
}

#[test]
fn planes_stay_in_order() {
    let turn = turn();
    let eye = DVec3::new(0.0, 0.0, 10.0);
    let at = points(&turn).map(|p| p.dot(through(&turn)));
    for part in 0..3 {
        let [low, high] = range(&turn, part, eye).map(|d| at[part] + d);
        assert!(low < at[part] && at[part] < high);
        assert!(part == 0 || low > at[part - 1], "{part}");
        assert!(part == 2 || high < at[part + 1], "{part}");
    }
}
