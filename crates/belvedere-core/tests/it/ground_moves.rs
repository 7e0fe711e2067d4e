//! Ground that an author moves: laws, bounds, inversion of great turns, and folds that are refused.

use belvedere_core::map::ground_moves::{GroundMoves, GroundMovesError, MoveNet, NetPlace};
use belvedere_core::{Aabb, DVec2, DVec3, SpaceMap};
use belvedere_testkit::Random;
use belvedere_testkit::laws::{Continuity, Joint, MapCase, Similarity};

const SIZE: usize = 25;
const STEP: f64 = 200.0;

/// A net over 0..=4800 in both directions; `by`: column and row to displacement. A movement of the scene turns it about the vertical by
/// quarters only, for nets lie along the axes.
fn net(by: impl Fn(DVec2) -> DVec3) -> MoveNet {
    let place = NetPlace { first: DVec2::ZERO, step: STEP, size: [SIZE, SIZE] };
    let one = |i: usize| {
        let (x, y) = (i % SIZE, i / SIZE);
        let is_inside = x.min(y) >= 3 && x.max(y) < SIZE - 3;
        if is_inside { by(STEP * DVec2::new(x as f64, y as f64)) } else { DVec3::ZERO }
    };
    MoveNet::new(place, (0..SIZE * SIZE).map(one).collect()).expect("a net")
}

/// A hill that goes east and up.
fn pushed(strength: f64) -> GroundMoves {
    let net = net(|p| {
        let near = (-(p - DVec2::splat(2400.0)).length_squared() / 8e5).exp();
        strength * near * DVec3::new(400.0, -150.0, 300.0)
    });
    GroundMoves::new(net).unwrap_or_else(|e| panic!("{e}"))
}

/// A town that is turned by an angle, less and less around it.
fn turned(angle: f64) -> Result<GroundMoves, GroundMovesError> {
    let middle = DVec2::splat(2400.0);
    GroundMoves::new(net(|p| {
        let near = (1.0 - (p - middle).length() / 2000.0).clamp(0.0, 1.0);
        let share = near * near * (3.0 - 2.0 * near);
        (DVec2::from_angle(share * angle).rotate(p - middle) - (p - middle)).extend(0.0)
    }))
}

fn region() -> Aabb {
    Aabb::of([DVec3::new(-200.0, -200.0, -100.0), DVec3::new(5000.0, 5000.0, 900.0)])
}

/// The map shifted and scaled with the scene.
fn moved(map: &GroundMoves, s: &Similarity) -> GroundMoves {
    let place = map.net().place();
    let place = NetPlace { first: s.point(place.first.extend(0.0)).truncate(), step: s.length(place.step), ..*place };
    let coefficients = map.net().coefficients().iter().map(|c| s.scale * *c).collect();
    GroundMoves::new(MoveNet::new(place, coefficients).expect("a net")).expect("it does not fold")
}

fn case(name: &str, make: impl Fn() -> GroundMoves + 'static) -> MapCase<GroundMoves> {
    let joint = |x: f64, y: f64| Joint { point: DVec3::new(x, y, 50.0), across: DVec3::X };
    MapCase::new(name, region(), move |s: &Similarity| moved(&make(), s))
        .continuity(Continuity::C2)
        .joints([joint(2400.0, 2500.0), joint(600.0, 2500.0), joint(200.0, 2500.0)])
        .unturned()
        .identity_at_zero_strength(|| pushed(0.0))
}

fn pushed_case() -> MapCase<GroundMoves> {
    case("a pushed hill", || pushed(1.0))
}

fn turned_case() -> MapCase<GroundMoves> {
    case("a turned town", || turned(0.7).expect("no fold"))
}

belvedere_testkit::space_map_laws!(pushed_laws, super::pushed_case());
belvedere_testkit::space_map_laws!(turned_laws, super::turned_case());

#[test]
fn edges_and_boxes_keep_their_bounds() {
    let (map, mut random) = (pushed(1.0), Random::new(11));
    let (mut tight, mut edges) = (0, 0);
    for _ in 0..2000 {
        let p = random.point(&region());
        let length = 400.0 * random.unit();
        let q = p + length * random.direction();
        let [a, b] = [p, q].map(|p| map.apply(p).expect("everywhere"));
        let off = |t: f64| map.apply(p.lerp(q, t)).expect("everywhere").distance(a.lerp(b, t));
        let worst = (1..20).map(|i| off(f64::from(i) / 20.0)).fold(0.0, f64::max);
        let bound = map.edge_bound(p, q);
        assert!(worst <= bound + 1e-9, "{p} to {q}: {worst} over {bound}");
        edges += usize::from(worst > 0.1);
        tight += usize::from(worst > 0.1 && bound < 4.0 * worst);
        let bounds = Aabb::of([p, q]);
        let displaced = map.displaced_bounds(&bounds).expect("a box");
        for t in 0..=10 {
            let r = map.apply(p.lerp(q, f64::from(t) / 10.0)).expect("everywhere");
            assert!(r.cmpge(displaced.min - 1e-9).all() && r.cmple(displaced.max + 1e-9).all());
        }
    }
    assert!(edges > 100 && 2 * tight > edges, "{tight} of {edges} bounds are within a factor of 4");
}

#[test]
fn great_turns_are_inverted_and_folds_are_refused() {
    let mut random = Random::new(3);
    for degrees in [20.0f64, 40.0, 60.0] {
        let map = turned(degrees.to_radians()).unwrap_or_else(|e| panic!("{degrees}: {e}"));
        for _ in 0..3000 {
            let p = random.point(&region());
            let there = map.apply(p).expect("everywhere");
            let back = map.invert(there).expect("everywhere");
            assert!(back.distance(p) < 1e-6, "{degrees}: {p} became {back}");
        }
    }
    let folded = GroundMoves::new(net(|p| {
        let near = (-(p - DVec2::splat(2400.0)).length_squared() / 2e5).exp();
        DVec3::new(1500.0 * near, 0.0, 0.0)
    }));
    let Err(GroundMovesError::Folds { at, bound }) = folded else { panic!("a fold was not found") };
    assert!(bound <= 0.05 && at.distance(DVec2::splat(2400.0)) < 1500.0, "{at}: {bound}");
}

#[test]
fn a_turned_body_turns_as_its_ground() {
    use belvedere_core::map::StageMap;
    let map = turned(0.4).expect("no fold");
    let middle = DVec3::new(2400.0, 2400.0, 10.0);
    let rotation = StageMap::rotation_of_body(&map, middle).expect("everywhere");
    let derivative = map.jacobian(middle).expect("everywhere");
    let [turn, ground] = [rotation, derivative].map(|m| m.x_axis.y.atan2(m.x_axis.x));
    assert!(turn > 0.2 && (turn - ground).abs() < 0.02, "{turn}, the ground turns by {ground}");
}
