//! The hard set: every range of the data collection and seeded ones of 90 m, a route from corner to corner, three eyes.
//!
//! `cargo run --release -p belvedere-disocclusion --example hard_set [RANGE] [CASE] [rounds]` (parts of names). One line per case, with
//! what is asked of it: `seen` by the independent test >= 0.995 or something unresolved with its reason, raised at most 0.5 m over
//! the limit, 5 s of processor time per 3000 candidates, 400 MiB. At the end the growth of time against rows.

#![expect(clippy::print_stdout, reason = "it prints figures")]

mod cost;
mod independent;
mod ranges;

use belvedere_core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere_disocclusion::{TerrainMemory, TerrainSettings, TerrainSolver};
use belvedere_scene::{Heightfield, Layer, Progress, Scene};
use cost::Cost;
use ranges::Range;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let argument = |k: usize| std::env::args().nth(k).filter(|a| a != "all").unwrap_or_default();
    let (range, case) = (argument(1), argument(2));
    println!(
        "case nodes candidates rows active rounds cpu_s s_per_3000 seen report hidden_m raised_m rms_m named guaranteed MiB energy fallbacks"
    );
    let mut growth = Vec::new();
    for name in ranges::names().filter(|n| n.contains(&range)) {
        let Some(range) = ranges::load(name)? else {
            println!("{name}: SKIPPED, its files are not here");
            continue;
        };
        for (eye, view) in eyes(&range.ground)? {
            for (what, layers) in [("route", &range.route), ("areas", &range.areas)] {
                let label = format!("{name}/{eye}/{what}");
                if !layers.is_empty() && label.contains(&case) {
                    growth.extend(solve(&label, &range, layers, &view)?);
                }
            }
        }
    }
    println!("time grows with rows^{:.2} over {} cases", exponent(&growth), growth.len());
    Ok(())
}

/// Three eyes: a corner, a side, the centre; 500 to 900 m up, 100 degrees wide.
fn eyes(ground: &Heightfield) -> Result<Vec<(&'static str, View)>, Failure> {
    let at = |x: f64, y: f64| {
        let size = DVec2::new((ground.cols() - 1) as f64, (ground.rows() - 1) as f64) * ground.spacing();
        ground.north_west() + DVec2::new(x, -y) * size
    };
    let fov_y = 2.0 * (50f64.to_radians().tan() * 9.0 / 16.0).atan();
    let of = |name, from: DVec2, above: f64, to: DVec2| -> Result<(&'static str, View), Failure> {
        let height = |p: DVec2| ground.surface_at(p).unwrap_or(ground.z_range()[0]);
        let (eye, target) = (from.extend(height(from) + above), to.extend(height(to)));
        let lens = Projection::Perspective { fov_y };
        Ok((name, View::straight(Pinhole::look_at(eye, target, DVec3::Z, lens, [1280, 720], 1.0, None)?)))
    };
    Ok(vec![
        of("corner", at(0.04, 0.05), 900.0, at(0.5, 0.5))?,
        of("side", at(0.5, 0.96), 700.0, at(0.5, 0.5))?,
        of("centre", at(0.52, 0.48), 500.0, at(0.94, 0.94))?,
    ])
}

/// Prints every round if `rounds` is given.
fn progress() -> Progress {
    match std::env::args().nth(3) {
        Some(_) => Progress::new(|stage, done| println!("    {:3.0} % {stage}", 100.0 * done)),
        None => Progress::silent(),
    }
}

/// Prints the line of a case; answers rows and seconds.
fn solve(label: &str, range: &Range, layers: &[Layer], view: &View) -> Result<Option<(f64, f64)>, Failure> {
    let layers = std::iter::once(range.terrain()).chain(layers.iter().cloned()).collect();
    let scene = Scene { crs: range.crs, layers, ..Scene::default() };
    let solver = TerrainSolver::new(TerrainSettings::default())?;
    let cost = Cost::begin();
    let solved = match solver.solve(&scene, view, &mut TerrainMemory::default(), &progress()) {
        Ok(solved) => solved,
        Err(failure) => {
            println!("{label}: {failure}");
            return Ok(None);
        }
    };
    let (seconds, mebibytes) = cost.end();
    let r = &solved.report;
    let Some(qp) = r.qp else { return Ok(None) };
    let seen = independent::seen(&scene, view, solved.stage.grid());
    let named: usize = r.unresolved.iter().chain(&r.hidden).map(|run| run.points).sum();
    println!(
        "{label} {} {} {} {} {} {seconds:.1} {:.1} {seen:.4} {:.4} {:.1} {:.2} {:.1} {named} {} {mebibytes:.0} {:.0} {:?}",
        range.ground.cols() * range.ground.rows(),
        qp.candidates,
        qp.rows,
        qp.active,
        qp.rounds,
        seconds * 3000.0 / qp.candidates.max(1) as f64,
        r.metrics.visible_dense,
        r.metrics.hidden_worst_m,
        r.metrics.raised_max_m,
        r.metrics.rms_m,
        r.guaranteed,
        qp.energy,
        r.fallbacks,
    );
    Ok(Some((qp.rows as f64, seconds)))
}

/// Slope of the logarithm of time over that of rows, of cases with more than 500 rows.
fn exponent(cases: &[(f64, f64)]) -> f64 {
    let logs: Vec<DVec2> = cases.iter().filter(|c| c.0 > 500.0).map(|c| DVec2::new(c.0.ln(), c.1.ln())).collect();
    let mean = logs.iter().sum::<DVec2>() / logs.len() as f64;
    let off = |p: &DVec2| *p - mean;
    logs.iter().map(|p| off(p).x * off(p).y).sum::<f64>() / logs.iter().map(|p| off(p).x.powi(2)).sum::<f64>()
}
