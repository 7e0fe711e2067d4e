//! Frames of 256 x 256 x 110 voxels, straight and bent rays in turn, as one line of JSON.
//!
//! `cargo bench -p belvedere-bench --bench volume -- [--volume FILE.raw] [--frames 8] [--step 1] [--shaded] [--ppm OUT.ppm]`
#![allow(missing_docs, clippy::print_stdout)]

use anyhow::{Context, Result};
use belvedere_bench::volume::{VolumeRequest, block, measure, scene};

fn main() -> Result<()> {
    let mut request = VolumeRequest { frames: 8, image: [1280, 720], step: 1.0, shaded: false };
    let (mut values, mut picture) = (None, None);
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        let mut next = || args.next().with_context(|| format!("{arg} needs a value"));
        match arg.as_str() {
            "--volume" => values = Some(std::fs::read(next()?)?),
            "--frames" => request.frames = next()?.parse()?,
            "--step" => request.step = next()?.parse()?,
            "--ppm" => picture = Some(next()?),
            "--shaded" => request.shaded = true,
            // Cargo passes it to every benchmark.
            "--bench" => {}
            other => anyhow::bail!("{other} is not understood"),
        }
    }
    let (costs, frame) = measure(&scene(values.unwrap_or_else(block), &request)?, &request)?;
    if let Some(path) = picture {
        let mut file = format!("P6 {} {} 255\n", frame.width, frame.height).into_bytes();
        file.extend_from_slice(frame.color.as_flattened());
        std::fs::write(path, file)?;
    }
    let [straight, curved] = &costs[..] else { unreachable!("two views are measured") };
    println!("{}", serde_json::json!({ "bench": "volume", "straight": straight, "curved": curved }));
    Ok(())
}
