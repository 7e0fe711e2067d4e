//! Letters of further fonts in PDF: each glyph in use is a drawing of its own (Type 3), whatever the format of its font, so that of large
//! fonts nothing else is embedded. The characters of each are known, so that text is found and copied.

use belvedere_composite::canvas::{Fonts, Letter, OutlinePiece};
use flate2::{Compression, write::ZlibEncoder};
use pdf_writer::types::{SystemInfo, UnicodeCmap};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str};
use std::collections::BTreeMap;
use std::io::Write;

const SYSTEM: SystemInfo<'static> = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };
/// Letters of one font of PDF.
const CODES: usize = 256;

/// A letter: the set of fonts, the font, the glyph and its characters.
type Key = (usize, usize, u16, String);

/// Letters in use.
#[derive(Default)]
pub(super) struct DrawnLetters {
    sets: Vec<Fonts>,
    codes: BTreeMap<Key, usize>,
    letters: Vec<(Key, f32)>,
}

impl DrawnLetters {
    /// Number of the font of PDF and code of a letter.
    pub(super) fn code(&mut self, fonts: &Fonts, letter: &Letter) -> (usize, u8) {
        let set = self.sets.iter().position(|set| set == fonts).unwrap_or_else(|| {
            self.sets.push(fonts.clone());
            self.sets.len() - 1
        });
        let key: Key = (set, letter.font, letter.glyph, letter.characters.clone());
        let code = *self.codes.entry(key.clone()).or_insert_with(|| {
            self.letters.push((key, (1000.0 * letter.width) as f32));
            self.letters.len() - 1
        });
        (code / CODES, (code % CODES) as u8)
    }

    /// Number of fonts of PDF.
    pub(super) fn fonts(&self) -> usize {
        self.letters.len().div_ceil(CODES)
    }

    /// Name of a font of PDF in the resources of the page.
    pub(super) fn name(number: usize) -> String {
        format!("T{number}")
    }

    /// Writes the fonts; `ids` are those of the fonts, `next` gives further ones.
    pub(super) fn write(&self, pdf: &mut Pdf, ids: &[Ref], mut next: impl FnMut() -> Ref) {
        for (letters, id) in self.letters.chunks(CODES).zip(ids) {
            let (unicode, drawings) = (next(), letters.iter().map(|_| next()).collect::<Vec<_>>());
            let mut around = [0.0f32; 4];
            for (((set, font, glyph, _), width), drawing) in letters.iter().zip(&drawings) {
                let outline = self.sets.get(*set).map(|fonts| fonts.outline(*font, *glyph)).unwrap_or_default();
                let bounds = bounds(&outline);
                around = union(around, bounds);
                let mut content = Content::new();
                content.start_shape_glyph(*width, bounds[0], bounds[1], bounds[2], bounds[3]);
                path(&mut content, &outline, |[x, y]| [1000.0 * x, 1000.0 * y]);
                if !outline.is_empty() {
                    content.fill_nonzero();
                }
                pdf.stream(*drawing, &deflated(&content.finish())).filter(Filter::FlateDecode);
            }
            let last = letters.len().saturating_sub(1) as u8;
            let mut font = pdf.type3_font(*id);
            font.bbox(Rect::new(around[0], around[1], around[2], around[3]));
            font.matrix([0.001, 0.0, 0.0, 0.001, 0.0, 0.0]).first_char(0).last_char(last);
            font.widths(letters.iter().map(|(_, width)| *width)).to_unicode(unicode);
            let names: Vec<String> = (0..letters.len()).map(|code| format!("g{code}")).collect();
            let mut drawn = font.char_procs();
            for (name, drawing) in names.iter().zip(&drawings) {
                drawn.pair(Name(name.as_bytes()), *drawing);
            }
            drawn.finish();
            font.encoding_custom().differences().consecutive(0, names.iter().map(|name| Name(name.as_bytes())));
            font.resources().finish();
            font.finish();
            let mut map: UnicodeCmap<u8> = UnicodeCmap::new(Name(b"Letters"), SYSTEM);
            for (code, ((.., characters), _)) in letters.iter().enumerate().filter(|(_, l)| !l.0.3.is_empty()) {
                map.pair_with_multiple(code as u8, characters.chars());
            }
            pdf.cmap(unicode, &map.finish());
        }
    }
}

/// Draws an outline as a path, its points moved by `place`.
pub(super) fn path(content: &mut Content, outline: &[OutlinePiece], place: impl Fn([f32; 2]) -> [f32; 2]) {
    for piece in outline {
        match piece {
            OutlinePiece::Move(p) => {
                let [x, y] = place(*p);
                content.move_to(x, y);
            }
            OutlinePiece::Line(p) => {
                let [x, y] = place(*p);
                content.line_to(x, y);
            }
            OutlinePiece::Curve(points) => {
                let [[ax, ay], [bx, by], [x, y]] = points.map(&place);
                content.cubic_to(ax, ay, bx, by, x, y);
            }
            OutlinePiece::Close => {
                content.close_path();
            }
        }
    }
}

/// Left, lower, right and upper bound of an outline and its handles, thousandths of an em.
fn bounds(outline: &[OutlinePiece]) -> [f32; 4] {
    let points = outline.iter().flat_map(|piece| match piece {
        OutlinePiece::Move(p) | OutlinePiece::Line(p) => vec![*p],
        OutlinePiece::Curve(points) => points.to_vec(),
        OutlinePiece::Close => Vec::new(),
    });
    let all = points.map(|[x, y]| [1000.0 * x, 1000.0 * y, 1000.0 * x, 1000.0 * y]);
    all.reduce(union).unwrap_or_default()
}

fn union(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
    [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])]
}

fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    // Memory takes everything.
    encoder.write_all(bytes).and_then(|()| encoder.finish()).unwrap_or_default()
}
