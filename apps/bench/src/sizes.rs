//! Scenes of the sizes that Cui et al. 2010 measure: blocks, a molecule's surface, a canyon, a city.

use crate::scene::{ground, views};
use anyhow::{Result, bail};
use belvedere::core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere::core::{CurvedRays, DVec3, Stage, View};
use belvedere::scene::{Color, Layer, LayerKind, Mesh, MeshColors, MeshLayer, OwnLayer, Scene};

/// Names of the scenes.
pub const NAMES: [&str; 4] = ["blocks", "molecule", "canyon", "city"];

/// Half the extent of every scene, metres: that of the bench's ground.
const HALF: f64 = 5_120.0;

/// A scene by name.
///
/// * `blocks`: 3 600 houses, 86 400 vertices, 43 200 triangles.
/// * `molecule`: 12 900 balls, 2.09 million vertices, 4.13 million triangles.
/// * `canyon`: ground of 1042 x 1042 nodes, 2.17 million triangles.
/// * `large_blocks`: 64 houses of 768 m, whose edges a bend curves visibly; not of the paper.
/// * `city`: 862 500 houses whose triangles share no vertex, 31 million vertices, 10.35 million triangles.
///
/// # Errors
/// Another name.
pub fn sized(name: &str) -> Result<Scene> {
    match name {
        "blocks" => mesh_of(houses(3_600, false)),
        "large_blocks" => mesh_of(houses(64, false)),
        "molecule" => mesh_of(balls(12_900)),
        "canyon" => ground(1042),
        "city" => mesh_of(houses(862_500, true)),
        _ => bail!("\"{name}\" is unknown; possible: {}", NAMES.join(", ")),
    }
}

/// The straight view, that with a kink and that with a curve, of one turn.
///
/// # Errors
/// An image without pixels.
pub fn sized_views(image: [u32; 2]) -> Result<[(&'static str, View); 3]> {
    let [(_, straight), ..] = views(image)?;
    let camera = straight.pinhole().clone();
    let at = |y: f64| DVec3::new(0.0, y, 0.0);
    let turn = TurnSpec {
        viewpoint: camera.eye + DVec3::Z * 2000.0,
        t0: at(-1500.0),
        t1: at(0.0),
        t2: at(1500.0),
        pencil: Pencil::Parallel { normal: -DVec3::Y },
        m: Sharpness::Bend,
    };
    let bent = |model| -> Result<View> {
        let rays = CurvedRays::new(&camera, model, &[turn])?;
        Ok(View::new(camera.clone(), vec![Stage::CurvedRays(rays)])?)
    };
    Ok([("straight", straight), ("c0", bent(Model::C0)?), ("curved", bent(Model::Modified)?)])
}

/// Vertices and triangles of a scene.
pub fn counts(scene: &Scene) -> [usize; 2] {
    let of = |layer: &Layer| match &layer.kind {
        LayerKind::Mesh(m) | LayerKind::Own(OwnLayer { surface: m, .. }) => {
            [m.mesh.positions().len(), m.mesh.triangles().len()]
        }
        LayerKind::Terrain(t) => {
            let (cols, rows) = (t.heightfield.cols(), t.heightfield.rows());
            [cols * rows, 2 * (cols - 1) * (rows - 1)]
        }
        _ => [0, 0],
    };
    scene.layers.iter().map(of).fold([0, 0], |a, b| [a[0] + b[0], a[1] + b[1]])
}

type Surface = (Vec<DVec3>, Vec<[u32; 3]>);

fn mesh_of((positions, triangles): Surface) -> Result<Scene> {
    let mesh = Mesh::new(&positions, triangles, MeshColors::Layer)?;
    let kind = LayerKind::Mesh(MeshLayer::new(mesh, Color::rgb(214, 205, 190)));
    Ok(Scene { layers: vec![Layer { id: "mesh".into(), must_see: false, kind }], ..Scene::default() })
}

/// A pseudo-random number in 0..1, the same for the same `i` (integer hash).
fn scattered(i: usize) -> f64 {
    let mut x = (i as u64).wrapping_add(0x9e37_79b9_7f4a_7c15).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x ^= x >> 29;
    x = x.wrapping_mul(0x94d0_49bb_1331_11eb);
    (x >> 40) as f64 / f64::from(1u32 << 24)
}

/// Houses on a square grid, 24 vertices each, or 36 if triangles share none.
fn houses(count: usize, unshared: bool) -> Surface {
    let side = (count as f64).sqrt().ceil() as usize;
    let spacing = 2.0 * HALF / side as f64;
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..count {
        let base = DVec3::new((i % side) as f64, (i / side) as f64, 0.0) * spacing - DVec3::new(HALF, HALF, 0.0);
        let size = DVec3::new(0.6 * spacing, 0.6 * spacing, spacing * (0.4 + 1.2 * scattered(i)));
        for axis in 0..3 {
            let [u, v] = [(axis + 1) % 3, (axis + 2) % 3].map(|a| DVec3::AXES[a] * size);
            for far in [false, true] {
                let corner = base + if far { DVec3::AXES[axis] * size } else { DVec3::ZERO };
                let mut quad = [corner, corner + u, corner + u + v, corner + v];
                if !far {
                    quad.reverse();
                }
                let first = positions.len() as u32;
                if unshared {
                    positions.extend([0, 1, 2, 0, 2, 3].map(|k: usize| quad[k]));
                    triangles.extend([[first, first + 1, first + 2], [first + 3, first + 4, first + 5]]);
                } else {
                    positions.extend(quad);
                    triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
                }
            }
        }
    }
    (positions, triangles)
}

/// Balls along a double helix, 162 vertices and 320 triangles each.
fn balls(count: usize) -> Surface {
    let (ball, faces) = icosphere();
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..count {
        let along = i as f64 / count as f64;
        let turn = 60.0 * std::f64::consts::TAU * along + std::f64::consts::PI * (i % 2) as f64;
        let wide = 0.12 + 0.12 * scattered(i);
        let (sin, cos) = turn.sin_cos();
        let centre = DVec3::new(HALF * wide * 3.5 * cos, HALF * (1.9 * along - 0.95), HALF * wide * sin);
        let radius = 40.0 + 20.0 * scattered(i + count);
        let first = positions.len() as u32;
        positions.extend(ball.iter().map(|p| centre + radius * *p));
        triangles.extend(faces.iter().map(|t| t.map(|k| first + k)));
    }
    (positions, triangles)
}

/// An icosahedron whose faces are split twice.
fn icosphere() -> Surface {
    let g = 0.5 * (1.0 + 5f64.sqrt());
    let mut points: Vec<DVec3> = (0..12usize)
        .map(|i| {
            let [a, b] = [i & 1, i >> 1 & 1].map(|bit| if bit == 1 { 1.0 } else { -1.0 });
            match i / 4 {
                0 => DVec3::new(0.0, a, b * g),
                1 => DVec3::new(a, b * g, 0.0),
                _ => DVec3::new(b * g, 0.0, a),
            }
            .normalize()
        })
        .collect();
    let near = |a: DVec3, b: DVec3| (1.0..1.2).contains(&a.distance(b));
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for (a, b, c) in (0..12).flat_map(|a| (a + 1..12).flat_map(move |b| (b + 1..12).map(move |c| (a, b, c)))) {
        let [p, q, r] = [a, b, c].map(|i: usize| points[i]);
        if near(p, q) && near(q, r) && near(r, p) {
            let outward = (q - p).cross(r - p).dot(p) > 0.0;
            faces.push(if outward { [a as u32, b as u32, c as u32] } else { [a as u32, c as u32, b as u32] });
        }
    }
    for _ in 0..2 {
        let mut middles = std::collections::BTreeMap::new();
        let mut split = Vec::new();
        for [a, b, c] in faces {
            let mut middle = |i: u32, j: u32| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    points.push((points[i as usize] + points[j as usize]).normalize());
                    points.len() as u32 - 1
                })
            };
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            split.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        faces = split;
    }
    (points, faces)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_have_the_sizes_of_the_paper() {
        assert_eq!(counts(&sized("blocks").unwrap()), [86_400, 43_200]);
        let (points, faces) = icosphere();
        assert_eq!((points.len(), faces.len()), (162, 320));
        assert!(faces.iter().all(|f| {
            let [a, b, c] = f.map(|k| points[k as usize]);
            (b - a).cross(c - a).dot(a) > 0.0
        }));
        assert!(sized("town").is_err());
    }
}
