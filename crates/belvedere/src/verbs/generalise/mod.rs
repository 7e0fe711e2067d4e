//! `generalise`: levels of abstraction of a city.

mod read;

use crate::answers;
use crate::city_map::overview::{Panel, overview};
use crate::city_map::{MapPicture, bounds, map_picture};
use crate::guard::guarded;
use crate::names::PublicNames;
use crate::record::{self, InputFile};
use crate::request::Generalise;
use crate::{BelvedereError, output};
use belvedere_construct::generalise::{GeneraliseReport, GeneraliseSettings, Generalised, LevelReport};
use belvedere_core::DVec2;
use belvedere_core::Warning;
use belvedere_io::city_write::{BlockFigures, write_city_json};
use belvedere_io::png;
use belvedere_resolve::city_blocks;
use belvedere_resolve::city_ground::Bases;
use belvedere_scene::Progress;
use belvedere_scene::city::City;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Longer side of the map, pixels, and its smallest pixel, metres.
const MAP_PX: usize = 4096;
const MAP_LEAST_M: f64 = 0.25;
/// Margin around the buildings on the map, metres.
const MAP_MARGIN_M: f64 = 50.0;

/// A city and its levels.
pub struct GeneralisedCity {
    /// The city in metres.
    pub city: City,
    /// Code of its coordinate system, if it has one.
    pub epsg: Option<u32>,
    /// The levels and their report.
    pub generalised: Generalised,
    /// Warnings of reading the files.
    pub warnings: Vec<Warning>,
    inputs: Vec<InputFile>,
}

/// Content of the report file and of `--json`.
#[derive(Debug, JsonSchema, Serialize)]
pub struct GeneraliseDocument<'a> {
    program: &'static str,
    crs: Option<String>,
    inputs: Vec<InputFile>,
    #[serde(flatten)]
    report: &'a GeneraliseReport,
    warnings: Vec<Warning>,
}

/// Reads a city and generalises it.
///
/// # Errors
/// [`BelvedereError::Io`], [`BelvedereError::Crs`], [`BelvedereError::Generalise`].
pub fn generalise(request: &Generalise, progress: &Progress) -> Result<GeneralisedCity, BelvedereError> {
    guarded(|| generalised(request, progress))
}

fn generalised(request: &Generalise, progress: &Progress) -> Result<GeneralisedCity, BelvedereError> {
    progress.tick("read", 0.0)?;
    let roads: Vec<PathBuf> = request.roads.iter().map(PathBuf::from).collect();
    let mut settings = GeneraliseSettings { keep: request.keep, ..GeneraliseSettings::default() };
    settings.margin_m = request.margin.unwrap_or(settings.margin_m);
    let read::Read { city, epsg, inputs, warnings } = read::read(Path::new(&request.city), &roads)?;
    let mut generalised = belvedere_construct::generalise::generalise(&city, &settings, progress)?;
    let mut bases = Bases::default();
    bases.add(&city, 0.0);
    if let Some(ground) = bases.ground() {
        generalised.levels.iter_mut().for_each(|level| city_blocks::stand(level, &ground));
        generalised.measure(&city);
    }
    Ok(GeneralisedCity { city, epsg, generalised, warnings, inputs: record::inputs(&inputs)? })
}

fn many(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Every file that is written into `folder`; which map depends on the coordinate system.
pub fn files(folder: &Path, epsg: Option<u32>) -> Vec<PathBuf> {
    let names = ["loa1.city.json", "loa2.city.json", "report.json", "overview.png"];
    names.iter().map(|name| folder.join(name)).chain(MapPicture::files(folder, epsg)).collect()
}

impl GeneralisedCity {
    /// Content of the report file and of `--json`.
    pub fn document(&self) -> GeneraliseDocument<'_> {
        let files: Vec<PathBuf> = self.inputs.iter().map(|input| input.path.clone()).collect();
        let names = PublicNames::new(None, Vec::new(), &files);
        GeneraliseDocument {
            program: concat!("belvedere ", env!("CARGO_PKG_VERSION")),
            crs: self.epsg.map(|code| format!("EPSG:{code}")),
            inputs: names.inputs(&self.inputs),
            report: &self.generalised.report,
            warnings: names.warnings(&self.warnings),
        }
    }

    /// Levels that do not keep the volume, one sentence each.
    pub fn missed(&self) -> Vec<String> {
        self.generalised.report.levels.iter().filter_map(LevelReport::missed).collect()
    }

    /// Blocks that leave some of their buildings out or whose buildings overlap, one sentence for each reason.
    pub fn failing(&self) -> Vec<Warning> {
        self.generalised.report.levels.iter().flat_map(LevelReport::failing).collect()
    }

    /// One line per level.
    pub fn summary(&self) -> String {
        let report = &self.generalised.report;
        let mut text = format!("{} buildings, {:.1} s", report.buildings, report.seconds);
        for l in &report.levels {
            text += &format!(
                "\n{}: {} blocks in {} cells ({} green), {} landmarks, {:.1} % of the volume, {:.1} % of the built ground, {:.0} % of the triangles",
                l.name,
                l.blocks,
                l.cells,
                l.green_cells,
                l.landmarks,
                100.0 * l.volume_share,
                100.0 * l.covered_share,
                100.0 * l.triangles as f64 / report.triangles.max(1) as f64
            );
        }
        text
    }

    /// Writes [`files`] into `folder`, which is made if it is not there; the report last.
    ///
    /// # Errors
    /// [`BelvedereError::Io`], [`BelvedereError::Output`], [`BelvedereError::Cancelled`].
    pub fn write(&self, folder: &Path, overwrite: bool, progress: &Progress) -> Result<Vec<PathBuf>, BelvedereError> {
        belvedere_io::atomic::together(|| self.write_each(folder, overwrite, progress))
    }

    fn write_each(&self, folder: &Path, overwrite: bool, progress: &Progress) -> Result<Vec<PathBuf>, BelvedereError> {
        std::fs::create_dir_all(folder).map_err(|e| belvedere_io::IoError::os(folder, e))?;
        let inputs: Vec<PathBuf> = self.inputs.iter().map(|i| i.path.clone()).collect();
        let files = files(folder, self.epsg);
        for path in &files {
            output::check(path, &inputs, overwrite)?;
        }
        for (number, (level, path)) in self.generalised.levels.iter().zip(&files).enumerate() {
            progress.tick("write", 0.2 * number as f64)?;
            let stands_for = level.blocks.iter().zip(&level.members);
            let figures = stands_for.map(|(b, members)| BlockFigures { coverage: b.coverage, count: members.len() });
            write_city_json(path, &level.city, &figures.collect::<Vec<_>>(), self.epsg, overwrite)?;
        }
        progress.tick("map", 0.4)?;
        self.map().write(folder, self.epsg, overwrite)?;
        progress.tick("overview", 0.8)?;
        let (pixels, width) = self.overview();
        let height = pixels.len() / width;
        png::write(&files[3], overwrite, width, height, png::Channels::Rgb, pixels.as_flattened(), &[])?;
        output::write_text(&files[2], &answers::in_file("generalise", &files, &self.document())?, overwrite)?;
        Ok(files)
    }

    /// The ground as a map: land cover, water and roads of the city, green cells, and the blocks of the finer level.
    pub fn map(&self) -> MapPicture {
        let fine = &self.generalised.levels[0].city;
        let ground = City { areas: fine.areas.clone(), ways: self.city.ways.clone(), ..City::default() };
        let [low, high] = bounds(&self.city).unwrap_or([DVec2::ZERO, DVec2::ONE]);
        map_picture(&ground, &fine.buildings, [low - MAP_MARGIN_M, high + MAP_MARGIN_M], MAP_PX, MAP_LEAST_M)
    }

    /// Plan drawings of the city and its levels side by side: RGB pixels and the width.
    pub fn overview(&self) -> (Vec<[u8; 3]>, usize) {
        let [fine, coarse] = &self.generalised.levels;
        let counted =
            |level: &LevelReport| format!("{}, {}", many(level.blocks, "block"), many(level.landmarks, "landmark"));
        let figures = &self.generalised.report.levels;
        let notes = [many(self.city.buildings.len(), "building"), counted(&figures[0]), counted(&figures[1])];
        let titles = ["The city as mapped", "Blocks between all streets", "Blocks between main streets"];
        let cities = [&self.city, &fine.city, &coarse.city];
        let panels: Vec<Panel<'_>> =
            (0..3).map(|i| Panel { title: [titles[i], &notes[i]], city: cities[i], landmarks: i > 0 }).collect();
        overview(&self.city, &panels)
    }
}
