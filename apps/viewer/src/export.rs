//! Export of a picture of any size, an animation or a report: in the background, with progress and cancellation.

use crate::files::Choosing;
use crate::language::{fill, heard, later, tr};
use crate::menu::Bookmark;
use crate::model::Model;
use crate::wake::Wake;
use belvedere::picture::PictureOptions;
use belvedere::placed::Place;
use belvedere::request::Measure;
use belvedere::scene::Progress;
use belvedere::scene_file::{AnimationDoc, Document, LayerDoc, PointDoc, SweepDoc, TurntableDoc};
use belvedere::verbs::animate::{AnimateRequest, animate};
use belvedere::verbs::measure::measure;
use belvedere::{BelvedereError, RendererName, output};
use belvedere_studio::beside;
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
    /// Along a line layer.
    Route,
    /// Through the bookmarks.
    Bookmarks,
}

/// The panel and its running export.
pub(crate) struct Exporter {
    film: Film,
    /// Duration, seconds, and frames per second; `None`: as the motion needs.
    seconds: Option<f64>,
    rate: f64,
    /// Id of the line layer that is followed.
    route: Option<String>,
    job: Option<Job>,
    /// What the user chooses an output for, and the open question.
    chosen: Option<(Want, Choosing)>,
}

impl Default for Exporter {
    fn default() -> Self {
        Self { film: Film::default(), seconds: Some(10.0), rate: RATE, route: None, job: None, chosen: None }
    }
}

/// Usual frames per second.
const RATE: f64 = 25.0;

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
    pub(crate) fn show(&mut self, ui: &mut Ui, model: &mut Model, bookmarks: &[Bookmark]) {
        let (mut image, mut by) = (model.document().camera.image, None);
        ui.horizontal_wrapped(|ui| {
            for (pixels, name) in image.iter_mut().zip([tr("Width, pixels"), tr("Height, pixels")]) {
                let label = ui.label(name);
                let field = ui
                    .add(DragValue::new(pixels).range(16..=16384).clamp_existing_to_range(false))
                    .labelled_by(label.id);
                by = by.or(model.changed(&field));
            }
        });
        if let Some(by) = by {
            model.edit_on(by, |document| document.camera.image = image);
        }
        let idle = self.job.is_none() && self.chosen.is_none();
        // What stands below keeps its identity when the window gets another shape.
        ui.scope(|ui| {
            let Some([w, h]) = model.screen_size().filter(|size| *size != image) else { return };
            let button = ui.button(tr("As the window"));
            if button.on_hover_text(fill(tr("{0} x {1} pixels, the shape of the window"), &[&w, &h])).clicked() {
                model.edit(|document| document.camera.image = [w, h]);
            }
        });
        ui.separator();
        ui.add_enabled_ui(idle, |ui| {
            if ui.button(tr("Export picture…")).clicked() {
                self.ask(model, Want::Picture, "picture.png");
            }
            ui.vertical(|ui| {
                let why = self.film_lacks(model, bookmarks);
                let film = ui.add_enabled(FILMS && why.is_none(), Button::new(tr("Export film…")));
                let why = if FILMS { why.unwrap_or_default() } else { tr(NO_FILMS) };
                if film.on_disabled_hover_text(why).clicked() {
                    self.ask(model, Want::Film, "film.mp4");
                }
                self.motion(ui, model);
            });
            if ui
                .button(tr("Export report…"))
                .on_hover_text(tr("what the picture shows of what must be seen"))
                .clicked()
            {
                self.ask(model, Want::Report, "report.json");
            }
        });
        self.follow(ui);
    }

    /// Why the chosen film cannot be made.
    fn film_lacks(&self, model: &Model, bookmarks: &[Bookmark]) -> Option<&'static str> {
        match self.film {
            Film::Scene if model.document().animation.is_none() => Some(tr("the scene has no motion; choose another")),
            Film::Route if lines(model).is_empty() => Some(tr("there is no route")),
            Film::Bookmarks if bookmarks.len() < 2 => {
                Some(tr("it needs two bookmarks at least: press B at each place"))
            }
            _ => None,
        }
    }

    /// Motion, duration and rate of a film.
    fn motion(&mut self, ui: &mut Ui, model: &Model) {
        let name = |film: Film| match film {
            Film::Scene => tr("motion of the scene"),
            Film::Sweep => tr("viewing angle 10 to 80 degrees"),
            Film::Turntable => tr("once around"),
            Film::Route => tr("along a route"),
            Film::Bookmarks => tr("past the bookmarks"),
        };
        ComboBox::from_label(tr("Film")).selected_text(name(self.film)).show_ui(ui, |ui| {
            for one in [Film::Scene, Film::Route, Film::Bookmarks, Film::Sweep, Film::Turntable] {
                ui.selectable_value(&mut self.film, one, name(one));
            }
        });
        let lines = lines(model);
        if self.film == Film::Route && !lines.is_empty() {
            let route = self.route.take().filter(|route| lines.contains(route)).unwrap_or_else(|| lines[0].clone());
            let route = self.route.insert(route);
            ComboBox::from_label(tr("Route")).selected_text(route.as_str()).show_ui(ui, |ui| {
                for line in &lines {
                    ui.selectable_value(route, line.clone(), line);
                }
            });
        }
        let mut own = self.seconds.is_some();
        let words = tr("otherwise as long as its motion says");
        if ui.checkbox(&mut own, tr("duration of the film")).on_hover_text(words).changed() {
            self.seconds = own.then_some(10.0);
        }
        ui.horizontal_wrapped(|ui| {
            if let Some(seconds) = &mut self.seconds {
                let label = ui.label(tr("Seconds"));
                ui.add(DragValue::new(seconds).speed(0.1).range(0.1..=3600.0).max_decimals(1)).labelled_by(label.id);
            }
            let label = ui.label(tr("Frames per second"));
            ui.add(DragValue::new(&mut self.rate).speed(0.2).range(1.0..=120.0).max_decimals(2)).labelled_by(label.id);
        });
        match self.seconds {
            _ if self.is_scenes_own() => {
                drop(ui.weak(tr("Length and rate of the scene's own motion until you change them.")))
            }
            Some(seconds) => drop(ui.weak(fill(tr("Frames: {0}"), &[&frames(seconds, self.rate)]))),
            None => {}
        }
    }

    /// Whether the film has the length and rate of the scene's own motion: others were not asked for.
    fn is_scenes_own(&self) -> bool {
        let usual = Self::default();
        self.film == Film::Scene && (!FILMS || (self.rate, self.seconds) == (usual.rate, usual.seconds))
    }

    /// The chosen motion as the scene file states it; bookmarks are written to a file beside the film.
    fn animation(&self, path: &Path, bookmarks: &[Bookmark]) -> Result<AnimationDoc, String> {
        let own = self.is_scenes_own();
        let fps = (FILMS && !own).then_some(self.rate);
        let frames = self.seconds.filter(|_| !own).map(|seconds| frames(seconds, self.rate));
        let plain = AnimationDoc { fps, frames, ..AnimationDoc::default() };
        Ok(match self.film {
            Film::Scene => plain,
            Film::Sweep => {
                // One step of half a degree per frame, unless the number of frames is stated.
                let step = frames.map_or(0.5, |frames| 70.0 / f64::from(frames.max(2) - 1));
                AnimationDoc { sweep: Some(SweepDoc { phi_deg: [10.0, 80.0, step] }), frames: None, ..plain }
            }
            Film::Turntable => {
                let deg_per_s = self.seconds.map_or(36.0, |seconds| 360.0 / seconds);
                AnimationDoc { turntable: Some(TurntableDoc { deg_per_s }), ..plain }
            }
            Film::Route => AnimationDoc { along: self.route.clone(), ..plain },
            Film::Bookmarks => {
                let stem = path.file_stem().unwrap_or_default().to_string_lossy();
                let text = cameras(bookmarks).to_string();
                let mut file = path.with_extension("cameras.json");
                // Cameras of an earlier film stay.
                if std::fs::read_to_string(&file).is_ok_and(|earlier| earlier != text) {
                    file = crate::files::free_name(path.parent().unwrap_or(Path::new("")), &stem, "cameras.json");
                }
                output::write_text(&file, &text, true).map_err(|e| e.to_string())?;
                AnimationDoc { camera: Some(file.display().to_string()), ..plain }
            }
        })
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
        ui.label(format!("{}: {}", tr(job.name), heard(stage)));
        ui.add(ProgressBar::new(*share as f32).show_percentage());
        if ui.button(tr("Cancel export")).clicked() {
            job.progress.cancel_flag().store(true, Ordering::Relaxed);
        }
        ui.ctx().request_repaint_after_secs(0.1);
    }

    /// Takes the chosen file and the result of the running export, whatever panel is shown.
    pub(crate) fn poll(&mut self, ctx: &Context, model: &mut Model, bookmarks: &[Bookmark]) {
        if let Some((want, choosing)) = &mut self.chosen
            && let Some(answer) = choosing.answer(ctx)
        {
            let want = *want;
            self.chosen = None;
            match answer {
                Ok(paths) => paths.iter().take(1).for_each(|path| self.begin(want, path, (model, bookmarks), ctx)),
                Err(reason) => model.notices.error(reason),
            }
        }
        let Some(job) = &mut self.job else { return };
        let now = ctx.input(|input| input.time);
        match job.done.try_recv() {
            Ok(Ok(written)) => {
                let names: Vec<String> = written.iter().map(|path| path.display().to_string()).collect();
                model.notices.say(fill(tr("Written: {0}"), &[&names.join(", ")]), now);
                for reason in written.iter().filter_map(|path| crate::files::hand_over(path).err()) {
                    model.notices.error(reason);
                }
            }
            Ok(Err(e)) if e.is_cancelled() => model.notices.say(tr("Export cancelled"), now),
            Ok(Err(e)) => model.notices.error(e.to_string()),
            Err(mpsc::TryRecvError::Empty) => return,
            Err(mpsc::TryRecvError::Disconnected) => model.notices.error(tr("the export ended without a word")),
        }
        self.job = None;
    }

    fn begin(&mut self, want: Want, path: &Path, (model, bookmarks): (&mut Model, &[Bookmark]), ctx: &Context) {
        let (document, mut place) = ((**model.document()).clone(), model.editor.place.clone());
        let animation = match want {
            Want::Film => self.animation(path, bookmarks),
            Want::Picture | Want::Report => Ok(AnimationDoc::default()),
        };
        let animation = match animation {
            Ok(animation) => animation,
            Err(reason) => return model.notices.error(reason),
        };
        if animation.camera.is_some() {
            place.roots.allowed.extend(path.parent().map(Path::to_owned));
        }
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
            Want::Picture => later("Picture"),
            Want::Film => later("Animation"),
            Want::Report => later("Report"),
        };
        if let Err(e) = beside(work) {
            model.notices.error(e);
            return;
        }
        self.job = Some(Job { name, progress, at, last: Default::default(), done });
    }
}

const NO_FILMS: &str = later("in a browser there are no films; save the scene and make the film with the command line");

/// Number of frames of a duration in seconds.
fn frames(seconds: f64, rate: f64) -> u32 {
    (seconds * rate).round().max(1.0) as u32
}

/// Ids of the layers that a film can follow.
fn lines(model: &Model) -> Vec<String> {
    model.layer_ids(|layer| matches!(layer, LayerDoc::Line(_)))
}

/// The cameras of the bookmarks as a file of saved cameras states them; those that are given by a rule are left out.
fn cameras(bookmarks: &[Bookmark]) -> serde_json::Value {
    let one = |bookmark: &Bookmark| {
        let camera = &bookmark.camera;
        let (PointDoc::Scene(eye), Some(PointDoc::Scene(look_at))) = (&camera.eye, &camera.look_at) else {
            return None;
        };
        Some(serde_json::json!({ "eye": eye, "look_at": look_at, "up": camera.up, "fov_y_deg": camera.fov_y_deg }))
    };
    bookmarks.iter().filter_map(one).collect()
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
            let cameras = animation.camera.as_deref().filter(|name| name.ends_with(".cameras.json")).map(PathBuf::from);
            let request = AnimateRequest { animation, picture, out, overwrite: true, ..AnimateRequest::default() };
            let made = animate(&session, &request, progress)?;
            Ok([made.folder].into_iter().chain(cameras).collect())
        }
        Want::Report => {
            let report = measure(&session, &Measure { renderer: RendererName::CPU, ..Measure::default() }, progress)?;
            output::write_text(path, &output::pretty(&report)?, true)?;
            Ok(vec![path.to_owned()])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_of_the_viewing_angle_runs_from_10_to_80_degrees_in_its_time() {
        for (seconds, rate) in [(2.0, 8.0), (10.0, RATE)] {
            let exporter = Exporter { film: Film::Sweep, seconds: Some(seconds), rate, ..Exporter::default() };
            let animation = exporter.animation(Path::new("film.mp4"), &[]).expect("an animation");
            let [from, to, step] = animation.sweep.expect("a sweep").phi_deg;
            assert_eq!([from, to], [10.0, 80.0], "as the choice says");
            assert!(((to - from) / step + 1.0 - seconds * rate).abs() < 1e-9, "{step} degrees a frame");
        }
    }
}
