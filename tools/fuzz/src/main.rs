//! Runs mutated files through the readers, repeats one, or writes the seeds as a corpus.
#![allow(clippy::print_stdout, reason = "a program, not a library")]

use anyhow::{Context, Result, bail};
use belvedere_fuzz::campaign::{self, Case, named};
use belvedere_fuzz::readers::READERS;
use clap::Parser;
use std::path::PathBuf;
use std::time::Duration;

/// Every reader of Belvedere under mutated files.
#[derive(Parser)]
enum Args {
    /// Runs mutated files; ends with 1 after panics, with 3 at once after a hang or too much memory.
    Run {
        /// How many files, divided among the readers.
        #[arg(long, default_value_t = 20_000)]
        inputs: usize,
        /// Seed of the damage.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Only this reader, may be repeated.
        #[arg(long = "reader")]
        readers: Vec<String>,
        /// Threads.
        #[arg(long, default_value_t = 2)]
        workers: usize,
        /// Longest time of a core for one file, seconds.
        #[arg(long, default_value_t = 5.0)]
        time: f64,
    },
    /// Repeats one file: reader, seed, number.
    Replay {
        /// Reader.
        reader: String,
        /// Seed of the campaign.
        seed: u64,
        /// Number of the file.
        number: u64,
        /// Writes the file and those beside it into this folder, and leaves them there.
        #[arg(long)]
        keep: Option<PathBuf>,
    },
    /// Writes the seeds of every reader into folders of this one, as corpora of the fuzz targets.
    Corpus {
        /// Folder, such as `fuzz/corpus`.
        folder: PathBuf,
    },
    /// Lists the readers.
    List,
}

fn main() -> Result<()> {
    match Args::parse() {
        Args::Run { inputs, seed, readers, workers, time } => {
            let unknown = |name: &String| format!("there is no reader {name}; `list` names them");
            let chosen = readers.iter().map(|name| named(name).with_context(|| unknown(name)));
            let mut chosen = chosen.collect::<Result<Vec<_>>>()?;
            if chosen.is_empty() {
                chosen = READERS.iter().collect();
            }
            let outcome = campaign::run(&chosen, inputs, seed, workers.max(1), Duration::from_secs_f64(time));
            for (name, [accepted, refused]) in &outcome.counts {
                println!("{name}: {accepted} accepted, {refused} refused");
            }
            println!("slowest: {:.3} s, {}", outcome.slowest.0, outcome.slowest.1);
            outcome.panics.iter().for_each(|panic| println!("PANIC {panic}"));
            println!("{inputs} files, {} panics", outcome.panics.len());
            if !outcome.panics.is_empty() {
                bail!("{} files end in panics", outcome.panics.len());
            }
        }
        Args::Replay { reader, seed, number, keep } => {
            let reader = named(&reader).context("no such reader; `list` names them")?;
            let temporary = tempfile::tempdir()?;
            let folder = keep.as_deref().unwrap_or(temporary.path());
            std::fs::create_dir_all(folder)?;
            reader.prepare(folder)?;
            let bytes = Case { reader, seed, number }.bytes(&(reader.seeds)());
            let begun = std::time::Instant::now();
            println!("{} bytes: {:?}", bytes.len(), reader.read(&bytes, folder));
            println!("{:.3} s", begun.elapsed().as_secs_f64());
        }
        Args::Corpus { folder } => {
            for reader in READERS {
                let folder = folder.join(reader.name);
                std::fs::create_dir_all(&folder)?;
                for (k, bytes) in (reader.seeds)().iter().enumerate() {
                    std::fs::write(folder.join(format!("seed-{k}")), bytes)?;
                }
            }
            println!("{} corpora in {}", READERS.len(), folder.display());
        }
        Args::List => READERS.iter().for_each(|reader| println!("{}", reader.name)),
    }
    Ok(())
}
