use super::super::shape::closed::euler;
use super::*;

/// A helix of ten residues, a loop, a strand of seven, pleated, and an end.
fn trace() -> Trace {
    let mut places = Vec::new();
    for i in 0..10 {
        let (sin, cos) = (100.0 * f64::from(i)).to_radians().sin_cos();
        places.push((DVec3::new(2.3 * cos, 2.3 * sin, 1.5 * f64::from(i)), Secondary::Helix, DVec3::Z));
    }
    for i in 0..3 {
        places.push((DVec3::new(5.0 + 3.0 * f64::from(i), 1.0, 15.0), Secondary::Coil, DVec3::Y));
    }
    for i in 0..7 {
        let z = 15.0 + if i % 2 == 0 { 0.9 } else { -0.9 };
        let flip = if i % 2 == 0 { 1.0 } else { -1.0 };
        places.push((DVec3::new(14.5 + 3.3 * f64::from(i), 1.0, z), Secondary::Strand, flip * DVec3::Y));
    }
    places.push((DVec3::new(38.0, 2.0, 15.0), Secondary::Coil, DVec3::Y));
    let link = |(i, (at, structure, side)): (usize, (DVec3, Secondary, DVec3))| {
        let i = i as u32;
        Link { residue: i, atom: 10 * i, at, side: Some(side), structure, base: None }
    };
    Trace { kind: Kind::Protein, links: places.into_iter().enumerate().map(link).collect() }
}

fn colors() -> Vec<Color> {
    vec![Color::rgb(1, 2, 3); 500]
}

#[test]
fn a_ribbon_passes_its_residues_and_flattens_strands() {
    let trace = trace();
    let line = Line::of(&trace);
    for (i, link) in trace.links.iter().enumerate() {
        let off = line.at(i as f64).0.distance(link.at);
        let most = if link.structure == Secondary::Strand { 1.0 } else { 1e-9 };
        assert!(off <= most, "{i}: {off}");
    }
    // The width of a strand does not turn over although its oxygens point to either side.
    for i in 14..19 {
        assert!(line.sides[i].dot(line.sides[i - 1]) > 0.9, "{i}");
    }
    // The line has no corners.
    for k in 1..(trace.links.len() - 1) * 20 {
        let u = k as f64 / 20.0;
        assert!(line.at(u - 1e-6).1.dot(line.at(u + 1e-6).1) > 0.999, "{u}");
    }
}

#[test]
fn a_ribbon_is_closed_looks_outwards_and_belongs_to_its_residues() {
    let trace = trace();
    for (along, around) in [(4, 8), (8, 16)] {
        let shapes = build(std::slice::from_ref(&trace), &colors(), Fineness { along, around });
        let shape = &shapes[0];
        assert_eq!(euler(shape), 2, "{along}");
        let mut volume = 0.0;
        let mut seen = vec![false; trace.links.len()];
        for (t, atom) in shape.triangles.iter().zip(&shape.parts) {
            let [a, b, c] = t.map(|v| shape.positions[v as usize]);
            volume += a.dot(b.cross(c)) / 6.0;
            let residue = *atom as usize / 10;
            seen[residue] = true;
            let middle = (a + b + c) / 3.0;
            assert!(middle.distance(trace.links[residue].at) < 4.0, "{residue}");
        }
        assert!(volume > 20.0, "{volume}");
        assert!(seen.iter().all(|s| *s));
        for n in &shape.normals {
            assert!((n.length() - 1.0).abs() < 1e-9);
        }
        // Along the middle of a strand the band is wide, at its arrow wider, at the tip narrow.
        let width = |u: f64| {
            let (p, t) = Line::of(&trace).at(u);
            let near = shape.positions.iter().filter(|v| (**v - p).dot(t).abs() < 0.05);
            near.map(|v| (*v - p).dot(DVec3::Y).abs()).filter(|w| *w < 3.0).fold(0.0, f64::max)
        };
        assert!((width(16.0) - 1.1).abs() < 0.2, "{}", width(16.0));
        assert!((width(18.0) - 1.9).abs() < 0.3, "{}", width(18.0));
    }
}

#[test]
fn arrows_stand_at_the_ends_of_strands() {
    let links = trace().links;
    assert_eq!(arrows(&links), [[18.0, 19.5]]);
    assert_eq!(arrows(&links[..16]), [[14.0, 15.0]], "at the end of the chain");
    assert_eq!(arrows(&links[..14]), [[0.0; 2]; 0], "one residue is no strand");
}

#[test]
fn bases_are_slabs_in_their_planes() {
    let ring: Vec<DVec3> = (0..6)
        .map(|k| {
            let (sin, cos) = (60.0 * f64::from(k)).to_radians().sin_cos();
            DVec3::new(6.0 + 1.4 * cos, 1.4 * sin, 0.0)
        })
        .collect();
    let link = |i: u32| {
        let up = DVec3::new(0.0, 0.0, 6.0 * f64::from(i));
        let base = Base { atom: 100 + i, rings: ring.iter().map(|p| *p + up).collect(), normal: DVec3::Z };
        let side = Some(DVec3::new(3.5, 0.0, 0.0));
        Link { residue: i, atom: i, at: up, side, structure: Secondary::Coil, base: Some(base) }
    };
    let trace = Trace { kind: Kind::Nucleic, links: (0..4).map(link).collect() };
    let shapes = build(&[trace], &colors(), Fineness::of(4, None));
    let of_base = |atom: u32| {
        let own = shapes[0].triangles.iter().zip(&shapes[0].parts).filter(move |(_, part)| **part == atom);
        own.flat_map(|(t, _)| t.map(|v| shapes[0].positions[v as usize]))
    };
    for i in 0..4 {
        let z = 6.0 * f64::from(i);
        assert!(of_base(100 + i).count() >= 36);
        assert!(of_base(100 + i).all(|p| (p.z - z).abs() < 1.0 && p.x < 7.8));
    }
}
