//! Output for the user: one line per failure, warnings, progress, results.

use crate::common_args::Common;
use crate::options_of_keys::{Told, lifting, of_argument, of_data};
use crate::stdin::Stdin;
use crate::timings::Timings;
use belvedere::answers::{self, Content, Written};
use belvedere::core::{PinholeError, plain};
use belvedere::io::IoError;
use belvedere::picture::PictureOptions;
use belvedere::request::OfData;
use belvedere::scene::Progress;
use belvedere::scene_file::DocumentKind;
use belvedere::verbs::open_files::scene_of_data;
use belvedere::{BelvedereError, DocumentError, Needs, OpenOptions, Session, Trust, Warning};
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Time between two progress lines where standard error is not a terminal.
const BETWEEN_LINES: Duration = Duration::from_secs(10);
/// Work shorter than this shows no progress bar.
const QUIET_FOR: Duration = Duration::from_millis(500);

/// Most characters of an error.
const LONGEST: usize = 480;

/// Prints `belvedere: text` on standard error, on one line; ignores a closed pipe.
pub(crate) fn complain(text: &str) {
    let _ = writeln!(std::io::stderr(), "belvedere: {}", plain::escaped(text));
}

/// Prints an error, of at most [`LONGEST`] characters.
pub(crate) fn fail(text: &str) {
    complain(&plain::shortened(&plain::escaped(text), LONGEST));
}

/// Whether an output is standard output.
pub(crate) fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

/// An error as one line.
pub(crate) fn one_line(error: &anyhow::Error) -> String {
    let mut text = error.to_string();
    // Not where the command says more before it.
    if let Some(library) = error.chain().next().and_then(|e| e.downcast_ref::<BelvedereError>()) {
        text = in_options(library);
    }
    let words = |cause: &(dyn std::error::Error + 'static)| match cause.downcast_ref::<std::io::Error>() {
        Some(error) => belvedere::io::said(error),
        None => cause.to_string(),
    };
    for cause in error.chain().skip(1).map(words) {
        // Errors that show their cause themselves also name it as their source.
        if !shows(&text, &cause) {
            text = format!("{text}: {cause}");
        }
    }
    let text = relative(&text);
    text.split('\n').map(str::trim).filter(|l| !l.is_empty()).collect::<Vec<_>>().join("; ")
}

/// Whether a text holds a cause, whose file it may name in another way.
fn shows(text: &str, cause: &str) -> bool {
    let of_file = cause.split_once(": ").filter(|(file, _)| Path::new(file).is_absolute());
    text.contains(cause) || of_file.is_some_and(|(_, reason)| text.contains(reason))
}

/// A text in which files below the working folder are named from there, as users name them.
pub(crate) fn relative(text: &str) -> String {
    match std::env::current_dir().and_then(std::fs::canonicalize) {
        Ok(here) if here.parent().is_some() => {
            text.replace(&format!("{}{}", here.display(), std::path::MAIN_SEPARATOR), "")
        }
        _ => text.to_owned(),
    }
}

/// An error of the library as a message for the command line, which names the options that lift it.
fn in_options(error: &BelvedereError) -> String {
    match error {
        BelvedereError::FieldOfView { .. } | BelvedereError::UnusualFieldOfView { .. } => format!("--fov: {error}"),
        BelvedereError::NoRenderer { .. } => format!("--renderer: {error}"),
        BelvedereError::Highlight(_) => format!("--highlight: {error}"),
        BelvedereError::Appearance { option, .. } => format!("--{option}: {error}"),
        BelvedereError::Setting(_) => format!("--set: {error}"),
        BelvedereError::Position { what, reason } => {
            let option = match *what {
                "target" => "--look",
                "eye" => "--eye",
                "see" => "--see",
                "outside" => "--outside",
                _ => return error.to_string(),
            };
            format!("{option}: {reason}")
        }
        BelvedereError::RaySamples { .. } => format!("--samples: {error}"),
        BelvedereError::EyeIsTarget | BelvedereError::Camera(PinholeError::EyeIsTarget { .. }) => {
            "--eye and --look are the same point; look somewhere else".into()
        }
        BelvedereError::GroundAlone { ground } => {
            format!("{error}; for the ground alone: belvedere render {ground} -o x.png")
        }
        BelvedereError::NoAnimation => {
            format!("{error}, or give --along LAYER, --sweep phi or --turntable")
        }
        BelvedereError::NoSweepRange => format!("{error}; add one, or give --sweep phi=FIRST:LAST"),
        BelvedereError::Argument(advice) => advice.naming(of_argument),
        BelvedereError::Document(DocumentError::Scene { path: None, key, .. }) => {
            match key.as_deref().and_then(of_data) {
                Some(option) => format!("{option}: {error}"),
                None => error.to_string(),
            }
        }
        BelvedereError::Document(DocumentError::OtherKind { path, wanted: DocumentKind::Scene, .. }) => {
            let file = path.display();
            match scene_of_data(std::slice::from_ref(path)) {
                Ok(Some(source)) => {
                    format!("{error}; for a scene of it: belvedere show {file} -o {}.toml", source.document.title)
                }
                _ => {
                    let missing = belvedere::without_terrain(path).map_or_else(String::new, |text| format!("; {text}"));
                    format!("{error}{missing}; for a description: belvedere info {file}")
                }
            }
        }
        _ => format!("{error}{}", option_for(error).unwrap_or_default()),
    }
}

/// End of the message: the options that lift an error; `None` if no option does.
fn option_for(error: &BelvedereError) -> Option<&'static str> {
    Some(match error {
        BelvedereError::Document(error) => return option_for_document(error),
        BelvedereError::Frame { source, .. } => return option_for(source),
        BelvedereError::Io(error) => return option_for_io(error),
        BelvedereError::Render(belvedere::scene::RenderError::TooLarge { .. }) | BelvedereError::OnePiece { .. } => {
            " (--size, --samples, --max-mem)"
        }
        BelvedereError::Paper(paper) => match paper.key {
            "paper" => " (--paper)",
            "margin_mm" => " (--margin-mm)",
            _ => " (--dpi)",
        },
        BelvedereError::RayEnd { .. } => "; give a larger --far",
        BelvedereError::NoRayEnd => "; give --far or camera.far",
        BelvedereError::FramesThere { resumable: true, .. } => {
            "; go on with --resume, or replace them with --overwrite"
        }
        BelvedereError::FramesThere { .. } => "; start anew with --overwrite, or choose another output",
        BelvedereError::Interrupted { .. } => "; the same command with --resume goes on from there",
        _ => return lifting(error.lifted_by()),
    })
}

/// The same for errors of documents.
fn option_for_document(error: &DocumentError) -> Option<&'static str> {
    match error {
        DocumentError::Path { root_missing: true, .. } => {
            Some(" with --allow-root DIR, or for good with: belvedere trust SCENE")
        }
        DocumentError::Scene { source: Some(source), .. } => option_for_document(source),
        DocumentError::Io(error) => option_for_io(error),
        _ => None,
    }
}

/// The same for errors of files.
fn option_for_io(error: &IoError) -> Option<&'static str> {
    match error {
        IoError::Exists { .. } => Some("; give --overwrite to replace it"),
        _ => lifting(error.lifted_by()),
    }
}

/// Options, progress and cancellation of one run.
pub(crate) struct Context {
    pub(crate) common: Common,
    pub(crate) progress: Progress,
    /// Files outside their folders that scenes may read.
    pub(crate) trust: Trust,
    pub(crate) timings: Timings,
    pub(crate) stdin: Stdin,
    bar: Arc<Mutex<Option<indicatif::ProgressBar>>>,
}

impl Context {
    /// Installs the progress bar.
    ///
    /// * `many_pictures`: the time limit applies to each picture, not to the whole command.
    pub(crate) fn new(common: Common, many_pictures: bool) -> Self {
        let bar: Arc<Mutex<Option<indicatif::ProgressBar>>> = Arc::default();
        let progress = match (common.quiet, std::io::stderr().is_terminal()) {
            (true, _) => Progress::silent(),
            (false, true) => with_bar(Arc::clone(&bar)),
            (false, false) => with_lines(),
        };
        let progress = match common.time_limit {
            Some(seconds) if many_pictures => progress.limited(Duration::from_secs_f64(seconds)),
            Some(seconds) => progress.limited(Duration::from_secs_f64(seconds)).begin(),
            None => progress,
        };
        let trust = if common.no_remember { Trust::default() } else { Trust::of_user() };
        Self { common, progress, trust, timings: Timings::begin(), stdin: Stdin::default(), bar }
    }

    /// Removes the progress bar.
    pub(crate) fn finish(&self) {
        if let Ok(mut slot) = self.bar.lock()
            && let Some(bar) = slot.take()
        {
            bar.finish_and_clear();
        }
    }

    /// Opens a scene with the options of the run.
    pub(crate) fn open(&self, scene: &Path, needs: Needs, image: Option<[u32; 2]>) -> anyhow::Result<Session> {
        self.open_with(scene, &self.options(needs, image))
    }

    /// The same with other options.
    pub(crate) fn open_with(&self, scene: &Path, options: &OpenOptions) -> anyhow::Result<Session> {
        Ok(Session::from_document(self.stdin.scene(scene)?, options)?)
    }

    /// A picture with the threads, memory and progress of the run.
    pub(crate) fn running(&self, mut picture: PictureOptions) -> PictureOptions {
        picture.quality.threads = self.common.threads;
        picture.quality.max_bytes = belvedere::io::budget::bytes();
        PictureOptions { progress: self.progress.clone(), ..picture }
    }

    /// Opens a scene, or data that can be drawn without one.
    pub(crate) fn open_drawable(
        &self,
        input: &PathBuf,
        said: &OfData,
        options: &OpenOptions,
    ) -> anyhow::Result<Session> {
        Ok(Session::from_document(self.stdin.drawable(std::slice::from_ref(input), said)?, options)?)
    }

    /// The options of the run.
    pub(crate) fn options(&self, needs: Needs, image: Option<[u32; 2]>) -> OpenOptions {
        OpenOptions {
            allow_roots: self.common.allow_root.clone(),
            trust: self.trust.clone(),
            needs,
            image,
            seed: self.common.seed,
            fonts: self.common.font.clone(),
            max_bytes: self.common.budget(),
            progress: self.progress.clone(),
            ..OpenOptions::default()
        }
    }

    /// Remembers that a scene that this command wrote may read the files that it was made from: the user gave or allowed them.
    pub(crate) fn remember(&self, scene: &Path, session: &Session) {
        if let Err(e) = self.trust.remember(scene, &session.outside(scene)) {
            self.warn(&[format!(
                "{}: its files are not remembered: {e}; it opens with --allow-root DIR",
                scene.display()
            )]);
        }
    }

    /// Prints what a verb has to say: on standard output, or on standard error where a picture goes there.
    pub(crate) fn say(&self, text: &str, out: &Path) -> anyhow::Result<()> {
        if is_stdout(out) {
            let _ = write!(std::io::stderr(), "{}", plain::escaped_lines(text));
            return Ok(());
        }
        print(text)
    }

    /// Prints the text of each warning or missed goal on standard error.
    pub(crate) fn warn(&self, warnings: &[impl Told]) {
        self.finish();
        if !self.common.quiet {
            for warning in warnings {
                complain(&format!("warning: {}", warning.told()));
            }
        }
    }

    /// Writes the text of a verb into `out`, or prints it on standard output.
    pub(crate) fn deliver(
        &self,
        verb: &'static str,
        out: Option<&Path>,
        text: &str,
        warnings: &[Warning],
    ) -> anyhow::Result<()> {
        match out.filter(|path| !is_stdout(path)) {
            Some(path) => {
                belvedere::output::write_text(path, text, self.common.overwrite)?;
                if self.common.json {
                    self.print(verb, &[path.to_owned()], &Written { warnings: warnings.to_vec() })?;
                }
            }
            None => print(text)?,
        }
        self.warn(warnings);
        Ok(())
    }

    /// Writes the answer of a verb into `out`, and prints it with `--json` or where there is no file.
    pub(crate) fn deliver_answer(
        &self,
        verb: &'static str,
        out: Option<&Path>,
        content: &impl Content,
        warnings: &[Warning],
    ) -> anyhow::Result<()> {
        let file: Vec<PathBuf> = out.filter(|path| !is_stdout(path)).map(Path::to_owned).into_iter().collect();
        if let [path] = &file[..] {
            belvedere::output::write_text(path, &answers::line_in_file(verb, &file, content)?, self.common.overwrite)?;
        }
        if file.is_empty() || self.common.json {
            self.print(verb, &file, content)?;
        }
        self.warn(warnings);
        Ok(())
    }

    /// Prints the answer of a verb as one line of JSON.
    pub(crate) fn print(&self, verb: &'static str, outputs: &[PathBuf], content: &impl Content) -> anyhow::Result<()> {
        print(&answers::line(verb, outputs, content)?)
    }
}

/// Prints a text on standard output; a closed pipe is not an error.
pub(crate) fn print(text: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(plain::escaped_lines(text).as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(anyhow::anyhow!("standard output: {e}")),
        _ => Ok(()),
    }
}

fn with_bar(slot: Arc<Mutex<Option<indicatif::ProgressBar>>>) -> Progress {
    let started = Instant::now();
    Progress::new(move |stage, done| {
        if started.elapsed() < QUIET_FOR {
            return;
        }
        let Ok(mut slot) = slot.lock() else { return };
        let bar = slot.get_or_insert_with(|| {
            let bar = indicatif::ProgressBar::new(1000);
            if let Ok(style) =
                indicatif::ProgressStyle::with_template("[{bar:30}] {percent:>3} %, about {eta} left: {msg}")
            {
                bar.set_style(style);
            }
            bar
        });
        bar.set_message(stage.to_owned());
        bar.set_position((done.clamp(0.0, 1.0) * 1000.0) as u64);
    })
}

/// Progress for standard error that is not a terminal: a line from time to time.
fn with_lines() -> Progress {
    let said = Mutex::new(Instant::now());
    Progress::new(move |stage, done| {
        if let Ok(mut said) = said.lock()
            && said.elapsed() >= BETWEEN_LINES
        {
            *said = Instant::now();
            complain(&format!("{:.0} %: {stage}", 100.0 * done));
        }
    })
}
