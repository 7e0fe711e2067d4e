//! The centreline between two points of a volume: a path through voxels of certain values, such as those of a vessel or a bore, that
//! keeps away from their border.
//!
//! 1. The voxels that are connected with the first point face to face, with values within the range.
//! 2. `distance`: the distance of each of them to the nearest other voxel, its clearance.
//! 3. `way`: the cheapest path (Dijkstra); a step costs its length over the clearance.
//! 4. The path is smoothed; points that smoothing would move out of the voxels stay.

mod way;

use crate::ConstructError;
use crate::distance::{Around, squared};
use belvedere_core::DVec3;
use belvedere_scene::Volume;
use serde::{Deserialize, Serialize};
use way::Cells;

/// Largest distance of a given point from a voxel of the range, shortest voxel edges.
const NEAR: f64 = 3.0;
/// Most voxels of the box that is searched: nine bytes each.
const MOST_VOXELS: usize = 1 << 27;
/// Standard deviation of the smoothing, and distance of the points of the answer, shortest voxel edges.
const SMOOTH: f64 = 2.0;
const SPACING: f64 = 0.5;

/// A centreline.
#[derive(Debug, Clone, PartialEq)]
pub struct Centreline {
    /// Points from the first given point to the second, scene coordinates.
    pub points: Vec<DVec3>,
    /// Figures.
    pub report: CentrelineReport,
}

/// Figures of a [`Centreline`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CentrelineReport {
    /// Its length, scene units.
    pub length: f64,
    /// Least distance from its points to the nearest voxel of other values, scene units.
    pub least_clearance: f64,
    /// Median of these distances, scene units.
    pub median_clearance: f64,
    /// Voxels that are connected with the first point.
    pub voxels: usize,
    /// Range of values.
    pub values: [f64; 2],
}

/// The centreline from one point to another.
///
/// * `from`, `to`: scene coordinates; the nearest voxel of the range within 3 voxel edges counts.
/// * `values`: least and greatest value of the voxels that the path may use.
///
/// Distances treat the axes of the volume as perpendicular, even if they are not. Deterministic.
///
/// # Errors
/// [`ConstructError::PointOutside`] where no voxel near a point is in the range, [`ConstructError::NotConnected`],
/// [`ConstructError::TooManyVoxels`], [`ConstructError::Parameter`] for an empty range.
pub fn centreline(volume: &Volume, from: DVec3, to: DVec3, values: [f64; 2]) -> Result<Centreline, ConstructError> {
    let [lo, hi] = values;
    if !(lo.is_finite() && hi.is_finite() && lo <= hi) {
        let must = "be two finite numbers, the least first";
        return Err(ConstructError::Parameter { name: "the first of values", value: lo, must });
    }
    let lattice = Lattice { volume, dims: volume.dims(), values };
    let start = lattice.nearest(from, "from")?;
    let end = lattice.nearest(to, "to")?;
    let part = Part::of(&lattice, start)?;
    let (Some(a), Some(b)) = (part.local(start), part.local(end)) else {
        return Err(lattice.apart(&part, to));
    };
    let [x, y, z] = [volume.axes().x_axis, volume.axes().y_axis, volume.axes().z_axis].map(DVec3::length);
    let spacing = [x, y, z];
    let mut clearance = squared(&part.inside, part.dims, spacing, Around::Outside);
    clearance.iter_mut().for_each(|d| *d = d.sqrt());
    let cells = Cells { dims: part.dims, spacing, clearance: &clearance };
    let Some(way) = part.inside[b].then(|| cells.cheapest(a, b)).flatten() else {
        return Err(lattice.apart(&part, to));
    };
    let mut points: Vec<DVec3> = way.iter().map(|i| volume.scene_from_lattice(part.voxel(*i))).collect();
    for (end, picked) in [(0, from), (way.len() - 1, to)] {
        if lattice.holds(picked) {
            points[end] = picked;
        }
    }
    let points = smoothed(points, volume.voxel_edge(), |p| part.holds(volume, p));
    let room = |p: &DVec3| part.at(volume, *p).map_or(0.0, |i| f64::from(clearance[i]));
    let mut rooms: Vec<f64> = points.iter().map(room).collect();
    rooms.sort_by(f64::total_cmp);
    let report = CentrelineReport {
        length: points.windows(2).map(|w| w[0].distance(w[1])).sum(),
        least_clearance: rooms[0],
        median_clearance: rooms[rooms.len() / 2],
        voxels: part.inside.iter().filter(|i| **i).count(),
        values,
    };
    Ok(Centreline { points, report })
}

/// The voxels of a volume and which of them may be used.
struct Lattice<'v> {
    volume: &'v Volume,
    dims: [usize; 3],
    values: [f64; 2],
}

impl Lattice<'_> {
    fn number(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.dims[1] + y) * self.dims[0] + x
    }

    fn fits(&self, voxel: [usize; 3]) -> bool {
        let value = f64::from(self.volume.values().at(self.number(voxel)));
        value >= self.values[0] && value <= self.values[1]
    }

    /// Whether the interpolated value of a position is within the range.
    fn holds(&self, p: DVec3) -> bool {
        let value = self.volume.at(self.volume.lattice_from_scene(p));
        value.is_some_and(|v| v >= self.values[0] && v <= self.values[1])
    }

    /// The voxel of the range nearest to a position.
    fn nearest(&self, p: DVec3, name: &'static str) -> Result<[usize; 3], ConstructError> {
        let reach = NEAR * self.volume.voxel_edge();
        let q = self.volume.lattice_from_scene(p);
        let spans: [std::ops::RangeInclusive<i64>; 3] = std::array::from_fn(|a| {
            let cells = (NEAR + 1.0).ceil();
            let most = self.dims[a] as f64 - 1.0;
            (q[a] - cells).clamp(0.0, most) as i64..=(q[a] + cells).clamp(0.0, most) as i64
        });
        let mut best: Option<(f64, [usize; 3])> = None;
        for z in spans[2].clone() {
            for y in spans[1].clone() {
                for x in spans[0].clone() {
                    let voxel = [x, y, z].map(|v| v as usize);
                    let at = self.volume.scene_from_lattice(DVec3::from_array(voxel.map(|v| v as f64)));
                    let far = at.distance(p);
                    if far <= reach && self.fits(voxel) && best.is_none_or(|(b, _)| far < b) {
                        best = Some((far, voxel));
                    }
                }
            }
        }
        best.map(|(_, voxel)| voxel).ok_or_else(|| ConstructError::PointOutside {
            name,
            point: p.to_array(),
            value: self.volume.at(q),
            values: self.values,
            reach,
        })
    }

    /// The error for points in different parts, with the distance of the first point's part from the second point.
    fn apart(&self, part: &Part, to: DVec3) -> ConstructError {
        let places = (0..part.inside.len()).filter(|i| part.inside[*i]).map(|i| {
            let p = self.volume.scene_from_lattice(part.voxel(i));
            (p.distance(to), p)
        });
        let (distance, nearest) = places.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, to));
        let voxels = part.inside.iter().filter(|i| **i).count();
        ConstructError::NotConnected { values: self.values, voxels, distance, nearest: nearest.to_array() }
    }
}

/// Connected voxels, in the smallest box around them.
struct Part {
    first: [usize; 3],
    dims: [usize; 3],
    inside: Vec<bool>,
}

impl Part {
    fn of(lattice: &Lattice<'_>, start: [usize; 3]) -> Result<Self, ConstructError> {
        let dims = lattice.dims;
        let mut found = vec![false; dims.iter().product()];
        let (mut lo, mut hi) = (start, start);
        found[lattice.number(start)] = true;
        let mut open = vec![start];
        while let Some(at) = open.pop() {
            for axis in 0..3 {
                (lo[axis], hi[axis]) = (lo[axis].min(at[axis]), hi[axis].max(at[axis]));
                for back in [true, false] {
                    let step = if back { at[axis].checked_sub(1) } else { Some(at[axis] + 1) };
                    let Some(c) = step.filter(|c| *c < dims[axis]) else { continue };
                    let mut next = at;
                    next[axis] = c;
                    let number = lattice.number(next);
                    if !found[number] && lattice.fits(next) {
                        found[number] = true;
                        open.push(next);
                    }
                }
            }
        }
        let size: [usize; 3] = std::array::from_fn(|a| hi[a] - lo[a] + 1);
        let voxels = size.iter().product();
        if voxels > MOST_VOXELS {
            return Err(ConstructError::TooManyVoxels { voxels, most: MOST_VOXELS });
        }
        let mut inside = Vec::with_capacity(voxels);
        for z in lo[2]..=hi[2] {
            for y in lo[1]..=hi[1] {
                let row = lattice.number([lo[0], y, z]);
                inside.extend_from_slice(&found[row..row + size[0]]);
            }
        }
        Ok(Self { first: lo, dims: size, inside })
    }

    /// Number of a voxel of the volume; `None` outside the box.
    fn local(&self, voxel: [usize; 3]) -> Option<usize> {
        let [x, y, z] = [0, 1, 2].map(|a| voxel[a].checked_sub(self.first[a]).filter(|v| *v < self.dims[a]));
        Some((z? * self.dims[1] + y?) * self.dims[0] + x?)
    }

    /// Lattice coordinates of a voxel by its number.
    fn voxel(&self, i: usize) -> DVec3 {
        let [nx, ny, _] = self.dims;
        let at = [i % nx, i / nx % ny, i / nx / ny];
        DVec3::from_array(std::array::from_fn(|a| (at[a] + self.first[a]) as f64))
    }

    /// The voxel nearest to a position, if it is inside.
    fn at(&self, volume: &Volume, p: DVec3) -> Option<usize> {
        let q = volume.lattice_from_scene(p).round();
        let within = q.cmpge(DVec3::ZERO).all();
        let i = within.then(|| self.local(q.to_array().map(|v| v as usize))).flatten()?;
        self.inside[i].then_some(i)
    }

    fn holds(&self, volume: &Volume, p: DVec3) -> bool {
        self.at(volume, p).is_some()
    }
}

/// The path at even spacing with rounded corners; both ends stay, and so do points whose smoothed position is not allowed.
///
/// Smoothing alone would pull bends inwards, so the difference that it makes is smoothed and added again (twicing, Tukey 1977).
fn smoothed(way: Vec<DVec3>, edge: f64, allowed: impl Fn(DVec3) -> bool) -> Vec<DVec3> {
    let even = resampled(&way, SPACING * edge);
    let once = averaged(&even);
    let lost: Vec<DVec3> = even.iter().zip(&once).map(|(p, q)| *p - *q).collect();
    let again = averaged(&lost);
    let last = even.len() - 1;
    let place = |i: usize| {
        let p = once[i] + again[i];
        if i == 0 || i == last || !allowed(p) { even[i] } else { p }
    };
    (0..even.len()).map(place).collect()
}

/// Points at even distances along a polyline, about `spacing` apart, both ends included.
fn resampled(way: &[DVec3], spacing: f64) -> Vec<DVec3> {
    let total: f64 = way.windows(2).map(|w| w[0].distance(w[1])).sum();
    let count = (total / spacing).ceil().max(1.0);
    let mut out = Vec::with_capacity(count as usize + 1);
    let (mut before, mut next) = (0.0, 0.0);
    for pair in way.windows(2) {
        let length = pair[0].distance(pair[1]);
        while next < before + length && out.len() < count as usize {
            out.push(pair[0].lerp(pair[1], (next - before) / length));
            next = total * out.len() as f64 / count;
        }
        before += length;
    }
    out.extend(way.last());
    out
}

/// Gaussian averages, over fewer and fewer values towards the ends, which stay.
fn averaged(values: &[DVec3]) -> Vec<DVec3> {
    let sigma = SMOOTH / SPACING;
    let reach = (3.0 * sigma).ceil() as usize;
    let weights: Vec<f64> = (0..=reach).map(|k| (-0.5 * (k as f64 / sigma).powi(2)).exp()).collect();
    let average = |i: usize| {
        let side = reach.min(i).min(values.len() - 1 - i);
        let (mut sum, mut weight) = (values[i], 1.0);
        for (k, w) in weights.iter().enumerate().take(side + 1).skip(1) {
            sum += *w * (values[i - k] + values[i + k]);
            weight += 2.0 * w;
        }
        sum / weight
    };
    (0..values.len()).map(average).collect()
}
