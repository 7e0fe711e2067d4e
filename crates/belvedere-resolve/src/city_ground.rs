//! The ground of cities without terrain: level, or a surface through the ground heights of their buildings.

use belvedere_core::quantile::{Rank, quantile};
use belvedere_core::{DMat3, DVec2, DVec3};
use belvedere_io::city::plate_extent;
use belvedere_scene::{Building, City, Heightfield};
use rayon::prelude::*;

/// Ground stays level where its trend over the town is less than this, metres.
const LEVEL_M: f64 = 3.0;
/// Buildings of one local plane, at least, and its reach over the distance of the nearest of them.
const NEIGHBOURS: usize = 12;
const REACH: f64 = 3.0;
/// Weight of a level ground beside the slope that the buildings show, which a row of houses shows along itself alone.
const LEVELLING: f64 = 1e-3;
/// Bases farther than this from the surface through the others are left out, metres; and at least so many deviations.
const ODD_M: f64 = 6.0;
const ODD: f64 = 6.0;
/// Cells of a field along its longer side, and their least width, metres.
const CELLS: f64 = 80.0;
const LEAST_CELL_M: f64 = 5.0;
/// Most cells along a side within which ground heights count as one.
const BINS: f64 = 64.0;

/// The ground of all cities of a scene without terrain, at every level of abstraction.
#[derive(Debug, Clone)]
pub enum OwnGround {
    /// Level, at a height, metres.
    Level(f64),
    /// Heights over the extent of the cities.
    Sloping(Heightfield),
}

/// Ground heights of buildings, and the extent of their cities.
#[derive(Debug, Default)]
pub struct Bases {
    places: Vec<DVec3>,
    extent: Option<[DVec2; 2]>,
}

impl Bases {
    /// Adds those of a city, lifted by `by` metres.
    pub fn add(&mut self, city: &City, by: f64) {
        let places = city.buildings.iter().filter_map(|b| Some(middle(b).extend(b.base_m? + by)));
        self.places.extend(places);
        if let Some([low, high]) = plate_extent(city) {
            self.extent = Some(self.extent.map_or([low, high], |[a, b]| [a.min(low), b.max(high)]));
        }
    }

    /// The ground through them; `None` without any. It is level unless the heights have a trend that is larger than what single
    /// buildings differ from it.
    pub fn ground(self) -> Option<OwnGround> {
        let mut heights: Vec<f64> = self.places.iter().map(|p| p.z).collect();
        if heights.is_empty() {
            return None;
        }
        let middle = heights.len() / 2;
        let level = OwnGround::Level(*heights.select_nth_unstable_by(middle, f64::total_cmp).1);
        let places: Vec<DVec3> = self.places.into_iter().filter(|p| p.is_finite()).collect();
        let Some([low, high]) = self.extent.filter(|_| places.len() >= 3) else { return Some(level) };
        let Some(trend) = Trend::of(&places) else { return Some(level) };
        Some(trend.field(low, high).map_or(level, OwnGround::Sloping))
    }
}

/// Middle of the plan of a building, not finite without one.
pub fn middle(building: &Building) -> DVec2 {
    let corners = building.footprint.iter().flat_map(|p| &p.outer);
    let [low, high] = corners.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[a, b], p| [a.min(*p), b.max(*p)]);
    0.5 * (low + high)
}

impl OwnGround {
    /// Height at a position; beyond the cities that of their nearest rim.
    pub fn at(&self, xy: DVec2) -> f64 {
        match self {
            Self::Level(z) => *z,
            Self::Sloping(field) => {
                let bounds = field.bounds();
                let inside = xy.clamp(bounds.min.truncate(), bounds.max.truncate());
                field.surface_at(inside).unwrap_or(bounds.min.z)
            }
        }
    }
}

/// Heights at positions, smoothed by local planes. Source: Cleveland, "Robust locally weighted regression and smoothing
/// scatterplots", Journal of the American Statistical Association 74 (1979).
struct Trend {
    places: Vec<DVec3>,
    range: [f64; 2],
}

impl Trend {
    /// The trend of heights; `None` if it is level, or less than what single heights differ from it.
    fn of(places: &[DVec3]) -> Option<Self> {
        let mut trend = Self::through(places);
        let off = |trend: &Self| -> Vec<f64> { places.par_iter().map(|p| p.z - trend.at(p.truncate())).collect() };
        let first = off(&trend);
        let median = quantile(&mut first.iter().map(|r| r.abs()).collect::<Vec<_>>(), 0.5, Rank::Nearest);
        let kept: Vec<DVec3> =
            places.iter().zip(&first).filter(|(_, r)| r.abs() <= ODD_M.max(ODD * median)).map(|(p, _)| *p).collect();
        if kept.len() >= 3 && kept.len() < places.len() {
            trend = Self::through(&kept);
        }
        let spread = |mut values: Vec<f64>| {
            let [low, high] = [0.05, 0.95].map(|share| quantile(&mut values, share, Rank::Nearest));
            high - low
        };
        let smooth = spread(kept.par_iter().map(|p| trend.at(p.truncate())).collect());
        let rough = spread(kept.par_iter().map(|p| p.z - trend.at(p.truncate())).collect());
        (smooth > LEVEL_M && smooth > rough).then_some(trend)
    }

    /// Mean places of the cells of a lattice.
    fn through(places: &[DVec3]) -> Self {
        let [low, high] = places.iter().fold([DVec3::MAX, DVec3::MIN], |[a, b], p| [a.min(*p), b.max(*p)]);
        let side = ((high - low).truncate().max_element() / BINS).max(1.0);
        let mut binned: Vec<([i64; 2], DVec3)> = places
            .iter()
            .map(|p| ((((*p - low).truncate() / side).floor().to_array().map(|v| v as i64)), *p))
            .collect();
        binned.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.x.total_cmp(&b.1.x)).then(a.1.y.total_cmp(&b.1.y)));
        let of_cell = |cell: &[([i64; 2], DVec3)]| cell.iter().map(|(_, p)| p).sum::<DVec3>() / cell.len() as f64;
        Self { places: binned.chunk_by(|a, b| a.0 == b.0).map(of_cell).collect(), range: [low.z, high.z] }
    }

    /// Height at a position: that of the plane through the places around it.
    fn at(&self, xy: DVec2) -> f64 {
        let distances: Vec<f64> = self.places.iter().map(|p| p.truncate().distance(xy)).collect();
        let mut sorted = distances.clone();
        let last = NEIGHBOURS.min(sorted.len()) - 1;
        let far = *sorted.select_nth_unstable_by(last, f64::total_cmp).1;
        let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
        let reach = (1.3 * far).max(REACH * nearest).max(1.0);
        let (mut matrix, mut right, mut sum) = (DMat3::ZERO, DVec3::ZERO, 0.0);
        for (place, distance) in self.places.iter().zip(&distances).filter(|(_, d)| **d < reach) {
            let weight = (1.0 - (distance / reach).powi(3)).powi(3);
            let row = ((place.truncate() - xy) / reach).extend(1.0);
            matrix += DMat3::from_cols(row * row.x, row * row.y, row * row.z) * weight;
            right += row * (weight * (place.z - self.range[0]));
            sum += weight;
        }
        matrix += DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0) * LEVELLING * sum);
        let height = self.range[0] + (matrix.inverse() * right).z;
        let [low, high] = self.range;
        let room = 0.5 * (high - low);
        if height.is_finite() { height.clamp(low - room, high + room) } else { low }
    }

    /// Its heights over an extent and a little beyond.
    fn field(&self, low: DVec2, high: DVec2) -> Option<Heightfield> {
        let cell = ((high - low).max_element() / CELLS).max(LEAST_CELL_M);
        let nodes = ((high - low) / cell).ceil().as_uvec2() + 3;
        let [cols, rows] = nodes.to_array().map(|n| n as usize);
        let north_west = DVec2::new(low.x - cell, low.y + (rows - 2) as f64 * cell);
        let node = |i: usize| north_west + cell * DVec2::new((i % cols) as f64, -((i / cols) as f64));
        let heights = (0..cols * rows).into_par_iter().map(|i| self.at(node(i)) as f32).collect();
        Heightfield::measured(north_west, DVec2::splat(cell), cols, rows, heights).ok()
    }
}
