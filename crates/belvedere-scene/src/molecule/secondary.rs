//! Secondary structure of proteins: as the file states it, or found from the places of the alpha carbons.

use belvedere_core::DVec3;

/// Structure of the backbone at a residue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Secondary {
    /// Neither of the others.
    #[default]
    Coil,
    /// Part of a helix.
    Helix,
    /// Part of a strand of a sheet.
    Strand,
}

/// A value and how far from it a distance (angstrom) or an angle (degrees) may lie.
type Range = [f64; 2];

/// Distances from a residue to the third and the fourth after it, the angle at the next one, and the dihedral angle of four, for the
/// two structures. Source: Labesse, Colloc'h, Pothier and Mornon 1997 (P-SEA), table 1.
struct Signs {
    third: Range,
    fourth: Range,
    angle: Range,
    dihedral: Range,
}

const HELIX: Signs = Signs { third: [5.3, 0.5], fourth: [6.4, 0.6], angle: [89.0, 12.0], dihedral: [50.0, 20.0] };
const STRAND: Signs = Signs { third: [9.9, 0.9], fourth: [12.4, 1.1], angle: [124.0, 14.0], dihedral: [-170.0, 45.0] };

/// Fewest residues of a helix, and of a strand with and without another beside it. The last two are ours.
const SHORTEST_HELIX: usize = 5;
const SHORTEST_STRAND: usize = 3;
const LONE_STRAND: usize = 6;
/// Farthest apart that alpha carbons of neighbouring strands are, angstrom: 4.4 to 5.5 in sheets.
const BESIDE: f64 = 5.8;

/// Structure at each alpha carbon of a piece of chain without gaps.
///
/// Four residues show the signs if both distances fit and the dihedral angle about (so that mirror images are none), or both angles;
/// runs of them long enough are a helix or a strand. Strands have
/// another strand beside them, unless they are long.
pub(super) fn by_places(carbons: &[DVec3]) -> Vec<Secondary> {
    let n = carbons.len();
    let mut out = vec![Secondary::Coil; n];
    let helix = marked(carbons, &HELIX);
    for [from, to] in runs(&helix) {
        if to - from >= SHORTEST_HELIX {
            out[from..to].fill(Secondary::Helix);
        }
    }
    let mut strand = marked(carbons, &STRAND);
    strand.iter_mut().zip(&out).for_each(|(s, taken)| *s &= *taken == Secondary::Coil);
    let all = runs(&strand);
    for &[from, to] in &all {
        let beside = |i: usize| {
            let others = all.iter().filter(|other| other[0] != from).flat_map(|o| o[0]..o[1]);
            others.into_iter().any(|k| k.abs_diff(i) > 2 && carbons[k].distance(carbons[i]) < BESIDE)
        };
        let pairs = (from..to).filter(|&i| beside(i)).count();
        if to - from >= LONE_STRAND || (to - from >= SHORTEST_STRAND && pairs >= 2) {
            out[from..to].fill(Secondary::Strand);
        }
    }
    out
}

/// Residues within four that show the signs.
fn marked(p: &[DVec3], signs: &Signs) -> Vec<bool> {
    let mut out = vec![false; p.len()];
    let fits = |value: f64, [mean, off]: Range| (value - mean).abs() <= off;
    let turned = |value: f64, [mean, off]: Range| {
        let apart = (value - mean).rem_euclid(360.0);
        apart.min(360.0 - apart) <= off
    };
    for i in 0..p.len().saturating_sub(3) {
        let third = fits(p[i].distance(p[i + 3]), signs.third);
        let fourth = p.get(i + 4).is_none_or(|q| fits(p[i].distance(*q), signs.fourth));
        let bent = fits(angle(p[i], p[i + 1], p[i + 2]), signs.angle);
        let twist = dihedral([p[i], p[i + 1], p[i + 2], p[i + 3]]);
        let [mean, off] = signs.dihedral;
        let (twisted, about) = (turned(twist, [mean, off]), turned(twist, [mean, 2.0 * off]));
        if (third && fourth && about) || (bent && twisted) {
            out[i..i + 4].fill(true);
        }
    }
    out
}

/// Runs of `true`: from, and one past the last.
fn runs(marks: &[bool]) -> Vec<[usize; 2]> {
    let mut out: Vec<[usize; 2]> = Vec::new();
    for (i, _) in marks.iter().enumerate().filter(|(_, mark)| **mark) {
        match out.last_mut() {
            Some(last) if last[1] == i => last[1] = i + 1,
            _ => out.push([i, i + 1]),
        }
    }
    out
}

/// Angle at `b`, degrees.
fn angle(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    (a - b).angle_between(c - b).to_degrees()
}

/// Dihedral angle, degrees, by the convention of IUPAC: positive is clockwise, looking along the middle bond.
fn dihedral([a, b, c, d]: [DVec3; 4]) -> f64 {
    let (first, middle, last) = (b - a, c - b, d - c);
    let (m, n) = (first.cross(middle), middle.cross(last));
    (middle.length() * first.dot(n)).atan2(m.dot(n)).to_degrees()
}

#[cfg(test)]
mod tests;
