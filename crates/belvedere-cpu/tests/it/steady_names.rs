//! Names in films: from frame to frame of a camera that moves, a name stays where it stood.

use crate::support::{Random, hills, layer, line, options, pinhole, render, scene, terrain};
use belvedere_composite::marks::{NameMemory, Patience};
use belvedere_composite::traced_marks::next_names;
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{
    Color, FeatureStyle, Hidden, LayerKind, Light, NameId, NamePlace, PlacedName, PointFeature, PointLayer, PointStyle,
    Progress, RenderJob, RenderOptions, Scene, Symbol,
};
use std::collections::HashMap;

const IMAGE: [u32; 2] = [640, 360];
const FRAMES: u32 = 60;

/// Hills with places on them, each with its height as rank, and two named paths.
fn named() -> Scene {
    let hf = hills(129, 12.0, 160.0, 5);
    let mut random = Random::new(3);
    let on_ground = |xy: DVec2| xy.extend(hf.surface_at(xy).expect("on the hills"));
    let features = (0..60).map(|i| {
        let position = on_ground(DVec2::new(random.range(-600.0, 600.0), random.range(-600.0, 600.0)));
        let style = FeatureStyle { rank: Some(position.z), ..FeatureStyle::default() };
        PointFeature { name: format!("Piz {i}"), style: Some(style), position }
    });
    let points = PointLayer {
        features: features.collect(),
        color: Color::rgb(60, 20, 90),
        size_px: 6.0,
        style: PointStyle { symbol: Symbol::Triangle, casing: None, label_px: Some(12.0) },
        hidden: Hidden::Cut,
        lift_m: 1.0,
        beyond: 0.0,
    };
    let path = |offset: f64, name: &str| {
        let course = (0..400).map(|i| {
            let t = f64::from(i) / 399.0;
            on_ground(DVec2::new(-600.0 + 1200.0 * t, offset + 120.0 * (t * 7.0).sin()))
        });
        let mut path = line(course.collect(), Hidden::Dash);
        path.features[0].name = name.into();
        path.label_px = Some(12.0);
        path
    };
    let layers = vec![
        layer("ground", LayerKind::Terrain(terrain(hf.clone()))),
        layer("upper", LayerKind::Line(path(200.0, "Upper path"))),
        layer("lower", LayerKind::Line(path(-150.0, "Lower path"))),
        layer("places", LayerKind::Point(points)),
    ];
    scene(layers)
}

/// A camera that goes sideways and turns, as in a film of 60 frames.
fn view(frame: u32) -> View {
    let t = f64::from(frame) / f64::from(FRAMES);
    let eye = DVec3::new(-200.0 + 250.0 * t, -1100.0, 420.0);
    View::straight(pinhole(eye, DVec3::new(-40.0 + 160.0 * t, 0.0, 0.0), 38.0, IMAGE))
}

/// Names of all frames, each after the frame before, or as if there were none before.
fn film(scene: &Scene, held: bool) -> Vec<Vec<PlacedName>> {
    let mut memory = NameMemory::default();
    let frame = |frame: u32| {
        let (view, options) = (view(frame), options(1));
        let depth = render(scene, &view, &RenderOptions { marks: false, ..options.clone() }).depth;
        let job = RenderJob {
            scene,
            view: &view,
            light: &Light::default(),
            options: &options,
            progress: &Progress::silent(),
        };
        let before = if held { memory.clone() } else { NameMemory::default() };
        memory = next_names(&job, &depth, (&before, Patience(7)));
        memory.names()
    };
    (0..FRAMES).map(frame).collect()
}

/// Changes of place of each name from a frame to the next, and how often names come or go.
fn changes(film: &[Vec<PlacedName>]) -> (HashMap<NameId, usize>, usize) {
    let mut moved: HashMap<NameId, usize> = HashMap::new();
    let mut came_or_went = 0;
    for pair in film.windows(2) {
        let before: HashMap<&NameId, NamePlace> = pair[0].iter().map(|name| (&name.id, name.place)).collect();
        let stayed: Vec<&PlacedName> = pair[1].iter().filter(|name| before.contains_key(&name.id)).collect();
        came_or_went += pair[0].len() + pair[1].len() - 2 * stayed.len();
        for name in stayed {
            *moved.entry(name.id.clone()).or_default() += usize::from(before[&name.id] != name.place);
        }
    }
    (moved, came_or_went)
}

#[test]
fn names_of_points_and_lines_keep_their_places_past_a_moving_camera() {
    let scene = named();
    let (held, anew) = (film(&scene, true), film(&scene, false));
    let ((moved, went), (moved_anew, went_anew)) = (changes(&held), changes(&anew));
    let sum = |moved: &HashMap<NameId, usize>| moved.values().sum::<usize>();
    let told = format!(
        "{} moves and {went} comings and goings, placed anew {} and {went_anew}",
        sum(&moved),
        sum(&moved_anew)
    );
    assert!(moved.len() > 20, "{} names", moved.len());
    assert!(6 * sum(&moved) < sum(&moved_anew) && went < went_anew, "{told}");
    // A name changes its place at most three times in 60 frames, and few do so at all.
    let most = moved.values().max().copied().unwrap_or_default();
    assert!(most <= 3 && 2 * moved.values().filter(|n| **n > 0).count() < moved.len(), "{most} changes; {told}");
    assert!(held.iter().flatten().any(|name| name.place.anchor.is_some()), "names of lines");
    let names = |film: &[Vec<PlacedName>]| film.iter().map(Vec::len).sum::<usize>() as f64;
    assert!(names(&held) > 0.85 * names(&anew), "{} names of {}", names(&held), names(&anew));
}

#[test]
fn the_first_frame_is_the_picture_and_given_names_are_drawn_where_they_were_placed() {
    // Points of lines are told in thousandths of a metre, those of points exactly.
    let mut scene = named();
    scene.layers.retain(|layer| layer.kind.lines().is_none());
    let first = &film(&scene, true)[..1];
    let given = RenderOptions { names: Some(first[0].clone().into()), ..options(1) };
    assert!(render(&scene, &view(0), &given).color == render(&scene, &view(0), &options(1)).color);
    let one = RenderOptions { names: Some(first[0][..1].into()), ..options(1) };
    assert!(render(&scene, &view(0), &one).color != render(&scene, &view(0), &given).color);
}
