//! The guarantee of mode `qp` on real mountains, judged by rays that are independent of the solver's rows.
//!
//! A few eyes for each place; `BELVEDERE_EYES=20` judges 20 (minutes).

use belvedere_builtin::valley_route;
use belvedere_core::DVec2;
use belvedere_core::grid::Grid;
use belvedere_disocclusion::TerrainSettings;
use belvedere_disocclusion::internals::{Candidate, QpOptions, QpProblem, QpSolver, StraightSight};
use belvedere_disocclusion::internals::{Field, Hierarchy, Smoother, grid_weight, stated_spacing};
use belvedere_io::load_vectors;
use belvedere_io::vector::lines_on_terrain;
use belvedere_io::{TerrainRequest, load_terrain};
use belvedere_scene::{Heightfield, Progress};
use rayon::prelude::*;

struct Place {
    name: &'static str,
    ground: Heightfield,
    field: Field,
    /// Grid coordinates.
    lines: Vec<Vec<DVec2>>,
}

/// The route is that of a file of vectors, or a valley route of a seed.
fn place(name: &'static str, terrain: &str, vectors: &[&str]) -> Option<Place> {
    let path = belvedere_testkit::data(terrain)?;
    let request = TerrainRequest { fill_voids: true, ..TerrainRequest::default() };
    let loaded = load_terrain(&[path], &request, &Progress::silent()).unwrap().value;
    let ground = loaded.heightfield;
    let mut lines: Vec<Vec<DVec2>> = Vec::new();
    for file in vectors {
        let vectors = load_vectors(&belvedere_testkit::data(file)?).unwrap().value;
        let features = lines_on_terrain(&vectors, loaded.crs, Some(&ground)).unwrap().value;
        lines.extend(features.iter().map(|f| f.points.iter().map(|p| p.truncate()).collect()));
    }
    if vectors.is_empty() {
        lines.push(valley_route(&ground, 7).unwrap());
    }
    let field = Field::new(&ground, |_| 0.0).unwrap();
    for p in lines.iter_mut().flatten() {
        *p = field.grid_from_scene(*p);
    }
    Some(Place { name, ground, field, lines })
}

/// Points along a line, equidistant from its start.
fn along(line: &[DVec2], spacing: f64) -> Vec<DVec2> {
    let (mut out, mut next, mut way) = (Vec::new(), 0.0, 0.0);
    for w in line.windows(2) {
        let length = (w[1] - w[0]).length();
        while next <= way + length && length > 0.0 {
            out.push(w[0].lerp(w[1], (next - way) / length));
            next += spacing;
        }
        way += length;
    }
    out
}

impl Place {
    fn points(&self, spacing: f64) -> Vec<DVec2> {
        let last = DVec2::new((self.field.cols() - 1) as f64, (self.field.rows() - 1) as f64);
        let points = self.lines.iter().flat_map(|l| along(l, spacing));
        points.filter(|p| p.cmpge(DVec2::ZERO).all() && p.cmple(last).all()).collect()
    }

    fn ground_at(&self, g: DVec2) -> Option<f64> {
        self.ground.surface_at(self.field.scene_from_grid(g))
    }

    /// Eye `k`: somewhere beside the route, `200..1500` m above the ground, looking at it.
    fn eye(&self, k: usize, middle: DVec2) -> (DVec2, f64, DVec2) {
        let direction = DVec2::from_angle(2.399_963 * k as f64 + 0.5);
        let last = DVec2::new((self.field.cols() - 1) as f64, (self.field.rows() - 1) as f64);
        let at = (middle - direction * (60.0 + 37.0 * (k % 6) as f64)).clamp(DVec2::splat(1.0), last - 1.0);
        let above = 200.0 * 7.5f64.powf((k * 7 % 20) as f64 / 19.0);
        (at, self.ground_at(at).unwrap_or(self.field.datum() + self.field.relief()) + above, (middle - at).normalize())
    }

    /// Whether a point is seen, by marching: 0.2 cell a step, ground within the guard of the point left out.
    fn sees(&self, delta: &Grid, p: DVec2, eye: (DVec2, f64)) -> bool {
        let height = |g: DVec2| {
            let xy = self.field.scene_from_grid(g);
            Some(self.ground.surface_at(xy)? + delta.sample(xy).unwrap_or(0.0))
        };
        let Some(from) = height(p).map(|z| z + 1.0) else { return false };
        let (way, mut at) = ((eye.0 - p).length(), 1.5);
        while at < way {
            let t = at / way;
            if height(p.lerp(eye.0, t)).is_some_and(|z| z > from + t * (eye.1 - from)) {
                return false;
            }
            at += 0.2;
        }
        true
    }
}

fn solver(place: &Place) -> (QpSolver, Hierarchy) {
    let settings = TerrainSettings::default();
    let hierarchy = Hierarchy::whole(place.field.cols(), place.field.rows(), settings.solver_nodes);
    let (cols, rows) = (hierarchy.cols(), hierarchy.rows());
    let stated_m = stated_spacing(place.field.cols(), place.field.rows(), place.field.spacing());
    let smoother =
        Smoother::new(cols, rows, grid_weight(settings.smoothness(stated_m), hierarchy.intervals()), 0.0).unwrap();
    (QpSolver::new(&place.field, &hierarchy, smoother, QpOptions::of(&settings)), hierarchy)
}

fn keeps_its_promise(place: Option<Place>, far: f64) {
    let Some(place) = place else { return };
    let eyes = std::env::var("BELVEDERE_EYES").ok().and_then(|v| v.parse().ok()).unwrap_or(3);
    let (mut solver, hierarchy) = solver(&place);
    let dense = place.points(0.25);
    let middle = dense[dense.len() / 2];
    for k in 0..eyes {
        solver.reset();
        let (at, z, look) = place.eye(k, middle);
        let in_frame = |p: &DVec2| {
            let d = *p - at;
            d.length() > 4.5 && d.length() < far && d.normalize().dot(look) > 30f64.to_radians().cos()
        };
        let candidates: Vec<Candidate> = dense
            .iter()
            .enumerate()
            .filter(|(_, p)| in_frame(p))
            .map(|(i, p)| Candidate::new(i as u32, *p, 1.0))
            .collect();
        let sight = StraightSight { eye: at, z };
        let got =
            solver.solve(&QpProblem { candidates: &candidates, sight: &sight, target: None, ceilings: None }).unwrap();
        let view = format!("{} eye {k} at {at:.1}, height {z:.0}", place.name);
        assert!(got.unresolved.is_empty(), "{view}: {:?}", got.unresolved);
        let highest = got.u.iter().copied().fold(0.0, f64::max);
        assert!(highest <= 0.5, "{view}: the ground rises by {highest}");
        let (cols, rows) = (hierarchy.cols(), hierarchy.rows());
        let spacing = place.field.spacing() * hierarchy.step();
        let delta = Grid::new(place.field.north_west(), spacing, cols, rows, got.u).unwrap();
        let share = |points: Vec<DVec2>| {
            let seen = points.par_iter().filter(|p| place.sees(&delta, **p, (at, z))).count();
            seen as f64 / points.len().max(1) as f64
        };
        let asked = share(candidates.iter().filter(|c| c.id % 8 == 0).map(|c| c.grid).collect());
        let length = share(place.points(0.2).into_iter().filter(in_frame).collect());
        let before = Grid::new(place.field.north_west(), place.field.spacing(), 2, 2, vec![0.0; 4]).unwrap();
        let hidden = candidates.iter().filter(|c| c.id % 64 == 0 && !place.sees(&before, c.grid, (at, z))).count();
        assert!(asked == 1.0 && length >= 0.99, "{view}: {asked} of the points, {length} of the length");
        assert!(hidden > 0 || got.active.is_empty(), "{view}: nothing was hidden");
    }
}

#[test]
fn andorra_shows_the_gr_11() {
    keeps_its_promise(place("Andorra", "andorra/N42E001.hgt", &["andorra/gr11_andorra_no_elevation.gpx"]), 500.0);
}

#[test]
fn the_gotthard_shows_a_valley_route() {
    keeps_its_promise(place("Gotthard", "gotthard/N46E008.tif", &[]), 500.0);
}

#[test]
fn the_baltoro_shows_a_valley_route() {
    keeps_its_promise(place("Baltoro", "baltoro/baltoro_srtm.tif", &[]), 500.0);
}
