//! Runs mutated files through the readers, repeats one, or writes the seeds as a corpus.
#![allow(clippy::print_stdout, reason = "a program, not a library")]

use anyhow::{Context, Result, bail};
use belvedere_fuzz::bombs::{Blast, Budget, Fate, blast, bombs};
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
    /// Runs a program's `info` on small files that ask for much memory, each in its own process; ends with 1 if one aborts it, hangs it or
    /// makes it take more than a tenth over its budget.
    Bombs {
        /// The program.
        program: PathBuf,
        /// Its `--max-mem`, MiB; its own default without it.
        #[arg(long)]
        max_mem: Option<u64>,
        /// Limit of its address space, MiB.
        #[arg(long, default_value_t = 4096)]
        address_space: u64,
        /// What the packed files expand to, MiB.
        #[arg(long, default_value_t = 1024)]
        largest: usize,
        /// Longest time for one file, seconds.
        #[arg(long, default_value_t = 120.0)]
        time: f64,
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
        Args::Bombs { program, max_mem, address_space, largest, time } => {
            let budget = Budget { max_mem, address_space, time: Duration::from_secs_f64(time) };
            let mut bad = 0;
            let all = bombs(largest);
            for bomb in &all {
                let Blast { name, fate, peak, time } = blast(&program, bomb, &budget)?;
                println!("{name}: {fate:?}, {peak} MiB, {:.2} s", time.as_secs_f64());
                bad += usize::from(fate != Fate::Answered);
            }
            println!("{} files, {bad} bad", all.len());
            if bad > 0 {
                bail!("{bad} files abort the program, hang it or take too much memory");
            }
        }
        Args::List => READERS.iter().for_each(|reader| println!("{}", reader.name)),
    }
    Ok(())
}
