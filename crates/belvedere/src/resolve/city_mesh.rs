//! Cities as triangles.

use belvedere_construct::generalise::{LandCoverMap, land_cover};
use belvedere_core::DVec2;
use belvedere_io::city::{CityColors, CityGround, surface};
use belvedere_scene::{City, Mesh, MeshLayer};

/// A city as triangles, with its buildings as parts. Without terrain it is on a plate of its land cover, as wide as `extent`.
pub(super) fn mesh(
    mut city: City,
    colors: &CityColors,
    terrain: Option<&dyn Fn(DVec2) -> Option<f64>>,
    extent: Option<[DVec2; 2]>,
) -> Result<MeshLayer, String> {
    let file = match terrain {
        Some(terrain) => surface(&city, colors, CityGround::Terrain(terrain)),
        None => {
            let cover = extent.map(|extent| land_cover(&city.areas, extent));
            let LandCoverMap { areas, bare } = cover.unwrap_or_default();
            city.areas = areas;
            surface(&city, colors, CityGround::Plate(&bare))
        }
    };
    if file.triangles.is_empty() {
        return Err("it has no building or other surface to draw; ways alone are drawn by a line layer".into());
    }
    let mesh = Mesh::textured(&file.positions, file.triangles, file.colors, file.parts, file.texturing);
    let mesh = mesh.map_err(|e| e.to_string())?;
    Ok(MeshLayer { names: file.names, has_plate: terrain.is_none(), ..MeshLayer::new(mesh, colors.wall) })
}
