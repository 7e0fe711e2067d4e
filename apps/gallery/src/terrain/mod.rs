//! `figures terrain`: the figures and tables of Deng et al. 2013, drawn again on open data.

pub(crate) mod area;
mod cells;
mod eyes;
mod page;
mod pictures;
pub(crate) mod profile;
mod sweeps;
mod timing;

use crate::sheet::{self, Pixels};
use anyhow::{Context, Result, bail};
use area::Area;
use belvedere::OpenOptions;
use belvedere::output::{self, pretty};
use page::AreaRecord;
use pictures::Solutions;
use std::path::{Path, PathBuf};

/// Areas that are drawn if no scene is given; they need no files.
const BUILTIN: [(&str, &str); 2] = [
    ("massif_terrain", include_str!("../../../../scenes/massif_terrain.toml")),
    ("massif_lake_terrain", include_str!("../../../../scenes/massif_lake_terrain.toml")),
];

/// Real ranges that are drawn beside those where the environment variable `BELVEDERE_DATA` names the collection that holds their files.
const REAL: [(&str, &str); 2] = [
    ("andorra_terrain", include_str!("../../../../scenes/andorra_terrain.toml")),
    ("baltoro_terrain", include_str!("../../../../scenes/baltoro_terrain.toml")),
];

/// The scene files and texts of the areas that are drawn if no scene is given.
fn usual_areas() -> Vec<(PathBuf, Option<&'static str>)> {
    let scene = |folder: &Path, name: &str| folder.join(format!("{name}.toml"));
    let builtin = BUILTIN.map(|(name, text)| (scene(Path::new(""), name), Some(text)));
    let Some(data) = std::env::var_os("BELVEDERE_DATA").map(PathBuf::from).filter(|d| d.is_dir()) else {
        return builtin.into();
    };
    builtin.into_iter().chain(REAL.map(|(name, text)| (scene(&data, name), Some(text)))).collect()
}

/// Draws the figures of terrain disocclusion into `folder`, which is created if necessary, for the areas of `scenes` (two built-in
/// ones if there are none, and two real ranges where `BELVEDERE_DATA` names their files): pictures, `figures.json` with every report,
/// and `index.html`. Returns the files.
///
/// # Errors
/// A file that exists if `overwrite` is false; those of opening, solving and drawing a scene.
pub fn figures(folder: &Path, scenes: &[PathBuf], options: &OpenOptions, overwrite: bool) -> Result<Vec<PathBuf>> {
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let (page, record) = (folder.join("index.html"), folder.join("figures.json"));
    output::check(&page, scenes, overwrite)?;
    output::check(&record, scenes, overwrite)?;
    let given = scenes.iter().map(|path| (path.clone(), None));
    let areas = if scenes.is_empty() { usual_areas() } else { given.collect() };
    let mut names: Vec<_> = areas.iter().filter_map(|(path, _)| path.file_stem()).collect();
    names.sort();
    if let Some(twice) = names.windows(2).find(|pair| pair[0] == pair[1]) {
        let name = twice[0].to_string_lossy();
        bail!("two scenes are called {name}, and so would their pictures; rename one");
    }
    for (name, what) in names.iter().flat_map(|name| PICTURES.map(|what| (name, what))) {
        output::check(&area::picture(folder, &name.to_string_lossy(), what), scenes, overwrite)?;
    }
    let (mut records, mut written) = (Vec::new(), Vec::new());
    for (path, text) in &areas {
        let area = Area::open(path, *text, options)?;
        records.push(figures_of(&area, folder, overwrite, &mut written)?);
    }
    output::write_text(&record, &pretty(&records)?, overwrite)?;
    output::write_text(&page, &page::page(&records), overwrite)?;
    written.extend([record, page]);
    Ok(written)
}

/// Endings of the picture names of an area.
const PICTURES: [&str; 6] = ["pair", "steps", "profile", "w", "eta", "times"];

fn figures_of(area: &Area, folder: &Path, overwrite: bool, written: &mut Vec<PathBuf>) -> Result<AreaRecord> {
    let mut pictures = Vec::new();
    let mut keep = |what: &str, pixels: Pixels| -> Result<()> {
        let path = area::picture(folder, &area.name, what);
        sheet::write(&path, pixels, NOTE, overwrite)?;
        pictures.extend(path.file_name().map(|n| n.to_string_lossy().into_owned()));
        written.push(path);
        Ok(())
    };
    let tick = |done: f64| area.progress.tick(&format!("figures of {}", area.name), done);
    tick(0.0)?;
    let solutions = Solutions::of(area)?;
    keep("pair", pictures::pair(area, &solutions)?)?;
    tick(0.2)?;
    keep("steps", pictures::steps(area, &solutions)?)?;
    if let Some(profile) = profile::profile(area, &solutions.qp)? {
        keep("profile", profile)?;
    }
    tick(0.35)?;
    let (sheet, w) = sweeps::over_w(area)?;
    keep("w", sheet)?;
    tick(0.5)?;
    let (sheet, eta) = sweeps::over_eta(area)?;
    keep("eta", sheet)?;
    tick(0.65)?;
    let timing = timing::timing(area)?;
    if let Some(plot) = timing::plot(&timing)? {
        keep("times", plot)?;
    }
    tick(0.8)?;
    let eyes = eyes::eyes(area)?;
    let Solutions { paper, paper_qp, qp } = solutions;
    Ok(AreaRecord {
        name: area.name.clone(),
        title: area.session.scene().title.clone(),
        pictures,
        modes: [paper, paper_qp, qp].map(|s| s.report).into(),
        w,
        eta,
        eyes,
        timing,
        warnings: area.session.warnings(),
    })
}

/// Comment in the metadata of every picture.
const NOTE: &str = "displaced ground unless a panel says perspective; not to scale, not for navigation";
