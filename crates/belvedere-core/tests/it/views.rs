//! Views: pinholes of both kinds, the earth's curvature, and stages in a chain.

use belvedere_core::map::curved_rays::{CurvedRays, Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::{Aabb, DVec2, DVec3, EarthCurvature, Miss, Pinhole, Projection, Stage, View, ViewError};
use belvedere_testkit::Random;
use belvedere_testkit::laws::{CameraCase, Continuity, MapCase, Similarity};

fn pinhole(s: &Similarity, projection: Projection) -> Pinhole {
    let projection = match projection {
        Projection::Orthographic { height } => Projection::Orthographic { height: s.length(height) },
        perspective => perspective,
    };
    let (eye, target) = (DVec3::new(100.0, -200.0, 900.0), DVec3::new(900.0, 3000.0, 200.0));
    Pinhole::look_at(s.point(eye), s.point(target), s.direction(DVec3::Z), projection, [1280, 720], s.length(1.0), None)
        .unwrap()
}

const PERSPECTIVE: Projection = Projection::Perspective { fov_y: 0.8 };
const ORTHOGRAPHIC: Projection = Projection::Orthographic { height: 2500.0 };

fn earth(s: &Similarity) -> EarthCurvature {
    // A small planet, so that the curvature is large.
    EarthCurvature { eye: s.point(DVec3::new(100.0, -200.0, 900.0)), radius: s.length(2e5), refraction: 0.13 }
}

fn turn(s: &Similarity) -> TurnSpec {
    let eye = DVec3::new(100.0, -200.0, 900.0);
    let ahead = (DVec3::new(900.0, 3000.0, 200.0) - eye).normalize();
    let at = |d: f64| s.point(eye + d * ahead);
    TurnSpec {
        viewpoint: s.point(eye + DVec3::new(500.0, -100.0, 50.0)),
        t0: at(1200.0),
        t1: at(1500.0),
        t2: at(1900.0),
        pencil: Pencil::Parallel { normal: s.direction(ahead) },
        m: Sharpness::Mid,
    }
}

fn both(s: &Similarity) -> View {
    let root = pinhole(s, PERSPECTIVE);
    let rays = CurvedRays::new(&root, Model::Modified, &[turn(s)]).unwrap();
    View::new(root, vec![Stage::EarthCurvature(earth(s)), Stage::CurvedRays(rays)]).unwrap()
}

fn earth_case() -> MapCase<EarthCurvature> {
    let region = Aabb { min: DVec3::new(-9e3, -9e3, -100.0), max: DVec3::new(9e3, 9e3, 4e3) };
    MapCase::new("earth", region, earth)
        .continuity(Continuity::Smooth)
        .upright()
        .identity_at_zero_strength(|| EarthCurvature { refraction: 1.0, ..earth(&Similarity::IDENTITY) })
}

fn case(name: &str, make: impl Fn(&Similarity) -> View + 'static) -> CameraCase {
    CameraCase::new(name, [2.0, 9000.0], make).tolerance_px(1e-8)
}

fn perspective_case() -> CameraCase {
    case("perspective", |s| View::straight(pinhole(s, PERSPECTIVE)))
}

fn orthographic_case() -> CameraCase {
    case("orthographic", |s| View::straight(pinhole(s, ORTHOGRAPHIC)))
}

fn orthographic_earth_case() -> CameraCase {
    case("orthographic, earth", |s| View::new(pinhole(s, ORTHOGRAPHIC), vec![Stage::EarthCurvature(earth(s))]).unwrap())
        .upright()
}

fn both_case() -> CameraCase {
    case("earth and curved rays", both).upright()
}

belvedere_testkit::space_map_laws!(earth_laws, super::earth_case());
belvedere_testkit::camera_laws!(perspective, super::perspective_case());
belvedere_testkit::camera_laws!(orthographic, super::orthographic_case());
belvedere_testkit::camera_laws!(orthographic_earth, super::orthographic_earth_case());
belvedere_testkit::camera_laws!(earth_and_rays, super::both_case());

/// The conventions, by hand: focal length from the vertical field of view, principal point in the middle, x right, y down.
#[test]
fn pixels_are_as_documented() {
    let fov_y = 60f64.to_radians();
    let camera =
        Pinhole::look_at(DVec3::ZERO, DVec3::Y, DVec3::Z, Projection::Perspective { fov_y }, [800, 600], 1.0, None)
            .unwrap();
    let view = View::straight(camera);
    let f = 300.0 / 30f64.to_radians().tan();
    let at = view.project(DVec3::new(2.0, 10.0, 1.0)).unwrap();
    assert!((at.pixel - DVec2::new(400.0 + 0.2 * f, 300.0 - 0.1 * f)).length() < 1e-10);
    assert_eq!((at.depth, at.segment, at.folded), (10.0, 0, false));
    let top = view.project(DVec3::new(0.0, 10.0, 10.0 * 30f64.to_radians().tan())).unwrap();
    assert!(top.pixel.y.abs() < 1e-10, "the field of view ends at the image's edge");
}

#[test]
fn orthographic_pixels_do_not_depend_on_depth() {
    let view = View::straight(pinhole(&Similarity::IDENTITY, ORTHOGRAPHIC));
    let ph = view.pinhole();
    let near = view.project(ph.eye + 10.0 * ph.forward + 1250.0 * ph.down).unwrap();
    let far = view.project(ph.eye + 5000.0 * ph.forward + 1250.0 * ph.down).unwrap();
    assert!((near.pixel - far.pixel).length() < 1e-9 && (near.pixel.y - 720.0).abs() < 1e-9);
    assert_eq!(view.project(ph.eye - ph.forward), Err(Miss::BehindEye));
}

#[test]
fn stages_out_of_order_are_refused() {
    let root = pinhole(&Similarity::IDENTITY, PERSPECTIVE);
    let rays = CurvedRays::new(&root, Model::Modified, &[]).unwrap();
    let stages = vec![Stage::CurvedRays(rays), Stage::EarthCurvature(earth(&Similarity::IDENTITY))];
    assert!(matches!(View::new(root, stages), Err(ViewError::Order { first: "curved_rays", second: "earth" })));
}

#[test]
fn edge_error_of_two_stages_covers_both() {
    let view = both(&Similarity::IDENTITY);
    let mut random = Random::new(17);
    let mut bent = 0;
    for _ in 0..3000 {
        let pixel = DVec2::new(random.range(0.0, 1280.0), random.range(0.0, 720.0));
        let p0 = view.ray(pixel).at(random.range(300.0, 6000.0)).unwrap().point;
        let p1 = p0 + random.range(1.0, 600.0) * random.direction();
        let bound = view.edge_error(p0, p1).px;
        let (Ok(d0), Ok(d1)) = (view.displace(p0), view.displace(p1)) else { continue };
        for i in 1..32 {
            let t = f64::from(i) / 32.0;
            let chord = view.pinhole().project(d0.point.lerp(d1.point, t));
            let (Ok((chord, _)), Ok(image)) = (chord, view.project(p0.lerp(p1, t))) else { continue };
            let truth = (image.pixel - chord).length();
            assert!(truth <= bound + 1e-8, "{p0} {p1}: {truth} px, bound {bound}");
            bent += usize::from(truth > 0.1);
        }
    }
    assert!(bent > 1000, "{bent}");
}

#[test]
fn image_box_of_two_stages_is_conservative() {
    let view = both(&Similarity::IDENTITY);
    let mut random = Random::new(18);
    for _ in 0..300 {
        let pixel = DVec2::new(random.range(0.0, 1280.0), random.range(0.0, 720.0));
        let p = view.ray(pixel).at(random.range(500.0, 6000.0)).unwrap().point;
        let bounds = Aabb::of([p, p + 400.0 * random.direction()]);
        let Some(image) = view.image_box(&bounds) else { continue };
        for _ in 0..60 {
            let at = view.project(random.point(&bounds)).unwrap();
            assert!(at.pixel.cmpge(image.min - 1e-8).all() && at.pixel.cmple(image.max + 1e-8).all());
            assert!(at.depth >= image.depth_min - 1e-8 && at.depth <= image.depth_max + 1e-8);
        }
    }
}

/// With other stages the length is found by quadrature: against chords.
#[test]
fn path_length_through_two_stages() {
    let view = both(&Similarity::IDENTITY);
    let ray = view.ray(DVec2::new(300.0, 400.0));
    let n = 20_000;
    let at = |i: u32| ray.at(5000.0 * f64::from(i).max(1e-9) / f64::from(n)).unwrap().point;
    let chords: f64 = (0..n).map(|i| (at(i + 1) - at(i)).length()).sum();
    let length = ray.path_length(5000.0).unwrap();
    assert!((length / chords - 1.0).abs() < 1e-6, "{length} {chords}");
}

#[test]
fn views_without_curved_rays_have_one_record() {
    let view = View::straight(pinhole(&Similarity::IDENTITY, PERSPECTIVE));
    let p = DVec3::new(300.0, 2000.0, 100.0);
    assert_eq!(view.records(), 1);
    assert_eq!(view.displace_in(0, p).unwrap().point, p);
    assert_eq!(view.displace_in(1, p), Err(Miss::OutsideDomain));
    assert_eq!(view.record_margins(0, p), [f64::INFINITY; 2]);
    assert_eq!(view.edge_error(p, p + 100.0).px, 0.0);
}

#[test]
fn the_ground_falls_away_as_on_a_sphere_of_the_refracted_radius() {
    let (radius, refraction) = (6_371_000.0, EarthCurvature::REFRACTION);
    let earth = EarthCurvature { eye: DVec3::new(500.0, -200.0, 3000.0), radius, refraction };
    let refracted = radius / (1.0 - refraction);
    for (distance, within) in [(1_000.0, 1e-6), (10_000.0, 1e-5), (100_000.0, 0.1)] {
        let p = earth.eye + DVec3::new(0.6 * distance, -0.8 * distance, -1000.0);
        let drop = p.z - belvedere_core::SpaceMap::apply(&earth, p).unwrap().z;
        let sphere = refracted - (refracted * refracted - distance * distance).sqrt();
        assert!((drop - sphere).abs() < within, "{distance} m: {drop} m, sphere {sphere} m");
    }
}
