//! The page that shows figures and tables.

use super::eyes::EyeRow;
use super::sweeps::Trial;
use super::timing::{PAPER_CELLS, PAPER_SOLVE, Timing};
use crate::html::{self, escape};
use belvedere::Warning;
use belvedere::disocclusion::{SolverMode, TerrainReport};
use serde::Serialize;
use std::fmt::Write;

/// Figures of one area.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct AreaRecord {
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) pictures: Vec<String>,
    pub(crate) modes: Vec<TerrainReport>,
    pub(crate) w: Vec<Trial>,
    pub(crate) eta: Vec<Trial>,
    pub(crate) eyes: Vec<EyeRow>,
    pub(crate) timing: Timing,
    pub(crate) warnings: Vec<Warning>,
}

/// What a picture shows, by the ending of its name.
const CAPTIONS: [(&str, &str); 6] = [
    ("pair", "Perspective beside occlusion-free, the same camera."),
    ("steps", "From cells over the naive ground to the final one, and the two modes that guarantee what is seen."),
    ("profile", "The line of sight that is hidden most: the ground gives way just as far as it must."),
    ("w", "Smoothness weight w: the larger, the more is seen and the rougher the ground becomes."),
    ("eta", "Price of discontinuities eta: the larger, the less the ground near the eye is torn."),
    ("times", "Time of the greedy pass against reference points."),
];

pub(crate) fn page(records: &[AreaRecord]) -> String {
    let mut sections = String::new();
    for record in records {
        sections += &section(record);
    }
    let body = format!(
        "<h1>Terrain that makes way</h1>\n\
         <p>The figures and tables of Deng et al. 2013, <i>Occlusion-free mountain navigation</i>, on open data; the paper's own \
         elevation models and routes are not public, so kinds and trends can be compared, not single values. Displaced ground is \
         not to scale and not for navigation. Every figure is in <a href=\"figures.json\">figures.json</a>.</p>\n\
         {sections}<p class=\"small\">belvedere {}</p>\n",
        belvedere::VERSION
    );
    html::page("Belvedere: terrain that makes way", html::TABLES, &body)
}

fn section(record: &AreaRecord) -> String {
    let title = if record.title.is_empty() { &record.name } else { &record.title };
    let mut out = format!("<section>\n<h2>{}</h2>\n", escape(title));
    for picture in &record.pictures {
        let caption = CAPTIONS.iter().find(|(what, _)| picture.ends_with(&format!("_{what}.png"))).map_or("", |c| c.1);
        let _ = writeln!(out, "<p>{caption}</p>\n<figure>{}</figure>", html::picture(&escape(picture), caption));
    }
    out += &modes(record);
    out += &eyes(&record.eyes);
    out += &times(&record.timing);
    out + "</section>\n"
}

fn modes(record: &AreaRecord) -> String {
    let mut rows = String::new();
    let name = |mode| match mode {
        SolverMode::Paper => "paper",
        SolverMode::PaperQp => "paper+qp",
        SolverMode::Qp => "qp",
    };
    for r in &record.modes {
        rows += &mode_row(name(r.parameters.mode), r);
    }
    for trial in &record.w {
        rows += &mode_row(&format!("paper, w = {}", trial.value), &trial.report);
    }
    for trial in &record.eta {
        rows += &mode_row(&format!("paper, eta = {}", trial.value), &trial.report);
    }
    table(
        "mode|points|visible before|visible|length visible|rms, m|largest, m|raised, m|normals, deg|step, m|border, m",
        &rows,
    )
}

fn mode_row(name: &str, r: &TerrainReport) -> String {
    row(&[
        name.into(),
        r.points.to_string(),
        format!("{:.3}", r.visible_before),
        format!("{:.3}", r.metrics.visible),
        format!("{:.3}", r.metrics.visible_dense),
        format!("{:.1}", r.metrics.rms_m),
        format!("{:.0}", r.metrics.max_m),
        format!("{:.1}", r.metrics.raised_max_m),
        format!("{:.2}", r.metrics.normal_mean_deg),
        format!("{:.1}", r.metrics.step_p999_m),
        r.metrics.border_step_m.map_or_else(|| "-".into(), |b| format!("{b:.2}")),
    ])
}

fn eyes(eyes: &[EyeRow]) -> String {
    if eyes.is_empty() {
        return String::new();
    }
    let mut rows = String::new();
    for e in eyes {
        rows += &row(&[
            format!("{} m", e.above_ground_m),
            e.points.to_string(),
            format!("{:.3}", e.visible_before),
            format!("{:.3}", e.paper.visible),
            format!("{:.1}", e.paper.rms_m),
            format!("{:.3}", e.qp.visible),
            format!("{:.3}", e.qp.visible_dense),
            format!("{:.1}", e.qp.rms_m),
            format!("{:.0}", e.qp.max_m),
            e.qp.unresolved.to_string(),
        ]);
    }
    table(
        "eye over ground|points|visible before|paper: visible|rms, m|qp: visible|length|rms, m|largest, m|unresolved",
        &rows,
    )
}

fn times(t: &Timing) -> String {
    let line = |what: String, paper: String, ours: String| row(&[what, paper, ours]);
    let mut rows = String::new();
    rows += &line(
        format!("cells: {} there, {} here, of {} x {} nodes", PAPER_CELLS.0, t.cells, t.nodes[0], t.nodes[1]),
        format!("{:.0} ms", PAPER_CELLS.1),
        format!("{:.1} ms", t.cells_ms),
    );
    for g in &t.greedy {
        rows += &line(
            format!("{} points: lines of sight and parameters", g.points),
            format!("{:.0} ms", g.paper_ms),
            format!("{:.2} ms", g.ms),
        );
    }
    rows += &line(
        "hierarchy and matrix; factorisation".into(),
        "140 ms; 500 ms".into(),
        format!("{:.2} ms; none", t.prepare_ms),
    );
    rows += &line(
        format!("a solution: {} unknowns there, {} here", PAPER_SOLVE.0, t.unknowns),
        format!("{:.0} ms", PAPER_SOLVE.1),
        format!("{:.2} ms", t.solve_ms),
    );
    let grid = format!(
        "Measured on {} x {} nodes, to which the terrain's {} x {} were resampled: the paper's grid and number of cells.",
        t.nodes[0], t.nodes[1], t.own_nodes[0], t.own_nodes[1]
    );
    let growth = t.exponent.map_or(String::new(), |e| format!(" Greedy time grows like points^{e:.2}."));
    let growth = format!("<p class=\"small\">{grid}{growth}</p>\n");
    table("step|paper, 2.33 GHz dual core|here", &rows) + &growth
}

fn table(head: &str, rows: &str) -> String {
    let head: String = head.split('|').map(|h| format!("<th>{h}</th>")).collect();
    format!("<table>\n<tr>{head}</tr>\n{rows}</table>\n")
}

fn row(cells: &[String]) -> String {
    let cells: String = cells.iter().map(|c| format!("<td>{}</td>", escape(c))).collect();
    format!("<tr>{cells}</tr>\n")
}
