//! Rows of the legend: what the layers of a scene look like.

use super::Subject;
use super::block::{Row, Sign};
use crate::notes::ClassNote;
use belvedere_composite::color::{Rgb, encode};
use belvedere_composite::tint::GroundTint;
use belvedere_core::DVec2;
use belvedere_core::plain::number;
use belvedere_scene::{
    Color, Edge, Layer, LayerKind, LineClass, LineLayer, OwnLayer, Palette, PaletteName, TerrainLayer, VolumeLayer,
};

/// Steps of a bar of colours.
const BAR_STEPS: usize = 64;
/// Numbers at a bar.
const MOST_TICKS: usize = 5;

/// The rows of a legend, in the order of the layers; what two layers share has one row.
pub(super) fn rows(subject: &Subject<'_>) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    for row in subject.scene.layers.iter().flat_map(|layer| of_layer(subject, layer)) {
        let is_told = !row.inset && !matches!(row.sign, Sign::Heading) && rows.contains(&row);
        rows.extend((!is_told).then_some(row));
    }
    rows
}

/// The words of a layer: those that are stated, the name that all its features have, its id.
fn words_of(subject: &Subject<'_>, layer: &Layer) -> String {
    let stated = subject.doc.names.get(&layer.id).map(String::as_str);
    // Names of files have no spaces as a rule.
    let of_id = || layer.id.replace('_', " ");
    stated.or(layer.kind.only_name()).map_or_else(of_id, str::to_owned).trim().to_owned()
}

/// Rows of the classes of lines that a layer draws, one each; of a single class the words of the layer, where its features have a name.
fn of_classes(lines: &LineLayer, (words, is_name): (&str, bool)) -> Vec<Row> {
    let mut looks: Vec<(Option<LineClass>, Sign)> = Vec::new();
    for own in lines.features.iter().map(|f| f.style.unwrap_or_default()) {
        if looks.iter().all(|(class, _)| *class != own.class) {
            let (color, casing) = (own.color.unwrap_or(lines.color), own.casing.or(lines.casing));
            let width = own.scale.max(0.0) * lines.width_px;
            looks.push((own.class, Sign::Line { color, casing, width }));
        }
    }
    looks.sort_by_key(|(class, _)| *class);
    let is_one = looks.len() == 1 && is_name;
    let name = |class: Option<LineClass>| class.filter(|_| !is_one).map_or(words, |class| class.words()).to_owned();
    looks.into_iter().map(|(class, sign)| Row { sign, words: name(class), inset: false }).collect()
}

fn of_layer(subject: &Subject<'_>, layer: &Layer) -> Vec<Row> {
    let words = words_of(subject, layer);
    // Sides and mats of the ground are no layer of the scene.
    let is_edge = layer.id == Edge::LAYER || layer.id.starts_with("edge of ");
    if words.is_empty() || is_edge && layer.kind.mesh().is_some() {
        return Vec::new();
    }
    let row = |sign: Sign| Row { sign, words: words.clone(), inset: false };
    // What the sample of a class looks like, in its colour.
    let sample: Box<dyn Fn(Color) -> Sign> = match &layer.kind {
        LayerKind::Line(line) => {
            let (casing, width) = (line.casing, line.width_px);
            Box::new(move |color| Sign::Line { color, casing, width })
        }
        LayerKind::Area(area) => {
            let outline = area.outline;
            Box::new(move |fill| Sign::Area { fill, outline })
        }
        LayerKind::Point(point) => {
            let (symbol, casing, size) = (point.style.symbol, point.style.casing, point.size_px);
            Box::new(move |color| Sign::Point { symbol, color, casing, size })
        }
        LayerKind::Terrain(terrain) => {
            let lines = terrain.contours.map(|lines| {
                let every = lines.interval_in(&terrain.heightfield, subject.view.pinhole(), subject.density);
                let sign = Sign::Line { color: lines.color, casing: None, width: 1.2 };
                Row { sign, words: format!("equal height, every {} m", number(every)), inset: false }
            });
            return heights(terrain).map(row).into_iter().chain(lines).collect();
        }
        LayerKind::Volume(volume) => return vec![row(values(volume))],
        LayerKind::Boxes(boxes) => {
            let fill = boxes.boxes.first().map(|b| b.color);
            return fill.map(|fill| row(Sign::Area { fill, outline: None })).into_iter().collect();
        }
        LayerKind::Mesh(_) if classes(subject, layer).is_some() => Box::new(|fill| Sign::Area { fill, outline: None }),
        LayerKind::Mesh(mesh) | LayerKind::Own(OwnLayer { surface: mesh, .. }) => {
            let fill = if mesh.mesh.triangles().is_empty() {
                None
            } else {
                let own = mesh.mesh.color_at(0, [1.0 / 3.0; 3]);
                own.is_none().then_some(mesh.color)
            };
            return fill.map(|fill| row(Sign::Area { fill, outline: None })).into_iter().collect();
        }
        LayerKind::Molecule(_) => return Vec::new(),
    };
    let own = match &layer.kind {
        LayerKind::Line(line) => line.color,
        LayerKind::Area(area) => area.fill,
        LayerKind::Point(point) => point.color,
        LayerKind::Mesh(mesh) => mesh.color,
        _ => return Vec::new(),
    };
    let Some(note) = classes(subject, layer) else {
        let is_name = subject.doc.names.contains_key(&layer.id) || layer.kind.only_name().is_some();
        return match &layer.kind {
            LayerKind::Line(line) => of_classes(line, (&words, is_name)),
            _ => vec![row(sample(own))],
        };
    };
    let mut rows = vec![Row { sign: Sign::Heading, words: format!("{words}: {}", note.property), inset: false }];
    if note.smooth {
        let bar = smooth(&note.classes);
        rows.push(Row { sign: bar, words: String::new(), inset: true });
    } else {
        let class = |(name, color): &(String, Color)| Row { sign: sample(*color), words: name.clone(), inset: true };
        rows.extend(note.classes.iter().map(class));
    }
    if let Some(others) = note.others {
        rows.push(Row { sign: sample(others.unwrap_or(own)), words: "other".into(), inset: true });
    }
    rows
}

/// Classes of a layer whose features or buildings are coloured by a property.
fn classes<'a>(subject: &'a Subject<'_>, layer: &Layer) -> Option<&'a ClassNote> {
    subject.notes.classes.iter().find(|note| note.layer == layer.id && !note.classes.is_empty())
}

/// A bar that runs through colours at equal distances.
fn smooth(stops: &[(String, Color)]) -> Sign {
    let last = stops.len().saturating_sub(1).max(1) as f64;
    let color = |i: usize| {
        let at = i as f64 / (BAR_STEPS - 1) as f64 * last;
        let k = (at as usize).min(stops.len().saturating_sub(2));
        let (a, b) = (stops[k].1, stops[(k + 1).min(stops.len() - 1)].1);
        mixed(a, b, at - k as f64)
    };
    let labels = stops.iter().enumerate().map(|(i, (name, _))| (i as f64 / last, name.clone())).collect();
    Sign::Bar { colors: (0..BAR_STEPS).map(color).collect(), opacity: None, labels }
}

fn mixed(a: Color, b: Color, share: f64) -> Color {
    let part = |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a))).round().clamp(0.0, 255.0) as u8;
    Color::rgb(part(a.r, b.r), part(a.g, b.g), part(a.b, b.b))
}

/// The tints of a palette that follows height alone; `None` for others, and under pictures laid over the ground.
fn heights(terrain: &TerrainLayer) -> Option<Sign> {
    let by_height = match &terrain.palette {
        Palette::Ramp(_) => true,
        Palette::Named(name) => matches!(name, PaletteName::Clear | PaletteName::Atlas | PaletteName::Night),
        Palette::Placed(..) => false,
    };
    let range = terrain.heightfield.z_range();
    let [low, high] = range;
    if !by_height || !terrain.drapes.is_empty() || !(high > low) {
        return None;
    }
    let tint = GroundTint::new(&terrain.palette, range);
    let color = |i: usize| {
        let height = low + (i as f64 + 0.5) / BAR_STEPS as f64 * (high - low);
        encoded(tint.color(height, DVec2::ZERO))
    };
    let labels = ticks(low, high).into_iter().map(|v| ((v - low) / (high - low), format!("{} m", number(v))));
    Some(Sign::Bar { colors: (0..BAR_STEPS).map(color).collect(), opacity: None, labels: labels.collect() })
}

/// A linear colour as it is stored.
fn encoded(linear: [f32; 3]) -> Color {
    let [r, g, b] = encode(Rgb::from_array(linear));
    Color::rgb(r, g, b)
}

/// Colours and opacities of the values of a volume.
fn values(volume: &VolumeLayer) -> Sign {
    let points = volume.transfer.points();
    let [low, high] = [points.first(), points.last()].map(|p| p.map_or(0.0, |p| p.value));
    let high = if high > low { high } else { low + 1.0 };
    let at = |i: usize| volume.transfer.at(low + (i as f64 + 0.5) / BAR_STEPS as f64 * (high - low));
    let color = |i: usize| {
        let [r, g, b, _] = at(i).map(|v| (255.0 * v).round().clamp(0.0, 255.0) as u8);
        Color::rgb(r, g, b)
    };
    let labels = ticks(low, high).into_iter().map(|v| ((v - low) / (high - low), number(v))).collect();
    Sign::Bar {
        colors: (0..BAR_STEPS).map(color).collect(),
        opacity: Some((0..BAR_STEPS).map(|i| at(i)[3]).collect()),
        labels,
    }
}

/// Round numbers within a range, at most five.
pub(super) fn ticks(low: f64, high: f64) -> Vec<f64> {
    let span = high - low;
    let mut step = crate::round_below(span / 2.0);
    if !(step > 0.0) {
        return Vec::new();
    }
    let count = |step: f64| ((high / step).floor() - (low / step).ceil()) as i64 + 1;
    let finer = crate::round_below(0.6 * step);
    if finer > 0.0 && count(finer) <= MOST_TICKS as i64 {
        step = finer;
    }
    let first = (low / step).ceil() as i64;
    (0..count(step).clamp(0, MOST_TICKS as i64)).map(|k| (first + k) as f64 * step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers_within_their_range() {
        for (low, high) in [(812.0, 2946.0), (-430.0, 310.0), (0.0, 255.0), (1e-3, 2.5e-3), (1000.0, 1000.5)] {
            let found = ticks(low, high);
            assert!((2..=5).contains(&found.len()), "{low}..{high}: {found:?}");
            assert!(found.iter().all(|v| (low..=high).contains(v)), "{low}..{high}: {found:?}");
        }
        assert_eq!(ticks(0.0, 255.0), [0.0, 100.0, 200.0]);
        assert!(ticks(1.0, 1.0).is_empty() && ticks(f64::NAN, 1.0).is_empty());
    }
}
