//! Grounds with what must be seen on them.

use crate::Failure;
use belvedere_builtin::{RouteCost, least_cost_route};
use belvedere_core::DVec2;
use belvedere_io::{TerrainRequest, areas_on_terrain, load_terrain, load_vectors};
use belvedere_scene::{
    AreaLayer, AreaSurface, Color, Crs, Heightfield, Hidden, Layer, LayerKind, LineFeature, LineLayer, Progress,
    TerrainLayer, drape_polyline,
};
use belvedere_testkit::data;
use std::sync::Arc;

/// A ground, a route from corner to corner, and outlines where there are any.
pub(crate) struct Range {
    pub(crate) ground: Arc<Heightfield>,
    pub(crate) crs: Crs,
    pub(crate) route: Vec<Layer>,
    pub(crate) areas: Vec<Layer>,
}

impl Range {
    pub(crate) fn terrain(&self) -> Layer {
        let kind = LayerKind::Terrain(TerrainLayer::new(self.ground.clone()));
        Layer { id: "ground".into(), must_see: false, kind }
    }
}

/// Seeded grounds.
const ANDES: [&str; 3] = ["andes1", "andes2", "andes3"];

/// Names, DEMs and outlines.
const FILES: [(&str, &str, Option<&str>); 8] = [
    ("andorra", "andorra/N42E001.hgt", Some("andorra/water.geojson")),
    ("gotthard", "gotthard/N46E008.tif", None),
    ("baltoro", "baltoro/baltoro_srtm.tif", Some("baltoro/glacier_outline.geojson")),
    ("crop", "baltoro/baltoro_crop.asc", None),
    ("bigtujunga", "bigtujunga/bigtujunga.tif", None),
    ("canyon", "grand_canyon/grandcanyon_dem_3857.tif", None),
    ("rmnp", "rmnp/rmnp_dem.tif", None),
    ("swellendam", "swellendam/srtm_41_19_utm33s.tif", Some("swellendam/protected_areas.geojson")),
];

/// All of them, seeded ones first.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    ANDES.into_iter().chain(FILES.into_iter().map(|f| f.0))
}

/// `None` where its files are missing.
pub(crate) fn load(name: &str) -> Result<Option<Range>, Failure> {
    if let Some(seed) = ANDES.iter().position(|n| *n == name) {
        let ground = Arc::new(andes(401, 90.0, seed as u64 + 1)?);
        let route = route(&ground)?;
        return Ok(Some(Range { ground, crs: Crs::Local, route, areas: Vec::new() }));
    }
    let Some((_, dem, outlines)) = FILES.into_iter().find(|f| f.0 == name) else { return Ok(None) };
    let Some(path) = data(dem) else { return Ok(None) };
    let request = TerrainRequest { fill_voids: true, ..TerrainRequest::default() };
    let loaded = load_terrain(&[path], &request, &Progress::silent())?.value;
    let mut areas = Vec::new();
    if let Some(path) = outlines.and_then(data) {
        let features = areas_on_terrain(&load_vectors(&path)?.value, loaded.crs, Some(&loaded.heightfield))?.value;
        let kind = LayerKind::Area(AreaLayer {
            features: features.features,
            fill: Color::rgb(80, 140, 200),
            outline: None,
            width_px: 1.0,
            surface: AreaSurface::Outline,
            hidden: Hidden::Dash,
            lift_m: 1.0,
            label_px: None,
            beyond: 0.0,
        });
        areas.push(Layer { id: "areas".into(), must_see: true, kind });
    }
    let (ground, crs) = (Arc::new(loaded.heightfield), loaded.crs);
    Ok(Some(Range { route: route(&ground)?, ground, crs, areas }))
}

/// From corner to corner, or from what lies nearer to the middle where corners are void.
fn route(ground: &Heightfield) -> Result<Vec<Layer>, Failure> {
    let cost = RouteCost { wander: 1.0, seed: 11, ..RouteCost::default() };
    let size = DVec2::new((ground.cols() - 1) as f64, (ground.rows() - 1) as f64) * ground.spacing();
    let at = |share: f64| ground.north_west() + DVec2::new(share, -share) * size;
    let mut way = Err("no route".into());
    for inset in [0.06, 0.12, 0.2, 0.3] {
        way = least_cost_route(ground, at(inset), at(1.0 - inset), &cost).map_err(Failure::from);
        if way.is_ok() {
            break;
        }
    }
    let parts = drape_polyline(ground, &way?).parts;
    let features = parts.into_iter().map(|points| LineFeature { style: None, name: "route".into(), points }).collect();
    let kind = LayerKind::Line(LineLayer::new(features, Color::rgb(215, 48, 31)));
    Ok(vec![Layer { id: "route".into(), must_see: true, kind }])
}

/// Steep ground like the Andes: 2 km of relief per valley, sharp ridges, rough down to single cells.
fn andes(n: usize, spacing: f64, seed: u64) -> Result<Heightfield, Failure> {
    let height = |i: usize| {
        let p = spacing * DVec2::new((i % n) as f64, (i / n) as f64);
        let (mut cell, mut size, mut sum) = (8000.0, 1.0, 0.0);
        for octave in 0..7 {
            // Folded, so that ridges are sharp.
            sum += size * (1.0 - 2.0 * (2.0 * smooth_noise(p / cell, 10 * seed + octave) - 1.0).abs());
            cell *= 0.5;
            size *= if octave == 0 { 0.42 } else { 0.45 };
        }
        (2500.0 + 1400.0 * sum) as f32
    };
    let north_west = DVec2::new(0.0, (n - 1) as f64 * spacing);
    Ok(Heightfield::measured(north_west, DVec2::splat(spacing), n, n, (0..n * n).map(height).collect())?)
}

/// 0..1, smooth, seeded, one value per unit.
fn smooth_noise(p: DVec2, seed: u64) -> f64 {
    let (corner, part) = (p.floor(), p - p.floor());
    let ease = part * part * (DVec2::splat(3.0) - 2.0 * part);
    let value = |x: f64, y: f64| {
        let key = (seed << 40) ^ (((corner.x + x) as u64) << 20) ^ ((corner.y + y) as u64);
        belvedere_testkit::Random::new(key).unit()
    };
    let rows = [0.0, 1.0].map(|y| value(0.0, y) + ease.x * (value(1.0, y) - value(0.0, y)));
    rows[0] + ease.y * (rows[1] - rows[0])
}
