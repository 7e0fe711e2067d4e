//! Projecting 4.3 million nodes of a ground through a camera of two viewpoints.
#![allow(missing_docs)]

use belvedere::cpu::GroundImage;
use belvedere_bench::scene::{ground, views};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

fn project(c: &mut Criterion) {
    let scene = ground(2073).expect("well formed");
    let hf = scene.terrain().expect("a ground");
    let mut group = c.benchmark_group("project 4.3 M points");
    group.throughput(Throughput::Elements(hf.heights().len() as u64));
    let mut image = GroundImage::default();
    for (name, view) in views([1280, 720]).expect("well formed").into_iter().take(2) {
        group.bench_function(name, |b| b.iter(|| assert!(image.project(hf, &view, 0), "every node has an image")));
    }
    group.finish();
}

criterion_group!(benches, project);
criterion_main!(benches);
