//! Values of a property become colours or sizes.

use super::scales::CATEGORIES;
use crate::color::{Complaint, color};
use belvedere_core::plain::number;
use belvedere_document::{ColorByDoc, SizeByDoc, StepsDoc};
use belvedere_scene::Color;
use std::collections::BTreeMap;

/// Number of colours of a smooth scale, and of sizes between the least and the largest.
const SMOOTH: usize = 32;
/// Number of classes where none is given.
const USUAL_CLASSES: u8 = 5;

/// A value of a property and the number of features that have it.
pub type Counted = (String, usize);

/// Features that have one colour.
#[derive(Debug, Clone, PartialEq)]
pub struct Class {
    /// The value, or the range of numbers.
    pub name: String,
    /// Its colour.
    pub color: Color,
    /// Number of features.
    pub count: usize,
}

/// Colours of the values of a property.
#[derive(Debug, Clone, PartialEq)]
pub struct Coloring {
    /// The classes, lowest numbers or stated and most frequent values first; of a smooth scale its ends and its middle.
    pub classes: Vec<Class>,
    /// Number of features of no class.
    pub others: usize,
    rule: Rule,
}

#[derive(Debug, Clone, PartialEq)]
enum Rule {
    Values(BTreeMap<String, Color>),
    Breaks(Vec<f64>, Vec<Color>),
    Smooth { low: f64, high: f64, scale: belvedere_document::ScaleName },
}

impl Coloring {
    /// * `values`: distinct values of the property.
    ///
    /// # Errors
    /// A key of the table and a sentence: a value out of its range, a text that is not a colour, texts where numbers are needed.
    pub fn new(doc: &ColorByDoc, values: &[Counted]) -> Result<Self, Complaint> {
        check(doc)?;
        let wants_numbers = doc.scale.is_some() || doc.steps.is_some() || doc.classes.is_some() || doc.breaks.is_some();
        let numbers = numbers(values);
        let known: usize = numbers.iter().map(|n| n.1).sum();
        let filled: usize = values.iter().map(|v| v.1).sum();
        if wants_numbers && known == 0 {
            let sample = values.first().map_or("", |v| v.0.as_str());
            let sample: String = sample.chars().take(40).collect();
            let reason = format!(
                "property \"{}\" holds no number, the first value is \"{sample}\"; remove scale, steps, classes and breaks, or choose a property with numbers",
                doc.property
            );
            return Err(("property", reason));
        }
        match wants_numbers || (doc.values.is_empty() && known == filled && known > 0) {
            true => Ok(by_numbers(doc, &numbers, filled - known)),
            false => by_texts(doc, values),
        }
    }

    /// The colour of a value; `None` = that of the others.
    pub fn color_of(&self, value: &str) -> Option<Color> {
        match &self.rule {
            Rule::Values(colors) => colors.get(value.trim()).copied(),
            Rule::Breaks(breaks, colors) => {
                let value = number_of(value)?;
                colors.get(breaks.partition_point(|b| *b <= value)).copied()
            }
            Rule::Smooth { low, high, scale } => {
                let share = ((number_of(value)? - low) / (high - low).max(1e-300)).clamp(0.0, 1.0);
                let steps = (SMOOTH - 1) as f64;
                Some(scale.color_at((share * steps).round() / steps))
            }
        }
    }

    /// Whether numbers and not texts give the colour.
    pub fn is_of_numbers(&self) -> bool {
        !matches!(self.rule, Rule::Values(_))
    }

    /// Whether colours run into each other between the classes.
    pub fn is_smooth(&self) -> bool {
        matches!(self.rule, Rule::Smooth { .. })
    }

    /// Limits between the classes of numbers.
    pub fn breaks(&self) -> Option<&[f64]> {
        match &self.rule {
            Rule::Breaks(breaks, _) => Some(breaks),
            _ => None,
        }
    }
}

/// Checks what can be checked without the features.
pub fn check(doc: &ColorByDoc) -> Result<(), Complaint> {
    if doc.property.trim().is_empty() {
        return Err(("property", "property is empty; name one of the file's, `info` lists them".into()));
    }
    let wants_numbers = doc.scale.is_some() || doc.steps.is_some() || doc.classes.is_some() || doc.breaks.is_some();
    if wants_numbers && !doc.values.is_empty() {
        let reason = "values are for texts, and scale, steps, classes and breaks for numbers; keep one kind";
        return Err(("values", reason.into()));
    }
    if let Some(n) = doc.classes.filter(|n| !(3..=7).contains(n)) {
        return Err(("classes", format!("classes is {n}, it must be in 3..=7")));
    }
    if let Some(breaks) = &doc.breaks {
        let rises = breaks.windows(2).all(|pair| pair[0] < pair[1]) && breaks.iter().all(|b| b.is_finite());
        if !rises || !(1..=11).contains(&breaks.len()) {
            return Err(("breaks", format!("breaks is {breaks:?}; give 1 to 11 numbers in ascending order")));
        }
        if doc.steps.is_some() || doc.classes.is_some() {
            return Err(("breaks", "breaks says where the classes end; remove steps and classes".into()));
        }
    }
    doc.values.values().try_for_each(|text| color("values", text).map(drop))?;
    doc.others.as_deref().map_or(Ok(()), |text| color("others", text).map(drop))
}

/// Checks what can be checked without the features.
pub fn check_size(doc: &SizeByDoc) -> Result<(), Complaint> {
    if doc.property.trim().is_empty() {
        return Err(("property", "property is empty; name one of the file's, `info` lists them".into()));
    }
    if let Some(px) = doc.px.iter().find(|px| !(**px > 0.0 && **px <= 100.0)) {
        return Err(("px", format!("px holds {}, both sizes must be greater than 0 and at most 100", number(*px))));
    }
    match doc.range.filter(|[low, high]| !(low < high && low.is_finite() && high.is_finite())) {
        Some(range) => Err(("range", format!("range is {range:?}; give the lower number first"))),
        None => Ok(()),
    }
}

/// Sizes of the values of a property, pixels.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sizing {
    low: f64,
    high: f64,
    px: [f64; 2],
}

impl Sizing {
    /// Sizes of the values of a layer, between the least and the largest number unless a range is stated.
    ///
    /// # Errors
    /// A key and why it is wrong.
    pub(super) fn new(doc: &SizeByDoc, values: &[Counted]) -> Result<Self, Complaint> {
        check_size(doc)?;
        let numbers = numbers(values);
        let (Some(first), Some(last)) = (numbers.first(), numbers.last()) else {
            let reason = format!("property \"{}\" holds no number; choose another one", doc.property);
            return Err(("property", reason));
        };
        let [low, high] = doc.range.unwrap_or([first.0, last.0]);
        Ok(Self { low, high, px: doc.px })
    }

    /// `None` = the size of the layer.
    pub(super) fn px_of(&self, value: &str) -> Option<f64> {
        let share = match self.high > self.low {
            true => ((number_of(value)? - self.low) / (self.high - self.low)).clamp(0.0, 1.0),
            false => number_of(value).map(|_| 0.5)?,
        };
        let steps = (SMOOTH - 1) as f64;
        let [a, b] = self.px;
        Some(a + (share * steps).round() / steps * (b - a))
    }
}

fn number_of(text: &str) -> Option<f64> {
    text.trim().parse::<f64>().ok().filter(|v| v.is_finite())
}

/// The values that are numbers, ascending, and how many features have each.
fn numbers(values: &[Counted]) -> Vec<(f64, usize)> {
    let mut numbers: Vec<(f64, usize)> =
        values.iter().filter_map(|(text, count)| Some((number_of(text)?, *count))).collect();
    numbers.sort_by(|a, b| a.0.total_cmp(&b.0));
    numbers
}

/// Lowest and highest value, if all are numbers.
pub(super) fn range(values: &[Counted]) -> Option<[f64; 2]> {
    let numbers = numbers(values);
    let ends = [numbers.first()?.0, numbers.last()?.0];
    (numbers.len() == values.len()).then_some(ends)
}

fn by_texts(doc: &ColorByDoc, values: &[Counted]) -> Result<Coloring, Complaint> {
    let count = |value: &str| values.iter().filter(|(v, _)| v.trim() == value).map(|v| v.1).sum::<usize>();
    let named: Vec<(String, Color)> = match doc.values.is_empty() {
        false => {
            let one = |(value, text): (&String, &String)| Ok((value.trim().to_owned(), color("values", text)?));
            doc.values.iter().map(one).collect::<Result<_, Complaint>>()?
        }
        true => {
            let mut frequent: Vec<&Counted> = values.iter().filter(|v| !v.0.trim().is_empty()).collect();
            frequent.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
            frequent.iter().zip(CATEGORIES).map(|(v, color)| (v.0.trim().to_owned(), color)).collect()
        }
    };
    let classes: Vec<Class> =
        named.iter().map(|(name, color)| Class { name: name.clone(), color: *color, count: count(name) }).collect();
    let all: usize = values.iter().map(|v| v.1).sum();
    let others = all - classes.iter().map(|c| c.count).sum::<usize>().min(all);
    Ok(Coloring { classes, others, rule: Rule::Values(named.into_iter().collect()) })
}

fn by_numbers(doc: &ColorByDoc, numbers: &[(f64, usize)], others: usize) -> Coloring {
    let (low, high) = (numbers[0].0, numbers[numbers.len() - 1].0);
    let scale = doc.scale.unwrap_or_default();
    let all: usize = numbers.iter().map(|n| n.1).sum();
    if doc.steps == Some(StepsDoc::Smooth) {
        let ends = [(low, 0.0), (0.5 * (low + high), 0.5), (high, 1.0)];
        let class = |(value, share)| Class { name: number(value), color: scale.color_at(share), count: all };
        return Coloring { classes: ends.map(class).to_vec(), others, rule: Rule::Smooth { low, high, scale } };
    }
    let breaks = match &doc.breaks {
        Some(breaks) => breaks.clone(),
        None => breaks(numbers, doc.steps.unwrap_or_default(), usize::from(doc.classes.unwrap_or(USUAL_CLASSES))),
    };
    let share = |i: usize| if breaks.is_empty() { 0.5 } else { i as f64 / breaks.len() as f64 };
    let colors: Vec<Color> = (0..=breaks.len()).map(|i| scale.color_at(share(i))).collect();
    let class = |(i, color): (usize, &Color)| {
        let from = if i == 0 { f64::NEG_INFINITY } else { breaks[i - 1] };
        let to = breaks.get(i).copied().unwrap_or(f64::INFINITY);
        let held: Vec<&(f64, usize)> = numbers.iter().filter(|n| (from..to).contains(&n.0)).collect();
        let name = match held[..] {
            [] if i == 0 => format!("< {}", number(to)),
            [] => format!("≥ {}", number(from)),
            [first, ..] if held[held.len() - 1].0 == first.0 => number(first.0),
            [first, ..] => format!("{} – {}", number(first.0), number(held[held.len() - 1].0)),
        };
        Class { name, color: *color, count: held.iter().map(|n| n.1).sum() }
    };
    let classes = colors.iter().enumerate().map(class).collect();
    Coloring { classes, others, rule: Rule::Breaks(breaks, colors) }
}

/// Limits between `n` classes; fewer where there are fewer values.
///
/// * `numbers`: at least one, ascending.
fn breaks(numbers: &[(f64, usize)], steps: StepsDoc, n: usize) -> Vec<f64> {
    let mut distinct: Vec<f64> = numbers.iter().map(|n| n.0).collect();
    distinct.dedup();
    if distinct.len() <= n {
        return distinct.split_off(1);
    }
    let (low, high) = (distinct[0], distinct[distinct.len() - 1]);
    let all: usize = numbers.iter().map(|n| n.1).sum();
    let quantile = |k: usize| {
        let mut before = 0;
        let at = numbers.iter().find(|(_, count)| {
            before += count;
            before > k * all / n
        });
        at.map_or(high, |found| found.0)
    };
    let mut breaks: Vec<f64> = match steps {
        StepsDoc::Equal => (1..n).map(|k| low + k as f64 / n as f64 * (high - low)).collect(),
        StepsDoc::Quantiles | StepsDoc::Smooth => (1..n).map(quantile).collect(),
    };
    breaks.dedup();
    breaks.retain(|b| *b > low);
    breaks
}

#[cfg(test)]
mod tests;
