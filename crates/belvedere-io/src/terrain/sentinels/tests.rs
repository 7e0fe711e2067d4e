use super::*;

fn voids(mut heights: Vec<f32>, unit: f32) -> (usize, Option<Warning>) {
    let said = void(&mut heights, unit);
    (heights.iter().filter(|h| h.is_nan()).count(), said)
}

/// Hills between two heights, with a few samples of other values.
fn hills(low: f32, high: f32, odd: &[f32]) -> Vec<f32> {
    (0..1000).map(|k| low + (high - low) * (k as f32 * 0.37).sin().abs()).chain(odd.iter().copied()).collect()
}

#[test]
fn values_far_from_all_others_are_voids() {
    for value in [-9999.0, -32768.0, -32767.0, -99999.0, -999.0, 9999.0, 32767.0, 65535.0] {
        let (count, said) = voids(hills(200.0, 1900.0, &[value; 3]), 1.0);
        assert_eq!(count, 3, "{value}");
        assert!(said.is_some_and(|s| s.text().contains(&format!("3 samples of {value},"))), "{value}");
    }
    let (count, said) = voids(hills(200.0, 1900.0, &[-9999.0, 65535.0, -32768.0]), 1.0);
    assert_eq!(count, 3, "{said:?}");
    // in feet
    assert_eq!(voids(hills(200.0, 1900.0, &[-9999.0 * 0.3048]), 0.3048).0, 1);
    assert_eq!(voids(hills(100.0, 100.0, &[-9999.0]), 1.0).0, 1, "flat ground");
    for value in [-88888.0, 50000.0, -12345.0, 12345.0, 0.0, -1.0, -9990.0, 9999.9] {
        assert_eq!(voids(hills(800.0, 1900.0, &[value; 2]), 1.0).0, 2, "{value}");
    }
}

#[test]
fn heights_near_others_stay() {
    assert_eq!(voids(hills(-10500.0, 3000.0, &[-9999.0]), 1.0), (0, None), "a trench");
    assert_eq!(voids(hills(200.0, 1900.0, &[]), 1.0), (0, None));
    assert_eq!(voids(hills(-1200.0, -700.0, &[-999.0]), 1.0), (0, None));
    assert_eq!(voids(hills(0.0, 8849.0, &[9999.0]), 1.0), (0, None), "no gap of a fifth of the relief");
    assert_eq!(voids(vec![-9999.0; 40], 1.0), (0, None), "nothing else");
    assert_eq!(voids(hills(200.0, 1900.0, &[-5000.0]), 1.0), (0, None), "no custom");
    assert_eq!(voids(hills(200.0, 1900.0, &[0.0, -1.0]), 1.0), (0, None), "the sea");
    let plane = |high: &dyn Fn(usize) -> f32| (0..1000).map(|k| if k % 10 < 6 { 0.0 } else { high(k) }).collect();
    assert_eq!(voids(plane(&|_| 1000.0), 1.0), (0, None), "walls on a plane");
    assert_eq!(voids(plane(&|k| 800.0 + k as f32), 1.0), (0, None), "more plane than hills");
    assert_eq!(voids(hills(900.0, 900.0, &[0.0; 9]), 1.0), (0, None), "two levels");
    assert_eq!(voids(hills(-8000.0, 21200.0, &[]), 1.0), (0, None), "Mars");
}

#[test]
fn a_frame_of_zeros_beside_high_ground_is_void_and_the_sea_round_an_island_is_not() {
    let (cols, rows) = (40usize, 30usize);
    let ground = |land: &dyn Fn(usize) -> f32| -> Vec<f32> {
        let of = |i: usize| {
            let inland = (i % cols).min(cols - 1 - i % cols).min(i / cols).min(rows - 1 - i / cols);
            if inland < 5 { 0.0 } else { land(inland - 5) }
        };
        (0..cols * rows).map(of).collect()
    };
    let framed = |mut heights: Vec<f32>| {
        let said = void_frame(&mut heights, cols);
        (heights.iter().filter(|h| h.is_nan()).count(), said.is_some())
    };
    assert_eq!(framed(ground(&|k| 90.0 + k as f32)), (cols * rows - 30 * 20, true), "a frame");
    assert_eq!(framed(ground(&|k| 12.0 * (k + 1) as f32)), (0, false), "an island");
    let mut land = ground(&|k| 90.0 + k as f32);
    land[7] = 55.0;
    assert_eq!(framed(land), (0, false), "data reach the border");
    let mut lake = ground(&|k| 90.0 + k as f32);
    lake[15 * cols + 20] = 0.0;
    assert_eq!(framed(lake).0, cols * rows - 30 * 20, "a zero inside stays");
}
