//! Classes of lines: what the lines of a layer are, how they are drawn for it, and the cables of lifts.

use belvedere_composite::marks::simplified;
use belvedere_core::{DVec2, DVec3};
use belvedere_document::{LineDoc, LineStyleDoc};
use belvedere_io::vector::{Geometry, Vectors, line_kind, line_words};
use belvedere_scene::{FeatureStyle, LineClass, LineFeature};

/// Height of the cables of a lift over the ground where they touch a pylon, metres.
const PYLON_M: f64 = 10.0;
/// Largest distance of cables from the course of the file in plan, and from the tightest ones in height, metres.
const STRAIGHT_M: f64 = 10.0;
const TIGHT_M: f64 = 3.0;

/// Gives the lines of a file their class and its look. What must be seen keeps the look of the layer where its class is a way.
pub(super) fn tell(layer: &LineDoc, file: &mut Vectors) {
    let stem = file.path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let of_file = || line_words(&file.layer).or_else(|| line_words(&stem)).or_else(|| line_words(&layer.id));
    let tagged: Vec<Option<LineClass>> = file.features.iter().map(|f| line_kind(&f.properties)).collect();
    let of_file = if tagged.iter().all(Option::is_none) { of_file() } else { None };
    for (feature, tagged) in file.features.iter_mut().zip(tagged) {
        let is_line = matches!(feature.geometry, Geometry::Lines(_));
        // Rims of areas are lines of nothing but borders.
        let found = tagged.or(of_file).filter(|class| is_line || *class == LineClass::Border);
        let found = found.filter(|class| !(layer.must_see && class.is_way()));
        if let Some(class) = layer.style.class.or(found) {
            dress(layer, class, &mut feature.style);
        }
    }
}

/// Gives lines that are of no file the class that their layer states.
pub(super) fn tell_stated(layer: &LineDoc, features: &mut [LineFeature]) {
    let Some(class) = layer.style.class else { return };
    features.iter_mut().for_each(|feature| dress(layer, class, &mut feature.style));
}

/// The style of a line of a class: colour, width and casing of the class where the layer states none. What must be seen is never thinner
/// than the lines of its layer.
fn dress(layer: &LineDoc, class: LineClass, style: &mut Option<FeatureStyle>) {
    if class == LineClass::Route {
        return;
    }
    let (stated, usual, look) = (&layer.style, LineStyleDoc::default(), class.look());
    let own = style.get_or_insert_default();
    own.class = Some(class);
    if stated.color == usual.color && stated.color_by.is_none() {
        own.color = Some(look.color);
        own.casing = (stated.casing == usual.casing).then_some(look.casing);
    }
    if stated.width_px == usual.width_px && stated.width_by.is_none() {
        let scale = look.width_px / stated.width_px;
        own.scale = if layer.must_see { scale.max(1.0) } else { scale };
    }
}

/// Gives lifts their cables in place of the ground below them.
pub(super) fn stretch_cables(features: &mut [LineFeature]) {
    let is_lift = |f: &&mut LineFeature| f.style.is_some_and(|own| own.class == Some(LineClass::Lift));
    features.iter_mut().filter(is_lift).for_each(|lift| lift.points = cable(&lift.points));
}

/// The tightest cable over the ground: straight in plan between the corners of its course, and over each stretch the upper convex hull of
/// the ground and the height of pylons. Its vertices are the pylons.
///
/// * `ground`: points on the ground, scene coordinates.
fn cable(ground: &[DVec3]) -> Vec<DVec3> {
    let plan: Vec<DVec2> = ground.iter().map(|p| p.truncate()).collect();
    let corners = simplified(&plan, STRAIGHT_M);
    let mut out: Vec<DVec3> = Vec::new();
    let mut next = 0;
    for ends in corners.windows(2) {
        let Some(end) = plan[next..].iter().skip(1).position(|p| *p == ends[1]).map(|i| next + 1 + i) else { break };
        let [from, way] = [ends[0], ends[1] - ends[0]];
        let along = |p: &DVec3| (p.truncate() - from).dot(way) / way.length().max(1e-9);
        let profile = ground[next..=end].iter().map(|p| DVec2::new(along(p), p.z + PYLON_M));
        let tight = simplified(&hull(profile), TIGHT_M);
        let unit = way.normalize_or_zero();
        let placed = tight.into_iter().map(|p| (from + p.x * unit).extend(p.y));
        out.extend(placed.skip(usize::from(!out.is_empty())));
        next = end;
    }
    if out.len() < 2 { ground.to_vec() } else { out }
}

/// The upper convex hull of points with rising x.
fn hull(points: impl Iterator<Item = DVec2>) -> Vec<DVec2> {
    let mut hull: Vec<DVec2> = Vec::new();
    for p in points {
        while let [.., a, b] = hull[..]
            && (b - a).perp_dot(p - a) >= 0.0
        {
            hull.pop();
        }
        hull.push(p);
    }
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cables_are_straight_over_valleys_and_touch_no_ground() {
        // A valley of 300 m between 0 and 2000 m, then a brow.
        let height = |x: f64| match x {
            x if x < 2000.0 => 1000.0 - 300.0 * (x / 2000.0 * std::f64::consts::PI).sin(),
            x => 1000.0 + 150.0 * ((x - 2000.0) / 1000.0 * std::f64::consts::PI).sin(),
        };
        let ground: Vec<DVec3> =
            (0..=300).map(|i| DVec3::new(10.0 * f64::from(i), 0.0, height(10.0 * f64::from(i)))).collect();
        let cable = cable(&ground);
        let at = |x: f64| {
            let pair = cable.windows(2).find(|pair| (pair[0].x..=pair[1].x).contains(&x)).expect("covered");
            pair[0].z + (x - pair[0].x) / (pair[1].x - pair[0].x) * (pair[1].z - pair[0].z)
        };
        for p in &ground {
            assert!(at(p.x) >= p.z + PYLON_M - TIGHT_M - 1e-6, "{p}: {}", at(p.x));
        }
        assert!(at(1000.0) > 1000.0, "300 m over the valley: {}", at(1000.0));
        assert!((4..20).contains(&cable.len()), "pylons on the brow alone: {cable:?}");
        assert_eq!((cable[0].x, cable[cable.len() - 1].x), (0.0, 3000.0));
    }

    #[test]
    fn corners_of_a_course_stay() {
        let bent: Vec<DVec3> = (0..=20)
            .map(|i| f64::from(i) * 50.0)
            .map(|s| if s <= 500.0 { DVec3::new(s, 0.0, 0.0) } else { DVec3::new(500.0, s - 500.0, 0.0) })
            .collect();
        let found = cable(&bent);
        let wanted = [[0.0, 0.0], [500.0, 0.0], [500.0, 500.0]].map(|[x, y]| DVec3::new(x, y, PYLON_M));
        assert!(found.len() == 3 && found.iter().zip(wanted).all(|(a, b)| a.distance(b) < 1e-6), "{found:?}");
    }
}
