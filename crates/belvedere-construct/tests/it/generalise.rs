//! Levels of abstraction of cities: laws, odd cities, real ones.

use crate::generalise_towns::{building, read, rectangle, town, way};
use belvedere_construct::generalise::{GeneraliseError, GeneraliseSettings, Generalised, generalise, volume_m3};
use belvedere_core::DVec2;
use belvedere_io::{Limits, load_city};
use belvedere_scene::Progress;
use belvedere_scene::city::{Building, City, CityArea, Keep, LandCover, Polygon, WayClass};
use belvedere_testkit::{Random, data};

fn done(city: &City) -> Generalised {
    generalise(city, &GeneraliseSettings::default(), &Progress::silent()).expect("a city")
}

fn inside(polygon: &Polygon, p: DVec2) -> bool {
    let rings = std::iter::once(&polygon.outer).chain(&polygon.holes);
    let crossings = rings
        .flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)))
        .filter(|(a, b)| (a.y <= p.y) != (b.y <= p.y) && a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) > p.x);
    crossings.count() % 2 == 1
}

fn in_any(polygons: &[Polygon], p: DVec2) -> bool {
    polygons.iter().any(|polygon| inside(polygon, p))
}

fn area(polygons: &[Polygon]) -> f64 {
    let twice =
        |ring: &Vec<DVec2>| ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| a.perp_dot(*b)).sum::<f64>();
    polygons.iter().map(|p| 0.5 * (twice(&p.outer).abs() - p.holes.iter().map(|h| twice(h).abs()).sum::<f64>())).sum()
}

fn distance_to_outline(polygons: &[Polygon], p: DVec2) -> f64 {
    let rings = polygons.iter().flat_map(|polygon| std::iter::once(&polygon.outer).chain(&polygon.holes));
    let edges = rings.flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
    edges
        .map(|(a, b)| {
            let t = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-12)).clamp(0.0, 1.0);
            p.distance(a.lerp(*b, t))
        })
        .fold(f64::MAX, f64::min)
}

/// Blocks may reach out of their cells by this where their outlines are made simple, metres.
const REACH_M: f64 = 6.0;

/// What holds for every city: cells share the settled ground without streets, blocks lie in cells, every building is in one
/// cell, blocks and landmarks hold the volume of what they stand for.
fn check_laws(city: &City, made: &Generalised) {
    let mut random = Random::new(7);
    for level in &made.levels {
        let places = level.cells.iter().flat_map(|c| c.buildings.iter().chain(&c.landmarks)).copied();
        let mut places: Vec<usize> = places.collect();
        places.sort_unstable();
        assert_eq!(places, (0..city.buildings.len()).collect::<Vec<_>>(), "{}: every building in one cell", level.name);
        for _ in 0..2000 {
            let building = &city.buildings[random.below(city.buildings.len())];
            let corner = building.footprint[0].outer[0];
            let p = corner + DVec2::new(random.range(-13.0, 13.0), random.range(-13.0, 13.0));
            let holders = level.cells.iter().filter(|c| in_any(&c.polygons, p)).count();
            let on_edge = level.cells.iter().any(|c| distance_to_outline(&c.polygons, p) < 1e-3);
            let expected = usize::from(!in_any(&level.streets, p));
            assert!(holders == expected || on_edge, "{}: {p} lies in {holders} cells, not {expected}", level.name);
        }
        for (block, shape) in level.blocks.iter().zip(&level.city.buildings) {
            let cell = &level.cells[block.cell];
            assert_eq!(shape.id, cell.name);
            assert!(area(&shape.footprint) > 0.0);
            let rings = |p: &Polygon| std::iter::once(p.outer.clone()).chain(p.holes.clone()).collect::<Vec<_>>();
            for p in shape.footprint.iter().flat_map(rings).flatten() {
                let near = |polygons: &[Polygon], by| in_any(polygons, p) || distance_to_outline(polygons, p) < by;
                let by_building = cell.buildings.iter().any(|i| near(&city.buildings[*i].footprint, REACH_M));
                assert!(
                    near(&cell.polygons, REACH_M) || by_building,
                    "{}: {p} lies {} m outside",
                    cell.name,
                    distance_to_outline(&cell.polygons, p)
                );
            }
            let held: f64 =
                cell.buildings.iter().map(|i| area(&city.buildings[*i].footprint) * city.buildings[*i].height_m).sum();
            let shown = area(&shape.footprint) * shape.height_m * block.coverage;
            assert!((shown / held - 1.0).abs() < 0.1 || block.coverage == 1.0, "{}: {shown} for {held} m^3", cell.name);
        }
        let own: Vec<_> =
            level.city.buildings[level.blocks.len()..].iter().map(|b| (&b.footprint, b.height_m)).collect();
        let landmarks: Vec<_> = level.cells.iter().flat_map(|c| &c.landmarks).map(|i| &city.buildings[*i]).collect();
        assert_eq!(own, landmarks.iter().map(|b| (&b.footprint, b.height_m)).collect::<Vec<_>>());
        let tagged = |b: &&Building| b.landmark;
        assert_eq!(landmarks.iter().copied().filter(tagged).count(), city.buildings.iter().filter(tagged).count());
    }
    for (level, report) in made.levels.iter().zip(&made.report.levels) {
        let shown: f64 = level.city.buildings.iter().map(volume_m3).sum();
        let held: f64 = city.buildings.iter().map(volume_m3).sum();
        assert!((report.volume_share / (shown / held) - 1.0).abs() < 1e-6, "{}: {}", level.name, report.volume_share);
        assert_eq!(report.volume_kept, report.missed().is_none(), "{}", level.name);
        for (block, shape) in report.each_block.iter().zip(&level.city.buildings) {
            let prism = area(&shape.footprint) * shape.height_m;
            assert!((block.volume_out_m3 / prism - 1.0).abs() < 1e-4, "{block:?} is a prism of {prism} m^3");
        }
    }
    check_tallest(city, made);
}

/// The 20 tallest of a town, one in twenty of a small one, are as high at every level as they are, to a tenth.
fn check_tallest(city: &City, made: &Generalised) {
    let with_area = |b: &&Building| area(&b.footprint) > 0.01 && b.height_m > 0.0;
    let mut order: Vec<&Building> = city.buildings.iter().filter(with_area).collect();
    order.sort_by(|a, b| b.height_m.total_cmp(&a.height_m));
    for building in &order[..20.min(order.len() / 20)] {
        for level in &made.levels {
            let own = level.city.buildings[level.blocks.len()..].iter().find(|l| l.footprint == building.footprint);
            let in_block = level.blocks.iter().zip(&level.city.buildings).find(|(block, _)| {
                level.cells[block.cell].buildings.iter().any(|i| city.buildings[*i].footprint == building.footprint)
            });
            let shown = own.or(in_block.map(|(_, shape)| shape)).expect("the building or its block").height_m;
            assert!(
                (shown / building.height_m - 1.0).abs() <= 0.1 + 1e-9,
                "{}: {shown} of {} m",
                level.name,
                building.height_m
            );
        }
    }
}

#[test]
fn a_town_of_blocks() {
    let mut city = town(8, 3);
    city.buildings[5].height_m = 60.0;
    city.buildings[100].landmark = true;
    let made = done(&city);
    check_laws(&city, &made);
    let [fine, coarse] = &made.report.levels[..] else { panic!("two levels") };
    assert_eq!([fine.cells - fine.green_cells, coarse.cells - coarse.green_cells], [64, 4]);
    assert_eq!([fine.landmarks, coarse.landmarks], [21, 21], "the tallest and a tagged building");
    assert!((1.0..2.5).contains(&fine.volume_share), "{}", fine.volume_share);
    assert!(coarse.volume_share < 3.0, "{}", coarse.volume_share);
    assert_eq!(made.report.notes, []);
    let block = &made.levels[0].city.buildings[0];
    assert!((7.0..11.0).contains(&block.height_m), "the mean without the landmarks, not {}", block.height_m);
}

#[test]
fn the_same_city_gives_the_same_levels() {
    let city = town(5, 9);
    let [a, b] = [done(&city), done(&city)];
    assert!(a.levels[0].city == b.levels[0].city && a.levels[1].city == b.levels[1].city);
    let shift = DVec2::new(84_000.0, 447_000.0);
    let mut moved = city.clone();
    moved.ways.iter_mut().flat_map(|w| &mut w.points).for_each(|p| *p += shift);
    moved.buildings.iter_mut().flat_map(|b| &mut b.footprint).flat_map(|f| &mut f.outer).for_each(|p| *p += shift);
    let there = done(&moved);
    assert_eq!(there.report.levels[0].blocks, a.report.levels[0].blocks);
    assert!((there.report.levels[0].volume_m3 / a.report.levels[0].volume_m3 - 1.0).abs() < 1e-5);
}

#[test]
fn street_areas_and_water_divide() {
    let mut city = City::default();
    for x in [10.0, 35.0, 75.0, 100.0] {
        city.buildings.push(building(rectangle(DVec2::new(x, 0.0), DVec2::splat(15.0), 0.0), 10.0));
    }
    let strip = |width: f64| {
        let outer = rectangle(DVec2::new(55.0, 0.0), DVec2::new(width, 200.0), 0.0);
        vec![Polygon { outer, holes: Vec::new() }]
    };
    let with = |cover, width| {
        let area = CityArea { name: String::new(), cover, polygons: strip(width) };
        let made = done(&City { areas: vec![area], ..city.clone() });
        [0, 1].map(|level| made.levels[level].blocks.len())
    };
    assert_eq!(with(LandCover::Green, 8.0), [1, 1], "grass is built around");
    assert_eq!(with(LandCover::Road, 8.0), [2, 1], "a side street");
    assert_eq!(with(LandCover::Road, 16.0), [2, 2], "a main street");
    assert_eq!(with(LandCover::Water, 4.0), [2, 2], "a canal");
}

#[test]
fn small_cells_join_the_neighbour_they_face() {
    let mut city = City::default();
    for (x, y) in [(0.0, 0.0), (30.0, 0.0), (0.0, 30.0), (30.0, 30.0)] {
        city.buildings.push(building(rectangle(DVec2::new(x, y), DVec2::splat(18.0), 0.0), 10.0));
    }
    city.ways.push(way(WayClass::Residential, &[DVec2::new(-100.0, 50.0), DVec2::new(100.0, 50.0)]));
    city.ways.push(way(WayClass::Residential, &[DVec2::new(-100.0, 62.0), DVec2::new(100.0, 62.0)]));
    city.buildings.push(building(rectangle(DVec2::new(15.0, 56.0), DVec2::new(4.0, 3.0), 0.0), 3.0));
    let settings = GeneraliseSettings { smallest_cell_m2: 500.0, ..Default::default() };
    let made = generalise(&city, &settings, &Progress::silent()).expect("a city");
    let holder = made.levels[0].cells.iter().find(|c| c.buildings.contains(&4)).expect("a cell");
    assert!(holder.buildings.contains(&2) && made.report.levels[0].cells_merged >= 1, "{:?}", made.report);
    check_laws(&city, &made);
}

#[test]
fn odd_cities_become_something_sensible_and_it_is_said() {
    let houses = |n: usize| City {
        buildings: (0..n)
            .map(|i| building(rectangle(DVec2::new(20.0 * i as f64, 0.0), DVec2::splat(14.0), 0.3), 9.0))
            .collect(),
        ..City::default()
    };
    let without_streets = done(&houses(6));
    check_laws(&houses(6), &without_streets);
    assert_eq!(without_streets.levels[0].blocks.len(), 1);
    assert!(
        without_streets.report.notes.iter().any(|n| n.text().contains("no streets")),
        "{:?}",
        without_streets.report.notes
    );
    assert!(
        without_streets.report.notes.iter().any(|n| n.text().contains("one cell")),
        "{:?}",
        without_streets.report.notes
    );

    let mut paved = houses(3);
    let outer = rectangle(DVec2::ZERO, DVec2::splat(500.0), 0.0);
    let polygons = vec![Polygon { outer, holes: Vec::new() }];
    paved.areas.push(CityArea { name: String::new(), cover: LandCover::Road, polygons });
    let made = done(&paved);
    assert_eq!(made.levels[0].city.buildings.len(), 3, "streets everywhere: every building stays");
    assert!(made.report.notes.iter().any(|n| n.text().contains("keeps its shape")), "{:?}", made.report.notes);

    let mut damaged = houses(4);
    damaged.buildings[0].footprint[0].outer[2] = DVec2::new(f64::NAN, 0.0);
    damaged.buildings[1].footprint[0].outer.truncate(2);
    damaged.buildings[2].height_m = f64::NAN;
    let bow = &mut damaged.buildings[3].footprint[0].outer;
    bow.swap(1, 2);
    damaged.ways.push(way(WayClass::Primary, &[DVec2::ZERO]));
    damaged.ways.push(way(WayClass::Primary, &[DVec2::NAN, DVec2::ZERO]));
    damaged.ways.push(way(WayClass::Primary, &[DVec2::splat(300.0), DVec2::splat(300.0)]));
    let made = done(&damaged);
    assert_eq!(made.report.without_area, 2);
    assert!((made.report.volume_m3 - (9.0 * 14.0 * 14.0 + 9.0 * 7.0 * 14.0)).abs() < 1.0, "{}", made.report.volume_m3);
    assert!(made.report.notes.iter().any(|n| n.text().contains("no usable height")), "{:?}", made.report.notes);
    assert!(
        made.report.notes.iter().any(|n| n.text().contains("every cell is hardly built")),
        "{:?}",
        made.report.notes
    );
}

#[test]
fn what_is_no_city_is_refused_with_a_reason() {
    let refused =
        |city: &City| generalise(city, &GeneraliseSettings::default(), &Progress::silent()).expect_err("refused");
    assert!(matches!(refused(&City::default()), GeneraliseError::NoBuildings { buildings: 0 }));
    let mut degrees = town(1, 1);
    degrees.buildings.iter_mut().flat_map(|b| &mut b.footprint).flat_map(|f| &mut f.outer).for_each(|p| *p *= 1e-5);
    assert!(refused(&degrees).to_string().contains("project it"), "{}", refused(&degrees));
    let settings = GeneraliseSettings { inset_m: 0.5, ..Default::default() };
    let error = generalise(&town(1, 1), &settings, &Progress::silent()).expect_err("refused");
    assert!(error.to_string().contains("inset_m is 0.5"), "{error}");
    let progress = Progress::silent();
    progress.cancel_flag().store(true, std::sync::atomic::Ordering::Relaxed);
    let cancelled = generalise(&town(1, 1), &GeneraliseSettings::default(), &progress);
    assert!(matches!(cancelled, Err(GeneraliseError::Cancelled(_))));
}

/// Delft: solids instead of footprints, streets that are surfaces instead of lines.
#[test]
fn a_modelled_quarter() {
    let Some(path) = data("city_delft/delft.city.json") else { return };
    let mut city = load_city(&path, None, &Limits::default()).expect("a city").value.city;
    assert_eq!((city.buildings.len(), city.ways.len()), (160, 0));
    let plain = done(&city);
    check_laws(&city, &plain);
    for building in city.buildings.iter_mut().step_by(31) {
        building.landmark = true;
    }
    let made = done(&city);
    check_laws(&city, &made);
    let [before, after] = [&plain, &made].map(|m| m.report.levels.iter().map(|l| l.landmarks).collect::<Vec<_>>());
    for (level, (before, after)) in made.report.levels.iter().zip(before.iter().zip(&after)) {
        assert!((1.0..1.7).contains(&level.volume_share), "{} holds {}", level.name, level.volume_share);
        assert!(level.blocks > 0 && level.blocks < 16, "{} blocks", level.blocks);
        assert!(after > before && *after >= 6, "{}: six more landmarks than {before}, not {after}", level.name);
    }
}

#[test]
fn a_mapped_town_and_a_mapped_quarter() {
    let files = [
        ("swellendam/buildings.geojson", "swellendam/roads.geojson", 4708),
        ("city_bubenec/buildings.geojson", "city_bubenec/streets.geojson", 144),
    ];
    for (buildings, roads, count) in files {
        let (Some(from), Some(roads)) = (data(buildings), data(roads)) else { continue };
        let city = read(&from, &roads);
        assert_eq!(city.buildings.len(), count);
        let made = done(&city);
        check_laws(&city, &made);
        for level in &made.report.levels {
            assert!(
                (1.0..3.5).contains(&level.volume_share),
                "{buildings}: {} holds {}",
                level.name,
                level.volume_share
            );
            assert!(level.blocks > 0 && level.blocks < count / 10, "{buildings}: {} blocks", level.blocks);
        }
    }
}

#[test]
fn blocks_keep_the_volume_of_their_buildings_where_that_is_wanted() {
    let city = town(5, 17);
    let settings = GeneraliseSettings { keep: Keep::Volume, ..GeneraliseSettings::default() };
    let made = generalise(&city, &settings, &Progress::silent()).expect("a city");
    check_tallest(&city, &made);
    for (level, report) in made.levels.iter().zip(&made.report.levels) {
        assert!(report.volume_kept && (0.99..1.01).contains(&report.volume_share), "{}", report.volume_share);
        for block in &report.each_block {
            assert!((block.volume_out_m3 / block.volume_in_m3 - 1.0).abs() < 1e-3, "{}: {block:?}", level.name);
        }
        assert_eq!(report.failing(), []);
    }
    let high = done(&city);
    let height = |made: &Generalised| made.levels[1].city.buildings[0].height_m;
    assert!(height(&made) < height(&high), "lower on more ground");
}

/// Nine cells of twelve houses of 9 m, four towers of 120 m in the middle one.
#[test]
fn a_cluster_of_towers_stays() {
    let mut city = town(3, 1);
    city.buildings.iter_mut().for_each(|b| b.height_m = 9.0);
    for k in 0..4 {
        let at = DVec2::new(130.0 + 13.0 * f64::from(k), 190.0);
        city.buildings.push(building(rectangle(at, DVec2::splat(8.0), 0.0), 120.0));
    }
    let made = done(&city);
    for (level, report) in made.levels.iter().zip(&made.report.levels) {
        assert_eq!(report.landmarks, 4, "{}", level.name);
        let blocks = &level.city.buildings[..level.blocks.len()];
        assert!(blocks.iter().all(|b| (b.height_m - 9.0).abs() < 1e-9), "{}", level.name);
    }
}
