//! Draws an elevation model and a route as a picture in which the route is visible.
//!
//! `cargo run --example reveal_from_files -- dem.tif route.gpx out.png`; without arguments on generated ground.

use belvedere::request::Reveal;
use belvedere::verbs::reveal::{RevealFiles, Setting, reveal};
use std::path::PathBuf;

/// Draws the picture and says how much of the route it shows, straight and bent.
pub fn run(dem: &str, route: &str, out: PathBuf, image: [u32; 2]) -> Result<String, Box<dyn std::error::Error>> {
    let asked = Reveal { data: dem.into(), features: vec![route.into()], size: Some(image), ..Reveal::default() };
    let answer = reveal(&asked, &Setting::default())?;
    answer.write(&RevealFiles { out, ..RevealFiles::default() }, true)?;
    Ok(answer.summary())
}

#[allow(clippy::print_stdout, reason = "a program, not a library")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let [dem, route, out] = match &given[..] {
        [dem, route, out] => [dem.as_str(), route, out],
        _ => ["builtin:massif?seed=7", "builtin:massif?seed=7", "revealed.png"],
    };
    println!("{}", run(dem, route, out.into(), [1280, 720])?);
    Ok(())
}
