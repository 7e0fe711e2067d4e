//! Rays that separate at seams and merge again.

use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::map::split_rays::{Fork, Merge, Seam, SplitRays, SplitRaysError, SplitSpec};
use belvedere_core::{CurvedRays, CurvedRaysError, DVec2, DVec3, Miss, Pinhole, Projection, Stage, View};
use belvedere_testkit::laws::{CameraCase, Similarity};

const IMAGE: [u32; 2] = [1280, 720];
const MIDDLE: f64 = 640.0;

pub(crate) fn root(s: &Similarity) -> Pinhole {
    let lens = Projection::Perspective { fov_y: 40f64.to_radians() };
    let axis = |v: DVec3| s.vector(v).normalize();
    Pinhole::look_at(s.point(DVec3::ZERO), s.point(DVec3::Y), axis(DVec3::Z), lens, IMAGE, s.scale, None).unwrap()
}

/// Planes across the depth axis at `y` - 5, `y`, `y` + 5.
fn turn(s: &Similarity, viewpoint: [f64; 3], at: [f64; 2]) -> TurnSpec {
    let [x, y] = at;
    let plane = |off: f64| s.point(DVec3::new(x, y + off, 0.0));
    TurnSpec {
        viewpoint: s.point(DVec3::from_array(viewpoint)),
        t0: plane(-5.0),
        t1: plane(0.0),
        t2: plane(5.0),
        pencil: Pencil::Parallel { normal: s.vector(DVec3::Y) },
        m: Sharpness::Bend,
    }
}

fn way(turns: impl Into<Vec<TurnSpec>>) -> SplitSpec {
    SplitSpec { turns: turns.into(), fork: None }
}

fn fork(seam: Seam, left: SplitSpec, right: SplitSpec, merge: Option<Merge>) -> SplitSpec {
    SplitSpec { turns: Vec::new(), fork: Some(Box::new(Fork { seam, sides: [left, right], merge })) }
}

/// Left of the middle rays lean left, right of it they lean right.
pub(crate) fn parting(s: &Similarity) -> SplitSpec {
    let side = |x: f64| way([turn(s, [-8.0 * x, 0.0, 0.0], [0.0, 30.0])]);
    fork(Seam::MIDDLE, side(-1.0), side(1.0), None)
}

/// Quarter turns to both sides, whose common lines lie where the other side draws.
fn quarters(s: &Similarity) -> SplitSpec {
    let quarter = |side: f64| {
        let p = |x: f64, y: f64| s.point(DVec3::new(side * x, y, 0.0));
        way([TurnSpec {
            viewpoint: p(-40.0, 45.0),
            t0: p(0.0, 30.0),
            t1: p(0.0, 45.0),
            t2: p(10.0, 50.0),
            pencil: Pencil::Line { point: p(20.0, 25.0), dir: s.vector(DVec3::Z) },
            m: Sharpness::Bend,
        }])
    };
    fork(Seam::MIDDLE, quarter(-1.0), quarter(1.0), None)
}

/// Round an obstacle: outwards by `out`, back again as from a viewpoint `back` ahead, merged from about y = 80 on.
fn round(s: &Similarity, out: [f64; 2], back: [f64; 2]) -> SplitSpec {
    let side = |side: f64, out: f64, back: f64| {
        let x = side * 1.5 * out;
        way([turn(s, [-side * out, 0.0, 0.0], [0.0, 20.0]), turn(s, [x + side * 2.0 * out, back, 0.0], [x, 50.0])])
    };
    let merge = Merge { viewpoint: s.point(DVec3::new(0.0, -20.0, 0.0)), reach: 4.0 * s.scale };
    fork(Seam::MIDDLE, side(-1.0, out[0], back[0]), side(1.0, out[1], back[1]), Some(merge))
}

fn view(s: &Similarity, model: Model, spec: &SplitSpec) -> View {
    let root = root(s);
    let rays = SplitRays::new(&root, model, spec).unwrap();
    View::new(root, vec![Stage::SplitRays(rays)]).unwrap()
}

fn here(spec: &SplitSpec) -> View {
    view(&Similarity::IDENTITY, Model::Modified, spec)
}

fn case(name: &str, model: Model, spec: fn(&Similarity) -> SplitSpec, far: f64) -> CameraCase {
    let make = move |s: &Similarity| view(s, model, &spec(s));
    CameraCase::new(format!("{name} {model:?}"), [1.5, far], make).overlapping().samples(300)
}

fn round_evenly(s: &Similarity) -> SplitSpec {
    round(s, [4.0, 4.0], [10.0, 10.0])
}

belvedere_testkit::camera_laws!(
    parting_modified,
    super::case("parting", super::Model::Modified, super::parting, 150.0)
);
belvedere_testkit::camera_laws!(
    parting_original,
    super::case("parting", super::Model::Original, super::parting, 150.0)
);
belvedere_testkit::camera_laws!(parting_c0, super::case("parting", super::Model::C0, super::parting, 150.0));
belvedere_testkit::camera_laws!(
    round_modified,
    super::case("round", super::Model::Modified, super::round_evenly, 150.0)
);
belvedere_testkit::camera_laws!(round_c2, super::case("round", super::Model::C2, super::round_evenly, 150.0));
belvedere_testkit::camera_laws!(
    quarters_modified,
    super::case("quarters", super::Model::Modified, super::quarters, 40.0)
);

#[test]
fn each_side_is_the_picture_of_its_own_branch() {
    let id = Similarity::IDENTITY;
    let view = here(&parting(&id));
    let branches = view.split_rays().unwrap().branches();
    assert_eq!(branches.len(), 2);
    for (i, branch) in branches.iter().enumerate() {
        let alone = view.along(branch);
        for pixel in
            [DVec2::new(100.0, 50.0), DVec2::new(639.9, 700.0), DVec2::new(640.1, 3.0), DVec2::new(1200.0, 360.0)]
        {
            assert_eq!(branch.region.contains(pixel), (pixel.x < MIDDLE) == (i == 0));
            if branch.region.contains(pixel) {
                for depth in [3.0, 29.0, 90.0] {
                    assert_eq!(view.ray(pixel).at(depth), alone.ray(pixel).at(depth));
                    let p = alone.ray(pixel).at(depth).unwrap().point;
                    assert_eq!(view.project(p), alone.project(p));
                    assert_eq!(view.jacobian(p), alone.jacobian(p));
                }
                let points =
                    |v: &View| v.ray(pixel).pieces().unwrap().iter().map(|p| p.at(p.depth[0])).collect::<Vec<_>>();
                assert_eq!(points(&view), points(&alone));
            }
        }
    }
}

/// Distance between the rays just left and right of the seam at a height and a depth.
fn gap(view: &View, seam_x: f64, y: f64, depth: f64) -> f64 {
    let at = |x: f64| view.ray(DVec2::new(x, y)).at(depth).unwrap().point;
    at(seam_x - 1e-9).distance(at(seam_x + 1e-9))
}

#[test]
fn rays_run_together_up_to_the_fork_and_part_behind_it() {
    let view = here(&parting(&Similarity::IDENTITY));
    assert!(gap(&view, MIDDLE, 200.0, 24.9) < 1e-9);
    assert!(gap(&view, MIDDLE, 200.0, 60.0) > 10.0);
    // A point in the dead angle has no image, one in front of the fork has one.
    assert_eq!(view.project(DVec3::new(0.0, 60.0, 0.0)), Err(Miss::OutsideDomain));
    assert!(view.project_all(DVec3::new(0.0, 60.0, 0.0)).is_empty());
    assert_eq!(view.project_all(DVec3::new(0.1, 20.0, 0.0)).len(), 1);
}

#[test]
fn after_a_merge_rays_along_the_seam_are_one_whichever_side_they_came_by() {
    for (out, back) in
        [([4.0, 4.0], [10.0, 10.0]), ([4.0, 5.0], [10.0, 10.0]), ([4.0, 4.0], [10.0, 8.0]), ([6.0, 3.0], [9.0, 12.0])]
    {
        let view = here(&round(&Similarity::IDENTITY, out, back));
        let split = view.split_rays().unwrap();
        let fork = split.spec().fork.as_ref().unwrap();
        assert!(fork.merge.is_none() && fork.sides.iter().all(|side| side.turns.len() == 3));
        let seam_x = MIDDLE;
        let viewpoint = fork.sides[1].turns[1].viewpoint;
        assert_eq!(back[0] == back[1], (viewpoint.y - back[1]).abs() < 1e-9, "{viewpoint}");
        for y in [5.0, 200.0, 360.0, 715.0] {
            assert!(gap(&view, seam_x, y, 14.0) < 1e-8);
            assert!(gap(&view, seam_x, y, 50.0) > 5.0, "the obstacle is gone round");
            // Depths differ between the two sides: compare the lines, not the points.
            let line = |x: f64| {
                let ray = view.ray(DVec2::new(x, y));
                [500.0, 900.0].map(|depth| ray.at(depth).unwrap().point)
            };
            let ([a, b], [c, d]) = (line(seam_x - 1e-9), line(seam_x + 1e-9));
            let along = (b - a).normalize();
            for p in [c, d] {
                assert!(
                    (p - a).reject_from(along).length() < 2e-4,
                    "{out:?} {y}: {}",
                    (p - a).reject_from(along).length()
                );
            }
        }
    }
}

#[test]
fn forks_nest_and_their_parts_keep_their_order() {
    let id = Similarity::IDENTITY;
    let lean = |x: f64| way([turn(&id, [-8.0 * x, 0.0, 0.0], [0.0, 60.0])]);
    let level = Seam { from: DVec2::new(0.0, 0.5), to: DVec2::new(1.0, 0.5) };
    let inner =
        SplitSpec { turns: vec![turn(&id, [-4.0, 0.0, 0.0], [0.0, 30.0])], ..fork(level, lean(0.5), lean(1.5), None) };
    let view = here(&fork(Seam::MIDDLE, way([]), inner, None));
    let branches = view.split_rays().unwrap().branches();
    assert_eq!(branches.iter().map(|b| b.rays.turn_count()).collect::<Vec<_>>(), [0, 2, 2]);
    let part = |x: f64, y: f64| branches.iter().position(|b| b.region.contains(DVec2::new(x, y))).unwrap();
    assert_eq!([part(10.0, 10.0), part(10.0, 700.0), part(900.0, 10.0), part(900.0, 700.0)], [0, 0, 1, 2]);
    // The same specification at three times the resolution.
    let finer = Pinhole { image: IMAGE.map(|n| 3 * n), ..root(&id) };
    let again = SplitRays::new(&finer, Model::Modified, view.split_rays().unwrap().spec()).unwrap();
    assert_eq!(
        again.branches()[1].region.corners(),
        branches[1].region.corners().iter().map(|c| 3.0 * *c).collect::<Vec<_>>()
    );
}

#[test]
fn a_side_is_checked_within_its_part_of_the_picture_only() {
    let id = Similarity::IDENTITY;
    let rays = SplitRays::new(&root(&id), Model::Modified, &quarters(&id)).unwrap();
    for branch in rays.branches() {
        let whole = CurvedRays::new(&root(&id), Model::Modified, branch.rays.spec());
        assert!(matches!(whole, Err(CurvedRaysError::EndNotReached { .. })), "{whole:?}");
    }
}

#[test]
fn what_cannot_be_is_said() {
    let id = Similarity::IDENTITY;
    let new = |spec: &SplitSpec| SplitRays::new(&root(&id), Model::Modified, spec).unwrap_err().to_string();
    let says = |spec: &SplitSpec, words: &[&str]| {
        let text = new(spec);
        assert!(words.iter().all(|w| text.contains(w)), "{text}");
    };
    let [left, right] = parting(&id).fork.unwrap().sides;
    let beside = Seam { from: DVec2::new(-0.2, 0.0), to: DVec2::new(-0.2, 1.0) };
    says(&fork(beside, left.clone(), right.clone(), None), &["no pixel on its left side"]);
    let point = Seam { from: DVec2::splat(0.5), to: DVec2::splat(0.5) };
    says(&fork(point, left.clone(), right.clone(), None), &["two points"]);
    let merge = Merge { viewpoint: DVec3::ZERO, reach: 4.0 };
    says(&fork(Seam::MIDDLE, left.clone(), right.clone(), Some(merge)), &["do not meet", "turn back"]);
    says(&fork(Seam::MIDDLE, left.clone(), right.clone(), Some(Merge { reach: 0.0, ..merge })), &["reach is 0"]);
    says(&fork(Seam::MIDDLE, parting(&id), right.clone(), Some(merge)), &["another fork on its left side"]);
    let behind = way([turn(&id, [0.0, 200.0, 0.0], [0.0, 30.0])]);
    says(
        &fork(
            Seam::MIDDLE,
            left.clone(),
            fork(Seam { from: DVec2::new(0.8, 0.0), to: DVec2::new(0.8, 1.0) }, right, behind, None),
            None,
        ),
        &["right, right of the seam, turn 1", "viewpoint 1"],
    );
    // One side returns higher than the other.
    let mut uneven = round(&id, [4.0, 4.0], [10.0, 10.0]);
    let raised = &mut uneven.fork.as_mut().unwrap().sides[1].turns[1].viewpoint;
    raised.z -= 3.0;
    assert!(
        matches!(SplitRays::new(&root(&id), Model::Modified, &uneven), Err(SplitRaysError::UnevenMeeting { off_px, .. }) if off_px > 0.5)
    );
}
