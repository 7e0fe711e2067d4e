//! From the layers of a document to the layers of a scene.

use super::validate::{color, optional_color};
use super::{Ground, builtin, vectors};
use crate::scene_file::paths::Roots;
use crate::scene_file::{
    AreaDoc, AutoOrLength, Document, HiddenDoc, LayerDoc, LineDoc, PaletteDoc, PaletteName, Paths, PlaceDoc,
    PointLayerDoc, ReliefDoc, RouteDoc, ShadingDoc, SourceDocument, SurfaceDoc, SymbolDoc, TerrainDoc,
};
use crate::{BelvedereError, OpenOptions};
use belvedere_builtin::{RouteCost, least_cost_route, valley_route};
use belvedere_core::DVec2;
use belvedere_scene::{
    AreaLayer, AreaSurface, Color, Crs, DistanceMarkers, Drape, Heightfield, Hidden, Layer, LayerKind, LineFeature,
    LineLayer, Palette, PointLayer, PointStyle, Relief, Scene, Shading, Symbol, TerrainLayer, drape_polyline,
};
use std::path::PathBuf;
use std::sync::Arc;

/// What layers are loaded with, and what is found out on the way.
pub(super) struct Loader<'a> {
    pub(super) source: &'a SourceDocument,
    pub(super) roots: &'a Roots,
    pub(super) options: &'a OpenOptions,
    pub(super) builtins: builtin::Builtins,
    pub(super) inputs: Vec<PathBuf>,
    pub(super) warnings: Vec<String>,
}

impl Loader<'_> {
    /// An error at a key of layer `index`.
    pub(super) fn fail(&self, index: usize, key: &str, reason: impl std::fmt::Display) -> BelvedereError {
        let id = self.source.document.layer.get(index).map_or("", LayerDoc::id);
        self.source.error(&["layer", &index.to_string(), key], format!("layer \"{id}\": {reason}"))
    }

    /// The files that a key names.
    pub(super) fn files(&mut self, index: usize, key: &str, paths: &Paths) -> Result<Vec<PathBuf>, BelvedereError> {
        if paths.as_slice().is_empty() {
            return Err(self.fail(index, key, format!("{key} is an empty list; name at least one file")));
        }
        let found: Vec<PathBuf> = paths
            .as_slice()
            .iter()
            .map(|name| self.roots.resolve(name).map_err(|e| self.fail(index, key, e)))
            .collect::<Result<_, _>>()?;
        self.inputs.extend(found.iter().cloned());
        Ok(found)
    }

    /// Keeps warnings, with the layer they belong to.
    pub(super) fn note(&mut self, index: usize, warnings: Vec<String>) {
        let id = self.source.document.layer.get(index).map_or("", LayerDoc::id);
        self.warnings.extend(warnings.into_iter().map(|w| format!("layer \"{id}\": {w}")));
    }

    /// The terrain of a layer and the coordinate system it brings.
    pub(super) fn terrain(
        &mut self,
        index: usize,
        doc: &TerrainDoc,
        wanted: Option<Crs>,
    ) -> Result<(TerrainLayer, Crs), BelvedereError> {
        let style = &doc.style;
        let (heightfield, crs) = match doc.source.as_slice() {
            [name] if builtin::is_name(name) => {
                let seed = self.options.seed;
                let kind = self.builtins.find(name, seed, |k| matches!(k, LayerKind::Terrain(_)));
                match kind.map_err(|e| self.fail(index, "source", e))? {
                    LayerKind::Terrain(t) => (t.heightfield, wanted.unwrap_or_default()),
                    _ => return Err(self.fail(index, "source", "the built-in scene has no terrain")),
                }
            }
            _ => {
                let (heightfield, crs) = super::dem::load(self, index, doc, wanted)?;
                (heightfield.into(), crs)
            }
        };
        let layer = TerrainLayer {
            heightfield,
            drapes: Vec::new(),
            relief: match style.relief {
                ReliefDoc::Swiss => Relief::Swiss,
                ReliefDoc::Sun => Relief::Sun,
                ReliefDoc::None => Relief::None,
            },
            shading: style.shading.map(|s| match s {
                ShadingDoc::Map => Shading::Map,
                ShadingDoc::Deformed => Shading::Deformed,
            }),
            exaggeration: style.exaggeration,
            palette: self.palette(index, &style.palette)?,
        };
        Ok((layer, crs))
    }

    /// A palette by name or from its file.
    fn palette(&mut self, index: usize, doc: &PaletteDoc) -> Result<Palette, BelvedereError> {
        let name = match doc {
            PaletteDoc::Named(name) => {
                return Ok(match name {
                    PaletteName::Auto => Palette::Auto,
                    PaletteName::Alpine => Palette::Alpine,
                    PaletteName::Desert => Palette::Desert,
                    PaletteName::Glacial => Palette::Glacial,
                    PaletteName::Clear => Palette::Clear,
                    PaletteName::Plain => Palette::Plain,
                });
            }
            PaletteDoc::File(name) => name,
        };
        let fail = |e: String| {
            let names = PaletteName::ALL.map(|(name, _)| name).join(", ");
            let id = self.source.document.layer.get(index).map_or("", LayerDoc::id);
            let reason = format!("layer \"{id}\": palette: {e}; give one of {names}, or a file of colours by height");
            self.source.error(&["layer", &index.to_string(), "style", "palette"], reason)
        };
        let file = self.roots.resolve(name).map_err(|e| fail(e.to_string()))?;
        let loaded = belvedere_io::load_ramp(&file).map_err(|e| fail(e.to_string()))?;
        self.inputs.push(file);
        self.note(index, loaded.warnings);
        Ok(Palette::Ramp(Arc::new(loaded.value)))
    }

    /// Pictures for a terrain that is already there.
    pub(super) fn drapes(
        &mut self,
        index: usize,
        doc: &TerrainDoc,
        ground: &Ground<'_>,
    ) -> Result<Vec<Drape>, BelvedereError> {
        let Some(paths) = &doc.drape else { return Ok(Vec::new()) };
        let files = self.files(index, "drape", paths)?;
        let bounds = ground.terrain.map(Heightfield::bounds);
        let mut drapes = Vec::new();
        for file in files {
            let loaded = super::drape::load(&file, ground.crs, bounds, self.options.limits(), &self.options.progress);
            let loaded = loaded.map_err(|e| self.fail(index, "drape", e))?;
            self.note(index, loaded.warnings);
            drapes.push(loaded.value);
        }
        Ok(drapes)
    }

    /// A line layer.
    pub(super) fn line(
        &mut self,
        index: usize,
        doc: &LineDoc,
        ground: &Ground<'_>,
    ) -> Result<LayerKind, BelvedereError> {
        let features = match (&doc.source, &doc.route) {
            (_, Some(route)) => vec![self.route(index, route, ground)?],
            (Some(Paths::One(name)), None) if builtin::is_name(name) => {
                let seed = self.options.seed;
                let kind = self.builtins.find(name, seed, |k| matches!(k, LayerKind::Line(_)));
                match kind.map_err(|e| self.fail(index, "source", e))? {
                    LayerKind::Line(l) => l.features,
                    _ => Vec::new(),
                }
            }
            (Some(paths), None) => {
                let files = self.files(index, "source", paths)?;
                vectors::lines(self, index, &files, ground)?
            }
            (None, None) => Vec::new(),
        };
        if features.is_empty() {
            return Err(self.fail(index, "source", "no line lies on the terrain; check that the source covers it"));
        }
        let style = &doc.style;
        Ok(LayerKind::Line(LineLayer {
            features,
            color: self.color(index, &style.color)?,
            width_px: style.width_px,
            casing: self.optional_color(index, &style.casing)?,
            hidden: hidden(style.hidden),
            lift_m: style.lift_m,
            markers: style.distance_markers_m.map(|m| match m {
                AutoOrLength::Auto(_) => DistanceMarkers::Auto,
                AutoOrLength::Length(every) => DistanceMarkers::Every(every),
            }),
            label_px: style.labels.then_some(style.label_px),
        }))
    }

    fn route(&mut self, index: usize, doc: &RouteDoc, ground: &Ground<'_>) -> Result<LineFeature, BelvedereError> {
        let Some(terrain) = ground.terrain else {
            return Err(self.fail(index, "route", "a generated route needs a terrain layer; add one"));
        };
        let seed = self.options.seed.unwrap_or(doc.seed);
        let found = match (doc.from, doc.to) {
            (Some(from), Some(to)) => {
                let from = place(ground, from).map_err(|e| self.fail(index, "route", e))?;
                let to = place(ground, to).map_err(|e| self.fail(index, "route", e))?;
                least_cost_route(terrain, from, to, &RouteCost { wander: 1.5, seed, ..RouteCost::default() })
            }
            (None, None) => valley_route(terrain, seed),
            _ => {
                return Err(self.fail(
                    index,
                    "route",
                    "a route needs both from and to, or neither for a valley of its own",
                ));
            }
        };
        let way = found.map_err(|e| self.fail(index, "route", e))?;
        let points = drape_polyline(terrain, &way).parts.into_iter().max_by_key(Vec::len).unwrap_or_default();
        if points.len() < 2 {
            return Err(self.fail(index, "route", "the route has no length; move from and to apart"));
        }
        Ok(LineFeature { name: "generated route".into(), points })
    }

    /// An area layer.
    pub(super) fn area(
        &mut self,
        index: usize,
        doc: &AreaDoc,
        ground: &Ground<'_>,
    ) -> Result<LayerKind, BelvedereError> {
        let (features, tagged) = match &doc.source {
            Paths::One(name) if builtin::is_name(name) => {
                let seed = self.options.seed;
                let kind = self.builtins.find(name, seed, |k| matches!(k, LayerKind::Area(_)));
                match kind.map_err(|e| self.fail(index, "source", e))? {
                    LayerKind::Area(a) => (a.features, Some(a.surface)),
                    _ => (Vec::new(), None),
                }
            }
            paths => {
                let files = self.files(index, "source", paths)?;
                vectors::areas(self, index, &files, ground)?
            }
        };
        if features.is_empty() {
            return Err(self.fail(index, "source", "no area lies on the terrain; check that the source covers it"));
        }
        let style = &doc.style;
        let asked = style.surface.map(surface);
        let asked = asked.or(style.water.map(|water| if water { AreaSurface::Water } else { AreaSurface::Plain }));
        let surface = asked.or(tagged).unwrap_or_default();
        Ok(LayerKind::Area(AreaLayer {
            features,
            fill: match &style.color {
                Some(color) => self.color(index, color)?,
                None => surface.color(),
            },
            outline: self.optional_color(index, &style.outline)?,
            width_px: style.width_px,
            surface,
            hidden: hidden(style.hidden),
            lift_m: style.lift_m,
        }))
    }

    /// A point layer.
    pub(super) fn point(
        &mut self,
        index: usize,
        doc: &PointLayerDoc,
        ground: &Ground<'_>,
    ) -> Result<LayerKind, BelvedereError> {
        let files = self.files(index, "source", &doc.source)?;
        let features = vectors::points(self, index, &files, ground)?;
        if features.is_empty() {
            return Err(self.fail(index, "source", "no point lies on the terrain; check that the source covers it"));
        }
        let style = &doc.style;
        Ok(LayerKind::Point(PointLayer {
            features,
            color: self.color(index, &style.color)?,
            size_px: style.size_px,
            style: PointStyle {
                symbol: match style.symbol {
                    SymbolDoc::Dot => Symbol::Dot,
                    SymbolDoc::Triangle => Symbol::Triangle,
                    SymbolDoc::Square => Symbol::Square,
                    SymbolDoc::Pin => Symbol::Pin,
                    SymbolDoc::Cross => Symbol::Cross,
                },
                casing: self.optional_color(index, &style.casing)?,
                label_px: style.labels.then_some(style.label_px),
            },
            hidden: hidden(style.hidden),
            lift_m: style.lift_m,
        }))
    }

    /// Any layer but terrain.
    pub(super) fn layer(
        &mut self,
        index: usize,
        doc: &LayerDoc,
        ground: &Ground<'_>,
    ) -> Result<Option<Layer>, BelvedereError> {
        let kind = match doc {
            LayerDoc::Terrain(_) => return Ok(None),
            LayerDoc::Line(line) => self.line(index, line, ground)?,
            LayerDoc::Area(area) => self.area(index, area, ground)?,
            LayerDoc::Point(point) => self.point(index, point, ground)?,
            LayerDoc::Boxes(boxes) => super::boxes::layer(self, index, boxes)?,
            LayerDoc::Mesh(mesh) => super::mesh::layer(self, index, mesh, ground)?,
            LayerDoc::City(_) | LayerDoc::Molecule(_) | LayerDoc::Volume(_) => {
                return Err(self.fail(
                    index,
                    "kind",
                    format!("layers of kind {} are not drawn by this version; remove the layer", doc.kind()),
                ));
            }
        };
        Ok(Some(Layer { id: doc.id().to_owned(), must_see: doc.must_see(), kind }))
    }

    pub(super) fn color(&self, index: usize, text: &str) -> Result<Color, BelvedereError> {
        color("color", text).map_err(|(key, reason)| self.fail(index, key, reason))
    }

    fn optional_color(&self, index: usize, text: &str) -> Result<Option<Color>, BelvedereError> {
        optional_color("casing", text).map_err(|(key, reason)| self.fail(index, key, reason))
    }
}

fn place(ground: &Ground<'_>, place: PlaceDoc) -> Result<DVec2, String> {
    match place {
        PlaceDoc::Scene(xy) => Ok(DVec2::from_array(xy)),
        PlaceDoc::Geographic(p) => ground.place_of(p.lon, p.lat),
    }
}

fn surface(doc: SurfaceDoc) -> AreaSurface {
    match doc {
        SurfaceDoc::Plain => AreaSurface::Plain,
        SurfaceDoc::Water => AreaSurface::Water,
        SurfaceDoc::Forest => AreaSurface::Forest,
        SurfaceDoc::Glacier => AreaSurface::Glacier,
    }
}

/// Writes into the areas of a document what was found to cover them, and their colours.
pub(super) fn fill_surfaces(document: &mut Document, scene: &Scene) {
    for doc in &mut document.layer {
        let LayerDoc::Area(doc) = doc else { continue };
        let layer = scene.layers.iter().find(|l| l.id == doc.id);
        let Some(LayerKind::Area(layer)) = layer.map(|l| &l.kind) else { continue };
        doc.style.water = None;
        doc.style.surface = Some(match layer.surface {
            AreaSurface::Plain => SurfaceDoc::Plain,
            AreaSurface::Water => SurfaceDoc::Water,
            AreaSurface::Forest => SurfaceDoc::Forest,
            AreaSurface::Glacier => SurfaceDoc::Glacier,
        });
        let Color { r, g, b, a } = layer.fill;
        let alpha = if a == 255 { String::new() } else { format!("{a:02x}") };
        doc.style.color.get_or_insert_with(|| format!("#{r:02x}{g:02x}{b:02x}{alpha}"));
    }
}

fn hidden(doc: HiddenDoc) -> Hidden {
    match doc {
        HiddenDoc::Show => Hidden::Show,
        HiddenDoc::Fade => Hidden::Fade,
        HiddenDoc::Dash => Hidden::Dash,
        HiddenDoc::Cut => Hidden::Cut,
    }
}
