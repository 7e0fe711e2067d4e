//! `generalise`: its arguments, and what it says.

use crate::goal::Goal;
use crate::outputs;
use crate::report::{Context, print};
use belvedere::output;
use belvedere::verbs::generalise::{self, GeneraliseRequest, GeneraliseSettings};
use clap::Args;
use std::path::PathBuf;

/// Buildings and streets.
#[derive(Debug, Args)]
pub(crate) struct GeneraliseArgs {
    /// Buildings with their heights or storeys: CityJSON, CityGML, OSM PBF, or footprints as GeoJSON, shapefile or
    /// GeoPackage (FILE.gpkg?table=NAME, where they are built in)
    pub(crate) city: PathBuf,
    /// Streets, railways, rivers and land cover, if the city file has none: GeoJSON, shapefiles, OSM PBF,
    /// GeoPackages
    pub(crate) roads: Vec<PathBuf>,
    /// Folder for the levels, the map, the plan drawings and the report
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Distance from buildings up to which ground counts as built-up, metres
    #[arg(long, value_name = "METRES", default_value_t = GeneraliseSettings::default().margin_m, allow_negative_numbers = true, value_parser = belvedere::request::parse::number)]
    pub(crate) margin: f64,
}

pub(crate) fn generalise_city(args: GeneraliseArgs, context: &Context) -> anyhow::Result<Goal> {
    outputs::check_folder(&args.out, context)?;
    let inputs: Vec<PathBuf> = args.roads.iter().chain([&args.city]).cloned().collect();
    if args.out.exists() {
        for path in [None, Some(0)].iter().flat_map(|epsg| generalise::files(&args.out, *epsg)) {
            output::check(&path, &inputs, context.common.overwrite)?;
        }
    }
    let settings = GeneraliseSettings { margin_m: args.margin, ..GeneraliseSettings::default() };
    let request = GeneraliseRequest { city: args.city, roads: args.roads, settings };
    let found = generalise::generalise(&request, &context.progress)?;
    let written = found.write(&args.out, context.common.overwrite, &context.progress)?;
    context.finish();
    if context.common.json {
        context.print("generalise", &written, &found.document())?;
    } else if !context.common.quiet {
        print(&format!("{}\nopen {}\n", found.summary(), args.out.join("overview.png").display()))?;
    }
    context.warn(&found.warnings);
    context.warn(&found.generalised.report.notes);
    context.warn(&found.missed());
    context.warn(&found.failing());
    Ok(if found.missed().is_empty() { Goal::Reached } else { Goal::Missed })
}
