use super::*;
use belvedere_core::{Pinhole, Projection};
use belvedere_scene::{Layer, PaletteName, Relief, TerrainLayer};

/// Waves of 400 over a square of 20,000 by nodes 50 apart.
fn ground() -> Scene {
    let n = 401;
    let height = |i: usize| 400.0 * ((i % n) as f32 * 0.05).sin() * ((i / n) as f32 * 0.04).cos();
    let heights = (0..n * n).map(height).collect();
    let hf = Heightfield::measured(DVec2::new(0.0, 20e3), DVec2::splat(50.0), n, n, heights).expect("ground");
    let terrain = TerrainLayer {
        heightfield: hf.into(),
        drapes: Vec::new(),
        relief: Relief::Sun,
        shading: None,
        exaggeration: 1.0,
        palette: PaletteName::Plain.into(),
        contours: None,
        edge: belvedere_scene::Edge::Plain,
    };
    let layer = Layer { id: "ground".into(), must_see: false, kind: terrain.into() };
    Scene { layers: vec![layer], ..Scene::default() }
}

fn screen(eye: DVec3, lens: Projection) -> Screen {
    let target = DVec3::new(10e3, 10e3, 0.0);
    Screen::new(&Pinhole::look_at(eye, target, DVec3::Z, lens, [268, 151], 1.0, None).expect("pinhole"))
}

#[test]
fn lines_of_coarse_pictures_have_few_points_and_lie_where_all_of_them_do() {
    let scene = ground();
    let at = |i: u32| {
        let t = f64::from(i) / 20_000.0;
        DVec2::new(2e3 + 16e3 * t, 10e3 + 4e3 * (9.0 * t).sin())
    };
    let line: Vec<DVec3> = (0..=20_000).map(|i| at(i).extend(0.0)).collect();
    let perspective = Projection::Perspective { fov_y: 0.8 };
    let eye = DVec3::new(10e3, -9e3, 5e3);
    for lens in [perspective, Projection::Orthographic { height: 15e3 }] {
        let screen = screen(eye, lens);
        let image = |p: DVec3| screen.pixel(screen.view_from(p));
        let [fine, coarse] = [None, Some(&screen)].map(|coarse| lay(&scene, &line, 2.0, coarse).concat());
        assert!(coarse.len() * 20 < fine.len(), "{} of {} points", coarse.len(), fine.len());
        let ends = |points: &[LinePoint]| [points[0].p, points[points.len() - 1].p];
        assert_eq!(ends(&fine), ends(&coarse));
        let chords: Vec<[DVec2; 2]> = coarse.windows(2).map(|pair| [image(pair[0].p), image(pair[1].p)]).collect();
        for point in &fine {
            let p = image(point.p);
            let off = |[a, b]: &[DVec2; 2]| belvedere_core::polygon::to_segment(p, *a, *b).length();
            let nearest = chords.iter().map(off).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1.0, "{p} lies {nearest} pixels beside the line");
        }
        // Points on the ground are draped alike.
        let on_ground: Vec<DVec3> = fine.iter().map(|point| point.p - 2.0 * DVec3::Z).collect();
        let draped = drape(&scene, &on_ground, 2.0, Some(&screen));
        assert!(draped.len() * 20 < fine.len() && draped.iter().all(|point| point.on_ground));
        assert_eq!(ends(&draped), ends(&fine));
    }
}
