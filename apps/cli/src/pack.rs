//! The verb that makes a web page.

use crate::goal::Goal;
use crate::outputs;
use crate::report::{Context, done, print};
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
}

pub(crate) fn pack_scene(args: PackArgs, context: &Context) -> anyhow::Result<Goal> {
    crate::inputs::exist(&args.files)?;
    outputs::check_folder(&args.out, context)?;
    let request = PackRequest {
        trust: context.trust.clone(),
        files: args.files,
        allowed: context.common.allow_root.clone(),
        application: args.app.unwrap_or_else(application),
        out: args.out,
        overwrite: context.common.overwrite,
    };
    let packed = pack(&request, &context.progress)?;
    context.finish();
    let out = &packed.folder;
    if context.common.json {
        let mut result = done("pack", &[out.join("index.html")], &[]);
        result["report"] = serde_json::to_value(&packed)?;
        context.print(&result)?;
    } else if !context.common.quiet {
        let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
        print(&format!(
            "{}: application {:.1} MiB, scene {:.1} MiB in {} files\nput the folder on any web server; to try it: python3 -m http.server -d {}\n",
            out.display(),
            mib(packed.application_bytes),
            mib(packed.scene_bytes),
            packed.bundle.files.len(),
            out.display()
        ))?;
    }
    Ok(Goal::Reached)
}

/// Where the application for browsers lies: named by the environment, installed beside the program, or built in its repository.
fn application() -> PathBuf {
    if let Some(folder) = std::env::var_os("BELVEDERE_WEB_APP") {
        return folder.into();
    }
    let program = std::env::current_exe().unwrap_or_default();
    let beside = program.parent().unwrap_or(Path::new("."));
    let places = ["web", "../share/belvedere/web", "../web/app"].map(|place| beside.join(place));
    let found = places.iter().find(|place| place.join("index.html").is_file());
    found.unwrap_or(&places[0]).clone()
}
