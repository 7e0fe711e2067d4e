//! One level of abstraction: cells, landmarks, blocks and their volumes, put together as a city.

use super::blocks::{CellKind, Footprint, Grain, Site, footprint, kind};
use super::landmarks::{Usual, Volume, landmarks, mean_height};
use super::report::{BlockReport, FailingCell, LevelReport, VOLUME_OFF};
use super::settings::GeneraliseSettings;
use super::shapes::{Land, area, polygons_of, triangles};
use super::solid::volume_m3;
use super::streets::Dividers;
use belvedere_scene::city::{Building, City, CityArea, HeightSource, Keep, LandCover, Polygon, StructureKind};
use geo::{Area, InteriorPoint, MultiPolygon};
use rayon::prelude::*;

/// A city at one level of abstraction.
#[derive(Debug, Clone)]
pub struct Level {
    /// `loa1` or `loa2`.
    pub name: &'static str,
    /// Blocks, in the order of `blocks`, then landmarks in their own shape; green cells as areas; the ways that divide.
    pub city: City,
    /// Data of each block.
    pub blocks: Vec<Block>,
    /// For each building of `city` those that it stands for, indices in the list of the city that was generalised.
    pub members: Vec<Vec<usize>>,
    /// All cells.
    pub cells: Vec<Cell>,
    /// Ground of streets, railways and water that divides the cells, as far as it reaches.
    pub streets: Vec<Polygon>,
}

/// The buildings that a block stands for.
#[derive(Debug, Clone)]
pub struct Block {
    /// Index of its cell in [`Level::cells`].
    pub cell: usize,
    /// Share of its footprint that the buildings that it stands for cover, at most 1.
    pub coverage: f64,
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
    /// Its buildings that a block stands for or that are not shown, indices in the city's list.
    pub buildings: Vec<usize>,
    /// Its landmarks, indices in the city's list.
    pub landmarks: Vec<usize>,
}

/// Buildings that have an area.
pub(super) struct Input<'a> {
    pub city: &'a City,
    /// Index of each in the city's list.
    pub places: Vec<usize>,
    /// Outlines.
    pub lands: Vec<Land>,
    /// Footprint areas and heights.
    pub volumes: Vec<Volume>,
    /// What heights are usual in the town.
    pub usual: Usual,
}

impl Input<'_> {
    fn volume(&self, i: usize) -> f64 {
        self.volumes[i].area_m2 * self.volumes[i].height_m
    }

    /// Triangles of buildings as prisms.
    pub(super) fn triangles(&self, buildings: &[usize]) -> usize {
        buildings.iter().map(|i| triangles(&self.lands[*i])).sum()
    }

    /// Volume between the surfaces of buildings, m^3.
    fn held(&self, buildings: &[usize]) -> f64 {
        buildings.iter().map(|i| volume_m3(&self.city.buildings[self.places[*i]])).sum()
    }

    pub(super) fn volume_of(&self, buildings: &[usize]) -> f64 {
        buildings.iter().map(|i| self.volume(*i)).sum()
    }
}

/// A cell before its block is made; indices are those of [`Input`].
struct Made {
    land: Land,
    coverage: f64,
    kind: CellKind,
    ordinary: Vec<usize>,
    landmarks: Vec<usize>,
    block: Option<MadeBlock>,
}

struct MadeBlock {
    shape: Footprint,
    height_m: f64,
}

impl MadeBlock {
    /// Share of the footprint that its buildings cover.
    fn coverage(&self) -> f64 {
        (self.shape.covered_m2 / area(&self.shape.land).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
    }

    fn covered_share(&self) -> f64 {
        (self.shape.covered_m2 / self.shape.built_m2.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
    }
}

/// Blocks of the finer level, each with the index of one of its buildings in [`Input`], and its landmarks.
pub(super) struct Finer {
    pub blocks: Vec<(Land, usize)>,
    pub landmarks: Vec<usize>,
}

/// Settings that differ between the levels.
pub(super) struct Plan<'a> {
    pub name: &'static str,
    /// The level that the blocks are put together from.
    pub finer: Option<&'a Finer>,
    pub grain: Grain,
}

/// The level, its figures without volumes, and its blocks and landmarks for the next.
pub(super) fn level(
    plan: &Plan<'_>,
    input: &Input<'_>,
    (lands, merged): (Vec<Land>, usize),
    of: &[Option<usize>],
    dividers: &Dividers,
    settings: &GeneraliseSettings,
) -> (Level, LevelReport, Finer) {
    let mut members = vec![Vec::new(); lands.len()];
    let mut homeless = Vec::new();
    for (building, cell) in of.iter().enumerate() {
        match cell {
            Some(cell) => members[*cell].push(building),
            None => homeless.push(building),
        }
    }
    let mut finer: Vec<Vec<&Land>> = vec![Vec::new(); lands.len()];
    for (land, building) in plan.finer.iter().flat_map(|f| &f.blocks) {
        if let Some(cell) = of[*building] {
            finer[cell].push(land);
        }
    }
    for building in plan.finer.iter().flat_map(|f| &f.landmarks) {
        if let Some(cell) = of[*building] {
            finer[cell].push(&input.lands[*building]);
        }
    }
    let of_size = |land: &Land, members: &Vec<usize>| !members.is_empty() || area(land) >= settings.smallest_cell_m2;
    let found = lands.len();
    let cells = lands.into_iter().zip(members).zip(finer).filter(|((l, m), _)| of_size(l, m));
    let cells: Vec<_> = cells.map(|((land, members), finer)| (land, members, finer)).collect();
    let dropped = found - cells.len();
    let make_one = |(land, members, finer): (Land, Vec<usize>, Vec<&Land>)| {
        make(input, land, &members, &finer, (plan.grain, settings))
    };
    let made: Vec<Made> = cells.into_par_iter().map(make_one).collect();
    let report = figures(plan.name, input, &made, &homeless, dividers, [merged, dropped]);
    let landmarks = made.iter().flat_map(|m| m.landmarks.iter().copied()).chain(homeless.iter().copied()).collect();
    let blocks = made.iter().filter_map(|m| Some((m.block.as_ref()?.shape.land.clone(), *m.ordinary.first()?)));
    let next = Finer { blocks: blocks.collect(), landmarks };
    (assemble(plan.name, input, made, &homeless, dividers), report, next)
}

fn make(
    input: &Input<'_>,
    land: Land,
    members: &[usize],
    finer: &[&Land],
    (grain, settings): (Grain, &GeneraliseSettings),
) -> Made {
    let built: f64 = members.iter().map(|i| input.volumes[*i].area_m2).sum();
    let coverage = built / area(&land).max(f64::MIN_POSITIVE);
    let landmarks = landmarks(&input.volumes, members, input.usual, settings.keep);
    let ordinary: Vec<usize> = members.iter().copied().filter(|i| !landmarks.contains(i)).collect();
    let kind = kind(coverage, ordinary.len(), settings);
    let lands_of = |places: &[usize]| places.iter().map(|i| &input.lands[*i]).collect::<Vec<_>>();
    let block = (!ordinary.is_empty()).then(|| {
        let (ordinary_lands, landmark_lands) = (lands_of(&ordinary), lands_of(&landmarks));
        let site = Site { cell: &land, ordinary: &ordinary_lands, landmarks: &landmark_lands, finer };
        let shape = footprint(&site, grain, input.triangles(&ordinary), settings);
        let height_m = match settings.keep {
            Keep::Height => mean_height(ordinary.iter().map(|i| input.volumes[*i])),
            Keep::Volume => input.held(&ordinary) / area(&shape.land).max(f64::MIN_POSITIVE),
        };
        MadeBlock { shape, height_m }
    });
    let block = block.filter(|b| !b.shape.land.0.is_empty());
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
    let blocks = || made.iter().filter_map(|m| m.block.as_ref());
    let sum = |of: fn(&MadeBlock) -> f64| blocks().map(of).sum::<f64>();
    let (built, covered) = (sum(|b| b.shape.built_m2), sum(|b| b.shape.covered_m2));
    let landmarks: Vec<usize> = made.iter().flat_map(|m| &m.landmarks).chain(homeless).copied().collect();
    let numbered = || made.iter().enumerate();
    LevelReport {
        name,
        streets: dividers.ways.len(),
        cells: made.len(),
        cells_merged: merged,
        cells_dropped: dropped,
        blocks: blocks().count(),
        green_cells: green().count(),
        buildings_in_green: green().map(|m| m.ordinary.len()).sum(),
        volume_in_green_m3: green().map(|m| input.volume_of(&m.ordinary)).sum(),
        landmarks: landmarks.len(),
        block_area_m2: sum(|b| area(&b.shape.land)),
        built_area_m2: built,
        covered_share: if built > 0.0 { covered / built } else { 1.0 },
        triangles: blocks().map(|b| triangles(&b.shape.land)).sum::<usize>() + input.triangles(&landmarks),
        volume_m3: 0.0,
        volume_share: 0.0,
        volume_kept: false,
        cells_failing: numbered().filter_map(|(number, m)| failing(input, cell_name(name, number), m)).collect(),
        each_block: numbered().filter_map(|(number, m)| block_report(cell_name(name, number), m)).collect(),
    }
}

/// Least share of the ground of a block's buildings that has to lie in it.
const LEAST_COVERED: f64 = 0.9;

/// Report of a cell whose block misses some of the ground of its buildings, or stands for several at one place; without volumes.
fn failing(input: &Input<'_>, cell: String, m: &Made) -> Option<FailingCell> {
    let held = input.volume_of(&m.ordinary) + input.volume_of(&m.landmarks);
    // Overlaps count once in the ground that is covered.
    let mean_m = mean_height(m.ordinary.iter().map(|i| input.volumes[*i]));
    let shown = m.block.as_ref().map_or(0.0, |b| b.shape.covered_m2 * mean_m) + input.volume_of(&m.landmarks);
    let covered_share = m.block.as_ref().map_or(f64::from(m.ordinary.is_empty()), MadeBlock::covered_share);
    let reason = if m.block.is_none() && !m.ordinary.is_empty() {
        "no room for a block"
    } else if covered_share < LEAST_COVERED {
        "buildings reach out of the block"
    } else if (shown - held).abs() > VOLUME_OFF * held {
        "buildings overlap each other"
    } else {
        return None;
    };
    Some(FailingCell {
        cell,
        at: point_of(&m.land),
        reason,
        buildings: m.ordinary.len() + m.landmarks.len(),
        volume_in_m3: 0.0,
        volume_out_m3: 0.0,
        covered_share,
    })
}

fn block_report(block: String, m: &Made) -> Option<BlockReport> {
    let made = m.block.as_ref()?;
    Some(BlockReport {
        block,
        buildings: m.ordinary.len(),
        area_m2: area(&made.shape.land),
        height_m: made.height_m,
        covered_share: made.covered_share(),
        coverage: made.coverage(),
        volume_in_m3: 0.0,
        volume_out_m3: 0.0,
    })
}

fn cell_name(level: &str, number: usize) -> String {
    format!("{level}-{}", number + 1)
}

/// Name of a block: that of the largest of its buildings that has one.
fn name_of(city: &City, buildings: &[usize]) -> String {
    let named = buildings.iter().map(|i| &city.buildings[*i]).filter(|b| !b.name.is_empty());
    named.max_by(|a, b| volume_m3(a).total_cmp(&volume_m3(b))).map(|b| b.name.clone()).unwrap_or_default()
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
    let (mut blocks, mut members, mut cells, mut own_shape) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (number, made) in made.into_iter().enumerate() {
        let polygons = polygons_of(&made.land);
        let (id, ordinary) = (cell_name(name, number), places(&made.ordinary));
        if let Some(made) = made.block {
            let coverage = made.coverage();
            let MadeBlock { shape, height_m } = made;
            let bases = ordinary.iter().filter_map(|i| from.buildings[*i].base_m);
            city.buildings.push(Building {
                id: id.clone(),
                name: name_of(from, &ordinary),
                landmark: false,
                footprint: polygons_of(&shape.land),
                base_m: bases.min_by(f64::total_cmp),
                height_m,
                height_source: HeightSource::Stated,
                faces: Vec::new(),
            });
            blocks.push(Block { cell: number, coverage });
            members.push(ordinary.clone());
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
    members.extend(own_shape.iter().map(|i| vec![*i]));
    city.buildings.extend(own_shape.into_iter().map(|i| Building { landmark: true, ..from.buildings[i].clone() }));
    let streets = polygons_of(&MultiPolygon(dividers.land.0.clone()));
    Level { name, city, blocks, members, cells, streets }
}
