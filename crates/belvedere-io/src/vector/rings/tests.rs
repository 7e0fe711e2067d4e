use super::*;

fn square(x: f64, y: f64, half: f64, clockwise: bool) -> Vec<DVec2> {
    let mut ring: Vec<DVec2> = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(u, v)| DVec2::new(x + u * half, y + v * half))
        .into();
    if clockwise {
        ring.reverse();
    }
    ring
}

#[test]
fn holes_and_islands_find_their_polygons_whatever_the_orientation() {
    for turn in 0..16u32 {
        let cw = |k: u32| turn >> k & 1 == 1;
        let rings = vec![
            square(0.0, 0.0, 5.0, cw(0)),  // hole of 1
            square(0.0, 0.0, 10.0, cw(1)), // outer
            square(0.0, 0.0, 2.0, cw(2)),  // island in 0
            square(30.0, 0.0, 4.0, cw(3)), // beside
        ];
        let mut nested = nest(&rings);
        nested.sort();
        assert_eq!(nested, vec![vec![1, 0], vec![2], vec![3]], "orientation {turn:04b}");
    }
}

#[test]
fn area_has_the_sign_of_the_orientation() {
    assert_eq!(doubled_area(&square(1e7, 1e7, 1.0, false)), 8.0);
    assert_eq!(doubled_area(&square(1e7, 1e7, 1.0, true)), -8.0);
    assert_eq!(doubled_area(&[]), 0.0);
}

#[test]
fn a_ring_that_pokes_out_of_another_is_no_hole_of_it() {
    for tip in [DVec2::X, -DVec2::X, DVec2::Y, -DVec2::Y] {
        let mut poking = square(0.0, 0.0, 2.0, false);
        poking.push(12.0 * tip);
        assert_eq!(nest(&[square(0.0, 0.0, 10.0, false), poking]), [[0], [1]], "towards {tip}");
    }
}
