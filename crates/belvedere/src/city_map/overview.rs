//! Plan drawings of a city and its levels side by side, shaded by height.

use super::plan::Plan;
use belvedere_composite::canvas::{Canvas, text_size};
use belvedere_core::DVec2;
use belvedere_scene::Color;
use belvedere_scene::city::{Building, City};

/// One drawing.
#[derive(Debug, Clone, Copy)]
pub struct Panel<'a> {
    /// Title and a line below it.
    pub title: [&'a str; 2],
    /// The city that is drawn.
    pub city: &'a City,
    /// Whether landmarks are marked.
    pub landmarks: bool,
}

/// Side of a drawing and space around, pixels.
const SIDE: usize = 760;
const GAP: usize = 28;
const HEAD: usize = 66;
const FOOT: usize = 64;
const INK: Color = Color::rgb(52, 50, 48);
const FAINT: Color = Color::rgb(124, 118, 110);
const LANDMARK: Color = Color::rgb(196, 78, 52);
/// Colours from low to high.
const SHADES: [Color; 5] = [
    Color::rgb(231, 219, 200),
    Color::rgb(216, 190, 160),
    Color::rgb(188, 152, 128),
    Color::rgb(146, 112, 108),
    Color::rgb(92, 76, 92),
];
/// Length of the shadow of a metre of height, metres to the south-east.
const SHADOW: f64 = 0.45;

/// Colour of a share 0..=1 of the highest height.
fn shade(share: f64) -> Color {
    let at = share.clamp(0.0, 1.0) * (SHADES.len() - 1) as f64;
    let (low, high) = (SHADES[at as usize], SHADES[(at as usize + 1).min(SHADES.len() - 1)]);
    let mix = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * at.fract()).round() as u8;
    Color::rgb(mix(low.r, high.r), mix(low.g, high.g), mix(low.b, high.b))
}

/// The square around the middle of the city that holds all buildings, or at least 85 of 100 of them if single distant ones would make
/// the town small.
fn crop(city: &City) -> Option<[DVec2; 2]> {
    const FEWEST: f64 = 0.85;
    const WIDER: f64 = 1.7;
    let corner = |b: &Building| b.footprint.first().and_then(|p| p.outer.first().copied()).filter(|p| p.is_finite());
    let corners: Vec<DVec2> = city.buildings.iter().filter_map(corner).collect();
    let last = corners.len().checked_sub(1)?;
    let ranked = |mut values: Vec<f64>, share: f64| {
        values.sort_by(f64::total_cmp);
        values[(share * last as f64).round() as usize]
    };
    let [x, y] = [|p: &DVec2| p.x, |p: &DVec2| p.y].map(|axis| ranked(corners.iter().map(axis).collect(), 0.5));
    let middle = DVec2::new(x, y);
    let reach = |share: f64| ranked(corners.iter().map(|p| (*p - middle).abs().max_element()).collect(), share);
    let most = WIDER * reach(FEWEST);
    let half = [1.0, 0.97, 0.94, 0.91, 0.88].into_iter().map(reach).find(|half| *half <= most).unwrap_or(reach(FEWEST));
    let inside = corners.iter().filter(|p| (**p - middle).abs().max_element() <= half);
    let [low, high] = inside.fold([DVec2::MAX, DVec2::MIN], |[low, high], p| [low.min(*p), high.max(*p)]);
    let (middle, side) = (0.5 * (low + high), (high - low).max_element().max(20.0));
    Some([middle - 0.54 * side, middle + 0.54 * side])
}

/// The height that 97 of 100 buildings do not exceed, rounded up to 5 m.
fn top_of_scale(city: &City) -> f64 {
    let mut heights: Vec<f64> = city.buildings.iter().map(|b| b.height_m).filter(|h| h.is_finite()).collect();
    heights.sort_by(f64::total_cmp);
    let at = (0.97 * heights.len().saturating_sub(1) as f64).round() as usize;
    (heights.get(at).copied().unwrap_or(10.0) / 5.0).ceil().max(1.0) * 5.0
}

/// RGB pixels of the panels side by side, and the width. `city` gives the part that is drawn and the scale of heights.
pub fn overview(city: &City, panels: &[Panel<'_>]) -> (Vec<[u8; 3]>, usize) {
    let (width, height) = (GAP + panels.len() * (SIDE + GAP), HEAD + SIDE + FOOT);
    let mut pixels = vec![[255u8; 3]; width * height];
    let box2 = crop(city).unwrap_or([DVec2::ZERO, DVec2::ONE]);
    let top = top_of_scale(city);
    for (number, panel) in panels.iter().enumerate() {
        let drawing = draw(panel, box2, top);
        let left = GAP + number * (SIDE + GAP);
        for (row, from) in drawing.chunks(SIDE).enumerate() {
            pixels[(HEAD + row) * width + left..][..SIDE].copy_from_slice(from);
        }
        let mut canvas = Canvas::new(&mut pixels, width);
        canvas.text(DVec2::new(left as f64, 30.0), 22.0, panel.title[0], INK, None);
        canvas.text(DVec2::new(left as f64, 53.0), 15.0, panel.title[1], FAINT, None);
    }
    let mut canvas = Canvas::new(&mut pixels, width);
    legend(&mut canvas, top, (box2[1] - box2[0]).x / SIDE as f64);
    (pixels, width)
}

fn draw(panel: &Panel<'_>, box2: [DVec2; 2], top: f64) -> Vec<[u8; 3]> {
    let mut pixels = vec![[255u8; 3]; SIDE * SIDE];
    let mut canvas = Canvas::new(&mut pixels, SIDE);
    let plan = Plan { width: SIDE, height: SIDE, ..Plan::within(box2, SIDE, 0.0) };
    plan.ground(&mut canvas, panel.city);
    plan.ways(&mut canvas, &panel.city.ways);
    let mut order: Vec<&Building> = panel.city.buildings.iter().collect();
    order.sort_by(|a, b| a.height_m.total_cmp(&b.height_m));
    for building in &order {
        let reach = SHADOW * building.height_m.clamp(0.0, 200.0) / plan.m_per_px;
        let steps = (reach / 1.5).ceil().clamp(1.0, 12.0);
        for polygon in &building.footprint {
            plan.fill(&mut canvas, polygon, Color { r: 70, g: 62, b: 66, a: 70 }, DVec2::splat(reach / steps));
            plan.fill(&mut canvas, polygon, Color { r: 70, g: 62, b: 66, a: 45 }, DVec2::splat(reach));
        }
    }
    for building in order {
        let marked = panel.landmarks && building.landmark;
        let fill = if marked { LANDMARK } else { shade(building.height_m / top) };
        for polygon in &building.footprint {
            plan.fill(&mut canvas, polygon, fill, DVec2::ZERO);
            // At small scales outlines would cover the fills.
            if plan.m_per_px > 3.0 {
                continue;
            }
            let edge = if marked { Color::rgb(128, 40, 26) } else { Color { r: 84, g: 70, b: 66, a: 90 } };
            plan.outline(&mut canvas, polygon, 0.8, edge);
        }
    }
    pixels
}

fn legend(canvas: &mut Canvas<'_>, top: f64, m_per_px: f64) {
    let y = (HEAD + SIDE + 22) as f64;
    let (left, wide) = (GAP as f64, 260.0);
    for step in 0..130 {
        let x = left + wide * f64::from(step) / 130.0;
        canvas.rect(DVec2::new(x, y), DVec2::new(x + 2.0, y + 14.0), 0.0, shade(f64::from(step) / 129.0));
    }
    let label = format!("{top:.0} m and more");
    canvas.text(DVec2::new(left, y + 32.0), 14.0, "0 m", FAINT, None);
    canvas.text(DVec2::new(left + wide - text_size(14.0, &label).width, y + 32.0), 14.0, &label, FAINT, None);
    let mark = left + wide + 40.0;
    canvas.rect(DVec2::new(mark, y), DVec2::new(mark + 14.0, y + 14.0), 0.0, LANDMARK);
    canvas.text(DVec2::new(mark + 22.0, y + 12.0), 15.0, "landmark, kept in its own shape", INK, None);
    let target = 200.0 * m_per_px;
    let power = 10f64.powf(target.log10().floor());
    let length = [5.0, 2.0, 1.0].iter().map(|f| f * power).find(|l| *l <= target).unwrap_or(power);
    let (right, px) = (canvas.size().x - GAP as f64, length / m_per_px);
    for (a, b) in [
        ([right - px, y + 8.0], [right, y + 8.0]),
        ([right - px, y + 3.0], [right - px, y + 13.0]),
        ([right, y + 3.0], [right, y + 13.0]),
    ] {
        canvas.line(&[DVec2::from(a), DVec2::from(b)], 1.5, INK);
    }
    let text = if length < 1000.0 { format!("{length:.0} m") } else { format!("{:.0} km", length / 1000.0) };
    canvas.text(DVec2::new(right - 0.5 * (px + text_size(15.0, &text).width), y + 30.0), 15.0, &text, INK, None);
}
