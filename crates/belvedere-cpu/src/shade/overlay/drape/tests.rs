use super::*;

/// Black and white squares of one pixel, one scene unit each.
fn board(side: usize) -> DrapeMap {
    let pixel = |i: usize| if (i % side + i / side).is_multiple_of(2) { [255u8; 4] } else { [0, 0, 0, 255] };
    let pixels = (0..side * side).map(pixel).collect();
    let a = [1.0, 0.0, 0.0, 0.0, -1.0, side as f64];
    DrapeMap::new(&Drape { pixels, width: side, height: side, pixel_from_scene: a }).unwrap()
}

#[test]
fn a_checkerboard_seen_at_a_grazing_angle_is_its_mean() {
    let board = board(256);
    for (width, length) in [(2.0, 2.0), (2.0, 9.0), (2.5, 24.0), (4.0, 90.0), (2.0, 48.0)] {
        for i in 0..60 {
            let along = DVec2::from_angle(f64::from(i) * 0.37);
            let print = Footprint::new([along * length, along.perp() * width], width);
            let (c, a) = board.at(DVec2::new(128.0 + 0.31 * f64::from(i % 9), 120.0 + 0.17 * f64::from(i)), &print);
            assert!((c - Rgb::splat(0.5)).abs().max_element() < 0.02 && a == 1.0, "{width} x {length}, {i}: {c}");
        }
    }
    // Up close it is sharp.
    let print = Footprint::new([DVec2::X * 0.1, DVec2::Y * 0.1], 0.1);
    assert!(
        board.at(DVec2::new(100.5, 155.5), &print).0.x < 0.01 || board.at(DVec2::new(101.5, 155.5), &print).0.x < 0.01
    );
    assert!(board.at(DVec2::new(-40.0, 10.0), &print).1 == 0.0, "nothing outside");
}

#[test]
fn stripes_along_the_line_of_sight_stay_sharp_at_a_grazing_angle() {
    let side = 128;
    let pixel = |i: usize| if (i % side / 4).is_multiple_of(2) { [255u8; 4] } else { [0, 0, 0, 255] };
    let a = [1.0, 0.0, 0.0, 0.0, -1.0, side as f64];
    let pixels = (0..side * side).map(pixel).collect();
    let stripes = DrapeMap::new(&Drape { pixels, width: side, height: side, pixel_from_scene: a }).unwrap();
    let print = Footprint::new([DVec2::X * 1.0, DVec2::Y * 14.0], 1.0);
    let at = |x: f64| stripes.at(DVec2::new(x, 64.0), &print).0.x;
    assert!(at(66.0) > 0.95 && at(70.0) < 0.05, "{} {}", at(66.0), at(70.0));
}
