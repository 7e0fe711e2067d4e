//! Vectors as features of a scene: projected to its system, clipped to the terrain and draped on it.

use super::{Geometry, VectorFeature, Vectors, Vertex};
use crate::crs::{CoordinateSystem, CrsError, Transform};
use crate::{Fault, IoError, Loaded};
use belvedere_core::polygon::doubled_area;
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{AreaFeature, Crs, Heightfield, LineFeature, PointFeature, drape_polyline};
use glam::{DVec2, DVec3};

/// Straight pieces of the source are cut to this length before they are projected, degrees: off by less than 0.1 m at 45 degrees.
const STEP_DEG: f64 = 0.02;
/// The same for projected sources, metres.
const STEP_M: f64 = 2000.0;
/// Mean radius of the earth, metres, for lengths that are only reported.
const EARTH_M: f64 = 6_371_008.8;

/// Features of a scene on its ground, and what of the file lies beyond it.
#[derive(Debug, Clone, PartialEq)]
pub struct OnGround<T> {
    /// The features.
    pub features: Vec<T>,
    /// What was cut off or left out because the ground ends or has no data there: length of lines, area of polygons, number of points, scene
    /// units; 0 without terrain.
    pub beyond: f64,
}

impl<T> std::ops::Deref for OnGround<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.features
    }
}

/// Lines of a scene from tracks, routes, lines and outlines of polygons; points are passed over.
///
/// Projected to the scene's system (long straight pieces of the source stay straight in the source), cut off where the terrain ends or has
/// voids (a line may fall into several), laid on its drawn surface. Without terrain the heights of the file are kept, 0 if it has
/// none. A line across the antimeridian takes the shorter arc. Warnings report what was cut off.
///
/// # Errors
/// [`IoError`]: no line in the file, nothing on the terrain (both extents are told), systems that cannot be joined.
pub fn lines_on_terrain(
    vectors: &Vectors,
    scene_crs: Crs,
    terrain: Option<&Heightfield>,
) -> Result<Loaded<OnGround<LineFeature>>, IoError> {
    let mut reprojection = Reprojection::new(vectors, scene_crs, terrain)?;
    let (mut features, mut lengths, mut lines_seen, mut lines_lost) = (Vec::new(), [0.0; 2], 0usize, 0usize);
    for feature in &vectors.features {
        for line in lines_of(feature) {
            lines_seen += 1;
            let before = features.len();
            let projected = reprojection.line(&line);
            lengths[0] += projected.dropped_m;
            lengths[1] += projected.dropped_m;
            for part in projected.parts {
                let parts = match terrain {
                    Some(terrain) => {
                        let flat: Vec<DVec2> = part.iter().map(|p| p.truncate()).collect();
                        let draped = drape_polyline(terrain, &flat);
                        lengths[0] += draped.length_m;
                        lengths[1] += draped.outside_m;
                        draped.parts
                    }
                    None => vec![without_repeats(part)],
                };
                let name = || feature.name.clone();
                features.extend(parts.into_iter().filter(|p| p.len() >= 2).map(|points| LineFeature {
                    style: feature.style,
                    name: name(),
                    points,
                }));
            }
            lines_lost += usize::from(features.len() == before);
        }
    }
    if lines_seen == 0 {
        return Err(vectors.fail("holds points only, no line; use it as a point layer (kind = \"point\")"));
    }
    if features.is_empty() {
        return Err(reprojection.all_outside("lines"));
    }
    let [length, outside] = lengths;
    if outside > 1e-3 * length {
        let text = format!(
            "{:.1} of {:.1} km ({:.0} %) lie outside the terrain or over its voids and were cut off, {lines_lost} of {lines_seen} lines wholly",
            outside / 1000.0,
            length / 1000.0,
            100.0 * outside / length
        );
        let warning = Warning::new(WarningKind::Ignored, text).with("outside_m", outside).with("length_m", length);
        reprojection.warn(warning.with("lines", lines_lost as f64).with("of", lines_seen as f64));
    }
    Ok(reprojection.done(OnGround { features, beyond: outside }))
}

/// Areas of a scene from polygons, one feature each: outer ring counter-clockwise, holes clockwise, for any orientation in the file.
/// Polygons that miss the terrain are dropped and counted; those that overlap it stay whole.
///
/// # Errors
/// [`IoError`]: no polygon in the file, nothing on the terrain (both extents are told), systems that cannot be joined.
pub fn areas_on_terrain(
    vectors: &Vectors,
    scene_crs: Crs,
    terrain: Option<&Heightfield>,
) -> Result<Loaded<OnGround<AreaFeature>>, IoError> {
    let mut reprojection = Reprojection::new(vectors, scene_crs, terrain)?;
    let ground = terrain.map(Heightfield::bounds);
    let (mut features, mut beyond, mut seen, mut outside, mut broken) = (Vec::new(), 0.0, 0usize, 0usize, 0usize);
    for feature in &vectors.features {
        let Geometry::Polygons(polygons) = &feature.geometry else { continue };
        for polygon in polygons {
            seen += 1;
            let mut rings: Vec<Vec<DVec2>> = Vec::new();
            for (k, ring) in polygon.iter().enumerate() {
                match reprojection.ring(ring) {
                    Some(mut ring) => {
                        if (doubled_area(&ring) < 0.0) == (k == 0) {
                            ring.reverse();
                        }
                        rings.push(ring);
                    }
                    None if k == 0 => break,
                    None => {}
                }
            }
            let Some(outer) = rings.first() else {
                broken += 1;
                continue;
            };
            let [lo, hi] = outer.iter().fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[l, h], &p| [l.min(p), h.max(p)]);
            let misses = ground.is_some_and(|g| hi.x < g.min.x || hi.y < g.min.y || lo.x > g.max.x || lo.y > g.max.y);
            if misses {
                outside += 1;
                // Holes run the other way round.
                beyond += 0.5 * rings.iter().map(|ring| doubled_area(ring)).sum::<f64>();
            } else {
                features.push(AreaFeature { style: feature.style, name: feature.name.clone(), rings });
            }
        }
    }
    if seen == 0 {
        return Err(vectors.fail("holds no polygon; use it as a line or point layer"));
    }
    if features.is_empty() {
        return Err(reprojection.all_outside("areas"));
    }
    if outside + broken > 0 {
        let text = format!("{} of {seen} areas lie outside the terrain and were dropped", outside + broken);
        reprojection.lost(text, outside + broken, seen);
    }
    Ok(reprojection.done(OnGround { features, beyond }))
}

/// Points of a scene from waypoints and points, on the ground. Points outside the terrain or on voids are dropped and counted.
/// Without terrain the heights of the file are kept, 0 if it has none.
///
/// # Errors
/// [`IoError`]: no point in the file, nothing on the terrain (both extents are told), systems that cannot be joined.
pub fn points_on_terrain(
    vectors: &Vectors,
    scene_crs: Crs,
    terrain: Option<&Heightfield>,
) -> Result<Loaded<OnGround<PointFeature>>, IoError> {
    let mut reprojection = Reprojection::new(vectors, scene_crs, terrain)?;
    let (mut features, mut seen) = (Vec::new(), 0usize);
    for feature in &vectors.features {
        let Geometry::Points(points) = &feature.geometry else { continue };
        for v in points {
            seen += 1;
            let Some(xy) = reprojection.project(v.xy) else { continue };
            reprojection.include(xy);
            let z = match terrain {
                Some(terrain) => terrain.surface_at(xy),
                None => Some(v.z.unwrap_or(0.0)),
            };
            features.extend(z.map(|z| PointFeature {
                style: feature.style,
                name: feature.name.clone(),
                position: xy.extend(z),
            }));
        }
    }
    if seen == 0 {
        return Err(vectors.fail("holds no point; use it as a line or area layer"));
    }
    if features.is_empty() {
        return Err(reprojection.all_outside("points"));
    }
    let lost = seen - features.len();
    if lost > 0 {
        let text = format!("{lost} of {seen} points lie outside the terrain or on its voids and were dropped");
        reprojection.lost(text, lost, seen);
    }
    Ok(reprojection.done(OnGround { features, beyond: lost as f64 }))
}

impl Vectors {
    fn fail(&self, reason: impl std::fmt::Display) -> IoError {
        IoError::format(&self.path, format!("{} {reason}", self.format))
    }
}

/// Lines of a feature: segments that meet end to end joined, outlines closed.
fn lines_of(feature: &VectorFeature) -> Vec<Vec<Vertex>> {
    match &feature.geometry {
        Geometry::Points(_) => Vec::new(),
        Geometry::Lines(lines) => {
            let mut joined: Vec<Vec<Vertex>> = Vec::new();
            for line in lines {
                match joined.last_mut() {
                    Some(last) if last.last().map(|v| v.xy) == line.first().map(|v| v.xy) => {
                        last.extend(line.iter().skip(1))
                    }
                    _ => joined.push(line.clone()),
                }
            }
            joined
        }
        Geometry::Polygons(polygons) => {
            polygons.iter().flatten().map(|ring| ring.iter().chain(ring.first()).copied().collect()).collect()
        }
    }
}

fn without_repeats(mut line: Vec<DVec3>) -> Vec<DVec3> {
    line.dedup_by(|a, b| a.truncate().distance(b.truncate()) <= 1e-6);
    line
}

/// A line in the scene's system.
struct Projected {
    parts: Vec<Vec<DVec3>>,
    /// Length that was not projected because it lies far from the terrain, metres.
    dropped_m: f64,
}

/// Projection from the file's coordinate system to the scene's; collects the extent of the results and warnings.
struct Reprojection<'a> {
    vectors: &'a Vectors,
    terrain: Option<&'a Heightfield>,
    scene_crs: Crs,
    transform: Option<Transform>,
    /// Longitude around which longitudes are unwrapped, degrees.
    near_lon: Option<f64>,
    /// Box around the terrain in the source's system: only positions inside are projected.
    near: Option<[DVec2; 2]>,
    extent: Option<[DVec2; 2]>,
    warnings: Vec<Warning>,
}

impl<'a> Reprojection<'a> {
    fn new(vectors: &'a Vectors, scene_crs: Crs, terrain: Option<&'a Heightfield>) -> Result<Self, IoError> {
        let first = vectors.features.iter().find_map(|f| f.geometry.vertices().next()).map_or(DVec2::ZERO, |v| v.xy);
        let fail = |e: CrsError| {
            let at = if e == CrsError::Unstated {
                format!(" (the first is at {}, {})", first.x, first.y)
            } else {
                String::new()
            };
            vectors.fail(format!("cannot be brought to {scene_crs}{at}: {e}"))
        };
        let mut reprojection = Self {
            vectors,
            terrain,
            scene_crs,
            transform: None,
            near_lon: None,
            near: None,
            extent: None,
            warnings: Vec::new(),
        };
        match CoordinateSystem::from_scene(scene_crs) {
            Err(CrsError::Local) if vectors.crs.is_local() && vectors.crs_stated => {}
            Err(CrsError::Local) if !vectors.crs.is_geographic() || reprojection.could_be_local() => {
                let text = "coordinates are taken as they are, for the scene has no coordinate system";
                reprojection.warn(Warning::new(WarningKind::Assumed, text));
            }
            Err(CrsError::Local) => {
                let reason = format!(
                    "{} is in longitude and latitude, but the scene has no coordinate system; state that of the terrain as source_crs of its layer",
                    vectors.format
                );
                return Err(IoError::format(&vectors.path, Fault::lifted_by(reason, &["source_crs"])));
            }
            Err(e) => return Err(fail(e)),
            Ok(system) => reprojection.transform = Some(Transform::new(&vectors.crs, &system).map_err(fail)?),
        }
        reprojection
            .warnings
            .extend(reprojection.transform.iter().filter(|t| !t.is_identity()).filter_map(|t| t.from().datum_note()));
        reprojection.near_lon = if reprojection.transform.is_some() && vectors.crs.is_geographic() {
            reprojection.middle_lon()
        } else {
            None
        };
        reprojection.near = reprojection.surroundings();
        Ok(reprojection)
    }

    /// Whether coordinates of an unstated system overlap the terrain as they are.
    fn could_be_local(&self) -> bool {
        let (Some(ground), Some([lo, hi])) = (self.terrain.map(Heightfield::bounds), self.vectors.extent()) else {
            return false;
        };
        let meets = hi.cmpge(ground.min.truncate()).all() && lo.cmple(ground.max.truncate()).all();
        !self.vectors.crs_stated && meets
    }

    fn warn(&mut self, warning: Warning) {
        self.warnings.push(warning.in_file(&self.vectors.path));
    }

    /// Warns of `count` features of `of` that were dropped.
    fn lost(&mut self, text: String, count: usize, of: usize) {
        self.warn(Warning::new(WarningKind::Ignored, text).with("count", count as f64).with("of", of as f64));
    }

    fn done<T>(self, value: T) -> Loaded<T> {
        Loaded::new(value, self.warnings)
    }

    fn middle_lon(&self) -> Option<f64> {
        let middle = self.terrain.map(|t| t.bounds().center().truncate());
        let from_terrain = middle.and_then(|xy| self.transform.as_ref()?.inverse_one(xy)).map(|p| p.x);
        from_terrain.or_else(|| self.vectors.features.iter().find_map(|f| f.geometry.vertices().next().map(|v| v.xy.x)))
    }

    /// The terrain's extent in the source's system, grown by half its size on all sides; `None` = everything is projected.
    fn surroundings(&self) -> Option<[DVec2; 2]> {
        let transform = self.transform.as_ref().filter(|t| !t.is_identity())?;
        let bounds = self.terrain?.bounds();
        let mut near: Option<[DVec2; 2]> = None;
        for i in 0..=16 {
            for j in 0..=16 {
                let t = DVec2::new(f64::from(i), f64::from(j)) / 16.0;
                let xy = bounds.min.truncate() + t * (bounds.max - bounds.min).truncate();
                let p = self.bring_near(transform.inverse_one(xy)?);
                near = Some(near.map_or([p; 2], |[lo, hi]| [lo.min(p), hi.max(p)]));
            }
        }
        near.map(|[lo, hi]| {
            let grow = 0.5 * (hi - lo) + DVec2::splat(2.0 * self.step());
            [lo - grow, hi + grow]
        })
    }

    /// Longest piece of the source projected as one, source units.
    fn step(&self) -> f64 {
        self.vectors.crs.metres_per_unit().map_or(STEP_DEG, |m| STEP_M / m)
    }

    /// The same position with a longitude at most 180 degrees from the middle of the terrain.
    fn bring_near(&self, p: DVec2) -> DVec2 {
        match self.near_lon {
            Some(middle) => DVec2::new(middle + (p.x - middle + 180.0).rem_euclid(360.0) - 180.0, p.y),
            None => p,
        }
    }

    fn project(&self, p: DVec2) -> Option<DVec2> {
        match &self.transform {
            None => Some(p),
            Some(t) if t.is_identity() => Some(p),
            Some(t) => {
                let lon_in_range = |p: DVec2| DVec2::new((p.x + 180.0).rem_euclid(360.0) - 180.0, p.y);
                t.forward_one(if self.near_lon.is_some() { lon_in_range(p) } else { p })
            }
        }
    }

    fn include(&mut self, xy: DVec2) {
        self.extent = Some(self.extent.map_or([xy; 2], |[lo, hi]| [lo.min(xy), hi.max(xy)]));
    }

    /// Vertices of a line with continuous longitudes, shifted by full turns as near to the terrain as possible.
    fn unwrapped(&self, line: &[Vertex]) -> Vec<Vertex> {
        let mut out = line.to_vec();
        let Some(middle) = self.near_lon else { return out };
        for k in 1..out.len() {
            let before = out[k - 1].xy.x;
            out[k].xy.x = before + (out[k].xy.x - before + 180.0).rem_euclid(360.0) - 180.0;
        }
        let away = |v: &Vertex, turn: f64| (v.xy.x + turn - middle).abs();
        let turns = [0.0, 360.0, -360.0, 720.0, -720.0];
        let nearest = |turn: f64| out.iter().map(|v| away(v, turn)).fold(f64::INFINITY, f64::min);
        let turn = turns.into_iter().min_by(|a, b| nearest(*a).total_cmp(&nearest(*b))).unwrap_or(0.0);
        out.iter_mut().for_each(|v| v.xy.x += turn);
        out
    }

    /// Positions along a piece of the source, without its first.
    fn pieces(&self, a: DVec2, b: DVec2) -> usize {
        let far = self.near.is_some_and(|[lo, hi]| {
            let (min, max) = (a.min(b), a.max(b));
            max.cmplt(lo).any() || min.cmpgt(hi).any()
        });
        let same = self.transform.as_ref().is_none_or(Transform::is_identity);
        if far || same { 1 } else { (a.distance(b) / self.step()).ceil().clamp(1.0, 40_000.0) as usize }
    }

    fn metres_between(&self, a: DVec2, b: DVec2) -> f64 {
        match self.vectors.crs.metres_per_unit() {
            Some(m) => m * a.distance(b),
            None => {
                let d = (b - a) * DVec2::new((0.5 * (a.y + b.y)).to_radians().cos(), 1.0);
                d.length().to_radians() * EARTH_M
            }
        }
    }

    fn line(&mut self, line: &[Vertex]) -> Projected {
        let line = self.unwrapped(line);
        let mut out = Projected { parts: Vec::new(), dropped_m: 0.0 };
        let mut part: Vec<DVec3> = Vec::new();
        let mut previous: Option<(DVec2, bool)> = None;
        let near = self.near;
        let mut visit = |reprojection: &mut Self, xy: DVec2, z: f64| {
            let inside = near.is_none_or(|[lo, hi]| xy.cmpge(lo).all() && xy.cmple(hi).all());
            let projected = reprojection.project(xy);
            if let Some(p) = projected {
                reprojection.include(p);
            }
            let kept = projected.filter(|_| inside);
            if let Some((from, was_kept)) = previous
                && !(was_kept && kept.is_some())
            {
                out.dropped_m += reprojection.metres_between(from, xy);
            }
            match kept {
                Some(p) => part.push(p.extend(z)),
                None if part.len() >= 2 => out.parts.push(std::mem::take(&mut part)),
                None => part.clear(),
            }
            previous = Some((xy, kept.is_some()));
        };
        if let Some(first) = line.first() {
            visit(self, first.xy, first.z.unwrap_or(0.0));
        }
        for w in line.windows(2) {
            let count = self.pieces(w[0].xy, w[1].xy);
            let (z0, z1) = (w[0].z.unwrap_or(0.0), w[1].z.unwrap_or(0.0));
            for k in 1..=count {
                let t = k as f64 / count as f64;
                visit(self, w[0].xy.lerp(w[1].xy, t), z0 + t * (z1 - z0));
            }
        }
        if part.len() >= 2 {
            out.parts.push(part);
        }
        out
    }

    /// A ring in the scene's system; `None` if a vertex cannot be projected or fewer than 3 remain.
    fn ring(&mut self, ring: &[Vertex]) -> Option<Vec<DVec2>> {
        let closed: Vec<Vertex> = ring.iter().chain(ring.first()).copied().collect();
        let closed = self.unwrapped(&closed);
        let mut out = Vec::new();
        for w in closed.windows(2) {
            let count = self.pieces(w[0].xy, w[1].xy);
            for k in 0..count {
                let xy = self.project(w[0].xy.lerp(w[1].xy, k as f64 / count as f64))?;
                self.include(xy);
                out.push(xy);
            }
        }
        out.dedup_by(|a, b| a.distance(*b) <= 1e-6);
        (out.len() >= 3).then_some(out)
    }

    fn all_outside(&self, what: &str) -> IoError {
        let crs = self.scene_crs;
        let theirs = match self.extent {
            Some([lo, hi]) => {
                format!("their extent in {crs} is x {:.0}..{:.0}, y {:.0}..{:.0}", lo.x, hi.x, lo.y, hi.y)
            }
            None => format!("they cannot be projected to {crs}"),
        };
        let ours = self.terrain.map_or(String::new(), |t| {
            let b = t.bounds();
            format!(", the terrain's is x {:.0}..{:.0}, y {:.0}..{:.0}", b.min.x, b.max.x, b.min.y, b.max.y)
        });
        let advice = if self.swapped_meet() {
            "with x and y exchanged they lie on it, so their axes are swapped; exchange them, as with ogr2ogr -swapxy"
        } else {
            "take data that overlap"
        };
        self.vectors
            .fail(format!("lies wholly outside the terrain or over its voids: {what}: {theirs}{ours}; {advice}"))
    }

    /// Whether some position would lie on the terrain if x and y were exchanged.
    fn swapped_meet(&self) -> bool {
        let Some(bounds) = self.terrain.map(Heightfield::bounds) else { return false };
        let on_terrain = |v: &Vertex| {
            let swapped = DVec2::new(v.xy.y, v.xy.x);
            let place = self.transform.as_ref().map_or(Some(swapped), |t| t.forward_one(swapped));
            place.is_some_and(|p| p.cmpge(bounds.min.truncate()).all() && p.cmple(bounds.max.truncate()).all())
        };
        self.vectors.features.iter().flat_map(|f| f.geometry.vertices()).take(10_000).any(on_terrain)
    }
}
