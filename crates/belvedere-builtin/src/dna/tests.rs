use super::*;

#[test]
fn a_double_helix_is_bonded_as_chemistry_says() {
    let m = helix(7, 12).unwrap();
    let at = |chain: &str, number: i32, name: &str| {
        (0..m.atoms().len())
            .find(|&i| m.residue_of(i).chain == chain && m.residue_of(i).number == number && m.atoms()[i].name == name)
            .unwrap_or_else(|| panic!("{chain} {number} {name}"))
    };
    let bonded = |a: usize, b: usize| m.bonds().contains(&[a.min(b) as u32, a.max(b) as u32]);
    for (chain, from) in [("A", 1), ("B", 13)] {
        for n in from..from + 11 {
            let (a, b) = (at(chain, n, "O3'"), at(chain, n + 1, "P"));
            let length = m.atoms()[a].position.distance(m.atoms()[b].position);
            assert!(bonded(a, b) && (length - 1.607).abs() < 0.01, "{chain} {n}: {length}");
        }
    }
    // Every ring and chain closes: a base of n rings has as many bonds as atoms and n - 1 more, the sugar one ring.
    let mut partners = vec![0; m.atoms().len()];
    m.bonds().iter().flatten().for_each(|&i| partners[i as usize] += 1);
    for (i, atom) in m.atoms().iter().enumerate() {
        let possible = match atom.element.symbol() {
            "C" => 1..=4,
            "N" => 1..=3,
            "O" => 1..=2,
            _ => 4..=4,
        };
        assert!(possible.contains(&partners[i]), "{}: {}", m.name_of(i), partners[i]);
    }
    for &[a, b] in m.bonds() {
        let (a, b) = (&m.atoms()[a as usize], &m.atoms()[b as usize]);
        let length = a.position.distance(b.position);
        assert!((1.2..1.63).contains(&length), "{} {}: {length}", a.name, b.name);
    }
    // The pairs hold together by hydrogen bonds: 2.8 to 3.0 angstrom from N1 of a purine to N3 of a pyrimidine.
    for n in 1..=12 {
        let [one, other] = [("A", n), ("B", 25 - n)].map(|(chain, n)| {
            let any = at(chain, n, "C1'");
            let purine = ["DA", "DG"].contains(&m.residue_of(any).name.as_str());
            m.atoms()[at(chain, n, if purine { "N1" } else { "N3" })].position
        });
        assert!((2.7..3.1).contains(&one.distance(other)), "{n}: {}", one.distance(other));
    }
    let near = |i: usize| (0..i).filter(|&k| m.atoms()[i].position.distance(m.atoms()[k].position) < 2.0).count();
    let close: usize = (0..m.atoms().len()).map(near).sum();
    assert_eq!(close, m.bonds().len(), "what is not bonded keeps its distance");
}

#[test]
fn seeds_make_sequences_and_sizes_have_limits() {
    let names = |seed| helix(seed, 40).unwrap().residues().iter().map(|r| r.name.clone()).collect::<Vec<_>>();
    assert_eq!(names(1), names(1));
    assert_ne!(names(1), names(2));
    for base in ["DA", "DC", "DG", "DT"] {
        assert!(names(1).iter().any(|n| n == base));
    }
    assert_eq!(
        dna(1, 1).unwrap_err().to_string(),
        "DNA of 1 base pairs is not possible; choose 2 to 5000, for example 12"
    );
    assert!(dna(1, 5001).is_err());
    let (scene, camera) = dna(1, 12).unwrap();
    let b = scene.bounds();
    assert!(b.max.z - b.min.z > 36.0 && b.max.x < 13.0 && camera.eye.y < b.min.y);
}
