use super::*;

#[test]
fn moves_keep_the_speed_and_states_fit_16_bits() {
    for per_frame in [0.001, 0.013, 0.0249, 0.05, 0.0625, 0.099, 0.1, 0.24, 0.39, 0.41, 1.5, 9.0] {
        let disc = Disc::new(per_frame, false);
        assert!(disc.places.len() * SENSES <= usize::from(u16::MAX), "{per_frame}: {}", disc.places.len());
        let all = disc.moves.iter().enumerate().flat_map(|(to, moves)| moves.iter().map(move |m| (m.from, to)));
        let longest = all.map(|(a, b)| distance(disc.places[a], disc.places[b])).fold(0.0, f64::max);
        let most = (per_frame * disc.stride as f64).min(2.0);
        assert!(longest <= most * (1.0 + 1e-6) && longest > 0.7 * most, "{per_frame}: {longest}");
        let reach = disc.places.iter().map(|p| p[0].hypot(p[1])).fold(0.0, f64::max);
        assert!(reach > 0.9 && reach <= 1.0 + 1e-9, "{per_frame}: {reach}");
    }
}

#[test]
fn waits_aside_where_returning_would_mean_turning_round_again() {
    let disc = Disc::new(0.1, true);
    let middle = disc.places.iter().position(|p| *p == [0.0, 0.0]).unwrap();
    // The middle is closed at two times; between them being there would be free.
    let cost = |knot: usize| {
        let closed = [10, 30].contains(&knot);
        (0..disc.places.len()).map(|n| if closed && n == middle { 1e6 } else { 0.0 }).collect()
    };
    let (least, way) = disc.cheapest(40, cost);
    assert!(least < 1e-9 && way.len() == 40 && way.iter().all(|n| n == &way[0] && *n != middle), "{least} {way:?}");
}

#[test]
fn goes_round_the_middle_on_a_ring() {
    let disc = Disc::new(0.1, false);
    // A hole that goes once round: only places in its direction and not too near the middle are open.
    let open = |knot: usize, [x, y]: [f64; 2]| {
        let (sin, cos) = (0.06 * knot as f64).sin_cos();
        let (along, beside) = (x * cos + y * sin, y * cos - x * sin);
        along > 0.4 && along < 0.8 && beside.abs() < 0.15
    };
    let cost = |knot: usize| disc.places.iter().map(|p| if open(knot, *p) { 0.0 } else { 1e6 }).collect();
    let (least, way) = disc.cheapest(100, cost);
    let radii: Vec<f64> = way.iter().map(|n| disc.places[*n][0].hypot(disc.places[*n][1])).collect();
    assert!(least < 10.0 && radii.iter().all(|r| (r - radii[0]).abs() < 1e-9), "{least} {radii:?}");
}

#[test]
fn passing_the_middle_is_not_turning_round_and_coming_back_is() {
    let [right, up, left] = [[0.1, 0.0], [0.0, 0.1], [-0.1, 0.0]];
    let kind = |from: [f64; 2], to: [f64; 2]| {
        let ring = |p: [f64; 2]| usize::from(p != [0.0; 2]);
        Move::new((0, (ring(from), from)), (ring(to), to), 0.1).kind
    };
    for (to, turns) in [(left, 0), (right, 1), (up, 1)] {
        let (at, first) = kind(right, [0.0; 2]).sense_after(0);
        assert_eq!((first, kind([0.0; 2], to).sense_after(at[0]).1), (0, turns), "{to:?}");
    }
    assert_eq!(kind(right, left).sense_after(0), ([1; 2], 0));
    assert_eq!(kind(right, left).sense_after(1), ([1; 2], 1));
}
