//! Built-in scenes as sources: `builtin:massif?seed=7&size=513`, `builtin:street?layer=route`.

use super::city_mesh::Stand;
use crate::city_ground::OwnGround;
use belvedere_builtin as builtin;
use belvedere_core::DVec3;
use belvedere_document::suggestion;
use belvedere_io::city::CityColors;
use belvedere_scene::{City, Crs, Layer, LayerKind, Scene, Unit};

/// Seed of a built-in scene without one.
pub const DEFAULT_SEED: u64 = 7;
/// Nodes per side of a massif without a size.
pub const DEFAULT_SIZE: usize = 513;

/// Base pairs of a double helix without a size.
const DEFAULT_PAIRS: usize = 12;

/// Width of a town without a size, metres.
const DEFAULT_TOWN_M: usize = 1200;

const NAMES: &[&str] = &["massif", "canyon", "street", "church", "dna", "engine", "tube", "town"];

/// Whether a source names a built-in scene.
pub(super) fn is_name(source: &str) -> bool {
    source.starts_with("builtin:")
}

#[derive(Debug, Clone, PartialEq)]
struct Request {
    name: String,
    seed: u64,
    /// Nodes per side, base pairs, or metres.
    size: usize,
}

/// Built-in scenes generated so far, so that layers of one scene are generated once.
#[derive(Debug, Default)]
pub(super) struct Builtins(Vec<(Request, Scene)>);

impl Builtins {
    /// Result of `pick` on the first layer of `source`'s scene that it accepts (and that has the id given as `layer=`).
    pub(super) fn find<T>(
        &mut self,
        source: &str,
        seed: Option<u64>,
        pick: impl Fn(&LayerKind) -> Option<T>,
    ) -> Result<T, String> {
        let (mut request, id) = parse(source)?;
        request.seed = seed.unwrap_or(request.seed);
        let at = match self.0.iter().position(|(r, _)| *r == request) {
            Some(at) => at,
            None => {
                let (scene, _) = make(&request)?;
                self.0.push((request, scene));
                self.0.len() - 1
            }
        };
        let layers = &self.0[at].1.layers;
        let named = |l: &&Layer| id.as_ref().is_none_or(|id| *id == l.id);
        layers.iter().filter(named).find_map(|l| pick(&l.kind)).ok_or_else(|| {
            let ids: Vec<&str> = layers.iter().filter(|l| pick(&l.kind).is_some()).map(|l| l.id.as_str()).collect();
            format!("{source} has no such layer of this kind; layers of this kind are: {}", ids.join(", "))
        })
    }
}

/// A whole built-in scene and its suggested camera.
pub fn scene(source: &str) -> Result<(Scene, builtin::SuggestedCamera), String> {
    make(&parse(source)?.0)
}

fn make(request: &Request) -> Result<(Scene, builtin::SuggestedCamera), String> {
    let made = match request.name.as_str() {
        "massif" => builtin::massif(request.seed, request.size),
        "canyon" => builtin::canyon(request.seed),
        "church" => builtin::church(),
        "town" => return town(request),
        "engine" => builtin::engine(request.seed),
        "tube" => builtin::tube(request.seed),
        "dna" => builtin::dna(request.seed, request.size),
        _ => builtin::street(request.seed),
    };
    made.map_err(|e| e.to_string())
}

/// The city of a built-in scene, if it has one.
pub(super) fn city(source: &str, seed: Option<u64>) -> Result<City, String> {
    let (request, layer) = parse(source)?;
    if request.name != "town" || layer.is_some() {
        return Err(format!("{source} is no city; builtin:town?seed=7 is one"));
    }
    builtin::town(seed.unwrap_or(request.seed), request.size as f64).map_err(|e| e.to_string())
}

/// The town as triangles, seen from over the fields in the south.
fn town(request: &Request) -> Result<(Scene, builtin::SuggestedCamera), String> {
    let size = request.size as f64;
    let city = builtin::town(request.seed, size).map_err(|e| e.to_string())?;
    let extent = belvedere_io::city::plate_extent(&city);
    let stand = Stand::Own(&OwnGround::Level(0.0), extent);
    let layer = super::city_mesh::mesh(city, &CityColors::default(), &stand)?;
    let title = format!("Town {}: its church between roofs", request.seed);
    let layers = vec![Layer { id: "town".into(), must_see: false, kind: layer.into() }];
    let camera = builtin::SuggestedCamera {
        title: title.clone(),
        eye: DVec3::new(0.0, -0.75 * size, 0.25 * size),
        look_at: DVec3::ZERO,
        fov_y: 40f64.to_radians(),
    };
    Ok((Scene { title, crs: Crs::Local, unit: Unit::Metre, layers, ..Scene::default() }, camera))
}

fn parse(source: &str) -> Result<(Request, Option<String>), String> {
    let text = source.trim_start_matches("builtin:");
    let (name, query) = text.split_once('?').unwrap_or((text, ""));
    if !NAMES.contains(&name) {
        return Err(format!("built-in scene \"{name}\" does not exist; {}", suggestion(name, NAMES)));
    }
    let size = match name {
        "dna" => DEFAULT_PAIRS,
        "town" => DEFAULT_TOWN_M,
        _ => DEFAULT_SIZE,
    };
    let mut request = Request { name: name.to_owned(), seed: DEFAULT_SEED, size };
    let mut layer = None;
    for pair in query.split('&').filter(|p| !p.is_empty()) {
        let (key, value) = pair.split_once('=').unwrap_or((pair, ""));
        let bad = || {
            format!(
                "{source}: \"{pair}\" is not understood; possible: seed=N, size=N (massif, town), pairs=N (dna), layer=ID"
            )
        };
        match key {
            "seed" => request.seed = value.parse().map_err(|_| bad())?,
            "pairs" if name == "dna" => request.size = value.parse().map_err(|_| bad())?,
            "size" if name == "massif" || name == "town" => request.size = value.parse().map_err(|_| bad())?,
            "layer" if !value.is_empty() => layer = Some(value.to_owned()),
            _ => return Err(bad()),
        }
    }
    Ok((request, layer))
}
