//! Cities and streets from files, in metres.

use crate::BelvedereError;
use belvedere_core::{Warning, WarningKind};
use belvedere_io::city::reproject;
use belvedere_io::{CityFile, InputFile, IoError, Limits, load_city};
use belvedere_scene::City;
use std::path::{Path, PathBuf};

/// A city in metres and its origin.
pub(super) struct Read {
    pub city: City,
    /// Code of the metric system; `None` for files without one.
    pub epsg: Option<u32>,
    pub inputs: Vec<InputFile>,
    pub warnings: Vec<Warning>,
}

/// Reads the buildings, land cover and streets of `city`, and land cover and streets of `roads`.
///
/// # Errors
/// [`BelvedereError::Io`]: unreadable files, no building among the shapes, no metric system for them.
pub(super) fn read(city: &Path, roads: &[PathBuf]) -> Result<Read, BelvedereError> {
    let mut out = Read { city: City::default(), epsg: None, inputs: Vec::new(), warnings: Vec::new() };
    let mut first = out.load(city)?;
    if first.city.buildings.is_empty() {
        let reason = "holds no polygon that is a building; give building footprints first, then files of streets";
        return Err(IoError::format(city, reason).into());
    }
    let target = first.metric_system(None)?;
    out.epsg = target.as_ref().and_then(|t| t.epsg());
    let place = |out: &mut Read, file: &mut CityFile| -> Result<(), BelvedereError> {
        let (Some(from), Some(to)) = (&file.crs, &target) else { return Ok(()) };
        let lost = reproject(&mut file.city, from, to)?;
        let what = format!("shapes lie outside the domain of {to} and are left out");
        out.warnings.extend(Warning::counted(WarningKind::Ignored, lost, &what).map(|w| w.in_file(&file.path)));
        Ok(())
    };
    place(&mut out, &mut first)?;
    out.city = first.city;
    for path in roads {
        let mut more = out.load(path)?;
        place(&mut out, &mut more)?;
        let buildings = more.city.buildings.len();
        let what = "buildings are left out; those of the first file are taken";
        out.warnings.extend(Warning::counted(WarningKind::Ignored, buildings, what).map(|w| w.in_file(path)));
        out.city.ways.extend(more.city.ways);
        out.city.areas.extend(more.city.areas);
    }
    Ok(out)
}

impl Read {
    fn load(&mut self, path: &Path) -> Result<CityFile, BelvedereError> {
        let loaded = load_city(path, None, &Limits::default())?;
        self.warnings.extend(loaded.warnings);
        self.inputs.extend(loaded.files);
        Ok(loaded.value)
    }
}
