//! Frames of 2.1 million triangles, 1280 x 720: straight against bent, without and with anti-aliasing, and in less detail.
#![allow(missing_docs)]

use belvedere::cpu::CpuRenderer;
use belvedere::scene::{Light, Progress, RenderJob, RenderOptions, Renderer};
use belvedere_bench::scene::{ground, views};
use criterion::{Criterion, criterion_group, criterion_main};

fn frames(c: &mut Criterion) {
    let scene = ground(1025).expect("well formed");
    let (renderer, light, progress) = (CpuRenderer::default(), Light::default(), Progress::silent());
    for (samples, lod_px) in [(1, 0.0), (4, 0.0), (1, 0.5)] {
        let mut group = c.benchmark_group(format!("frame, {samples} samples, detail {lod_px} px"));
        group.sample_size(10);
        for (name, view) in views([1280, 720]).expect("well formed") {
            let options = RenderOptions { samples, lod_px, ..RenderOptions::default() };
            let job = RenderJob { scene: &scene, view: &view, light: &light, options: &options, progress: &progress };
            group.bench_function(name, |b| b.iter(|| renderer.render(&job).expect("drawn")));
        }
        group.finish();
    }
}

criterion_group!(benches, frames);
criterion_main!(benches);
