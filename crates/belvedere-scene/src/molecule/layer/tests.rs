use super::*;
use crate::molecule::{Atom, Residue};

/// Six residues of a chain with a side atom each, and a ligand.
fn chain() -> Molecule {
    chain_of(6)
}

fn chain_of(residues_of_chain: i32) -> Molecule {
    let mut atoms = Vec::new();
    let mut residues = Vec::new();
    let mut add = |name: &str, number: i32, hetero: bool, list: &[(&str, Element, DVec3)]| {
        let residue = residues.len() as u32;
        residues.push(Residue { name: name.into(), number, insertion: None, chain: "A".into(), hetero });
        for (name, element, position) in list {
            let serial = atoms.len() as i64 + 1;
            atoms.push(Atom { serial, name: (*name).into(), element: *element, residue, position: *position });
        }
    };
    for i in 0..residues_of_chain {
        let at = DVec3::new(3.8 * f64::from(i), 0.0, 0.0);
        add("ALA", i + 1, false, &[("CA", Element::C, at), ("CB", Element::C, at + 1.53 * DVec3::Z)]);
    }
    add(
        "LIG",
        100,
        true,
        &[("O1", Element::O, DVec3::new(5.0, 9.0, 0.0)), ("C1", Element::C, DVec3::new(5.0, 10.4, 0.0))],
    );
    Molecule::bonded(atoms, residues, &[]).unwrap()
}

fn layer(representation: Representation, sticks: Option<&str>) -> MoleculeLayer {
    let sticks = sticks.map(|text| Selection::parse(text).unwrap());
    let style = MoleculeStyle { representation, sticks, ..MoleculeStyle::default() };
    MoleculeLayer::new(chain(), &style, ModelTransform::default()).unwrap()
}

#[test]
fn chains_become_ribbons_from_a_hundred_residues_on() {
    let auto = |residues| Representation::Auto.of(&chain_of(residues));
    assert_eq!((auto(99), auto(100)), (Representation::BallAndStick, Representation::Ribbon));
    assert_eq!(Representation::Sticks.of(&chain_of(100)), Representation::Sticks);
    // Everything else follows, colours too.
    let made = |representation| {
        let style = MoleculeStyle { representation, ..MoleculeStyle::default() };
        MoleculeLayer::new(chain_of(100), &style, ModelTransform::default()).unwrap()
    };
    let (auto, ribbon) = (made(Representation::Auto), made(Representation::Ribbon));
    assert_eq!((auto.representation, &auto.surface.mesh), (Representation::Ribbon, &ribbon.surface.mesh));
}

#[test]
fn ribbons_stand_for_residues_and_leave_ligands_as_balls() {
    let made = layer(Representation::Ribbon, None);
    assert_eq!((made.atoms, made.bonds), (14, 1));
    let parts: std::collections::BTreeSet<u32> =
        (0..made.surface.mesh.triangles().len()).filter_map(|t| made.surface.mesh.part(t)).collect();
    assert_eq!(parts.into_iter().collect::<Vec<_>>(), [0, 2, 4, 6, 8, 10, 12, 13]);
    assert_eq!((made.stand_in(5), made.stand_in(4), made.stand_in(12)), (Some(4), Some(4), Some(12)));
    let side = Selection::parse("resi 3 and name CB").unwrap();
    let mask = made.mask_of(&side);
    assert_eq!(mask.iter().enumerate().filter(|(_, m)| **m).map(|(i, _)| i).collect::<Vec<_>>(), [4]);
    assert!(made.radius(4) < made.radius(12));
    let of = |part: u32| {
        (0..made.surface.mesh.triangles().len()).find(|&t| made.surface.mesh.part(t) == Some(part)).unwrap()
    };
    assert_eq!(made.name_of(of(4)).as_deref(), Some("chain A ALA 3"));
    assert_eq!(made.name_of(of(12)).as_deref(), Some("atom O1 of chain A LIG 100"));
}

#[test]
fn chosen_atoms_are_balls_and_rods_beside_ribbons_and_through_surfaces() {
    let ribbon = layer(Representation::Ribbon, Some("resi 2"));
    assert_eq!((ribbon.shown[2], ribbon.shown[3], ribbon.bonds), (Shown::Ball, Shown::Ball, 2));
    let surface = layer(Representation::Surface, Some("hetero"));
    assert_eq!((surface.shown[0], surface.shown[12], surface.bonds), (Shown::Surface, Shown::Ball, 1));
    let carbon = Element::C.van_der_waals_radius();
    assert!((surface.radius(0) - carbon).abs() < 1e-12 && surface.radius(13) < 0.3 * carbon);
    let mesh = &surface.surface.mesh;
    for t in 0..mesh.triangles().len() {
        let atom = mesh.part(t).unwrap() as usize;
        let most = if atom < 12 { 1.6 * carbon } else { 0.8 };
        assert!(mesh.corners(t).iter().all(|p| p.distance(surface.center(atom)) < most), "{atom}");
    }
}

#[test]
fn double_bonds_have_two_rods() {
    let triangles = |orders: bool| {
        let double = chain().with_orders(&[([12, 13], 2)]);
        let style =
            MoleculeStyle { orders, selection: Selection::parse("hetero").unwrap(), ..MoleculeStyle::default() };
        MoleculeLayer::new(double, &style, ModelTransform::default()).unwrap().surface.mesh.triangles().len()
    };
    // Two halves of one more rod of 20 sides.
    assert_eq!(triangles(true), triangles(false) + 2 * 40);
}
