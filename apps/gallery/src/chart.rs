//! Charts with axes and a legend.

use crate::chart_canvas::ChartCanvas;
use crate::sheet::Pixels;
use anyhow::{Result, anyhow};
pub(crate) use plotters::prelude::SeriesLabelPosition;
use plotters::prelude::*;

/// Size of charts of a page of their own, pixels.
pub(crate) const WIDE: [u32; 2] = [1280, 560];
const LETTERS: &str = "sans-serif";

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Style {
    /// Filled down to the axis.
    Filled,
    Line,
    Dashes,
    Dots,
}

/// Values of one kind.
pub(crate) struct Curve {
    /// Text in the legend; empty: the curve has no entry.
    name: String,
    points: Vec<(f64, f64)>,
    color: RGBColor,
    style: Style,
}

impl Curve {
    pub(crate) fn new(name: &str, points: Vec<(f64, f64)>, [r, g, b]: [u8; 3], style: Style) -> Self {
        Self { name: name.into(), points, color: RGBColor(r, g, b), style }
    }
}

/// A chart.
pub(crate) struct Chart {
    pub(crate) title: String,
    pub(crate) x: String,
    pub(crate) y: String,
    /// Where the legend stands.
    pub(crate) legend: SeriesLabelPosition,
    pub(crate) curves: Vec<Curve>,
}

/// The chart as a picture of `width` x `height` pixels.
pub(crate) fn draw(chart: &Chart, [width, height]: [u32; 2]) -> Result<Pixels> {
    let (width, height) = (width as usize, height as usize);
    let mut pixels = vec![[255u8; 3]; width * height];
    plot(chart, ChartCanvas::new(&mut pixels, width))
        .map_err(|e| anyhow!("the chart \"{}\" cannot be drawn: {e}", chart.title))?;
    Ok((width, height, pixels))
}

fn plot(chart: &Chart, canvas: ChartCanvas<'_>) -> Result<(), Box<dyn std::error::Error>> {
    let area = canvas.into_drawing_area();
    area.fill(&WHITE)?;
    let all = || chart.curves.iter().flat_map(|c| &c.points).filter(|p| p.0.is_finite() && p.1.is_finite());
    let bounds = |of: fn(&(f64, f64)) -> f64| {
        let [lo, hi] = all().map(of).fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], v| [lo.min(v), hi.max(v)]);
        if lo < hi { [lo, hi] } else { [0.0, 1.0] }
    };
    let (x, y) = (bounds(|p| p.0), bounds(|p| p.1));
    let room = 0.04 * (y[1] - y[0]);
    let low = if y[0] >= 0.0 && y[0] < 0.2 * y[1] { 0.0 } else { y[0] - room };
    // Dots on the frame would be cut in two.
    let side = if chart.curves.iter().any(|c| c.style == Style::Dots) { 0.04 * (x[1] - x[0]) } else { 0.0 };
    let label = |v: &f64| format!("{}", (v * 1e6).round() / 1e6);
    let mut axes = ChartBuilder::on(&area)
        .caption(&chart.title, (LETTERS, 20))
        .margin(14)
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(x[0] - side..x[1] * 1.0001 + side, low..y[1] + room)?;
    axes.configure_mesh()
        .x_desc(&chart.x)
        .y_desc(&chart.y)
        .label_style((LETTERS, 15))
        .axis_desc_style((LETTERS, 16))
        .x_label_formatter(&label)
        .y_label_formatter(&label)
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(226, 226, 222))
        .draw()?;
    for curve in &chart.curves {
        let (color, points) = (curve.color, curve.points.clone());
        let drawn = match curve.style {
            Style::Filled => {
                axes.draw_series(AreaSeries::new(points, low, color.mix(0.75)).border_style(color.stroke_width(2)))?
            }
            Style::Line => axes.draw_series(LineSeries::new(points, color.stroke_width(3)))?,
            Style::Dashes => axes.draw_series(DashedLineSeries::new(points, 10, 7, color.stroke_width(2)))?,
            Style::Dots => axes.draw_series(points.iter().map(|p| Circle::new(*p, 6, color.filled())))?,
        };
        let dots = curve.style == Style::Dots;
        if curve.name.is_empty() {
            continue;
        }
        drawn.label(&curve.name).legend(move |(x, y)| {
            let ([left, right], half) = if dots { ([6, 14], 4) } else { ([0, 20], 3) };
            Rectangle::new([(x + left, y - half), (x + right, y + half)], color.filled())
        });
    }
    axes.configure_series_labels()
        .label_font((LETTERS, 15))
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(200, 200, 196))
        .position(chart.legend.clone())
        .draw()?;
    area.present()?;
    Ok(())
}
