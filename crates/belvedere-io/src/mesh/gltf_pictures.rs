//! Pictures of glTF files: within the file, in a data address, or below its folder.

use super::{neighbour, picture};
use crate::base64;
use crate::fs::percent_decoded;
use crate::{Fault, InputFile, Limits};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{Texture, Wrap};
use gltf::image::Source;
use gltf::texture::WrappingMode;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Where a picture lies: many pictures of a file may name one file beside it, which is decoded once.
#[derive(PartialEq, Eq, Hash)]
enum Place {
    Beside(String),
    Within(usize),
}

impl Place {
    fn of(image: &gltf::Image<'_>) -> Self {
        match image.source() {
            Source::Uri { uri, .. } if !uri.starts_with("data:") => Self::Beside(uri.to_owned()),
            _ => Self::Within(image.index()),
        }
    }
}

/// The pictures read so far.
#[derive(Default)]
pub(super) struct Pictures<'p> {
    path: Option<&'p Path>,
    limits: Limits,
    /// Number by the picture and how it goes on beyond its edge; `None` = it cannot be read.
    known: HashMap<(Place, [u32; 2]), Option<u32>>,
    pub(super) textures: Vec<Arc<Texture>>,
    pub(super) files: Vec<InputFile>,
    /// Why a picture was refused for want of memory.
    pub(super) refused: Option<Fault>,
    /// One sentence each.
    pub(super) warnings: Vec<Warning>,
}

impl<'p> Pictures<'p> {
    pub(super) fn new(path: &'p Path, limits: &Limits) -> Self {
        Self { path: Some(path), limits: *limits, ..Self::default() }
    }

    /// Number of the picture of a texture; `None` if it cannot be read, which is warned of once.
    pub(super) fn number(&mut self, texture: &gltf::Texture<'_>, buffers: &[Vec<u8>]) -> Option<u32> {
        let sampler = texture.sampler();
        let key = (Place::of(&texture.source()), [sampler.wrap_s(), sampler.wrap_t()].map(|mode| mode.as_gl_enum()));
        if let Some(known) = self.known.get(&key) {
            return *known;
        }
        let number = match self.read(texture, buffers) {
            Ok((texture, file)) => {
                self.textures.push(Arc::new(texture));
                self.files.extend(file);
                Some(self.textures.len() as u32 - 1)
            }
            Err(e) => {
                let path = self.path.unwrap_or(Path::new(""));
                let e = e.placed(format_args!("picture {}", texture.index()));
                self.warnings.push(Warning::new(WarningKind::Ignored, format!("{e}; it is left out")).in_file(path));
                self.refused = self.refused.take().or(Some(e).filter(Fault::is_of_memory));
                None
            }
        };
        self.known.insert(key, number);
        number
    }

    fn read(&self, texture: &gltf::Texture<'_>, buffers: &[Vec<u8>]) -> Result<(Texture, Option<InputFile>), Fault> {
        let sampler = texture.sampler();
        let wrap = [sampler.wrap_s(), sampler.wrap_t()].map(|mode| match mode {
            WrappingMode::Repeat => Wrap::Repeat,
            WrappingMode::ClampToEdge => Wrap::Clamp,
            WrappingMode::MirroredRepeat => Wrap::Mirror,
        });
        let limits = picture::beside(&self.limits, &self.textures);
        let decode = |bytes: &[u8]| picture::read(bytes, wrap, &limits);
        match texture.source().source() {
            Source::View { view, .. } => {
                let end = view.offset().checked_add(view.length());
                let bytes = buffers.get(view.buffer().index()).zip(end).and_then(|(b, end)| b.get(view.offset()..end));
                Ok((decode(bytes.ok_or("it lies outside its buffer; the file is damaged")?)?, None))
            }
            Source::Uri { uri, .. } => {
                if let Some(data) = uri.strip_prefix("data:") {
                    let bytes = data.split_once(";base64,").and_then(|(_, text)| base64::decode(text));
                    return Ok((decode(&bytes.ok_or("it is no base64; the file is damaged")?)?, None));
                }
                let path = self.path.unwrap_or(Path::new(""));
                let (bytes, file) = neighbour(path, &percent_decoded(uri), &limits)?;
                Ok((decode(&bytes)?, Some(file)))
            }
        }
    }
}
