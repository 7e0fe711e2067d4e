//! The surface of a city as triangles: roofs, walls, land cover and the ground that all stands on.

use super::draped::draped;
use super::plan::normal;
use crate::MeshFile;
use belvedere_core::polygon::is_inside;
use belvedere_scene::{
    Building, City, CityFace, Color, Heightfield, LandCover, MeshColors, Polygon, StructureKind, Surface, Texturing,
};
use earcut::Earcut;
use glam::{DVec2, DVec3, Vec2};

/// Colours of a city.
#[derive(Debug, Clone, PartialEq)]
pub struct CityColors {
    /// Roofs.
    pub roof: Color,
    /// Walls, and all other faces of buildings that are not roofs.
    pub wall: Color,
    /// The ground between, where there is no terrain.
    pub ground: Color,
    /// Colours of the roofs of single buildings, in the order of the city; walls are lighter. `None`, and beyond the end: as all others.
    pub buildings: Vec<Option<Color>>,
}

impl Default for CityColors {
    fn default() -> Self {
        let [roof, wall, ground] =
            [[186, 110, 86], [236, 228, 214], [232, 229, 220]].map(|[r, g, b]| Color::rgb(r, g, b));
        Self { roof, wall, ground, buildings: Vec::new() }
    }
}

impl CityColors {
    /// Colours of roof and wall of a building.
    fn of(&self, building: usize) -> [Color; 2] {
        let Some(own) = self.buildings.get(building).copied().flatten() else { return [self.roof, self.wall] };
        let lighter = |v: u8| v + ((f32::from(255 - v)) * LIGHTER) as u8;
        [own, Color { r: lighter(own.r), g: lighter(own.g), b: lighter(own.b), ..own }]
    }
}

/// How much lighter walls are than coloured roofs, share of the way to white.
const LIGHTER: f32 = 0.55;

/// The ground reaches beyond the city by this share of its size.
const MARGIN: f64 = 0.15;

/// Least height of a roof over the highest ground under it, or the height of the building if that is less, metres.
const CLEAR_M: f64 = 2.5;
/// Floors higher than this over the base of their building stand on nothing, metres.
const ON_FLOOR_M: f64 = 2.5;
/// Spacing of the samples of the ground under a building, on its outline and (second) within wide outlines, metres.
const LOOK_EVERY_M: f64 = 5.0;
const WIDE_M: f64 = 15.0;
/// Most samples per edge, and most rows and columns of samples within.
const MOST_PARTS: f64 = 40.0;

/// The ground of a city.
#[derive(Clone, Copy)]
pub enum CityGround<'a> {
    /// Terrain, as height at a position; land cover is not drawn.
    Terrain(&'a dyn Fn(DVec2) -> Option<f64>),
    /// A level plate at a height: the city's land cover, which must lie side by side, and these pieces between.
    Plate(f64, &'a [Polygon]),
    /// The same on a surface that is not level.
    Draped(&'a Heightfield, &'a [Polygon]),
}

impl CityGround<'_> {
    /// Height at a position, if it is known there.
    fn at(&self, xy: DVec2) -> Option<f64> {
        match self {
            Self::Terrain(terrain) => terrain(xy),
            Self::Plate(z, _) => Some(*z),
            Self::Draped(field, _) => field.surface_at(xy),
        }
    }
}

/// Triangles of a city in parts: one per building and structure, named by its name or else its id, and one for all the rest.
pub fn surface(city: &City, colors: &CityColors, ground: CityGround<'_>) -> MeshFile {
    let mut out = Builder {
        mesh: MeshFile { format: "city", ..MeshFile::default() },
        colors: Vec::new(),
        worn: Texturing { textures: city.pictures.clone(), ..Texturing::default() },
        earcut: Earcut::new(),
    };
    out.part(String::new());
    if let CityGround::Plate(_, bare) | CityGround::Draped(_, bare) = ground {
        bare.iter().for_each(|p| out.ground(p, ground, colors.ground));
        for area in &city.areas {
            area.polygons.iter().for_each(|p| out.ground(p, ground, cover(area.cover)));
        }
    }
    for (number, building) in city.buildings.iter().enumerate() {
        let [roof, wall] = colors.of(number);
        out.part(if building.name.is_empty() { building.id.clone() } else { building.name.clone() });
        if building.faces.is_empty() {
            let [base, top] = stands(building, ground);
            out.extruded(building, base, top, [roof, wall]);
        } else {
            // Without a base of its own, the heights of a building's surfaces are over the ground.
            let base = if building.base_m.is_some() { 0.0 } else { stands(building, ground)[0] };
            let color = |face: &CityFace| if face.surface == Surface::Roof { roof } else { wall };
            building.faces.iter().for_each(|face| out.face(face, base, color(face)));
            if let (Some(base), CityGround::Draped(field, _)) = (building.base_m, ground) {
                let floors = building.faces.iter().filter(|f| f.surface == Surface::Ground);
                floors.for_each(|floor| out.down_to(floor, base, field, wall));
            }
        }
    }
    for structure in &city.structures {
        out.part(if structure.name.is_empty() { structure.id.clone() } else { structure.name.clone() });
        let color = match structure.kind {
            StructureKind::Bridge => Color::rgb(203, 193, 176),
            StructureKind::Vegetation => Color::rgb(126, 158, 104),
            StructureKind::Other => Color::rgb(206, 202, 194),
        };
        structure.faces.iter().for_each(|face| out.face(face, 0.0, color));
    }
    let texturing = Some(out.worn).filter(|worn| !worn.textures.is_empty());
    MeshFile { colors: MeshColors::PerTriangle(out.colors), texturing, ..out.mesh }
}

fn cover(cover: LandCover) -> Color {
    match cover {
        LandCover::Other => Color::rgb(226, 221, 208),
        LandCover::Green => Color::rgb(190, 209, 158),
        LandCover::Forest => Color::rgb(148, 180, 126),
        LandCover::Water => Color::rgb(142, 184, 214),
        LandCover::Rail => Color::rgb(188, 182, 176),
        LandCover::Road => Color::rgb(207, 203, 196),
    }
}

/// Least and largest corner of the plate under a city, with its margin; `None` without any position.
pub fn plate_extent(city: &City) -> Option<[DVec2; 2]> {
    let of = |polygons: &[Polygon]| polygons.iter().flat_map(|p| p.outer.clone()).collect::<Vec<_>>();
    let faces = city.structures.iter().flat_map(|s| &s.faces).flat_map(|f| &f.rings).flatten().map(|p| p.truncate());
    let footprints = city.buildings.iter().flat_map(|b| of(&b.footprint));
    let all = footprints.chain(city.areas.iter().flat_map(|a| of(&a.polygons))).chain(faces);
    let [low, high] = all.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[lo, hi], p| [lo.min(p), hi.max(p)]);
    let margin = DVec2::splat(MARGIN * (high - low).max_element() + 1.0);
    (low.is_finite() && high.is_finite()).then(|| [low - margin, high + margin])
}

/// Heights of the foot of the walls and of the flat roof of a building. On a slope the roof lies over the highest ground, too.
fn stands(building: &Building, ground: CityGround<'_>) -> [f64; 2] {
    let height = building.height_m;
    if let (CityGround::Plate(z, _), base) = (ground, building.base_m) {
        let base = base.unwrap_or(z);
        return [base, base + height];
    }
    let under = || building.footprint.iter().flat_map(places_under).filter_map(|xy| ground.at(xy));
    let [low, high] = under().fold([f64::MAX, f64::MIN], |[a, b], z| [a.min(z), b.max(z)]);
    match (building.base_m, ground) {
        // Walls of buildings with ground of their own go down to the surface that is drawn.
        (Some(base), CityGround::Draped(..)) => [base.min(low), base + height],
        (Some(base), _) => [base, base + height],
        (None, _) if low > high => [0.0, height],
        (None, _) => [low, (low + height).max(high + height.min(CLEAR_M))],
    }
}

/// Samples of the ground under an outline: its corners, points along its edges and, if it is wide, points within.
fn places_under(polygon: &Polygon) -> impl Iterator<Item = DVec2> + '_ {
    let along = |k: usize| {
        let [a, b] = [polygon.outer[k], polygon.outer[(k + 1) % polygon.outer.len()]];
        let parts = (a.distance(b) / LOOK_EVERY_M).ceil().clamp(1.0, MOST_PARTS);
        (0..parts as usize).map(move |i| a.lerp(b, i as f64 / parts))
    };
    let [low, high] = polygon.outer.iter().fold([DVec2::MAX, DVec2::MIN], |[a, b], p| [a.min(*p), b.max(*p)]);
    let parts = ((high - low) / WIDE_M).floor().clamp(DVec2::ZERO, DVec2::splat(MOST_PARTS)).as_uvec2();
    let step = (high - low) / (parts + 1).as_dvec2();
    let grid = (1..=parts.x).flat_map(move |x| (1..=parts.y).map(move |y| low + step * glam::uvec2(x, y).as_dvec2()));
    (0..polygon.outer.len()).flat_map(along).chain(grid.filter(|p| is_inside([&polygon.outer], *p)))
}

struct Builder {
    mesh: MeshFile,
    colors: Vec<Color>,
    /// Pictures on the triangles.
    worn: Texturing,
    earcut: Earcut<f64>,
}

impl Builder {
    /// Starts a new part.
    fn part(&mut self, name: String) {
        self.mesh.names.push(name);
    }

    fn triangle(&mut self, corners: [u32; 3], color: Color) {
        self.worn.of_triangle.push(Texturing::NONE);
        self.worn.corners.push([Vec2::ZERO; 3]);
        self.mesh.triangles.push(corners);
        self.colors.push(color);
        self.mesh.parts.push(self.mesh.names.len() as u32 - 1);
    }

    /// Rings in space, outer first, in the plane that fits the first.
    fn rings(&mut self, rings: &[Vec<DVec3>], color: Color) {
        let Some(outer) = rings.first() else { return };
        let n = normal(outer);
        // Projected along the axis nearest to the face's normal.
        let axis = n.abs().to_array();
        let drop = (0..3).max_by(|a, b| axis[*a].total_cmp(&axis[*b])).unwrap_or(2);
        let [u, v] = [(drop + 1) % 3, (drop + 2) % 3];
        let first = self.mesh.positions.len() as u32;
        let flat: Vec<[f64; 2]> = rings.iter().flatten().map(|p| [p[u] - outer[0][u], p[v] - outer[0][v]]).collect();
        let mut holes = Vec::new();
        let mut count = 0;
        for ring in &rings[..rings.len() - 1] {
            count += ring.len() as u32;
            holes.push(count);
        }
        let mut corners: Vec<u32> = Vec::new();
        self.earcut.earcut(flat.iter().copied(), &holes, &mut corners);
        self.mesh.positions.extend(rings.iter().flatten());
        for t in corners.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|k| flat[k as usize]);
            let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            let turned = (area < 0.0) != (n[drop] < 0.0);
            let [b, c] = if turned { [t[2], t[1]] } else { [t[1], t[2]] };
            self.triangle([first + t[0], first + b, first + c], color);
        }
    }

    fn face(&mut self, face: &CityFace, base: f64, color: Color) {
        let [triangle, vertex] = [self.mesh.triangles.len(), self.mesh.positions.len()];
        // Pictures multiply the colour.
        let color = if face.picture.is_some() { Color::rgb(255, 255, 255) } else { color };
        self.rings(&face.rings, color);
        self.mesh.positions[vertex..].iter_mut().for_each(|p| p.z += base);
        let Some(picture) = &face.picture else { return };
        let places: Vec<Vec2> = picture.rings.iter().flatten().copied().collect();
        for i in triangle..self.mesh.triangles.len() {
            let place = |v: u32| places.get(v as usize - vertex).copied().unwrap_or_default();
            self.worn.of_triangle[i] = picture.number;
            self.worn.corners[i] = self.mesh.triangles[i].map(place);
        }
    }

    /// A piece of the ground.
    fn ground(&mut self, polygon: &Polygon, ground: CityGround<'_>, color: Color) {
        let z = if let CityGround::Plate(z, _) = ground { z } else { 0.0 };
        let [vertex, triangle] = [self.mesh.positions.len(), self.mesh.triangles.len()];
        self.flat(polygon, z, color);
        let CityGround::Draped(field, _) = ground else { return };
        let flat =
            self.mesh.triangles[triangle..].iter().map(|t| t.map(|v| self.mesh.positions[v as usize].truncate()));
        let pieces: Vec<Vec<DVec3>> = flat.flat_map(|t| draped(&t, field)).collect();
        self.mesh.positions.truncate(vertex);
        self.truncate_triangles(triangle);
        for piece in pieces {
            let first = self.mesh.positions.len() as u32;
            (2..piece.len() as u32).for_each(|k| self.triangle([first, first + k - 1, first + k], color));
            self.mesh.positions.extend(piece);
        }
    }

    fn truncate_triangles(&mut self, to: usize) {
        self.mesh.triangles.truncate(to);
        self.mesh.parts.truncate(to);
        self.colors.truncate(to);
        self.worn.of_triangle.truncate(to);
        self.worn.corners.truncate(to);
    }

    /// Walls from the floor of a building, near its base, down to the ground where that is lower.
    fn down_to(&mut self, floor: &CityFace, base: f64, field: &Heightfield, color: Color) {
        for ring in &floor.rings {
            for (k, a) in ring.iter().enumerate() {
                let b = ring[(k + 1) % ring.len()];
                let low = [a, &b].map(|p| field.surface_at(p.truncate()).unwrap_or(p.z).min(p.z));
                if a.z.max(b.z) > base + ON_FLOOR_M || (a.z - low[0]).max(b.z - low[1]) < 0.01 {
                    continue;
                }
                // Floors are turned down: seen from outside their edges run the other way.
                let first = self.mesh.positions.len() as u32;
                self.mesh.positions.extend([b.with_z(low[1]), a.with_z(low[0]), *a, b]);
                self.triangle([first, first + 1, first + 2], color);
                self.triangle([first, first + 2, first + 3], color);
            }
        }
    }

    fn flat(&mut self, polygon: &Polygon, z: f64, color: Color) {
        let rings = std::iter::once(&polygon.outer).chain(&polygon.holes);
        let rings: Vec<Vec<DVec3>> = rings.map(|ring| ring.iter().map(|p| p.extend(z)).collect()).collect();
        self.rings(&rings, color);
    }

    /// Walls over the footprint, and a flat roof.
    fn extruded(&mut self, building: &Building, base: f64, top: f64, [roof, wall]: [Color; 2]) {
        for polygon in &building.footprint {
            self.flat(polygon, top, roof);
            for ring in std::iter::once(&polygon.outer).chain(&polygon.holes) {
                for (k, a) in ring.iter().enumerate() {
                    let b = ring[(k + 1) % ring.len()];
                    let first = self.mesh.positions.len() as u32;
                    self.mesh.positions.extend([a.extend(base), b.extend(base), b.extend(top), a.extend(top)]);
                    self.triangle([first, first + 1, first + 2], wall);
                    self.triangle([first, first + 2, first + 3], wall);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
