//! Cities as triangles.

use crate::city_ground::OwnGround;
use belvedere_construct::generalise::{LandCoverMap, land_cover};
use belvedere_core::DVec2;
use belvedere_io::city::{CityColors, CityGround, surface};
use belvedere_scene::{City, Mesh, MeshLayer};

/// What a city stands on.
pub(super) enum Stand<'a> {
    /// Terrain, as height at a position.
    Terrain(&'a dyn Fn(DVec2) -> Option<f64>),
    /// Its own ground, which is drawn with its land cover over this extent.
    Own(&'a OwnGround, Option<[DVec2; 2]>),
}

/// A city as triangles, with its buildings as parts.
pub(super) fn mesh(mut city: City, colors: &CityColors, stand: &Stand<'_>) -> Result<MeshLayer, String> {
    let file = match stand {
        Stand::Terrain(terrain) => surface(&city, colors, CityGround::Terrain(terrain)),
        Stand::Own(ground, extent) => {
            let cover = extent.map(|extent| land_cover(&city.areas, extent));
            let LandCoverMap { areas, bare } = cover.unwrap_or_default();
            city.areas = areas;
            let drawn = match ground {
                OwnGround::Level(z) => CityGround::Plate(*z, &bare),
                OwnGround::Sloping(field) => CityGround::Draped(field, &bare),
            };
            surface(&city, colors, drawn)
        }
    };
    if file.triangles.is_empty() {
        return Err("it has no building or other surface to draw; ways alone are drawn by a line layer".into());
    }
    let mesh = Mesh::textured(&file.positions, file.triangles, file.colors, file.parts, file.texturing);
    let mesh = mesh.map_err(|e| e.to_string())?;
    Ok(MeshLayer { names: file.names, has_plate: matches!(stand, Stand::Own(..)), ..MeshLayer::new(mesh, colors.wall) })
}
