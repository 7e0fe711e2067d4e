//! The ground that divides cells: streets, railways and water, at each level.

use super::settings::{GeneraliseSettings, half_width_m, is_main};
use super::shapes::{Land, along, by_place, common, grown, land_of, shrunk, union};
use super::strokes::longest_strokes;
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::city::{City, LandCover, Way, WayClass};
use geo::LineString;
use rayon::prelude::*;

/// Ground and streets that divide the cells of a level.
pub(super) struct Dividers {
    /// Ground of the dividers.
    pub land: Land,
    /// Indices in `City::ways`.
    pub ways: Vec<usize>,
}

/// The dividers of both levels: all streets, and main streets. The second lies in the first.
pub(super) fn dividers(city: &City, settings: &GeneraliseSettings, notes: &mut Vec<Warning>) -> [Dividers; 2] {
    let divides = |way: &Way| {
        half_width_m(way.class).is_some() && way.points.len() >= 2 && way.points.iter().all(|p| p.is_finite())
    };
    let all: Vec<usize> = (0..city.ways.len()).filter(|i| divides(&city.ways[*i])).collect();
    let road = area_of(city, LandCover::Road);
    let others = [LandCover::Water, LandCover::Rail].map(|cover| area_of(city, cover));
    let wide = grown(&shrunk(&road, 0.5 * settings.main_width_m), 0.5 * settings.main_width_m);
    let wide = common(&wide, &road);
    let mut main: Vec<usize> = all.iter().copied().filter(|i| is_main(city.ways[*i].class)).collect();
    let is_street = |i: &usize| !matches!(city.ways[*i].class, WayClass::Rail | WayClass::Waterway);
    if !main.iter().any(is_street) && wide.0.is_empty() && all.iter().any(is_street) {
        let streets: Vec<usize> = all.iter().copied().filter(is_street).collect();
        let chosen = longest_strokes(&city.ways, &streets);
        let (count, of) = (chosen.len(), streets.len());
        let text = format!(
            "no street is of a main class: the longest runs of streets, {count} of {of} pieces, divide the blocks of loa2"
        );
        notes.push(Warning::new(WarningKind::Assumed, text).with("count", count as f64).with("of", of as f64));
        main.extend(chosen);
    }
    if all.is_empty() && road.0.is_empty() {
        let text = "the city has no streets: every group of buildings is one cell";
        notes.push(Warning::new(WarningKind::Assumed, text));
    }
    let lines = |ways: &[usize]| along_ways(&city.ways, ways);
    let [water, rail] = others;
    let fine = union(vec![lines(&all), road, water.clone(), rail.clone()]);
    let coarse = union(vec![lines(&main), wide, water, rail]);
    [Dividers { land: fine, ways: all }, Dividers { land: coarse, ways: main }]
}

/// Land of one cover.
fn area_of(city: &City, cover: LandCover) -> Land {
    let parts = city.areas.par_iter().filter(|a| a.cover == cover).map(|a| land_of(&a.polygons)).collect();
    union(by_place(parts))
}

/// Land within the half widths of ways.
fn along_ways(ways: &[Way], chosen: &[usize]) -> Land {
    let parts: Vec<Land> = chosen
        .par_iter()
        .filter_map(|i| {
            let way = &ways[*i];
            let line = LineString::from(way.points.iter().map(|p| (p.x, p.y)).collect::<Vec<_>>());
            Some(along(&line, half_width_m(way.class)?))
        })
        .collect();
    union(by_place(parts))
}
