//! Options of every verb.

use crate::parse::{parse_bytes, parse_seconds, parse_threads};
use belvedere::io::budget;
use clap::Args;
use std::path::PathBuf;

/// Options of every verb.
#[derive(Debug, Clone, Args)]
pub(crate) struct Common {
    /// Print one machine-readable result on stdout
    #[arg(long, global = true, help_heading = "Every command")]
    pub(crate) json: bool,
    /// Print no warnings and no progress
    #[arg(short, long, global = true, help_heading = "Every command")]
    pub(crate) quiet: bool,
    /// Replace existing outputs
    #[arg(long, global = true, help_heading = "Every command")]
    pub(crate) overwrite: bool,
    /// Exit with 1 if a stated goal is missed
    #[arg(long, global = true, help_heading = "Every command")]
    pub(crate) strict: bool,
    /// Worker threads; 0 = all cores
    #[arg(long, global = true, help_heading = "Every command", default_value_t = 0, value_name = "N", allow_negative_numbers = true, value_parser = parse_threads)]
    pub(crate) threads: usize,
    /// Budget of memory for the whole command, such as 2GiB or 800MiB; by default three quarters of what the machine has free
    #[arg(long, global = true, help_heading = "Every command", value_name = "SIZE", allow_negative_numbers = true, value_parser = parse_bytes)]
    pub(crate) max_mem: Option<u64>,
    /// Limit of time for the whole command (animate and view: for solving the ground of each picture); when it is reached the best
    /// result so far is taken, and a warning says so
    #[arg(long, global = true, help_heading = "Every command", value_name = "SECONDS", allow_negative_numbers = true, value_parser = parse_seconds)]
    pub(crate) time_limit: Option<f64>,
    /// Seed of generated layers, instead of the scene's
    #[arg(long, global = true, help_heading = "Every command", value_name = "N", allow_negative_numbers = true)]
    pub(crate) seed: Option<u64>,
    /// Folder, beside the scene's own, from which files may be read; may be given several times
    #[arg(long, global = true, help_heading = "Every command", value_name = "DIR")]
    pub(crate) allow_root: Vec<PathBuf>,
    /// Font for names whose letters the program's own font lacks (it has Latin, Greek and Cyrillic ones), TrueType or OpenType, before those
    /// of the scene and of the system; may be given several times
    #[arg(long, global = true, help_heading = "Every command", value_name = "FILE")]
    pub(crate) font: Vec<PathBuf>,
    /// Do not remember which files outside their folders scenes may read, and do not use what is remembered; as with
    /// BELVEDERE_NO_TRUST=1. See trust --help
    #[arg(long, global = true, help_heading = "Every command")]
    pub(crate) no_remember: bool,
    /// Write how long the steps took, JSON
    #[arg(long, global = true, help_heading = "Every command", value_name = "FILE.json")]
    pub(crate) timings: Option<PathBuf>,
}

impl Common {
    /// The budget of memory that was asked for, bytes, as far as the system gives it; `None` without the option.
    pub(crate) fn budget(&self) -> Option<u64> {
        self.max_mem.map(|_| budget::bytes())
    }
}
