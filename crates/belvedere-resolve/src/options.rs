//! Options for opening a scene.

use crate::trust::Trust;
use crate::{Advice, BelvedereError};
use belvedere_document::request::{Air, Molecules, Panorama, Render, Straighten, given_of};
use belvedere_document::{FurnitureWish, LayerDoc, PaletteDoc, SurfaceDoc, SwitchOrLength, SwitchOrVisibility};
use belvedere_io::{Arrays, Limits};
use belvedere_scene::{Edge, Progress};
use std::path::PathBuf;

/// Parts of a scene to load.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Needs {
    /// The view alone: of the layers only the terrain is read, and only if the camera or a stage depends on it.
    View,
    /// The view and the terrain.
    Ground,
    /// Every layer.
    #[default]
    Everything,
}

/// Options for opening a scene.
#[derive(Debug, Clone, Default)]
pub struct OpenOptions {
    /// Folders beside that of the scene from which files may come.
    pub allow_roots: Vec<PathBuf>,
    /// Files outside its folder that a scene file may read because the user agreed; by default none.
    pub trust: Trust,
    /// Single files that may be read, canonical paths.
    pub allow_files: Vec<PathBuf>,
    /// Arrays in memory, which sources `array:NAME` of layers and of data files mean.
    pub arrays: Arrays,
    /// Parts of the scene to load.
    pub needs: Needs,
    /// Size of the picture instead of the scene's, pixels.
    pub image: Option<[u32; 2]>,
    /// Seed of generated data instead of the scene's.
    pub seed: Option<u64>,
    /// Tint of terrain instead of the scene's.
    pub palette: Option<PaletteDoc>,
    /// Sky instead of the scene's, see [`belvedere_document::LightDoc::sky`].
    pub sky: Option<String>,
    /// Haze instead of the scene's.
    pub haze: Option<SwitchOrVisibility>,
    /// Clouds instead of the scene's, see [`belvedere_document::LightDoc::clouds`].
    pub clouds: Option<f64>,
    /// Furniture and title instead of the scene's.
    pub furniture: Option<FurnitureWish>,
    /// Lines of equal height instead of the scene's.
    pub contours: Option<SwitchOrLength>,
    /// Whether materials are drawn by rule, instead of the scene's setting.
    pub materials: Option<bool>,
    /// A file of land cover for all terrain, instead of the scene's.
    pub land_cover: Option<String>,
    /// How the ground ends where its data end, instead of the scene's setting.
    pub edge: Option<Edge>,
    /// Whether the sea is drawn as such, instead of the scene's setting.
    pub sea: Option<bool>,
    /// Surface of the areas of all layers, instead of the scene's settings; `Some(Auto)`: as the files say.
    pub area_style: Option<SurfaceDoc>,
    /// What molecules are shown as, instead of the scene's settings.
    pub molecule: Molecules,
    /// A trajectory of the one molecule of the scene, see [`belvedere_document::MoleculeDoc::trajectory`].
    pub trajectory: Option<String>,
    /// A place around which the whole circle is seen.
    pub panorama: Panorama,
    /// A line along which what lies around it is straightened, by a camera of its own.
    pub straighten: Straighten,
    /// Leaves stages that need a solver out of the view, for callers that need the document alone.
    pub unsolved: bool,
    /// Leaves out what only pictures need, such as ambient occlusion, for callers that draw none.
    pub undrawn: bool,
    /// Leaves out the check of presets at viewing angles that the picture does not show, for pictures that are drawn while something moves.
    pub unchecked: bool,
    /// Memory limit for the samples of one file, bytes; `None`: that of [`Limits::default`].
    pub max_bytes: Option<u64>,
    /// Font files for letters that the embedded font lacks, before those of the scene.
    pub fonts: Vec<PathBuf>,
    /// Progress and cancellation.
    pub progress: Progress,
}

/// Puts what is asked of molecules into the layers that are some.
///
/// # Errors
/// [`BelvedereError::Argument`] if something is asked for and no layer is a molecule.
pub fn show_molecules(asked: &Molecules, layers: &mut [LayerDoc]) -> Result<(), BelvedereError> {
    let mut any = false;
    for layer in layers {
        let LayerDoc::Molecule(molecule) = layer else { continue };
        any = true;
        molecule.style.representation = asked.representation.unwrap_or(molecule.style.representation);
        molecule.style.color = asked.color_by.clone().unwrap_or_else(|| std::mem::take(&mut molecule.style.color));
        molecule.assembly = asked.assembly.clone().or(molecule.assembly.take());
        molecule.model = asked.model.or(molecule.model);
    }
    let options = given_of(asked, &Molecules::OPTIONS);
    if any || options.is_empty() {
        return Ok(());
    }
    Err(BelvedereError::Argument(Advice::of_options(&options, "for molecules, and there is none")))
}

/// Puts a trajectory into the one molecule of a scene.
///
/// # Errors
/// [`BelvedereError::Argument`] if the scene does not hold exactly one molecule.
pub fn set_in_motion(trajectory: &str, layers: &mut [LayerDoc]) -> Result<(), BelvedereError> {
    let mut molecules = layers.iter_mut().filter_map(|layer| match layer {
        LayerDoc::Molecule(molecule) => Some(molecule),
        _ => None,
    });
    match (molecules.next(), molecules.count()) {
        (Some(molecule), 0) => {
            molecule.trajectory = Some(trajectory.to_owned());
            Ok(())
        }
        (first, more) => {
            let count = usize::from(first.is_some()) + more;
            let advice = Advice::new("{} is for a scene of one molecule, and there are ", &["trajectory"]);
            Err(BelvedereError::Argument(advice.then(format!("{count}; name it in its layer"))))
        }
    }
}

impl OpenOptions {
    /// Limits for reading files.
    pub fn limits(&self) -> Limits {
        self.max_bytes.map_or_else(Limits::default, |max_bytes| Limits { max_bytes })
    }

    /// The options with what is asked of contours, materials and the end of the ground.
    pub fn airy(self, air: &Air) -> Self {
        Self {
            contours: air.contours.or(self.contours),
            edge: air.edge.or(self.edge),
            land_cover: air.landcover.clone().or(self.land_cover),
            materials: if air.plain { Some(false) } else { self.materials },
            ..self
        }
    }

    /// The options with what a picture is asked to show otherwise than its scene says.
    pub fn showing(self, asked: &Render) -> Self {
        let air = &asked.air;
        Self {
            palette: asked.palette.as_deref().map(PaletteDoc::of),
            sky: air.sky.clone(),
            haze: air.haze,
            clouds: air.clouds,
            furniture: Some(air.furnishing.wish()),
            area_style: asked.area_style,
            sea: asked.no_sea.then_some(false),
            // A straight picture does not need the ground solved.
            unsolved: asked.drawing.straight,
            molecule: asked.molecules.clone(),
            straighten: asked.straighten.clone(),
            panorama: asked.panorama,
            ..self.airy(air)
        }
    }
}
