//! Boxes of rows: texts, samples of styles, bars of colours.

use crate::{INK, PAPER};
use belvedere_composite::canvas::{Canvas, text_size};
use belvedere_composite::marks::outline;
use belvedere_core::DVec2;
use belvedere_scene::{Color, Symbol};

const PAD: f64 = 8.0;
/// Letters of titles by the smaller side of the picture: up to the first number they have the first size, and so on.
const TITLES_PX: [(f64, f64); 3] = [(480.0, 17.0), (1000.0, 24.0), (f64::INFINITY, 34.0)];
/// Letters of legends and notes, and distances of their baselines.
const LETTERS_PX: f64 = 12.0;
const SMALL_PX: f64 = 10.0;
const LEADING: f64 = 1.3;
/// Width of samples, and of the gap behind them.
const SAMPLE: f64 = 24.0;
const BESIDE: f64 = 7.0;
/// Height of a bar of colours, of its labels, and of a curve over it.
const BAR: f64 = 10.0;
const LABELS: f64 = 14.0;
const CURVE: f64 = 26.0;
/// Largest symbol in a legend.
const MOST_SYMBOL: f64 = 20.0;
/// Most lines of a text.
const MOST_LINES: usize = 4;
/// Most names of a list.
const MOST_NAMES: usize = 6;

/// What stands before the words of a row.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Sign {
    /// Nothing: the words begin a part.
    Heading,
    /// A line with a rim.
    Line { color: Color, casing: Option<Color>, width: f64 },
    /// A surface with an outline.
    Area { fill: Color, outline: Option<Color> },
    /// A symbol with a rim.
    Point { symbol: Symbol, color: Color, casing: Option<Color>, size: f64 },
    /// A bar of colours with an opacity each, from low to high, and numbers at shares of it.
    Bar { colors: Vec<Color>, opacity: Option<Vec<f64>>, labels: Vec<(f64, String)> },
}

/// A row of a legend.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    pub(super) sign: Sign,
    pub(super) words: String,
    /// Whether it belongs to the row before.
    pub(super) inset: bool,
}

/// A row with its words in lines.
#[derive(Debug, Clone)]
struct Set {
    sign: Sign,
    lines: Vec<String>,
    left: f64,
    height: f64,
}

/// Rows in a box.
#[derive(Debug, Clone)]
pub(super) struct Block {
    rows: Vec<Set>,
    letters: f64,
    size: DVec2,
    /// Whether it stands on paper; else its letters have a halo.
    paper: bool,
}

/// A text in lines of at most `width`; words that are longer are parted.
pub(super) fn wrapped(text: &str, letters: f64, width: f64) -> Vec<String> {
    let fits = |line: &str| text_size(letters, line).width <= width;
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::new();
    let mut words: Vec<String> = text.split_whitespace().rev().map(str::to_owned).collect();
    while let Some(word) = words.pop() {
        let longer = if line.is_empty() { word.clone() } else { format!("{line} {word}") };
        if fits(&longer) {
            line = longer;
        } else if !line.is_empty() {
            lines.push(std::mem::take(&mut line));
            words.push(word);
        } else {
            let chars: Vec<char> = word.chars().collect();
            let most =
                (1..chars.len()).take_while(|n| fits(&chars[..*n].iter().collect::<String>())).last().unwrap_or(1);
            lines.push(chars[..most].iter().collect());
            if most < chars.len() {
                words.push(chars[most..].iter().collect());
            }
        }
    }
    if !line.is_empty() {
        lines.push(line);
    }
    if lines.len() > MOST_LINES {
        lines.truncate(MOST_LINES);
        if let Some(last) = lines.last_mut() {
            while !last.is_empty() && !fits(&format!("{last}…")) {
                last.pop();
            }
            last.push('…');
        }
    }
    lines
}

/// Names after a word, the first ones of many.
pub(super) fn listed(before: &str, names: &[String]) -> String {
    if names.is_empty() {
        return String::new();
    }
    let shown = names.len().min(MOST_NAMES);
    let more = names.len() - shown;
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{before}{}{rest}", names[..shown].join(", "))
}

impl Block {
    /// The title of a picture of some size: large letters with a halo.
    pub(super) fn title(text: &str, size: DVec2) -> Self {
        let side = size.min_element();
        let letters = TITLES_PX.iter().find(|(most, _)| side <= *most).map_or(LETTERS_PX, |(_, letters)| *letters);
        Self { paper: false, ..Self::texts(&[text.to_owned()], letters, 0.8 * size.x) }
    }

    /// Attribution, source and date.
    pub(super) fn notes(texts: &[String], width: f64) -> Self {
        Self::texts(texts, SMALL_PX, width)
    }

    fn texts(texts: &[String], letters: f64, width: f64) -> Self {
        let row = |text: &String| Row { sign: Sign::Heading, words: text.clone(), inset: false };
        let rows: Vec<Row> = texts.iter().map(row).collect();
        Self::of(rows.iter().map(|row| set(row, letters, width - 2.0 * PAD)).collect(), letters)
    }

    /// A legend of at most `height`, and the number of rows that are cut; `None` if not even one row fits or there are none.
    pub(super) fn legend(rows: &[Row], width: f64, height: f64) -> Option<(Self, usize)> {
        let all: Vec<Set> = rows.iter().map(|row| set(row, LETTERS_PX, width - 2.0 * PAD)).collect();
        let whole = Self::of(all.clone(), LETTERS_PX);
        if rows.is_empty() || whole.size.y <= height {
            return (!rows.is_empty()).then_some((whole, 0));
        }
        (1..all.len()).rev().find_map(|shown| {
            let cut = all.len() - shown;
            let more = Row { sign: Sign::Heading, words: format!("and {cut} more"), inset: false };
            let mut part = all[..shown].to_vec();
            part.push(set(&more, LETTERS_PX, width - 2.0 * PAD));
            let block = Self::of(part, LETTERS_PX);
            (block.size.y <= height).then_some((block, cut))
        })
    }

    fn of(rows: Vec<Set>, letters: f64) -> Self {
        let height: f64 = rows.iter().map(|row| row.height).sum();
        let right = |row: &Set| {
            let words = row.lines.iter().map(|line| text_size(letters, line).width).fold(0.0, f64::max);
            let bar = if matches!(row.sign, Sign::Bar { .. }) { bar_width(row) } else { 0.0 };
            row.left + words.max(bar)
        };
        let width = rows.iter().map(right).fold(0.0, f64::max);
        Self { rows, letters, size: DVec2::new(width + 2.0 * PAD, height + 2.0 * PAD - 2.0), paper: true }
    }

    pub(super) fn size(&self) -> DVec2 {
        self.size
    }

    /// Draws the box with its upper left corner at `at`.
    pub(super) fn draw(&self, canvas: &mut Canvas<'_>, at: DVec2) {
        if self.paper {
            canvas.rect(at, at + self.size, 5.0, PAPER);
        }
        let mut y = at.y + PAD;
        for row in &self.rows {
            let halo = (!self.paper).then_some((PAPER.with_alpha(225), (self.letters / 8.0).max(2.0)));
            row.draw(canvas, DVec2::new(at.x + PAD, y), (self.letters, halo));
            y += row.height;
        }
    }
}

/// Width of the bar of a row: as wide as its labels need.
fn bar_width(row: &Set) -> f64 {
    let Sign::Bar { labels, .. } = &row.sign else { return 0.0 };
    let needed: f64 = labels.iter().map(|(_, text)| text_size(SMALL_PX, text).width + 8.0).sum();
    needed.clamp(110.0, 214.0)
}

fn set(row: &Row, letters: f64, width: f64) -> Set {
    let inset = if row.inset { 10.0 } else { 0.0 };
    let left = match row.sign {
        Sign::Heading | Sign::Bar { .. } => inset,
        _ => inset + SAMPLE + BESIDE,
    };
    let lines = wrapped(&row.words, letters, (width - left).max(2.0 * letters));
    let text = lines.len() as f64 * (letters * LEADING).ceil();
    let height = match &row.sign {
        Sign::Bar { opacity, .. } => text + BAR + LABELS + 6.0 + if opacity.is_some() { CURVE } else { 0.0 },
        Sign::Point { size, .. } => text.max(size.min(MOST_SYMBOL) + 4.0),
        _ => text.max(letters * LEADING),
    };
    Set { sign: row.sign.clone(), lines, left, height }
}

impl Set {
    /// * `halo`: its colour and width.
    fn draw(&self, canvas: &mut Canvas<'_>, at: DVec2, (letters, halo): (f64, Option<(Color, f64)>)) {
        let leading = (letters * LEADING).ceil();
        for (i, line) in self.lines.iter().enumerate() {
            let baseline = at + DVec2::new(self.left, 0.80 * letters + 1.0 + leading * i as f64);
            canvas.text(baseline, letters, line, INK, halo);
        }
        let x = self.left - SAMPLE - BESIDE;
        let middle = at + DVec2::new(x + 0.5 * SAMPLE, 0.5 * letters + 1.0);
        let half = 0.5 * SAMPLE;
        match &self.sign {
            Sign::Heading => {}
            Sign::Line { color, casing, width } => {
                let width = width.clamp(0.8, 8.0);
                let ends = [middle - half * DVec2::X, middle + half * DVec2::X]
                    .map(|end| end + 0.5 * width * DVec2::X * if end.x < middle.x { 1.0 } else { -1.0 });
                if let Some(casing) = casing {
                    canvas.line(&ends, width + 2.4, *casing);
                }
                canvas.line(&ends, width, *color);
            }
            Sign::Area { fill, outline } => {
                let reach = DVec2::new(half, 0.42 * letters);
                if let Some(color) = outline {
                    canvas.rect(middle - reach, middle + reach, 2.0, *color);
                    // What shines through lies on the paper.
                    canvas.rect(middle - reach + 1.2, middle + reach - 1.2, 1.0, Color { a: 255, ..PAPER });
                    canvas.rect(middle - reach + 1.2, middle + reach - 1.2, 1.0, *fill);
                } else {
                    canvas.rect(middle - reach, middle + reach, 2.0, *fill);
                }
            }
            Sign::Point { symbol, color, casing, size } => {
                let size = size.clamp(3.0, MOST_SYMBOL);
                let mut stamp = |half: f64, color: Color| match symbol {
                    Symbol::Dot => canvas.disc(middle, half, color),
                    other => {
                        let mut rings = outline(*other, half);
                        rings.iter_mut().flatten().for_each(|p| *p += middle);
                        canvas.polygon(rings.iter().map(Vec::as_slice), color);
                    }
                };
                if let Some(casing) = casing {
                    stamp(0.5 * size + 1.2, *casing);
                }
                stamp(0.5 * size, *color);
            }
            Sign::Bar { colors, opacity, labels } => {
                let text = self.lines.len() as f64 * leading;
                self.bar(canvas, at + DVec2::new(self.left, text + 2.0), (colors, opacity.as_deref()), labels);
            }
        }
    }

    fn bar(
        &self,
        canvas: &mut Canvas<'_>,
        at: DVec2,
        (colors, opacity): (&[Color], Option<&[f64]>),
        labels: &[(f64, String)],
    ) {
        let width = bar_width(self);
        let part = width / colors.len().max(1) as f64;
        let top = at + DVec2::Y * if opacity.is_some() { CURVE } else { 0.0 };
        for (i, color) in colors.iter().enumerate() {
            let x = top.x + part * i as f64;
            canvas.rect(DVec2::new(x, top.y), DVec2::new(x + part, top.y + BAR), 0.0, *color);
        }
        if let Some(opacity) = opacity {
            let place = |(i, share): (usize, &f64)| {
                DVec2::new(top.x + part * (i as f64 + 0.5), top.y - 2.0 - (CURVE - 4.0) * share.clamp(0.0, 1.0))
            };
            let curve: Vec<DVec2> = opacity.iter().enumerate().map(place).collect();
            let base = top.y - 2.0;
            canvas.line(&[DVec2::new(top.x, base), DVec2::new(top.x + width, base)], 0.8, INK.with_alpha(110));
            canvas.line(&curve, 1.4, INK);
        }
        for (share, text) in labels {
            let x = top.x + share * width;
            let wide = text_size(SMALL_PX, text).width;
            canvas.line(&[DVec2::new(x, top.y + BAR), DVec2::new(x, top.y + BAR + 3.0)], 0.8, INK);
            let left = (x - 0.5 * wide).clamp(top.x, (top.x + width - wide).max(top.x));
            canvas.text(DVec2::new(left, top.y + BAR + 12.0), SMALL_PX, text, INK, None);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_wrap_where_they_must_and_nothing_is_wider_than_its_room() {
        let text = "The High Route of the Pyrenees through Andorra Donaudampfschifffahrtsgesellschaft";
        for width in [40.0, 90.0, 300.0] {
            let lines = wrapped(text, 12.0, width);
            assert!(lines.iter().all(|line| text_size(12.0, line).width <= width), "{lines:?}");
            assert!(lines.len() <= MOST_LINES && (lines.len() < MOST_LINES || !lines[3].is_empty()));
        }
        assert_eq!(wrapped("a b", 12.0, 500.0), ["a b"]);
        assert!(wrapped("  ", 12.0, 500.0).is_empty());
        assert_eq!(wrapped("ab", 12.0, 0.5).len(), 2, "a letter a line at least");
    }

    #[test]
    fn long_legends_are_cut_with_their_number() {
        let row = |i: usize| Row { sign: Sign::Heading, words: format!("class {i}"), inset: false };
        let rows: Vec<Row> = (0..30).map(row).collect();
        let (block, cut) = Block::legend(&rows, 200.0, 200.0).expect("a legend");
        assert!(block.size().y <= 200.0 && cut > 0);
        assert_eq!(block.rows.len(), 30 - cut + 1);
        assert_eq!(block.rows.last().expect("rows").lines, [format!("and {cut} more")]);
        assert_eq!(Block::legend(&rows, 200.0, 1e4).map(|(_, cut)| cut), Some(0));
        assert!(Block::legend(&rows, 200.0, 20.0).is_none() && Block::legend(&[], 200.0, 200.0).is_none());
        let names: Vec<String> = (0..8).map(|i| format!("f{i}")).collect();
        assert_eq!(listed("Data: ", &names), "Data: f0, f1, f2, f3, f4, f5 and 2 more");
    }
}
