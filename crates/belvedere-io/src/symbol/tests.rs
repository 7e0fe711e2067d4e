use super::*;

fn area(drawing: &Drawing) -> f64 {
    let ring = |ring: &Vec<DVec2>| {
        ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| 0.5 * a.perp_dot(*b)).sum::<f64>()
    };
    drawing.shapes.iter().map(|(rings, _)| rings.iter().map(ring).sum::<f64>().abs()).sum()
}

#[test]
fn shapes_are_read_with_their_places_colours_and_holes() {
    let svg = r##"<?xml version="1.0"?><svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 20 20">
            <title>hut</title><g transform="translate(10 10) scale(2)" fill="#f00">
            <rect x="-5" y="-5" width="10" height="10"/><circle r="2" fill="white"/></g>
            <path d="M0,0h20v20h-20z m5 5h10v10h-10z" fill-rule="evenodd" style="fill:#00ff00;stroke:none"/>
            <polygon points="0,0 4,0 0,4"/></svg>"##;
    let read = drawing(svg).expect("read");
    assert_eq!(read.shapes.len(), 4);
    let colors: Vec<_> = read.shapes.iter().map(|(_, color)| *color).collect();
    let rgb = Color::rgb;
    assert_eq!(colors, [Some(rgb(255, 0, 0)), Some(rgb(255, 255, 255)), Some(rgb(0, 255, 0)), None]);
    let of = |i: usize| area(&Drawing { shapes: vec![read.shapes[i].clone()] });
    assert!((of(0) - 4.0).abs() < 1e-9, "{}", of(0));
    assert!((of(1) - std::f64::consts::PI * 0.16).abs() < 0.01, "{}", of(1));
    // Four units of half sizes less the hole.
    assert!((of(2) - 3.0).abs() < 1e-9, "{}", of(2));
    assert!((of(3) - 0.08).abs() < 1e-9, "{}", of(3));
}

#[test]
fn what_is_not_read_is_refused_in_words() {
    let body = |body: &str| format!("<svg viewBox='0 0 10 10'>{body}</svg>");
    for (text, wanted) in [
        (body("<text>a</text>"), "<text>"),
        (body("<path d='M0 0h9v9z' stroke='#000'/>"), "stroke"),
        (body("<path d='M0 0h9v9z' fill='url(#g)'/>"), "fill"),
        (body("<path d='M0 0h9v9z' clip-path='url(#c)'/>"), "clip-path"),
        (body("<path d='M0 0 X9'/>"), "X"),
        (body("<g></g>"), "no filled shape"),
        (body("<style>path{fill:red}</style><path d='M0 0h9v9z'/>"), "<style>"),
        (body("<path transform='turn(3)' d='M0 0h9v9z'/>"), "transform"),
        (body("<path d='M0 0h1e9v9z'/>"), "viewBox"),
        ("<html/>".into(), "<html>"),
        ("<svg><path d='M0 0h9v9z'/></svg>".into(), "viewBox"),
        ("plain words".into(), "<svg>"),
        ("".into(), "<svg>"),
        ("<svg viewBox='0 0 1 1'><".into(), "XML"),
    ] {
        let said = drawing(&text).expect_err(&text);
        assert!(said.contains(wanted) && said.chars().count() < 300, "{text}: {said}");
    }
    assert!(drawing(&format!("<svg viewBox='0 0 9 9'>{}", "<g>".repeat(100))).is_err());
}

#[test]
fn no_text_is_ever_a_panic() {
    let pieces = [
        "M",
        "1,2",
        "a5 5 0 01 3 3",
        "z",
        "<path d='",
        "'/>",
        "<svg viewBox='0 0 9 9'>",
        "é",
        "-.5.5",
        "1e9",
        "Q",
        "<g>",
        "c",
        "&",
        "\"",
    ];
    let mut seed = 5u64;
    for _ in 0..4000 {
        let mut text = String::from("<svg viewBox='0 0 9 9'><path d='M1 1");
        for _ in 0..16 {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            text.push_str(pieces[(seed >> 33) as usize % pieces.len()]);
        }
        if let Ok(read) = drawing(&text) {
            assert!(read.shapes.iter().flat_map(|(rings, _)| rings.iter().flatten()).all(|p| p.is_finite()));
        }
    }
}
