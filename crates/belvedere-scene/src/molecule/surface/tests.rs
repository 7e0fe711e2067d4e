use super::*;
use crate::molecule::{Atom, MoleculeLayer, MoleculeStyle, Residue, Selection};
use glam::DMat3;

fn molecule() -> Molecule {
    let atom = |serial: i64, element: Element, p: [f64; 3]| Atom {
        serial,
        name: element.symbol().into(),
        element,
        residue: 0,
        position: DVec3::from_array(p),
    };
    let atoms = vec![
        atom(1, Element::C, [0.0; 3]),
        atom(2, Element::O, [1.22, 0.0, 0.0]),
        atom(3, Element::H, [-0.55, 0.94, 0.0]),
        atom(4, Element::H, [-0.55, -0.94, 0.0]),
        atom(5, Element::UNKNOWN, [5.0, 0.0, 0.0]),
    ];
    Molecule::bonded(atoms, vec![Residue::default()], &[]).unwrap()
}

fn layer(style: MoleculeStyle, placement: ModelTransform) -> MoleculeLayer {
    MoleculeLayer::new(molecule(), &style, placement).unwrap()
}

#[test]
fn every_triangle_lies_on_its_atom_or_half_a_bond_away() {
    let turn = DMat3::from_rotation_z(0.7);
    let placement = ModelTransform { scale: 3.0, turn, to: DVec3::new(100.0, -50.0, 7.0) };
    for representation in [Representation::BallAndStick, Representation::SpaceFilling] {
        let made = layer(MoleculeStyle { representation, ..MoleculeStyle::default() }, placement);
        let filling = representation == Representation::SpaceFilling;
        assert_eq!((made.atoms, made.bonds), (4, if filling { 0 } else { 3 }), "the unknown one is not drawn");
        let mesh = &made.surface.mesh;
        let mut seen = [0; 5];
        for t in 0..mesh.triangles().len() {
            let atom = mesh.part(t).unwrap() as usize;
            seen[atom] += 1;
            let element = made.molecule.atoms()[atom].element;
            let share = if filling { 1.0 } else { BALL };
            assert!((made.radius(atom) - 3.0 * share * element.van_der_waals_radius()).abs() < 1e-12);
            // Rods go half way to the next atom.
            let reach = if filling { 1.02 * made.radius(atom) } else { 3.0 * 0.8 };
            for corner in mesh.corners(t) {
                assert!(corner.distance(made.center(atom)) < reach, "{t}");
            }
            assert_eq!(mesh.color_at(t, [0.2, 0.3, 0.5]), Some(element.color()));
            assert!(mesh.normal_at(t, [0.4, 0.3, 0.3]).dot(mesh.face_normal(t)) > 0.8);
            assert!((0.0..=1.0).contains(&mesh.openness_at(t, [0.4, 0.3, 0.3])));
        }
        assert!(seen[..4].iter().all(|n| *n > 0) && seen[4] == 0, "{seen:?}");
        assert_eq!(made.name_of(0).as_deref(), Some("atom C of  0"));
    }
}

#[test]
fn nothing_that_is_seen_is_left_out_of_balls_that_fill_space() {
    let style = MoleculeStyle { representation: Representation::SpaceFilling, ..MoleculeStyle::default() };
    let made = layer(style, ModelTransform::default());
    let mesh = &made.surface.mesh;
    let whole = 4 * 20 * FINEST * FINEST;
    assert!(mesh.triangles().len() < whole * 3 / 4, "{} of {whole}", mesh.triangles().len());
    // Points of each sphere outside all others have a triangle at them.
    let ball = Ball::new(3);
    let atoms = &made.molecule.atoms()[..4];
    for (i, a) in atoms.iter().enumerate() {
        for n in &ball.normals {
            let p = a.position + a.element.van_der_waals_radius() * *n;
            let free = atoms
                .iter()
                .enumerate()
                .all(|(k, b)| k == i || p.distance(b.position) > 1.001 * b.element.van_der_waals_radius());
            let near = |t: usize| mesh.part(t) == Some(i as u32) && mesh.corners(t).iter().any(|c| c.distance(p) < 0.3);
            assert!(!free || (0..mesh.triangles().len()).any(near), "{i} {n}");
        }
    }
}

#[test]
fn selections_choose_and_colour() {
    let selection = Selection::parse("not hydrogen").unwrap();
    let paint =
        vec![crate::molecule::Paint { selection: Selection::parse("atom 2").unwrap(), color: Color::rgb(9, 8, 7) }];
    let made = layer(MoleculeStyle { selection, paint, ..MoleculeStyle::default() }, ModelTransform::default());
    assert_eq!((made.atoms, made.bonds), (2, 1));
    let mesh = &made.surface.mesh;
    let of = |atom: u32| (0..mesh.triangles().len()).find(|&t| mesh.part(t) == Some(atom)).unwrap();
    assert_eq!(mesh.color_at(of(1), [1.0, 0.0, 0.0]), Some(Color::rgb(9, 8, 7)));
    assert_eq!(mesh.color_at(of(0), [1.0, 0.0, 0.0]), Some(Element::C.color()));
}

#[test]
fn detail_falls_with_the_number_of_atoms() {
    assert_eq!([1, 559, 3341, 47_681, 1_000_000].map(|n| detail(n, false)), [8, 8, 6, 2, 1]);
    assert!(detail(16_755, true) > detail(16_755, false));
}
