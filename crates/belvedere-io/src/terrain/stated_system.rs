//! The coordinate system of a raster.

use crate::crs::CoordinateSystem;
use crate::{Affine, Fault, IoError, RasterInfo, SourceCrs};
use belvedere_core::{Warning, WarningKind};
use std::path::Path;

/// System of a raster: the given code, else what the file says; `None` if neither tells. Coordinates that can only be
/// degrees are taken as such, with a warning. A `local` scene does not need one.
pub(crate) fn stated_system(
    info: &RasterInfo,
    source_crs: Option<u32>,
    local: bool,
    warnings: &mut Vec<Warning>,
) -> Result<Option<CoordinateSystem>, IoError> {
    let failed = |e: crate::crs::CrsError| {
        let reason = format!("its coordinate system cannot be used: {e}; or set source_crs of its layer");
        IoError::format(&info.path, Fault::lifted_by(reason, &["source_crs"]))
    };
    let Some(to_model) = info.pixel_to_model else {
        return Ok(None);
    };
    if let Some(code) = source_crs {
        return CoordinateSystem::from_epsg(code).map(Some).map_err(failed);
    }
    match &info.crs {
        SourceCrs::Epsg(code) => CoordinateSystem::from_epsg(*code).map(Some).map_err(failed),
        SourceCrs::Wkt(text) => {
            let system = CoordinateSystem::from_text(text).map_err(failed)?;
            if system.is_local() && !local {
                warnings.push(of_another_body(&info.path, system.name()));
            }
            Ok((!system.is_local()).then_some(system))
        }
        SourceCrs::OtherBody(name) => {
            if !local {
                warnings.push(of_another_body(&info.path, name));
            }
            Ok(None)
        }
        SourceCrs::UserDefined(_) if local => Ok(None),
        SourceCrs::UserDefined(text) => {
            let reason = format!(
                "its coordinate system cannot be used ({text}); set its EPSG code as source_crs of its layer, or crs = \"local\" to draw it without georeference"
            );
            Err(IoError::format(&info.path, Fault::lifted_by(reason, &["source_crs", "crs"])))
        }
        SourceCrs::Unknown if !local && looks_geographic(info, &to_model) => {
            let text = "no coordinate system is stated and the coordinates look like degrees, so EPSG:4326 is assumed; source_crs of its layer says otherwise";
            warnings.push(Warning::new(WarningKind::Assumed, text).settled_by("source_crs").in_file(&info.path));
            CoordinateSystem::from_epsg(4326).map(Some).map_err(failed)
        }
        SourceCrs::Unknown => Ok(None),
    }
}

/// Whether a system is of another body than the Earth.
pub(super) fn is_of_another_body(crs: &SourceCrs) -> bool {
    match crs {
        SourceCrs::OtherBody(_) => true,
        SourceCrs::Wkt(text) => CoordinateSystem::from_text(text).is_ok_and(|system| system.is_local()),
        _ => false,
    }
}

fn of_another_body(path: &Path, name: &str) -> Warning {
    let text = format!("its coordinate system ({name}) is of another body than the Earth, so the scene is local");
    Warning::new(WarningKind::Assumed, text).in_file(path)
}

/// Whether coordinates can only be degrees: in the range of longitude and latitude, with steps finer than any metric grid.
fn looks_geographic(info: &RasterInfo, to_model: &Affine) -> bool {
    let corners = [[0.0, 0.0], [info.width as f64, info.height as f64]].map(|[c, r]| to_model.apply(c, r));
    let [step_x, step_y] = [to_model.0[0].hypot(to_model.0[3]), to_model.0[1].hypot(to_model.0[4])];
    corners.iter().all(|p| p[0].abs() <= 360.0 && p[1].abs() <= 90.0) && step_x < 0.1 && step_y < 0.1
}
