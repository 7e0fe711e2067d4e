//! Levels of abstraction of generated towns of 1000, 5000 and 20,000 buildings.
#![allow(missing_docs)]

use belvedere::construct::generalise::{GeneraliseSettings, generalise};
use belvedere::core::DVec2;
use belvedere::scene::Progress;
use belvedere::scene::city::{Building, City, HeightSource, Polygon, Way, WayClass};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

/// `side` x `side` street blocks of 100 m with 12 houses each; every fourth street is a main one.
fn town(side: usize) -> City {
    let mut city = City::default();
    let span = 100.0 * side as f64;
    for i in 0..=side {
        let class = if i % 4 == 0 { WayClass::Secondary } else { WayClass::Residential };
        let at = 100.0 * i as f64;
        for points in [[[at, 0.0], [at + 5.0, span]], [[0.0, at], [span, at - 3.0]]] {
            city.ways.push(Way { name: String::new(), class, points: points.map(DVec2::from).to_vec() });
        }
    }
    for number in 0..side * side * 12 {
        let (block, house) = (number / 12, number % 12);
        let corner = 100.0 * DVec2::new((block % side) as f64, (block / side) as f64);
        let middle = corner + DVec2::new(18.0 + 22.0 * (house % 4) as f64, 22.0 + 27.0 * (house / 4) as f64);
        // Sizes and orientations repeat after 97 houses.
        let odd = (number * 31 % 97) as f64 / 97.0;
        let turn = DVec2::from_angle(0.3 * odd - 0.15);
        let outline = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(|c| middle + turn.rotate(DVec2::from(c) * DVec2::new(5.0 + 4.0 * odd, 10.0 - 5.0 * odd)));
        city.buildings.push(Building {
            id: String::new(),
            name: String::new(),
            landmark: false,
            footprint: vec![Polygon { outer: outline.to_vec(), holes: Vec::new() }],
            base_m: None,
            height_m: 6.0 + 6.0 * odd,
            height_source: HeightSource::Stated,
            faces: Vec::new(),
        });
    }
    city
}

fn towns(c: &mut Criterion) {
    let mut group = c.benchmark_group("generalise, buildings");
    group.sample_size(10);
    for side in [9, 20, 41] {
        let city = town(side);
        let buildings = city.buildings.len();
        group.throughput(Throughput::Elements(buildings as u64));
        group.bench_with_input(BenchmarkId::from_parameter(buildings), &city, |b, city| {
            b.iter(|| generalise(city, &GeneraliseSettings::default(), &Progress::silent()).expect("a city"));
        });
    }
    group.finish();
}

criterion_group!(benches, towns);
criterion_main!(benches);
