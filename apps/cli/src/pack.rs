//! The verb that makes a web page.

use crate::goal::Goal;
use crate::outputs;
use crate::report::{Context, print};
use belvedere::answers::Warned;
use belvedere::verbs::pack::{PackRequest, pack};
use clap::Args;
use std::path::{Path, PathBuf};

/// A scene, data or nothing, and where the page goes.
#[derive(Debug, Args)]
pub(crate) struct PackArgs {
    /// A scene file, models, or an elevation model, alone or with routes, areas or points
    pub(crate) files: Vec<PathBuf>,
    /// Folder to make
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Folder with the application for browsers; else $BELVEDERE_WEB_APP, else where it lies beside this program
    #[arg(long, value_name = "DIR")]
    pub(crate) app: Option<PathBuf>,
    /// Draw on all cores of the visitor: needs a server that sends the two headers in the file `_headers`
    #[arg(long)]
    pub(crate) all_cores: bool,
}

pub(crate) fn pack_scene(args: PackArgs, context: &Context) -> anyhow::Result<Goal> {
    crate::inputs::exist(&args.files)?;
    outputs::check_folder(&args.out, context)?;
    let (application, remedy) = application(args.app);
    let request = PackRequest {
        trust: context.trust.clone(),
        files: args.files,
        allowed: context.common.allow_root.clone(),
        application,
        threads: args.all_cores,
        remedy,
        out: args.out,
        overwrite: context.common.overwrite,
    };
    let packed = pack(&request, &context.progress)?;
    context.finish();
    let out = &packed.folder;
    if context.common.json {
        let page = out.join("index.html");
        context.print("pack", &[page], &Warned { content: &packed, warnings: Vec::new() })?;
    } else if !context.common.quiet {
        let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
        let shown = out.display();
        let next = match args.all_cores {
            true => "put the folder on a web server that sends the headers in its file _headers".to_owned(),
            false => format!(
                "put the folder on any web server; to try it: python3 -m http.server --bind 127.0.0.1 -d {shown}"
            ),
        };
        print(&format!(
            "{shown}: application {:.1} MiB, scene {:.1} MiB in {} files\n{next}\n",
            mib(packed.application_bytes),
            mib(packed.scene_bytes),
            packed.bundle.files.len(),
        ))?;
    }
    Ok(Goal::Reached)
}

/// The script that builds the application, in the repository.
const BUILD: &str = "apps/viewer/web/build";

/// Where the application for browsers lies: as given, named by the environment, installed beside the program, or built in the repository of the
/// program. And the one command that builds it there.
fn application(given: Option<PathBuf>) -> (PathBuf, String) {
    let program = std::env::current_exe().and_then(|program| program.canonicalize()).unwrap_or_default();
    let beside = program.parent().unwrap_or(Path::new("."));
    let in_repository = beside.join("../..").join(BUILD).is_file();
    let places = ["web", "../share/belvedere/web", "../web/app"].map(|place| beside.join(place));
    let named = given.or_else(|| std::env::var_os("BELVEDERE_WEB_APP").map(PathBuf::from));
    let found = named.clone().or_else(|| places.iter().find(|place| place.join("index.html").is_file()).cloned());
    // Without a folder the script builds into the last of the places.
    let folder = found.unwrap_or_else(|| if in_repository { places[2].clone() } else { places[0].clone() });
    let into = if in_repository && named.is_none() { String::new() } else { format!(" {}", folder.display()) };
    let remedy = format!("in a copy of the repository this command builds it: {BUILD}{into}");
    (folder, remedy)
}
