//! Atoms and bonds as triangles.

use super::openness::{Around, Shades};
use super::sphere::{Ball, rod};
use super::{Element, ModelTransform, Molecule, Representation};
use crate::{Color, Mesh, MeshColors, MeshError};
use belvedere_core::DVec3;
use rayon::prelude::*;

/// Radius of a ball beside rods, as a share of the van der Waals radius, and of a rod, angstrom.
const BALL: f64 = 0.27;
const ROD: f64 = 0.16;

/// Radius of the ball that an atom is drawn as, angstrom.
pub(super) fn ball_radius(element: Element, representation: Representation) -> f64 {
    let share = if representation == Representation::SpaceFilling { 1.0 } else { BALL };
    share * element.van_der_waals_radius()
}

/// Share of the van der Waals radius by which an atom between rods takes light from its neighbours.
const SHADE: f64 = 0.5;

/// Most triangles of all balls together, unless that would need fewer than [`COARSEST`] cuts.
const TRIANGLES: usize = 3_000_000;
const COARSEST: usize = 2;
const FINEST: usize = 8;
/// Atoms from which on balls are plain icosahedra.
const VERY_MANY: usize = 150_000;

/// The part of the style that decides the shape.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    pub(super) representation: Representation,
    pub(super) detail: Option<u32>,
}

/// A surface and the numbers of its atoms and bonds.
pub(super) struct Made {
    pub(super) mesh: Mesh,
    pub(super) atoms: usize,
    pub(super) bonds: usize,
}

/// Triangles of one atom, its halves of bonds included, angstrom.
#[derive(Default)]
struct Piece {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    open: Vec<u8>,
    triangles: Vec<[u32; 3]>,
}

/// Balls of the drawn atoms, and rods unless atoms fill space, in their colours; the part of a triangle is the index of its atom.
pub(super) fn build(
    molecule: &Molecule,
    drawn: &[bool],
    colors: &[Color],
    look: Look,
    placement: &ModelTransform,
) -> Result<Made, MeshError> {
    let filling = look.representation == Representation::SpaceFilling;
    let radius = |i: usize| molecule.atoms()[i].element.van_der_waals_radius();
    let atoms: Vec<u32> = (0..drawn.len() as u32).filter(|&i| drawn[i as usize] && radius(i as usize) > 0.0).collect();
    // Number of an atom among the drawn ones.
    let mut number = vec![u32::MAX; drawn.len()];
    atoms.iter().enumerate().for_each(|(n, &i)| number[i as usize] = n as u32);
    let is_drawn = |b: &&[u32; 2]| b.iter().all(|&i| number[i as usize] != u32::MAX);
    let bonds: Vec<[u32; 2]> =
        if filling { Vec::new() } else { molecule.bonds().iter().filter(is_drawn).copied().collect() };
    let partners = partners(&bonds, &number, atoms.len());
    let detail = look.detail.map_or_else(|| detail(atoms.len(), filling), |d| d.clamp(1, 16) as usize);
    let shade = if filling { 1.0 } else { SHADE };
    let centers: Vec<DVec3> = atoms.iter().map(|&i| molecule.atoms()[i as usize].position).collect();
    let shades = Shades::new(centers, atoms.iter().map(|&i| shade * radius(i as usize)).collect());
    let maker = Maker { ball: Ball::new(detail), sides: (2 * detail + 4).min(20), filling };
    let pieces: Vec<Piece> = (0..atoms.len())
        .into_par_iter()
        .map(|n| {
            let i = atoms[n] as usize;
            let around = shades.around(n);
            let center = molecule.atoms()[i].position;
            let mut piece = maker.ball(center, ball_radius(molecule.atoms()[i].element, look.representation), &around);
            for &other in partners.of(n) {
                maker.half_rod(&mut piece, center, molecule.atoms()[other as usize].position, &around);
            }
            piece
        })
        .collect();
    let mesh = join(&pieces, &atoms, colors, placement)?;
    Ok(Made { mesh, atoms: atoms.len(), bonds: bonds.len() })
}

/// Cuts along the edge of an icosahedron for a number of balls.
fn detail(atoms: usize, filling: bool) -> usize {
    // Two thirds of the triangles of balls that fill space lie inside others and are left out.
    let most = if filling { 2 * TRIANGLES } else { TRIANGLES };
    let cuts = (most as f64 / (20 * atoms.max(1)) as f64).sqrt() as usize;
    if atoms > VERY_MANY { 1 } else { cuts.clamp(COARSEST, FINEST) }
}

/// The atoms that each drawn atom is bonded to.
struct Partners {
    first: Vec<u32>,
    list: Vec<u32>,
}

impl Partners {
    fn of(&self, n: usize) -> &[u32] {
        &self.list[self.first[n] as usize..self.first[n + 1] as usize]
    }
}

fn partners(bonds: &[[u32; 2]], number: &[u32], atoms: usize) -> Partners {
    let mut pairs: Vec<(u32, u32)> =
        bonds.iter().flat_map(|&[a, b]| [(number[a as usize], b), (number[b as usize], a)]).collect();
    pairs.sort_unstable();
    let first = (0..=atoms as u32).map(|n| pairs.partition_point(|p| p.0 < n) as u32).collect();
    Partners { first, list: pairs.into_iter().map(|p| p.1).collect() }
}

struct Maker {
    ball: Ball,
    sides: usize,
    filling: bool,
}

impl Maker {
    fn ball(&self, center: DVec3, radius: f64, around: &Around) -> Piece {
        let mut piece = Piece::default();
        let outer = radius * self.ball.outer();
        // Triangles inside a neighbour are hidden; its faces lie a little deeper than its radius.
        let share = self.ball.outer() * self.ball.inner;
        let mut number = vec![u32::MAX; self.ball.normals.len()];
        for t in &self.ball.triangles {
            if self.filling && around.hides(&t.map(|v| center + outer * self.ball.normals[v as usize]), share) {
                continue;
            }
            let corners = t.map(|v| {
                if number[v as usize] == u32::MAX {
                    let normal = self.ball.normals[v as usize];
                    number[v as usize] = piece.positions.len() as u32;
                    piece.push(center + outer * normal, normal, around);
                }
                number[v as usize]
            });
            piece.triangles.push(corners);
        }
        piece
    }

    /// Adds the rod from the centre of the atom to the middle of a bond.
    fn half_rod(&self, piece: &mut Piece, center: DVec3, other: DVec3, around: &Around) {
        let half = 0.5 * (other - center);
        let (normals, triangles) = rod(self.sides, half);
        let first = piece.positions.len() as u32;
        for normal in normals {
            for end in [0.0, 1.0] {
                piece.push(center + end * half + ROD * normal, normal, around);
            }
        }
        piece.triangles.extend(triangles.into_iter().map(|t| t.map(|v| v + first)));
    }
}

impl Piece {
    fn push(&mut self, position: DVec3, normal: DVec3, around: &Around) {
        self.positions.push(position);
        self.normals.push(normal);
        self.open.push((255.0 * around.open(position, normal)).round().clamp(1.0, 255.0) as u8);
    }
}

fn join(pieces: &[Piece], atoms: &[u32], colors: &[Color], placement: &ModelTransform) -> Result<Mesh, MeshError> {
    let vertices = pieces.iter().map(|p| p.positions.len()).sum();
    let count = pieces.iter().map(|p| p.triangles.len()).sum();
    for (what, count) in [("vertices", vertices), ("triangles", count)] {
        if count > Mesh::MAX {
            return Err(MeshError::TooMany { what, count });
        }
    }
    let (mut positions, mut normals) = (Vec::with_capacity(vertices), Vec::with_capacity(vertices));
    let (mut shades, mut open) = (Vec::with_capacity(vertices), Vec::with_capacity(vertices));
    let (mut triangles, mut parts) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for (piece, &atom) in pieces.iter().zip(atoms) {
        let first = positions.len() as u32;
        positions.extend(piece.positions.iter().map(|p| placement.apply(*p)));
        normals.extend(piece.normals.iter().map(|n| placement.turn * *n));
        open.extend(&piece.open);
        shades.extend(std::iter::repeat_n(colors[atom as usize], piece.positions.len()));
        triangles.extend(piece.triangles.iter().map(|t| t.map(|v| v + first)));
        parts.extend(std::iter::repeat_n(atom, piece.triangles.len()));
    }
    Mesh::in_parts(&positions, triangles, MeshColors::PerVertex(shades), parts)?
        .with_normals(&normals)?
        .with_openness(open)
}

#[cfg(test)]
mod tests {
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
                let near =
                    |t: usize| mesh.part(t) == Some(i as u32) && mesh.corners(t).iter().any(|c| c.distance(p) < 0.3);
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
}
