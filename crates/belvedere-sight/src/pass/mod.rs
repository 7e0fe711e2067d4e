//! One drawing of the scene, or of part of it: a record of a curved-ray chain, several records that displace as one map, or a segment
//! of the rays where records leave something out.

mod displace;
mod points;
mod spline_table;
mod way;

use crate::screen::Screen;
use belvedere_core::map::unroll::Seam;
use belvedere_core::{Aabb, CurvedRays, DVec2, DVec3, EdgeError, EdgePoint, Edges, Stage, View};
use displace::Displacer;
pub use points::Points;
pub use spline_table::{PIECES, SplineTable, TableCubic};
pub use way::Way;

/// A pass over a view: where it places points. Views draw each image of every point once, by one pass per record of their rays
/// and, where the records leave something out, by one per segment; most views need one pass.
///
/// Whatever places points, surfaces and marks alike, asks the same pass, so that what shares a point is placed alike to the last bit.
#[derive(Debug)]
pub struct Pass<'a> {
    view: &'a View,
    way: Way,
    numbers: [usize; 2],
    /// Whether geometry that does not belong to the record or segment is clipped.
    cut: bool,
    displacer: Displacer<'a>,
    /// `None` unless edges are bent by a single turn alone.
    edges: Option<Edges<'a>>,
}

/// Whether the image shows a box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InView {
    /// The box is not visible in this pass.
    No,
    /// The box may be visible, with its extent; `None` where part of it may be beside or behind the eye.
    Maybe(Option<Extent>),
}

/// Extent of a box on the image and in depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Least depth, positive.
    pub depth: f64,
    /// Least and largest position on the image, pixels from its centre.
    pub image: [DVec2; 2],
}

impl<'a> Pass<'a> {
    /// The passes of a view: one for each record, then one for each segment of curved rays. The records draw every image of every point
    /// once, except what they leave out ([`CurvedRays::leaves_out`]), which the segments draw.
    pub fn all(view: &'a View) -> Vec<Self> {
        let records = view.records();
        let segments = view.curved_rays().filter(|rays| rays.turn_count() > 0).map_or(0, CurvedRays::segments);
        let of_records =
            (0..records).map(|record| Self::new(view, Way::Records([record; 2]), [record; 2], records > 1));
        let of_segments = (0..segments).map(|k| Self::new(view, Way::Segment(k), [records + k as usize; 2], true));
        of_records.chain(of_segments).collect()
    }

    /// The pass for records from the first to the last that displace as one map, see [`CurvedRays::is_continuous`].
    pub fn between(view: &'a View, records: [usize; 2]) -> Self {
        Self::new(view, Way::Records(records), records, false)
    }

    fn new(view: &'a View, way: Way, numbers: [usize; 2], cut: bool) -> Self {
        let edges = match way {
            Way::Records([first, last]) if first == last => view.edges(first),
            Way::Segment(number) if number % 2 == 1 => view.edges(number as usize / 2),
            _ => None,
        };
        Self { view, way, numbers, cut, displacer: Displacer::new(view, way), edges }
    }

    /// The view.
    pub fn view(&self) -> &'a View {
        self.view
    }

    /// The part of curved rays that displaces it.
    pub fn way(&self) -> Way {
        self.way
    }

    /// Numbers of the first and the last record or segment, among all passes of the view.
    pub fn numbers(&self) -> [usize; 2] {
        self.numbers
    }

    /// Displaced position; `None` where the point has no image.
    #[inline]
    pub fn displace(&self, p: DVec3) -> Option<DVec3> {
        if self.is_straight() { Some(p) } else { self.displacer.point(p) }
    }

    /// Displaces a row of points in place; `false` if one of them has no image (the rest is then unspecified).
    pub fn displace_row(&self, points: &mut Points<'_>) -> bool {
        self.displacer.row(points)
    }

    /// Signed distances that must be positive for the point to belong to this pass.
    #[inline]
    pub fn margins(&self, p: DVec3) -> [f64; 2] {
        match self.way {
            _ if !self.cut => [f64::INFINITY; 2],
            Way::Records([record, _]) => self.view.record_margins(record, p),
            Way::Segment(number) => self.view.segment_margins(number, p),
        }
    }

    /// Whether the records may leave out part of a box that this segment then has to draw.
    fn is_left_out(&self, bounds: &Aabb) -> bool {
        let (Way::Segment(number), Some(rays)) = (self.way, self.view.curved_rays()) else { return false };
        displaced(self.view.earlier_stages(), bounds).is_none_or(|b| rays.leaves_out(number, &b))
    }

    /// Whether part of a box may be clipped from a segment.
    pub fn cuts(&self, bounds: &Aabb) -> bool {
        let (Way::Segment(number), Some(rays)) = (self.way, self.view.curved_rays()) else { return false };
        let planes = rays.segment_planes(number);
        displaced(self.view.earlier_stages(), bounds)
            .is_none_or(|b| b.corners().iter().any(|&p| planes.iter().flatten().any(|plane| !(plane.at(p) > 0.0))))
    }

    /// Whether edges stay straight wherever they are.
    #[inline]
    pub fn keeps_edges(&self) -> bool {
        let straight_part = matches!(self.way, Way::Segment(number) if number % 2 == 0);
        self.is_straight() || (straight_part && self.view.stages().len() == 1)
    }

    /// Whether all edges inside a box may be drawn straight within the tolerance; `false` also where the error is unknown.
    #[inline]
    pub fn is_straight_in(&self, bounds: &Aabb, tolerance_px: f64) -> bool {
        self.keeps_edges() || self.edges.as_ref().is_some_and(|edges| edges.box_error_px(bounds) <= tolerance_px)
    }

    /// Input of [`Pass::edge_error_between`]; `None` where it cannot be precomputed.
    #[inline]
    pub fn edge_point(&self, p: DVec3) -> Option<EdgePoint> {
        self.edges.as_ref()?.point(p)
    }

    /// [`EdgeError::px`] of [`Pass::edge_error`] from precomputed ends; `None` where it must be computed from their positions.
    #[inline]
    pub fn edge_error_between(&self, a: Option<&EdgePoint>, b: Option<&EdgePoint>) -> Option<f64> {
        Some(self.edges.as_ref()?.error_px(a?, b?))
    }

    /// See [`View::edge_error`].
    #[inline]
    pub fn edge_error(&self, a: DVec3, b: DVec3) -> EdgeError {
        edge_error(self.view, self.way, a, b)
    }

    /// Whether an edge may have an image between its ends where neither end has one.
    pub fn crosses(&self, a: DVec3, b: DVec3) -> bool {
        self.has_border() && !is_missed(self.view.stages(), &Aabb::of([a, b]))
    }

    /// See [`View::seam`].
    pub fn seam(&self) -> Option<Seam> {
        self.view.seam()
    }

    /// See [`belvedere_core::map::StageMap::has_border`].
    #[inline]
    pub fn has_border(&self) -> bool {
        self.view.stages().iter().any(|s| s.has_border())
    }

    /// Whether the pass may show the box, judged by its displaced bounds.
    pub fn in_view(&self, screen: &Screen, bounds: &Aabb) -> InView {
        if is_missed(self.view.stages(), bounds) {
            return InView::No;
        }
        let Some(rays) = self.view.curved_rays() else {
            return displaced(self.view.stages(), bounds)
                .map_or(InView::Maybe(None), |b| image_of(screen, &b.corners()));
        };
        let Some(before) = displaced(self.view.earlier_stages(), bounds) else { return InView::Maybe(None) };
        let eye = self.view.pinhole().eye;
        let record = match self.way {
            _ if rays.turn_count() == 0 => return image_of(screen, &before.corners()),
            Way::Records([record, _]) => record,
            Way::Segment(number) => match rays.straight_map(number) {
                Some(map) => {
                    let image = before.corners().map(|p| eye + map.linear * (p - map.viewpoint));
                    return image_of(screen, &image);
                }
                None => number as usize / 2,
            },
        };
        let Some(hull) = rays.displaced_hull_in(record, &before) else { return InView::Maybe(None) };
        let hull = hull.map(|v| eye + v);
        if self.view.records() == 1 { image_of(screen, &Aabb::of(hull).corners()) } else { image_of(screen, &hull) }
    }

    /// Whether the records leave out part of a box that this pass, of a segment, may show.
    pub fn fills_in(&self, screen: &Screen, bounds: &Aabb) -> bool {
        self.is_left_out(bounds) && self.in_view(screen, bounds) != InView::No
    }

    /// Whether nothing is displaced.
    #[inline]
    pub fn is_straight(&self) -> bool {
        self.displacer.is_straight()
    }
}

/// See [`View::edge_error`].
pub fn edge_error(view: &View, way: Way, a: DVec3, b: DVec3) -> EdgeError {
    match way {
        Way::Records([first, last]) if first == last => view.edge_error_in(first, a, b),
        Way::Records([first, last]) => view.edge_error_between(first..=last, a, b),
        Way::Segment(number) => view.edge_error_along(number, a, b),
    }
}

/// Whether the image may show the hull of displaced points.
fn image_of(screen: &Screen, hull: &[DVec3]) -> InView {
    let (mut code, mut depth) = (u8::MAX, f64::INFINITY);
    let mut image = [DVec2::INFINITY, DVec2::NEG_INFINITY];
    for &p in hull {
        let v = screen.view_from(p);
        code &= screen.outcode(v, 2.0);
        depth = depth.min(v.z);
        let at = screen.pixel(v) - screen.center;
        image = [image[0].min(at), image[1].max(at)];
    }
    if code != 0 { InView::No } else { InView::Maybe((depth > 0.0).then_some(Extent { depth, image })) }
}

/// Whether the stages give no point of a box an image.
fn is_missed(stages: &[Stage], bounds: &Aabb) -> bool {
    let mut with_border = stages.iter().enumerate().filter(|(_, stage)| stage.has_border());
    with_border.any(|(at, stage)| displaced(&stages[..at], bounds).is_some_and(|b| stage.misses(&b)))
}

/// Bounds of a displaced box; `None` where a stage gives none.
pub fn displaced(stages: &[Stage], bounds: &Aabb) -> Option<Aabb> {
    stages.iter().try_fold(*bounds, |b, stage| stage.displaced_bounds(&b))
}
