//! Scenes of coarse pictures: lines and letters that look as wide on the screen as those of the picture at rest, models and volumes with
//! less detail.

use super::coarse;
use super::rate::Quality;
use belvedere_overlay::widths;
use belvedere_scene::{Layer, LayerKind, MeshLayer, MoleculeLayer, OwnLayer, Scene, VolumeModel};
use std::sync::Arc;

/// Detail of moving pictures from which on volumes are not shaded.
const PLAIN: u8 = 3;

/// Scenes that are kept: those of the qualities between which moving pictures change.
const KEPT: usize = 3;

/// A scene, the quality and density of its picture, and its form for that.
type Kept = (Arc<Scene>, (Quality, f64), Arc<Scene>);

/// The scenes of the last coarse pictures.
#[derive(Debug, Default)]
pub(super) struct Thin {
    kept: Vec<Kept>,
    /// Coarse meshes of a scene: number of the layer, most triangles, the mesh if it can be made coarser.
    meshes: Vec<(usize, usize, Option<MeshLayer>)>,
}

impl Thin {
    /// The scene for a moving picture: lines and letters as thin as it is narrow, models and volumes as coarse as its quality says.
    ///
    /// * `density`: pixels of the full picture per point of the screen.
    pub(super) fn scene(&mut self, scene: Arc<Scene>, quality: Quality, density: f64) -> Arc<Scene> {
        let scale = quality.width() * density;
        if (scale == 1.0 || !widths::has_any(&scene)) && !scene.layers.iter().any(|layer| changes(&layer.kind, quality))
        {
            return scene;
        }
        if let Some(at) = self.kept.iter().position(|(of, at, _)| Arc::ptr_eq(of, &scene) && *at == (quality, density))
        {
            self.kept[at..].rotate_left(1);
        } else {
            if self.kept.last().is_some_and(|(of, ..)| !Arc::ptr_eq(of, &scene)) {
                (self.kept, self.meshes) = (Vec::new(), Vec::new());
            }
            let thin = Arc::new(self.thinned(&widths::scaled(&scene, scale), quality));
            if self.kept.len() >= KEPT {
                self.kept.remove(0);
            }
            self.kept.push((scene.clone(), (quality, density), thin));
        }
        self.kept.last().map_or(scene, |(.., thin)| thin.clone())
    }

    fn thinned(&mut self, scene: &Scene, quality: Quality) -> Scene {
        let layer = |(index, layer): (usize, &Layer)| {
            let kind = self.coarse(index, &layer.kind, quality).unwrap_or_else(|| thinned(&layer.kind, quality));
            Layer { id: layer.id.clone(), must_see: layer.must_see, kind }
        };
        let layers = scene.layers.iter().enumerate().map(layer).collect();
        let (title, representations) = (scene.title.clone(), scene.representations.clone());
        let (fonts, drawings) = (scene.fonts.clone(), scene.drawings.clone());
        Scene { title, crs: scene.crs, unit: scene.unit, layers, representations, fonts, drawings }
    }

    /// A layer of triangles with fewer of them; `None` if it has none, or few.
    fn coarse(&mut self, index: usize, kind: &LayerKind, quality: Quality) -> Option<LayerKind> {
        let (most, fine) = (quality.mesh_triangles()?, kind.triangles()?);
        let made = self.meshes.iter().find(|(of, at, _)| (*of, *at) == (index, most)).map(|(.., made)| made.clone());
        let coarser = made.unwrap_or_else(|| {
            let made = coarse::layer(fine, most);
            self.meshes.push((index, most, made.clone()));
            made
        })?;
        match kind {
            LayerKind::Molecule(molecule) => Some(LayerKind::Molecule(Box::new(MoleculeLayer {
                molecule: molecule.molecule.clone(),
                placement: molecule.placement,
                surface: coarser,
                atoms: molecule.atoms,
                bonds: molecule.bonds,
                representation: molecule.representation,
                shown: molecule.shown.clone(),
                film: molecule.film.clone(),
                label_px: molecule.label_px,
                wanted: molecule.wanted.clone(),
            }))),
            LayerKind::Mesh(_) => Some(coarser.into()),
            LayerKind::Own(own) => Some(OwnLayer { surface: coarser, ..own.clone() }.into()),
            _ => None,
        }
    }
}

/// Whether a layer is another one in a picture of this quality.
fn changes(kind: &LayerKind, quality: Quality) -> bool {
    match kind {
        LayerKind::Volume(_) => quality.volume_step() > 1.0,
        kind => quality
            .mesh_triangles()
            .zip(kind.triangles())
            .is_some_and(|(most, layer)| layer.mesh.triangles().len() > most),
    }
}

/// A volume of a picture of this quality; other layers as they are.
fn thinned(kind: &LayerKind, quality: Quality) -> LayerKind {
    let mut kind = kind.clone();
    if let Some(volume) = kind.volume_mut() {
        volume.step *= quality.volume_step();
        if quality.coarseness() >= PLAIN {
            volume.model = VolumeModel::Plain;
        }
    }
    kind
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_scene::{Color, Layer, LineLayer};

    #[test]
    fn lines_are_as_thin_as_the_picture_is_coarse_and_made_once() {
        let layer =
            Layer { id: "way".into(), must_see: true, kind: LineLayer::new(Vec::new(), Color::rgb(1, 2, 3)).into() };
        let scene = Arc::new(Scene { layers: vec![layer], ..Scene::default() });
        let mut thin = Thin::default();
        assert!(Arc::ptr_eq(&thin.scene(scene.clone(), Quality::FULL, 1.0), &scene), "nothing to do");
        let least = thin.scene(scene.clone(), Quality::LEAST, 1.0);
        let Some(line) = least.layers[0].kind.lines() else { panic!("no line") };
        assert_eq!((line.width_px, least.layers[0].must_see), (3.0 * Quality::LEAST.width(), true));
        assert!(Arc::ptr_eq(&thin.scene(scene, Quality::LEAST, 1.0), &least), "made twice");
    }

    #[test]
    fn molecules_have_few_triangles_and_volumes_long_steps_in_coarse_pictures() {
        let session = |text: &str| {
            let document = crate::scene_file::parse(std::path::Path::new("s.toml"), text).expect("scene").document;
            let source = crate::scene_file::SourceDocument::new(document);
            crate::Session::from_document(source, &crate::OpenOptions::default()).expect("session")
        };
        let camera = "format = 1\nunit = 'angstrom'\n[camera]\neye = [0, -300, 0]\nlook_at = [0, 0, 0]\n[[layer]]\n";
        let scene = session(&format!("{camera}id = 'm'\nkind = 'molecule'\nsource = 'builtin:dna?pairs=12&seed=7'\n"));
        let count = |scene: &Scene| scene.layers[0].kind.triangles().expect("triangles").mesh.triangles().len();
        let (all, coarse) =
            (scene.loaded.scene.clone(), Thin::default().scene(scene.loaded.scene.clone(), Quality::LEAST, 1.0));
        assert!(count(&all) > 200_000 && (10_000..=40_000).contains(&count(&coarse)), "{}", count(&coarse));
        let scene = session(&format!("{camera}id = 'v'\nkind = 'volume'\nsource = 'builtin:tube'\n"));
        let coarse = Thin::default().scene(scene.loaded.scene.clone(), Quality::LEAST, 1.0);
        let Some(volume) = coarse.layers[0].kind.volume() else { panic!("no volume") };
        assert_eq!((volume.step, volume.model), (2.0, VolumeModel::Plain));
    }
}
