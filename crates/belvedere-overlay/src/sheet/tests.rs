use super::*;

fn doc(paper: Option<&str>, dpi: Option<f64>, margin_mm: Option<f64>) -> PrintDoc {
    PrintDoc { paper: paper.map(str::to_owned), dpi, margin_mm }
}

#[test]
fn sheets_have_the_pixels_of_their_inches() {
    let cases = [
        (doc(Some("A3"), Some(300.0), None), None, [420.0, 297.0], [4961, 3508]),
        (doc(Some("a3-portrait"), Some(300.0), None), None, [297.0, 420.0], [3508, 4961]),
        (doc(Some("A4"), None, Some(10.0)), None, [297.0, 210.0], [3272, 2244]),
        (doc(Some("254x127mm"), Some(100.0), None), None, [254.0, 127.0], [1000, 500]),
    ];
    for (doc, size, paper, pixels) in cases {
        let sheet = Sheet::of(&doc, size, [1280, 720]).expect("fits").expect("a sheet");
        assert_eq!((sheet.paper_mm, sheet.pixels()), (paper, pixels), "{doc:?}");
    }
    // A view that stands makes the sheet stand; a size makes the resolution, a resolution alone the paper.
    let of = |doc, size, shape| Sheet::of(&doc, size, shape).expect("fits").expect("a sheet");
    assert_eq!(of(doc(Some("A4"), None, None), None, [600, 900]).paper_mm, [210.0, 297.0]);
    let small = of(doc(Some("254x127mm"), None, None), Some([500, 250]), [1280, 720]);
    assert!((small.dpi - 50.0).abs() < 1e-9 && (small.density() - 50.0 / 96.0).abs() < 1e-9);
    let bare = of(doc(None, Some(100.0), Some(5.0)), Some([1000, 500]), [1280, 720]);
    assert_eq!((bare.paper_mm, bare.pixels()), ([264.0, 137.0], [1000, 500]));
    assert_eq!(Sheet::of(&PrintDoc::default(), Some([9, 9]), [1, 1]).expect("nothing asked for"), None);
    // What a sheet writes into a scene is read as the same sheet.
    assert_eq!(of(bare.document(), None, [1, 1]), bare);
}

#[test]
fn what_cannot_be_printed_is_refused_in_one_line() {
    let cases = [
        (doc(Some("A7"), None, None), "\"A7\" is not a paper; give A0 to A6"),
        (doc(Some("A3-upright"), None, None), "is not a paper"),
        (doc(Some("5x200mm"), None, None), "each side of a paper must be in 10..=10000 mm"),
        (doc(Some("axbmm"), None, None), "give width and height such as 420x297mm"),
        (doc(Some("A4"), Some(5.0), None), "5.0000 pixels per inch are asked for, they must be in 10..=2400"),
        (doc(Some("A4"), Some(f64::NAN), None), "must be in 10..=2400"),
        (doc(Some("A6"), None, Some(60.0)), "a margin of 60 mm leaves nothing of 148 x 105 mm"),
        (doc(Some("A0"), Some(2000.0), None), "2000 pixels per inch make 93622 pixels"),
        (doc(None, None, Some(3.0)), "a margin needs a paper"),
        (doc(Some("A4"), None, Some(-1.0)), "the margin is -1 mm"),
    ];
    for (doc, words) in cases {
        let error = Sheet::of(&doc, None, [1280, 720]).expect_err("refused").to_string();
        assert!(error.contains(words) && !error.contains('\n'), "{doc:?}: {error}");
    }
}
