//! Pictures on the faces of city models: PNG and JPEG beside the model or below its folder.

use crate::mesh::{neighbour, picture};
use crate::{Fault, InputFile, Limits};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{City, CityFace, FacePicture, Texture, Wrap};
use glam::Vec2;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::sync::Arc;

/// Most names of pictures in a warning.
const TOLD: usize = 3;

/// The pictures that a model names.
#[derive(Debug, Default)]
pub(super) struct PictureList {
    named: Vec<(String, [Wrap; 2])>,
    known: HashMap<(String, bool, bool), u32>,
    /// Number of faces whose texture positions do not fit their rings.
    pub(super) odd: usize,
}

/// Continuation of a picture beyond its edge, by the word of CityJSON and CityGML.
pub(super) fn wrap(word: &str) -> Wrap {
    match word.trim().to_ascii_lowercase().as_str() {
        "mirror" => Wrap::Mirror,
        "clamp" | "border" | "none" => Wrap::Clamp,
        _ => Wrap::Repeat,
    }
}

impl PictureList {
    /// Number of a picture, new or known.
    ///
    /// * `name`: path in the model, relative to the model.
    pub(super) fn number(&mut self, name: &str, wrap: Wrap) -> u32 {
        let name = name.trim().replace('\\', "/").replace("%20", " ");
        let key = (name.clone(), wrap == Wrap::Mirror, wrap == Wrap::Clamp);
        *self.known.entry(key).or_insert_with(|| {
            self.named.push((name, [wrap; 2]));
            self.named.len() as u32 - 1
        })
    }

    /// Picture `number` on a face, with texture positions `places`, v up; `None`, and counted, if they do not fit the rings.
    pub(super) fn on(&mut self, number: u32, places: Vec<Vec<Vec2>>, face: &CityFace) -> Option<FacePicture> {
        let fits = places.len() == face.rings.len()
            && places.iter().zip(&face.rings).all(|(p, ring)| p.len() == ring.len())
            && places.iter().flatten().all(|p| p.is_finite());
        self.odd += usize::from(!fits);
        let down = |ring: Vec<Vec2>| ring.into_iter().map(|p| Vec2::new(p.x, 1.0 - p.y)).collect();
        fits.then(|| FacePicture { number, rings: places.into_iter().map(down).collect() })
    }

    /// Reads the pictures that the faces of a city wear; faces whose picture cannot be read get none. Returns the files read
    /// and warnings about missing ones.
    ///
    /// # Errors
    /// If a picture needs more memory than `limits` leave.
    pub(super) fn load(
        self,
        city: &mut City,
        path: &Path,
        limits: &Limits,
    ) -> Result<(Vec<InputFile>, Vec<Warning>), Fault> {
        let (mut files, mut warnings) = (Vec::new(), Vec::new());
        let mut refused: Option<Fault> = None;
        let (mut read, mut missing) = (HashMap::<u32, Option<u32>>::new(), BTreeMap::<String, (String, usize)>::new());
        let mut bare = 0;
        let faces = city.buildings.iter_mut().flat_map(|b| &mut b.faces);
        for face in faces.chain(city.structures.iter_mut().flat_map(|s| &mut s.faces)) {
            let Some(worn) = &mut face.picture else { continue };
            let number = *read.entry(worn.number).or_insert_with(|| {
                let (name, wrap) = self.named.get(worn.number as usize)?;
                match decoded(path, name, *wrap, &picture::beside(limits, &city.pictures)) {
                    Ok((texture, file)) => {
                        files.push(file);
                        city.pictures.push(Arc::new(texture));
                        Some(city.pictures.len() as u32 - 1)
                    }
                    Err(e) => {
                        missing.insert(name.clone(), (e.to_string(), 0));
                        let refusal = Some(e).filter(Fault::is_of_memory);
                        refused = refused.take().or(refusal.map(|e| e.placed(format_args!("picture {name:?}"))));
                        None
                    }
                }
            });
            match number {
                Some(number) => worn.number = number,
                None => {
                    bare += 1;
                    face.picture = None;
                }
            }
        }
        if let Some(reason) = refused {
            return Err(reason);
        }
        if !missing.is_empty() {
            let told: Vec<String> = missing.iter().take(TOLD).map(|(name, (e, _))| format!("{name:?}: {e}")).collect();
            let more =
                if missing.len() > TOLD { format!(", and {} more", missing.len() - TOLD) } else { String::new() };
            let text = format!(
                "{} of {} pictures cannot be read and {bare} faces go without ({}{more})",
                missing.len(),
                read.len(),
                told.join("; ")
            );
            let warning = Warning::new(WarningKind::Ignored, text).with("pictures", missing.len() as f64);
            warnings.push(warning.with("faces", f64::from(bare)));
        }
        let odd = "faces go without their picture: its places do not fit their vertices";
        warnings.extend(Warning::counted(WarningKind::Ignored, self.odd, odd));
        Ok((files, warnings))
    }
}

fn decoded(path: &Path, name: &str, wrap: [Wrap; 2], limits: &Limits) -> Result<(Texture, InputFile), Fault> {
    let (bytes, file) = neighbour(path, name, limits)?;
    Ok((picture::read(&bytes, wrap, limits)?, file))
}
