use super::*;

fn blank([width, height]: [usize; 2], color: [u8; 3]) -> Frame {
    Frame { width, height, color: vec![color; width * height], ..Frame::default() }
}

/// Pixels to the right of the middle that are of a colour.
fn of(frame: &Frame, color: Color) -> Vec<usize> {
    let row = frame.height / 2 * frame.width;
    let is = |x: &usize| frame.color[row + x] == [color.r, color.g, color.b];
    (frame.width / 2..frame.width).filter(is).map(|x| x - frame.width / 2).collect()
}

#[test]
fn the_mark_has_the_size_of_symbols_and_grows_with_large_pictures() {
    for (size, density, unit) in
        [([640, 400], 1.0, 1.0), ([640, 400], 2.0, 2.0), ([2560, 1440], 1.0, 2.0), ([120, 60], 1.0, 6.0 / 17.0)]
    {
        let mut frame = blank(size, [120, 90, 70]);
        assert!((unit_px(&frame, density) - unit).abs() < 1e-12, "{size:?}");
        if unit < 1.0 {
            // Lines as thin as a pixel have no pixel of their own colour.
            continue;
        }
        draw(&mut frame, DVec2::new(size[0] as f64 / 2.0, size[1] as f64 / 2.0), false, density);
        let line = of(&frame, COLORS[2]);
        let [first, last] = [line[0], line[line.len() - 1]].map(|x| x as f64 / unit);
        let within = 2.0 / unit;
        assert!((first - RADIUS).abs() < within + 2.0 && (last - STROKES).abs() < within + 2.0, "{first} {last}");
    }
}

#[test]
fn both_casings_surround_the_line_and_the_point_stays_free() {
    let ground = [120, 90, 70];
    let mut frame = blank([400, 400], ground);
    draw(&mut frame, DVec2::splat(200.0), false, 2.0);
    let row = &frame.color[200 * 400 + 200..200 * 400 + 400];
    assert!(row[..24].iter().all(|c| *c == ground), "free within the ring");
    let [dark, light, line] = COLORS.map(|c| of(&frame, c)[0]);
    assert!(24 <= dark && dark < light && light < line && line < 34, "{dark} {light} {line}");
}

#[test]
fn a_hidden_point_has_a_ring_of_dashes() {
    let drawn = |hidden: bool| {
        let mut frame = blank([200, 200], [120, 90, 70]);
        draw(&mut frame, DVec2::splat(100.0), hidden, 1.0);
        frame.color.iter().filter(|c| **c == [208, 20, 88]).count()
    };
    let [whole, dashed] = [false, true].map(drawn);
    assert!(dashed > 100 && 10 * dashed < 8 * whole, "{dashed} of {whole}");
}
