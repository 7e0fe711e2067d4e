use super::*;
use belvedere_core::DVec3;
use belvedere_scene::Heightfield;

const N: usize = 181;

fn hills(cols: usize, rows: usize) -> Heightfield {
    let h = |i: usize| {
        let (x, y) = ((i % cols) as f32 * 0.11, (i / cols) as f32 * 0.13);
        240.0 * (x.sin() * (0.7 * y).cos() + 0.4 * (2.3 * x + y).sin() + 0.2 * (5.1 * y - 3.0 * x).cos())
    };
    let heights = (0..cols * rows).map(h).collect();
    Heightfield::new(DVec2::ZERO, DVec2::new(30.0, 20.0), cols, rows, heights, vec![NodeState::Measured; cols * rows])
        .unwrap()
}

/// Least height of the sun's ray over the ground, by short steps: as share of the way gone, and in metres.
fn clearance(hf: &Heightfield, from: DVec3, light: &Light) -> [f64; 2] {
    let towards = light.direction() / light.direction().truncate().length();
    let top = hf.z_range()[1];
    let mut least = [f64::INFINITY; 2];
    for i in 1.. {
        let p = from + towards * (5.0 * f64::from(i));
        if p.z > top {
            break;
        }
        let Some(z) = hf.height_at(p.truncate()) else {
            // What lies beyond the border is not known.
            least[0] = 0.0;
            break;
        };
        least[0] = least[0].min((p.z - z) / (5.0 * f64::from(i)));
        least[1] = least[1].min(p.z - z);
    }
    least
}

#[test]
fn thousands_of_nodes_are_as_dark_as_rays_towards_the_sun_say() {
    let hf = hills(N, N);
    let surface = Surface::of_map(&hf);
    let means = MipPyramid::new(&surface);
    let (mut dark, mut bright, mut wrong) = (0, 0, [0; 2]);
    for (azimuth, altitude) in [(315f64, 20f64), (10.0, 12.0), (93.0, 16.0), (200.0, 25.0), (260.0, 8.0), (45.0, 30.0)]
    {
        let light =
            Light { azimuth: azimuth.to_radians(), altitude: altitude.to_radians(), shadows: true, ..Light::default() };
        let shadows = Shadows::new(&surface, &means, &light, Softness::SUN);
        let lit = &shadows.levels[0].2;
        for i in (0..N * N).step_by(7) {
            let p = hf.node(i % N, i / N).unwrap();
            let [share, clear] = clearance(&hf, p, &light);
            let shadow = clear < -6.0;
            // Where the ray just grazes the ground, cells and lines differ.
            if !shadow && share < 0.02 {
                continue;
            }
            (dark, bright) = (dark + u32::from(shadow), bright + u32::from(!shadow));
            wrong[usize::from(shadow)] += u32::from(shadow != (lit[i] < 128));
        }
    }
    assert!(dark > 3000 && bright > 2000, "{dark} {bright}");
    let all = wrong[0] + wrong[1];
    assert!(all * 200 < dark + bright, "{wrong:?} of {bright} bright and {dark} dark nodes");
}

#[test]
fn a_wall_throws_its_shadow_as_far_as_its_height_over_the_tangent() {
    // A wall of 100 m in column 20, sun in the west at 45 degrees, cells of 10 m.
    let (cols, rows) = (60, 9);
    let heights: Vec<f32> = (0..cols * rows).map(|i| if i % cols == 20 { 100.0 } else { 0.0 }).collect();
    let light = Light { azimuth: 270f64.to_radians(), altitude: 45f64.to_radians(), shadows: true, ..Light::default() };
    let lit = sweep([cols, rows], DVec2::splat(10.0), (&light, Softness::SUN), &|i| heights[i]);
    for c in 0..cols {
        let want = if c > 20 && c < 30 { 0 } else { 255 };
        if c != 30 {
            assert_eq!(lit[4 * cols + c], want, "column {c}");
        }
    }
    assert!((100..156).contains(&lit[4 * cols + 30]), "the border lies halfway: {}", lit[4 * cols + 30]);
    assert!(
        sweep([cols, rows], DVec2::splat(10.0), (&Light { altitude: -0.01, ..light }, Softness::SUN), &|i| heights[i])
            .iter()
            .all(|&l| l == 0)
    );
}

#[test]
fn voids_throw_no_shadow_and_the_border_softens_with_distance() {
    let (cols, rows) = (400, 5);
    let light = Light { azimuth: 270f64.to_radians(), altitude: 10f64.to_radians(), shadows: true, ..Light::default() };
    let void: Vec<f32> = (0..cols * rows).map(|i| if i % cols == 20 { f32::NEG_INFINITY } else { 0.0 }).collect();
    assert!(sweep([cols, rows], DVec2::splat(10.0), (&light, Softness::SUN), &|i| void[i]).iter().all(|&l| l == 255));
    let soft = |wall: f32| {
        let lit = sweep([cols, rows], DVec2::splat(2.0), (&light, Softness::SUN), &|i| {
            if i % cols == 2 { wall } else { 0.0 }
        });
        lit[..cols].iter().filter(|&&l| l > 0 && l < 255).count()
    };
    assert!(soft(130.0) > soft(20.0) && soft(130.0) >= 12, "{} {}", soft(20.0), soft(130.0));
}

/// A wall on a plain: its painted shadow is softer than that of the sun, fades, and ends within its reach.
#[test]
fn painted_shadows_are_soft_and_short() {
    let (cols, rows) = (900, 3);
    let light = Light { azimuth: 270f64.to_radians(), altitude: 0.6, ..Light::default() };
    let lit = |soft: Softness, wall: f32| {
        let height = move |i: usize| if i % cols == 2 { wall } else { 0.0 };
        let lit = sweep([cols, rows], DVec2::splat(10.0), (&light, soft), &height);
        lit[cols..2 * cols].iter().map(|l| f64::from(*l) / 255.0).collect::<Vec<_>>()
    };
    let [sun, painted] = [Softness::SUN, Softness::PAINTED].map(|soft| lit(soft, 400.0));
    let border = |lit: &[f64]| lit.iter().filter(|l| (0.05..0.95).contains(*l)).count();
    assert!(border(&painted) > 5 * border(&sun).max(1), "{} cells, {} by the sun", border(&painted), border(&sun));
    let high = lit(Softness::PAINTED, 4000.0);
    assert!(high[10] < 0.2 && high[270..].iter().all(|l| *l > 0.99), "{:?}", &high[230..290]);
}
