//! Export of a picture of any size, an animation or a report: in the background, with progress and cancellation.

use crate::files::Choosing;
use crate::model::Model;
use crate::wake::Wake;
use belvedere::editor::{Place, beside};
use belvedere::picture::PictureOptions;
use belvedere::scene::Progress;
use belvedere::scene_file::{AnimationDoc, Document, SweepDoc, TurntableDoc};
use belvedere::verbs::animate::{AnimateRequest, animate};
use belvedere::verbs::measure::{MeasureOptions, measure};
use belvedere::{BelvedereError, RendererChoice, output};
use eframe::egui::{Button, ComboBox, Context, DragValue, ProgressBar, Ui};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, mpsc};

/// Whether films can be made: they need a folder of frames and an encoder program.
const FILMS: bool = cfg!(not(target_family = "wasm"));

/// Motion of a film.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Film {
    /// The animation of the scene file.
    #[default]
    Scene,
    /// The viewing angle rises.
    Sweep,
    /// Once around.
    Turntable,
}

/// The panel and its running export.
#[derive(Default)]
pub(crate) struct Exporter {
    film: Film,
    job: Option<Job>,
    /// What the user chooses an output for, and the open question.
    chosen: Option<(Want, Choosing)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Want {
    Picture,
    Film,
    Report,
}

/// An export that runs in the background.
struct Job {
    name: &'static str,
    progress: Progress,
    at: Arc<Mutex<(String, f64)>>,
    /// Stage and share that were read last.
    last: (String, f64),
    /// Files that were written, or the error.
    done: mpsc::Receiver<Result<Vec<PathBuf>, BelvedereError>>,
}

impl Exporter {
    /// Shows the panel.
    pub(crate) fn show(&mut self, ui: &mut Ui, model: &mut Model) {
        let mut image = model.document().camera.image;
        ui.horizontal(|ui| {
            let label = ui.label("Width, pixels");
            ui.add(DragValue::new(&mut image[0]).range(16..=16384)).labelled_by(label.id);
            let label = ui.label("Height, pixels");
            ui.add(DragValue::new(&mut image[1]).range(16..=16384)).labelled_by(label.id);
        });
        if image != model.document().camera.image {
            model.edit_on(|document| document.camera.image = image);
        }
        let idle = self.job.is_none() && self.chosen.is_none();
        ui.add_enabled_ui(idle, |ui| {
            if ui.button("Export picture…").clicked() {
                self.ask(model, Want::Picture, "picture.png");
            }
            ui.vertical(|ui| {
                let film = ui.add_enabled(FILMS, Button::new("Export animation…"));
                let film =
                    film.on_disabled_hover_text("in a browser there are no films; save the scene and animate it");
                if film.clicked() {
                    self.ask(model, Want::Film, "animation.mp4");
                }
                let name = |film: Film| match film {
                    Film::Scene => "as the scene says",
                    Film::Sweep => "viewing angle 10 to 80 degrees",
                    Film::Turntable => "once around",
                };
                ComboBox::from_label("Animation").selected_text(name(self.film)).show_ui(ui, |ui| {
                    for one in [Film::Scene, Film::Sweep, Film::Turntable] {
                        ui.selectable_value(&mut self.film, one, name(one));
                    }
                });
            });
            if ui.button("Export report…").on_hover_text("what the picture shows of what must be seen").clicked() {
                self.ask(model, Want::Report, "report.json");
            }
        });
        self.follow(ui);
    }

    fn ask(&mut self, model: &Model, want: Want, name: &str) {
        let folder = &model.editor.place.roots.scene_dir;
        self.chosen = Some((want, crate::files::choose_output(folder, name, model.system_dialogs)));
    }

    /// Shows progress and the cancel button.
    fn follow(&mut self, ui: &mut Ui) {
        let Some(job) = &mut self.job else { return };
        // The main thread of a browser must not block on a lock.
        if let Ok(at) = job.at.try_lock() {
            job.last = at.clone();
        }
        let (stage, share) = &job.last;
        ui.label(format!("{}: {stage}", job.name));
        ui.add(ProgressBar::new(*share as f32).show_percentage());
        if ui.button("Cancel export").clicked() {
            job.progress.cancel_flag().store(true, Ordering::Relaxed);
        }
        ui.ctx().request_repaint_after_secs(0.1);
    }

    /// Takes the chosen file and the result of the running export, whatever panel is shown.
    pub(crate) fn poll(&mut self, ctx: &Context, model: &mut Model) {
        if let Some((want, choosing)) = &mut self.chosen
            && let Some(answer) = choosing.answer(ctx)
        {
            let want = *want;
            self.chosen = None;
            match answer {
                Ok(paths) => paths.iter().take(1).for_each(|path| self.begin(want, path, model, ctx)),
                Err(reason) => model.notices.error(reason),
            }
        }
        let Some(job) = &mut self.job else { return };
        let now = ctx.input(|input| input.time);
        match job.done.try_recv() {
            Ok(Ok(written)) => {
                let names: Vec<String> = written.iter().map(|path| path.display().to_string()).collect();
                model.notices.say(format!("Written: {}", names.join(", ")), now);
                for reason in written.iter().filter_map(|path| crate::files::hand_over(path).err()) {
                    model.notices.error(reason);
                }
            }
            Ok(Err(e)) if e.is_cancelled() => model.notices.say("Export cancelled", now),
            Ok(Err(e)) => model.notices.error(e.to_string()),
            Err(mpsc::TryRecvError::Empty) => return,
            Err(mpsc::TryRecvError::Disconnected) => model.notices.error("the export ended without a word"),
        }
        self.job = None;
    }

    fn begin(&mut self, want: Want, path: &Path, model: &mut Model, ctx: &Context) {
        let (document, place) = ((**model.document()).clone(), model.editor.place.clone());
        let animation = match self.film {
            Film::Scene => AnimationDoc::default(),
            Film::Sweep => {
                AnimationDoc { sweep: Some(SweepDoc { phi_deg: [10.0, 80.0, 0.5] }), ..AnimationDoc::default() }
            }
            Film::Turntable => {
                AnimationDoc { turntable: Some(TurntableDoc { deg_per_s: 36.0 }), ..AnimationDoc::default() }
            }
        };
        let at = Arc::new(Mutex::new((String::new(), 0.0)));
        let told = at.clone();
        let progress = Progress::new(move |stage, share| {
            if let Ok(mut at) = told.lock() {
                *at = (stage.to_owned(), share);
            }
        });
        let (outbox, done) = mpsc::channel();
        let (own, path, wake) = (progress.clone(), path.to_owned(), Wake::new(ctx));
        let work = move || {
            let result = make(want, document, &place, &path, animation, &own);
            let _ = outbox.send(result);
            wake.call();
        };
        let name = match want {
            Want::Picture => "Picture",
            Want::Film => "Animation",
            Want::Report => "Report",
        };
        if let Err(e) = beside(work) {
            model.notices.error(e);
            return;
        }
        self.job = Some(Job { name, progress, at, last: Default::default(), done });
    }
}

fn make(
    want: Want,
    document: Document,
    place: &Place,
    path: &Path,
    animation: AnimationDoc,
    progress: &Progress,
) -> Result<Vec<PathBuf>, BelvedereError> {
    let session = place.session(document, progress)?;
    let picture = PictureOptions { progress: progress.clone(), ..PictureOptions::default() };
    match want {
        Want::Picture => {
            output::check(path, &session.input_paths(), true)?;
            session.render(&picture)?.write(path, true)
        }
        Want::Film => {
            let out = path.to_owned();
            let request = AnimateRequest { animation, picture, out, resume: false, overwrite: true };
            let made = animate(&session, &request, progress)?;
            Ok(vec![made.folder])
        }
        Want::Report => {
            let report = measure(&session, &MeasureOptions::default(), RendererChoice::Cpu, progress)?;
            output::write_text(path, &output::pretty(&report)?, true)?;
            Ok(vec![path.to_owned()])
        }
    }
}
