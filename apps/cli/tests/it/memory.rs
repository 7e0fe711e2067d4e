//! The budget of memory through the command line: one line and exit code 2, under a limit of the system too.

use super::Place;
use std::process::Command;

/// Heights of 16384 x 16384 samples of 16 bits in tiles as high as the raster, so that no band of it can be read alone, which all lie at one
/// place: 0.5 GiB of samples in 8 MiB.
fn heights(place: &Place) -> String {
    const SIDE: u32 = 16_384;
    let tiles = SIDE / 256;
    let tile = 256 * SIDE * 2;
    let lists = 8 + tile;
    let entries: [(u16, u16, u32, u32); 11] = [
        (256, 4, 1, SIDE),
        (257, 4, 1, SIDE),
        (258, 3, 1, 16),
        (259, 3, 1, 1),
        (262, 3, 1, 1),
        (277, 3, 1, 1),
        (322, 4, 1, 256),
        (323, 4, 1, SIDE),
        (324, 4, tiles, lists),
        (325, 4, tiles, lists + 4 * tiles),
        (339, 3, 1, 2),
    ];
    let mut out = b"II*\0".to_vec();
    out.extend((lists + 8 * tiles).to_le_bytes());
    out.resize(lists as usize, 0);
    (0..tiles).for_each(|_| out.extend(8u32.to_le_bytes()));
    (0..tiles).for_each(|_| out.extend(tile.to_le_bytes()));
    out.extend((entries.len() as u16).to_le_bytes());
    for (tag, kind, count, value) in entries {
        out.extend(tag.to_le_bytes());
        out.extend(kind.to_le_bytes());
        out.extend(count.to_le_bytes());
        out.extend(value.to_le_bytes());
    }
    out.extend(0u32.to_le_bytes());
    std::fs::write(place.path("heights.tif"), out).expect("written");
    "heights.tif".into()
}

/// Runs the program with a limit of address space, KiB, expects exit code 2 and one line, and returns it.
fn fails_within(place: &Place, kib: u64, args: &[&str]) -> String {
    let program = place.command(args);
    let mut shell = Command::new("sh");
    shell.arg("-c").arg(format!("ulimit -v {kib}; exec \"$0\" \"$@\"")).arg(program.get_program()).args(args);
    shell.current_dir(place.path("."));
    for (name, value) in program.get_envs() {
        if let Some(value) = value {
            shell.env(name, value);
        }
    }
    let out = shell.output().expect("the program starts");
    let text = String::from_utf8(out.stderr).expect("UTF-8");
    assert_eq!(out.status.code(), Some(2), "{args:?}: {text}");
    assert!(text.lines().count() == 1 && text.starts_with("belvedere: "), "{text}");
    text
}

#[test]
fn what_passes_the_budget_is_refused_before_it_is_read() {
    let place = Place::new();
    let file = heights(&place);
    let line = place.fails(&["info", &file, "--max-mem", "256MiB", "-q"]);
    assert!(line.contains("heights.tif: the raster needs 2603 MiB") && line.ends_with("(--max-mem)"), "{line}");
}

/// The budget by default is a part of what the system gives.
#[test]
fn a_limit_of_the_system_is_obeyed() {
    let place = Place::new();
    let file = heights(&place);
    let line = fails_within(&place, 2 << 20, &["info", &file, "-q"]);
    assert!(line.contains("the raster needs 2603 MiB") && line.contains("allow more memory"), "{line}");
}

/// A budget beyond what the system gives is cut to that.
#[test]
fn a_budget_beyond_the_system_is_refused_in_one_line() {
    let place = Place::new();
    let file = heights(&place);
    let line = fails_within(&place, 1 << 20, &["info", &file, "-q", "--max-mem", "64GiB"]);
    assert!(line.contains("the raster needs 2603 MiB"), "{line}");
}

/// A tree of JSON takes far more than its text, which no estimate foresees.
#[test]
fn what_no_estimate_foresees_ends_in_one_line() {
    let place = Place::new();
    let positions = "[0,0],".repeat(700_000);
    place.write("way.geojson", &format!(r#"{{"type":"LineString","coordinates":[{positions}[1,1]]}}"#));
    let line = place.fails(&["info", "way.geojson", "--max-mem", "64MiB", "-q"]);
    assert!(line.contains("way.geojson: ") && line.contains("the budget of memory is 64 MiB"), "{line}");
}

/// Address space that the system refuses where no code of ours asked for it: the standard library says so, and the program ends with 2.
#[test]
#[cfg(unix)]
fn a_refused_allocation_is_no_abort() {
    let place = Place::new();
    let positions = "[0,0],".repeat(1_400_000);
    place.write("way.geojson", &format!(r#"{{"type":"LineString","coordinates":[{positions}[1,1]]}}"#));
    let limited = "ulimit -v 307200; exec \"$0\" info way.geojson -q";
    let mut shell = Command::new("sh");
    shell.current_dir(place.path(".")).args(["-c", limited, env!("CARGO_BIN_EXE_belvedere")]);
    let out = shell.output().expect("the program starts");
    let text = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(2), "{text}");
    assert!(text.contains("memory") && !text.contains("panicked"), "{text}");
}
