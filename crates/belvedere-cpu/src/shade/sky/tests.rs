use super::*;
use belvedere_core::{DVec2, Projection};

#[test]
fn haze_and_sky_are_as_the_light_says() {
    let scene = Scene::default();
    let screen = Projection::Perspective { fov_y: 1.0 };
    let p = Pinhole::look_at(DVec3::ZERO, DVec3::X, DVec3::Z, screen, [64, 48], 1.0, None).unwrap();
    let seen = |light: Light| Sky::of(&scene, &light, &p);
    let clear = seen(Light { haze: Haze::None, ..Light::default() });
    assert_eq!(clear.haze_at(1e9), 0.0);
    let air = seen(Light { haze: Haze::Visibility(4000.0), ..Light::default() });
    for depth in [0.0f32, 100.0, 1000.0, 4000.0, 1e6] {
        let want = 1.0 - (-3.912 * depth / 4000.0).exp();
        assert!((air.haze_at(depth) - want).abs() < 4e-3, "{depth}: {} for {want}", air.haze_at(depth));
    }
    // A parallel projection has no eye to be far from.
    let parallel = Projection::Orthographic { height: 50.0 };
    let p = Pinhole::look_at(DVec3::ZERO, DVec3::X, DVec3::Z, parallel, [64, 48], 1.0, None).unwrap();
    let above = Sky::of(&scene, &Light { haze: Haze::Visibility(4000.0), ..Light::default() }, &p);
    assert_eq!(above.haze_at(3000.0), 0.0);
    // A plain sky is one colour in every pixel, to the byte.
    for color in [Color::rgb(255, 255, 255), Color::rgb(0, 0, 0), Color::rgb(17, 130, 201)] {
        let sky = seen(Light { sky: Choice::Plain(color), ..Light::default() });
        let mut row = [[7; 3]; 64];
        for y in 0..48 {
            sky.store([SUB / 2, y * SUB + SUB / 2], &mut row);
            assert!(row.iter().all(|pixel| *pixel == [color.r, color.g, color.b]), "{color:?}: {:?}", row[0]);
        }
    }
    let paper = seen(Light { sky: Choice::Plain(Color::rgb(0, 0, 0)), ..Light::default() });
    assert!((paper.towards(0.4) - towards(0.4)).abs().max_element() < 1e-6, "water mirrors no paper");
    let light = |degrees: f64| Light { altitude: degrees.to_radians(), ..Light::default() };
    let up = |sky: &Sky| sky.towards(0.9).element_sum();
    let [day, dusk, night] = [30.0, 2.0, -20.0].map(|height| up(&seen(light(height))));
    assert!(day > dusk && dusk > 2.0 * night, "{day} {dusk} {night}");
}

#[test]
fn pixels_see_the_sky_that_their_rays_point_at() {
    let screen = Projection::Perspective { fov_y: 0.9 };
    let up = DVec3::new(0.2, 0.1, 1.0);
    let p = Pinhole::look_at(DVec3::ZERO, DVec3::new(3.0, 8.0, 1.0), up, screen, [80, 60], 1.0, None).unwrap();
    let sky = Sky::new(&Aabb::EMPTY, &p);
    for i in 0..4800 {
        let pixel = DVec2::new(f64::from(i % 80) + 0.5, f64::from(i / 80) + 0.5);
        let t = (pixel - p.center_px()) / p.scale_px();
        let ray = p.forward + t.x * p.right + t.y * p.down;
        let pixel = [pixel.x as f32, pixel.y as f32];
        assert!((f64::from(sky.sine(pixel)) - ray.normalize().z).abs() < 1e-6);
        let step = (roots(sky.at(pixel)) - roots(towards(ray.z.clamp(-1.0, 1.0) as f32))).abs().max_element() * 255.0;
        assert!(step < 0.8, "{step} steps");
        let (x, y) = ([pixel[0] as i32 * 256 + 128], [pixel[1] as i32 * 256 + 128]);
        let ([mut r], [mut g], [mut b]) = ([0.0], [0.0], [0.0]);
        sky.paint(&x, &y, [&mut r, &mut g, &mut b].map(std::slice::from_mut));
        assert!((Rgb::new(r * r, g * g, b * b) - sky.at(pixel)).abs().max_element() < 1e-5);
    }
}
#[test]
fn rows_of_sky_are_within_a_step_of_each_of_their_pixels() {
    let screen = Projection::Perspective { fov_y: 0.8 };
    for (roll, pitch) in [(0.0, 0.0), (0.0, 0.3), (0.0, -0.2), (0.05, 0.0), (0.3, 0.1), (1.5, 0.0)] {
        let up = DVec3::new(f64::sin(roll), 0.0, f64::cos(roll));
        let target = DVec3::new(0.0, f64::cos(pitch), f64::sin(pitch));
        let p = Pinhole::look_at(DVec3::ZERO, target, up, screen, [1283, 720], 1.0, None).unwrap();
        let sky = Sky::new(&Aabb::EMPTY, &p);
        let x: Vec<i32> = (0..1283).map(|x| x * SUB + SUB / 2).collect();
        let (mut planes, mut each) = ([(); 3].map(|()| vec![0.0f32; 1283]), [(); 3].map(|()| vec![0.0f32; 1283]));
        let mut worst = 0.0f32;
        for row in (0..720).step_by(7) {
            let y = vec![row * SUB + SUB / 2; 1283];
            sky.paint(&x, &y, planes.each_mut().map(Vec::as_mut_slice));
            for (k, x) in x.chunks(LANES).enumerate() {
                let out = each.each_mut().map(|plane| &mut plane[k * LANES..][..x.len()]);
                sky.paint_each(x, &y[..x.len()], out);
            }
            for (a, b) in planes.iter().flatten().zip(each.iter().flatten()) {
                worst = worst.max((a - b).abs() * 255.0);
            }
        }
        assert!(worst < 0.6, "rolled by {roll}, raised by {pitch}: {worst} steps");
    }
}

#[test]
fn the_sky_is_pale_at_the_skyline_and_darker_at_the_top_however_far_down_the_view_looks() {
    let screen = Projection::Perspective { fov_y: 0.8 };
    let bounds = Aabb { min: DVec3::new(-4e4, 0.0, 0.0), max: DVec3::new(4e4, 8e4, 2500.0) };
    for pitch in [0.0f64, 0.2, 0.35, 0.5] {
        let target = DVec3::new(0.0, pitch.cos(), -pitch.sin());
        let p =
            Pinhole::look_at(DVec3::Z * 9000.0, DVec3::Z * 9000.0 + target, DVec3::Z, screen, [320, 200], 1.0, None);
        let p = p.unwrap();
        let stretch = Stretch::new(&bounds, &p);
        let sky = Sky { steps: steps(|rise| towards(stretch.of(rise))), stretch, ..Sky::new(&bounds, &p) };
        let lightness = |y: f32| roots(sky.at([160.5, y])).dot(Rgb::new(0.2, 0.7, 0.1));
        let (top, palest) = (lightness(0.5), (20..110).map(|y| lightness(y as f32 + 0.5)).fold(0.0, f32::max));
        assert!(palest - top > 0.2, "looking down by {pitch}: {top} at the top, {palest} at the skyline");
        // Level bands: the colour of a row is the same from side to side.
        assert!((roots(sky.at([0.5, 9.5])) - roots(sky.at([319.5, 9.5]))).abs().max_element() < 2.1 / 255.0);
    }
}
