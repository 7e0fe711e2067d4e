//! Grid lines of the coordinate system on the ground.

use super::round_below;
use belvedere_core::DVec3;
use belvedere_document::{OverlayDoc, SwitchOrLength};
use belvedere_scene::{Color, Hidden, OverlayLine, Scene};

/// Lines across the shorter side of the terrain if the spacing is automatic, and largest number of lines in one direction.
const WANTED: f64 = 8.0;
const MOST_LINES: f64 = 500.0;

/// Spacing of the grid, scene units: as given, or round; `None` without terrain or with more than 500 lines.
pub fn spacing(scene: &Scene, given: Option<f64>) -> Option<f64> {
    let bounds = scene.terrain()?.bounds();
    let size = (bounds.max - bounds.min).truncate();
    let spacing = given.unwrap_or_else(|| round_below(size.min_element() / WANTED));
    (spacing > 0.0 && size.max_element() / spacing <= MOST_LINES).then_some(spacing)
}

/// The grid that a scene asks for: a spacing, or `Some(None)` for an automatic one.
pub fn stated(overlay: &OverlayDoc) -> Option<Option<f64>> {
    match overlay.grid? {
        SwitchOrLength::Length(spacing) => Some(Some(spacing)),
        SwitchOrLength::Switch(on) => on.then_some(None),
    }
}

/// The lines of the grid, if one is asked for.
pub fn wanted(scene: &Scene, grid: Option<Option<f64>>) -> Vec<OverlayLine> {
    grid.and_then(|given| spacing(scene, given)).map_or_else(Vec::new, |spacing| lines(scene, spacing))
}

/// The lines at multiples of `spacing`, with their coordinates.
pub fn lines(scene: &Scene, spacing: f64) -> Vec<OverlayLine> {
    let Some(bounds) = scene.terrain().map(|t| t.bounds()) else { return Vec::new() };
    let (lo, hi) = (bounds.min, bounds.max);
    let multiples = |lo: f64, hi: f64| {
        let first = (lo / spacing).ceil() as i64;
        (first..=(hi / spacing).floor() as i64).map(move |k| k as f64 * spacing)
    };
    let line = |a: DVec3, b: DVec3, label: String| OverlayLine {
        points: vec![a, b],
        on_ground: true,
        color: Color { r: 30, g: 44, b: 66, a: 150 },
        width_px: 1.1,
        casing: None,
        hidden: Hidden::Cut,
        label,
        label_px: belvedere_scene::SMALL_LETTERS_PX,
    };
    let name = |axis: &str, v: f64| match spacing >= 1000.0 && spacing % 500.0 == 0.0 {
        true => format!("{axis} {}", v / 1000.0),
        false => format!("{axis} {v}"),
    };
    let north = multiples(lo.x, hi.x).map(|x| line(DVec3::new(x, lo.y, 0.0), DVec3::new(x, hi.y, 0.0), name("E", x)));
    let east = multiples(lo.y, hi.y).map(|y| line(DVec3::new(lo.x, y, 0.0), DVec3::new(hi.x, y, 0.0), name("N", y)));
    north.chain(east).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_core::DVec2;
    use belvedere_scene::Heightfield;

    #[test]
    fn lines_stand_at_multiples_and_are_called_by_kilometres_where_those_are_round() {
        let ground = Heightfield::measured(DVec2::new(900.0, 7100.0), DVec2::splat(1000.0), 7, 7, vec![5.0; 49]);
        let scene = Scene::default().with_terrain("ground", ground.expect("ground"));
        let names = |spacing: f64| lines(&scene, spacing).into_iter().map(|l| l.label).collect::<Vec<_>>();
        assert_eq!(names(1500.0)[..4], ["E 1.5", "E 3", "E 4.5", "E 6"], "kilometres");
        assert_eq!(
            names(1250.0)[..4],
            ["E 1250", "E 2500", "E 3750", "E 5000"],
            "a quarter of a kilometre stays in metres"
        );
        assert_eq!(names(600.0)[0], "E 1200");
        let north: Vec<f64> =
            lines(&scene, 3000.0).iter().filter(|l| l.label.starts_with('N')).map(|l| l.points[0].y).collect();
        assert_eq!(north, [3000.0, 6000.0]);
    }
}
