//! Which symbols are drawn, and where: those that must be seen all are; context stays off lines that must be seen, and overlaps no symbol by
//! more than a quarter of the smaller one.

use crate::marks::drawing::PlacedDrawing;
use crate::marks::occupied::{Occupied, Rect};
use crate::marks::request::LabelRequest;
use crate::marks::ribbon::{Ink, Stroke};
use crate::marks::symbol;
use belvedere_core::DVec2;
use belvedere_scene::Symbol;
use std::cmp::Reverse;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// Largest share of the smaller of two symbols that both cover.
const MOST_SHARED: f64 = 0.25;
/// How far a symbol steps aside from a line, in half sizes of it, nearest first.
const ASIDE: [f64; 4] = [0.75, 1.25, 1.75, 2.5];
/// Number that no layer has.
const NOBODY: usize = usize::MAX;

/// Images of the points of a layer that are drawn alike.
#[derive(Debug)]
pub(super) struct PointGroup {
    /// 1 + index of the layer.
    pub(super) id: u32,
    pub(super) inks: [Ink; 3],
    pub(super) images: Vec<PointImage>,
}

/// An image of a point, with all that is drawn for it.
#[derive(Debug)]
pub(super) struct PointImage {
    pub(super) at: DVec2,
    pub(super) symbol: Symbol,
    pub(super) half_px: f64,
    /// How much it counts, see [`LabelRequest::rank`].
    pub(super) rank: f64,
    /// Whether nothing hides it, or its style draws it all the same.
    pub(super) seen: bool,
    pub(super) strokes: Vec<Stroke>,
    pub(super) drawing: Option<PlacedDrawing>,
    pub(super) request: Option<LabelRequest>,
}

impl PointImage {
    /// What its symbol takes, pixels.
    pub(super) fn rect(&self) -> Rect {
        let corners = || symbol::rings(self.symbol).iter().flatten();
        let (lo, hi) = match self.symbol {
            Symbol::Own(_) => (DVec2::NEG_ONE, DVec2::ONE),
            _ => (
                corners().copied().reduce(DVec2::min).unwrap_or_default(),
                corners().copied().reduce(DVec2::max).unwrap_or_default(),
            ),
        };
        [lo, hi].map(|p| self.at + self.half_px * p)
    }

    fn is_drawn(&self) -> bool {
        !self.strokes.is_empty() || self.drawing.is_some()
    }

    /// Moves it to the nearest of a few places off some lines; whether there is one.
    fn step_aside(&mut self, lines: &Occupied) -> bool {
        let rect = self.rect();
        let steps =
            ASIDE.iter().flat_map(|step| (0..8).map(move |k| step * DVec2::from_angle(f64::from(k) * TAU / 8.0)));
        let mut moves = std::iter::once(DVec2::ZERO).chain(steps.map(|step| self.half_px * step));
        let Some(by) = moves.find(|by| lines.is_free(&rect.map(|corner| corner + *by), NOBODY)) else { return false };
        if by == DVec2::ZERO {
            return true;
        }
        self.at += by;
        self.strokes.iter_mut().for_each(|stroke| *stroke = stroke.moved(by));
        if let Some(drawing) = &mut self.drawing {
            drawing.at += by;
        }
        if let Some(request) = &mut self.request {
            request.at += by;
        }
        true
    }
}

/// Moves symbols of context off lines that must be seen, takes out those that find no place near, and returns their number.
pub(super) fn keep_off(context: &mut [PointGroup], lines: &Occupied) -> u64 {
    let mut count = 0;
    for group in context {
        let before = group.images.len();
        group.images.retain_mut(|image| !image.is_drawn() || image.step_aside(lines));
        count += (before - group.images.len()) as u64;
    }
    count
}

/// Takes out the images of context that would overlap one that counts more, and returns their number: what must be seen counts more than
/// context and is never taken out, what is seen counts more than what is hidden, then ranks decide, then the order of layers and points.
///
/// * `groups`: those of context, then those that must be seen; `keep_clear`: rectangles that context stays out of.
pub(super) fn thin(groups: [&mut [PointGroup]; 2], keep_clear: &[Rect]) -> u64 {
    let mut order: Vec<(bool, usize, usize)> = Vec::new();
    for (must_see, groups) in groups.iter().enumerate() {
        for (g, group) in groups.iter().enumerate() {
            order.extend((0..group.images.len()).map(|i| (must_see == 1, g, i)));
        }
    }
    let image = |(must_see, g, i): (bool, usize, usize)| &groups[usize::from(must_see)][g].images[i];
    order.sort_by(|a, b| {
        let of = |key: &(bool, usize, usize)| Reverse((key.0, image(*key).seen));
        let layer = |key: &(bool, usize, usize)| groups[usize::from(key.0)][key.1].id;
        of(a).cmp(&of(b)).then(image(*b).rank.total_cmp(&image(*a).rank)).then(layer(a).cmp(&layer(b)))
    });
    let mut squares = Squares::of(order.iter().map(|key| image(*key).rect()));
    let mut dropped = Vec::new();
    for key in order.into_iter().filter(|key| image(*key).is_drawn()) {
        let rect = image(key).rect();
        let is_covered = keep_clear.iter().any(|other| shared(other, &rect) > MOST_SHARED);
        match !key.0 && (is_covered || squares.is_taken(&rect)) {
            true => dropped.push(key),
            false => squares.take(rect),
        }
    }
    let count = dropped.len() as u64;
    // From the last on, so that the numbers of the others stay.
    dropped.sort_unstable();
    for (must_see, g, i) in dropped.into_iter().rev() {
        groups[usize::from(must_see)][g].images.remove(i);
    }
    count
}

/// Share of the smaller of two rectangles that both cover.
fn shared(a: &Rect, b: &Rect) -> f64 {
    let size = |r: &Rect| (r[1] - r[0]).max(DVec2::ZERO);
    let both = size(&[a[0].max(b[0]), a[1].min(b[1])]);
    let least = size(a).element_product().min(size(b).element_product());
    if least > 0.0 { both.element_product() / least } else { 0.0 }
}

/// Rectangles by the squares of a grid that they lie in.
struct Squares {
    side: f64,
    rects: HashMap<[i64; 2], Vec<Rect>>,
}

impl Squares {
    /// A grid for rectangles of these sizes.
    fn of(rects: impl Iterator<Item = Rect>) -> Self {
        let side = rects.map(|r| (r[1] - r[0]).max_element()).filter(|side| side.is_finite()).fold(8.0, f64::max);
        Self { side, rects: HashMap::new() }
    }

    fn squares(&self, [lo, hi]: &Rect) -> impl Iterator<Item = [i64; 2]> + use<> {
        let square = |v: f64| (v / self.side).floor().clamp(-1e9, 1e9) as i64;
        let ([x0, y0], [x1, y1]) = ([lo.x, lo.y].map(square), [hi.x, hi.y].map(square));
        (y0..=y1).flat_map(move |y| (x0..=x1).map(move |x| [x, y]))
    }

    fn is_taken(&self, rect: &Rect) -> bool {
        let hit = |square| self.rects.get(&square).is_some_and(|all| all.iter().any(|r| shared(r, rect) > MOST_SHARED));
        self.squares(rect).any(hit)
    }

    fn take(&mut self, rect: Rect) {
        for square in self.squares(&rect) {
            self.rects.entry(square).or_default().push(rect);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::marks::inks;
    use crate::marks::ribbon::Lane;
    use belvedere_scene::{Color, Hidden};

    fn image(x: f64, rank: f64, seen: bool) -> PointImage {
        let at = DVec2::new(x, 50.0);
        let strokes = vec![Stroke::symbol(Symbol::Square, at, 10.0, 0.0, Lane::Fill)];
        PointImage { at, symbol: Symbol::Square, half_px: 10.0, rank, seen, strokes, drawing: None, request: None }
    }

    fn group(images: Vec<PointImage>) -> PointGroup {
        PointGroup { id: 1, inks: inks(Color::rgb(0, 0, 0), None, Hidden::Cut), images }
    }

    fn left(group: &PointGroup) -> Vec<f64> {
        group.images.iter().map(|image| image.at.x).collect()
    }

    #[test]
    fn of_symbols_that_overlap_by_more_than_a_quarter_the_one_that_counts_more_stays() {
        // Squares of 17 pixels: at 13 pixels they share a quarter less a little, at 12 more.
        let none = f64::NEG_INFINITY;
        let mut context = [group(vec![
            image(0.0, 1.0, true),
            image(12.0, 2.0, true),
            image(25.0, none, true),
            image(300.0, none, true),
        ])];
        let mut subject = [group(vec![image(302.0, none, true)])];
        assert_eq!(thin([&mut context, &mut subject], &[]), 2);
        assert_eq!((left(&context[0]), left(&subject[0])), (vec![12.0, 25.0], vec![302.0]));
    }

    #[test]
    fn symbols_that_must_be_seen_are_all_drawn_however_close_they_lie() {
        let many = || group((0..20).map(|k| image(f64::from(k), f64::from(k), k % 2 == 0)).collect());
        let (mut context, mut subject) = ([many()], [many()]);
        assert_eq!(thin([&mut context, &mut subject], &[]), 20);
        assert_eq!((context[0].images.len(), subject[0].images.len()), (0, 20));
        assert_eq!(thin([&mut [many()], &mut []], &[]), 18, "context alone is thinned");
    }

    #[test]
    fn context_steps_off_a_line_that_must_be_seen_or_is_left_out_and_others_stay() {
        let mut lines = Occupied::new(16.0);
        lines.take([DVec2::new(-50.0, 48.0), DVec2::new(150.0, 52.0)], 7);
        // No place is free near the second symbol.
        lines.take([DVec2::new(400.0, 0.0), DVec2::new(500.0, 100.0)], 7);
        let far = PointImage { at: DVec2::new(50.0, 90.0), ..image(50.0, 1.0, true) };
        let named = PointImage {
            request: Some(LabelRequest::new("hut", DVec2::new(20.0, 50.0), 12.0, Color::rgb(0, 0, 0))),
            ..image(20.0, 1.0, true)
        };
        let mut context = [group(vec![named, image(450.0, 1.0, true), far])];
        assert_eq!(keep_off(&mut context, &lines), 1);
        let [moved, stays] = &context[0].images[..] else { panic!("two symbols stay") };
        assert_eq!(stays.at, DVec2::new(50.0, 90.0));
        let off = moved.at - DVec2::new(20.0, 50.0);
        assert!(lines.is_free(&moved.rect(), NOBODY) && off.length() <= 2.5 * moved.half_px, "moved by {off}");
        assert_eq!(moved.request.as_ref().map(|request| request.at), Some(moved.at), "its name goes along");
        assert!(moved.strokes.iter().all(|stroke| stroke.ends()[0].as_dvec2().distance(moved.at) < 1e-3));
    }

    #[test]
    fn hidden_symbols_give_way_and_context_stays_out_of_what_is_kept_clear() {
        let mut context = [group(vec![image(0.0, 9.0, false), image(3.0, 1.0, true), image(100.0, 1.0, true)])];
        let mut subject = [group(vec![image(104.0, 1.0, true)])];
        let mark = [DVec2::new(90.0, 40.0), DVec2::new(200.0, 60.0)];
        assert_eq!(thin([&mut context, &mut subject], &[mark]), 2);
        assert_eq!((left(&context[0]), left(&subject[0])), (vec![3.0], vec![104.0]));
    }

    #[test]
    fn the_grid_leaves_no_pair_that_a_search_of_all_finds() {
        let mut seed = 7u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f64 / f64::from(1u32 << 24)
        };
        let images: Vec<PointImage> = (0..400)
            .map(|_| PointImage {
                at: DVec2::new(400.0 * random(), 300.0 * random()),
                half_px: 4.0 + 8.0 * random(),
                ..image(0.0, random(), true)
            })
            .collect();
        let mut all = [group(images)];
        let dropped = thin([&mut all, &mut []], &[]);
        let kept = &all[0].images;
        assert!((50..300).contains(&kept.len()) && kept.len() as u64 + dropped == 400, "{} kept", kept.len());
        for (i, a) in kept.iter().enumerate() {
            assert!(kept[..i].iter().all(|b| shared(&a.rect(), &b.rect()) <= MOST_SHARED), "{}", a.at);
        }
    }
}
