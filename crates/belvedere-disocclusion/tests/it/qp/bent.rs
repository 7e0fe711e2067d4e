//! Rows that follow the later stages of a view.

use belvedere_core::grid::Grid;
use belvedere_core::map::spline::{ReferencePlane, default_pivot};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{DVec2, DVec3, Pinhole, Projection, SplineBend, Stage, View};
use belvedere_disocclusion::TerrainSettings;
use belvedere_disocclusion::internals::{Candidate, LinesOfSight, QpOptions, QpProblem, QpSolver, ViewSight};
use belvedere_disocclusion::internals::{Hierarchy, Smoother};
use belvedere_sight::Field;
use belvedere_testkit::synthetic::mountains;

fn pinhole() -> Pinhole {
    let (eye, look) = (DVec3::new(3100.0, -600.0, 1900.0), DVec3::new(3200.0, 3000.0, 1100.0));
    let lens = Projection::Perspective { fov_y: 40f64.to_radians() };
    Pinhole::look_at(eye, look, DVec3::Z, lens, [640, 360], 1.0, None).unwrap()
}

#[test]
fn points_are_seen_along_the_rays_of_a_spline() {
    let ground = mountains(129, 3);
    let field = Field::new(&ground, |_| 0.0).unwrap();
    let plane = ReferencePlane::level(1000.0);
    let bend = SplineBend::new(
        &pinhole(),
        &PresetDocument::builtin("progressive").unwrap(),
        &plane,
        default_pivot(&pinhole(), &plane),
    )
    .unwrap();
    let view = View::new(pinhole(), vec![Stage::SplineBend(bend)]).unwrap();
    let candidates: Vec<Candidate> = (0..240)
        .map(|i| DVec2::new(45.0 + 0.2 * f64::from(i), 20.0 + 0.37 * f64::from(i % 200)))
        .enumerate()
        .map(|(i, grid)| Candidate::new(i as u32, grid, 1.0))
        .collect();
    let sight = ViewSight::new(&view, &field);
    assert!(sight.straight().is_none());
    let smoother = Smoother::new(33, 33, 4.8, 0.0).unwrap();
    let options = QpOptions::of(&TerrainSettings::default());
    let mut solver = QpSolver::new(&field, &Hierarchy::new(129, 129, 33), smoother, options);
    let got =
        solver.solve(&QpProblem { candidates: &candidates, sight: &sight, target: None, ceilings: None }).unwrap();
    assert!(got.unresolved.is_empty(), "{:?}", got.unresolved);
    assert!(got.active.iter().any(|r| r.candidate.is_some()), "nothing was hidden");
    let delta = Grid::new(field.north_west(), field.spacing() * 4.0, 33, 33, got.u).unwrap().on_facets(field.places());
    for c in &candidates {
        let xy = field.scene_from_grid(c.grid);
        let height = |xy: DVec2| Some(ground.surface_at(xy)? + delta.sample(xy)?);
        let p = xy.extend(height(xy).unwrap() + c.lift);
        let image = view.project(p).unwrap();
        let ray = view.ray(image.pixel);
        for k in 1..3000 {
            let Ok(at) = ray.at(image.depth * f64::from(k) / 3000.0) else { continue };
            let q = at.point;
            if ((q - p).truncate() / field.spacing()).length() > 1.5 {
                let clear = height(q.truncate()).is_none_or(|z| z < q.z);
                assert!(clear, "point {} at {}: the ground covers its ray at {q}", c.id, c.grid);
            }
        }
    }
}

#[test]
fn without_later_stages_lines_are_straight() {
    let field = Field::new(&mountains(33, 3), |_| 0.0).unwrap();
    let sight = ViewSight::new(&View::straight(pinhole()), &field);
    let (eye, z) = sight.straight().unwrap();
    assert_eq!(field.scene_from_grid(eye).extend(z), pinhole().eye);
    let mut line = Vec::new();
    sight.trace(DVec2::new(7.0, 9.0), 1200.0, &mut line);
    assert_eq!(line, [(DVec2::new(7.0, 9.0), 1200.0), (eye, z)]);
}
