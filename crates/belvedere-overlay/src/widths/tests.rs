use super::*;
use belvedere_scene::{Color, Layer, LineLayer, SMALL_LETTERS_PX};

#[test]
fn twice_as_many_pixels_per_point_make_lines_and_names_twice_as_large() {
    let mut way = LineLayer::new(Vec::new(), Color::rgb(1, 2, 3));
    (way.width_px, way.label_px) = (3.0, Some(12.0));
    let layer = Layer { id: "way".into(), must_see: true, kind: way.into() };
    let scene = Scene { layers: vec![layer], ..Scene::default() };
    assert!(matches!(scaled(&scene, 1.0), Cow::Borrowed(_)));
    for (scale, width, letters) in [(2.0, 6.0, Some(24.0)), (0.5, 1.5, None)] {
        let other = scaled(&scene, scale);
        let Some(line) = other.layers[0].kind.lines() else { panic!("no line") };
        assert_eq!((line.width_px, line.label_px), (width, letters), "letters of 6 pixels cannot be read");
    }
}

#[test]
fn letters_of_grids_and_distances_are_scaled_and_left_out_where_they_cannot_be_read() {
    let grid = OverlayLine {
        points: Vec::new(),
        on_ground: true,
        color: Color::rgb(1, 2, 3),
        width_px: 1.0,
        casing: None,
        hidden: belvedere_scene::Hidden::Cut,
        label: "E 500".into(),
        label_px: SMALL_LETTERS_PX,
    };
    let mut way = LineLayer::new(Vec::new(), Color::rgb(1, 2, 3));
    way.markers = Some(belvedere_scene::DistanceMarkers::Auto);
    let layer = Layer { id: "way".into(), must_see: true, kind: way.into() };
    let scene = Scene { layers: vec![layer], ..Scene::default() };
    for (scale, letters) in [(2.0, Some(22.0)), (0.75, Some(8.25)), (0.5, None)] {
        let other = line(grid.clone(), scale);
        assert_eq!((!other.label.is_empty()).then_some(other.label_px), letters);
        let scene = scaled(&scene, scale);
        let Some(way) = scene.layers[0].kind.lines() else { panic!("no line") };
        assert_eq!(way.markers.map(|_| way.marker_px), letters);
    }
}
