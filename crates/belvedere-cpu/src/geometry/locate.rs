//! Which records of a curved-ray chain draw a box, and whether they may draw it at once.

use crate::geometry::pass::Pass;
use crate::screen::Screen;
use belvedere_core::{Aabb, DVec3, View};
use belvedere_sight::pass::{InView, displaced};
use std::collections::HashMap;
use std::ops::Range;

/// The passes that draw a box: two ranges in a list of pass numbers.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Held {
    /// Records that may show part of the box.
    pub(crate) records: Range<usize>,
    /// Segments that draw what the records leave out.
    pub(crate) segments: Range<usize>,
    /// Whether the records displace the whole box as one map: it is then drawn once, uncut.
    pub(crate) whole: bool,
}

/// The passes of a frame.
pub(crate) struct Locator<'a> {
    pub(crate) view: &'a View,
    pub(crate) passes: &'a [Pass<'a>],
    pub(crate) screen: &'a Screen,
}

impl<'a> Locator<'a> {
    /// * `passes`: all of the view, see [`Pass::all`].
    pub(crate) fn new(view: &'a View, passes: &'a [Pass<'a>], screen: &'a Screen) -> Self {
        Self { view, passes, screen }
    }

    /// Every pass, for a box of any size.
    pub(crate) fn all(&self, list: &mut Vec<u32>) -> Held {
        let records = self.view.records();
        list.clear();
        list.extend(0..self.passes.len() as u32);
        Held { records: 0..records, segments: records..list.len(), whole: records == 1 }
    }

    /// Those of the passes of a larger box that may draw part of this one; their numbers are appended to the list.
    pub(crate) fn locate(&self, bounds: &Aabb, larger: &Held, list: &mut Vec<u32>) -> Held {
        if self.passes.len() == 1 {
            return larger.clone();
        }
        let Some(rays) = self.view.curved_rays() else { return larger.clone() };
        let one = self.view.records() == 1;
        // Where the earlier stages give no bounds, all passes of the larger box are kept.
        let Some(before) = displaced(self.view.earlier_stages(), bounds) else {
            return Held { whole: one, ..larger.clone() };
        };
        let (mut records, mut whole) = (larger.records.clone(), true);
        if !one {
            let from = list.len();
            for i in larger.records.clone() {
                if rays.may_hold(list[i] as usize, &before) {
                    list.push(list[i]);
                }
            }
            records = from..list.len();
            let held = &list[records.clone()];
            whole = held.first().zip(held.last()).is_none_or(|(&first, &last)| {
                (last - first) as usize + 1 == held.len() && rays.is_continuous(first as usize..=last as usize, &before)
            });
        }
        let from = list.len();
        for i in larger.segments.clone() {
            let number = list[i] - self.view.records() as u32;
            if rays.leaves_out(number, &before) && self.shows(list[i], bounds) {
                list.push(list[i]);
            }
        }
        Held { records, segments: from..list.len(), whole }
    }

    /// Bound on the pixels per unit of height inside the box, infinite where unknown; `None` if no pass shows it.
    ///
    /// * `coarse`: whether the picture is a coarse one, see [`Pass::shown_extent`].
    pub(crate) fn px_per_height(&self, bounds: &Aabb, passes: impl Iterator<Item = u32>, coarse: bool) -> Option<f64> {
        let of = |number: u32| {
            let pass = &self.passes[number as usize];
            let InView::Maybe(mut extent) = pass.plain.in_view(self.screen, bounds) else { return None };
            if coarse {
                extent = pass.shown_extent(self.screen, bounds, extent);
            }
            Some(pass.px_per_height(self.screen, bounds, extent))
        };
        passes.filter_map(of).reduce(f64::max)
    }

    /// Whether part of a box lies beside or behind the eye; `false` for curved rays.
    pub(crate) fn reaches_behind(&self, bounds: &Aabb) -> bool {
        let [pass] = self.passes else { return false };
        let depth = |p: DVec3| pass.plain.displace(p).map(|v| self.screen.view_from(v).z);
        bounds.corners().into_iter().filter_map(depth).any(|depth| depth <= 0.0)
    }

    /// Whether a pass shows part of the box.
    pub(crate) fn shows(&self, number: u32, bounds: &Aabb) -> bool {
        self.passes[number as usize].plain.in_view(self.screen, bounds) != InView::No
    }
}

/// Passes that draw several records together.
pub(crate) struct JoinedPasses<'a> {
    passes: &'a [Pass<'a>],
    joined: HashMap<[u32; 2], Pass<'a>>,
}

impl<'a> JoinedPasses<'a> {
    /// Joins the passes of each list of records that displace as one map.
    pub(crate) fn new<'l>(view: &'a View, passes: &'a [Pass<'a>], lists: impl Iterator<Item = &'l [u32]>) -> Self {
        let mut joined = HashMap::new();
        for ends in lists.filter_map(ends).filter(|[first, last]| first < last) {
            joined.entry(ends).or_insert_with(|| Pass::between(view, ends.map(|k| k as usize)));
        }
        Self { passes, joined }
    }

    /// The joined pass of `records`, or one pass for each of them; then those of `segments`.
    pub(crate) fn of<'s>(
        &'s self,
        [records, segments]: [&'s [u32]; 2],
        whole: bool,
    ) -> impl Iterator<Item = &'s Pass<'a>> {
        let together = ends(records).filter(|_| whole).and_then(|ends| self.joined.get(&ends));
        let each = if together.is_some() { &[] } else { records };
        together.into_iter().chain(each.iter().chain(segments).map(|&number| &self.passes[number as usize]))
    }
}

fn ends(records: &[u32]) -> Option<[u32; 2]> {
    Some([*records.first()?, *records.last()?])
}
