//! Parts of the image, cut by straight seams.

use glam::{DVec2, dvec2};

/// A straight line across the picture, by two points of it in shares of the picture's width and height (y down).
///
/// Its left side is the one with the smaller x; the upper one of a level seam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seam {
    /// A point of the line.
    pub from: DVec2,
    /// Another point of the line.
    pub to: DVec2,
}

impl Seam {
    /// The upright line in the middle of the picture.
    pub const MIDDLE: Self = Self { from: dvec2(0.5, 1.0), to: dvec2(0.5, 0.0) };

    /// The edge between the sides in pixels; `None` unless the two points are apart and finite.
    pub(super) fn edge(&self, image: [u32; 2]) -> Option<Edge> {
        let scale = DVec2::from_array(image.map(f64::from));
        let (point, to) = (self.from * scale, self.to * scale);
        let across = (to - point).perp().try_normalize()?;
        let toward_right = across.x > 0.0 || (across.x == 0.0 && across.y > 0.0);
        Some(Edge { point, right: if toward_right { across } else { -across } })
    }
}

/// A seam in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Edge {
    point: DVec2,
    /// Unit vector towards the right side.
    right: DVec2,
}

impl Edge {
    /// Distance from the seam, positive on its right, pixels.
    fn distance(&self, pixel: DVec2) -> f64 {
        (pixel - self.point).dot(self.right)
    }

    /// Points where the seam crosses the outline of a region, pixels; `None` if it does not.
    pub(super) fn ends(&self, image: &[DVec2]) -> Option<[DVec2; 2]> {
        let sides = image.iter().zip(image.iter().cycle().skip(1));
        let mut met = sides.filter_map(|(&a, &b)| {
            let (da, db) = (self.distance(a), self.distance(b));
            ((da < 0.0) != (db < 0.0)).then(|| a.lerp(b, da / (da - db)))
        });
        Some([met.next()?, met.next()?])
    }
}

/// Which side of a seam.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
}

/// A convex part of the image; the parts of a split share no pixel and leave none out.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageRegion {
    corners: Vec<DVec2>,
    edges: Vec<(Edge, Side)>,
}

impl ImageRegion {
    /// The whole image.
    pub(super) fn whole(image: [u32; 2]) -> Self {
        let [w, h] = image.map(f64::from);
        Self { corners: vec![DVec2::ZERO, dvec2(w, 0.0), dvec2(w, h), dvec2(0.0, h)], edges: Vec::new() }
    }

    /// The part on one side of a seam; `None` if that is empty.
    pub(super) fn cut(&self, edge: Edge, side: Side) -> Option<Self> {
        let inside = |p: DVec2| match side {
            Side::Left => -edge.distance(p),
            Side::Right => edge.distance(p),
        };
        let mut corners = Vec::new();
        for (&a, &b) in self.corners.iter().zip(self.corners.iter().cycle().skip(1)) {
            let (da, db) = (inside(a), inside(b));
            if da >= 0.0 {
                corners.push(a);
            }
            if (da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0) {
                corners.push(a.lerp(b, da / (da - db)));
            }
        }
        let reaches_in = self.corners.iter().any(|&c| inside(c) > 0.0);
        let edges = self.edges.iter().copied().chain([(edge, side)]).collect();
        (reaches_in && corners.len() > 2).then_some(Self { corners, edges })
    }

    /// Corners in order, pixels.
    pub fn corners(&self) -> &[DVec2] {
        &self.corners
    }

    /// Whether a pixel position belongs to the part; positions beside the image belong to parts as well.
    pub fn contains(&self, pixel: DVec2) -> bool {
        self.edges.iter().all(|(edge, side)| (edge.distance(pixel) < 0.0) == (*side == Side::Left))
    }

    /// Weight of the part in the colour of a pixel position, 0..=1, when seams are blended over `width` pixels (> 0).
    /// The weights of all parts sum to 1.
    pub fn coverage(&self, pixel: DVec2, width: f64) -> f64 {
        let of_edge = |(edge, side): &(Edge, Side)| {
            let right = (0.5 + edge.distance(pixel) / width).clamp(0.0, 1.0);
            if *side == Side::Right { right } else { 1.0 - right }
        };
        self.edges.iter().map(of_edge).product()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(seam: Seam, image: [u32; 2]) -> [ImageRegion; 2] {
        let whole = ImageRegion::whole(image);
        let edge = seam.edge(image).unwrap();
        [Side::Left, Side::Right].map(|side| whole.cut(edge, side).unwrap())
    }

    #[test]
    fn parts_of_a_slanting_seam_are_convex_and_cover_every_pixel_once() {
        let seam = Seam { from: dvec2(0.3, 0.0), to: dvec2(0.8, 1.0) };
        let [left, right] = parts(seam, [40, 30]);
        assert_eq!([left.corners().len(), right.corners().len()], [4, 4]);
        for i in 0..1200u32 {
            let pixel = dvec2(f64::from(i % 40) + 0.5, f64::from(i / 40) + 0.5);
            assert!(left.contains(pixel) != right.contains(pixel));
            let sum = left.coverage(pixel, 2.0) + right.coverage(pixel, 2.0);
            assert!((sum - 1.0).abs() < 1e-12);
        }
        assert!(left.contains(dvec2(0.0, 29.0)) && right.contains(dvec2(39.0, 0.0)));
    }

    #[test]
    fn left_is_left_whichever_end_comes_first_and_above_for_a_level_seam() {
        for [from, to] in [[dvec2(0.5, 0.0), dvec2(0.5, 1.0)], [dvec2(0.5, 1.0), dvec2(0.5, 0.0)]] {
            let [left, right] = parts(Seam { from, to }, [10, 10]);
            assert!(left.contains(dvec2(1.0, 5.0)) && right.contains(dvec2(9.0, 5.0)));
        }
        let [above, below] = parts(Seam { from: dvec2(1.0, 0.5), to: dvec2(0.0, 0.5) }, [10, 10]);
        assert!(above.contains(dvec2(5.0, 1.0)) && below.contains(dvec2(5.0, 9.0)));
    }

    #[test]
    fn a_seam_beside_the_picture_leaves_nothing_on_one_side() {
        let edge = Seam { from: dvec2(1.2, 0.0), to: dvec2(1.2, 1.0) }.edge([10, 10]).unwrap();
        let whole = ImageRegion::whole([10, 10]);
        assert!(whole.cut(edge, Side::Right).is_none() && whole.cut(edge, Side::Left).is_some());
        assert!(Seam { from: DVec2::ONE, to: DVec2::ONE }.edge([10, 10]).is_none());
        assert!(Seam { from: DVec2::NAN, to: DVec2::ONE }.edge([10, 10]).is_none());
    }
}
