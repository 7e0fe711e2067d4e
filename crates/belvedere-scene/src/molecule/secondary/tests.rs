use super::*;

/// Alpha carbons along a helix: radius, turn (degrees) and rise per residue.
fn spiral(n: usize, radius: f64, turn: f64, rise: f64) -> Vec<DVec3> {
    let at = |i: usize| {
        let (sin, cos) = (turn * i as f64).to_radians().sin_cos();
        DVec3::new(radius * cos, radius * sin, rise * i as f64)
    };
    (0..n).map(at).collect()
}

#[test]
fn an_alpha_helix_is_one_and_its_mirror_image_is_none() {
    let helix = spiral(12, 2.3, 100.0, 1.5);
    assert_eq!(by_places(&helix), vec![Secondary::Helix; 12]);
    assert!((dihedral([helix[0], helix[1], helix[2], helix[3]]) - 50.0).abs() < 3.0);
    let mirrored: Vec<DVec3> = helix.iter().map(|p| DVec3::new(p.x, p.y, -p.z)).collect();
    assert!((dihedral([mirrored[0], mirrored[1], mirrored[2], mirrored[3]]) + 50.0).abs() < 3.0);
    assert_eq!(by_places(&mirrored), vec![Secondary::Coil; 12]);
    assert_eq!(by_places(&helix[..4]), vec![Secondary::Coil; 4], "too short");
}

#[test]
fn strands_lie_beside_each_other_unless_they_are_long() {
    // Pleated: 3.3 angstrom of rise, 0.9 to either side.
    let strand = |n: usize, y: f64| -> Vec<DVec3> {
        (0..n).map(|i| DVec3::new(3.3 * i as f64, y, if i % 2 == 0 { 0.9 } else { -0.9 })).collect()
    };
    assert_eq!(by_places(&strand(9, 0.0)), vec![Secondary::Strand; 9]);
    assert_eq!(by_places(&strand(5, 0.0)), vec![Secondary::Coil; 5]);
    let mut pair = strand(5, 0.0);
    // A turn far enough out that nothing of it fits.
    pair.extend([DVec3::new(17.0, 0.0, 4.0), DVec3::new(17.0, 2.4, 8.0), DVec3::new(17.0, 4.8, 4.0)]);
    pair.extend(strand(5, 4.8).into_iter().rev());
    let found = by_places(&pair);
    assert!(found[1..4].iter().chain(&found[9..12]).all(|s| *s == Secondary::Strand), "{found:?}");
    assert_eq!(found[6], Secondary::Coil);
}

#[test]
fn few_or_equal_places_are_coil() {
    for n in 0..6 {
        assert_eq!(by_places(&vec![DVec3::ONE; n]), vec![Secondary::Coil; n]);
    }
}
