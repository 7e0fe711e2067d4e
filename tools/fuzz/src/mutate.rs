//! Damage to files, by seed: bits, bytes, numbers, lengths, chunks, lines and words.

use belvedere::core::random::Random;

/// Largest mutated file, bytes.
const MOST: usize = 1 << 16;
/// Numbers in texts that readers must withstand.
const NUMBERS: &[&str] = &[
    "0",
    "-1",
    "1",
    "-0",
    "NaN",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e-320",
    "1e999",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551616",
    "-9223372036854775808",
    "2147483647",
    "65536",
    "100000",
    "0.0000001",
    "180",
    "90.0000001",
    "",
];
/// The same in binary files.
const VALUES: &[u64] = &[
    0,
    1,
    2,
    0x7f,
    0x80,
    0xff,
    0x7fff,
    0x8000,
    0xffff,
    0x1_0000,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x7fff_ffff_ffff_ffff,
    0x8000_0000_0000_0000,
    u64::MAX,
    // Not a number, infinity, and large and small floats of 4 and 8 bytes.
    0x7fc0_0000,
    0x7f80_0000,
    0x7f7f_ffff,
    0x0000_0001,
    0x7ff8_0000_0000_0000,
    0x7ff0_0000_0000_0000,
    0x7fef_ffff_ffff_ffff,
    0x7e37_e43c_8800_759c,
];
const BYTES: &[u8] = b"\x00\x01\x7f\x80\xff\n\r\t \"'<>{}[](),:;/\\=#-+.eE09";

/// One of the seeds with one change, or up to four.
pub fn mutated(seeds: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let seed = pick(seeds, random);
    let mut bytes = seed.clone();
    // Most files have one fault only: others are refused before the second is met.
    for _ in 0..[1, 1, 1, 2, 3, 4][random.below(6)] {
        change(&mut bytes, seeds, random);
        bytes.truncate(MOST);
    }
    while bytes == *seed {
        change(&mut bytes, seeds, random);
    }
    if bytes.starts_with(b"\x89PNG") {
        mend_png(&mut bytes);
    }
    bytes
}

/// Writes the right checksums into the chunks of a PNG, without which its reader refuses any damage.
fn mend_png(bytes: &mut [u8]) {
    let mut at = 8;
    while let Some(length) = bytes.get(at..at + 4).map(|b| b.iter().fold(0usize, |n, b| n << 8 | usize::from(*b))) {
        let end = at.saturating_add(8).saturating_add(length);
        let Some(content) = bytes.get(at + 4..end) else { return };
        let crc = !content.iter().fold(u32::MAX, |crc, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |c, _| if c & 1 == 1 { c >> 1 ^ 0xedb8_8320 } else { c >> 1 })
        });
        let Some(place) = bytes.get_mut(end..end + 4) else { return };
        place.copy_from_slice(&crc.to_be_bytes());
        at = end + 4;
    }
}

fn pick<'l, T>(list: &'l [T], random: &mut Random) -> &'l T {
    &list[random.below(list.len())]
}

/// A random part of `length` bytes, more often short.
fn part(length: usize, random: &mut Random) -> std::ops::Range<usize> {
    let start = random.below(length.max(1)).min(length);
    let most = match random.below(3) {
        0 => 4,
        1 => 64,
        _ => length,
    };
    start..(start + 1 + random.below(most.max(1))).min(length)
}

fn change(bytes: &mut Vec<u8>, seeds: &[Vec<u8>], random: &mut Random) {
    if bytes.is_empty() {
        bytes.push(random.bits() as u8);
        return;
    }
    let length = bytes.len();
    let at = random.below(length);
    match random.below(20) {
        0 | 1 => bytes[at] ^= 1 << random.below(8),
        2 => bytes[at] = *pick(BYTES, random),
        3 => bytes.truncate(at),
        4 => drop(bytes.drain(part(length, random))),
        5 => {
            // A chunk again, once or so often that lists and nesting grow.
            let chunk = bytes[part(length, random)].to_vec();
            let times = if random.below(4) == 0 { 64 } else { 1 };
            bytes.splice(at..at, chunk.repeat(times));
        }
        6 => {
            let other = pick(seeds, random);
            bytes.truncate(at);
            bytes.extend(&other[random.below(other.len().max(1)).min(other.len())..]);
        }
        7 => {
            let (a, b) = (part(length, random), part(length, random));
            let (first, second) = if a.start <= b.start { (a, b) } else { (b, a) };
            if first.end <= second.start {
                let (x, y) = (bytes[first.clone()].to_vec(), bytes[second.clone()].to_vec());
                bytes.splice(second, x);
                bytes.splice(first, y);
            }
        }
        8 => {
            let noise: Vec<u8> = (0..1 + random.below(8)).map(|_| random.bits() as u8).collect();
            bytes.splice(at..at, noise);
        }
        9 | 10 => lines(bytes, random),
        11 | 12 => words(bytes, random),
        13..=15 => number_in_binary(bytes, at, random),
        _ => number_in_text(bytes, at, random),
    }
}

/// Replaces the number at or after a place.
fn number_in_text(bytes: &mut Vec<u8>, at: usize, random: &mut Random) {
    let is_part = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'+');
    let Some(start) = (at..bytes.len()).find(|&i| bytes[i].is_ascii_digit()) else { return };
    let start = (0..start).rev().take_while(|&i| is_part(&bytes[i])).last().unwrap_or(start);
    let end = (start..bytes.len()).find(|&i| !is_part(&bytes[i])).unwrap_or(bytes.len());
    let new = match random.below(4) {
        0 => [b"-", &bytes[start..end]].concat(),
        1 => [&bytes[start..end], b"000000".as_slice()].concat(),
        _ => pick(NUMBERS, random).as_bytes().to_vec(),
    };
    bytes.splice(start..end, new);
}

/// Replaces the integer or float of 1 to 8 bytes at a place, in either order of bytes.
fn number_in_binary(bytes: &mut [u8], at: usize, random: &mut Random) {
    let size = [1, 2, 4, 8][random.below(4)].min(bytes.len() - at);
    let is_big = random.below(2) == 0;
    let place = &mut bytes[at..at + size];
    if is_big {
        place.reverse();
    }
    let old = place.iter().rev().fold(0u64, |v, b| v << 8 | u64::from(*b));
    let new = match random.below(5) {
        0 => old.wrapping_add(1),
        1 => old.wrapping_sub(1),
        2 => old.wrapping_mul(2),
        _ => *pick(VALUES, random),
    };
    place.copy_from_slice(&new.to_le_bytes()[..size]);
    if is_big {
        place.reverse();
    }
}

/// Removes, repeats or exchanges lines.
fn lines(bytes: &mut Vec<u8>, random: &mut Random) {
    let mut list: Vec<Vec<u8>> = bytes.split(|b| *b == b'\n').map(<[u8]>::to_vec).collect();
    let (a, b) = (random.below(list.len()), random.below(list.len()));
    match random.below(3) {
        0 => drop(list.remove(a)),
        1 => list.insert(b, list[a].clone()),
        _ => list.swap(a, b),
    }
    *bytes = list.join(&b'\n');
}

/// Writes one word of the file in place of another.
fn words(bytes: &mut Vec<u8>, random: &mut Random) {
    let is_word = |b: &u8| b.is_ascii_alphanumeric() || *b == b'_' || *b >= 0x80;
    let mut list = Vec::new();
    let mut i = 0;
    while i < bytes.len() {
        let end = (i..bytes.len()).find(|&k| !is_word(&bytes[k])).unwrap_or(bytes.len());
        if end > i {
            list.push(i..end);
        }
        i = end + 1;
    }
    if !list.is_empty() {
        let (to, from) = (pick(&list, random).clone(), pick(&list, random).clone());
        let word = bytes[from].to_vec();
        bytes.splice(to, word);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_gives_the_same_damage_and_all_of_it_differs() {
        let seeds = crate::seeds::vectors::gpx();
        let made = |seed| mutated(&seeds, &mut Random::new(seed));
        let all: std::collections::BTreeSet<Vec<u8>> = (0..2000).map(made).collect();
        assert!((0..2000).all(|seed| made(seed) == made(seed) && made(seed).len() <= MOST));
        assert!(all.len() > 1800, "{}", all.len());
    }

    #[test]
    fn checksums_of_a_png_are_mended() {
        let whole = crate::seeds::rasters::png(5, 4);
        let mut broken = whole.clone();
        let place = whole.len() - 4;
        broken[place..].fill(0);
        broken[29..33].fill(7);
        mend_png(&mut broken);
        assert_eq!(broken, whole);
    }

    #[test]
    fn a_number_is_replaced_whole() {
        for seed in 0..200 {
            let mut bytes = b"x -12.50 y".to_vec();
            number_in_text(&mut bytes, 0, &mut Random::new(seed));
            assert!(bytes.starts_with(b"x ") && bytes.ends_with(b" y"), "{}", String::from_utf8_lossy(&bytes));
        }
    }
}
