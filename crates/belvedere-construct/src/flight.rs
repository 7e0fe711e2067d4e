//! A camera that follows a walker along a route: behind and above, looking ahead, smooth, never under ground.

use belvedere_core::{DVec2, DVec3};
use belvedere_scene::Heightfield;

/// Position of the camera relative to the walker.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlightOptions {
    /// Distance in plan from the walker back to the eye, scene units, > 0.
    pub behind_m: f64,
    /// Height of the eye over the ground below it and over the walker, whichever is higher, scene units, > 0.
    pub above_m: f64,
    /// Distance in plan from the walker to the point looked at, scene units, > 0.
    pub ahead_m: f64,
}

impl FlightOptions {
    /// 800 behind, 500 above, 1500 ahead for routes of 10 km and more; for shorter routes in proportion to their length, down to 1 %.
    pub fn for_length(length_m: f64) -> Self {
        let scale = (length_m / 10_000.0).clamp(0.01, 1.0);
        Self { behind_m: 800.0 * scale, above_m: 500.0 * scale, ahead_m: 1500.0 * scale }
    }

    /// The same over ground of cells of `cell_m`: the eye stays far enough away that cells look small, 8 cells behind the walker,
    /// 5 above and 12 ahead at least, and no farther behind than a quarter of `extent_m`, the shorter side of the ground.
    pub fn over_cells(self, cell_m: f64, extent_m: f64) -> Self {
        let least = (8.0 * cell_m).min(0.25 * extent_m);
        let scale = if least > 0.0 { (least / self.behind_m).max(1.0) } else { 1.0 };
        Self { behind_m: scale * self.behind_m, above_m: scale * self.above_m, ahead_m: scale * self.ahead_m }
    }
}

/// A flight that is not possible.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FlightError {
    /// The route has no length.
    #[error(
        "the route to fly along is {length_m:.3} long with {points} points; give one with at least 2 distinct points"
    )]
    Short {
        /// Length, scene units.
        length_m: f64,
        /// Points of the route.
        points: usize,
    },
    /// An option out of range.
    #[error("{name} is {value}, it must be a number greater than 0")]
    Option {
        /// Name.
        name: &'static str,
        /// Value given.
        value: f64,
    },
}

/// Most steps in which a route is tabulated.
const MOST_STEPS: f64 = 40_000.0;
/// Places on the line of sight to the walker that the eye looks over, as shares of the distance from the walker to the eye.
const SIGHT: [f64; 8] = [0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
/// Height over the ground at which the line of sight passes there, and most that the eye rises for it, in units of `above_m`.
const OVER: f64 = 0.05;
const MOST_RISE: f64 = 1.0;

/// Eye and target for every distance walked. Both are C1 in the distance: piecewise cubic through a fine table.
#[derive(Debug, Clone, PartialEq)]
pub struct Flight {
    length_m: f64,
    step: f64,
    eye: Vec<DVec3>,
    target: Vec<DVec3>,
    walker: Vec<DVec3>,
}

impl Flight {
    /// Follows `route` (scene x, y; at least two points) over `terrain`.
    ///
    /// The route is smoothed over about `behind_m`; the heading is that from the eye's side of the walker to the far side,
    /// unwrapped and smoothed again, so that hairpins turn the camera gently. The eye's height is a sliding maximum of the
    /// ground around it and under the walker, smoothed by a kernel no wider than the maximum: it stays at least `above_m` over both.
    /// Where ground between hides the walker the eye rises, by at most `above_m`.
    ///
    /// # Errors
    /// Every [`FlightError`].
    ///
    /// Source: ours.
    pub fn along(route: &[DVec2], terrain: Option<&Heightfield>, options: &FlightOptions) -> Result<Self, FlightError> {
        let named = [("behind_m", options.behind_m), ("above_m", options.above_m), ("ahead_m", options.ahead_m)];
        if let Some((name, value)) = named.into_iter().find(|(_, v)| !(*v > 0.0 && v.is_finite())) {
            return Err(FlightError::Option { name, value });
        }
        let path = Route::new(route);
        let length_m = path.length();
        if !(length_m > 1e-3) {
            return Err(FlightError::Short { length_m, points: route.len() });
        }
        let behind = options.behind_m;
        let step = (behind / 16.0).min(length_m / 64.0).max(length_m / MOST_STEPS);
        let steps = (length_m / step).ceil() as usize;
        let nodes = |reach: f64| (reach / step).ceil() as usize;
        // Everything is tabulated beyond both ends, as far as the smoothing and looking around reach.
        let pad = nodes(4.0 * behind + options.ahead_m);
        let table = Table { step, pad, len: steps + 1 + 2 * pad };
        let smoothed: Vec<DVec2> = smooth(&table.map(|s| path.at(s)), nodes(behind / 3.0));
        let heading = headings(&smoothed, nodes(0.5 * behind), nodes(0.5 * options.ahead_m), nodes(behind / 3.0));
        let direction = |i: usize| DVec2::from_angle(heading[i]);
        let eyes: Vec<DVec2> = (0..table.len).map(|i| smoothed[i] - behind * direction(i)).collect();
        let ground = Ground { terrain, reach: behind / 8.0 };
        let walker: Vec<f64> = ground.filled(&smoothed, Ground::at);
        let around: Vec<f64> = ground.filled(&eyes, Ground::highest_around);
        let over = OVER * options.above_m;
        let needed = (0..table.len).map(|i| {
            let least = walker[i].max(around[i]) + options.above_m;
            // Eyes from which the line of sight to the walker passes over the ground between.
            let rise = |t: f64| {
                let between = ground.at(smoothed[i].lerp(eyes[i], t)).unwrap_or(f64::NEG_INFINITY);
                walker[i] + (between + over - walker[i]) / t
            };
            SIGHT.into_iter().map(rise).fold(least, f64::max).min(least + MOST_RISE * options.above_m)
        });
        let needed: Vec<f64> = needed.collect();
        let window = nodes(0.75 * behind);
        let height = smooth(&sliding_max(&needed, 3 * (window / 3)), window / 3);
        let level = smooth(&walker, nodes(behind / 3.0));
        let eye = table.cut(|i| eyes[i].extend(height[i]));
        let target = table.cut(|i| (smoothed[i] + options.ahead_m * direction(i)).extend(level[i]));
        let walker = table.cut(|i| smoothed[i].extend(level[i]));
        Ok(Self { length_m, step, eye, target, walker })
    }

    /// Length of the route, scene units.
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// Eye and point looked at when the walker has come `walked_m` along the route (held at its ends).
    pub fn at(&self, walked_m: f64) -> (DVec3, DVec3) {
        let t = self.node(walked_m);
        (cubic(&self.eye, t), cubic(&self.target, t))
    }

    /// The walker on the ground, smoothed as the camera follows it: near to the route, not on it in sharp turns.
    pub fn walker(&self, walked_m: f64) -> DVec3 {
        cubic(&self.walker, self.node(walked_m))
    }

    fn node(&self, walked_m: f64) -> f64 {
        (walked_m.clamp(0.0, self.length_m) / self.step).max(0.0)
    }
}

/// A polyline by arc length; beyond its ends it goes on mirrored through them.
struct Route {
    points: Vec<DVec2>,
    along: Vec<f64>,
}

impl Route {
    fn new(route: &[DVec2]) -> Self {
        let mut points: Vec<DVec2> = route.iter().copied().filter(|p| p.is_finite()).collect();
        points.dedup();
        let mut along = Vec::with_capacity(points.len());
        let mut sum = 0.0;
        for (i, p) in points.iter().enumerate() {
            sum += if i == 0 { 0.0 } else { p.distance(points[i - 1]) };
            along.push(sum);
        }
        Self { points, along }
    }

    fn length(&self) -> f64 {
        self.along.last().copied().unwrap_or(0.0)
    }

    fn at(&self, s: f64) -> DVec2 {
        let length = self.length();
        if s < 0.0 {
            return 2.0 * self.inside(0.0) - self.inside((-s).min(length));
        }
        if s > length {
            return 2.0 * self.inside(length) - self.inside((2.0 * length - s).max(0.0));
        }
        self.inside(s)
    }

    fn inside(&self, s: f64) -> DVec2 {
        let i = self.along.partition_point(|a| *a <= s).clamp(1, self.points.len() - 1);
        let (a, b) = (self.along[i - 1], self.along[i]);
        self.points[i - 1].lerp(self.points[i], ((s - a) / (b - a)).clamp(0.0, 1.0))
    }
}

/// Equal steps along the route, `pad` of them before it and after it.
struct Table {
    step: f64,
    pad: usize,
    len: usize,
}

impl Table {
    fn map<T>(&self, at: impl Fn(f64) -> T) -> Vec<T> {
        (0..self.len).map(|i| at((i as f64 - self.pad as f64) * self.step)).collect()
    }

    /// The route itself and one node more at either end.
    fn cut<T>(&self, at: impl Fn(usize) -> T) -> Vec<T> {
        (self.pad - 1..self.len - self.pad + 1).map(at).collect()
    }
}

/// Three running means of 2 `reach` + 1 nodes: a smooth kernel that ends 3 `reach` nodes away. Ends are held.
fn smooth<T>(values: &[T], reach: usize) -> Vec<T>
where
    T: Copy + Default + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    let mut out = values.to_vec();
    for _ in 0..3 {
        let old = out.clone();
        let at = |i: isize| old[i.clamp(0, old.len() as isize - 1) as usize];
        for (i, v) in out.iter_mut().enumerate() {
            let window = i as isize - reach as isize..=i as isize + reach as isize;
            *v = window.map(at).fold(T::default(), |a, b| a + b) * (1.0 / (2 * reach + 1) as f64);
        }
    }
    out
}

fn sliding_max(values: &[f64], reach: usize) -> Vec<f64> {
    let window = |i: usize| i.saturating_sub(reach)..(i + reach + 1).min(values.len());
    (0..values.len()).map(|i| values[window(i)].iter().copied().fold(f64::NEG_INFINITY, f64::max)).collect()
}

/// Angle from the point `before` nodes back to one `after` nodes on, unwrapped and smoothed.
fn headings(path: &[DVec2], before: usize, after: usize, reach: usize) -> Vec<f64> {
    let last = path.len() - 1;
    let mut angle = 0.0f64;
    let raw: Vec<f64> = (0..path.len())
        .map(|i| {
            let d = path[(i + after).min(last)] - path[i.saturating_sub(before)];
            if d.length() > 1e-6 {
                let turn = (d.to_angle() - angle).rem_euclid(std::f64::consts::TAU);
                angle += if turn > std::f64::consts::PI { turn - std::f64::consts::TAU } else { turn };
            }
            angle
        })
        .collect();
    smooth(&raw, reach)
}

struct Ground<'a> {
    terrain: Option<&'a Heightfield>,
    /// Half side of the square around an eye that counts as its ground, scene units.
    reach: f64,
}

impl Ground<'_> {
    /// Heights by `of`; where there is no ground, that of the nearest point along the path that has ground; 0 if no point has.
    fn filled(&self, path: &[DVec2], of: impl Fn(&Self, DVec2) -> Option<f64>) -> Vec<f64> {
        let known: Vec<Option<f64>> = path.iter().map(|p| of(self, *p)).collect();
        let mut out: Vec<f64> = Vec::with_capacity(path.len());
        let mut last = known.iter().flatten().next().copied().unwrap_or(0.0);
        for k in known {
            last = k.unwrap_or(last);
            out.push(last);
        }
        out
    }

    fn at(&self, p: DVec2) -> Option<f64> {
        self.terrain?.surface_at(p)
    }

    /// Highest ground of a lattice about as fine as the terrain, at most 17 x 17.
    fn highest_around(&self, p: DVec2) -> Option<f64> {
        let terrain = self.terrain?;
        let half = (self.reach / terrain.spacing().min_element()).ceil().clamp(1.0, 8.0) as i32;
        let step = self.reach / f64::from(half);
        let lattice = (-half..=half).flat_map(|i| (-half..=half).map(move |j| DVec2::new(f64::from(i), f64::from(j))));
        lattice.filter_map(|d| terrain.surface_at(p + step * d)).reduce(f64::max)
    }
}

/// Cubic through the nodes of a table whose node 1 lies at `t` = 0, with central differences as slopes.
fn cubic(table: &[DVec3], t: f64) -> DVec3 {
    let i = (t.floor() as usize).min(table.len() - 4) + 1;
    let f = (t - (i - 1) as f64).clamp(0.0, 1.0);
    let (p, q) = (table[i], table[i + 1]);
    let (dp, dq) = (0.5 * (q - table[i - 1]), 0.5 * (table[i + 2] - p));
    let (f2, f3) = (f * f, f * f * f);
    (2.0 * f3 - 3.0 * f2 + 1.0) * p + (f3 - 2.0 * f2 + f) * dp + (3.0 * f2 - 2.0 * f3) * q + (f3 - f2) * dq
}
