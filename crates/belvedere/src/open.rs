//! Opens scene files and documents as sessions.

use crate::guard::guarded;
use crate::scene_file::camera;
use crate::scene_file::paths::Roots;
use crate::scene_file::{
    self, Document, EarthDoc, LayerDoc, LightDoc, MapPointDoc, Paths, PointDoc, SourceDocument, StageDoc,
};
use crate::session::Loaded;
use crate::shown::{end_ground, show_all};
use crate::user_files::of_user;
use crate::{Advice, BelvedereError, Needs, OpenOptions, Session};
use crate::{circle, straightened};
use belvedere_io::crs::utm_epsg;
use belvedere_resolve::constructor;
use belvedere_resolve::motion::Motions;
use belvedere_resolve::solving::Memory;
use belvedere_resolve::solving::Solving;
use belvedere_resolve::{self, LayerRequest, hidden, representations, validate};
use belvedere_resolve::{set_in_motion, show_molecules};
use belvedere_scene::{Crs, Scene};
use std::path::{Path, PathBuf};
use std::sync::Arc;

impl Session {
    /// Opens a scene file.
    ///
    /// # Errors
    /// Every [`BelvedereError`]; mistakes in the file come with their line.
    pub fn open(path: &Path, options: &OpenOptions) -> Result<Self, BelvedereError> {
        guarded(|| Self::from_document(scene_file::read(path)?, options))
    }

    /// Opens a scene from its text (TOML, or JSON if it starts with `{`); `path` gives the folder of its files.
    ///
    /// # Errors
    /// As [`Session::open`].
    pub fn from_text(path: &Path, text: &str, options: &OpenOptions) -> Result<Self, BelvedereError> {
        Self::from_document(scene_file::parse(path, text)?, options)
    }

    /// Opens a document that was read already, or made in memory; files named by the latter are relative to the current
    /// folder.
    ///
    /// # Errors
    /// As [`Session::open`].
    pub fn from_document(source: SourceDocument, options: &OpenOptions) -> Result<Self, BelvedereError> {
        guarded(|| Self::opened(source, options))
    }

    fn opened(mut source: SourceDocument, options: &OpenOptions) -> Result<Self, BelvedereError> {
        let mut allowed = options.allow_roots.clone();
        allowed.extend(source.of_files.iter().flatten().cloned());
        if source.of_files.is_some() {
            end_ground(&mut source.document.layer);
        }
        change(&mut source.document, options, &mut allowed)?;
        validate::document(&source)?;
        hidden::check(&source)?;
        let scene_dir = source.path().and_then(Path::parent).map(Path::to_owned).unwrap_or_default();
        let trusted = source.path().map(|scene| options.trust.files_of(scene)).unwrap_or_default();
        let roots = Roots { scene_dir, allowed, files: [options.allow_files.clone(), trusted].concat() };
        let document = &source.document;
        let request = LayerRequest {
            needs: needs(&source, options),
            fallback_crs: crs_of_eye(document),
            text: document.text.as_ref(),
            words: &document.title,
            ..LayerRequest::new(&source.origin, &document.layer, &document.crs, &roots)
        };
        let mut loaded = belvedere_resolve::load(request, options)?;
        let (title, crs, unit) = (document.title.clone(), loaded.crs, document.unit);
        let representations = representations::of(&source, &roots)?;
        let (layers, fonts, drawings) = (loaded.layers, loaded.fonts, loaded.drawings);
        let mut scene = Scene { title, crs, unit, layers, representations, fonts, drawings };
        hidden::apply(&mut scene, document);
        if source.of_files.is_some() {
            let shown = show_all(&mut source.document, &scene)?;
            if options.straighten.straighten.is_none() && options.panorama.panorama.is_none() {
                loaded.warnings.push(shown.said());
            }
        }
        belvedere_resolve::fill_surfaces(&mut source.document.layer, &scene);
        let (mut scene, mut inputs) = (Arc::new(scene), loaded.inputs);
        let motions = Motions::read(&source, &roots, &scene, &mut inputs)?.map(Arc::new);
        if let Some(motions) = &motions {
            scene = Arc::new(motions.at(0.0));
        }
        let mut memory = Memory::default();
        let mut solving = Solving { memory: &mut memory, time_step_s: None, progress: &options.progress };
        let loaded = Loaded {
            scene,
            motions,
            areas: loaded.areas,
            notes: loaded.notes,
            arrays: options.arrays.clone(),
            inputs: source.input().cloned().into_iter().chain(inputs).collect(),
            warnings: loaded.warnings,
        };
        let session = Self::of_document(loaded, source, roots, (!options.unsolved).then_some(&mut solving))?;
        circle::aimed(straightened::aimed(session, options)?, options)
    }
}

/// Puts what is asked for instead of what a document says into it.
///
/// * `allowed`: takes the folder of a palette.
fn change(document: &mut Document, options: &OpenOptions, allowed: &mut Vec<PathBuf>) -> Result<(), BelvedereError> {
    if let Some(image) = options.image {
        camera::resize(document, image);
    }
    let OpenOptions { sky, haze, clouds, .. } = options;
    if sky.is_some() || haze.is_some() || clouds.is_some() {
        let asked = LightDoc { sky: sky.clone(), haze: *haze, clouds: *clouds, ..LightDoc::default() };
        let light = asked.over(document.light.take().unwrap_or_default());
        belvedere_resolve::check_air(&light)?;
        document.light = Some(light);
    }
    if let Some(wish) = &options.furniture {
        wish.put_into(&mut document.furniture);
    }
    let palette = options.palette.as_ref().map(|palette| palette.located(allowed)).transpose()?;
    if options.land_cover.is_some() && !document.layer.iter().any(|layer| matches!(layer, LayerDoc::Terrain(_))) {
        let advice = Advice::of_options(&["landcover"], "for terrain, and the scene has none");
        return Err(BelvedereError::Argument(advice));
    }
    let land_cover = options.land_cover.as_ref().map(|name| of_user(name, allowed)).transpose()?;
    straightened::put_into(document, &options.straighten, allowed)?;
    show_molecules(&options.molecule, &mut document.layer)?;
    if let Some(trajectory) = &options.trajectory {
        set_in_motion(&of_user(trajectory, allowed)?, &mut document.layer)?;
    }
    for layer in &mut document.layer {
        match layer {
            LayerDoc::Area(area) => {
                if let Some(kind) = options.area_style {
                    belvedere_resolve::restyle(&mut area.style, kind);
                }
            }
            LayerDoc::Terrain(terrain) => {
                terrain.land_cover = land_cover.clone().map(Paths::One).or(terrain.land_cover.take());
                let style = &mut terrain.style;
                style.palette = palette.clone().unwrap_or_else(|| std::mem::take(&mut style.palette));
                style.materials = options.materials.unwrap_or(style.materials);
                style.sea = options.sea.unwrap_or(style.sea);
                style.contours = options.contours.or(style.contours);
                style.edge = options.edge.unwrap_or(style.edge);
            }
            _ => {}
        }
    }
    Ok(())
}

/// Parts of the scene to read for the given options.
fn needs(source: &SourceDocument, options: &OpenOptions) -> Needs {
    let document = &source.document;
    let constructs = document.solves_terrain() || constructor::stated(source).is_some();
    match options.needs {
        _ if source.of_files.is_some() => Needs::Everything,
        _ if constructs && !options.unsolved => Needs::Everything,
        _ if document.stage.iter().any(needs_layers) => Needs::Everything,
        Needs::View if ground_is_needed(document) => Needs::Ground,
        needs => needs,
    }
}

/// Whether a stage follows lines of layers, or keeps what lies on the ground.
fn needs_layers(stage: &StageDoc) -> bool {
    match stage {
        StageDoc::Strip(strip) => strip.along.is_some(),
        StageDoc::GroundMoves(_) => true,
        StageDoc::Tube(tube) => tube.points.is_none(),
        _ => false,
    }
}

/// Whether the view cannot be resolved without the terrain.
fn ground_is_needed(doc: &Document) -> bool {
    let points = [Some(&doc.camera.eye), doc.camera.look_at.as_ref()];
    let stands = |p: &PointDoc| matches!(p, PointDoc::Map(m) if m.above_ground_m.is_some());
    let geographic = |p: &PointDoc| matches!(p, PointDoc::Map(m) if m.lon.is_some());
    let spline_floats = doc.stage.iter().any(|s| match s {
        StageDoc::SplineBend(spline) => spline.plane.as_ref().is_none_or(|p| p.height_m.is_none()),
        StageDoc::Relief(relief) => {
            relief.levelling.is_some_and(|v| v > 0.0) || relief.plane.as_ref().is_none_or(|p| p.height_m.is_none())
        }
        StageDoc::TerrainDisocclusion(_) | StageDoc::GroundMoves(_) => true,
        // Without an anchor the point that the camera looks at is used, which may lie on the terrain.
        StageDoc::Strip(strip) => strip.anchor.is_none(),
        StageDoc::Tube(_) | StageDoc::Unroll(_) | StageDoc::CurvedRays(_) => false,
    });
    let needs_crs = points.into_iter().flatten().any(geographic)
        || doc.earth == EarthDoc::Curved
        || doc.light.as_ref().is_some_and(|l| l.time.is_some());
    let automatic = doc.crs.trim().eq_ignore_ascii_case("auto");
    points.into_iter().flatten().any(stands) || spline_floats || (automatic && needs_crs)
}

/// The UTM zone of an eye given by longitude and latitude, which `auto` stands for without terrain.
fn crs_of_eye(doc: &Document) -> Option<Crs> {
    match doc.camera.eye {
        PointDoc::Map(MapPointDoc { lon: Some(lon), lat: Some(lat), .. }) => utm_epsg(lon, lat).map(Crs::Epsg),
        _ => None,
    }
}
