//! Plans the furniture of a session's picture: what it needs to know of files, marks, north and the day.

use super::options::PictureOptions;
use crate::Session;
use crate::scene_file::Corner;
use belvedere_composite::tint::GroundTint;
use belvedere_core::{DVec2, View};
use belvedere_io::arrays::SCHEME;
use belvedere_overlay::badge::Made;
use belvedere_overlay::furniture::{self, Plan, Subject};
use belvedere_overlay::{badge, curve_inset, heat};
use belvedere_resolve::ground::Ground;
use belvedere_scene::{Cover, Palette, Scene, Unit};

/// Sizes that the legend of the heat map and that of highlights may take.
const HEAT: DVec2 = DVec2::new(210.0, heat::LEGEND_HEIGHT);
const HIGHLIGHT: DVec2 = DVec2::new(250.0, 150.0);
/// Part of a degree of latitude over which the direction to the north is taken.
const STEP_DEG: f64 = 1e-3;

/// Whom the data of a session ask to be named.
pub(super) fn credits(session: &Session) -> Vec<String> {
    furniture::credits(&session.resolved.furniture, &session.loaded.notes, session.scene())
}

/// The furniture that the session's scene asks for.
///
/// * `highlight`, `heatmap`: whether their legends stand in the lower left corner.
pub(super) fn plan(
    session: &Session,
    (scene, view): (&Scene, &View),
    request: &PictureOptions,
    (highlight, heatmap): (bool, bool),
) -> Plan {
    let (doc, overlay) = (&session.resolved.furniture, &session.resolved.overlay);
    let bent = !request.straight && view.is_bent();
    let inset = overlay.inset.is_some() && view.spline_bend().is_some();
    let smaller = view.pinhole().image.map(f64::from).into_iter().fold(f64::INFINITY, f64::min) / request.density;
    let [width, height] = view.pinhole().image.map(|side| (f64::from(side) / request.density) as usize);
    let mark = badge::room(width, scene.unit, made_ground(session));
    let reserved = [
        (bent && overlay.mark && !request.no_mark && badge::fits(width, height), Corner::BottomRight, mark),
        (heatmap, Corner::BottomLeft, HEAT),
        (bent && highlight, Corner::BottomLeft, HIGHLIGHT),
        (inset, Corner::TopLeft, curve_inset::room(smaller)),
    ];
    let ground = Ground::of(scene);
    let names = session.public_names();
    let scene_file = session.path();
    let mut files: Vec<String> = Vec::new();
    for input in session.inputs().iter().filter(|input| Some(input.path.as_path()) != scene_file) {
        // An array is named as the file that it is written as, so that a saved scene draws the same letters.
        let array = input.path.to_str().and_then(|path| session.loaded.arrays.file_name(path.strip_prefix(SCHEME)?));
        let name = array.unwrap_or_else(|| names.file(&input.path));
        if !files.contains(&name) {
            files.push(name);
        }
    }
    Plan::new(&Subject {
        doc,
        scene,
        view,
        notes: &session.loaded.notes,
        files,
        density: request.density,
        reserved: reserved.into_iter().filter(|r| r.0).map(|(_, corner, size)| (corner, size)).collect(),
        north: &|xy| if scene.unit == Unit::Metre { north(&ground, xy) } else { DVec2::Y },
        today: today(),
    })
}

/// Share of a ground of which no land cover is known, up to which the mark says that its materials are data.
const UNKNOWN: f64 = 0.05;

/// What the grounds of a scene show by rule.
pub(super) fn made_ground(session: &Session) -> Made {
    let mut made = Made::Nothing;
    for terrain in session.scene().layers.iter().filter_map(|layer| layer.kind.terrain()) {
        let tint = GroundTint::new(&terrain.palette, terrain.heightfield.z_range());
        let land = if let Palette::Placed(_, _, Some(land)) = &terrain.palette { Some(land) } else { None };
        match land {
            _ if !tint.is_made() => {}
            Some(land) if land.share(Cover::Unknown) <= UNKNOWN => made = made.max(Made::Relief),
            _ => made = Made::Materials,
        }
    }
    made
}

/// Direction of true north at a place; that of y without georeference.
fn north(ground: &Ground<'_>, xy: DVec2) -> DVec2 {
    let along = ground.lon_lat(xy).and_then(|at| {
        // Towards the nearer pole a step stays on the earth.
        let step = if at.y > 0.0 { -STEP_DEG } else { STEP_DEG };
        let other = ground.position_of(at.x, at.y + step).ok()?;
        ((other - xy) * step.signum()).try_normalize()
    });
    along.unwrap_or(DVec2::Y)
}

/// The day in UTC, that of `SOURCE_DATE_EPOCH` where it is set; `None` where the program cannot know it.
#[cfg(not(target_family = "wasm"))]
fn today() -> Option<String> {
    use std::time::{SystemTime, UNIX_EPOCH};
    /// Seconds from the beginning of the Unix clock to J2000.0.
    const J2000_S: f64 = 946_728_000.0;
    let stated = std::env::var("SOURCE_DATE_EPOCH").ok().and_then(|text| text.trim().parse::<f64>().ok());
    let now = || SystemTime::now().duration_since(UNIX_EPOCH).ok().map(|d| d.as_secs_f64());
    let seconds = stated.or_else(now)?;
    let time = crate::sun::written_time((seconds - J2000_S) / 86_400.0);
    time.get(..10).map(str::to_owned)
}

#[cfg(target_family = "wasm")]
fn today() -> Option<String> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_scene::Crs;

    #[test]
    fn north_is_that_of_the_earth_and_not_that_of_the_grid() {
        // Two degrees west of the middle of a zone at 42.5 degrees north the meridians lean by 2 sin(42.5 degrees).
        let ground = Ground { crs: Crs::Epsg(32631), terrain: None };
        let at = ground.position_of(1.0, 42.5).expect("a place");
        let found = north(&ground, at);
        let lean = (2.0f64 * 42.5f64.to_radians().sin()).to_radians();
        // The grid's north lies west of the true one there, so the true one points to the east of the grid.
        let expected = DVec2::new(lean.sin(), lean.cos());
        assert!(found.distance(expected) < 1e-4, "{found} for {expected}");
        assert_eq!(north(&Ground { crs: Crs::Local, terrain: None }, DVec2::ZERO), DVec2::Y);
    }
}
