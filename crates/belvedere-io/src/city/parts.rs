//! Buildings of OpenStreetMap with their parts: raised parts, roofs on posts, and underground buildings.
//! Source: OpenStreetMap Wiki, "Simple 3D Buildings".

use super::attributes::{self, Attributes, length_m};
use super::plan::Repairs;
use super::roofs::{Heights, Roof, solid};
use belvedere_core::polygon::is_inside;
use belvedere_scene::{Building, Polygon};
use glam::DVec2;

/// Height of a storey below a raised part, metres.
const STOREY_M: f64 = 3.0;
/// Thickness of roofs that stand on posts, metres.
const CANOPY_M: f64 = 0.4;

/// A building or a part of one as it is tagged.
pub(super) struct Tagged {
    pub(super) building: Building,
    /// Whether it is a part of a building.
    pub(super) part: bool,
    heights: Heights,
    roof: Roof,
}

/// Whether the tags say that an object lies underground.
pub(super) fn is_underground(about: &impl Attributes) -> bool {
    let is = |key: &str, value: &str| about.text(key).is_some_and(|v| v.eq_ignore_ascii_case(value));
    is("location", "underground") || is("building", "underground") || is("building:part", "underground")
}

impl Tagged {
    /// A building or part with this footprint.
    pub(super) fn new(
        id: String,
        about: &impl Attributes,
        footprint: Vec<Polygon>,
        part: bool,
        repairs: &mut Repairs,
    ) -> Self {
        let (mut height_m, height_source) = attributes::height(about, repairs);
        let roof = Roof::of(about, length_m);
        let mut rise = 0.0;
        if roof.is_pitched() {
            rise = roof.rise.unwrap_or_else(|| roof.usual_rise(&footprint, height_m));
            // Storeys reach up to the eaves, stated heights up to the top.
            if height_source != belvedere_scene::HeightSource::Stated {
                height_m += rise;
            }
            rise = rise.min(height_m);
        }
        let kind = about.text("building").or_else(|| about.text("building:part")).unwrap_or_default();
        let mut under = under(about).unwrap_or(if kind == "roof" { height_m - rise - CANOPY_M } else { 0.0 });
        if !(0.0..height_m).contains(&under) {
            repairs.heights += usize::from(under >= height_m);
            under = 0.0;
        }
        let heights = Heights { under, eaves: (height_m - rise).max(under), top: height_m };
        let name = attributes::name(about);
        let landmark = attributes::is_landmark(about);
        let faces = Vec::new();
        let building = Building { id, name, landmark, footprint, base_m: None, height_m, height_source, faces };
        Self { building, part, heights, roof }
    }

    /// Whether it has a raised underside or a pitched roof.
    fn is_shaped(&self) -> bool {
        self.heights.under > 0.0 || self.roof.is_pitched()
    }

    fn solids(&self) -> impl Iterator<Item = belvedere_scene::CityFace> {
        self.building.footprint.iter().flat_map(|p| solid(p, self.heights, &self.roof))
    }
}

/// Height of the underside over the ground, metres, if the tags state it.
fn under(about: &impl Attributes) -> Option<f64> {
    let height = ["min_height", "building:min_height"].iter().find_map(|k| about.text(k));
    let level = ["building:min_level", "min_level"].iter().find_map(|k| about.text(k));
    let by_level = || Some(STOREY_M * attributes::number(&level?)?);
    height.as_deref().and_then(length_m).or_else(by_level).filter(|h| h.is_finite() && *h > 0.0)
}

/// Buildings whose parts replace their outlines, and the number of parts.
pub(super) fn assembled(tagged: Vec<Tagged>) -> (Vec<Building>, usize) {
    let (parts, outlines): (Vec<Tagged>, Vec<Tagged>) = tagged.into_iter().partition(|t| t.part);
    let count = parts.len();
    let mut of: Vec<Vec<Tagged>> = outlines.iter().map(|_| Vec::new()).collect();
    let boxes: Vec<[DVec2; 2]> = outlines.iter().map(|o| extent(&o.building.footprint)).collect();
    let mut alone = Vec::new();
    for part in parts {
        let inside = inner_point(&part.building.footprint);
        let around = inside.and_then(|p| {
            let boxed = |k: &usize| p.cmpge(boxes[*k][0]).all() && p.cmple(boxes[*k][1]).all();
            (0..outlines.len()).filter(boxed).find(|k| holds(&outlines[*k].building.footprint, p))
        });
        match around {
            Some(k) => of[k].push(part),
            None => alone.push(part),
        }
    }
    let mut out = Vec::new();
    for (mut outline, parts) in outlines.into_iter().zip(of) {
        if parts.is_empty() {
            if outline.is_shaped() {
                outline.building.faces = outline.solids().collect();
            }
        } else {
            let building = &mut outline.building;
            building.faces = parts.iter().flat_map(Tagged::solids).collect();
            let tallest = parts.iter().map(|p| p.heights.top).fold(0.0, f64::max);
            (building.height_m, building.height_source) = (tallest, parts[0].building.height_source);
            building.landmark |= parts.iter().any(|p| p.building.landmark);
        }
        out.push(outline.building);
    }
    for mut part in alone {
        if part.is_shaped() {
            part.building.faces = part.solids().collect();
        }
        out.push(part.building);
    }
    (out, count)
}

fn extent(polygons: &[Polygon]) -> [DVec2; 2] {
    let all = polygons.iter().flat_map(|p| &p.outer);
    all.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[lo, hi], p| [lo.min(*p), hi.max(*p)])
}

fn holds(polygons: &[Polygon], p: DVec2) -> bool {
    let within =
        |polygon: &Polygon| is_inside([&polygon.outer], p) && !polygon.holes.iter().any(|hole| is_inside([hole], p));
    polygons.iter().any(within)
}

/// A point within the first polygon: the middle of a triangle of its corners that lies in it.
fn inner_point(polygons: &[Polygon]) -> Option<DVec2> {
    let polygon = polygons.first()?;
    let ring = &polygon.outer;
    let middle = |k: usize| {
        let n = ring.len();
        (ring[k] + ring[(k + 1) % n] + ring[(k + 2) % n]) / 3.0
    };
    let centre = ring.iter().sum::<DVec2>() / ring.len().max(1) as f64;
    std::iter::once(centre).chain((0..ring.len()).map(middle)).find(|p| holds(&polygons[..1], *p))
}
