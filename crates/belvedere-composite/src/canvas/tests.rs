use super::*;

#[test]
fn a_recording_canvas_holds_in_pixels_what_another_one_draws() {
    let mut shapes = Vec::new();
    let mut canvas = Canvas::recording(&mut shapes, [60, 40]).scaled(2.0);
    assert_eq!(canvas.size(), DVec2::new(30.0, 20.0));
    let black = Color::rgb(0, 0, 0);
    canvas.rect(DVec2::ONE, DVec2::splat(3.0), 0.5, black);
    canvas.text(DVec2::new(4.0, 9.0), 7.0, "be\nnt", black, Some((black, 1.5)));
    canvas.polygon([&[DVec2::ZERO, DVec2::X, DVec2::Y][..]], black);
    canvas.blend(1, 1, black, 1.0);
    let rect = CanvasShape::Rect { corners: [DVec2::splat(2.0), DVec2::splat(6.0)], radius: 1.0, color: black };
    assert_eq!((shapes.len(), &shapes[0]), (3, &rect));
    let width = text_size(14.0, "bent").width;
    let (at, text, halo) = (DVec2::new(8.0, 18.0), "bent".to_owned(), Some((black, 3.0)));
    let (fonts, along) = (Fonts::default(), Vec::new());
    assert_eq!(shapes[1], CanvasShape::Text { at, size: 14.0, text, width, fonts, along, color: black, halo });
    let rings = vec![vec![DVec2::ZERO, 2.0 * DVec2::X, 2.0 * DVec2::Y]];
    assert_eq!(shapes[2], CanvasShape::Polygon { rings, color: black });
}

#[test]
fn twice_the_scale_draws_the_same_twice_as_large() {
    let draw = |scale: usize| {
        let mut pixels = vec![[255u8; 3]; 60 * 40 * scale * scale];
        let mut canvas = Canvas::new(&mut pixels, 60 * scale).scaled(scale as f64);
        assert_eq!(canvas.size(), DVec2::new(60.0, 40.0));
        canvas.rect(DVec2::new(10.0, 5.0), DVec2::new(20.0, 9.0), 0.0, Color::rgb(0, 0, 0));
        canvas.line(&[DVec2::new(30.0, 8.0), DVec2::new(50.0, 8.0)], 2.0, Color::rgb(0, 0, 0));
        canvas.text(DVec2::new(4.0, 32.0), 14.0, "bent", Color::rgb(0, 0, 0), None);
        let corners = [[40.0, 20.0], [56.0, 20.0], [56.0, 36.0]].map(DVec2::from_array);
        canvas.polygon([&corners[..]], Color::rgb(0, 0, 0));
        pixels
    };
    let (once, twice) = (draw(1), draw(2));
    let dark = |pixels: &[[u8; 3]]| pixels.iter().map(|p| 1.0 - f64::from(p[0]) / 255.0).sum::<f64>();
    let ratio = dark(&twice) / dark(&once);
    assert!((ratio - 4.0).abs() < 0.4, "{ratio} times the ink");
    // The rectangle and the triangle lie at the same shares.
    for [x, y] in [[15, 7], [40, 8], [52, 24]] {
        assert!(once[y * 60 + x][0] < 40 && twice[2 * y * 120 + 2 * x][0] < 40, "{x}, {y}");
    }
}
