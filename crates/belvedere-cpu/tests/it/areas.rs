//! Areas that lie over one another.

use crate::support::{hills, layer, options, pinhole, render, scene, terrain};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{AreaFeature, AreaLayer, AreaSurface, Color, Frame, Hidden, LayerKind};

fn square(middle: [f64; 2], half: f64, surface: AreaSurface) -> LayerKind {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let ring = corners.map(|c| DVec2::from_array(middle) + half * DVec2::from_array(c)).to_vec();
    LayerKind::Area(AreaLayer {
        features: vec![AreaFeature { name: String::new(), style: None, rings: vec![ring] }],
        fill: Color::rgb(90, 140, 180),
        outline: None,
        width_px: 1.0,
        surface,
        hidden: Hidden::Cut,
        lift_m: 1.0,
        label_px: None,
        beyond: 0.0,
    })
}

/// Number of pixels of another colour.
fn unlike(a: &Frame, b: &Frame) -> usize {
    a.color.iter().zip(&b.color).filter(|(a, b)| a != b).count()
}

/// Water shines where it is seen, and nothing of it is left under an area that covers it.
#[test]
fn areas_over_water_look_as_without_the_water() {
    let hf = hills(33, 20.0, 8.0, 3);
    let view = View::straight(pinhole(DVec3::new(0.0, -300.0, 130.0), DVec3::ZERO, 50.0, [120, 80]));
    let draw = |water: [f64; 2], over: [f64; 2], surface: AreaSurface| {
        let layers = vec![
            layer("ground", LayerKind::Terrain(terrain(hf.clone()))),
            layer("water", square(water, 60.0, AreaSurface::Water)),
            layer("over", square(over, 140.0, surface)),
        ];
        render(&scene(layers), &view, &options(1))
    };
    let (here, away) = ([0.0, 0.0], [5000.0, 0.0]);
    for surface in [AreaSurface::Plain, AreaSurface::Park, AreaSurface::Forest, AreaSurface::Glacier] {
        let (with, without) = (draw(here, here, surface), draw(away, here, surface));
        let over = without.id.iter().filter(|id| **id == 3).count();
        assert!(over > 800, "{surface:?}: {over} pixels");
        assert_eq!(unlike(&with, &without), 0, "{surface:?}");
    }
    // The water is there.
    let [alone, none] = [here, away].map(|water| draw(water, away, AreaSurface::Plain));
    let changed = unlike(&alone, &none);
    assert!(changed > 200, "{changed} pixels");
}
