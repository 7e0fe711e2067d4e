//! A font made for tests: every letter is a square, in a TrueType file of the tables that setting text needs.

/// The bytes of a font of this family with these letters, each half an em wide with a square of 0.4 em.
pub fn tiny_font(family: &str, letters: &[char]) -> Vec<u8> {
    let mut letters: Vec<char> = letters.to_vec();
    letters.sort_unstable();
    letters.dedup();
    let glyphs = letters.len() as u16 + 1;
    let tables: Vec<(&[u8; 4], Vec<u8>)> = vec![
        (b"cmap", cmap(&letters)),
        (b"glyf", (0..glyphs).flat_map(|_| square()).collect()),
        (b"head", head()),
        (b"hhea", words(&[1, 0, 800, -200i16 as u16, 0, 500, 0, 0, 500, 1, 0, 0, 0, 0, 0, 0, 0, glyphs])),
        (b"hmtx", words(&(0..glyphs).flat_map(|_| [500, 50]).collect::<Vec<_>>())),
        (b"loca", (0..=u32::from(glyphs)).flat_map(|i| (i * square().len() as u32).to_be_bytes()).collect()),
        (b"maxp", [words(&[1, 0, glyphs, 4, 1]), words(&[0; 11])].concat()),
        (b"name", name(family)),
    ];
    let mut out = words(&[1, 0, tables.len() as u16, 128, 3, 0]);
    let mut at = out.len() + 16 * tables.len();
    for (tag, data) in &tables {
        out.extend_from_slice(*tag);
        [0, at as u32, data.len() as u32].iter().for_each(|word| out.extend(word.to_be_bytes()));
        at += data.len().div_ceil(4) * 4;
    }
    for (_, data) in &tables {
        out.extend_from_slice(data);
        out.resize(out.len().div_ceil(4) * 4, 0);
    }
    out
}

fn words(values: &[u16]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_be_bytes()).collect()
}

/// One contour of four corners from (50, 0) to (450, 400).
fn square() -> Vec<u8> {
    let mut out = words(&[1, 50, 0, 450, 400, 3, 0]);
    out.extend([1u8; 4]);
    out.extend(words(&[50, 400, 0, -400i16 as u16]));
    out.extend(words(&[0, 0, 400, 0]));
    out.resize(out.len().div_ceil(4) * 4, 0);
    out
}

fn head() -> Vec<u8> {
    let mut out = words(&[1, 0, 1, 0, 0, 0, 0x5f0f, 0x3cf5, 0, 1000]);
    out.extend([0u8; 16]);
    out.extend(words(&[0, 0, 500, 800, 0, 8, 2, 1, 0]));
    out
}

/// Format 12: the n-th letter is glyph n + 1.
fn cmap(letters: &[char]) -> Vec<u8> {
    let mut out = words(&[0, 1, 3, 10, 0, 12]);
    out.extend(words(&[12, 0]));
    let groups = letters.len() as u32;
    [16 + 12 * groups, 0, groups].iter().for_each(|word| out.extend(word.to_be_bytes()));
    for (i, letter) in letters.iter().enumerate() {
        let code = u32::from(*letter);
        [code, code, i as u32 + 1].iter().for_each(|word| out.extend(word.to_be_bytes()));
    }
    out
}

fn name(family: &str) -> Vec<u8> {
    let text: Vec<u8> = words(&family.encode_utf16().collect::<Vec<_>>());
    let mut out = words(&[0, 1, 18, 3, 1, 0x409, 1, text.len() as u16, 0]);
    out.extend(text);
    out
}
