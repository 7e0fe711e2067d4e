//! A small church as a mesh: nave with a pitched roof, round apse, tower with an eight-sided spire.

use super::{BuiltinError, SuggestedCamera};
use belvedere_core::DVec3;
use belvedere_scene::{Color, Crs, Layer, LayerKind, Mesh, MeshColors, MeshLayer, Scene, Unit};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const WALL: Color = Color::rgb(222, 205, 176);
const STONE: Color = Color::rgb(198, 184, 160);
const TILES: Color = Color::rgb(168, 84, 62);
const COPPER: Color = Color::rgb(96, 150, 130);

/// Half the width of the nave, the heights of its wall and its ridge; the ends of the nave along x, metres.
const HALF: f64 = 9.0;
const WALL_M: f64 = 13.0;
const RIDGE_M: f64 = 22.0;
const NAVE: [f64; 2] = [-16.0, 20.0];

/// The church: on the ground around the origin, its length along x, 64 m high.
///
/// # Errors
/// None in practice: the mesh is well formed.
pub fn church() -> Result<(Scene, SuggestedCamera), BuiltinError> {
    let mut builder = Builder::default();
    builder.nave();
    builder.apse();
    builder.tower();
    let mesh = Mesh::new(&builder.positions, builder.triangles, MeshColors::PerTriangle(builder.colors))?;
    let kind = LayerKind::Mesh(MeshLayer::new(mesh, WALL));
    let layers = vec![Layer { id: "church".into(), must_see: false, kind }];
    let title = "A church".to_owned();
    let (eye, look_at) = (DVec3::new(80.0, -120.0, 55.0), DVec3::new(0.0, 0.0, 24.0));
    let camera = SuggestedCamera { title: title.clone(), eye, look_at, fov_y: 40f64.to_radians() };
    Ok((Scene { title, crs: Crs::Local, unit: Unit::Metre, layers, ..Scene::default() }, camera))
}

#[derive(Default)]
struct Builder {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    colors: Vec<Color>,
}

impl Builder {
    /// Adds a flat polygon, its corners counter-clockwise from outside.
    fn face(&mut self, corners: &[DVec3], color: Color) {
        let first = self.positions.len() as u32;
        self.positions.extend(corners);
        for k in 1..corners.len() as u32 - 1 {
            self.triangles.push([first, first + k, first + k + 1]);
            self.colors.push(color);
        }
    }

    /// Adds the walls between rings of corners of equal number, counter-clockwise from above, lower ring first.
    fn walls(&mut self, low: &[DVec3], high: &[DVec3], color: Color) {
        for i in 0..low.len() {
            let k = (i + 1) % low.len();
            self.face(&[low[i], low[k], high[k], high[i]], color);
        }
    }

    fn nave(&mut self) {
        let at = |x: usize, y: f64, z: f64| DVec3::new(NAVE[x], y, z);
        for side in [1.0, -1.0] {
            let mut wall = [(0, 0.0), (1, 0.0), (1, WALL_M), (0, WALL_M)].map(|(x, z)| at(x, -side * HALF, z));
            let roof = [(0, HALF, WALL_M), (1, HALF, WALL_M), (1, 0.0, RIDGE_M), (0, 0.0, RIDGE_M)];
            let mut roof = roof.map(|(x, y, z)| at(x, -side * y, z));
            if side < 0.0 {
                wall.reverse();
                roof.reverse();
            }
            self.face(&wall, WALL);
            self.face(&roof, TILES);
        }
        let gable = [(-HALF, 0.0), (HALF, 0.0), (HALF, WALL_M), (0.0, RIDGE_M), (-HALF, WALL_M)];
        self.face(&gable.map(|(y, z)| at(1, y, z)), WALL);
        self.face(&gable.map(|(y, z)| at(0, -y, z)), WALL);
    }

    fn apse(&mut self) {
        const SIDES: usize = 12;
        let (radius, wall) = (7.0, 10.0);
        let at = |i: usize, r: f64, z: f64| {
            let angle = FRAC_PI_2 - PI * i as f64 / SIDES as f64;
            DVec3::new(NAVE[1] + r * angle.cos(), -r * angle.sin(), z)
        };
        for i in 0..SIDES {
            self.face(
                &[at(i, radius, 0.0), at(i + 1, radius, 0.0), at(i + 1, radius, wall), at(i, radius, wall)],
                WALL,
            );
            // A quarter of a sphere in rings.
            let ring = |k: usize| {
                let up = FRAC_PI_2 * k as f64 / 4.0;
                (radius * up.cos(), wall + radius * up.sin())
            };
            for k in 0..4 {
                let ((r0, z0), (r1, z1)) = (ring(k), ring(k + 1));
                self.face(&[at(i, r0, z0), at(i + 1, r0, z0), at(i + 1, r1, z1), at(i, r1, z1)], COPPER);
            }
        }
    }

    fn tower(&mut self) {
        let (x, half, top) = (NAVE[0] - 2.0, 5.0, 36.0);
        let square = |z: f64| {
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(u, v)| DVec3::new(x + u * half, v * half, z))
        };
        self.walls(&square(0.0), &square(top), STONE);
        self.face(&square(top), STONE);
        let eight = |r: f64, z: f64| -> Vec<DVec3> {
            let corner = |i: u32| TAU * (f64::from(i) + 0.5) / 8.0;
            (0..8).map(|i| DVec3::new(x + r * corner(i).cos(), r * corner(i).sin(), z)).collect()
        };
        self.walls(&eight(4.6, top), &eight(4.6, 42.0), STONE);
        self.walls(&eight(5.2, 42.0), &eight(0.0, 64.0), COPPER);
        let mut eaves = eight(5.2, 42.0);
        eaves.reverse();
        self.face(&eaves, COPPER);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_face_of_the_church_looks_outwards() {
        let (scene, camera) = church().unwrap();
        let LayerKind::Mesh(MeshLayer { mesh, .. }) = &scene.layers[0].kind else { panic!("a mesh") };
        assert!(mesh.triangles().len() > 100);
        let bounds = mesh.bounds();
        assert!(bounds.min.z == 0.0 && (bounds.max.z - 64.0).abs() < 1e-5);
        assert!(camera.eye.distance(camera.look_at) > 60.0);
        // A ray from outside, to a point on no face, first meets a face that looks towards it.
        let tree = belvedere_sight::MeshTree::new(mesh);
        let mut hits = 0;
        for i in 0..2000 {
            let angle = f64::from(i) * 2.399_963;
            let eye = DVec3::new(200.0 * angle.cos(), 200.0 * angle.sin(), f64::from(i % 90) + 0.37);
            let target = DVec3::new(f64::from(i % 37) - 18.13, f64::from(i % 13) - 6.07, f64::from(i * 7 % 40) + 0.21);
            if let Some((_, triangle)) = tree.first_crossing(eye, target) {
                hits += 1;
                assert!(mesh.face_normal(triangle).dot(target - eye) < 0.0, "triangle {triangle} from {eye}");
            }
        }
        assert!(hits > 1000, "{hits}");
    }
}
