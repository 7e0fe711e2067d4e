use super::testing::{Layout, write_dcd, write_dcd_as, write_xtc, write_xtc_as};
use super::*;
use std::panic::catch_unwind;
use std::time::{Duration, Instant};

/// Two frames of four molecules of water that MDAnalysis 2.11 wrote, with runs of up to four neighbours.
const WATER: &str = "\
    000007cb0000000c00000000000000004100000000000000000000000000000041000000000000000000000000000000410000000000000c\
    447a0000fffffe58fffffe51ffffff74fffffff0ffffff680000008f000000150000002aa9c15b428d907a8aced0e91770c2a68de51f5b11\
    f54ad296345517ce1ba34cd09a80a8d2ff90bd1bff800000000007cb0000000c000000014000000041000000000000000000000000000000\
    41000000000000000000000000000000410000000000000c447a0000fffffe4dfffffe14ffffff6900000006ffffff850000009600000015\
    0000002c6c189e219f833b220f5359229d929b65c9a8d539d3df4593f9b8d06e24cd76914f8d2a009400b8dadc353090";

/// Its places in hundredths of an angstrom.
#[rustfmt::skip]
const WATER_PLACES: [[[i16; 3]; 12]; 2] = [
    [[-349, -258, 81], [-374, -175, 122], [-376, -325, 143], [-51, -344, -140], [-144, -350, -122], [-16, -431, -123],
     [-113, -304, 41], [-141, -223, -1], [-88, -362, -32], [-332, -165, -90], [-424, -152, -111], [-332, -225, -15]],
    [[-343, -225, 75], [-401, -158, 140], [-383, -349, 150], [-126, -323, -125], [-194, -348, -150], [6, -492, -151],
     [-91, -269, -24], [-156, -213, -20], [-40, -397, -21], [-363, -123, -91], [-435, -204, -61], [-310, -202, 19]],
];

fn water() -> Vec<u8> {
    let digits = WATER.as_bytes().as_chunks::<2>().0;
    digits.iter().map(|d| u8::from_str_radix(str::from_utf8(d).unwrap(), 16).unwrap()).collect()
}

/// A generator of numbers by xorshift.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % limit
    }

    /// From minus to plus `extent`, in hundredths.
    fn place(&mut self, extent: usize) -> [f32; 3] {
        [0; 3].map(|_| (self.below(200 * extent + 1) as f32 - 100.0 * extent as f32) / 100.0)
    }
}

/// Frames of molecules of three atoms near each other.
fn frames(count: usize, atoms: usize, extent: usize) -> Vec<Vec<[f32; 3]>> {
    let mut random = Random(42);
    let mut frame = || {
        let mut places: Vec<[f32; 3]> = Vec::new();
        for i in 0..atoms {
            let near = random.place(1);
            let place =
                if i % 3 == 0 { random.place(extent) } else { [0, 1, 2].map(|k| places[i / 3 * 3][k] + near[k]) };
            places.push(place);
        }
        places
    };
    (0..count).map(|_| frame()).collect()
}

fn assert_near(read: &[Vec<[f32; 3]>], written: &[Vec<[f32; 3]>], tolerance: f32) {
    assert_eq!(read.len(), written.len());
    for (read, written) in read.iter().zip(written) {
        assert_eq!(read.len(), written.len());
        for (r, w) in read.as_flattened().iter().zip(written.as_flattened()) {
            assert!((r - w).abs() <= tolerance, "{r} is read where {w} was written");
        }
    }
}

fn error(bytes: &[u8]) -> String {
    read(bytes, &Wanted::ALL).unwrap_err()
}

#[test]
fn water_of_another_program_has_its_places() {
    let read = read(&water(), &Wanted::ALL).unwrap();
    assert_eq!(
        (read.format, read.atoms, read.frames_in_file, read.step_ps, read.cut_off),
        ("XTC", 12, 2, Some(2.0), false)
    );
    let written = WATER_PLACES.map(|frame| frame.map(|place| place.map(|v| f32::from(v) / 100.0)).to_vec());
    assert_near(&read.frames, &written, 1e-5);
}

#[test]
fn xtc_comes_back_in_all_its_codings() {
    // Plain, runs, no runs, a joined number of over 56 bits, and one number for each axis.
    for (atoms, extent) in [(1, 20), (9, 20), (10, 20), (301, 20), (300, 1), (300, 20_000), (300, 200_000)] {
        let written = frames(4, atoms, extent);
        for magic in [1995, 2023] {
            let bytes = write_xtc_as(&written, 0.5, magic);
            assert_eq!(kind_of(&bytes), Some(Kind::Xtc));
            let read = read(&bytes, &Wanted::ALL).unwrap();
            assert_eq!((read.atoms, read.frames_in_file, read.step_ps), (atoms, 4, Some(0.5)));
            assert_near(&read.frames, &written, 0.006 + extent as f32 * 1e-7);
        }
    }
    let apart: Vec<[f32; 3]> = (0..12).map(|i| [2e6 * (i % 4) as f32, -3e5 * i as f32, 0.0]).collect();
    let apart = [apart];
    assert_near(&read(&write_xtc(&apart, 1.0), &Wanted::ALL).unwrap().frames, &apart, 0.5);
}

#[test]
fn atoms_at_one_place_are_read() {
    let written = vec![vec![[1.5, -2.5, 3.5]; 20]; 2];
    assert_near(&read(&write_xtc(&written, 1.0), &Wanted::ALL).unwrap().frames, &written, 0.001);
}

#[test]
fn dcd_comes_back_in_all_its_layouts() {
    let mut written = frames(5, 30, 20);
    for i in 0..64 {
        let has = |bit: usize| i >> bit & 1 == 1;
        let fixed = [0, 1, 12, 29][i >> 4];
        let layout = Layout { big: has(0), xplor: has(1), cell: has(2) && !has(1), fourth: has(3) && !has(1), fixed };
        for k in 1..5 {
            let fixed = written[0][..layout.fixed].to_vec();
            written[k][..layout.fixed].copy_from_slice(&fixed);
        }
        let bytes = write_dcd_as(&written, 2.0, layout);
        assert_eq!(kind_of(&bytes), Some(Kind::Dcd));
        let all = read(&bytes, &Wanted::ALL).unwrap();
        assert_eq!((all.format, all.atoms, all.frames_in_file, all.step_ps), ("DCD", 30, 5, Some(2.0)));
        assert_eq!(all.frames, written);
        // Fixed atoms are those of the first frame, wanted or not.
        assert_eq!(read(&bytes, &Wanted { first: 3, every: 1, most: 1 }).unwrap().frames, written[3..4]);
    }
}

#[test]
fn twelve_atoms_are_not_a_unit_cell() {
    for cell in [false, true] {
        let written = frames(3, 12, 20);
        let bytes = write_dcd_as(&written, 2.0, Layout { cell, ..Layout::default() });
        assert_eq!(read(&bytes, &Wanted::ALL).unwrap().frames, written);
    }
}

#[test]
fn wanted_frames_are_read_alone() {
    let written = frames(10, 30, 20);
    for bytes in [write_dcd(&written, 1.0), write_xtc(&written, 1.0)] {
        let all = read(&bytes, &Wanted::ALL).unwrap().frames;
        let some = |first, every, most| {
            let read = read(&bytes, &Wanted { first, every, most }).unwrap();
            assert_eq!(read.frames_in_file, 10);
            read.frames
        };
        assert_eq!(some(1, 4, usize::MAX), [all[1].clone(), all[5].clone(), all[9].clone()]);
        assert_eq!(some(1, 4, 2), [all[1].clone(), all[5].clone()]);
        assert_eq!(some(8, 0, 9), all[8..]);
        assert_eq!(some(9, usize::MAX, usize::MAX), all[9..]);
        assert!(some(0, 1, 0).is_empty());
        let text = read(&bytes, &Wanted { first: 10, every: 1, most: 1 }).unwrap_err();
        assert_eq!(text, "frame 11 is wanted first and the file ends with frame 10; begin at an earlier one");
    }
}

#[test]
fn frames_that_are_not_wanted_are_not_decoded() {
    let mut bytes = write_xtc(&frames(3, 30, 20), 1.0);
    let length = bytes.len() / 3;
    bytes[length + 100..2 * length - 20].fill(0xff);
    assert!(error(&bytes).starts_with("frame 2: "));
    assert_eq!(read(&bytes, &Wanted { first: 0, every: 2, most: 9 }).unwrap().frames.len(), 2);
}

#[test]
fn the_time_between_frames_is_that_of_even_ones() {
    let step = |times: &[f32]| {
        let mut bytes = Vec::new();
        for time in times {
            let mut frame = write_xtc(&frames(1, 3, 20), 1.0);
            frame[12..16].copy_from_slice(&time.to_be_bytes());
            bytes.extend(frame);
        }
        read(&bytes, &Wanted::ALL).unwrap().step_ps
    };
    assert_eq!(step(&[0.0, 0.02, 0.04, 0.06]), Some(0.02));
    // A microsecond in, where single precision has steps of 0.06 ps.
    assert_eq!(step(&[1e6, 1_000_000.1, 1_000_000.2]).map(|ps| (ps * 10.0).round()), Some(1.0));
    for none in
        [&[5.0_f32] as &[f32], &[0.0, 1.0, 3.0], &[1.0, 1.0], &[2.0, 1.0], &[0.0, f32::NAN], &[0.0, f32::INFINITY]]
    {
        assert_eq!(step(none), None, "{none:?}");
    }
}

#[test]
fn a_dcd_file_may_not_know_its_time() {
    let written = frames(2, 3, 20);
    // The step of the simulation that converters write.
    assert_eq!(read(&write_dcd(&written, 10.0 * 0.048_888_21), &Wanted::ALL).unwrap().step_ps, None);
    let mut bytes = write_dcd(&written, 1.0);
    bytes[100..117].copy_from_slice(b"Written by LAMMPS");
    assert_eq!(read(&bytes, &Wanted::ALL).unwrap().step_ps, None);
    for none in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(read(&write_dcd(&written, none), &Wanted::ALL).unwrap().step_ps, None);
    }
}

#[test]
fn titles_may_be_longer_than_their_markers_say() {
    let mut bytes = write_dcd(&frames(2, 30, 20), 1.0);
    bytes.splice(100..180, [b' '; 240]);
    bytes[96] = 3;
    assert_eq!(read(&bytes, &Wanted::ALL).unwrap().frames_in_file, 2);
}

#[test]
fn whole_frames_of_a_cut_file_are_read() {
    let written = frames(3, 30, 20);
    let (dcd, xtc, small) = (write_dcd(&written, 1.0), write_xtc(&written, 1.0), write_xtc(&frames(3, 9, 20), 1.0));
    let mut ends = 0;
    for bytes in [dcd, xtc, small, water()] {
        let all = read(&bytes, &Wanted::ALL).unwrap();
        for length in 12..bytes.len() {
            match read(&bytes[..length], &Wanted::ALL) {
                Ok(read) => {
                    assert_eq!(read.frames, all.frames[..read.frames_in_file]);
                    assert!(read.frames_in_file > 0 && read.frames_in_file < all.frames_in_file);
                    ends += usize::from(!read.cut_off);
                }
                Err(text) => assert!(text.contains("cut off"), "{text}"),
            }
        }
    }
    // Cut between frames.
    assert_eq!(ends, 2 + 2 + 2 + 1);
}

#[test]
fn what_is_wrong_is_said() {
    let xtc = write_xtc(&frames(2, 30, 20), 1.0);
    let changed = |bytes: &[u8], at: usize, value: [u8; 4]| {
        let mut bytes = bytes.to_vec();
        bytes[at..at + 4].copy_from_slice(&value);
        error(&bytes)
    };
    let second = xtc.len() - write_xtc(&frames(2, 30, 20)[1..], 1.0).len();
    let (dcd, wide) = (write_dcd(&frames(2, 30, 20), 1.0), 2_000_000_000_u32);
    let mut texts = vec![
        (error(b"REMARK"), "neither XTC nor DCD"),
        (error(&[]), "its 0 bytes"),
        (error(&xtc[..60]), "its first frame needs 92; it is cut off or damaged"),
        (changed(&xtc, second, [0; 4]), "frame 2: it begins with 0 where 1995 or 2023 is needed"),
        (changed(&xtc, 4, wide.to_be_bytes()), "frame 1: it states 2000000000 atoms, then 30"),
        (changed(&xtc, 56, [0; 4]), "frame 1: its precision is 0 where a number above 0"),
        (changed(&xtc, 56, f32::NAN.to_be_bytes()), "frame 1: its precision is NaN"),
        (changed(&xtc, 56, 1e-40_f32.to_be_bytes()), "frame 1: atom 1 is not at a finite place"),
        (changed(&xtc, 60, i32::MAX.to_be_bytes()), "which is no extent"),
        (changed(&xtc, 84, 73_u32.to_be_bytes()), "is 73 where 9 to 72 is needed"),
        (changed(&xtc, 84, 3_u32.to_be_bytes()), "is 3 where 9 to 72 is needed"),
        (error(&[xtc.as_slice(), &water()].concat()), "frame 3 has 12 atoms and the frames before have 30"),
        (
            changed(&write_xtc(&frames(2, 3, 20), 1.0), 60, f32::NAN.to_be_bytes()),
            "frame 1: atom 1: a coordinate is NaN nm",
        ),
        (
            changed(&write_xtc(&frames(2, 3, 20), 1.0), 80, f32::MAX.to_be_bytes()),
            "frame 1: atom 3: a coordinate is 3.4",
        ),
        (changed(&dcd, 4, *b"VELD"), "it holds velocities"),
        (changed(&dcd, 92, [1, 0, 0, 0]), "the title: a record states 1 bytes before it"),
        (changed(&dcd, 188, wide.to_le_bytes()), "the record of x of 2000000000 atoms has 120 bytes"),
        (changed(&dcd, 188, [0; 4]), "it states 0 atoms"),
        (changed(&dcd, 40, 30_u32.to_le_bytes()), "30 of 30 atoms are stated to be fixed"),
        (changed(&dcd, 40, 3_u32.to_le_bytes()), "the list of 27 free atoms has 48 bytes"),
        (changed(&dcd, 256, f32::NAN.to_le_bytes()), "frame 1: atom 1 is at (NaN, "),
        (error(&dcd[..196]), "no frame follows its head"),
        (error(&dcd[..300]), "104 bytes follow its head where a record of its first frame needs 128"),
        (error(&[[84, 0, 0, 0, 0, 0, 0, 0].as_slice(), b"CORD"].concat()), "its records have markers of 64 bits"),
    ];
    // A few bytes cannot hold so many atoms.
    let mut claims = xtc.clone();
    claims[4..8].copy_from_slice(&wide.to_be_bytes());
    claims[52..56].copy_from_slice(&wide.to_be_bytes());
    texts.push((error(&claims), "2000000000 atoms are stated in "));
    for (text, part) in texts {
        assert!(text.contains(part), "{text:?} does not contain {part:?}");
        assert!(text.len() < 400 && !text.contains('\n'));
    }
}

#[test]
fn damaged_files_are_read_or_refused_without_panic() {
    let written = frames(3, 40, 20);
    let layout = Layout { big: true, cell: true, fourth: true, fixed: 7, ..Layout::default() };
    let files = [
        water(),
        write_xtc(&written, 1.0),
        write_xtc_as(&frames(2, 300, 20_000), 1.0, 2023),
        write_xtc(&frames(3, 9, 20), 1.0),
        write_dcd(&written, 1.0),
        write_dcd_as(&written, 1.0, layout),
    ];
    let (mut random, mut refused) = (Random(7), 0);
    for number in 0..12_000 {
        let mut bytes = files[number % files.len()].clone();
        for _ in 0..=random.below(4) {
            // Half of the changes are in the first head.
            let limit = if random.below(2) == 0 { 200.min(bytes.len()) } else { bytes.len() };
            let at = random.below(limit);
            bytes[at] = [random.below(256) as u8, 0, 0xff, bytes[at] ^ 1 << random.below(8)][random.below(4)];
        }
        if random.below(3) == 0 {
            bytes.truncate(random.below(bytes.len() + 1));
        }
        let start = Instant::now();
        let read = catch_unwind(|| read(&bytes, &Wanted::ALL)).unwrap_or_else(|_| panic!("panic by change {number}"));
        assert!(start.elapsed() < Duration::from_secs(1), "change {number} takes long");
        match read {
            Ok(read) => {
                assert!(read.frames.iter().all(|frame| frame.len() == read.atoms));
                assert!(read.frames.iter().flatten().flatten().all(|value| value.is_finite()));
            }
            Err(text) => {
                assert!(text.len() < 400, "{text}");
                refused += 1;
            }
        }
    }
    assert!(refused > 4000, "{refused} of the files are refused");
}
