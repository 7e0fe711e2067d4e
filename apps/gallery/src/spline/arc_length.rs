//! Error of a table of samples for arc length against the number of its samples.

use crate::chart::{self, Chart, Curve, SeriesLabelPosition, Style};
use crate::easel::Easel;
use crate::figure_set::Figure;
use crate::sheet::Panel;
use anyhow::Result;
use belvedere::core::DVec2;
use belvedere::core::bspline::BSpline;
use belvedere::core::deformation::DeformationCurve;
use belvedere::core::presets::PresetDocument;
use belvedere::scene::Frame;

/// Samples of the tables; the paper's is the last but one.
const SAMPLES: [usize; 7] = [50, 100, 200, 500, 1000, 2000, 5000];
/// Arc lengths at which a table is evaluated.
const PLACES: usize = 4000;
const PRESETS: [(&str, [u8; 3]); 4] = [
    ("progressive", [30, 90, 170]),
    ("degressive", [200, 90, 60]),
    ("flat-steep-flat", [40, 140, 90]),
    ("steep-flat-steep", [140, 70, 150]),
];
const SIZE: [u32; 2] = [720, 430];

/// Errors of a table.
#[derive(Debug, Clone, Copy)]
struct Error {
    /// Largest distance between the table's point and the curve's at the same arc length, curve units.
    place: f64,
    /// Largest relative deviation of a step along the table from the same step along the curve.
    stretch: f64,
}

/// Points at equal steps of the curve's parameter with the summed lengths of their chords, interpolated linearly.
struct Table {
    lengths: Vec<f64>,
    points: Vec<DVec2>,
}

impl Table {
    fn new(spline: &BSpline, samples: usize) -> Self {
        let points: Vec<DVec2> = (0..=samples).map(|i| spline.point(i as f64 / samples as f64)).collect();
        let mut lengths = vec![0.0];
        for pair in points.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + pair[0].distance(pair[1]));
        }
        Self { lengths, points }
    }

    fn at(&self, l: f64) -> DVec2 {
        let next = self.lengths.partition_point(|&other| other <= l).clamp(1, self.lengths.len() - 1);
        let share = (l - self.lengths[next - 1]) / (self.lengths[next] - self.lengths[next - 1]);
        self.points[next - 1].lerp(self.points[next], share)
    }

    fn error(&self, curve: &DeformationCurve) -> Error {
        let step = curve.length() / PLACES as f64;
        let (mut place, mut stretch) = (0.0f64, 0.0f64);
        for k in 0..PLACES {
            let [a, b] = [k, k + 1].map(|k| k as f64 * step);
            place = place.max(self.at(a).distance(curve.at(a).0));
            // Compared with the chord of the exact curve, since both are a little shorter than the arc.
            let exact = curve.at(a).0.distance(curve.at(b).0);
            stretch = stretch.max((self.at(a).distance(self.at(b)) / exact - 1.0).abs());
        }
        Error { place, stretch }
    }
}

pub(super) fn against_samples(_: &Easel<'_>) -> Result<Figure> {
    let (mut places, mut stretches) = (Vec::new(), Vec::new());
    let mut paper = Error { place: 0.0, stretch: 0.0 };
    for (name, color) in PRESETS {
        let spline = PresetDocument::builtin(name)?.presets[0].spline()?;
        let curve = DeformationCurve::new(&spline)?;
        let errors = SAMPLES.map(|samples| (samples, Table::new(&spline, samples).error(&curve)));
        let points = |of: fn(&Error) -> f64| {
            errors.iter().map(|(n, error)| ((*n as f64).log10(), of(error).max(1e-12).log10())).collect()
        };
        places.push(Curve::new(name, points(|e| e.place), color, Style::Line));
        stretches.push(Curve::new(name, points(|e| e.stretch), color, Style::Line));
        if let Some((_, error)) = errors.iter().find(|(n, _)| *n == 2000) {
            (paper.place, paper.stretch) = (paper.place.max(error.place), paper.stretch.max(error.stretch));
        }
    }
    let panel = |title: &str, y: &str, curves, worst: f64| -> Result<Panel> {
        let legend = SeriesLabelPosition::UpperRight;
        let (title, x) = (title.to_owned(), "samples of the table, log10".to_owned());
        let chart = Chart { title: String::new(), x, y: y.to_owned(), legend, curves };
        let (width, height, color) = chart::draw(&chart, SIZE)?;
        let note = format!("with 2000 samples, as in the paper, up to {worst:.1e}");
        Ok(Panel { title, note, frame: Frame { width, height, color, ..Frame::default() } })
    };
    let panels = vec![
        panel("Place on the curve", "error, curve units, log10", places, paper.place)?,
        panel("Lengths along the curve", "relative error, log10", stretches, paper.stretch)?,
    ];
    Ok(Figure { panels, columns: 2, ..Figure::default() })
}
