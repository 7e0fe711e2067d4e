//! Stacks of images in one TIFF: those of ImageJ, OME-TIFF, and pages of one size without a place on the earth.
//!
//! Source: TIFF 6.0; "TIFF format" of ImageJ (its class TiffEncoder); OME-TIFF specification 6 and OME-XML schema 2016-06.

use super::ome::Ome;
use super::pile::Pile;
use super::{VolumeFile, VolumeRequest, odd_values, unspaced};
use crate::geotiff::Pages;
use crate::{Fault, IoError, Limits, Loaded, budget};
use belvedere_core::{Warning, WarningKind};
use glam::{DMat3, DVec3};
use std::path::Path;

/// Which pages are slices of the volume, and where they lie.
struct Plan {
    format: &'static str,
    /// Indices of pages, from z = 0 on.
    slices: Vec<usize>,
    axes: DMat3,
    warnings: Vec<Warning>,
}

/// Whether a TIFF is a volume: it says that it is a stack, or has several pages of one size and no place on the earth.
pub(crate) fn is_stack(path: &Path) -> bool {
    let Ok(pages) = Pages::open(path, Limits::default()) else { return false };
    if pages.is_placed {
        return false;
    }
    match (ImageJ::of(&pages.description), Ome::of(&pages.description)) {
        (Some(stack), _) => stack.slices().is_some(),
        (_, Some(stack)) => stack.is_stack(),
        (None, None) => pages.count() > 1 && pages.odd_one().is_none(),
    }
}

pub(super) fn read(path: &Path, request: &VolumeRequest) -> Result<Loaded<VolumeFile>, IoError> {
    let pages = Pages::open(path, request.limits)?;
    let bad = |fault: Fault| IoError::format(path, fault);
    let _work = budget::work_on(path);
    let plan = Plan::of(&pages, path, request).map_err(|reason| bad(reason.into()))?;
    let mut pile = Pile::new(&pages.info, plan.slices.len(), &request.limits).map_err(bad)?;
    for (z, page) in plan.slices.iter().enumerate() {
        let slice =
            pages.read(*page).map_err(|e| bad(e.placed(format!("slice {} of {}", z + 1, plan.slices.len()))))?;
        pile.push(&slice).map_err(|e| bad(format!("page {} {e}", page + 1).into()))?;
    }
    let mut warnings: Vec<Warning> =
        plan.warnings.iter().cloned().chain(pile.warning()).map(|said| said.in_file(path)).collect();
    let (dims, stored, values, changed) = pile.finish();
    warnings.extend(odd_values(path, &changed));
    let Plan { format, axes, .. } = plan;
    let file = VolumeFile { format, array: None, stored, dims, axes, origin: DVec3::ZERO, values };
    Ok(Loaded::new(file, warnings).with_file(pages.input()?))
}

impl Plan {
    fn of(pages: &Pages, path: &Path, request: &VolumeRequest) -> Result<Self, String> {
        if let Some(stack) = ImageJ::of(&pages.description) {
            return stack.plan(pages);
        }
        if let Some(stack) = Ome::of(&pages.description) {
            let (slices, spacing, warnings) = stack.plan(pages.count(), path)?;
            return Ok(Self { format: "OME-TIFF", slices, axes: DMat3::from_diagonal(spacing), warnings });
        }
        if let Some((page, reason)) = pages.odd_one() {
            return Err(format!("page {} {reason}, unlike the first; pages of a volume must be alike", page + 1));
        }
        if pages.count() < 2 {
            return Err("it has one page, a volume needs 2 or more; give a stack of slices".into());
        }
        let (axes, said) = unspaced(request);
        let slices = (0..pages.count()).collect();
        Ok(Self { format: "TIFF stack", slices, axes, warnings: said.into_iter().collect() })
    }
}

/// What ImageJ says of a stack.
struct ImageJ<'t> {
    description: &'t str,
}

impl<'t> ImageJ<'t> {
    fn of(description: &'t str) -> Option<Self> {
        description.starts_with("ImageJ=").then_some(Self { description })
    }

    fn get(&self, key: &str) -> Option<&'t str> {
        self.description.lines().find_map(|line| line.trim().strip_prefix(key)?.strip_prefix('='))
    }

    /// A number of images, 1 where it is not stated.
    fn count(&self, key: &str) -> Result<u64, String> {
        let Some(text) = self.get(key) else { return Ok(1) };
        let count = text.trim().parse().ok().filter(|n| (1..=1 << 31).contains(n));
        count.ok_or_else(|| format!("its {key} are {text:.20?}, a whole number above 0 is needed; it is damaged"))
    }

    /// Images of one channel at one time, and whether they are times; `None` if there is one.
    fn slices(&self) -> Option<(u64, bool)> {
        let of = |key| self.count(key).unwrap_or(1);
        let (images, channels, slices, frames) = (of("images"), of("channels"), of("slices"), of("frames"));
        match (slices, frames) {
            (2.., _) => Some((slices, false)),
            (_, 2..) => Some((frames, true)),
            _ if images > 1 && channels == 1 => Some((images, false)),
            _ => None,
        }
    }

    fn plan(&self, pages: &Pages) -> Result<Plan, String> {
        let (channels, frames) = (self.count("channels")?, self.count("frames")?);
        self.count("images")?;
        self.count("slices")?;
        let (slices, are_times) = self.slices().ok_or("it is one image of ImageJ, a volume needs 2 slices or more")?;
        let mut warnings = Vec::new();
        let mut say = |text: String| warnings.push(Warning::new(WarningKind::Ignored, text));
        if channels > 1 {
            say(format!("it has {channels} channels; the first is taken"));
        }
        if frames > 1 && !are_times {
            say(format!("it has {frames} times; the first is taken"));
        }
        if are_times {
            let text = format!("it has {frames} times of one slice; they are taken as slices");
            warnings.push(Warning::new(WarningKind::Assumed, text).with("slices", frames as f64));
        }
        let there = if pages.count() > 1 { pages.count() as u64 } else { pages.in_a_row() };
        // Channels lie next to each other, then slices, then times.
        let last = slices.saturating_sub(1).saturating_mul(channels);
        if last >= there {
            let whole = there.div_ceil(channels);
            return Err(format!("it declares {slices} slices and holds {whole}; it is cut off, get it again"));
        }
        let slices = (0..slices).map(|z| (z * channels) as usize).collect();
        let axes = DMat3::from_diagonal(self.spacing(pages, &mut warnings)?);
        Ok(Plan { format: "ImageJ stack", slices, axes, warnings })
    }

    /// Distances of voxels in the unit of the file; in pixels where it states none.
    fn spacing(&self, pages: &Pages, warnings: &mut Vec<Warning>) -> Result<DVec3, String> {
        let unit = self.get("unit").map(str::trim).filter(|unit| !unit.is_empty() && *unit != "pixel");
        let [x, y] = unit.and(pages.resolution).map_or([1.0; 2], |[x, y]| [1.0 / x, 1.0 / y]);
        let z = match self.get("spacing") {
            Some(text) => {
                text.trim().parse().ok().map(f64::abs).filter(|z| z.is_finite() && *z > 0.0).ok_or_else(|| {
                    format!("its spacing of slices is {text:.20?}, a number above 0 is needed; it is damaged")
                })?
            }
            None => {
                if x != 1.0 {
                    let text = "it states no spacing of slices; 1 of its unit is assumed, as ImageJ does";
                    warnings.push(Warning::new(WarningKind::Assumed, text));
                }
                1.0
            }
        };
        Ok(DVec3::new(x, y, z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn imagej_tells_slices_from_channels_and_times() {
        let of = |text: &str| ImageJ::of(text).expect("ImageJ").slices();
        assert_eq!(of("ImageJ=1.54\nimages=32\nslices=32\n"), Some((32, false)));
        assert_eq!(of("ImageJ=1.54\nimages=24\nchannels=2\nslices=3\nframes=4\n"), Some((3, false)));
        assert_eq!(of("ImageJ=1.54\nimages=9\nframes=9\n"), Some((9, true)));
        assert_eq!(of("ImageJ=1.54\nimages=5\n"), Some((5, false)));
        assert_eq!(of("ImageJ=1.54\nimages=3\nchannels=3\n"), None);
        assert!(ImageJ::of("Image J").is_none());
    }
}
