//! Lengths between points that a user sets: along the ground, straight, up and down, and the area in plan.

use belvedere::core::{DVec2, DVec3};
use belvedere::io::crs::Transform;
use belvedere::scene::{Crs, Heightfield, Scene, Unit};
use serde_json::{Value, json};

/// EPSG code of longitude and latitude.
const WGS84: u32 = 4326;
/// Points of a height profile, at most.
const PROFILE: usize = 400;

/// Lengths of a chain of points, scene units.
#[derive(Debug, Clone, PartialEq)]
pub struct Lengths {
    /// Along the ground below the points, over the true surface as it is drawn unbent: two triangles in each cell. `None` where the
    /// scene has no ground below the whole chain.
    pub along_ground: Option<f64>,
    /// Sum of the straight distances from point to point.
    pub straight: f64,
    /// Upwards and downwards along the ground; without ground from point to point.
    pub climb: f64,
    /// See `climb`; positive.
    pub descent: f64,
    /// Area in plan of the ring of three points or more, square scene units; of a ring that crosses itself the parts count with the sign
    /// of their turn. `None` for fewer points, and in scenes without a plan (molecules, volumes).
    pub area: Option<f64>,
    /// Distance in plan from the first point and height, at most 400 points along the ground, or the points themselves without ground.
    pub profile: Vec<[f64; 2]>,
}

/// The lengths of a chain of points on or above the ground of a scene.
pub fn lengths(scene: &Scene, points: &[DVec3]) -> Lengths {
    let way = scene.terrain().and_then(|ground| ground_way(ground, points));
    let walked = way.as_deref().unwrap_or(points);
    let rise = |pair: &[DVec3]| pair[1].z - pair[0].z;
    let climb = walked.windows(2).map(|pair| rise(pair).max(0.0)).sum();
    let descent = walked.windows(2).map(|pair| (-rise(pair)).max(0.0)).sum();
    let is_ring = points.len() >= 3 && scene.unit == Unit::Metre;
    Lengths {
        along_ground: way.as_deref().map(length),
        straight: length(points),
        climb,
        descent,
        area: is_ring.then(|| area(points)),
        profile: profile(walked),
    }
}

fn length(points: &[DVec3]) -> f64 {
    points.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}

/// Area in plan of a ring that closes itself.
fn area(points: &[DVec3]) -> f64 {
    let first = points[0].truncate();
    let fan = points.windows(2).map(|pair| (pair[0].truncate() - first).perp_dot(pair[1].truncate() - first));
    0.5 * fan.sum::<f64>().abs()
}

/// The way over the drawn ground below a chain of points: a vertex wherever it crosses an edge of a triangle. `None` if the ground has a
/// gap below it.
pub fn ground_way(ground: &Heightfield, points: &[DVec3]) -> Option<Vec<DVec3>> {
    let on_ground = |xy: DVec2| ground.surface_at(xy).map(|z| xy.extend(z));
    let mut way = vec![on_ground(points.first()?.truncate())?];
    for pair in points.windows(2) {
        let [a, b] = [pair[0].truncate(), pair[1].truncate()];
        for t in crossings(ground, a, b) {
            way.push(on_ground(a.lerp(b, t))?);
        }
        way.push(on_ground(b)?);
    }
    Some(way)
}

/// Shares of the way from `a` to `b` at which it crosses columns, rows and diagonals of the grid, rising.
fn crossings(ground: &Heightfield, a: DVec2, b: DVec2) -> Vec<f64> {
    let [from, to] = [a, b].map(|p| ground.grid_from_scene(p));
    let families = [[from.x, to.x], [from.y, to.y], [from.x - from.y, to.x - to.y]];
    let mut shares = Vec::new();
    for [from, to] in families {
        let (low, high) = (from.min(to).ceil(), from.max(to).floor());
        let most = (ground.cols() + ground.rows()) as f64;
        if high - low > 2.0 * most {
            continue;
        }
        let mut k = low;
        while k <= high {
            let t = (k - from) / (to - from);
            if t > 0.0 && t < 1.0 {
                shares.push(t);
            }
            k += 1.0;
        }
    }
    shares.sort_by(f64::total_cmp);
    shares
}

/// Distance in plan and height, thinned where there are too many points; first and last stay.
fn profile(way: &[DVec3]) -> Vec<[f64; 2]> {
    let mut along = 0.0;
    let mut last: Option<DVec3> = None;
    let all = way.iter().map(|p| {
        along += last.map_or(0.0, |last| last.truncate().distance(p.truncate()));
        last = Some(*p);
        [along, p.z]
    });
    let all: Vec<[f64; 2]> = all.collect();
    if all.len() <= PROFILE {
        return all;
    }
    let at = |k: usize| all[k * (all.len() - 1) / (PROFILE - 1)];
    (0..PROFILE).map(at).collect()
}

/// The chain as GeoJSON with its lengths as properties: a line, or the ring of three points and more where `closed`. Longitude and
/// latitude (WGS84) with heights where the scene is georeferenced, as GeoJSON requires; else scene coordinates.
pub fn lengths_geojson(scene: &Scene, points: &[DVec3], closed: bool) -> Value {
    let from_degrees = match scene.crs {
        Crs::Local => None,
        Crs::Epsg(code) => Transform::between_epsg(WGS84, code).ok(),
    };
    let geographic: Option<Vec<[f64; 3]>> = from_degrees.and_then(|from_degrees| {
        let place = |p: &DVec3| {
            from_degrees.inverse_one(p.truncate()).map(|lon_lat| [rounded(lon_lat.x), rounded(lon_lat.y), p.z])
        };
        points.iter().map(place).collect()
    });
    let system = if geographic.is_some() { "OGC:CRS84".to_owned() } else { scene.crs.to_string() };
    let mut chain = geographic.unwrap_or_else(|| points.iter().map(|p| p.to_array()).collect());
    let closes = closed && points.len() >= 3;
    let geometry = match chain.as_slice() {
        [one] => json!({ "type": "Point", "coordinates": one }),
        _ if closes => {
            // The outer ring turns counter-clockwise.
            let first = points[0].truncate();
            let fan = points.windows(2).map(|pair| (pair[0].truncate() - first).perp_dot(pair[1].truncate() - first));
            if fan.sum::<f64>() < 0.0 {
                chain.reverse();
            }
            chain.push(chain[0]);
            json!({ "type": "Polygon", "coordinates": [chain] })
        }
        _ => json!({ "type": "LineString", "coordinates": chain }),
    };
    let of = lengths(scene, points);
    let unit = match scene.unit {
        Unit::Metre => "metre",
        Unit::Angstrom => "angstrom",
        Unit::Voxel => "voxel",
    };
    let properties = json!({
        "unit": unit,
        "crs": system,
        "along_ground": of.along_ground,
        "straight": of.straight,
        "climb": of.climb,
        "descent": of.descent,
        "area_in_plan": of.area,
    });
    json!({ "type": "FeatureCollection", "features": [{ "type": "Feature", "geometry": geometry, "properties": properties }] })
}

/// Degrees to about 0.1 mm.
fn rounded(degrees: f64) -> f64 {
    (1e9 * degrees).round() / 1e9
}

#[cfg(test)]
mod tests;
