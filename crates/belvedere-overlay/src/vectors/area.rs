//! Areas on the picture, cut to what is seen of them: borders between pixel centres inside and outside, found to a fraction of a pixel along
//! rays of the view (marching squares).

use belvedere_composite::marks::simplified;
use belvedere_core::{DVec2, View};
use belvedere_scene::{AreaLayer, Color, Frame, LayerKind, Scene};
use belvedere_sight::trace::Tracer;
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};

/// Halvings that find a border between two pixel centres: to 1/64 pixel.
const HALVINGS: u32 = 6;
/// Smallest ring that is kept, square pixels.
const LEAST_PX2: f64 = 0.5;
/// Most pixels of areas that are held at once: an area over the whole of a large sheet is held alone.
const PIXELS_AT_ONCE: u64 = 8 << 20;
/// Bands of edges by their y, and cells of areas along a side.
const BANDS: usize = 64;

/// An area as it is seen.
#[derive(Debug, Clone, PartialEq)]
pub struct AreaShape {
    /// Index of the layer in the scene.
    pub layer: usize,
    /// Name, possibly empty.
    pub name: String,
    /// Fill with opacity.
    pub fill: Color,
    /// Rings on the picture, pixels, for the even-odd rule.
    pub rings: Vec<Vec<DVec2>>,
}

/// All areas on the ground, in the order of the scene.
///
/// * `frame`: with world points, its ids without marks.
/// * `tolerance`: of simplified rings, pixels.
pub fn areas((scene, view): (&Scene, &View), frame: &Frame, tolerance: f64) -> Vec<AreaShape> {
    let is_ground = |kind: &LayerKind| kind.terrain().is_some();
    let Some(ground) = scene.layers.iter().position(|layer| is_ground(&layer.kind)) else { return Vec::new() };
    // Where areas are painted the ids are theirs.
    let shows_ground: Vec<bool> = std::iter::once(false)
        .chain(scene.layers.iter().map(|layer| is_ground(&layer.kind) || layer.kind.areas().is_some()))
        .collect();
    let mut tracer = None;
    let mut shapes = Vec::new();
    for (index, layer) in scene.layers.iter().enumerate() {
        let Some(layer) = layer.kind.areas() else { continue };
        let plans: Vec<Plan> = layer.features.par_iter().map(|f| Plan::new(&f.rings)).collect();
        let pixels = GroundPixels { frame, shows_ground: &shows_ground };
        let tracer = tracer.get_or_insert_with(|| Tracer::of_opaque(scene, view));
        let seen = |number: usize, pixel: DVec2| {
            let hit = tracer.first_hit(pixel).filter(|hit| hit.layer == ground);
            hit.is_some_and(|hit| plans[number].contains(hit.point.truncate()))
        };
        for numbers in groups(&pixels.counts(&plans)) {
            let inside = pixels.inside(&plans, &numbers);
            let traced = inside.into_par_iter().zip(&numbers).map(|(pixels, &number)| {
                let rings = rings(&pixels, [frame.width, frame.height], |pixel| seen(number, pixel));
                let rings = rings.iter().filter(|ring| area(ring).abs() >= LEAST_PX2);
                let rings: Vec<Vec<DVec2>> = rings.map(|ring| simplified(ring, tolerance)).collect();
                (!rings.is_empty()).then(|| shape(index, layer, number, rings))
            });
            shapes.extend(traced.collect::<Vec<_>>().into_iter().flatten());
        }
    }
    shapes
}

fn shape(index: usize, layer: &AreaLayer, number: usize, rings: Vec<Vec<DVec2>>) -> AreaShape {
    let feature = &layer.features[number];
    let fill = feature.style.and_then(|own| own.color).unwrap_or(layer.fill);
    AreaShape { layer: index, name: feature.name.trim().to_owned(), fill, rings }
}

/// A polygon in plan, its edges sorted into bands of y.
struct Plan {
    lo: DVec2,
    hi: DVec2,
    bands: Vec<Vec<[DVec2; 2]>>,
}

impl Plan {
    fn new(rings: &[Vec<DVec2>]) -> Self {
        let points = || rings.iter().flatten().filter(|p| p.is_finite());
        let lo = points().fold(DVec2::INFINITY, |lo, p| lo.min(*p));
        let hi = points().fold(DVec2::NEG_INFINITY, |hi, p| hi.max(*p));
        let mut plan = Self { lo, hi, bands: vec![Vec::new(); BANDS] };
        for ring in rings {
            for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                if a.is_finite() && b.is_finite() && a.y != b.y {
                    let [first, last] = [a.y.min(b.y), a.y.max(b.y)].map(|y| plan.band(y));
                    plan.bands[first..=last].iter_mut().for_each(|band| band.push([*a, *b]));
                }
            }
        }
        plan
    }

    fn band(&self, y: f64) -> usize {
        let share = (y - self.lo.y) / (self.hi.y - self.lo.y).max(1e-12);
        ((share * BANDS as f64) as usize).min(BANDS - 1)
    }

    fn contains(&self, p: DVec2) -> bool {
        if !(p.cmpge(self.lo).all() && p.cmple(self.hi).all()) {
            return false;
        }
        let crossed =
            |[a, b]: &&[DVec2; 2]| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
        self.bands[self.band(p.y)].iter().filter(crossed).count() % 2 == 1
    }
}

/// Finds the polygons that ground points lie in.
struct Finder<'p> {
    plans: &'p [Plan],
    lo: DVec2,
    hi: DVec2,
    /// Numbers of the polygons whose bounds meet each cell.
    cells: Vec<Vec<u32>>,
}

impl<'p> Finder<'p> {
    /// * `numbers`: of the polygons that are looked for.
    fn new(plans: &'p [Plan], numbers: &[usize]) -> Self {
        let bounds = numbers.iter().map(|n| &plans[*n]).filter(|plan| plan.lo.is_finite());
        let lo = bounds.clone().fold(DVec2::INFINITY, |lo, plan| lo.min(plan.lo));
        let hi = bounds.fold(DVec2::NEG_INFINITY, |hi, plan| hi.max(plan.hi));
        let mut finder = Self { plans, lo, hi, cells: vec![Vec::new(); BANDS * BANDS] };
        for number in numbers.iter().copied().filter(|n| plans[*n].lo.is_finite()) {
            let [from, to] = [plans[number].lo, plans[number].hi].map(|p| finder.cell(p));
            for y in from[1]..=to[1] {
                for x in from[0]..=to[0] {
                    finder.cells[y * BANDS + x].push(number as u32);
                }
            }
        }
        finder
    }

    fn cell(&self, p: DVec2) -> [usize; 2] {
        let size = (self.hi - self.lo).max(DVec2::splat(1e-9));
        let at = ((p - self.lo) / size * BANDS as f64).clamp(DVec2::ZERO, DVec2::splat(BANDS as f64 - 1.0));
        [at.x as usize, at.y as usize]
    }

    fn around(&self, p: DVec2) -> impl Iterator<Item = u32> + '_ {
        let is_near = p.cmpge(self.lo).all() && p.cmple(self.hi).all();
        let [x, y] = if is_near { self.cell(p) } else { [0; 2] };
        let near = if is_near { &self.cells[y * BANDS + x][..] } else { &[] };
        near.iter().copied().filter(move |n| self.plans[*n as usize].contains(p))
    }
}

/// The pixels of a frame whose centres show ground.
struct GroundPixels<'f> {
    frame: &'f Frame,
    /// By the ids of the frame.
    shows_ground: &'f [bool],
}

impl GroundPixels<'_> {
    /// The polygons at every pixel of a row: number, and number of the pixel.
    fn row(&self, row: usize, finder: &Finder<'_>, mut found: impl FnMut(u32, u32)) {
        let (width, world) = (self.frame.width, self.frame.world.as_deref().unwrap_or_default());
        for i in (row * width..(row + 1) * width).take_while(|i| *i < world.len()) {
            if self.shows_ground.get(self.frame.id[i] as usize).copied().unwrap_or(false) {
                finder.around(DVec2::new(world[i][0], world[i][1])).for_each(|number| found(number, i as u32));
            }
        }
    }

    /// Number of pixels inside each polygon.
    fn counts(&self, plans: &[Plan]) -> Vec<u64> {
        let all: Vec<usize> = (0..plans.len()).collect();
        let (finder, counts) = (Finder::new(plans, &all), all.iter().map(|_| AtomicU64::new(0)).collect::<Vec<_>>());
        (0..self.frame.height).into_par_iter().for_each(|row| {
            self.row(row, &finder, |number, _| {
                counts[number as usize].fetch_add(1, Ordering::Relaxed);
            });
        });
        counts.into_iter().map(AtomicU64::into_inner).collect()
    }

    /// Pixels inside each of some polygons, ascending.
    fn inside(&self, plans: &[Plan], numbers: &[usize]) -> Vec<Vec<u32>> {
        let finder = Finder::new(plans, numbers);
        let rows = (0..self.frame.height).into_par_iter().map(|row| {
            let mut found = Vec::new();
            self.row(row, &finder, |number, pixel| found.push((number, pixel)));
            found
        });
        let rows: Vec<Vec<(u32, u32)>> = rows.collect();
        let place: HashMap<usize, usize> = numbers.iter().enumerate().map(|(at, number)| (*number, at)).collect();
        let mut inside = vec![Vec::new(); numbers.len()];
        for (number, pixel) in rows.into_iter().flatten() {
            if let Some(at) = place.get(&(number as usize)) {
                inside[*at].push(pixel);
            }
        }
        inside
    }
}

/// Numbers of polygons, in order, in groups with at most [`PIXELS_AT_ONCE`] pixels, or of one.
fn groups(counts: &[u64]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut sum = 0;
    for (number, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        sum += count;
        match groups.last_mut() {
            Some(group) if sum <= PIXELS_AT_ONCE => group.push(number),
            _ => {
                groups.push(vec![number]);
                sum = *count;
            }
        }
    }
    groups
}

/// A crossing of the border: between the centres (x, y) and (x + 1, y), or (x, y + 1) if it is `down`.
type Crossing = (i64, i64, bool);

/// Borders of a set of pixels, closed.
///
/// * `pixels`: numbers, ascending; `seen`: whether the area is seen at a position.
fn rings(pixels: &[u32], [width, height]: [usize; 2], seen: impl Fn(DVec2) -> bool + Sync) -> Vec<Vec<DVec2>> {
    let inside = |x: i64, y: i64| {
        let known = x >= 0 && y >= 0 && x < width as i64 && y < height as i64;
        known && pixels.binary_search(&((y as usize * width + x as usize) as u32)).is_ok()
    };
    let mut next: HashMap<Crossing, Crossing> = HashMap::new();
    let mut cells: Vec<(i64, i64)> = Vec::new();
    for &pixel in pixels {
        let (x, y) = ((pixel as usize % width) as i64, (pixel as usize / width) as i64);
        let beside = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];
        if beside.iter().all(|(dx, dy)| inside(x + dx, y + dy)) {
            continue;
        }
        cells.extend([(x - 1, y - 1), (x, y - 1), (x - 1, y), (x, y)]);
    }
    cells.sort_unstable();
    cells.dedup();
    for (x, y) in cells {
        let corners = [inside(x, y), inside(x + 1, y), inside(x + 1, y + 1), inside(x, y + 1)];
        let (top, right, bottom, left) = ((x, y, false), (x + 1, y, true), (x, y + 1, false), (x, y, true));
        let case = corners.iter().enumerate().fold(0, |case, (bit, corner)| case | (usize::from(*corner) << bit));
        // The inside lies on the left of the way.
        let ways: &[(Crossing, Crossing)] = match case {
            1 => &[(left, top)],
            2 => &[(top, right)],
            3 => &[(left, right)],
            4 => &[(right, bottom)],
            5 => &[(left, top), (right, bottom)],
            6 => &[(top, bottom)],
            7 => &[(left, bottom)],
            8 => &[(bottom, left)],
            9 => &[(bottom, top)],
            10 => &[(top, right), (bottom, left)],
            11 => &[(bottom, right)],
            12 => &[(right, left)],
            13 => &[(right, top)],
            14 => &[(top, left)],
            _ => &[],
        };
        next.extend(ways.iter().copied());
    }
    let place = |&(x, y, down): &Crossing| {
        let other = if down { (x, y + 1) } else { (x + 1, y) };
        let centre = |(x, y): (i64, i64)| DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        let (mut a, mut b) = (centre((x, y)), centre(other));
        let on_picture = |p: DVec2| p.cmpge(DVec2::ZERO).all() && p.x < width as f64 && p.y < height as f64;
        if !(on_picture(a) && on_picture(b)) {
            return 0.5 * (a + b);
        }
        let inside_at_a = inside(x, y);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (a + b);
            if seen(middle) == inside_at_a {
                a = middle;
            } else {
                b = middle;
            }
        }
        0.5 * (a + b)
    };
    let mut starts: Vec<Crossing> = next.keys().copied().collect();
    starts.sort_unstable();
    let mut loops: Vec<Vec<Crossing>> = Vec::new();
    for start in starts {
        let (mut ring, mut at) = (Vec::new(), start);
        while let Some(to) = next.remove(&at) {
            ring.push(at);
            at = to;
        }
        if ring.len() > 2 {
            ring.push(ring[0]);
            loops.push(ring);
        }
    }
    loops.par_iter().map(|ring| ring.par_iter().map(place).collect()).collect()
}

/// Signed area of a closed ring.
fn area(ring: &[DVec2]) -> f64 {
    0.5 * ring.windows(2).map(|pair| pair[0].perp_dot(pair[1])).sum::<f64>()
}

#[cfg(test)]
mod tests;
