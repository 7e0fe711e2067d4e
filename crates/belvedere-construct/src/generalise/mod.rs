//! Levels of abstraction of a city: blocks of buildings between streets, and landmarks in their own shape.
//!
//! Streets as wide as their class divide the settled ground into cells; the buildings of a cell become one block as high as they
//! are on average, weighted by area. The finer level is divided by all streets, the coarser one by main streets. Buildings that
//! stand out stay.
//!
//! Source: the idea of cells, blocks and landmarks is that of Glander and Döllner, "Abstract representations for interactive
//! visualization of virtual 3D city models", Computers, Environment and Urban Systems 33 (2009); thresholds are ours.

mod blocks;
mod cells;
mod crossings;
mod error;
mod index;
mod land_cover;
mod landmarks;
mod level;
mod report;
mod settings;
mod shapes;
mod solid;
mod streets;
mod strokes;
mod volume;

pub use blocks::CellKind;
pub use error::GeneraliseError;
pub use land_cover::{LandCoverMap, land_cover};
pub use level::{Block, Cell, Level};
pub use report::{BlockReport, FailingCell, GeneraliseReport, LevelReport};
pub use settings::{GeneraliseSettings, half_width_m, is_main};
pub use solid::volume_m3;

use belvedere_core::DVec2;
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::Instant;
use belvedere_scene::Progress;
use belvedere_scene::city::City;
use blocks::Grain;
use landmarks::{Usual, Volume, mark_tallest};
use level::{Input, Plan};
use rayon::prelude::*;

/// Smallest footprint that counts, m^2.
const LEAST_AREA_M2: f64 = 0.01;
/// Range of the width of a city, metres: smaller coordinates are degrees, larger ones are damaged.
const WIDTHS_M: [f64; 2] = [10.0, 1e6];

/// A city at its levels of abstraction.
#[derive(Debug, Clone)]
pub struct Generalised {
    /// Indices of the buildings that have an area.
    places: Vec<usize>,
    /// `loa1`, the blocks of all streets, and `loa2`, the blocks of main streets.
    pub levels: [Level; 2],
    /// Figures.
    pub report: GeneraliseReport,
}

impl Generalised {
    /// Measures the volumes of the report again, after blocks were given another shape. `city` is that of [`generalise`].
    pub fn measure(&mut self, city: &City) {
        volume::measure(&mut self.report, city, &self.levels, &self.places);
    }
}

/// The levels of abstraction of `city`, whose coordinates are metres.
///
/// # Errors
/// [`GeneraliseError`]: no building with an area, coordinates that are not metres, settings out of range, cancelled.
pub fn generalise(
    city: &City,
    settings: &GeneraliseSettings,
    progress: &Progress,
) -> Result<Generalised, GeneraliseError> {
    let begun = Instant::now();
    settings.check()?;
    progress.tick("buildings", 0.0)?;
    let mut notes = Vec::new();
    let input = input(city, &mut notes)?;
    let extent = cells::settled(&input.lands, settings.margin_m);
    progress.tick("streets", 0.2)?;
    let [fine, coarse] = streets::dividers(city, settings, &mut notes);
    progress.tick("cells", 0.4)?;
    let fine_cells = cells::cells(&extent, &fine.land, settings);
    let of_fine = cells::assign(&fine_cells.lands, &input.lands);
    progress.tick("cells", 0.6)?;
    let coarse_cells = cells::cells(&extent, &coarse.land, settings);
    let of_coarse = cells::assign_by_cells(&coarse_cells.lands, &fine_cells.lands, &of_fine, &input.lands);
    progress.tick("blocks", 0.7)?;
    let whole = |cells: cells::Cells| (cells.lands, cells.merged);
    let plan = Plan { name: "loa1", finer: None, grain: Grain::of(settings, 1.0) };
    let (loa1, report1, finer) = level::level(&plan, &input, whole(fine_cells), &of_fine, &fine, settings);
    progress.tick("blocks", 0.85)?;
    let plan = Plan { name: "loa2", finer: Some(&finer), grain: Grain::of(settings, 2.0) };
    let (loa2, report2, _) = level::level(&plan, &input, whole(coarse_cells), &of_coarse, &coarse, settings);
    progress.tick("blocks", 1.0)?;
    let all: Vec<usize> = (0..input.volumes.len()).collect();
    let report = GeneraliseReport {
        keep: settings.keep,
        buildings: city.buildings.len(),
        without_area: city.buildings.len() - input.lands.len(),
        volume_m3: 0.0,
        triangles: input.triangles(&all),
        levels: vec![report1, report2],
        notes: notes_of(notes, [&loa1, &loa2]),
        seconds: begun.elapsed().as_secs_f64(),
    };
    let mut made = Generalised { places: input.places, levels: [loa1, loa2], report };
    made.measure(city);
    Ok(made)
}

/// Adds notes on levels whose buildings lie in one cell, or in green cells alone.
fn notes_of(mut notes: Vec<Warning>, levels: [&Level; 2]) -> Vec<Warning> {
    for level in levels {
        let inhabited: Vec<&Cell> = level.cells.iter().filter(|c| !c.buildings.is_empty()).collect();
        if let [only] = inhabited[..] {
            let held = only.buildings.len();
            let text = format!("{}: all buildings but landmarks ({held}) lie in one cell, {}", level.name, only.name);
            notes.push(Warning::new(WarningKind::Suspect, text).about(level.name).with("buildings", held as f64));
        }
        if !inhabited.is_empty() && inhabited.iter().all(|c| c.kind == CellKind::Green) {
            let text = format!(
                "{}: every cell is hardly built and drawn as green ground, blocks follow their buildings",
                level.name
            );
            notes.push(Warning::new(WarningKind::Suspect, text).about(level.name));
        }
        if level.cells.is_empty() {
            let text = format!("{}: streets cover all settled ground, every building keeps its shape", level.name);
            notes.push(Warning::new(WarningKind::Fallback, text).about(level.name));
        }
    }
    notes
}

/// Warning about outlines that are taken as their convex hulls.
fn tangled(city: &City) -> Option<Warning> {
    let footprints = city.buildings.par_iter().flat_map(|b| &b.footprint);
    let count =
        footprints.chain(city.areas.par_iter().flat_map(|a| &a.polygons)).filter(|p| shapes::is_tangled(p)).count();
    let most = shapes::MOST_CROSSINGS;
    let what =
        format!("outlines cross themselves more than {most} times and are taken as their convex hulls; draw them anew");
    Warning::counted(WarningKind::Repaired, count, &what)
}

fn input<'a>(city: &'a City, notes: &mut Vec<Warning>) -> Result<Input<'a>, GeneraliseError> {
    let lands: Vec<shapes::Land> = city.buildings.par_iter().map(|b| shapes::land_of(&b.footprint)).collect();
    let (mut input, mut bad_heights) = (
        Input {
            city,
            places: Vec::new(),
            lands: Vec::new(),
            volumes: Vec::new(),
            usual: Usual::of(std::iter::empty()),
        },
        0usize,
    );
    for (place, (land, building)) in lands.into_iter().zip(&city.buildings).enumerate() {
        let area_m2 = shapes::area(&land);
        if !(area_m2 > LEAST_AREA_M2) {
            continue;
        }
        let height_m = solid::height_m(building);
        bad_heights += usize::from(height_m != building.height_m);
        input.places.push(place);
        input.lands.push(land);
        input.volumes.push(Volume { area_m2, height_m, tagged: building.landmark, tall: false });
    }
    let taken = "buildings have no usable height and are taken as 9 m high";
    notes.extend(Warning::counted(WarningKind::Assumed, bad_heights, taken));
    notes.extend(tangled(city));
    let points = city.buildings.iter().flat_map(|b| &b.footprint).flat_map(|p| &p.outer).copied();
    let [low, high] = index::bounds(points.filter(|p| p.is_finite())).unwrap_or([DVec2::ZERO; 2]);
    let [width, height] = (high - low).to_array();
    if !city.buildings.is_empty() && low != high && !(WIDTHS_M[0]..=WIDTHS_M[1]).contains(&width.max(height)) {
        return Err(GeneraliseError::Extent { width, height });
    }
    if input.lands.is_empty() {
        return Err(GeneraliseError::NoBuildings { buildings: city.buildings.len() });
    }
    input.usual = Usual::of(input.volumes.iter().copied());
    mark_tallest(&mut input.volumes, input.usual);
    Ok(input)
}
