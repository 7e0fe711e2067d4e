use super::*;

#[test]
fn tones_from_the_table_are_the_formula() {
    for i in 0..=10_000 {
        let x = i as f32 / 3e3;
        assert!((tone(x, &TONES) - tone_of(x)).abs() < 1e-4, "{x}");
    }
    assert!((tone(99.0, &TONES) - 1.55).abs() < 0.01);
}

#[test]
fn gentle_slopes_are_modelled_and_walls_are_left_alone() {
    let light = ReliefLight::new(Relief::Swiss, &Light::default());
    let towards = |slope: f32| Vec3A::new(-slope, slope, 1.0).normalize();
    let away = |slope: f32| Vec3A::new(slope, -slope, 1.0).normalize();
    // Slopes of three degrees towards the light and away from it differ by a tenth and more.
    let [bright, dark] = [towards(0.037), away(0.037)].map(|n| light.parts(n, 1.0, 1.0)[0]);
    assert!(bright / dark > 1.1, "{bright} {dark}");
    let mut before = f32::INFINITY;
    for i in 0..200 {
        let slope = 0.02 * i as f32;
        let n = Vec3A::from_array(modelled(away(slope).to_array()));
        assert!((n.length() - 1.0).abs() < 1e-5 && n.z < before, "steeper ground stays steeper: {slope}");
        before = n.z;
    }
    let wall = away(4.0);
    assert!(Vec3A::from_array(modelled(wall.to_array())).dot(wall) > 0.9999);
    assert_eq!(modelled([0.0, 0.0, 1.0]), [0.0, 0.0, 1.0]);
}

#[test]
fn shadows_take_the_sun_and_leave_the_sky() {
    let n = Vec3A::new(0.1, -0.2, 0.9).normalize();
    for relief in [Relief::Sun, Relief::Swiss] {
        let light = ReliefLight::new(relief, &Light::default());
        let ([lit, sky], [dark, same]) = (light.parts(n, 1.0, 1.0), light.parts(n, 1.0, 0.0));
        assert!(
            dark < 0.5 * lit && sky == same && (relief == Relief::Swiss) == (dark > 0.0),
            "{relief:?} {lit} {dark}"
        );
    }
}
