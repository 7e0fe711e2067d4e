//! Virtual rasters of GDAL: the files that they are put together of. Source: GDAL's description of the format, elements VRTRasterBand,
//! SimpleSource and ComplexSource.

use crate::formats::ends;
use crate::{IoError, fs};
use quick_xml::Reader as XmlReader;
use quick_xml::events::{BytesStart, Event};
use std::path::{Path, PathBuf};

/// Largest file, bytes.
const MAX_BYTES: u64 = 64 << 20;
/// What turns every virtual raster into a file that is read.
const REMEDY: &str = "gdal_translate turns it into GeoTIFF";

/// The files of a virtual raster, in its order; `None` for other files.
///
/// # Errors
/// [`IoError::Os`]; [`IoError::Format`] for one that shows anything else than whole files side by side: parts of them, other values than
/// theirs, or rasters that are computed.
pub(crate) fn sources(path: &Path) -> Result<Option<Vec<PathBuf>>, IoError> {
    if !ends(path, &[".vrt"]) {
        return Ok(None);
    }
    let size = fs::metadata(path).map_err(|e| IoError::os(path, e))?.len();
    if size > MAX_BYTES {
        let reason = format!("is a virtual raster of {} MiB, the limit is {}; {REMEDY}", size >> 20, MAX_BYTES >> 20);
        return Err(IoError::format(path, reason));
    }
    let text = String::from_utf8_lossy(&fs::read(path).map_err(|e| IoError::os(path, e))?).into_owned();
    let mut found = Found::default();
    let mut reader = XmlReader::from_str(&text);
    let refused = loop {
        let event =
            reader.read_event().map_err(|e| IoError::format(path, format!("is broken XML ({e}); get it again")))?;
        let told = match &event {
            Event::Start(e) => found.begin(e),
            Event::Empty(e) => found.begin(e).and_then(|()| found.end(e.local_name().as_ref())),
            Event::Text(text) => {
                found.text += text;
                Ok(())
            }
            Event::GeneralRef(name) => {
                found.text += match name.as_ref() {
                    "amp" => "&",
                    "apos" => "'",
                    "quot" => "\"",
                    _ => "",
                };
                Ok(())
            }
            Event::End(e) => found.end(e.local_name().as_ref()),
            Event::Eof => break None,
            _ => Ok(()),
        };
        if let Err(what) = told {
            break Some(what);
        }
    };
    let refused = refused.or_else(|| found.files.is_empty().then(|| "names no file".to_owned()));
    if let Some(what) = refused {
        return Err(IoError::format(path, format!("is a virtual raster that {what}; {REMEDY}")));
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    Ok(Some(found.files.into_iter().map(|file| folder.join(file)).collect()))
}

/// What was read up to a place.
#[derive(Default)]
struct Found {
    files: Vec<String>,
    bands: usize,
    text: String,
    /// Size of the file of the source that is read.
    size: Option<[f64; 2]>,
}

impl Found {
    fn begin(&mut self, e: &BytesStart<'_>) -> Result<(), String> {
        let value = |key: &str| {
            let found = e.attributes().flatten().find(|a| a.key.local_name().as_ref() == key)?;
            Some(found.value.to_string())
        };
        let numbers = |keys: [&str; 2]| -> Option<[f64; 2]> {
            let [a, b] = keys.map(|key| value(key)?.trim().parse().ok());
            Some([a?, b?])
        };
        self.text.clear();
        match e.local_name().as_ref() {
            "VRTDataset" | "VRTRasterBand" if value("subClass").is_some() => Err("computes its values".into()),
            "VRTRasterBand" => {
                self.bands += 1;
                if self.bands > 1 { Err("has several bands".into()) } else { Ok(()) }
            }
            "KernelFilteredSource"
            | "AveragedSource"
            | "NoDataFromMaskSource"
            | "ArraySource"
            | "LUT"
            | "ScaleRatio"
            | "ScaleOffset"
            | "Exponent"
            | "ColorTableComponent" => Err("shows other values than its files".into()),
            "SourceProperties" => {
                self.size = numbers(["RasterXSize", "RasterYSize"]);
                Ok(())
            }
            "SrcRect" => {
                let whole = numbers(["xOff", "yOff"]) == Some([0.0, 0.0])
                    && self.size.is_none_or(|size| numbers(["xSize", "ySize"]) == Some(size));
                if whole { Ok(()) } else { Err("shows parts of its files".into()) }
            }
            _ => Ok(()),
        }
    }

    fn end(&mut self, element: &str) -> Result<(), String> {
        let text = std::mem::take(&mut self.text);
        match (element, text.trim()) {
            ("SourceFilename", "") => Err("names a file without a name".into()),
            ("SourceFilename", name) if name.starts_with("/vsi") || name.contains("://") => {
                Err(format!("names what is no file ({name})"))
            }
            ("SourceFilename", name) => {
                self.files.push(name.to_owned());
                Ok(())
            }
            ("SourceBand", band) if band != "1" => Err(format!("shows band {band} of a file")),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(sources: &str) -> Result<Option<Vec<PathBuf>>, IoError> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("all.VRT");
        let text = format!(
            "<VRTDataset rasterXSize=\"100\" rasterYSize=\"100\"><VRTRasterBand band=\"1\">{sources}</VRTRasterBand></VRTDataset>"
        );
        std::fs::write(&path, text).expect("written");
        let shorter = |p: PathBuf| p.strip_prefix(folder.path()).map(Path::to_owned).unwrap_or(p);
        Ok(super::sources(&path)?.map(|files| files.into_iter().map(shorter).collect()))
    }

    fn source(name: &str, rect: &str, more: &str) -> String {
        format!(
            "<ComplexSource><SourceFilename relativeToVRT=\"1\">{name}</SourceFilename><SourceBand>1</SourceBand>\
            <SourceProperties RasterXSize=\"50\" RasterYSize=\"100\"/><SrcRect {rect}/><DstRect xOff=\"0\" yOff=\"0\" xSize=\"50\" ySize=\"100\"/>\
            <NODATA>-9999</NODATA>{more}</ComplexSource>"
        )
    }

    const WHOLE: &str = "xOff=\"0\" yOff=\"0\" xSize=\"50\" ySize=\"100\"";

    #[test]
    fn whole_files_side_by_side_are_the_files_and_all_else_is_refused_with_a_remedy() {
        let two = [source("west.tif", WHOLE, ""), source("a &amp; b/east.tif", WHOLE, "")].concat();
        let files = ["west.tif", "a & b/east.tif"].map(PathBuf::from).to_vec();
        assert_eq!(of(&two).expect("two files"), Some(files));
        let part = "xOff=\"3\" yOff=\"0\" xSize=\"47\" ySize=\"100\"";
        for (sources, reason) in [
            (source("a.tif", part, ""), "shows parts"),
            (source("a.tif", WHOLE, "<ScaleRatio>2</ScaleRatio>"), "other values"),
            (source("/vsicurl/a.tif", WHOLE, ""), "no file"),
            (String::new(), "names no file"),
        ] {
            let error = of(&sources).expect_err("refused").to_string();
            assert!(error.contains(reason) && error.contains("gdal_translate"), "{error}");
        }
        assert!(sources(Path::new("a.tif")).expect("another file").is_none());
    }
}
