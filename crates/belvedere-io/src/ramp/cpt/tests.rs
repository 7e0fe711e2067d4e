use super::*;

fn heights(ramp: &Ramp, range: [f64; 2]) -> Vec<f64> {
    ramp.stops.iter().map(|s| s.height.metres(range)).collect()
}

#[test]
fn slices_ends_and_notations_are_read() {
    let text = "# COLOR_MODEL = RGB\n0 10/20/30 500 60 L\n500 red 1000 #0a0b0c ; hills\nB black\nF 1/2/3\nN 128\n";
    let ramp = read(text).unwrap().value;
    assert_eq!(heights(&ramp, [0.0, 1.0]), [0.0, 500.0, 500.0, 1000.0]);
    let colors: Vec<Color> = ramp.stops.iter().map(|s| s.color).collect();
    let want = [[10, 20, 30], [60, 60, 60], [255, 0, 0], [10, 11, 12]].map(|[r, g, b]| Color::rgb(r, g, b));
    assert_eq!(colors, want);
    assert_eq!((ramp.below, ramp.above), (Some(Color::rgb(0, 0, 0)), Some(Color::rgb(1, 2, 3))));
    let old = read("-10 0 0 255 0 0 255 0\n0 1 2 3 20 4 5 6\n").unwrap().value;
    assert_eq!((heights(&old, [0.0, 1.0]), old.stops[3].color), (vec![-10.0, 0.0, 0.0, 20.0], Color::rgb(4, 5, 6)));
}

#[test]
fn hues_are_read_and_lie_between() {
    let table = "# COLOR_MODEL = +HSV\n0 0-1-1 90 120-1-1\n";
    let ramp = read(table).unwrap().value;
    let stops = ramp.resolved([0.0, 1.0]);
    assert_eq!(ramp.color_at(&stops, 45.0), Color::rgb(255, 255, 0), "yellow lies between red and green");
    let plain = read("# COLOR_MODEL = HSV\n0 0 1 1 90 120 1 1\n").unwrap().value;
    assert_eq!(plain.color_at(&plain.resolved([0.0, 1.0]), 45.0), Color::rgb(128, 128, 0));
}

#[test]
fn normalised_tables_span_the_ground_their_range_or_the_sides_of_the_hinge() {
    let slices = "-1 blue 0 cyan\n0 green 1 white\n";
    let at = |head: &str| heights(&read(&format!("{head}\n{slices}")).unwrap().value, [-200.0, 1000.0]);
    assert_eq!(at("# plain"), [-200.0, 400.0, 400.0, 1000.0]);
    assert_eq!(at("# HARD_HINGE"), [-200.0, 0.0, 0.0, 1000.0]);
    assert_eq!(at("#RANGE = -8000/8000\n# SOFT_HINGE"), [-8000.0, 0.0, 0.0, 8000.0]);
    assert_eq!(at("# RANGE = -100/300"), [-100.0, 100.0, 100.0, 300.0]);
}

#[test]
fn wrong_lines_are_named() {
    for (text, line, word) in [
        ("0 red 1\n", "line 1", "3 values"),
        ("# x\n0 red 5 mauve\n", "line 2", "mauve"),
        ("5 red 0 blue\n", "line 1", "below"),
        ("0 red\n", "line 1", "categories"),
        ("# COLOR_MODEL = CMYK\n0 1/2/3/4 5 1/2/3/4\n", "line 1", "CMYK"),
        ("0 1/2/3/4 5 1/2/3/4\n", "line 1", "1/2/3/4"),
        ("# RANGE = up\n", "line 1", "range"),
        ("B black\n", "no slice", "slice"),
    ] {
        let e = read(text).unwrap_err();
        assert!(e.contains(line) && e.contains(word), "{text}: {e}");
    }
}
