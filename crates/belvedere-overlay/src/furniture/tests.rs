use super::*;
use crate::notes::ClassNote;
use belvedere_core::{DVec3, Pinhole, Projection};
use belvedere_scene::{
    Color, FeatureStyle, Heightfield, Hidden, LineClass, LineFeature, LineLayer, Mesh, MeshColors, MeshLayer,
    PointFeature, PointLayer, PointStyle, Symbol,
};

/// Gentle hills of 8 km, 40 m a cell.
fn hills() -> Scene {
    let side = 201;
    let height = |i: usize| {
        let (x, y) = ((i % side) as f32 * 0.04, (i / side) as f32 * 0.05);
        300.0 + 60.0 * (x.sin() + y.cos())
    };
    let heights = (0..side * side).map(height).collect();
    let ground = Heightfield::measured(DVec2::new(0.0, 8000.0), DVec2::splat(40.0), side, side, heights);
    Scene { title: "Hills".into(), ..Scene::default() }.with_terrain("ground", ground.expect("ground"))
}

/// From the south-west, turned by 25 degrees.
fn view(image: [u32; 2]) -> View {
    let (eye, target) = (DVec3::new(2000.0, -2500.0, 3200.0), DVec3::new(4200.0, 3600.0, 300.0));
    let lens = Projection::Perspective { fov_y: 0.75 };
    View::straight(Pinhole::look_at(eye, target, DVec3::Z, lens, image, 1.0, None).expect("a camera"))
}

fn plan(scene: &Scene, doc: &FurnitureDoc, (image, density): ([u32; 2], f64)) -> Plan {
    let notes = LayerNotes { credits: vec![("ground".into(), "© Survey".into())], ..LayerNotes::default() };
    Plan::new(&Subject {
        doc,
        scene,
        view: &view(image),
        notes: &notes,
        files: vec!["dem.tif".into()],
        density,
        reserved: vec![(Corner::BottomRight, DVec2::new(200.0, 24.0))],
        north: &|_| DVec2::new(0.05, 1.0).normalize(),
        today: Some("2026-05-01".into()),
    })
}

fn everything() -> FurnitureDoc {
    let on = || Some(SwitchOrText::Switch(true));
    FurnitureDoc {
        title: on(),
        legend: true,
        attribution: on(),
        source: on(),
        date: on(),
        compass: Some(CompassDoc::Switch(true)),
        scale: Some(ScaleDoc::Switch(true)),
        ..FurnitureDoc::default()
    }
}

/// Hills with a point in the middle.
fn with_point() -> Scene {
    let point = PointFeature { position: DVec3::new(4000.0, 4000.0, 300.0), ..PointFeature::default() };
    let style = PointStyle { symbol: Symbol::Triangle, casing: None, label_px: None };
    let (color, hidden) = (Color::rgb(1, 2, 3), Hidden::Fade);
    let layer = PointLayer { features: vec![point], color, size_px: 8.0, style, hidden, lift_m: 1.0, beyond: 0.0 };
    hills().with_layer("huts", layer)
}

/// A point layer is called by the name of its points, unless they have several, or the scene says otherwise.
#[test]
fn rows_of_the_legend_have_the_name_of_what_they_show() {
    let words = |names: &[&str], doc: &FurnitureDoc| {
        let mut scene = with_point();
        if let Some(layer) = scene.layers[1].kind.points_mut() {
            let point = layer.features[0].clone();
            layer.features = names.iter().map(|name| PointFeature { name: (*name).into(), ..point.clone() }).collect();
        }
        let notes = LayerNotes::default();
        let subject = Subject {
            doc,
            scene: &scene,
            view: &view([900, 600]),
            notes: &notes,
            files: Vec::new(),
            density: 1.0,
            reserved: Vec::new(),
            north: &|_| DVec2::Y,
            today: None,
        };
        legend::rows(&subject).into_iter().map(|row| row.words).next_back()
    };
    let doc = FurnitureDoc::default();
    assert_eq!(words(&["Piz Bernina"], &doc).as_deref(), Some("Piz Bernina"));
    assert_eq!(words(&["Piz Bernina", "Piz Bernina"], &doc).as_deref(), Some("Piz Bernina"));
    for several in [&["Piz Bernina", "Piz Palü"][..], &["Piz Bernina", ""], &[""]] {
        assert_eq!(words(several, &doc).as_deref(), Some("huts"));
    }
    let named = FurnitureDoc { names: [("huts".into(), "Summits".into())].into(), ..doc };
    assert_eq!(words(&["Piz Bernina"], &named).as_deref(), Some("Summits"));
}

/// Buildings in the colours of a property have a heading and a row for each class; without it coloured meshes have none.
#[test]
fn classes_of_buildings_are_rows_of_the_legend() {
    let [red, blue] = [Color::rgb(200, 0, 0), Color::rgb(0, 0, 200)];
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let mesh = Mesh::new(&corners, vec![[0, 1, 2]], MeshColors::PerTriangle(vec![red])).expect("a triangle");
    let scene = Scene::default().with_layer("town", MeshLayer::new(mesh, blue));
    let classes = vec![("shop".to_owned(), red), ("house".to_owned(), blue)];
    let note = ClassNote { layer: "town".into(), property: "use".into(), classes, smooth: false, others: None };
    let rows = |notes: LayerNotes| {
        let subject = Subject {
            doc: &FurnitureDoc::default(),
            scene: &scene,
            view: &view([900, 600]),
            notes: &notes,
            files: Vec::new(),
            density: 1.0,
            reserved: Vec::new(),
            north: &|_| DVec2::Y,
            today: None,
        };
        legend::rows(&subject).into_iter().map(|row| row.words).collect::<Vec<_>>()
    };
    assert_eq!(rows(LayerNotes { classes: vec![note], ..LayerNotes::default() }), ["town: use", "shop", "house"]);
    assert!(rows(LayerNotes::default()).is_empty());
}

#[test]
fn nothing_is_drawn_unless_it_is_asked_for() {
    let plan = plan(&hills(), &FurnitureDoc::default(), ([900, 600], 1.0));
    assert!(plan.kinds.is_empty() && plan.record.is_empty());
    // Names stay off the mark all the same.
    assert_eq!(plan.keep_clear, [[DVec2::new(690.0, 566.0), DVec2::new(890.0, 590.0)]]);
}

#[test]
fn titles_stand_on_no_paper_and_grow_with_the_picture() {
    let letters = |image: [u32; 2]| {
        let doc = FurnitureDoc { title: Some(SwitchOrText::Switch(true)), ..FurnitureDoc::default() };
        let plan = plan(&hills(), &doc, (image, 1.0));
        let shapes = &plan.kinds.iter().find(|(name, _)| *name == "title").expect("a title").1;
        assert!(shapes.iter().all(|shape| matches!(shape, CanvasShape::Text { .. })), "{shapes:?}");
        let CanvasShape::Text { size, halo, .. } = &shapes[0] else { unreachable!("texts alone") };
        assert!(halo.is_some());
        *size
    };
    assert_eq!([[600, 400], [900, 600], [1920, 1200]].map(letters), [17.0, 24.0, 34.0]);
}

#[test]
fn a_title_that_is_asked_for_and_has_no_words_is_told() {
    let doc = FurnitureDoc { title: Some(SwitchOrText::Switch(true)), ..FurnitureDoc::default() };
    let nameless = Scene { title: String::new(), ..hills() };
    assert_eq!(plan(&nameless, &doc, ([900, 600], 1.0)).record.left_out, ["title"]);
    let off = FurnitureDoc { title: Some(SwitchOrText::Switch(false)), ..FurnitureDoc::default() };
    assert!(plan(&nameless, &off, ([900, 600], 1.0)).record.is_empty());
}

#[test]
fn a_compass_is_no_higher_than_a_twentyfifth_of_the_picture() {
    for (image, density) in [([900, 600], 1.0), ([1280, 720], 1.0), ([1800, 1200], 2.0), ([400, 900], 1.0)] {
        for place in [CompassPlace::Ground, CompassPlace::Corner] {
            let doc = FurnitureDoc { compass: Some(CompassDoc::At(place)), ..FurnitureDoc::default() };
            let plan = plan(&hills(), &doc, (image, density));
            let shapes = &plan.kinds.iter().find(|(name, _)| *name == "compass").expect("a compass").1;
            let rect = plan.keep_clear.last().expect("kept clear");
            // On the ground 2 pixels around it are kept clear, too.
            let beside = if place == CompassPlace::Ground { 4.0 * density } else { 0.0 };
            let share = (rect[1].y - rect[0].y - beside) / f64::from(image[1]);
            assert!((0.015..=0.0401).contains(&share) && !shapes.is_empty(), "{place:?} in {image:?}: {share}");
        }
    }
}

#[test]
fn classes_of_lines_have_a_row_each_in_their_own_look_and_layers_share_them() {
    let line = |class: Option<LineClass>| {
        let style = class.map(|class| FeatureStyle {
            class: Some(class),
            color: Some(class.look().color),
            casing: Some(class.look().casing),
            scale: class.look().width_px / 3.0,
            ..FeatureStyle::default()
        });
        LineFeature { name: String::new(), style, points: vec![DVec3::ZERO, DVec3::X] }
    };
    let layer =
        |lines: &[Option<LineClass>]| LineLayer::new(lines.iter().copied().map(line).collect(), Color::rgb(200, 0, 0));
    let (river, road) = (Some(LineClass::River), Some(LineClass::Road));
    let mut scene = Scene::default()
        .with_layer("gr_11", layer(&[None]))
        .with_layer("map", layer(&[river, road, river]))
        .with_layer("more", layer(&[road]));
    scene.layers[0].must_see = true;
    let subject = Subject {
        doc: &FurnitureDoc::default(),
        scene: &scene,
        view: &view([900, 600]),
        notes: &LayerNotes::default(),
        files: Vec::new(),
        density: 1.0,
        reserved: Vec::new(),
        north: &|_| DVec2::Y,
        today: None,
    };
    let rows = legend::rows(&subject);
    let words: Vec<&str> = rows.iter().map(|row| row.words.as_str()).collect();
    assert_eq!(words, ["gr 11", "Road", "River"]);
    let look = LineClass::River.look();
    let block::Sign::Line { color, casing, width } = rows[2].sign else { panic!("{:?}", rows[2]) };
    assert_eq!((color, casing), (look.color, Some(look.casing)));
    assert!((width - look.width_px).abs() < 1e-9);
}

#[test]
fn everything_has_a_place_of_its_own_in_the_picture() {
    for (image, density) in [([900, 600], 1.0), ([1800, 1200], 2.0)] {
        let plan = plan(&with_point(), &everything(), (image, density));
        let record = &plan.record;
        assert!(record.left_out.is_empty(), "{record:?}");
        assert_eq!(record.title.as_deref(), Some("Hills"));
        assert_eq!(record.attribution.as_deref(), Some("© Survey"));
        assert_eq!(record.source.as_deref(), Some("Data: dem.tif"));
        assert_eq!((record.date.as_deref(), record.legend), (Some("2026-05-01"), Some(1)));
        assert!(record.compass.as_ref().is_some_and(|c| c.on_ground) && record.scale.len() == 3, "{record:?}");
        let size = DVec2::new(f64::from(image[0]), f64::from(image[1]));
        for (i, rect) in plan.keep_clear.iter().enumerate() {
            assert!(rect[0].cmpge(DVec2::ZERO).all() && rect[1].cmple(size).all(), "{rect:?}");
            assert!(plan.keep_clear[..i].iter().all(|other| !sighted::overlap(other, rect)), "{:?}", plan.keep_clear);
        }
        let names: Vec<&str> = plan.kinds.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["title", "attribution", "map-legend", "compass", "scale"]);
    }
}

#[test]
fn twice_the_density_makes_the_same_furniture_twice_as_large() {
    let [once, twice] = [([900, 600], 1.0), ([1800, 1200], 2.0)].map(|size| plan(&with_point(), &everything(), size));
    for (a, b) in once.keep_clear.iter().zip(&twice.keep_clear) {
        assert!((0..2).all(|k| (2.0 * a[k]).distance(b[k]) < 1e-6), "{a:?} {b:?}");
    }
    assert_eq!(once.record.scale.len(), twice.record.scale.len());
}

#[test]
fn bars_have_their_length_on_the_ground_and_lie_level_where_the_picture_shows_them() {
    let scene = hills();
    let view = view([900, 600]);
    let places = ScaleDoc::At(vec![[3600.0, 2600.0], [4400.0, 5200.0]]);
    for scale in [ScaleDoc::Switch(true), places] {
        let doc = FurnitureDoc { scale: Some(scale), ..FurnitureDoc::default() };
        let bars = plan(&scene, &doc, ([900, 600], 1.0)).record.scale;
        assert!(bars.len() >= 2);
        for bar in &bars {
            let [a, b] = bar.ends.map(DVec3::from_array);
            assert!((a.truncate().distance(b.truncate()) - bar.length).abs() < 1e-6 * bar.length, "{bar:?}");
            let power = 10f64.powf(bar.length.log10().floor());
            assert!([1.0, 2.0, 5.0].iter().any(|k| (bar.length / power - k).abs() < 1e-9), "{bar:?}");
            for (p, pixel) in [a, b].into_iter().zip(bar.pixels) {
                let ground = scene.terrain().and_then(|hf| hf.surface_at(p.truncate())).expect("ground");
                assert!((ground - p.z).abs() < 1e-9);
                let image = view.project(p).expect("an image");
                assert!(image.pixel.distance(DVec2::from_array(pixel)) < 1e-9);
            }
            let [a, b] = bar.pixels.map(DVec2::from_array);
            assert!((b - a).x > 20.0 && (b - a).y.abs() < 0.15 * (b - a).x, "along the horizontal: {bar:?}");
        }
        // What is nearer is larger.
        let per_m = |bar: &ScaleRecord| {
            DVec2::from_array(bar.pixels[0]).distance(DVec2::from_array(bar.pixels[1])) / bar.length
        };
        assert!(bars.windows(2).all(|pair| per_m(&pair[0]) > per_m(&pair[1])), "{bars:?}");
    }
    let beside = FurnitureDoc { scale: Some(ScaleDoc::At(vec![[-900.0, 0.0]])), ..FurnitureDoc::default() };
    assert_eq!(plan(&scene, &beside, ([900, 600], 1.0)).record.left_out, ["scale"]);
}

#[test]
fn roses_point_to_the_north_of_their_place() {
    let scene = hills();
    let view = view([900, 600]);
    for place in [CompassPlace::Ground, CompassPlace::Corner] {
        let doc = FurnitureDoc { compass: Some(CompassDoc::At(place)), ..FurnitureDoc::default() };
        let plan = plan(&scene, &doc, ([900, 600], 1.0));
        let rose = plan.record.compass.expect("a rose");
        assert_eq!(rose.on_ground, place == CompassPlace::Ground);
        let (at, north) = (DVec3::from_array(rose.at), DVec2::new(0.05, 1.0).normalize());
        assert_eq!(rose.north, north.to_array());
        // A short way to the north, as the picture shows it.
        let step = |p: DVec3| view.project(p).expect("an image").pixel;
        let along = (step(at + 10.0 * north.extend(0.0)) - step(at)).normalize();
        let found = DVec2::from_array(rose.north_px);
        // The rose lies on the slope of the ground, the step does not.
        assert!(found.dot(along) > 10f64.to_radians().cos(), "{found} for {along}");
        let foreground = step(at).y / 600.0;
        assert!(foreground > 0.6, "{foreground}");
    }
}

#[test]
fn what_has_no_place_is_told() {
    let small = plan(&with_point(), &everything(), ([120, 60], 1.0)).record;
    assert!(small.left_out.contains(&"scale") || small.scale.len() <= 3);
    assert!(small.left_out.contains(&"attribution"), "{small:?}");
}

#[test]
fn stated_credits_stand_before_those_of_files() {
    let scene = with_point();
    let notes = LayerNotes {
        credits: vec![("ground".into(), "© Survey".into()), ("huts".into(), "© Club".into())],
        ..LayerNotes::default()
    };
    let of = |credits: &[(&str, &str)]| {
        let credits = credits.iter().map(|(id, text)| ((*id).to_owned(), (*text).to_owned())).collect();
        super::credits(&FurnitureDoc { credits, ..FurnitureDoc::default() }, &notes, &scene)
    };
    assert_eq!(of(&[]), ["© Survey", "© Club"]);
    assert_eq!(of(&[("ground", "© Me"), ("huts", "")]), ["© Me"]);
    assert_eq!(of(&[("ground", "© Club")]), ["© Club"]);
}
