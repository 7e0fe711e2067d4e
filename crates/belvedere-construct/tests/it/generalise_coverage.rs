//! Blocks cover their buildings: generated towns of many kinds, each building and each piece of a block looked at by points.

use crate::generalise_towns::{building, rectangle, town, way};
use belvedere_construct::generalise::{FailingCell, GeneraliseSettings, Level, generalise};
use belvedere_core::DVec2;
use belvedere_scene::Progress;
use belvedere_scene::city::{City, Polygon, WayClass};
use belvedere_testkit::Random;

fn crossings(ring: &[DVec2], p: DVec2) -> usize {
    let edges = ring.iter().zip(ring.iter().cycle().skip(1));
    edges.filter(|(a, b)| (a.y <= p.y) != (b.y <= p.y) && a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) > p.x).count()
}

fn holds(polygon: &Polygon, p: DVec2) -> bool {
    let rings = std::iter::once(&polygon.outer).chain(&polygon.holes);
    rings.map(|ring| crossings(ring, p)).sum::<usize>() % 2 == 1
}

/// A polygon with its box.
struct Boxed<'a>(&'a Polygon, [DVec2; 2]);

impl<'a> Boxed<'a> {
    fn of(polygon: &'a Polygon) -> Self {
        let corners = polygon.outer.iter();
        Self(polygon, corners.fold([DVec2::MAX, DVec2::MIN], |[a, b], p| [a.min(*p), b.max(*p)]))
    }

    fn holds(&self, p: DVec2) -> bool {
        p.cmpge(self.1[0]).all() && p.cmple(self.1[1]).all() && holds(self.0, p)
    }

    /// Points of a lattice within it.
    fn points(&self, steps: u32) -> Vec<DVec2> {
        let [low, high] = self.1;
        let at = |k: u32| (f64::from(k) + 0.5) / f64::from(steps);
        let all = (0..steps).flat_map(|x| (0..steps).map(move |y| low + (high - low) * DVec2::new(at(x), at(y))));
        all.filter(|p| holds(self.0, *p)).collect()
    }
}

fn boxed<'a>(buildings: impl Iterator<Item = &'a belvedere_scene::city::Building>) -> Vec<Boxed<'a>> {
    buildings.flat_map(|b| &b.footprint).map(Boxed::of).collect()
}

/// Checks that every building lies in the blocks and landmarks of a level, and every piece of a block lies over buildings.
fn check(name: &str, city: &City, level: &Level) {
    let (buildings, shown) = (boxed(city.buildings.iter()), boxed(level.city.buildings.iter()));
    for (number, one) in buildings.iter().enumerate() {
        let points = one.points(12);
        let out = points.iter().filter(|p| !shown.iter().any(|s| s.holds(**p))).count();
        assert!(
            10 * out <= points.len(),
            "{name} {}: {out} of {} of building {number} are out",
            level.name,
            points.len()
        );
    }
    for piece in boxed(level.city.buildings[..level.blocks.len()].iter()) {
        let points = piece.points(40);
        let built = points.iter().filter(|p| buildings.iter().any(|b| b.holds(**p))).count();
        assert!(
            25 * built >= points.len(),
            "{name} {}: {built} of {} of a piece at {} are built",
            level.name,
            points.len(),
            piece.1[0]
        );
    }
}

/// Houses side by side along narrow streets that bend, some with courts, some over the street's edge.
fn old_town(seed: u64) -> City {
    let mut random = Random::new(seed);
    let mut city = City::default();
    for i in 0..=4 {
        let at = 70.0 * f64::from(i);
        let class = if i % 4 == 0 { WayClass::Tertiary } else { WayClass::Residential };
        city.ways.push(way(class, &[DVec2::new(at, -20.0), DVec2::new(at + 9.0, 150.0), DVec2::new(at - 4.0, 300.0)]));
        city.ways.push(way(class, &[DVec2::new(-20.0, at), DVec2::new(140.0, at - 7.0), DVec2::new(300.0, at)]));
        for row in 0..4 {
            let mut x = 6.0;
            while x < 268.0 {
                let width = random.range(6.0, 13.0);
                let depth = random.range(20.0, 32.0);
                let middle = DVec2::new(x + 0.5 * width, 70.0 * f64::from(row) + 6.0 + 0.5 * depth);
                x += width + if random.range(0.0, 1.0) < 0.1 { 9.0 } else { 0.0 };
                if i > 0 {
                    continue;
                }
                let mut house = building(rectangle(middle, DVec2::new(width, depth), 0.0), random.range(8.0, 18.0));
                if width > 11.0 {
                    let mut court = rectangle(middle, DVec2::splat(4.0), 0.0);
                    court.reverse();
                    house.footprint[0].holes.push(court);
                }
                city.buildings.push(house);
            }
        }
    }
    city
}

fn scattered(seed: u64, count: usize) -> City {
    let mut random = Random::new(seed);
    let mut city = City::default();
    city.ways
        .push(way(WayClass::Tertiary, &[DVec2::new(-50.0, 300.0), DVec2::new(300.0, 340.0), DVec2::new(700.0, 280.0)]));
    city.ways.push(way(WayClass::Service, &[DVec2::new(300.0, 340.0), DVec2::new(340.0, 620.0)]));
    for _ in 0..count {
        let middle = DVec2::new(random.range(0.0, 640.0), random.range(0.0, 640.0));
        let size = DVec2::new(random.range(5.0, 24.0), random.range(5.0, 18.0));
        city.buildings.push(building(rectangle(middle, size, random.range(0.0, 3.0)), random.range(3.0, 9.0)));
    }
    city
}

#[test]
fn every_building_lies_in_a_block_and_every_block_holds_buildings() {
    let one =
        City { buildings: vec![building(rectangle(DVec2::ZERO, DVec2::new(14.0, 9.0), 0.4), 7.0)], ..City::default() };
    let towns = [
        ("grid", town(4, 11)),
        ("another grid", town(5, 12)),
        ("old town", old_town(13)),
        ("another old town", old_town(14)),
        ("village, some overlap", scattered(15, 60)),
        ("hamlet", scattered(16, 9)),
        ("one", one),
    ];
    for (name, city) in &towns {
        let made = generalise(city, &GeneraliseSettings::default(), &Progress::silent()).expect("a city");
        for (level, report) in made.levels.iter().zip(&made.report.levels) {
            check(name, city, level);
            assert!(report.covered_share > 0.98, "{name} {}: {}", level.name, report.covered_share);
            assert_eq!(report.each_block.len(), level.blocks.len());
            for (block, shape) in report.each_block.iter().zip(&level.city.buildings) {
                assert_eq!(block.block, shape.id);
                assert!(block.covered_share > 0.9, "{name}: {block:?}");
            }
            let said = |reason: &str| report.cells_failing.iter().any(|c| c.reason == reason);
            assert!(!said("no room for a block") && !said("buildings reach out of the block"), "{name}: {report:?}");
        }
    }
}

#[test]
fn the_coarser_level_has_at_most_a_quarter_of_the_triangles() {
    for (name, city) in [("grid", town(6, 21)), ("old town", old_town(22))] {
        let made = generalise(&city, &GeneraliseSettings::default(), &Progress::silent()).expect("a city");
        let [fine, coarse] = &made.report.levels[..] else { panic!("two levels") };
        assert_eq!(
            made.report.triangles,
            city.buildings.iter().map(|b| 10 + 14 * b.footprint[0].holes.len()).sum::<usize>()
        );
        assert!(
            4 * coarse.triangles <= made.report.triangles,
            "{name}: {} of {}",
            coarse.triangles,
            made.report.triangles
        );
        assert!(coarse.triangles <= fine.triangles, "{name}: {} after {}", coarse.triangles, fine.triangles);
    }
}

#[test]
fn buildings_over_each_other_are_told_by_name() {
    let mut city = town(2, 5);
    let twice: Vec<_> = city.buildings[..12].to_vec();
    city.buildings.extend(twice);
    let made = generalise(&city, &GeneraliseSettings::default(), &Progress::silent()).expect("a city");
    let overlaps = |c: &&FailingCell| c.reason == "buildings overlap each other";
    let failing: Vec<_> = made.report.levels[0].cells_failing.iter().filter(overlaps).collect();
    assert_eq!(failing.len(), 1, "{failing:?}");
    let said = made.report.levels[0].failing();
    assert!(said.len() == 1 && said[0].text().contains(&failing[0].cell), "{said:?}");
    assert!(failing[0].cell.starts_with("loa1-"), "{failing:?}");
}
