//! Pictures, records and buffers as files.

use super::buffers;
use super::sidecar::Picture;
use super::{AuxBuffer, AuxFormat, PictureOptions};
use crate::BelvedereError;
use crate::output;
use crate::scene_file::StageDoc;
use crate::vectors::{Page, VectorPicture, pdf, svg};
use belvedere_io::atomic;
use belvedere_io::picture_file::{PictureFile, PictureFormat};
use belvedere_io::png::{self, Channels};
use belvedere_overlay::badge;
use belvedere_scene::Frame;
use std::borrow::Cow;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Width of the white gap between two pictures side by side, pixels.
const GAP: usize = 8;

/// File of the solved displacement of the ground, written beside a picture whose scene asks for terrain disocclusion by an intent.
pub fn delta_path(out: &Path) -> PathBuf {
    out.with_extension("delta.tif")
}

/// Refuses a picture that its format cannot hold, before it is drawn.
///
/// * `size`: width and height, pixels; `transparent`: whether its sky is.
///
/// # Errors
/// [`BelvedereError::Output`].
pub fn check_format(out: &Path, size: [usize; 2], transparent: bool) -> Result<(), BelvedereError> {
    let wrong = |reason: String| BelvedereError::Output { path: out.to_owned(), reason };
    let ending = out.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    let is = |name: &str| ending.as_deref() == Some(name);
    let format = PictureFormat::of(out).unwrap_or(PictureFormat::Png);
    if transparent && (is("pdf") || format != PictureFormat::Png) {
        let name = if is("pdf") { "PDF" } else { format.name() };
        return Err(wrong(format!("a {name} of this program holds no transparent sky; write a PNG or an SVG")));
    }
    let ([width, height], most) = (size, format.most_side());
    if width.max(height) > most && !is("svg") && !is("pdf") {
        let name = format.name();
        return Err(wrong(format!(
            "a {name} has at most {most} pixels along a side, the picture has {width} x {height}; write a PNG or a TIFF"
        )));
    }
    Ok(())
}

/// Files that [`Picture::write`] makes for `out`.
///
/// * `solves`: whether the scene asks for terrain disocclusion by an intent, see [`Document::solves_terrain`](crate::scene_file::Document::solves_terrain).
pub fn outputs(out: &Path, request: &PictureOptions, solves: bool) -> Vec<PathBuf> {
    let sidecar = sibling(out, ".json");
    let aux: Vec<PathBuf> = match request.aux_format {
        AuxFormat::Npy => request.aux.iter().map(|a| aux_path(out, *a)).collect(),
        AuxFormat::Exr => request.aux.first().map(|_| out.with_extension("exr")).into_iter().collect(),
    };
    let delta = (solves && !request.straight && request.camera.is_none()).then(|| delta_path(out));
    [out.to_owned(), sidecar].into_iter().chain(delta).chain(aux).collect()
}

impl Picture {
    /// Writes the picture, its record and its buffers, each in one piece; they get their names together. The record holds the hash of the
    /// picture, which tells whether they belong together.
    ///
    /// # Errors
    /// [`BelvedereError::Io`].
    pub fn write(&self, out: &Path, overwrite: bool) -> Result<Vec<PathBuf>, BelvedereError> {
        atomic::together(|| self.write_each((out, overwrite), &|this| this.write_picture(out, overwrite)))
    }

    /// [`Picture::write`], the pixels coming from `rows`, which writes them row by row.
    pub(super) fn write_rows(
        &self,
        out: &Path,
        overwrite: bool,
        rows: &dyn Fn(&mut dyn Write) -> io::Result<()>,
    ) -> Result<Vec<PathBuf>, BelvedereError> {
        let pixels = |this: &Self| {
            let format = PictureFormat::of(out).unwrap_or(PictureFormat::Png);
            let (width, height) = (this.frame.width, this.frame.height);
            let text = this.text()?;
            let text: Vec<(&str, &str)> = text.iter().map(|(k, v)| (*k, v.as_str())).collect();
            let file = PictureFile { width, height, pixels: &[], dpi: this.dpi(), text: &text };
            Ok(atomic::write_atomic(out, overwrite, |out| file.encode_rows(format, out, rows))?)
        };
        atomic::together(|| self.write_each((out, overwrite), &pixels))
    }

    /// * `pixels`: writes the picture alone.
    fn write_each(
        &self,
        (out, overwrite): (&Path, bool),
        pixels: &dyn Fn(&Self) -> Result<(), BelvedereError>,
    ) -> Result<Vec<PathBuf>, BelvedereError> {
        let mut written = vec![out.to_owned(), sibling(out, ".json")];
        let solved = self.with_delta(out, overwrite, &mut written)?;
        let this = solved.as_ref().unwrap_or(self);
        pixels(this)?;
        let mut sidecar = this.sidecar.clone();
        sidecar.look = this.look();
        // A device keeps nothing that could be read again.
        let place = atomic::contents_of(out);
        sidecar.picture_sha256 = belvedere_io::fs::metadata(&place)
            .is_ok_and(|m| m.is_file())
            .then(|| belvedere_io::sha256_of_file(&place))
            .transpose()?;
        output::write_text(&written[1], &output::pretty(&sidecar)?, overwrite)?;
        if self.aux_format == AuxFormat::Exr && !self.aux.is_empty() {
            let path = out.with_extension("exr");
            buffers::write(&self.frame, (&self.view, &self.rigid), &self.aux, &path, overwrite)?;
            written.push(path);
            return Ok(written);
        }
        for aux in &self.aux {
            let path = aux_path(out, *aux);
            self.write_aux(*aux, &path, overwrite)?;
            written.push(path);
        }
        Ok(written)
    }

    /// Writes the solved displacement of the ground beside the picture, and names it in the record in place of the intent.
    fn with_delta(
        &self,
        out: &Path,
        overwrite: bool,
        written: &mut Vec<PathBuf>,
    ) -> Result<Option<Self>, BelvedereError> {
        let solved = self.view.ground();
        let (Some(solved), Some(_)) = (solved, &self.sidecar.disocclusion) else { return Ok(None) };
        let path = delta_path(out);
        belvedere_resolve::delta::write(&path, solved.grid(), self.crs, overwrite)?;
        let mut this = self.clone();
        for stage in this.sidecar.scene.iter_mut().flat_map(|scene| &mut scene.stage) {
            if let StageDoc::TerrainDisocclusion(doc) = stage {
                doc.delta = path.file_name().and_then(|n| n.to_str()).map(str::to_owned);
                doc.delta_sha256 = Some(belvedere_io::sha256_of_file(&atomic::contents_of(&path))?);
            }
        }
        written.push(path);
        Ok(Some(this))
    }

    /// Writes the picture alone in the format that the ending of its name says: PNG, TIFF, JPEG or WebP, PNG for any other name; PDF or SVG
    /// for one with vectors.
    ///
    /// # Errors
    /// [`BelvedereError::Io`]; [`BelvedereError::Output`] for more pixels than the format holds, and for SVG and PDF of a picture without vectors.
    pub fn write_picture(&self, out: &Path, overwrite: bool) -> Result<(), BelvedereError> {
        check_format(out, [self.frame.width, self.frame.height], self.alpha.is_some())?;
        let ending = out.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        if self.vectors.is_none() && ["svg", "svgz", "pdf"].contains(&ending.as_str()) {
            let reason = "this picture was drawn without vectors; name it .png, or draw it with vectors".to_owned();
            return Err(BelvedereError::Output { path: out.to_owned(), reason });
        }
        let is_pdf = out.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("pdf"));
        if let Some(bytes) = if is_pdf { self.to_pdf()? } else { self.to_svg()?.map(String::into_bytes) } {
            return Ok(atomic::write_atomic(out, overwrite, |out| out.write_all(&bytes))?);
        }
        let format = PictureFormat::of(out).unwrap_or(PictureFormat::Png);
        if self.alpha.is_some() {
            return self.write_png(out, overwrite);
        }
        let (width, height, pixels) = self.pixels();
        check_format(out, [width, height], false)?;
        let text = self.text()?;
        let text: Vec<(&str, &str)> = text.iter().map(|(k, v)| (*k, v.as_str())).collect();
        let file = PictureFile { width, height, pixels: pixels.as_flattened(), dpi: self.dpi(), text: &text };
        Ok(atomic::write_atomic(out, overwrite, |out| file.encode(format, out))?)
    }

    /// The picture as SVG; `None` for one without vectors.
    ///
    /// # Errors
    /// [`BelvedereError::Io`] for a picture without pixels.
    pub fn to_svg(&self) -> Result<Option<String>, BelvedereError> {
        self.as_vectors(svg)
    }

    /// The picture as PDF of one page; `None` for one without vectors.
    ///
    /// # Errors
    /// As [`Picture::to_svg`].
    pub fn to_pdf(&self) -> Result<Option<Vec<u8>>, BelvedereError> {
        check_format(Path::new("picture.pdf"), [1, 1], self.alpha.is_some())?;
        self.as_vectors(pdf)
    }

    fn as_vectors<T>(&self, write: impl Fn(&VectorPicture, &Page<'_>) -> T) -> Result<Option<T>, BelvedereError> {
        let Some(vectors) = &self.vectors else { return Ok(None) };
        let (width, height) = (self.frame.width, self.frame.height);
        let mut raster = Vec::new();
        if vectors.over_raster {
            let (channels, bytes) = self.channels(&self.frame.color);
            png::encode(&mut raster, width, height, channels, &bytes, &[])
                .map_err(|e| belvedere_io::IoError::os(Path::new("the picture"), e))?;
        }
        let note = self.sidecar.note.as_deref();
        let description =
            [Some(self.sidecar.program.as_str()), note].into_iter().flatten().collect::<Vec<_>>().join("; ");
        let page = Page {
            size: [width, height],
            sheet: self.sidecar.print,
            title: &self.sidecar.title,
            description: &description,
            raster: vectors.over_raster.then_some(&raster[..]),
        };
        Ok(Some(write(vectors, &page)))
    }

    /// Channels and bytes of pixels of the picture.
    fn channels<'p>(&self, pixels: &'p [[u8; 3]]) -> (Channels, Cow<'p, [u8]>) {
        match &self.alpha {
            Some(alpha) if alpha.len() == pixels.len() => {
                (Channels::Rgba, pixels.iter().zip(alpha).flat_map(|([r, g, b], a)| [*r, *g, *b, *a]).collect())
            }
            _ => (Channels::Rgb, Cow::Borrowed(pixels.as_flattened())),
        }
    }

    fn dpi(&self) -> Option<f64> {
        // A pair is wider than its paper.
        self.sidecar.print.filter(|_| self.straight.is_none()).map(|sheet| sheet.dpi)
    }

    /// Writes the picture alone. Its bytes depend on scene, options and inputs only, not on threads or time.
    ///
    /// # Errors
    /// [`BelvedereError::Io`].
    pub fn write_png(&self, out: &Path, overwrite: bool) -> Result<(), BelvedereError> {
        let (width, height, pixels) = self.pixels();
        let text = self.text()?;
        let text: Vec<(&str, &str)> = text.iter().map(|(k, v)| (*k, v.as_str())).collect();
        Ok(atomic::write_atomic(out, overwrite, |out| {
            let (channels, bytes) = self.channels(&pixels);
            png::encode_at(out, (width, height), channels, &bytes, &text, self.dpi())
        })?)
    }

    /// The bytes of the picture, as [`Picture::write_png`] writes them.
    ///
    /// # Errors
    /// [`BelvedereError::Io`] for a picture without pixels.
    pub fn to_png(&self) -> Result<Vec<u8>, BelvedereError> {
        let (width, height, pixels) = self.pixels();
        let text = self.text()?;
        let text: Vec<(&str, &str)> = text.iter().map(|(k, v)| (*k, v.as_str())).collect();
        let (mut bytes, (channels, samples)) = (Vec::new(), self.channels(&pixels));
        png::encode_at(&mut bytes, (width, height), channels, &samples, &text, self.dpi())
            .map_err(|e| belvedere_io::IoError::os(Path::new("the picture"), e))?;
        Ok(bytes)
    }

    /// Width, height and colours; the two pictures of a pair side by side.
    pub fn pixels(&self) -> (usize, usize, Vec<[u8; 3]>) {
        let Some(straight) = &self.straight else {
            return (self.frame.width, self.frame.height, self.frame.color.clone());
        };
        let titles = ["straight".to_owned(), self.bent_title()];
        let right = straight.width + GAP;
        badge::titled(side_by_side(straight, &self.frame), &[(&titles[0], 0), (&titles[1], right)])
    }

    fn bent_title(&self) -> String {
        match self.sidecar.displacement {
            Some(d) => {
                format!("bent: what is seen moved by up to {}, {:.0} px", d.most(self.unit), d.max_px)
            }
            None => "the same camera".into(),
        }
    }

    /// Keywords and texts of the picture's metadata: the record without entries that differ from run to run.
    fn text(&self) -> Result<Vec<(&'static str, String)>, BelvedereError> {
        let mut text = vec![("Software", self.sidecar.program.clone())];
        if !self.sidecar.title.is_empty() {
            // Other programs print it.
            text.push(("Title", belvedere_core::plain::escaped(&self.sidecar.title).into_owned()));
        }
        if let Some(note) = &self.sidecar.note {
            text.push(("Comment", note.clone()));
        }
        if let Some(scene) = &self.sidecar.scene {
            text.push(("belvedere:scene", output::json(scene)?));
        }
        text.push(("belvedere:inputs", output::json(&self.sidecar.inputs)?));
        text.push(("belvedere:displacement", output::json(&self.sidecar.displacement)?));
        Ok(text)
    }

    fn write_aux(&self, aux: AuxBuffer, path: &Path, overwrite: bool) -> Result<(), BelvedereError> {
        let (w, h) = (self.frame.width, self.frame.height);
        let world = self.frame.world.as_deref().unwrap_or_default();
        match aux {
            AuxBuffer::Depth => npy(path, overwrite, "<f4", &[h, w], self.frame.depth.iter().map(|v| v.to_le_bytes())),
            AuxBuffer::Id => npy(path, overwrite, "<u4", &[h, w], self.frame.id.iter().map(|v| v.to_le_bytes())),
            AuxBuffer::World => {
                npy(path, overwrite, "<f8", &[h, w, 3], world.iter().flatten().map(|v| v.to_le_bytes()))
            }
            AuxBuffer::Displacement => {
                let moved = buffers::displacement((&self.view, &self.rigid), &self.frame).flatten();
                npy(path, overwrite, "<f8", &[h, w, 3], moved.map(|v| v.to_le_bytes()))
            }
        }
    }
}

/// `left` beside `right`, of the same height.
pub fn side_by_side(left: &Frame, right: &Frame) -> (usize, usize, Vec<[u8; 3]>) {
    let width = left.width + GAP + right.width;
    let height = left.height.min(right.height);
    let mut pixels = Vec::with_capacity(width * height);
    for row in 0..height {
        pixels.extend_from_slice(&left.color[row * left.width..(row + 1) * left.width]);
        pixels.extend(std::iter::repeat_n([255; 3], GAP));
        pixels.extend_from_slice(&right.color[row * right.width..(row + 1) * right.width]);
    }
    (width, height, pixels)
}

fn sibling(out: &Path, ending: &str) -> PathBuf {
    let mut name = out.as_os_str().to_owned();
    name.push(ending);
    PathBuf::from(name)
}

fn aux_path(out: &Path, aux: AuxBuffer) -> PathBuf {
    out.with_extension(format!("{}.npy", aux.name()))
}

/// Writes an array in NPY format 1.0, little endian, row-major.
fn npy<const B: usize>(
    path: &Path,
    overwrite: bool,
    kind: &str,
    shape: &[usize],
    values: impl Iterator<Item = [u8; B]>,
) -> Result<(), BelvedereError> {
    let shape: Vec<String> = shape.iter().map(usize::to_string).collect();
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({}), }}", shape.join(", "));
    // Data starts at a multiple of 64 bytes: 10 bytes before the header, its newline at the end.
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    Ok(atomic::write_atomic(path, overwrite, |out| {
        out.write_all(b"\x93NUMPY\x01\x00")?;
        out.write_all(&(header.len() as u16).to_le_bytes())?;
        out.write_all(header.as_bytes())?;
        for value in values {
            out.write_all(&value)?;
        }
        Ok(())
    })?)
}
