//! One level of abstraction: cells, landmarks, blocks and their volumes, put together as a city.

use super::blocks::{CellKind, footprint, kind};
use super::landmarks::{Volume, landmarks, mean_height};
use super::report::{FailingCell, LevelReport};
use super::settings::GeneraliseSettings;
use super::shapes::{Land, area, polygons_of};
use super::streets::Dividers;
use belvedere_scene::city::{Building, City, CityArea, HeightSource, LandCover, Polygon, StructureKind};
use geo::{Area, InteriorPoint, MultiPolygon};
use rayon::prelude::*;

/// A city at one level of abstraction.
#[derive(Debug, Clone)]
pub struct Level {
    /// `loa1` or `loa2`.
    pub name: &'static str,
    /// Blocks, in the order of `blocks`, then landmarks in their own shape; green cells as areas; the ways that divide.
    pub city: City,
    /// What is known of each block.
    pub blocks: Vec<Block>,
    /// All cells.
    pub cells: Vec<Cell>,
    /// Ground of streets, railways and water that divides the cells, as far as it reaches.
    pub streets: Vec<Polygon>,
}

/// What a block stands for.
#[derive(Debug, Clone)]
pub struct Block {
    /// Its cell, place in [`Level::cells`].
    pub cell: usize,
    /// Share of its footprint that the buildings that it stands for cover, at most 1.
    pub coverage: f64,
    /// Buildings that it stands for.
    pub count: usize,
}

/// Ground between streets.
#[derive(Debug, Clone)]
pub struct Cell {
    /// Name, from the level and a running number.
    pub name: String,
    /// A point of it.
    pub at: [f64; 2],
    /// Its ground.
    pub polygons: Vec<Polygon>,
    /// Area, m^2.
    pub area_m2: f64,
    /// Footprints of its buildings over its area; over 1 where buildings overlap or reach into the streets.
    pub coverage: f64,
    /// What it is drawn as.
    pub kind: CellKind,
    /// Its buildings that a block stands for or that are not shown, places in the city's list.
    pub buildings: Vec<usize>,
    /// Its landmarks, places in the city's list.
    pub landmarks: Vec<usize>,
}

/// Buildings that have an area.
pub(super) struct Input<'a> {
    pub city: &'a City,
    /// Place of every one in the city's list.
    pub places: Vec<usize>,
    /// Outlines.
    pub lands: Vec<Land>,
    /// What heights need.
    pub volumes: Vec<Volume>,
}

impl Input<'_> {
    fn volume(&self, i: usize) -> f64 {
        self.volumes[i].area_m2 * self.volumes[i].height_m
    }

    pub(super) fn volume_of(&self, buildings: &[usize]) -> f64 {
        buildings.iter().map(|i| self.volume(*i)).sum()
    }
}

/// A cell on its way to its block; places are those of [`Input`].
struct Made {
    land: Land,
    coverage: f64,
    kind: CellKind,
    ordinary: Vec<usize>,
    landmarks: Vec<usize>,
    block: Option<(Land, f64, f64)>,
}

/// The level, its figures, and its landmarks (places in `input`). Only `candidates` can be landmarks.
pub(super) fn level(
    name: &'static str,
    input: &Input<'_>,
    (lands, merged): (Vec<Land>, usize),
    of: &[Option<usize>],
    dividers: &Dividers,
    candidates: impl Fn(usize) -> bool + Sync,
    settings: &GeneraliseSettings,
) -> (Level, LevelReport, Vec<usize>) {
    let mut members = vec![Vec::new(); lands.len()];
    let mut homeless = Vec::new();
    for (building, cell) in of.iter().enumerate() {
        match cell {
            Some(cell) => members[*cell].push(building),
            None => homeless.push(building),
        }
    }
    let of_size = |land: &Land, members: &Vec<usize>| !members.is_empty() || area(land) >= settings.smallest_cell_m2;
    let found = lands.len();
    let cells: Vec<(Land, Vec<usize>)> = lands.into_iter().zip(members).filter(|(l, m)| of_size(l, m)).collect();
    let dropped = found - cells.len();
    let made: Vec<Made> =
        cells.into_par_iter().map(|(land, members)| make(input, land, &members, &candidates, settings)).collect();
    let report = figures(name, input, &made, &homeless, dividers, [merged, dropped]);
    let landmarks = made.iter().flat_map(|m| m.landmarks.iter().copied()).chain(homeless.iter().copied()).collect();
    (assemble(name, input, made, &homeless, dividers), report, landmarks)
}

fn make(
    input: &Input<'_>,
    land: Land,
    members: &[usize],
    candidates: &impl Fn(usize) -> bool,
    settings: &GeneraliseSettings,
) -> Made {
    let built: f64 = members.iter().map(|i| input.volumes[*i].area_m2).sum();
    let coverage = built / area(&land).max(f64::MIN_POSITIVE);
    let landmarks = landmarks(&input.volumes, members, candidates);
    let ordinary: Vec<usize> = members.iter().copied().filter(|i| !landmarks.contains(i)).collect();
    let kind = kind(coverage, ordinary.len(), settings);
    let lands_of = |places: &[usize]| places.iter().map(|i| &input.lands[*i]).collect::<Vec<_>>();
    let block = matches!(kind, CellKind::Sparse | CellKind::Built).then(|| {
        let shape = footprint(&land, kind, &lands_of(&ordinary), &lands_of(&landmarks), settings);
        let built: f64 = ordinary.iter().map(|i| input.volumes[*i].area_m2).sum();
        let coverage = (built / area(&shape).max(f64::MIN_POSITIVE)).min(1.0);
        (shape, mean_height(ordinary.iter().map(|i| input.volumes[*i])), coverage)
    });
    let block = block.filter(|(shape, ..)| !shape.0.is_empty());
    Made { land, coverage, kind, ordinary, landmarks, block }
}

fn point_of(land: &Land) -> [f64; 2] {
    let largest = land.iter().max_by(|a, b| a.unsigned_area().total_cmp(&b.unsigned_area()));
    largest.and_then(InteriorPoint::interior_point).map_or([0.0; 2], |p| [p.x(), p.y()])
}

fn figures(
    name: &'static str,
    input: &Input<'_>,
    made: &[Made],
    homeless: &[usize],
    dividers: &Dividers,
    [merged, dropped]: [usize; 2],
) -> LevelReport {
    let green = || made.iter().filter(|m| m.kind == CellKind::Green);
    let shown = |m: &Made| {
        let block = m.block.as_ref().map_or(0.0, |(shape, height, coverage)| area(shape) * height * coverage);
        block + input.volume_of(&m.landmarks)
    };
    let failing = |(number, m): (usize, &Made)| {
        let held = input.volume_of(&m.ordinary) + input.volume_of(&m.landmarks);
        let shown = shown(m);
        let reason = match (&m.block, m.kind) {
            (_, CellKind::Green) => "green",
            (None, _) => "no room for a block",
            (Some(_), _) => "buildings overlap or reach out of the cell",
        };
        ((shown - held).abs() > 0.1 * held).then(|| FailingCell {
            cell: cell_name(name, number),
            at: point_of(&m.land),
            reason,
            buildings: m.ordinary.len() + m.landmarks.len(),
            volume_in_m3: held,
            volume_out_m3: shown,
        })
    };
    let all: f64 = (0..input.volumes.len()).map(|i| input.volume(i)).sum();
    let volume = made.iter().map(shown).sum::<f64>() + input.volume_of(homeless);
    let share = volume / all.max(f64::MIN_POSITIVE);
    LevelReport {
        name,
        streets: dividers.ways.len(),
        cells: made.len(),
        cells_merged: merged,
        cells_dropped: dropped,
        blocks: made.iter().filter(|m| m.block.is_some()).count(),
        green_cells: green().count(),
        buildings_in_green: green().map(|m| m.ordinary.len()).sum(),
        volume_in_green_m3: green().map(|m| input.volume_of(&m.ordinary)).sum(),
        landmarks: made.iter().map(|m| m.landmarks.len()).sum::<usize>() + homeless.len(),
        volume_m3: volume,
        volume_share: share,
        volume_kept: (0.9..=1.1).contains(&share),
        cells_failing: made.iter().enumerate().filter_map(failing).collect(),
    }
}

fn cell_name(level: &str, number: usize) -> String {
    format!("{level}-{}", number + 1)
}

fn assemble(name: &'static str, input: &Input<'_>, made: Vec<Made>, homeless: &[usize], dividers: &Dividers) -> Level {
    let from = input.city;
    let places = |list: &[usize]| list.iter().map(|i| input.places[*i]).collect::<Vec<_>>();
    let mut city = City {
        structures: from.structures.iter().filter(|s| s.kind == StructureKind::Bridge).cloned().collect(),
        ways: dividers.ways.iter().map(|i| from.ways[*i].clone()).collect(),
        areas: from.areas.clone(),
        ..City::default()
    };
    let (mut blocks, mut cells, mut own_shape) = (Vec::new(), Vec::new(), Vec::new());
    for (number, made) in made.into_iter().enumerate() {
        let polygons = polygons_of(&made.land);
        let (id, ordinary) = (cell_name(name, number), places(&made.ordinary));
        if let Some((shape, height_m, coverage)) = made.block {
            let bases = ordinary.iter().filter_map(|i| from.buildings[*i].base_m);
            city.buildings.push(Building {
                id: id.clone(),
                name: String::new(),
                landmark: false,
                footprint: polygons_of(&shape),
                base_m: bases.min_by(f64::total_cmp),
                height_m,
                height_source: HeightSource::Stated,
                faces: Vec::new(),
            });
            blocks.push(Block { cell: number, coverage, count: ordinary.len() });
        }
        if made.kind == CellKind::Green {
            city.areas.push(CityArea { name: String::new(), cover: LandCover::Green, polygons: polygons.clone() });
        }
        own_shape.extend(places(&made.landmarks));
        cells.push(Cell {
            name: id,
            at: point_of(&made.land),
            area_m2: area(&made.land),
            polygons,
            coverage: made.coverage,
            kind: made.kind,
            buildings: ordinary,
            landmarks: places(&made.landmarks),
        });
    }
    own_shape.extend(places(homeless));
    city.buildings.extend(own_shape.into_iter().map(|i| Building { landmark: true, ..from.buildings[i].clone() }));
    let streets = polygons_of(&MultiPolygon(dividers.land.0.clone()));
    Level { name, city, blocks, cells, streets }
}
