use super::*;
use belvedere_core::DVec3;

fn atoms(list: &[(&str, [f64; 3])]) -> Vec<Atom> {
    let atom = |(i, (symbol, p)): (usize, &(&str, [f64; 3]))| Atom {
        serial: i as i64,
        name: (*symbol).into(),
        element: Element::from_symbol(symbol).unwrap_or_default(),
        residue: 0,
        position: DVec3::from_array(*p),
    };
    list.iter().enumerate().map(atom).collect()
}

#[test]
fn neighbours_within_their_radii_are_bonded() {
    // Two waters (0.96 angstrom, 104.5 degrees) with a hydrogen bond of 1.9 angstrom between them, and a sodium ion.
    let water = [("O", [0.0; 3]), ("H", [0.96, 0.0, 0.0]), ("H", [-0.24, 0.93, 0.0])];
    let other = [("O", [2.86, 0.0, 0.0]), ("H", [3.3, 0.85, 0.0]), ("H", [3.3, -0.85, 0.0])];
    let ion = [("Na", [0.0, -2.3, 0.0]), ("X", [0.2, 0.1, 0.0])];
    let all = atoms(&[&water[..], &other, &ion].concat());
    assert_eq!(by_distance(&all), [[0, 1], [0, 2], [3, 4], [3, 5]]);
}

#[test]
fn length_decides_and_places_taken_twice_are_no_bonds() {
    // The iodine far away makes the search look farther than carbon reaches.
    let pair = |d: f64| {
        by_distance(&atoms(&[("C", [5.0, 0.0, 0.0]), ("C", [5.0 + d, 0.0, 0.0]), ("I", [99.0, 0.0, 0.0])])).len()
    };
    assert_eq!([0.2, 1.2, 1.54, 1.96, 1.98, 3.0].map(pair), [0, 1, 1, 1, 0, 0]);
    // A hydrogen between two carbons belongs to the nearer.
    let shared = atoms(&[("C", [0.0; 3]), ("H", [1.2, 0.0, 0.0]), ("C", [2.3, 0.0, 0.0])]);
    assert_eq!(by_distance(&shared), [[1, 2]]);
    assert_eq!(by_distance(&atoms(&[("O", [0.0; 3])])), [[0u32; 2]; 0]);
}

#[test]
fn a_long_chain_takes_linear_time() {
    let n = 200_000;
    let list: Vec<(&str, [f64; 3])> = (0..n).map(|i| ("C", [1.5 * f64::from(i), 0.0, 0.0])).collect();
    let start = web_time::Instant::now();
    assert_eq!(by_distance(&atoms(&list)).len(), n as usize - 1);
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}
