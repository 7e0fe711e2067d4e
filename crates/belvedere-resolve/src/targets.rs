//! Targets by name: a point, a layer, a part of one, atoms.

use crate::BelvedereError;
use belvedere_construct::rays::Target;
use belvedere_core::DVec3;
use belvedere_scene::molecule::Selection;
use belvedere_scene::{MeshLayer, Scene};

/// The point of `x,y,z`; `None` for other texts.
pub fn point(see: &str) -> Option<DVec3> {
    let numbers: Vec<f64> = see.split(',').map(|n| n.trim().parse().ok()).collect::<Option<_>>()?;
    match numbers[..] {
        [x, y, z] => Some(DVec3::new(x, y, z)).filter(|p| p.is_finite()),
        _ => None,
    }
}

/// The target with a name: a point, a layer by its id, a part of a mesh or a box of a layer, or a selection of atoms.
///
/// # Errors
/// [`BelvedereError::Target`] for a name of nothing, or of something that cannot be looked for.
pub fn target(scene: &Scene, see: &str) -> Result<Target, BelvedereError> {
    if let Some(point) = point(see) {
        return Ok(Target::points([point]));
    }
    let layer = |same: fn(&str, &str) -> bool| scene.layers.iter().position(|l| same(&l.id, see));
    if let Some(index) = layer(|a, b| a == b).or_else(|| layer(str::eq_ignore_ascii_case)) {
        return Target::layer(scene, index).ok_or_else(|| {
            BelvedereError::Target(format!(
                "layer \"{see}\" cannot be looked for: it is ground, an area, or holds nothing"
            ))
        });
    }
    if let Some(target) = part(scene, see) {
        return Ok(target);
    }
    let molecules = scene.layers.iter().enumerate().filter_map(|(index, l)| l.kind.molecule().map(|m| (index, m)));
    let mut complaint = None;
    for (index, layer) in molecules {
        match Selection::parse(see) {
            Ok(selection) => {
                let mask = selection.mask(&layer.molecule);
                let atoms: Vec<usize> = (0..mask.len()).filter(|i| mask[*i]).collect();
                if let Some(target) = Target::atoms(scene, index, &atoms) {
                    return Ok(target);
                }
                let what = if atoms.is_empty() { "no atom is meant by" } else { "no atom is drawn of those meant by" };
                complaint = Some(format!("{what} \"{see}\""));
            }
            Err(e) => complaint = Some(e.to_string()),
        }
    }
    let ids = scene.layers.iter().map(|l| l.id.as_str());
    let ids: Vec<&str> = ids.chain(meshes(scene).flat_map(|(_, m)| &m.names).map(String::as_str)).collect();
    let complaint = complaint.map_or_else(String::new, |c| format!(", and as atoms: {c}"));
    Err(BelvedereError::Target(format!(
        "\"{see}\" is no layer of the scene and no part of a mesh{complaint}; {}; or give a point x,y,z",
        belvedere_document::suggestion(see, &ids)
    )))
}

/// The parts of a mesh with a name, of the first mesh that has such parts; or `LAYER/NUMBER`, a box of a layer, counted from 1.
pub fn part(scene: &Scene, name: &str) -> Option<Target> {
    if let Some((layer, number)) = name.rsplit_once('/')
        && let (Some(index), Ok(number)) = (scene.layers.iter().position(|l| l.id == layer), number.parse::<u32>())
        && scene.layers[index].kind.boxes().is_some()
    {
        return Target::parts(scene, index, &[number.checked_sub(1)?]);
    }
    meshes(scene).find_map(|(index, mesh)| Target::parts(scene, index, &mesh.parts_named(name)))
}

fn meshes(scene: &Scene) -> impl Iterator<Item = (usize, &MeshLayer)> {
    scene.layers.iter().enumerate().filter_map(|(index, layer)| layer.kind.mesh().map(|mesh| (index, mesh)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_three_numbers_and_nothing_else() {
        assert_eq!(point("1, -2.5,3e1"), Some(DVec3::new(1.0, -2.5, 30.0)));
        for other in ["1,2", "1,2,3,4", "a,1,2,3", "1,2,x", "nan,1,2", "chain A"] {
            assert_eq!(point(other), None, "{other}");
        }
    }
}
