//! Ghosts of required features at their straight image: a box or a dashed line there, and a leader to the bent image.

use belvedere_composite::canvas::Canvas;
use belvedere_core::{Aabb, DVec2, DVec3, View};
use belvedere_scene::{Color, Layer, LayerKind, MeshLayer, OwnLayer, Scene};
use serde::Serialize;

/// Widths of rim and line, pixels of a picture 720 high.
const WIDTHS: [f64; 2] = [4.0, 1.8];
/// Colours of rim and line.
pub(super) const COLORS: [Color; 2] = [Color::rgb(255, 255, 255), Color::rgb(20, 40, 150)];
/// Length of dashes and gaps, pixels of a picture 720 high.
const DASH: f64 = 7.0;
/// Largest number of points of a layer with leaders of their own.
const MOST_POINTS: usize = 32;

/// Bent and straight position of a required layer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GhostRecord {
    /// Id of the layer.
    pub layer: String,
    /// Start of the leader: the bent image of the middle of the layer, or of the point of a line that moved farthest, pixels.
    pub bent_px: Option<[f64; 2]>,
    /// End of the leader: the straight image of the same point, pixels.
    pub straight_px: Option<[f64; 2]>,
    /// Distance between them, pixels.
    pub shift_px: Option<f64>,
}

/// Drawing of one layer.
struct Ghost {
    layer: String,
    /// Polylines in the straight picture, pixels.
    lines: Vec<Vec<DVec2>>,
    /// Bent and straight images of points, that of the record first.
    leaders: Vec<[Option<DVec2>; 2]>,
}

/// Draws the ghosts; returns their positions.
pub(super) fn draw(canvas: &mut Canvas<'_>, scene: &Scene, bent: &View, straight: &View) -> Vec<GhostRecord> {
    let ghosts: Vec<Ghost> = scene.must_see().filter_map(|(_, layer)| ghost(layer, bent, straight)).collect();
    let (scale, size) = (super::scale(canvas), canvas.size());
    for (width, color) in WIDTHS.map(|w| w * scale).into_iter().zip(COLORS) {
        for ghost in &ghosts {
            for dash in ghost.lines.iter().flat_map(|line| dashes(line, DASH * scale, size)) {
                canvas.line(&dash, width, color);
            }
            for leader in &ghost.leaders {
                let [Some(from), Some(to)] = *leader else { continue };
                // A point that did not move needs no leader.
                if from.distance(to) > 4.0 * scale {
                    canvas.line(&[from, to], width, color);
                    canvas.disc(from, 0.5 * width + 2.0 * scale, color);
                }
            }
        }
    }
    ghosts.iter().map(record).collect()
}

fn record(ghost: &Ghost) -> GhostRecord {
    let [bent, straight] = ghost.leaders.first().copied().unwrap_or_default();
    let shift_px = bent.zip(straight).map(|(a, b)| a.distance(b));
    let [bent_px, straight_px] = [bent, straight].map(|p| p.map(|p| p.to_array()));
    GhostRecord { layer: ghost.layer.clone(), bent_px, straight_px, shift_px }
}

/// `None` for layers without an extent in space.
fn ghost(layer: &Layer, bent: &View, straight: &View) -> Option<Ghost> {
    let image = |view: &View, p: DVec3| view.project(p).ok().map(|image| image.pixel);
    let both = |p: DVec3| [image(bent, p), image(straight, p)];
    let (lines, leaders) = match &layer.kind {
        LayerKind::Terrain(_) | LayerKind::Area(_) => return None,
        LayerKind::Line(l) => {
            let lifted = l.features.iter().map(|f| f.points.iter().map(|&p| p + l.lift_m * DVec3::Z));
            let lines: Vec<Vec<DVec3>> = lifted.map(Iterator::collect).collect();
            let in_picture = |p: Option<DVec2>| p.is_some_and(|p| bent.pinhole().contains(p));
            let pairs = lines.iter().flatten().map(|&p| both(p)).filter(|[b, s]| in_picture(*b) && s.is_some());
            let shift = |[b, s]: &[Option<DVec2>; 2]| b.zip(*s).map_or(0.0, |(b, s)| b.distance(s));
            // Prefers a point whose leader ends in the picture.
            let rank = |pair: &[Option<DVec2>; 2]| (in_picture(pair[1]), shift(pair));
            let farthest = pairs.max_by(|a, b| {
                let (a, b) = (rank(a), rank(b));
                a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
            });
            (lines.iter().flat_map(|line| images(straight, line)).collect(), farthest.into_iter().collect())
        }
        LayerKind::Point(l) => {
            let places = l.features.iter().map(|f| f.position + l.lift_m * DVec3::Z);
            (Vec::new(), places.take(MOST_POINTS).map(both).collect())
        }
        _ => {
            let bounds = bounds(layer);
            if bounds.is_empty() {
                return None;
            }
            (edges(&bounds).iter().flat_map(|edge| images(straight, edge)).collect(), vec![both(bounds.center())])
        }
    };
    Some(Ghost { layer: layer.id.clone(), lines, leaders })
}

/// Bounds of the required part of a layer.
fn bounds(layer: &Layer) -> Aabb {
    let of_parts = |layer: &MeshLayer, is_wanted: &dyn Fn(u32) -> bool| {
        let mesh = &layer.mesh;
        let wanted = (0..mesh.triangles().len()).filter(|t| mesh.part(*t).is_some_and(is_wanted));
        Aabb::of(wanted.flat_map(|t| mesh.corners(t)))
    };
    match &layer.kind {
        LayerKind::Mesh(m) | LayerKind::Own(OwnLayer { surface: m, .. }) if m.wanted.is_some() => {
            of_parts(m, &|part| m.wanted.as_ref().is_some_and(|wanted| wanted.contains(&part)))
        }
        LayerKind::Molecule(m) if m.wanted.is_some() => {
            let mask = m.wanted.as_ref().map(|wanted| m.mask_of(wanted)).unwrap_or_default();
            of_parts(&m.surface, &|atom| mask.get(atom as usize) == Some(&true))
        }
        _ => layer.bounds(),
    }
}

/// The twelve edges of a box.
fn edges(b: &Aabb) -> Vec<[DVec3; 2]> {
    let corner = |i: usize| {
        let pick = |bit: usize, lo: f64, hi: f64| if i >> bit & 1 == 0 { lo } else { hi };
        DVec3::new(pick(0, b.min.x, b.max.x), pick(1, b.min.y, b.max.y), pick(2, b.min.z, b.max.z))
    };
    let along = |bit: usize| (0..8).filter(move |i| i >> bit & 1 == 0).map(move |i| [corner(i), corner(i | 1 << bit)]);
    (0..3).flat_map(along).collect()
}

/// Images of a polyline, split where points have no image.
fn images(view: &View, line: &[DVec3]) -> Vec<Vec<DVec2>> {
    let pinhole = view.pinhole();
    let image = |p: &DVec3| view.project(*p).ok().filter(|i| i.depth >= pinhole.near).map(|i| i.pixel);
    let images: Vec<Option<DVec2>> = line.iter().map(image).collect();
    let runs = images.split(Option::is_none).map(|run| run.iter().flatten().copied().collect::<Vec<_>>());
    runs.filter(|run| run.len() > 1).collect()
}

/// Dashes of a polyline that lie in a picture of this size.
/// * `length`: length of dashes and gaps, pixels, > 0.
fn dashes(line: &[DVec2], length: f64, size: DVec2) -> Vec<[DVec2; 2]> {
    let (mut out, mut along) = (Vec::new(), 0.0);
    for pair in line.windows(2) {
        let (way, total) = (pair[1] - pair[0], pair[0].distance(pair[1]));
        let Some([from, to]) = inside(pair[0], way, size).filter(|_| total > 0.0) else {
            along += if total.is_finite() { total } else { 0.0 };
            continue;
        };
        let at = |s: f64| pair[0] + way * ((s - along) / total);
        let (begin, end) = (along + from * total, along + to * total);
        let mut k = (begin / (2.0 * length)).floor() * 2.0 * length;
        while k < end {
            let (a, b) = (k.max(begin), (k + length).min(end));
            if b > a {
                out.push([at(a), at(b)]);
            }
            k += 2.0 * length;
        }
        along += total;
    }
    out
}

/// The stretch of `p + s way`, s in 0..=1, within a picture (Liang, Barsky 1984).
fn inside(p: DVec2, way: DVec2, size: DVec2) -> Option<[f64; 2]> {
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for (p, way, end) in [(p.x, way.x, size.x), (p.y, way.y, size.y)] {
        if way == 0.0 {
            if !(0.0..=end).contains(&p) {
                return None;
            }
            continue;
        }
        let (a, b) = (-p / way, (end - p) / way);
        (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
    }
    (from < to).then_some([from, to])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_keep_their_rhythm_over_corners_and_outside_the_picture() {
        let size = DVec2::new(100.0, 50.0);
        let total = |d: &[[DVec2; 2]]| d.iter().map(|[a, b]| a.distance(*b)).sum::<f64>();
        // 100 pixels: dashes 0..10, 20..30, ... 80..90.
        let straight = dashes(&[DVec2::new(0.0, 5.0), DVec2::new(100.0, 5.0)], 10.0, size);
        assert!(straight.len() == 5 && (total(&straight) - 50.0).abs() < 1e-9, "{straight:?}");
        let bent = dashes(&[DVec2::new(0.0, 5.0), DVec2::new(35.0, 5.0), DVec2::new(35.0, 40.0)], 10.0, size);
        assert!((total(&bent) - 40.0).abs() < 1e-9, "{bent:?}");
        // From far outside, at once.
        let far = dashes(&[DVec2::new(-1e12, 5.0), DVec2::new(1e12, 5.0)], 10.0, size);
        assert!(far.len() <= 7 && far.iter().flatten().all(|p| (-0.1..=100.1).contains(&p.x)), "{far:?}");
        assert_eq!(dashes(&[DVec2::new(0.0, -5.0), DVec2::new(100.0, -5.0)], 10.0, size).len(), 0);
        assert_eq!(dashes(&[DVec2::new(5.0, 5.0); 2], 10.0, size).len(), 0);
    }

    #[test]
    fn a_box_has_twelve_edges() {
        let edges = edges(&Aabb { min: DVec3::ZERO, max: DVec3::new(1.0, 2.0, 3.0) });
        assert_eq!(edges.len(), 12);
        assert_eq!(edges.iter().map(|[a, b]| a.distance(*b)).sum::<f64>(), 4.0 * (1.0 + 2.0 + 3.0));
    }
}
