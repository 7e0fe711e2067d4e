//! What the OME-XML of an OME-TIFF says of its planes. Source: OME-XML schema 2016-06, elements Pixels and TiffData.

use belvedere_core::{Warning, WarningKind};
use glam::DVec3;
use quick_xml::events::BytesStart;
use quick_xml::{Reader as XmlReader, events::Event};
use std::collections::BTreeSet;
use std::path::Path;

/// Most planes of a file.
const MAX_PLANES: u64 = 1 << 24;

/// Metres of a unit of length, by its sign; OME writes micrometres where it states none.
const UNITS: [(&str, f64); 9] = [
    ("µm", 1e-6),
    ("\u{3bc}m", 1e-6),
    ("um", 1e-6),
    ("nm", 1e-9),
    ("mm", 1e-3),
    ("cm", 1e-2),
    ("m", 1.0),
    ("pm", 1e-12),
    ("Å", 1e-10),
];

/// Planes of the first image.
#[derive(Debug, Default)]
pub(super) struct Ome {
    attributes: Vec<(String, String)>,
    runs: Vec<Run>,
    /// Names of files that planes are in.
    files: BTreeSet<String>,
    images: usize,
}

/// A stretch of pages that are planes one after the other.
#[derive(Debug, Default)]
struct Run {
    first: Option<u64>,
    /// Index along z, channels, times.
    at: [u64; 3],
    planes: Option<u64>,
}

impl Ome {
    /// Of the description of a TIFF; `None` if it is no OME-XML with an image.
    pub(super) fn of(description: &str) -> Option<Self> {
        if !description.contains("<OME") && !description.contains(":OME") {
            return None;
        }
        let mut out = Self::default();
        let mut reader = XmlReader::from_str(description);
        let mut in_uuid = false;
        loop {
            match reader.read_event() {
                Ok(Event::Start(e)) => {
                    in_uuid = e.local_name().as_ref() == "UUID";
                    out.element(&e);
                }
                Ok(Event::Empty(e)) => out.element(&e),
                Ok(Event::Eof) | Err(_) => break,
                _ => {}
            }
            if in_uuid && out.files.len() > 64 {
                break;
            }
        }
        (!out.attributes.is_empty()).then_some(out)
    }

    fn element(&mut self, e: &BytesStart<'_>) {
        let value = |key: &str| {
            let found = e.attributes().flatten().find(|a| a.key.local_name().as_ref() == key)?;
            Some(found.value.to_string())
        };
        let number = |key: &str| value(key)?.trim().parse::<u64>().ok();
        match e.local_name().as_ref() {
            "Pixels" => {
                self.images += 1;
                if self.images == 1 {
                    let all = e.attributes().flatten();
                    self.attributes =
                        all.map(|a| (a.key.local_name().as_ref().to_owned(), a.value.to_string())).collect();
                }
            }
            "TiffData" if self.images == 1 => {
                let at = ["FirstZ", "FirstC", "FirstT"].map(|key| number(key).unwrap_or(0));
                let first = number("IFD");
                self.runs.push(Run { first, at, planes: number("PlaneCount") });
            }
            "UUID" if self.images == 1 => self.files.extend(value("FileName")),
            _ => {}
        }
    }

    fn get(&self, key: &str) -> Option<&str> {
        self.attributes.iter().find(|(name, _)| name == key).map(|(_, value)| value.as_str())
    }

    /// Planes along z, channels, times.
    fn sizes(&self) -> Result<[u64; 3], String> {
        let of = |key: &str| {
            let text = self.get(key).unwrap_or("1");
            let count = text.trim().parse().ok().filter(|n| (1..=MAX_PLANES).contains(n));
            count.ok_or_else(|| format!("its {key} is {text:.20?}, a whole number above 0 is needed; it is damaged"))
        };
        Ok([of("SizeZ")?, of("SizeC")?, of("SizeT")?])
    }

    /// Whether it has several planes along z, or times of one plane.
    pub(super) fn is_stack(&self) -> bool {
        self.sizes().is_ok_and(|[z, _, times]| z > 1 || times > 1)
    }

    /// Pages of the slices, distances of voxels in the unit of x, and warnings.
    ///
    /// * `pages`: pages of the file.
    pub(super) fn plan(&self, pages: usize, path: &Path) -> Result<(Vec<usize>, DVec3, Vec<Warning>), String> {
        let [z, channels, times] = self.sizes()?;
        if z == 1 && times == 1 {
            return Err("it is one plane (SizeZ 1), a volume needs 2 or more".into());
        }
        if self.files.len() > 1 {
            let (files, own) = (self.files.len(), path.file_name().unwrap_or_default().to_string_lossy());
            return Err(format!(
                "its planes are in {files} files, of which {own:.60} is one; write them as one, as with bfconvert"
            ));
        }
        let mut warnings = Vec::new();
        let mut say = |count: u64, what: &str| {
            if count > 1 {
                let text = format!("it has {count} {what}; the first is taken");
                warnings.push(Warning::new(WarningKind::Ignored, text));
            }
        };
        say(self.images as u64, "images");
        say(channels, "channels");
        let are_times = z == 1;
        if are_times {
            let text = format!("it has {times} times of one plane; they are taken as slices");
            warnings.push(Warning::new(WarningKind::Assumed, text));
        } else {
            say(times, "times");
        }
        let count = if are_times { times } else { z };
        let mut slices = Vec::new();
        for i in 0..count {
            let plane = if are_times { [0, 0, i] } else { [i, 0, 0] };
            let page = self.page(plane, [z, channels, times]).and_then(|page| usize::try_from(page).ok());
            let page = page.filter(|page| *page < pages && slices.len() < pages).ok_or_else(|| {
                format!("slice {} of its {count} is not among its {pages} pages; it is cut off, or damaged", i + 1)
            })?;
            slices.push(page);
        }
        let spacing = self.spacing(are_times, &mut warnings)?;
        Ok((slices, spacing, warnings))
    }

    /// Place of a plane among those of the image, in the order that it states.
    fn rank(&self, [z, c, t]: [u64; 3], [nz, nc, nt]: [u64; 3]) -> u64 {
        let order = self.get("DimensionOrder").unwrap_or("XYZCT");
        let (mut rank, mut step) = (0u64, 1u64);
        for letter in order.chars().skip(2) {
            let (index, count) = match letter {
                'Z' => (z, nz),
                'C' => (c, nc),
                _ => (t, nt),
            };
            rank = rank.saturating_add(index.saturating_mul(step));
            step = step.saturating_mul(count);
        }
        rank
    }

    /// Page of a plane.
    fn page(&self, plane: [u64; 3], sizes: [u64; 3]) -> Option<u64> {
        let rank = self.rank(plane, sizes);
        if self.runs.is_empty() {
            return Some(rank);
        }
        self.runs.iter().find_map(|run| {
            let behind = rank.checked_sub(self.rank(run.at, sizes))?;
            let planes = run.planes.unwrap_or(if run.first.is_some() { 1 } else { u64::MAX });
            (behind < planes).then(|| run.first.unwrap_or(0).saturating_add(behind))
        })
    }

    fn spacing(&self, are_times: bool, warnings: &mut Vec<Warning>) -> Result<DVec3, String> {
        let metres = |axis: &str| -> Result<Option<f64>, String> {
            let key = format!("PhysicalSize{axis}");
            let Some(text) = self.get(&key) else { return Ok(None) };
            let size = text.trim().parse().ok().filter(|v: &f64| v.is_finite() && *v > 0.0);
            let size =
                size.ok_or_else(|| format!("its {key} is {text:.20?}, a number above 0 is needed; it is damaged"))?;
            let unit = self.get(&format!("{key}Unit")).unwrap_or("µm");
            // Of units that are not known here it counts that they are the same.
            Ok(Some(size * UNITS.iter().find(|(sign, _)| *sign == unit).map_or(1e-6, |(_, metres)| *metres)))
        };
        let unit = self.get("PhysicalSizeXUnit").unwrap_or("µm");
        let unit = UNITS.iter().find(|(sign, _)| *sign == unit).map_or(1e-6, |(_, metres)| *metres);
        let (x, y, z) = (metres("X")?, metres("Y")?, metres("Z")?.filter(|_| !are_times));
        let [x, y, z] = match (x.or(y), z) {
            (None, None) => {
                warnings.push(Warning::new(WarningKind::Assumed, "it states no spacing; 1 along each axis is assumed"));
                return Ok(DVec3::ONE);
            }
            (Some(side), None) => {
                let text = "it states no spacing of slices; that of its columns is assumed";
                warnings.push(Warning::new(WarningKind::Assumed, text));
                [x.unwrap_or(side), y.unwrap_or(side), side]
            }
            (None, Some(z)) => {
                let text = "it states no spacing of pixels; that of its slices is assumed";
                warnings.push(Warning::new(WarningKind::Assumed, text));
                [z; 3]
            }
            (Some(side), Some(z)) => [x.unwrap_or(side), y.unwrap_or(side), z],
        };
        // To the unit that the file has for x: rounding keeps whole figures whole.
        Ok(DVec3::new(x, y, z).to_array().map(|v| (v / unit * 1e12).round() / 1e12).into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(pixels: &str, inside: &str) -> Ome {
        let text =
            format!("<?xml version=\"1.0\"?><OME><Image ID=\"I:0\"><Pixels {pixels}>{inside}</Pixels></Image></OME>");
        Ome::of(&text).expect("OME")
    }

    #[test]
    fn planes_lie_in_the_order_that_is_stated() {
        let plan = |order: &str| {
            let text = format!(
                "DimensionOrder=\"{order}\" SizeZ=\"3\" SizeC=\"2\" SizeT=\"2\" PhysicalSizeX=\"0.5\" PhysicalSizeY=\"0.5\" PhysicalSizeZ=\"2\""
            );
            of(&text, "<TiffData/>").plan(12, Path::new("a.tif")).expect("planes")
        };
        assert_eq!(plan("XYZCT").0, [0, 1, 2]);
        assert_eq!(plan("XYCZT").0, [0, 2, 4]);
        let (slices, spacing, warnings) = plan("XYTCZ");
        assert_eq!((slices, spacing), (vec![0, 4, 8], DVec3::new(0.5, 0.5, 2.0)));
        assert_eq!(warnings.len(), 2, "{warnings:?}");
    }

    #[test]
    fn pages_that_are_named_count_and_units_are_one() {
        let ome = of(
            "DimensionOrder=\"XYZCT\" SizeZ=\"2\" SizeC=\"1\" SizeT=\"1\" PhysicalSizeX=\"500\" PhysicalSizeXUnit=\"nm\" PhysicalSizeZ=\"2\" PhysicalSizeZUnit=\"\u{b5}m\"",
            "<TiffData IFD=\"7\" FirstZ=\"1\"/><TiffData IFD=\"3\" FirstZ=\"0\"/>",
        );
        let (slices, spacing, _) = ome.plan(8, Path::new("a.tif")).expect("planes");
        assert_eq!((slices, spacing), (vec![3, 7], DVec3::new(500.0, 500.0, 2000.0)));
        let cut = ome.plan(7, Path::new("a.tif")).expect_err("cut");
        assert!(cut.contains("slice 2 of its 2 is not among its 7 pages"), "{cut}");
    }
}
