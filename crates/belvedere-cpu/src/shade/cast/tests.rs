use super::*;
use belvedere_scene::{
    BoxLayer, BoxShape, Color, Heightfield, Layer, Mesh, MeshColors, MeshLayer, PaletteName, Relief, TerrainLayer,
};

/// Sun in the west, 45 degrees high.
const SUN: Light = Light {
    clouds: 0.0,
    azimuth: 1.5 * std::f64::consts::PI,
    altitude: std::f64::consts::FRAC_PI_4,
    shadows: true,
    sky: belvedere_scene::Sky::Auto,
    haze: belvedere_scene::Haze::Auto,
};
const AXES: [DVec2; 2] = [DVec2::new(0.5, 0.0), DVec2::new(0.0, 0.5)];

fn layer(kind: LayerKind) -> Layer {
    Layer { id: "any".into(), must_see: false, kind }
}

/// A tower 20 wide and 50 high in the middle.
fn tower() -> LayerKind {
    let (base, size) = (DVec3::ZERO, DVec3::new(20.0, 20.0, 50.0));
    LayerKind::Boxes(BoxLayer::new(vec![BoxShape { base, size, yaw: 0.0, color: Color::rgb(200, 200, 200) }]))
}

/// The same tower as triangles.
fn tower_mesh() -> LayerKind {
    let LayerKind::Boxes(b) = tower() else { panic!("boxes") };
    let triangles = BoxShape::TRIANGLES.map(|t| t.map(|k| k as u32)).to_vec();
    let mesh = Mesh::new(&b.boxes[0].corners(), triangles, MeshColors::Layer).unwrap();
    LayerKind::Mesh(MeshLayer::new(mesh, Color::rgb(200, 200, 200)))
}

fn terrain(ground: Heightfield) -> LayerKind {
    LayerKind::Terrain(TerrainLayer {
        heightfield: ground.into(),
        drapes: Vec::new(),
        relief: Relief::Sun,
        shading: None,
        exaggeration: 1.0,
        palette: PaletteName::Plain.into(),
        contours: None,
        edge: belvedere_scene::Edge::Plain,
    })
}

#[test]
fn a_tower_throws_its_shadow_away_from_the_sun_as_far_as_it_is_high() {
    for kind in [tower(), tower_mesh()] {
        let scene = Scene { layers: vec![layer(kind)], ..Scene::default() };
        let casters = Casters::new(&scene, &SUN, &|_| true, 1 << 20).unwrap();
        for i in -80..160 {
            let x = f64::from(i) + 0.25;
            let lit = casters.on_ground(DVec3::new(x, 3.0, 0.0), AXES, &|_| true);
            // The foot itself is in the dark; the sun is as wide as 0.93 over the length of this shadow.
            let want = if (-9.0..58.5).contains(&x) { Some(0.0) } else { None };
            let want = want.or_else(|| (!(-11.0..=61.5).contains(&x)).then_some(1.0));
            assert!(want.is_none_or(|w| lit == w), "{lit} at {x}");
        }
        let border: Vec<f32> = (0..20)
            .map(|i| casters.on_ground(DVec3::new(59.0 + 0.1 * f64::from(i), 0.0, 0.0), AXES, &|_| true))
            .collect();
        assert!(border.windows(2).all(|w| w[0] <= w[1]), "{border:?}");
        assert!(border.iter().filter(|v| **v > 0.0 && **v < 1.0).count() > 4, "the border is soft: {border:?}");
        assert_eq!(casters.on_ground(DVec3::new(30.0, 10.9, 0.0), AXES, &|_| true), 1.0);
    }
}

#[test]
fn walls_are_lit_from_the_sun_and_darkened_by_each_other_and_by_hills() {
    // A ridge of 60 in the west.
    let heights = (0..41 * 41).map(|i| if i % 41 < 3 { 60.0 } else { 0.0 }).collect();
    let hf = Heightfield::measured(DVec2::new(-100.0, 100.0), DVec2::splat(5.0), 41, 41, heights).unwrap();
    let scene = |ground: bool| {
        let ground = ground.then(|| layer(terrain(hf.clone())));
        Scene { layers: ground.into_iter().chain([layer(tower())]).collect(), ..Scene::default() }
    };
    let low = Light { altitude: 0.4, ..SUN };
    let (open, behind) = (scene(false), scene(true));
    let [open, behind] = [&open, &behind].map(|s| Casters::new(s, &low, &|_| true, 1 << 20).unwrap());
    let west = |z: f64| (DVec3::new(-10.0, 0.0, z), DVec3::NEG_X);
    for z in [5.0, 20.0, 45.0] {
        let (p, n) = west(z);
        assert_eq!(open.on_surface(p, n, 0.2, &|_| true), 1.0, "{z}: nothing throws a shadow on itself");
        // The sun's ray over the ridge at x = -90 comes down by tan 0.4 on 80.
        let want = if z < 60.0 - 80.0 * 0.4f64.tan() { 0.0 } else { 1.0 };
        assert_eq!(behind.on_surface(p, n, 0.2, &|_| true), want, "{z}");
    }
    assert_eq!(open.on_surface(DVec3::new(10.0, 0.0, 5.0), DVec3::X, 0.2, &|_| true), 0.0, "the far side");
    assert_eq!(open.on_surface(DVec3::new(3.0, 2.0, 50.0), DVec3::Z, 0.2, &|_| true), 1.0, "the roof");
}

#[test]
fn ground_at_the_height_of_the_highest_caster_is_lit() {
    let scene = Scene { layers: vec![layer(tower())], ..Scene::default() };
    let casters = Casters::new(&scene, &SUN, &|_| true, 1 << 20).unwrap();
    let lit = |z: f64| casters.on_ground(DVec3::new(3.0, 2.0, z), AXES, &|_| true);
    assert_eq!([49.0, 50.0, 51.0].map(lit), [0.0, 1.0, 1.0]);
}

#[test]
fn nothing_is_asked_where_there_is_nothing_to_ask() {
    let scene = Scene { layers: vec![layer(tower())], ..Scene::default() };
    assert!(Casters::new(&scene, &Light { shadows: false, ..SUN }, &|_| true, 1).is_none());
    assert!(Casters::new(&scene, &Light { altitude: -0.1, ..SUN }, &|_| true, 1).is_none());
    assert!(Casters::new(&Scene::default(), &SUN, &|_| true, 1).is_none());
}

/// Numbers in 0..1 from a seed.
fn random(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Hilly ground, turned towers, and the same towers once more as triangles beside them; far from the origin.
fn town() -> Scene {
    let mut next = random(7);
    let corner = DVec3::new(4e5, 5e6, 0.0);
    let mut towers = || {
        let shape = |_| BoxShape {
            base: corner + DVec3::new(300.0 * next(), 300.0 * next(), 4.0 * next()),
            size: DVec3::new(4.0 + 10.0 * next(), 4.0 + 10.0 * next(), 5.0 + 30.0 * next()),
            yaw: 3.0 * next(),
            color: Color::rgb(200, 200, 200),
        };
        (0..120).map(shape).collect::<Vec<_>>()
    };
    let boxes = LayerKind::Boxes(BoxLayer::new(towers()));
    let corners: Vec<DVec3> = towers().iter().flat_map(|shape| shape.corners()).collect();
    let of = |i: usize| BoxShape::TRIANGLES.map(|t| t.map(|k| (8 * i + k) as u32));
    let triangles = (0..corners.len() / 8).flat_map(of).collect();
    let mesh = Mesh::new(&corners, triangles, MeshColors::Layer).unwrap();
    let mesh = LayerKind::Mesh(MeshLayer::new(mesh, Color::rgb(200, 200, 200)));
    let height = |i: usize| 3.0 + 3.0 * ((i % 81) as f32 * 0.2).sin() + 3.0 * ((i / 81) as f32 * 0.15).cos();
    let north_west = DVec2::new(4e5 - 50.0, 5e6 + 350.0);
    let heights = (0..81 * 81).map(height).collect();
    let ground = Heightfield::measured(north_west, DVec2::splat(5.0), 81, 81, heights).unwrap();
    Scene { layers: [terrain(ground), boxes, mesh].map(layer).to_vec(), ..Scene::default() }
}

#[test]
fn the_light_buffer_tells_what_every_ray_tells() {
    let scene = town();
    let mut next = random(11);
    let (mut told, mut shares) = (0, [0; 3]);
    let suns = [(1.5, 0.8), (0.3, 1.5), (4.1, 0.25), (2.6, 0.02), (5.9, 0.5)];
    for (azimuth, altitude) in suns {
        let casters = Casters::new(&scene, &Light { azimuth, altitude, ..SUN }, &|_| true, 1 << 20).unwrap();
        let Some(towers) = scene.layers[1].kind.boxes() else { panic!("boxes") };
        let Some(model) = scene.layers[2].kind.mesh() else { panic!("mesh") };
        for i in 0..3000 {
            let side = 0.02 * 200f64.powf(next());
            let throws = |layer: usize| i % 5 > 0 || layer != 1 + i % 2;
            let mut both = |p: DVec3, axes: [DVec3; 2], over_ground: bool| {
                let fast = casters.share(p, axes, over_ground, &throws);
                assert_eq!(fast, casters.share_by_trees(p, axes, over_ground, &throws), "{p}, {axes:?}, {altitude}");
                shares[if fast == 0.0 {
                    0
                } else if fast < 1.0 {
                    1
                } else {
                    2
                }] += 1;
                let half = axes.map(|axis| 0.5 * axis);
                let length = casters.way(p.z - 2.0 * side, casters.top);
                told += usize::from(casters.buffer.around(&Bundle { center: p, half, length }).is_some());
            };
            let Some(ground) = scene.layers[0].kind.terrain() else { panic!("terrain") };
            let xy = DVec2::new(4e5 - 40.0, 5e6 - 40.0) + 380.0 * DVec2::new(next(), next());
            let along = side * DVec2::from_angle(6.0 * next());
            let z = ground.heightfield.surface_at(xy).expect("ground");
            both(xy.extend(z), [along.extend(0.0), 3.0 * along.perp().extend(0.0)], false);
            // A place on a side of a tower of either kind.
            let [a, b, c] = if i % 2 == 0 {
                let tower = towers.boxes[i % towers.boxes.len()];
                BoxShape::TRIANGLES[i % 12].map(|k| tower.corners()[k])
            } else {
                model.mesh.corners(i * 7 % model.mesh.triangles().len())
            };
            let normal = (b - a).cross(c - a).normalize();
            let (u, v) = normal.any_orthonormal_pair();
            let [s, t] = [next(), next()];
            let off = OFF_PX * side + OFF * a.abs().max_element();
            both(a + s * (b - a) + t * (1.0 - s) * (c - a) + off * normal, [side * u, side * v], true);
        }
    }
    assert!(shares.iter().all(|n| *n > 500), "dark, half, lit: {shares:?}");
    assert!(told > 20_000, "of 30000 bundles {told} are told by the buffer");
}
