//! Fonts: the embedded one, and further ones for the letters that it lacks.

use belvedere_scene::FontFile;
use harfrust::{FontRef, GlyphId, ShaperData, ShaperInstance};
use skrifa::MetadataProvider;
use skrifa::instance::{Location, LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::raw::TableProvider;
use skrifa::string::StringId;
use std::collections::BTreeSet;
use std::sync::{Arc, LazyLock};

/// DejaVu Sans Condensed: Latin, Greek, Cyrillic; licence beside it.
const BYTES: &[u8] = include_bytes!("../../assets/DejaVuSansCondensed-subset.ttf");
/// Most fonts of a collection that are looked at.
const MOST_FACES: u32 = 64;
/// Weight of variable fonts: regular.
const WEIGHT: (&str, f32) = ("wght", 400.0);

/// The embedded font's file, for documents that embed it.
pub const FONT_FILE: &[u8] = BYTES;

static EMBEDDED: LazyLock<Fonts> = LazyLock::new(|| {
    let file = FontFile { name: "embedded".into(), bytes: Arc::new(BYTES.to_vec()), index: 0 };
    Fonts(Face::new(&file).map(Arc::new).into_iter().collect())
});

/// A font, ready to set letters.
pub(super) struct Face {
    bytes: Arc<Vec<u8>>,
    index: u32,
    family: String,
    shaping: ShaperData,
    instance: ShaperInstance,
    location: Location,
    /// Units of the font per em.
    em: f32,
}

impl Face {
    /// `None` if it is no font, or one without units.
    fn new(file: &FontFile) -> Option<Self> {
        let letters = FontRef::from_index(&file.bytes, file.index).ok()?;
        let location = letters.axes().location([WEIGHT]);
        let em = f32::from(letters.metrics(Size::unscaled(), &location).units_per_em);
        let names = letters.localized_strings(StringId::FAMILY_NAME);
        let family: String = names.english_or_first().map(|name| name.chars().collect()).unwrap_or_default();
        (em > 0.0).then(|| Self {
            shaping: ShaperData::new(&letters),
            instance: ShaperInstance::from_coords(&letters, location.coords().iter().copied()),
            location,
            em,
            family: family.chars().filter(|c| !c.is_control()).take(60).collect(),
            bytes: file.bytes.clone(),
            index: file.index,
        })
    }

    fn letters(&self) -> Option<FontRef<'_>> {
        FontRef::from_index(&self.bytes, self.index).ok()
    }

    /// Whether the font draws a letter.
    pub(super) fn has(&self, letter: char) -> bool {
        self.letters().is_some_and(|letters| draws(&letters, letter))
    }

    /// Glyphs of a text of one direction and script, each with its place and width in em, and its character in bytes.
    pub(super) fn shape(&self, run: Run<'_>) -> Vec<Glyph> {
        let Some(letters) = self.letters() else { return Vec::new() };
        let shaper = self.shaping.shaper(&letters).instance(Some(&self.instance)).build();
        let mut buffer = harfrust::UnicodeBuffer::new();
        for (at, letter) in run.letters {
            buffer.add(*letter, *at as u32);
        }
        let direction =
            if run.to_the_left { harfrust::Direction::RightToLeft } else { harfrust::Direction::LeftToRight };
        buffer.set_direction(direction);
        buffer.guess_segment_properties();
        let set = shaper.shape(buffer, harfrust::ShapeOptions::new());
        let metrics = letters.glyph_metrics(Size::unscaled(), &self.location);
        let glyph = |(info, place): (&harfrust::GlyphInfo, &harfrust::GlyphPosition)| Glyph {
            id: GlyphId::new(info.glyph_id),
            offset: [place.x_offset as f32 / self.em, place.y_offset as f32 / self.em],
            advance: place.x_advance as f32 / self.em,
            width: metrics.advance_width(GlyphId::new(info.glyph_id)).map_or(0.0, |width| width / self.em),
            cluster: info.cluster as usize,
        };
        set.glyph_infos().iter().zip(set.glyph_positions()).map(glyph).collect()
    }

    /// Draws the outline of a glyph with letters of `size_px`; one without an outline, or with a damaged one, is left out.
    pub(super) fn draw(&self, glyph: GlyphId, size_px: f32, pen: &mut impl OutlinePen) {
        let Some(letters) = self.letters() else { return };
        if let Some(outline) = letters.outline_glyphs().get(glyph) {
            let settings = DrawSettings::unhinted(Size::new(size_px), LocationRef::from(&self.location));
            let _ = outline.draw(settings, pen);
        }
    }
}

/// Letters of one font, script and direction, with their places in a text, bytes.
pub(super) struct Run<'a> {
    pub(super) letters: &'a [(usize, char)],
    pub(super) to_the_left: bool,
}

/// A glyph of a run, lengths in em.
pub(super) struct Glyph {
    pub(super) id: GlyphId,
    pub(super) offset: [f32; 2],
    pub(super) advance: f32,
    pub(super) width: f32,
    pub(super) cluster: usize,
}

fn draws(letters: &FontRef<'_>, letter: char) -> bool {
    let glyph = letters.charmap().map(letter).filter(|glyph| *glyph != GlyphId::NOTDEF);
    // Fonts of pictures have no outlines.
    glyph.is_some_and(|glyph| letters.outline_glyphs().get(glyph).is_some())
}

/// Fonts in the order in which letters are looked for; the embedded one is the first.
#[derive(Clone)]
pub struct Fonts(pub(super) Arc<[Arc<Face>]>);

impl Default for Fonts {
    fn default() -> Self {
        EMBEDDED.clone()
    }
}

impl PartialEq for Fonts {
    fn eq(&self, other: &Self) -> bool {
        let same = |a: &Arc<Face>, b: &Arc<Face>| Arc::ptr_eq(a, b) || (a.index == b.index && a.bytes == b.bytes);
        self.0.len() == other.0.len() && self.0.iter().zip(other.0.iter()).all(|(a, b)| same(a, b))
    }
}

impl std::fmt::Debug for Fonts {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.0.iter().map(|face| &face.family)).finish()
    }
}

impl Fonts {
    /// The embedded font and these; files that are no fonts are left out, see [`fonts_in`].
    pub fn with(files: &[FontFile]) -> Self {
        match files.is_empty() {
            true => Self::default(),
            false => Self(EMBEDDED.0.iter().cloned().chain(files.iter().filter_map(Face::new).map(Arc::new)).collect()),
        }
    }

    /// Whether they have all letters of a text.
    pub fn can_set(&self, text: &str) -> bool {
        self.lacks(text).is_empty()
    }

    /// Letters of a text that none of them has.
    pub fn lacks(&self, text: &str) -> BTreeSet<char> {
        // Signs that only join or part letters are not drawn.
        text.chars().filter(|c| !is_plain(*c) && !self.0.iter().any(|face| face.has(*c))).collect()
    }

    /// Families of further fonts, for documents whose letters are set by others.
    pub fn families(&self) -> Vec<&str> {
        self.0.iter().skip(1).map(|face| face.family.as_str()).filter(|family| !family.is_empty()).collect()
    }
}

/// Whether a character needs no ink.
pub(super) fn is_plain(c: char) -> bool {
    c.is_control()
        || c.is_whitespace()
        || super::bidi::states_direction(c)
        || matches!(c, '\u{200b}'..='\u{200f}' | '\u{61c}' | '\u{2060}' | '\u{fe00}'..='\u{fe0f}' | '\u{feff}')
}

/// Fonts of a file and which of `letters` each draws; empty for files that are no fonts. With `shaped`, only letters for whose script
/// the font has rules of joining and placing, where the script needs such rules.
pub fn fonts_in(bytes: &[u8], letters: &BTreeSet<char>, shaped: bool) -> Vec<BTreeSet<char>> {
    let faces = (0..MOST_FACES).map_while(|index| FontRef::from_index(bytes, index).ok());
    let drawn = |face: FontRef<'_>| {
        let scripts = scripts(&face);
        let sets = |c: &char| draws(&face, *c) && (!shaped || has_rules(&scripts, *c));
        letters.iter().copied().filter(sets).collect()
    };
    // A file of one font gives it for every number.
    let one = !bytes.starts_with(b"ttcf");
    faces.take(if one { 1 } else { MOST_FACES as usize }).map(drawn).collect()
}

/// Scripts whose letters change with their neighbours: first and last letter, and the tags of their rules.
/// Source: the registry of script tags of OpenType.
const JOINED: [(char, char, [&[u8; 4]; 2]); 15] = [
    ('\u{600}', '\u{6ff}', [b"arab", b"arab"]),
    ('\u{700}', '\u{74f}', [b"syrc", b"syrc"]),
    ('\u{750}', '\u{77f}', [b"arab", b"arab"]),
    ('\u{900}', '\u{97f}', [b"dev2", b"deva"]),
    ('\u{980}', '\u{9ff}', [b"bng2", b"beng"]),
    ('\u{a00}', '\u{a7f}', [b"gur2", b"guru"]),
    ('\u{a80}', '\u{aff}', [b"gjr2", b"gujr"]),
    ('\u{b00}', '\u{b7f}', [b"ory2", b"orya"]),
    ('\u{b80}', '\u{bff}', [b"tml2", b"taml"]),
    ('\u{c00}', '\u{c7f}', [b"tel2", b"telu"]),
    ('\u{c80}', '\u{cff}', [b"knd2", b"knda"]),
    ('\u{d00}', '\u{d7f}', [b"mlm2", b"mlym"]),
    ('\u{d80}', '\u{dff}', [b"sinh", b"sinh"]),
    ('\u{1000}', '\u{109f}', [b"mym2", b"mymr"]),
    ('\u{1780}', '\u{17ff}', [b"khmr", b"khmr"]),
];

/// Tags of the scripts for which a font has rules of substitution.
fn scripts(face: &FontRef<'_>) -> Vec<[u8; 4]> {
    let list = face.gsub().and_then(|table| table.script_list());
    list.map(|list| list.script_records().iter().map(|record| record.script_tag().to_be_bytes()).collect())
        .unwrap_or_default()
}

fn has_rules(scripts: &[[u8; 4]], letter: char) -> bool {
    let joined = JOINED.iter().find(|(first, last, _)| (*first..=*last).contains(&letter));
    joined.is_none_or(|(_, _, tags)| tags.iter().any(|tag| scripts.contains(tag)))
}
