//! Frames of scenes of the sizes that Cui et al. 2010 measure: straight, with a kink, curved, in turn; each scene in a process of its
//! own, so that its memory is its own. One line of JSON per scene.
//!
//! `cargo bench -p belvedere-bench --bench sizes -- [NAME..] [--frames 7]`
#![allow(missing_docs, clippy::print_stdout)]

use anyhow::{Context, Result};
use belvedere::cpu::CpuRenderer;
use belvedere::scene::{Light, Progress, RenderJob, RenderOptions, Renderer};
use belvedere_bench::clock::{Stopwatch, median, status_mib};
use belvedere_bench::sizes::{NAMES, counts, sized, sized_views};

const IMAGE: [u32; 2] = [1280, 720];

fn main() -> Result<()> {
    let (mut names, mut frames, mut alone) = (Vec::new(), 7, false);
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--frames" => frames = args.next().context("--frames needs a number")?.parse()?,
            "--alone" => alone = true,
            // Cargo passes it to every benchmark.
            "--bench" => {}
            _ => names.push(arg),
        }
    }
    if alone {
        return names.iter().try_for_each(|name| measure(name, frames));
    }
    let names = if names.is_empty() { NAMES.map(str::to_owned).into() } else { names };
    for name in names {
        let me = std::env::current_exe()?;
        let status =
            std::process::Command::new(me).args([&name, "--alone", "--frames", &frames.to_string()]).status()?;
        anyhow::ensure!(status.success(), "{name} failed");
    }
    Ok(())
}

fn measure(name: &str, frames: usize) -> Result<()> {
    let scene = sized(name)?;
    let [vertices, triangles] = counts(&scene);
    let made_mib = status_mib("VmHWM");
    let views = sized_views(IMAGE)?;
    let (renderer, light, progress) = (CpuRenderer::default(), Light::default(), Progress::silent());
    let options = RenderOptions { samples: 1, lod_px: 0.0, ..RenderOptions::default() };
    let mut times = views.each_ref().map(|_| Vec::new());
    let mut drawn = [0; 3];
    for round in 0..=frames {
        for (k, (_, view)) in views.iter().enumerate() {
            let job = RenderJob { scene: &scene, view, light: &light, options: &options, progress: &progress };
            let clock = Stopwatch::start();
            let frame = renderer.render(&job)?;
            let ms = clock.cpu_ms().unwrap_or_else(|| clock.wall_ms());
            drawn[k] = frame.stats.triangles_drawn;
            // The first frame of each view fills the caches.
            if round > 0 {
                times[k].push(ms);
            }
        }
    }
    let ratios = [1, 2].map(|k| median(times[k].iter().zip(&times[0]).map(|(a, b)| a / b).collect()));
    let [straight, c0, curved] = times.map(median);
    println!(
        "{}",
        serde_json::json!({
            "scene": name, "vertices": vertices, "triangles": triangles, "drawn": drawn,
            "straight_ms": straight, "c0_ms": c0, "curved_ms": curved, "c0_to_straight": ratios[0], "curved_to_straight": ratios[1],
            "made_mib": made_mib, "peak_mib": status_mib("VmHWM"),
        })
    );
    Ok(())
}
