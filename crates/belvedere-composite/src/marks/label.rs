//! Labels: placed greedily where no other label is, with a leader up from the point if need be, as in panoramas.

use crate::canvas::{Canvas, text_size};
use belvedere_core::DVec2;
use belvedere_scene::Color;

/// Lengths of leaders tried, pixels.
const LEADERS: [f64; 14] = [0.0, 10.0, 18.0, 26.0, 36.0, 48.0, 60.0, 74.0, 90.0, 108.0, 128.0, 150.0, 175.0, 200.0];
/// Gap between texts, pixels.
const ROOM: f64 = 2.0;
/// Most texts of a picture.
const MOST: usize = 400;

/// A text to be placed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LabelRequest {
    pub(crate) text: String,
    /// The point it belongs to, pixels.
    pub(crate) at: DVec2,
    /// Reach of the marker: to the sides and below, and above, pixels.
    pub(crate) marker: [f64; 2],
    /// Height of the letters, pixels.
    pub(crate) size_px: f64,
    pub(crate) color: Color,
    /// Whether the text may be placed away from its point.
    pub(crate) leader: bool,
    /// Whether the text stands over its point, not beside it.
    pub(crate) over: bool,
}

/// A placed text.
#[derive(Debug, Clone, PartialEq)]
struct Placed {
    label_request: LabelRequest,
    baseline: DVec2,
    leader: Option<[DVec2; 2]>,
}

/// The texts of a picture.
#[derive(Debug, Default)]
pub(crate) struct Labels {
    placed: Vec<Placed>,
    /// Pixels per unit of gaps, leaders and rims.
    density: f64,
}

type Rect = [DVec2; 2];

fn overlap(a: &Rect, b: &Rect) -> bool {
    a[0].x < b[1].x && b[0].x < a[1].x && a[0].y < b[1].y && b[0].y < a[1].y
}

impl Labels {
    /// Places the texts that fit into a picture of `size` pixels, in the order of the requests.
    ///
    /// * `density`: pixels per unit of gaps, leaders and rims; `keep_clear`: rectangles that stay free of them, pixels.
    pub(crate) fn place(requests: Vec<LabelRequest>, size: DVec2, (density, keep_clear): (f64, &[Rect])) -> Self {
        let markers: Vec<Rect> = requests.iter().map(marker).collect();
        let mut taken: Vec<Rect> = keep_clear.to_vec();
        let mut placed: Vec<Placed> = Vec::new();
        for (i, label_request) in requests.into_iter().enumerate() {
            if placed.len() >= MOST {
                break;
            }
            let free = |r: &Rect| {
                let inside = r[0].x >= 0.0 && r[0].y >= 0.0 && r[1].x <= size.x && r[1].y <= size.y;
                inside
                    && !taken.iter().any(|t| overlap(t, r))
                    && !markers.iter().enumerate().any(|(k, m)| k != i && overlap(m, r))
            };
            let found = candidates(&label_request, density).into_iter().find(|(text, leader, _)| {
                free(text) && leader.as_ref().is_none_or(|l| !taken.iter().any(|t| overlap(t, &line_box(l, density))))
            });
            if let Some((text, leader, baseline)) = found {
                taken.push(text);
                taken.extend(leader.as_ref().map(|leader| line_box(leader, density)));
                placed.push(Placed { label_request, baseline, leader });
            }
        }
        Self { placed, density }
    }

    /// Draws the texts.
    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>) {
        for p in &self.placed {
            let ink = p.label_request.color;
            if let Some(leader) = &p.leader {
                canvas.line(leader, 2.6 * self.density, rim(ink).with_alpha(150));
                canvas.line(leader, self.density, ink);
            }
        }
        for Placed { label_request, baseline, .. } in &self.placed {
            let width = (label_request.size_px / 7.0).clamp(1.2 * self.density, 3.0 * self.density);
            let halo = (rim(label_request.color).with_alpha(225), width);
            canvas.text(*baseline, label_request.size_px, &label_request.text, label_request.color, Some(halo));
        }
    }
}

/// Colour of the halo: white around dark letters, dark around light ones.
fn rim(ink: Color) -> Color {
    let light = 2 * u32::from(ink.r) + 5 * u32::from(ink.g) + u32::from(ink.b) > 8 * 140;
    if light { Color::rgb(30, 34, 40) } else { Color::rgb(255, 255, 255) }
}

fn marker(label_request: &LabelRequest) -> Rect {
    let [side, above] = label_request.marker;
    [label_request.at - DVec2::new(side, above), label_request.at + side]
}

fn line_box(line: &[DVec2; 2], density: f64) -> Rect {
    [line[0].min(line[1]) - 1.5 * density, line[0].max(line[1]) + 1.5 * density]
}

/// Boxes of text to try, best first, with leader and baseline.
fn candidates(label_request: &LabelRequest, density: f64) -> Vec<(Rect, Option<[DVec2; 2]>, DVec2)> {
    let size = text_size(label_request.size_px, &label_request.text);
    let [side, above] = label_request.marker;
    let rect = |baseline: DVec2| {
        let (lo, hi) = (DVec2::new(0.0, -size.ascent), DVec2::new(size.width, size.descent));
        [baseline + lo - ROOM * density, baseline + hi + ROOM * density]
    };
    let level = label_request.at.y + 0.36 * label_request.size_px;
    let beside = [
        DVec2::new(label_request.at.x + side + 4.0 * density, level),
        DVec2::new(label_request.at.x - side - 4.0 * density - size.width, level),
        DVec2::new(label_request.at.x - 0.5 * size.width, label_request.at.y + side + 3.0 * density + size.ascent),
    ];
    if label_request.over {
        let baseline = DVec2::new(label_request.at.x - 0.5 * size.width, level);
        return vec![(rect(baseline), None, baseline)];
    }
    let mut out = Vec::new();
    for length in LEADERS.into_iter().take(if label_request.leader { LEADERS.len() } else { 1 }) {
        let length = length * density;
        let foot = label_request.at - DVec2::Y * above;
        let top = foot - DVec2::Y * (length + 2.0 * density);
        for shift in [0.5, 0.15, 0.85] {
            let baseline = DVec2::new(top.x - shift * size.width, top.y - size.descent - density);
            out.push((rect(baseline), (length > 0.0).then_some([foot, top]), baseline));
        }
        if length == 0.0 {
            out.extend(beside.into_iter().map(|b| (rect(b), None, b)));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn label_request(i: usize, at: DVec2) -> LabelRequest {
        let color = Color::rgb(0, 0, 0);
        LabelRequest {
            text: format!("Summit {i}"),
            at,
            marker: [5.0, 6.0],
            size_px: 13.0,
            color,
            leader: true,
            over: false,
        }
    }

    #[test]
    fn names_do_not_overlap_and_the_first_come_first() {
        // Fifty summits in a tight row: not all names fit.
        let requests: Vec<LabelRequest> =
            (0..50).map(|i| label_request(i, DVec2::new(100.0 + 4.0 * i as f64, 230.0))).collect();
        let labels = Labels::place(requests.clone(), DVec2::new(400.0, 300.0), (1.0, &[]));
        let n = labels.placed.len();
        assert!((8..50).contains(&n), "{n} names of 50");
        assert_eq!(labels.placed[0].label_request, requests[0]);
        let rects: Vec<Rect> = labels
            .placed
            .iter()
            .map(|p| {
                let size = text_size(13.0, &p.label_request.text);
                [p.baseline - DVec2::Y * size.ascent, p.baseline + DVec2::new(size.width, size.descent)]
            })
            .collect();
        for (i, a) in rects.iter().enumerate() {
            assert!(
                a[0].min_element() >= 0.0 && a[1].x <= 400.0 && a[1].y <= 300.0,
                "a name leaves the picture: {a:?}"
            );
            assert!(rects[..i].iter().all(|b| !overlap(a, b)), "name {i} lies over another");
        }
    }

    #[test]
    fn names_stay_out_of_what_is_kept_clear() {
        let requests: Vec<LabelRequest> =
            (0..20).map(|i| label_request(i, DVec2::new(20.0 + 18.0 * i as f64, 150.0))).collect();
        let kept = [DVec2::new(100.0, 0.0), DVec2::new(300.0, 300.0)];
        let labels = Labels::place(requests.clone(), DVec2::new(400.0, 300.0), (1.0, &[kept]));
        let all = Labels::place(requests, DVec2::new(400.0, 300.0), (1.0, &[]));
        assert!(!labels.placed.is_empty() && labels.placed.len() < all.placed.len());
        for placed in &labels.placed {
            let size = text_size(13.0, &placed.label_request.text);
            let rect =
                [placed.baseline - DVec2::Y * size.ascent, placed.baseline + DVec2::new(size.width, size.descent)];
            assert!(!overlap(&rect, &kept), "{placed:?}");
        }
    }
}
