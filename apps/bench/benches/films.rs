//! Films along ten routes of the data collection (`BELVEDERE_DATA`) of scenes that `reveal` writes, with three techniques: frames whose
//! eye lies lower over the drawn ground than its clearance, and pixels that show the lower side of the ground. A line of a table per film.
//!
//! `cargo bench -p belvedere-bench --bench films -- [NAME..] [--frames 67] [--technique spline] [--keep DIR]`
#![allow(missing_docs, clippy::print_stdout, clippy::print_stderr)]

use anyhow::{Context, Result, bail};
use belvedere::builtin::valley_route;
use belvedere::request::Reveal;
use belvedere::scene::{Crs, Progress};
use belvedere::scene_file::AnimationDoc;
use belvedere::verbs::animate::{AnimateRequest, Animation, animate};
use belvedere::verbs::reveal::{RevealFiles, Technique, reveal};
use belvedere::{OpenOptions, Session};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

struct Case {
    name: &'static str,
    dem: &'static str,
    route: Route,
}

enum Route {
    File(&'static str),
    /// A path of least cost through valleys, by its seed.
    Seed(u64),
}

const CASES: [Case; 10] = [
    Case { name: "andorra", dem: "andorra/N42E001.hgt", route: Route::File("andorra/andorra_for_map_matching.gpx") },
    Case {
        name: "andorra-hrp",
        dem: "andorra/N42E001.hgt",
        route: Route::File("andorra/hrp_andorra_no_elevation.gpx"),
    },
    Case {
        name: "andorra-gr11",
        dem: "andorra/N42E001.hgt",
        route: Route::File("andorra/gr11_andorra_no_elevation.gpx"),
    },
    Case {
        name: "grand_canyon",
        dem: "grand_canyon/grandcanyon_dem_3857.tif",
        route: Route::File("grand_canyon/colorado_river_line_derived.geojson"),
    },
    Case { name: "rmnp", dem: "rmnp/rmnp_dem.tif", route: Route::File("rmnp/continental-div-trail_clip.geojson") },
    Case { name: "gotthard", dem: "gotthard/N46E008.tif", route: Route::Seed(1) },
    Case { name: "gotthard-2", dem: "gotthard/N46E008.tif", route: Route::Seed(5) },
    Case { name: "bigtujunga", dem: "bigtujunga/bigtujunga.tif", route: Route::Seed(2) },
    Case { name: "baltoro", dem: "baltoro/baltoro_srtm.tif", route: Route::Seed(3) },
    Case { name: "swellendam", dem: "swellendam/srtm_41_19_utm33s.tif", route: Route::Seed(4) },
];

const TECHNIQUES: [(&str, Technique); 3] =
    [("spline", Technique::Spline), ("curved_rays", Technique::CurvedRays), ("terrain", Technique::Terrain)];

const IMAGE: [u32; 2] = [96, 54];

fn main() -> Result<()> {
    let mut names: Vec<String> = Vec::new();
    let (mut frames, mut only, mut keep) = (67, None, None);
    let mut args = std::env::args().skip(1).filter(|a| a != "--bench");
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--frames" => frames = args.next().context("--frames N")?.parse()?,
            "--technique" => only = args.next(),
            "--keep" => keep = args.next().map(PathBuf::from),
            name if CASES.iter().any(|c| c.name == name) => names.push(arg),
            _ => bail!("{arg}: known are {}", CASES.map(|c| c.name).join(", ")),
        }
    }
    let Some(data) = std::env::var_os("BELVEDERE_DATA").map(PathBuf::from) else {
        bail!("BELVEDERE_DATA does not name the folder of the data collection");
    };
    println!(
        "| route | technique | frames | under ground | pixels of ground | from below | least clearance / needed | lifted | share of the bend, least | s |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let mut total = Row::default();
    for case in CASES.iter().filter(|c| names.is_empty() || names.iter().any(|n| n == c.name)) {
        for (name, technique) in TECHNIQUES.iter().filter(|(name, _)| only.as_deref().is_none_or(|o| o == *name)) {
            let folder = std::env::temp_dir().join(format!("belvedere-films-{}", std::process::id()));
            let out = keep.as_ref().map_or_else(|| folder.join("film"), |k| k.join(format!("{}-{name}", case.name)));
            std::fs::create_dir_all(&folder)?;
            let began = Instant::now();
            let made = film(case, *technique, &data, (&folder, &out), frames);
            std::fs::remove_dir_all(&folder)?;
            match made {
                Ok(made) => {
                    let row = Row::of(&made);
                    println!("| {} | {name} | {row} {:.0} |", case.name, began.elapsed().as_secs_f64());
                    total.add(&row);
                }
                Err(e) => println!("| {} | {name} | failed: {e:#} |", case.name),
            }
        }
    }
    println!("| all | | {total} |");
    Ok(())
}

/// Reveals the route of a case and makes a film along it.
fn film(
    case: &Case,
    technique: Technique,
    data: &Path,
    (folder, out): (&Path, &Path),
    frames: u32,
) -> Result<Animation> {
    let options = OpenOptions { allow_roots: vec![data.to_owned(), folder.to_owned()], ..OpenOptions::default() };
    let dem = data.join(case.dem).display().to_string();
    let route = match case.route {
        Route::File(name) => data.join(name),
        Route::Seed(seed) => seeded_route(&dem, seed, folder, &options)?,
    };
    let (features, size, technique) = (vec![route.display().to_string()], Some(IMAGE), Some(technique));
    let asked = Reveal { data: dem, features, size, technique, ..Reveal::default() };
    let scene = folder.join("scene.toml");
    let written = RevealFiles { out: folder.join("out.png"), scene: Some(scene.clone()), ..RevealFiles::default() };
    reveal(&asked, &options.clone().into())?.write(&written, true)?;
    let session = Session::open(&scene, &OpenOptions { unsolved: true, ..options })?;
    let animation = AnimationDoc {
        along: Some("features1".into()),
        frames: Some(frames),
        marker: Some(true),
        ..AnimationDoc::default()
    };
    let request = AnimateRequest { animation, out: out.to_owned(), overwrite: true, ..AnimateRequest::default() };
    Ok(animate(&session, &request, &Progress::silent())?)
}

/// A route through the valleys of an elevation model as a file.
fn seeded_route(dem: &str, seed: u64, folder: &Path, options: &OpenOptions) -> Result<PathBuf> {
    let scene = folder.join("ground.toml");
    let text = format!(
        "format = 1\n[[layer]]\nid = 'ground'\nkind = 'terrain'\nsource = '{dem}'\n[camera]\neye = [0, 0, 1e5]\nlook_at = [0, 1e5, 0]\n"
    );
    let session = Session::from_text(&scene, &text, options)?;
    let terrain = session.scene().terrain().context("no terrain")?;
    let Crs::Epsg(code) = session.scene().crs else { bail!("{dem} has no coordinate system") };
    let mut corners = String::new();
    for p in valley_route(terrain, seed)? {
        let comma = if corners.is_empty() { "" } else { ", " };
        write!(corners, "{comma}[{}, {}]", p.x, p.y)?;
    }
    let path = folder.join("route.geojson");
    let crs = format!(r#"{{"type": "name", "properties": {{"name": "EPSG:{code}"}}}}"#);
    std::fs::write(&path, format!(r#"{{"type": "LineString", "crs": {crs}, "coordinates": [{corners}]}}"#))?;
    Ok(path)
}

/// Figures of one film or of all.
#[derive(Default)]
struct Row {
    frames: usize,
    under: usize,
    pixels: usize,
    below: usize,
    least: Option<f64>,
    lifted: usize,
    share: Option<f64>,
}

impl Row {
    fn of(made: &Animation) -> Self {
        let mut out = Self::default();
        for ground in made.manifest.frames.iter().flatten().filter_map(|f| f.ground) {
            let clearance = ground.clearance_m.map(|c| c / ground.needed_m);
            out.add(&Self {
                frames: 1,
                under: usize::from(clearance.is_some_and(|c| c < 1.0)),
                pixels: ground.pixels,
                below: ground.from_below,
                least: clearance,
                lifted: usize::from(ground.lifted_m > 0.0),
                share: Some(ground.bend_share),
            });
        }
        out
    }

    fn add(&mut self, other: &Self) {
        let least = |a: Option<f64>, b: Option<f64>| a.into_iter().chain(b).reduce(f64::min);
        self.frames += other.frames;
        self.under += other.under;
        self.pixels += other.pixels;
        self.below += other.below;
        self.least = least(self.least, other.least);
        self.lifted += other.lifted;
        self.share = least(self.share, other.share);
    }
}

impl std::fmt::Display for Row {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { frames, under, pixels, below, lifted, .. } = self;
        let [least, share] = [self.least, self.share].map(|v| v.map_or("none".into(), |v| format!("{v:.2}")));
        write!(f, "{frames} | {under} | {pixels} | {below} | {least} | {lifted} | {share} |")
    }
}
