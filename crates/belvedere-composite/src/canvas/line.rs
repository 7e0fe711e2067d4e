//! Texts of one line: which font sets which letters, in which order, and where.

use super::bidi;
use super::font::{Face, Fonts, Run, is_plain};
use harfrust::{GlyphId, Script, UnicodeBuffer, script};

/// A letter of a text that is set in one line.
#[derive(Debug, Clone, PartialEq)]
pub struct Letter {
    /// Number of the font, see [`Fonts`].
    pub font: usize,
    /// Number of the glyph in its font.
    pub glyph: u16,
    /// Place from the left end of the text, right and up, em.
    pub at: [f64; 2],
    /// The glyph's own width, em.
    pub width: f64,
    /// The characters that the glyph stands for; empty where another glyph of the same characters has them.
    pub characters: String,
}

/// A piece of an outline, em, y up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OutlinePiece {
    /// The beginning of a ring.
    Move([f32; 2]),
    /// A straight line.
    Line([f32; 2]),
    /// A cubic curve: two handles and the end.
    Curve([[f32; 2]; 3]),
    /// The end of a ring.
    Close,
}

impl Fonts {
    /// The letters of a text as they are set, from left to right.
    pub fn letters(&self, text: &str) -> Vec<Letter> {
        let line = self.set(text);
        let mut starts: Vec<usize> = line.glyphs.iter().map(|glyph| glyph.cluster).collect();
        starts.sort_unstable();
        starts.dedup();
        let mut said = std::collections::BTreeSet::new();
        let letter = |glyph: &Placed| {
            let end = starts.get(starts.partition_point(|s| *s <= glyph.cluster)).copied().unwrap_or(text.len());
            let first = said.insert(glyph.cluster);
            Letter {
                font: glyph.font,
                glyph: glyph.id.to_u32() as u16,
                at: glyph.at.map(f64::from),
                width: f64::from(glyph.width),
                characters: text.get(glyph.cluster..end).filter(|_| first).unwrap_or_default().to_owned(),
            }
        };
        line.glyphs.iter().map(letter).collect()
    }

    /// The outline of a letter, see [`Letter`].
    pub fn outline(&self, font: usize, glyph: u16) -> Vec<OutlinePiece> {
        let mut pen = Pieces::default();
        if let Some(face) = self.0.get(font) {
            face.draw(GlyphId::new(u32::from(glyph)), 1.0, &mut pen);
        }
        pen.pieces
    }

    /// Sets `text` from the origin on.
    pub(super) fn set(&self, text: &str) -> Line<'_> {
        let letters: Vec<(usize, char)> = text.char_indices().filter(|(_, c)| !bidi::states_direction(*c)).collect();
        let plain: Vec<char> = letters.iter().map(|(_, c)| *c).collect();
        let levels = bidi::levels(&plain);
        let scripts = scripts(&plain);
        let fonts = self.chosen(&plain, &scripts);
        let mut line = Line { fonts: self, glyphs: Vec::new(), width: 0.0 };
        for run in bidi::visual(&levels) {
            let to_the_left = levels[run.start] % 2 == 1;
            let mut parts = parts(run, |i| (fonts[i], scripts[i]));
            if to_the_left {
                parts.reverse();
            }
            for part in parts {
                let font = fonts[part.start];
                let Some(face) = self.0.get(font) else { continue };
                for glyph in face.shape(Run { letters: &letters[part], to_the_left }) {
                    let at = [line.width + glyph.offset[0], glyph.offset[1]];
                    let (id, width, cluster) = (glyph.id, glyph.width, glyph.cluster);
                    line.glyphs.push(Placed { font, id, at, width, advance: glyph.advance, cluster });
                    line.width += glyph.advance;
                }
            }
        }
        line
    }

    /// The font of each letter: of a word of one script the first that has all of it, else letter by letter; the embedded one for
    /// letters that none has.
    fn chosen(&self, letters: &[char], scripts: &[Script]) -> Vec<usize> {
        if self.0.len() <= 1 {
            return vec![0; letters.len()];
        }
        let mut out = vec![0; letters.len()];
        for part in parts(0..letters.len(), |i| scripts[i]) {
            let has = |face: &Face, c: char| is_plain(c) || face.has(c);
            let whole = self.0.iter().position(|face| letters[part.clone()].iter().all(|c| has(face, *c)));
            for i in part {
                // A mark stays with its letter where the font has it.
                let before = i.checked_sub(1).map(|i| out[i]).filter(|_| bidi::is_mark(letters[i]));
                let usable = |font: &usize| has(&self.0[*font], letters[i]);
                let alone = || before.filter(usable).or_else(|| (0..self.0.len()).find(usable)).unwrap_or(0);
                out[i] = whole.unwrap_or_else(alone);
            }
        }
        out
    }
}

/// The script of each letter; signs of all scripts have that of the letter before, at the beginning of the one behind.
fn scripts(letters: &[char]) -> Vec<Script> {
    let own = |c: &char| {
        if c.is_ascii_alphabetic() {
            return script::LATIN;
        }
        let mut buffer = UnicodeBuffer::new();
        buffer.add(*c, 0);
        buffer.guess_segment_properties();
        match buffer.script() {
            // Japanese mixes three scripts, which one font sets.
            script::HIRAGANA | script::KATAKANA => script::HAN,
            known => known,
        }
    };
    let mut out: Vec<Script> = letters.iter().map(own).collect();
    let known = |s: &Script| !matches!(*s, script::COMMON | script::INHERITED | script::UNKNOWN);
    let mut last = out.iter().copied().find(known).unwrap_or(script::LATIN);
    for s in &mut out {
        if known(s) {
            last = *s;
        }
        *s = last;
    }
    out
}

/// Parts of a range of one key each.
fn parts<K: PartialEq>(range: std::ops::Range<usize>, key: impl Fn(usize) -> K) -> Vec<std::ops::Range<usize>> {
    let mut out: Vec<std::ops::Range<usize>> = Vec::new();
    for i in range {
        match out.last_mut() {
            Some(part) if key(part.start) == key(i) => part.end = i + 1,
            _ => out.push(i..i + 1),
        }
    }
    out
}

/// A glyph in a line, lengths in em.
pub(super) struct Placed {
    pub(super) font: usize,
    pub(super) id: GlyphId,
    pub(super) at: [f32; 2],
    pub(super) width: f32,
    pub(super) advance: f32,
    pub(super) cluster: usize,
}

/// A text set in one line: its letters from left to right, and its width, em.
pub(super) struct Line<'a> {
    pub(super) fonts: &'a Fonts,
    pub(super) glyphs: Vec<Placed>,
    pub(super) width: f32,
}

/// Collects an outline.
#[derive(Default)]
struct Pieces {
    last: [f32; 2],
    pieces: Vec<OutlinePiece>,
}

impl skrifa::outline::OutlinePen for Pieces {
    fn move_to(&mut self, x: f32, y: f32) {
        self.last = [x, y];
        self.pieces.push(OutlinePiece::Move([x, y]));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.last = [x, y];
        self.pieces.push(OutlinePiece::Line([x, y]));
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        // The same curve as a cubic one.
        let third = |end: f32, handle: f32| end + (handle - end) * 2.0 / 3.0;
        let [a, b] = [self.last, [x, y]].map(|end| [third(end[0], cx), third(end[1], cy)]);
        self.curve_to(a[0], a[1], b[0], b[1], x, y);
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        self.last = [x, y];
        self.pieces.push(OutlinePiece::Curve([[ax, ay], [bx, by], [x, y]]));
    }

    fn close(&mut self) {
        self.pieces.push(OutlinePiece::Close);
    }
}
