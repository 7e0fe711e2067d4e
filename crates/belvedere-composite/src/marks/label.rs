//! Labels: placed greedily where no other label is, with a leader up from the point if need be, as in panoramas.

use crate::canvas::{Canvas, Fonts};
use crate::marks::candidates::{candidates, held};
use crate::marks::name_memory::{Choice, NameMemory, Turn, When};
use crate::marks::occupied::{Occupied, Rect, overlap};
use crate::marks::request::{Candidate, LabelRequest, Lines, Page};
use belvedere_core::{DVec2, polygon::to_segment};
use belvedere_scene::{Color, PlacedName};

/// Most texts of a picture.
const MOST_TEXTS: usize = 5000;
/// Side of the squares of what is taken, units.
const SQUARE: f64 = 48.0;
/// Owner of what belongs to no request.
const NOBODY: usize = usize::MAX;

/// A placed text.
#[derive(Debug, Clone, PartialEq)]
struct Placed {
    color: Color,
    size_px: f64,
    lines: Lines,
    candidate: Candidate,
}

/// The texts of a picture.
#[derive(Debug, Default)]
pub(crate) struct Labels {
    placed: Vec<Placed>,
    /// Pixels per unit of gaps, leaders and rims.
    density: f64,
    fonts: Fonts,
    /// What the next frame of a film needs to know of this one.
    memory: NameMemory,
    /// Number of texts that found no room.
    left_out: u64,
}

impl Labels {
    /// Places the texts that fit into a picture, in the order of their turns.
    pub(crate) fn place(requests: Vec<LabelRequest>, page: &Page<'_>, choice: Choice<'_>) -> Self {
        let density = page.density;
        let mut markers = Occupied::new(SQUARE * density);
        let turns = choice.turns(requests);
        turns.iter().enumerate().for_each(|(i, turn)| markers.take(marker(&turn.request), i));
        let mut taken = Occupied::new(SQUARE * density);
        page.keep_clear.iter().for_each(|rect| taken.take(*rect, NOBODY));
        let mut placed: Vec<Placed> = Vec::new();
        let mut names: Vec<(PlacedName, bool)> = Vec::new();
        let mut left_out = 0;
        let mut place = |i: usize, request: &LabelRequest, places: &mut dyn FnMut(&Lines) -> Vec<Candidate>| {
            if placed.len() >= MOST_TEXTS {
                return false;
            }
            let lines = Lines::of(request, page.fonts);
            let inside = |r: &Rect| r[0].cmpge(DVec2::ZERO).all() && r[1].cmple(page.size).all();
            let layer = request.layer as usize;
            let free =
                |r: &Rect| inside(r) && taken.is_free(r, i) && markers.is_free(r, i) && page.must_see.is_free(r, layer);
            let can_stand = |candidate: &Candidate| {
                // What runs along a line stays off it by its baseline.
                let off = !candidate.along.is_empty() || candidate.boxes.iter().all(|r| is_off(&request.line, r));
                let leader = candidate.leader.as_ref().map(|leader| line_box(leader, density));
                off && candidate.boxes.iter().all(free) && leader.is_none_or(|rect| taken.is_free(&rect, i))
            };
            let Some(candidate) = places(&lines).into_iter().find(can_stand) else { return false };
            candidate.boxes.iter().for_each(|rect| taken.take(*rect, i));
            candidate.leader.iter().for_each(|leader| taken.take(line_box(leader, density), i));
            names.push((PlacedName { id: request.id(), place: candidate.place }, request.seen));
            placed.push(Placed { color: request.color, size_px: request.size_px, lines, candidate });
            true
        };
        // What must move takes no place that another name holds.
        let mut left: Vec<(usize, LabelRequest)> = Vec::new();
        for (i, Turn { request, when }) in turns.into_iter().enumerate() {
            let stands = match when {
                When::InTurn => {
                    left_out += u64::from(!place(i, &request, &mut |lines| candidates(&request, lines, page)));
                    true
                }
                When::Held(at) => {
                    place(i, &request, &mut |lines| held(&request, lines, page, at).into_iter().collect())
                }
                When::Last => false,
                When::Never => true,
            };
            if !stands {
                left.push((i, request));
            }
        }
        for (i, request) in &left {
            left_out += u64::from(!place(*i, request, &mut |lines| candidates(request, lines, page)));
        }
        Self { placed, density, fonts: page.fonts.clone(), memory: choice.remembered(names), left_out }
    }

    /// Number of texts that found no room.
    pub(crate) fn left_out(&self) -> u64 {
        self.left_out
    }

    /// What the next frame of a film needs to know of this one.
    pub(crate) fn into_memory(self) -> NameMemory {
        self.memory
    }

    /// Draws the texts.
    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>) {
        let canvas = canvas.in_fonts(&self.fonts);
        for Placed { color, candidate, .. } in &self.placed {
            if let Some(leader) = &candidate.leader {
                canvas.line(leader, 2.6 * self.density, rim(*color).with_alpha(150));
                canvas.line(leader, self.density, *color);
            }
        }
        for Placed { color, size_px, lines, candidate } in &self.placed {
            let width = (size_px / 7.0).clamp(1.2 * self.density, 3.0 * self.density);
            let halo = Some((rim(*color).with_alpha(225), width));
            match candidate.along.is_empty() {
                true => lines
                    .placed(candidate.baseline)
                    .for_each(|(text, size, at)| canvas.text(at, size, text, *color, halo)),
                false => {
                    let text = lines.lines.first().map_or("", |line| &line.0);
                    canvas.text_along(&candidate.along, *size_px, text, *color, halo);
                }
            }
        }
    }
}

/// Colour of the halo: white around dark letters, dark around light ones.
fn rim(ink: Color) -> Color {
    let light = 2 * u32::from(ink.r) + 5 * u32::from(ink.g) + u32::from(ink.b) > 8 * 140;
    if light { Color::rgb(30, 34, 40) } else { Color::rgb(255, 255, 255) }
}

fn marker(request: &LabelRequest) -> Rect {
    let [side, above] = request.marker;
    [request.at - DVec2::new(side, above), request.at + side]
}

fn line_box(line: &[DVec2; 2], density: f64) -> Rect {
    [line[0].min(line[1]) - 1.5 * density, line[0].max(line[1]) + 1.5 * density]
}

/// Whether a rectangle lies off a line of half a width.
fn is_off((line, half): &(Vec<DVec2>, f64), rect: &Rect) -> bool {
    let grown = [rect[0] - *half, rect[1] + *half];
    line.windows(2).all(|pair| {
        let [lo, hi] = [pair[0].min(pair[1]), pair[0].max(pair[1])];
        !overlap(&[lo, hi + 1e-9], &grown) || !crosses(pair[0], pair[1], &grown)
    })
}

/// Whether a segment meets a rectangle.
fn crosses(a: DVec2, b: DVec2, [lo, hi]: &Rect) -> bool {
    let inside = |p: DVec2| p.cmpgt(*lo).all() && p.cmplt(*hi).all();
    let middle = 0.5 * (*lo + *hi);
    // The corners lie on both sides of the segment's line, and the segment reaches the rectangle.
    let side = |corner: DVec2| (b - a).perp_dot(corner - a);
    let corners = [*lo, DVec2::new(hi.x, lo.y), *hi, DVec2::new(lo.x, hi.y)].map(side);
    let parted = corners.iter().any(|s| *s > 0.0) && corners.iter().any(|s| *s < 0.0);
    inside(a) || inside(b) || (parted && to_segment(middle, a, b).length() <= middle.distance(*lo))
}

#[cfg(test)]
mod tests;
