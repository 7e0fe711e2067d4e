//! Atoms and bonds as triangles, by representation.

use super::density::Ball as Gaussian;
use super::openness::{Around, Shades};
use super::ribbon::{self, Fineness};
use super::shape::Shape;
use super::sky::Sky;
use super::sphere::{Ball, rod};
use super::trace::{ByResidue, traces};
use super::{Element, ModelTransform, Molecule, Representation, Shown, iso};
use crate::{Color, Mesh, MeshError};
use belvedere_core::DVec3;
use rayon::prelude::*;

/// Radius of a ball beside rods, as a share of the van der Waals radius, of a rod beside balls, and of rods alone, angstrom.
const BALL: f64 = 0.27;
const ROD: f64 = 0.16;
const STICK: f64 = 0.24;
/// Radius of each rod of a double and of a triple bond, and how far it lies beside the middle, as shares of the radius of a single one.
const DOUBLE: [f64; 2] = [0.55, 0.85];
const TRIPLE: [f64; 2] = [0.42, 1.1];
/// Radius of the ball that stands for a residue of a ribbon, angstrom: half its thickness, about.
const RIBBON: f64 = 0.3;

/// Radius of the ball that an atom is drawn as, angstrom.
pub(super) fn ball_radius(element: Element, representation: Representation) -> f64 {
    match representation {
        Representation::SpaceFilling | Representation::Surface => element.van_der_waals_radius(),
        Representation::Sticks => STICK,
        Representation::BallAndStick | Representation::Ribbon | Representation::Auto => {
            BALL * element.van_der_waals_radius()
        }
    }
}

/// Radius that an atom is drawn with, angstrom.
pub(super) fn radius(element: Element, shown: Shown, representation: Representation) -> f64 {
    match (shown, representation) {
        (Shown::Ribbon(_), _) => RIBBON,
        (Shown::Surface, _) => element.van_der_waals_radius(),
        (_, Representation::Surface) => ball_radius(element, Representation::BallAndStick),
        _ => ball_radius(element, representation),
    }
}

/// Share of the van der Waals radius by which an atom between rods takes light from its neighbours.
const SHADE: f64 = 0.5;

/// Most triangles of all balls together, unless that would need fewer than [`COARSEST`] cuts.
const TRIANGLES: usize = 3_000_000;
const COARSEST: usize = 2;
const FINEST: usize = 8;
/// Atoms from which on balls are plain icosahedra.
const VERY_MANY: usize = 150_000;
/// Atoms from which on light is dimmed by matter farther away than neighbours, too.
const LARGE: usize = 5_000;

/// The part of the style that decides the shape.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    pub(super) representation: Representation,
    pub(super) detail: Option<u32>,
    /// Bonds of a higher order as two and three rods.
    pub(super) orders: bool,
}

/// A surface, what each atom is drawn as, and the numbers of drawn atoms and bonds.
pub(super) struct Made {
    pub(super) mesh: Mesh,
    pub(super) shown: Vec<Shown>,
    pub(super) atoms: usize,
    pub(super) bonds: usize,
}

/// The triangles of the drawn atoms in their colours; the part of a triangle is the index of its atom.
///
/// * `sticks`: atoms that are balls and rods whatever the representation is; empty = none.
pub(super) fn build(
    molecule: &Molecule,
    (drawn, sticks): (&[bool], &[bool]),
    colors: &[Color],
    look: Look,
    placement: &ModelTransform,
) -> Result<Made, MeshError> {
    let all = molecule.atoms();
    let has_size = |i: usize| all[i].element.van_der_waals_radius() > 0.0;
    let mut shown: Vec<Shown> =
        (0..all.len()).map(|i| if drawn[i] && has_size(i) { Shown::Ball } else { Shown::Not }).collect();
    let beside = |i: usize| sticks.get(i) == Some(&true);
    let mut pieces = Vec::new();
    let mut balls_look = look;
    match look.representation {
        Representation::Ribbon => {
            let by_residue = ByResidue::of(molecule);
            let mask: Vec<bool> = shown.iter().map(|s| *s == Shown::Ball).collect();
            let traces = traces(molecule, &mask, &by_residue);
            for link in traces.iter().flat_map(|t| &t.links) {
                for &i in by_residue.atoms(link.residue as usize) {
                    let of_base = link.base.as_ref().filter(|_| !is_backbone(&all[i as usize].name));
                    let atom = of_base.map_or(link.atom, |base| base.atom);
                    // The atoms that a ribbon stands for may not all be there.
                    if shown[i as usize] == Shown::Ball && !beside(i as usize) {
                        shown[i as usize] = Shown::Ribbon(atom);
                    }
                }
            }
            let count = traces.iter().map(|t| t.links.len()).sum();
            pieces = ribbon::build(&traces, colors, Fineness::of(count, look.detail));
            balls_look.representation = Representation::BallAndStick;
        }
        Representation::Surface => {
            let under: Vec<u32> =
                (0..all.len()).filter(|&i| shown[i] == Shown::Ball && !beside(i)).map(|i| i as u32).collect();
            if !under.is_empty() {
                let ball = |&i: &u32| (all[i as usize].position, all[i as usize].element.van_der_waals_radius());
                let balls: Vec<Gaussian> = under.iter().map(ball).collect();
                let own: Vec<Color> = under.iter().map(|&i| colors[i as usize]).collect();
                pieces = iso::build(&balls, &under, &own, look.detail);
                under.iter().for_each(|&i| shown[i as usize] = Shown::Surface);
            }
            balls_look.representation = Representation::BallAndStick;
        }
        Representation::BallAndStick | Representation::SpaceFilling | Representation::Sticks | Representation::Auto => {
        }
    }
    let atoms: Vec<u32> = (0..all.len() as u32).filter(|&i| shown[i as usize] == Shown::Ball).collect();
    let bonds = balls(&mut pieces, molecule, (&atoms, colors), balls_look);
    let count = shown.iter().filter(|s| **s != Shown::Not).count();
    let mesh = Shape::joined(pieces)?.mesh(placement)?;
    Ok(Made { mesh, shown, atoms: count, bonds })
}

/// Whether an atom of a nucleotide belongs to its phosphate or sugar.
fn is_backbone(name: &str) -> bool {
    name.ends_with(['\'', '*']) || name.contains('P') || name.ends_with("''")
}

/// Adds balls for atoms, and rods unless atoms fill space; gives the number of bonds.
fn balls(pieces: &mut Vec<Shape>, molecule: &Molecule, (atoms, colors): (&[u32], &[Color]), look: Look) -> usize {
    let filling = look.representation == Representation::SpaceFilling;
    let all = molecule.atoms();
    let radius = |i: u32| all[i as usize].element.van_der_waals_radius();
    // Number of an atom among the drawn ones.
    let mut number = vec![u32::MAX; all.len()];
    atoms.iter().enumerate().for_each(|(n, &i)| number[i as usize] = n as u32);
    let is_drawn = |b: &usize| molecule.bonds()[*b].iter().all(|&i| number[i as usize] != u32::MAX);
    let bonds: Vec<usize> = if filling { Vec::new() } else { (0..molecule.bonds().len()).filter(is_drawn).collect() };
    let partners = Partners::of(molecule, &bonds, &number, atoms.len());
    let detail = look.detail.map_or_else(|| detail(atoms.len(), filling), |d| d.clamp(1, 16) as usize);
    let shade = if filling { 1.0 } else { SHADE };
    let centers: Vec<DVec3> = atoms.iter().map(|&i| all[i as usize].position).collect();
    let sky = (atoms.len() >= LARGE).then(|| {
        let balls: Vec<Gaussian> = centers.iter().zip(atoms).map(|(p, &i)| (*p, radius(i))).collect();
        Sky::far(&balls)
    });
    let shades = Shades::new(centers, atoms.iter().map(|&i| shade * radius(i)).collect());
    let rod = if look.representation == Representation::Sticks { STICK } else { ROD };
    let maker = Maker { ball: Ball::new(detail), sides: (2 * detail + 4).min(20), filling, rod, sky: sky.as_ref() };
    let piece = |n: usize| {
        let i = atoms[n];
        let around = shades.around(n);
        let center = all[i as usize].position;
        let paint = Paint { color: colors[i as usize], atom: i, around: &around };
        let mut piece = Shape::default();
        maker.ball(&mut piece, center, ball_radius(all[i as usize].element, look.representation), &paint);
        for &(other, bond) in partners.of_atom(n) {
            let order = if look.orders { molecule.orders()[bond as usize] } else { 1 };
            let beside = if order > 1 { partners.plane(molecule, &number, bond as usize) } else { DVec3::ZERO };
            maker.half_bond(&mut piece, [center, all[other as usize].position], (order, beside), &paint);
        }
        piece
    };
    pieces.par_extend((0..atoms.len()).into_par_iter().map(piece));
    bonds.len()
}

/// Cuts along the edge of an icosahedron for a number of balls.
fn detail(atoms: usize, filling: bool) -> usize {
    // Two thirds of the triangles of balls that fill space lie inside others and are left out.
    let most = if filling { 2 * TRIANGLES } else { TRIANGLES };
    let cuts = (most as f64 / (20 * atoms.max(1)) as f64).sqrt() as usize;
    if atoms > VERY_MANY { 1 } else { cuts.clamp(COARSEST, FINEST) }
}

/// The atoms that each drawn atom is bonded to, and by which bond.
struct Partners {
    first: Vec<u32>,
    list: Vec<(u32, u32)>,
}

impl Partners {
    fn of(molecule: &Molecule, bonds: &[usize], number: &[u32], atoms: usize) -> Self {
        let both = |&k: &usize| {
            let [a, b] = molecule.bonds()[k];
            [(number[a as usize], b, k as u32), (number[b as usize], a, k as u32)]
        };
        let mut pairs: Vec<(u32, u32, u32)> = bonds.iter().flat_map(both).collect();
        pairs.sort_unstable();
        let first = (0..=atoms as u32).map(|n| pairs.partition_point(|p| p.0 < n) as u32).collect();
        Self { first, list: pairs.into_iter().map(|p| (p.1, p.2)).collect() }
    }

    fn of_atom(&self, n: usize) -> &[(u32, u32)] {
        &self.list[self.first[n] as usize..self.first[n + 1] as usize]
    }

    /// Unit vector across a bond, in the plane of the other bonds at its ends if there are any.
    fn plane(&self, molecule: &Molecule, number: &[u32], bond: usize) -> DVec3 {
        let [a, b] = molecule.bonds()[bond];
        let place = |i: u32| molecule.atoms()[i as usize].position;
        let along = (place(b) - place(a)).normalize_or(DVec3::Z);
        for (end, other) in [(a, b), (b, a)] {
            for &(next, _) in self.of_atom(number[end as usize] as usize) {
                let way = place(next) - place(end);
                let across = way - way.dot(along) * along;
                if next != other && across.length() > 0.1 {
                    return across.normalize();
                }
            }
        }
        along.any_orthonormal_vector()
    }
}

/// Colour, number and surroundings of an atom.
struct Paint<'a> {
    color: Color,
    atom: u32,
    around: &'a Around,
}

struct Maker<'a> {
    ball: Ball,
    sides: usize,
    filling: bool,
    /// Radius of a rod, angstrom.
    rod: f64,
    sky: Option<&'a Sky>,
}

impl Maker<'_> {
    fn vertex(&self, piece: &mut Shape, p: DVec3, normal: DVec3, paint: &Paint<'_>) -> u32 {
        let afar = self.sky.map_or(1.0, |sky| sky.open(p, normal));
        piece.vertex(p, normal, afar * paint.around.open(p, normal), paint.color)
    }

    fn ball(&self, piece: &mut Shape, center: DVec3, radius: f64, paint: &Paint<'_>) {
        let outer = radius * self.ball.outer();
        // Triangles inside a neighbour are hidden; its faces lie a little deeper than its radius.
        let share = self.ball.outer() * self.ball.inner;
        let mut number = vec![u32::MAX; self.ball.normals.len()];
        for t in &self.ball.triangles {
            if self.filling && paint.around.hides(&t.map(|v| center + outer * self.ball.normals[v as usize]), share) {
                continue;
            }
            let corners = t.map(|v| {
                if number[v as usize] == u32::MAX {
                    let normal = self.ball.normals[v as usize];
                    number[v as usize] = self.vertex(piece, center + outer * normal, normal, paint);
                }
                number[v as usize]
            });
            piece.triangle(corners, paint.atom);
        }
    }

    /// Adds the rods of a bond from the centre of the atom to its middle.
    fn half_bond(
        &self,
        piece: &mut Shape,
        [center, other]: [DVec3; 2],
        (order, beside): (u8, DVec3),
        paint: &Paint<'_>,
    ) {
        let half = 0.5 * (other - center);
        let (radius, offsets) = match order {
            2 => (DOUBLE[0], &[-DOUBLE[1], DOUBLE[1]][..]),
            3 => (TRIPLE[0], &[-TRIPLE[1], 0.0, TRIPLE[1]][..]),
            _ => (1.0, &[0.0][..]),
        };
        for offset in offsets {
            let start = center + offset * self.rod * beside;
            let (normals, triangles) = rod(self.sides, half);
            let first = piece.positions.len() as u32;
            for normal in normals {
                for end in [0.0, 1.0] {
                    self.vertex(piece, start + end * half + radius * self.rod * normal, normal, paint);
                }
            }
            triangles.into_iter().for_each(|t| piece.triangle(t.map(|v| v + first), paint.atom));
        }
    }
}

#[cfg(test)]
mod tests;
