//! Where lines become hidden, points with names, and marks that belong to no layer.

use crate::support::{layer, line, options, pinhole, render, scene, terrain};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{
    AreaFeature, AreaLayer, AreaSurface, Color, DistanceMarkers, Frame, Heightfield, Hidden, LayerKind, NodeState,
    Overlay, OverlayFace, OverlayLine, OverlayPoint, PaletteName, PointFeature, PointLayer, PointStyle, Relief,
    RenderOptions, Scene, Symbol,
};

const WIDTH_PX: f64 = 4.0;
const LIFT_M: f64 = 2.0;

/// Level ground with one ridge from west to east through the origin.
fn ridge() -> Heightfield {
    let (n, spacing) = (221, 10.0);
    let half = 0.5 * (n - 1) as f64 * spacing;
    let heights = (0..n * n).map(|i| {
        let y = half - (i / n) as f64 * spacing;
        (60.0 * (-(y / 60.0).powi(2)).exp()) as f32
    });
    let heights = heights.collect();
    Heightfield::new(DVec2::new(-half, half), DVec2::splat(spacing), n, n, heights, vec![NodeState::Measured; n * n])
        .expect("well formed")
}

fn ground(hf: &Heightfield) -> LayerKind {
    let mut ground = terrain(hf.clone());
    (ground.relief, ground.palette) = (Relief::None, PaletteName::Plain.into());
    LayerKind::Terrain(ground)
}

fn camera(height: f64) -> View {
    View::straight(pinhole(DVec3::new(0.0, -800.0, height), DVec3::new(0.0, 200.0, 0.0), 40.0, [400, 300]))
}

const ENDS: [DVec2; 2] = [DVec2::new(-180.0, -350.0), DVec2::new(260.0, 1000.0)];

fn with_line(hf: &Heightfield, hidden: Hidden) -> Scene {
    let points = (0..=400).map(|i| ENDS[0].lerp(ENDS[1], f64::from(i) / 400.0));
    let points = points.map(|xy| xy.extend(hf.surface_at(xy).expect("on the ground"))).collect();
    let mut style = line(points, hidden);
    (style.color, style.casing, style.width_px, style.lift_m) = (Color::rgb(0, 0, 0), None, WIDTH_PX, LIFT_M);
    scene(vec![layer("ground", ground(hf)), layer("route", LayerKind::Line(style))])
}

/// Amount of black added to the picture without the mark, in fully covered pixels, in linear light.
fn ink(with: &Frame, without: &Frame) -> f64 {
    let light = |v: u8| {
        let s = f64::from(v) / 255.0;
        if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) }
    };
    with.color.iter().zip(&without.color).map(|(a, b)| 1.0 - light(a[1]) / light(b[1])).sum()
}

/// Length of the visible line on the image, in pixels. Its two crossings are found by sampling lines of sight.
fn visible_px(hf: &Heightfield, view: &View) -> f64 {
    let eye = view.pinhole().eye;
    let place = |t: f64| {
        let xy = ENDS[0].lerp(ENDS[1], t);
        xy.extend(hf.surface_at(xy).expect("on the ground") + LIFT_M)
    };
    let sees = |t: f64| {
        (1..4000).all(|i| {
            let p = eye.lerp(place(t), f64::from(i) / 4000.0);
            hf.surface_at(p.truncate()).is_none_or(|z| z < p.z)
        })
    };
    let crossing = |mut seen: f64, mut hidden: f64| {
        assert!(sees(seen) && !sees(hidden), "between {seen} and {hidden}");
        for _ in 0..30 {
            let middle = 0.5 * (seen + hidden);
            if sees(middle) { seen = middle } else { hidden = middle }
        }
        seen
    };
    let pixel = |t: f64| view.project(place(t)).expect("in front").pixel;
    let length = |a: f64, b: f64| {
        (0..500)
            .map(|i| [i, i + 1].map(|k| pixel(a + (b - a) * f64::from(k) / 500.0)))
            .map(|[p, q]| p.distance(q))
            .sum::<f64>()
    };
    length(0.0, crossing(0.2, 0.4)) + length(crossing(0.95, 0.4), 1.0)
}

#[test]
fn lines_end_where_the_line_of_sight_says_and_move_with_the_camera() {
    let hf = ridge();
    let bare = scene(vec![layer("ground", ground(&hf))]);
    let route = with_line(&hf, Hidden::Cut);
    // There are round ends at the two ends of the line and at the two crossings.
    let ends = 4.0 * 0.5 * std::f64::consts::PI * (0.5 * WIDTH_PX).powi(2) / WIDTH_PX;
    for samples in [1, 4] {
        let errors: Vec<f64> = (0..24)
            .map(|i| {
                let view = camera(150.0 + 0.7 * f64::from(i));
                let drawn = ink(&render(&route, &view, &options(samples)), &render(&bare, &view, &options(samples)));
                drawn / WIDTH_PX - ends - visible_px(&hf, &view)
            })
            .collect();
        let (least, most) = errors.iter().fold((f64::MAX, f64::MIN), |(l, m), e| (l.min(*e), m.max(*e)));
        assert!(least > -0.45 && most < 0.45, "{samples} samples: length off by {errors:.2?} pixels");
        // From frame to frame the ink changes as much as the camera's motion requires and no more.
        let jump = errors.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
        assert!(jump < 0.3, "{samples} samples: the ends jump by {jump:.2} pixels: {errors:.2?}");
    }
}

fn summits() -> PointLayer {
    let feature = |name: &str, x: f64, y: f64, z: f64| PointFeature {
        style: None,
        name: name.into(),
        position: DVec3::new(x, y, z),
    };
    PointLayer {
        features: vec![feature("Crest", 0.0, 0.0, 60.0), feature("Behind", 120.0, 150.0, 0.2)],
        color: Color::rgb(90, 20, 140),
        size_px: 12.0,
        style: PointStyle { symbol: Symbol::Triangle, label_px: Some(13.0), ..PointStyle::default() },
        hidden: Hidden::Cut,
        lift_m: 1.0,
        beyond: 0.0,
    }
}

fn changed(a: &Frame, b: &Frame) -> Vec<usize> {
    (0..a.color.len()).filter(|&i| a.color[i] != b.color[i]).collect()
}

#[test]
fn points_in_sight_have_symbol_and_name_and_hidden_ones_have_neither() {
    let hf = ridge();
    let view = camera(150.0);
    let bare = render(&scene(vec![layer("ground", ground(&hf))]), &view, &options(4));
    let draw = |points: PointLayer| {
        render(
            &scene(vec![layer("ground", ground(&hf)), layer("summits", LayerKind::Point(points))]),
            &view,
            &options(4),
        )
    };
    let frame = draw(summits());
    let near = |p: DVec3, i: usize| {
        let at = view.project(p).expect("in front").pixel;
        (at - DVec2::new((i % 400) as f64, (i / 400) as f64)).abs().max_element() < 90.0
    };
    let [crest, behind] = [DVec3::new(0.0, 0.0, 61.0), DVec3::new(120.0, 150.0, 1.2)];
    assert_eq!(frame.depth, bare.depth);
    let symbol = frame.id.iter().filter(|&&id| id == 2).count();
    assert!((50..150).contains(&symbol), "{symbol} pixels of triangle");
    let touched = changed(&frame, &bare);
    assert!(touched.len() > symbol + 150, "a name is written: {} pixels", touched.len());
    assert!(touched.iter().all(|&i| near(crest, i)), "only around the crest");
    let mut shown = summits();
    shown.hidden = Hidden::Show;
    let through = draw(shown);
    assert!(changed(&through, &frame).iter().any(|&i| near(behind, i)), "hidden = show draws it");
    let mut unnamed = summits();
    unnamed.style.label_px = None;
    assert!(changed(&draw(unnamed), &bare).len() < 250, "without names only the symbol is left");
}

#[test]
fn names_of_areas_stand_where_the_area_has_most_room_and_that_is_seen() {
    let hf = ridge();
    let draw = |names: &[(&str, f64)], hidden| {
        // A long strip that widens at its western end.
        let ring = |y: f64| {
            [[-160.0, y - 45.0], [-60.0, y - 45.0], [-60.0, y], [240.0, y], [240.0, y + 12.0], [-160.0, y + 45.0]]
        };
        let feature = |(name, y): &(&str, f64)| AreaFeature {
            name: (*name).into(),
            style: None,
            rings: vec![ring(*y).map(DVec2::from_array).to_vec()],
        };
        let area = AreaLayer {
            features: names.iter().map(feature).collect(),
            fill: Color::rgb(60, 120, 60).with_alpha(0),
            outline: None,
            width_px: 1.0,
            surface: AreaSurface::Plain,
            hidden,
            lift_m: 1.0,
            label_px: Some(14.0),
            beyond: 0.0,
        };
        render(
            &scene(vec![layer("ground", ground(&hf)), layer("woods", LayerKind::Area(area))]),
            &camera(150.0),
            &options(4),
        )
    };
    let (before, behind) = (("Wood", -300.0), ("Wood", 110.0));
    let bare = draw(&[("", before.1)], Hidden::Cut);
    let touched = changed(&draw(&[before], Hidden::Cut), &bare);
    assert!(touched.len() > 80, "{} pixels", touched.len());
    let middle = touched.iter().map(|&i| DVec2::new((i % 400) as f64, (i / 400) as f64)).sum::<DVec2>();
    let middle = middle / touched.len() as f64;
    let pole = camera(150.0).project(DVec3::new(-110.0, -300.0, 1.0)).expect("in front").pixel;
    assert!((middle - pole).abs().max_element() < 12.0, "{middle} is not at {pole}");
    assert_eq!(changed(&draw(&[behind], Hidden::Cut), &draw(&[("", behind.1)], Hidden::Cut)).len(), 0, "it is hidden");
    assert!(changed(&draw(&[behind], Hidden::Show), &draw(&[("", behind.1)], Hidden::Show)).len() > 80);
}

#[test]
fn distance_marks_belong_to_their_line() {
    let hf = ridge();
    let mut route = with_line(&hf, Hidden::Cut);
    let plain = render(&route, &camera(400.0), &options(4));
    if let Some(l) = route.layers[1].kind.lines_mut() {
        l.markers = Some(DistanceMarkers::Every(200.0));
    }
    let marked = render(&route, &camera(400.0), &options(4));
    let more = marked.id.iter().filter(|&&id| id == 2).count() - plain.id.iter().filter(|&&id| id == 2).count();
    // The line is 1420 units long: seven marks, discs of 6.4 pixels on a line of 4.
    assert!((35..120).contains(&more), "{more} pixels more");
    assert!(changed(&marked, &plain).len() > 600, "with their distances");
}

fn overlay() -> Overlay {
    let grid = OverlayLine {
        points: vec![DVec3::new(-300.0, -300.0, 0.0), DVec3::new(-300.0, 900.0, 0.0)],
        on_ground: true,
        color: Color::rgb(0, 0, 120),
        width_px: 1.5,
        casing: None,
        hidden: Hidden::Dash,
        label: "E -300".into(),
        label_px: belvedere_scene::SMALL_LETTERS_PX,
    };
    let ray = OverlayLine {
        points: vec![DVec3::new(-100.0, -300.0, 100.0), DVec3::new(150.0, 400.0, 0.0)],
        on_ground: false,
        hidden: Hidden::Fade,
        casing: Some(Color::rgb(255, 255, 255)),
        ..grid.clone()
    };
    let corners = [[-80.0, 0.0], [80.0, 0.0], [80.0, 200.0], [-80.0, 200.0]].map(|[x, z]| DVec3::new(x, 120.0, z));
    let face = OverlayFace { corners: corners.to_vec(), color: Color { r: 200, g: 0, b: 0, a: 128 } };
    let point = OverlayPoint {
        position: DVec3::new(0.0, -200.0, 30.0),
        symbol: Symbol::Pin,
        size_px: 14.0,
        color: Color::rgb(0, 90, 0),
        hidden: Hidden::Show,
        label: "Höhe ½ ≥ 30 m".into(),
    };
    Overlay { under: vec![grid], faces: vec![face], over: vec![ray], points: vec![point] }
}

#[test]
fn overlays_leave_depth_and_id_alone_and_faces_fade_behind_the_ground() {
    let hf = ridge();
    let base = scene(vec![layer("ground", ground(&hf))]);
    let view = camera(150.0);
    let bare = render(&base, &view, &options(1));
    let only = Overlay { faces: overlay().faces, ..Overlay::default() };
    let faced = render(&base, &view, &RenderOptions { overlay: only, ..options(1) });
    let tone = |p: DVec3| {
        let px = view.project(p).expect("in front").pixel;
        let i = px.y as usize * 400 + px.x as usize;
        (f64::from(bare.color[i][2]) - f64::from(faced.color[i][2])) / f64::from(bare.color[i][2])
    };
    let (front, behind) = (tone(DVec3::new(0.0, 120.0, 150.0)), tone(DVec3::new(0.0, 120.0, 10.0)));
    assert!(front > 0.15 && behind > 0.01 && behind < 0.6 * front, "{front:.2} in front, {behind:.2} behind");
    let full = render(&base, &view, &RenderOptions { overlay: overlay(), ..options(1) });
    assert!(full.depth == bare.depth && full.id == bare.id);
    assert!(changed(&full, &faced).len() > 800, "lines, pin and texts are drawn");
}

#[test]
fn marks_do_not_depend_on_threads() {
    let hf = ridge();
    let mut all = with_line(&hf, Hidden::Dash);
    if let Some(l) = all.layers[1].kind.lines_mut() {
        l.markers = Some(DistanceMarkers::Auto);
    }
    all.layers.push(layer("summits", LayerKind::Point(summits())));
    for samples in [1, 4, 16] {
        let frame =
            |threads| render(&all, &camera(150.0), &RenderOptions { overlay: overlay(), threads, ..options(samples) });
        let one = frame(1);
        assert!([2, 5].into_iter().all(|threads| frame(threads).color == one.color), "{samples} samples");
    }
}
