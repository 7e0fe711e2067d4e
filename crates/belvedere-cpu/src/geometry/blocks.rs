//! Surfaces cut into blocks: culled, displaced and projected once per frame, ready to rasterise.

use crate::cache::GroundCache;
use crate::geometry::block::{Block, BufferPool, Counts, DrawnTriangle, Geometry, Job, SoupVertex};
use crate::geometry::box_blocks::box_chunks;
use crate::geometry::drawn_solids::DrawnSolids;
use crate::geometry::grid::{CELL_TRIANGLES, cell_weights};
use crate::geometry::layer_show::LayerShow;
use crate::geometry::locate::{Held, JoinedPasses, Locator};
use crate::geometry::lod::Tree;
use crate::geometry::mesh_blocks::Drawn;
use crate::geometry::pass::{BodyPasses, Pass};
use crate::geometry::select::{DetailSelector, Selection};
use crate::raster::band::Band;
use crate::raster::cells::SIDE;
use crate::screen::Screen;
use belvedere_core::Aabb;
use belvedere_scene::{LayerKind, RenderJob};
use belvedere_sight::LayerPart;
use belvedere_sight::pass::InView;
use belvedere_sight::sections::{Exposure, Sections, Shown};
use rayon::prelude::*;
use std::sync::Arc;

/// A primitive number with this bit counts soup triangles; without it, cells of grid blocks.
pub(crate) const SOUP: u32 = 1 << 31;
/// Bits of a grid primitive below the block number: 10 of the cell, 1 of the triangle.
pub(crate) const CELL_BITS: u32 = 11;

/// Parts between two reports of progress.
const REPORTED: usize = 32;

impl Job<'_> {
    /// Whether a part is still wanted; after a cancellation the rest is left out, and the caller's next report ends the frame.
    fn goes_on(&self, part: usize) -> bool {
        if part.is_multiple_of(REPORTED) {
            self.progress.tick("project", 0.0).is_ok()
        } else {
            !self.progress.is_cancelled()
        }
    }

    /// Adds blocks of ground.
    fn ground(&self, ground: &DetailSelector<'_>, choice: &mut Selection, out: &mut Vec<Block>) {
        ground.choose(choice);
        let (choice, &DetailSelector { hf, tree, view, locator, .. }) = (&*choice, ground);
        let whole = choice.list.iter().filter(|c| c.held.whole).map(|c| choice.held(&c.held)[0]);
        let joined = JoinedPasses::new(view, locator.passes, whole);
        let joined = &joined;
        let drawn = choice.list.par_iter().enumerate().filter(|(k, _)| self.goes_on(*k));
        out.par_extend(drawn.flat_map_iter(|(_, c)| {
            let bounds = tree.bounds(hf, c.level, c.block);
            let shown = bounds.map_or(Shown::Everything, |b| self.shown(&b));
            let seen_in = bounds.filter(|_| !c.held.whole);
            let passes = joined.of(choice.held(&c.held), c.held.whole).filter(move |_| shown != Shown::Nothing);
            let seen =
                passes.filter(move |pass| seen_in.is_none_or(|b| pass.plain.in_view(self.screen, &b) != InView::No));
            let thin = shown == Shown::Partly;
            seen.filter_map(move |pass| self.terrain_block(pass, hf, &tree.sparse, (c, bounds), thin))
        }));
    }

    /// Blocks of boxes or triangles. Each part of a layer is drawn once per record that shows it, or once for all of its records if they
    /// displace it as one map, and once per segment that shows what the records leave out.
    /// * `bounds`: bounds of the parts.
    /// * `draw`: draws the part with a number by a pass.
    fn soups(
        &self,
        locator: &Locator<'_>,
        bounds: &[Aabb],
        draw: impl Fn(&Pass<'_>, usize) -> Option<Block> + Sync,
    ) -> Vec<Block> {
        let locate = |bounds: &Aabb| {
            let mut list = Vec::new();
            let all = locator.all(&mut list);
            let Held { records, segments, whole } = locator.locate(bounds, &all, &mut list);
            let mut held = list[records].to_vec();
            if whole && !held.iter().any(|&record| locator.shows(record, bounds)) {
                held.clear();
            } else if !whole {
                held.retain(|&record| locator.shows(record, bounds));
            }
            (held, list[segments].to_vec(), whole)
        };
        let located: Vec<(Vec<u32>, Vec<u32>, bool)> = bounds.par_iter().map(locate).collect();
        let together = located.iter().filter(|(_, _, whole)| *whole).map(|(held, ..)| &held[..]);
        let joined = JoinedPasses::new(locator.view, locator.passes, together);
        let parts = located.par_iter().enumerate();
        parts
            .filter(|(k, _)| self.goes_on(*k))
            .flat_map_iter(|(k, (held, segments, whole))| {
                joined.of([held, segments], *whole).filter_map(|pass| draw(pass, k)).collect::<Vec<_>>()
            })
            .collect()
    }
}

fn triangles_of(kind: &LayerKind) -> u64 {
    match kind {
        LayerKind::Terrain(t) => 2 * ((t.heightfield.cols() - 1) * (t.heightfield.rows() - 1)) as u64,
        LayerKind::Boxes(b) => 12 * b.boxes.len() as u64,
        kind => kind.triangles().map_or(0, |m| m.mesh.triangles().len() as u64),
    }
}

/// All blocks of a frame; kept between frames so that its memory is reused.
#[derive(Debug, Default)]
pub(crate) struct Blocks {
    pub(crate) list: Vec<Block>,
    /// Numbers of the blocks, nearest first.
    order: Vec<u32>,
    soups: Vec<(u32, u32)>,
    pub(crate) triangles_in: u64,
    choice: Selection,
    spare: BufferPool,
}

impl Blocks {
    /// Displaces, projects, subdivides and clips every surface of the scene.
    /// * `bodies`: passes of the rigid bodies, if there are any.
    pub(crate) fn build(
        &mut self,
        job: &RenderJob<'_>,
        (passes, bodies): (&[Pass<'_>], Option<&BodyPasses<'_>>),
        screen: &Screen,
        sections: Option<&Sections<'_>>,
        detail: &GroundCache<(), Arc<Tree>>,
    ) {
        let RenderJob { scene, view, options, progress, .. } = *job;
        // A tolerance of zero or less would split edges without end.
        let tolerance_px = if options.tolerance_px > 0.01 { options.tolerance_px } else { 0.01 };
        self.list.drain(..).for_each(|b| self.spare.keep(b.geometry));
        self.triangles_in = 0;
        let locator = Locator::new(view, passes, screen);
        let body_locator = bodies.map(|b| Locator::new(b.carried.after(), &b.passes, screen));
        for (i, layer) in scene.layers.iter().enumerate() {
            if sections.is_some_and(|s| s.of_layer(i) == Shown::Nothing) {
                continue;
            }
            let job = Job { layer: i as u32, screen, tolerance_px, spare: &self.spare, sections, progress };
            let carried = bodies.and_then(|bodies| bodies.carried.layer(i));
            match &layer.kind {
                LayerKind::Terrain(t) => {
                    let (hf, lod_px) = (&t.heightfield, options.lod_px);
                    let tree = &detail.get(hf, (), || Arc::new(Tree::new(hf)));
                    let ground = DetailSelector { hf, tree, view, locator: &locator, tolerance_px, lod_px };
                    job.ground(&ground, &mut self.choice, &mut self.list);
                }
                LayerKind::Boxes(b) => {
                    let locator = body_locator.as_ref().filter(|_| carried.is_some()).unwrap_or(&locator);
                    let parts = box_chunks(b, carried);
                    self.list.par_extend(job.soups(locator, &parts, |pass, k| job.box_block(pass, b, carried, k)));
                }
                kind => {
                    let Some(mesh) = kind.triangles().map(|m| &m.mesh) else { continue };
                    let mut draw = |locator: &Locator<'_>, drawn: Drawn<'_>| {
                        let soups = job.soups(locator, &drawn.chunks(), |pass, k| job.mesh_block(pass, drawn, k));
                        self.list.par_extend(soups);
                    };
                    match (carried, &body_locator) {
                        (Some(carried), Some(body_locator)) => {
                            if !carried.holds_all() {
                                draw(&locator, Drawn::Loose(mesh, carried));
                            }
                            draw(body_locator, Drawn::Bodies(mesh, carried));
                        }
                        _ => draw(&locator, Drawn::All(mesh)),
                    }
                }
            }
            self.triangles_in += triangles_of(&layer.kind);
        }
        self.number();
    }

    /// Numbers the soup triangles and sorts the blocks by nearness.
    fn number(&mut self) {
        let mut base = 0;
        self.soups.clear();
        for (i, block) in self.list.iter_mut().enumerate() {
            block.soup_base = base;
            if let Geometry::Soup(soup) = &block.geometry {
                self.soups.push((base, i as u32));
                base += soup.len() as u32;
            }
        }
        self.order.clear();
        self.order.extend(0..self.list.len() as u32);
        let list = &self.list;
        self.order
            .sort_unstable_by(|&a, &b| list[b as usize].cover.q.total_cmp(&list[a as usize].cover.q).then(a.cmp(&b)));
    }

    /// Draws the blocks of some layers that touch the band and are not hidden, nearest first, except those shown sample by sample.
    pub(crate) fn draw(&self, band: &mut Band, shown: DrawnSolids<'_>) {
        for (i, block) in self.in_band(band).filter(|(_, block)| block.thin.is_empty()) {
            let held = shown.of(block);
            if held == LayerPart::Nothing || band.hides(block.cover.x, block.cover.q) {
                continue;
            }
            match &block.geometry {
                Geometry::Grid(nodes) => nodes.draw(i << CELL_BITS, band),
                Geometry::Soup(soup) => {
                    for (k, t) in soup.iter().enumerate().filter(|(_, t)| shown.holds(held, block, t.parent)) {
                        band.draw(t.v.map(|v| v.screen), SOUP | (block.soup_base + k as u32));
                    }
                }
            }
            band.drew(block.cover.x);
        }
    }

    /// Whether a block that touches the band is shown sample by sample.
    pub(crate) fn are_thin_in(&self, band: &Band) -> bool {
        self.in_band(band).any(|(_, block)| !block.thin.is_empty())
    }

    /// Draws the blocks that are shown sample by sample; the band has the samples of `exposure`.
    pub(crate) fn draw_thin(
        &self,
        band: &mut Band,
        ortho: bool,
        (sections, exposure): (&Sections<'_>, &Exposure),
        shown: DrawnSolids<'_>,
    ) {
        for (_, block) in self.in_band(band).filter(|(_, block)| !block.thin.is_empty()) {
            let Geometry::Soup(soup) = &block.geometry else { continue };
            let held = shown.of(block);
            if held == LayerPart::Nothing || band.hides(block.cover.x, block.cover.q) {
                continue;
            }
            let show = LayerShow { sections, exposure, layer: block.layer as usize };
            for (k, (t, at)) in soup.iter().zip(&block.thin).enumerate() {
                if !shown.holds(held, block, t.parent) {
                    continue;
                }
                let prim = SOUP | (block.soup_base + k as u32);
                band.draw_thin(t.v.map(|v| v.screen), *at, (ortho, exposure.places()), prim, &show);
            }
            band.drew(block.cover.x);
        }
    }

    /// Blocks that may touch a band, with their numbers, nearest first.
    fn in_band(&self, band: &Band) -> impl Iterator<Item = (u32, &Block)> + use<'_> {
        let [top, bottom] = [band.y0, band.y1];
        let only = band.only;
        let blocks = self.order.iter().map(|&i| (i, &self.list[i as usize]));
        let blocks = blocks.filter(move |(_, block)| block.cover.y[0] >> 8 < bottom && block.cover.y[1] >> 8 >= top);
        let meets =
            |block: &Block, [left, right]: [i32; 2]| block.cover.x[0] >> 8 < right && block.cover.x[1] >> 8 >= left;
        blocks.filter(move |(_, block)| only.is_none_or(|only| meets(block, only)))
    }

    /// Layer of a primitive number (not sky).
    pub(crate) fn layer_of(&self, prim: u32) -> Option<u32> {
        let block = if prim & SOUP == 0 { prim >> CELL_BITS } else { self.soup_block(prim & !SOUP)? };
        self.list.get(block as usize).map(|b| b.layer)
    }

    fn soup_block(&self, n: u32) -> Option<u32> {
        let at = self.soups.partition_point(|&(base, _)| base <= n).checked_sub(1)?;
        Some(self.soups[at].1)
    }

    /// The triangle of a primitive number (not sky).
    pub(crate) fn find(&self, prim: u32) -> Option<DrawnTriangle<'_>> {
        if prim & SOUP != 0 {
            let n = prim & !SOUP;
            let block = self.list.get(self.soup_block(n)? as usize)?;
            let Geometry::Soup(soup) = &block.geometry else { return None };
            let t = soup.get((n - block.soup_base) as usize)?;
            return Some(DrawnTriangle { block, parent: t.parent, v: t.v });
        }
        let block = self.list.get((prim >> CELL_BITS) as usize)?;
        let Geometry::Grid(nodes) = &block.geometry else { return None };
        let parent = prim & ((1 << CELL_BITS) - 1);
        let (cell, triangle) = ((parent >> 1) as usize, (parent & 1) as usize);
        let [c, r] = [cell % SIDE, cell / SIDE];
        let weights = cell_weights(block.seam, block.cells, [c, r], triangle);
        let corners = CELL_TRIANGLES[triangle].map(|n| nodes.at(c + (n & 1), r + (n >> 1)));
        let v = std::array::from_fn(|i| SoupVertex { screen: corners[i], weights: weights[i] });
        Some(DrawnTriangle { block, parent, v })
    }

    /// Sums over all blocks.
    pub(crate) fn counts(&self) -> Counts {
        self.list.iter().fold(Counts::default(), |a, b| Counts {
            drawn: a.drawn + b.counts.drawn,
            split: a.split + b.counts.split,
            missed: a.missed + b.counts.missed,
        })
    }
}
