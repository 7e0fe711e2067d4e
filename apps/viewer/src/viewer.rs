//! The application as a whole: opening, saving, kept state; panels around the picture.

use crate::builtin::BUILTIN;
use crate::consent::{self, Consent, Decision};
use crate::files;
use crate::keys::{self, Command};
use crate::menu::{self, Bookmark, Choice};
use crate::model::{Look, Model};
use crate::panels::{Panels, Tab, set_stage};
use crate::picture::{PictureView, image_of_frame};
use crate::times::Times;
use crate::wake::Wake;
use crate::widgets::overhead::overhead;
use belvedere::Trust;
use belvedere::editor::{Editor, Place, Recovery, beside};
use belvedere::io::fs;
use belvedere::scene::Progress;
use belvedere::scene_file::{self, CameraDoc, StageDoc};
use belvedere::verbs::open_files::{Opened, open_beside, open_trusted};
use eframe::egui::{self, CentralPanel, Context, Panel, TextureHandle, TextureOptions, Ui, ViewportCommand, Window};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError};
use std::sync::{Arc, Mutex};

/// What to open at the start.
#[derive(Debug, Clone, Default)]
pub struct Opening {
    /// A scene, or data files; empty: the first built-in scene.
    pub files: Vec<PathBuf>,
    /// Folders beside that of a scene from which its files may come.
    pub allowed: Vec<PathBuf>,
    /// Files outside their folders that scenes may read.
    pub trust: Trust,
    /// Folder of the state that is kept between runs; `None`: nothing is kept.
    pub state: Option<PathBuf>,
    /// Whether files are chosen in windows of the system, if it has any; else in windows of the application.
    pub system_dialogs: bool,
}

impl Opening {
    /// The usual folder of the kept state.
    #[cfg(not(target_family = "wasm"))]
    pub fn usual_state() -> Option<PathBuf> {
        files::state_folder()
    }
}

/// Recent files that are remembered.
const RECENT: usize = 12;
/// Time between a change and its entry in the recovery file, seconds.
const WRITE_AFTER: f64 = 0.4;

/// State that is kept between runs.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default)]
struct Remembered {
    recent: Vec<PathBuf>,
    /// Bookmarks of each scene file.
    bookmarks: BTreeMap<PathBuf, Vec<Bookmark>>,
}

/// A file that is being opened in the background, and the progress in words.
struct Pending {
    opened: Receiver<Result<Opened, Refusal>>,
    at: Arc<Mutex<String>>,
}

/// Why files are not opened.
enum Refusal {
    Reason(String),
    Asks(Consent),
}

/// State of the window that the recovery file holds beside the document.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
struct Extra {
    look: Look,
    tab: Tab,
    bookmarks: Vec<Bookmark>,
}

/// The application.
pub struct Viewer {
    model: Model,
    panels: Panels,
    picture: PictureView,
    from_above: Option<(u64, TextureHandle)>,
    bookmarks: Vec<Bookmark>,
    remembered: Remembered,
    allowed: Vec<PathBuf>,
    trust: Trust,
    consent: Option<Consent>,
    state: Option<PathBuf>,
    recovery: Option<Recovery>,
    /// Last content of the recovery file, and the time since which the state differs from it.
    written: Option<(Arc<scene_file::Document>, Extra)>,
    dirty_since: Option<f64>,
    pending: Option<Pending>,
    dropped: Option<files::Inputs>,
    chosen_input: Option<files::Choosing>,
    chosen_output: Option<files::Choosing>,
    help: bool,
    times: Times,
    wake: Wake,
}

impl Viewer {
    /// Opens the given files. After an instance that did not end properly its scene is restored, or kept in a file if others are opened.
    pub fn new(ctx: &Context, opening: &Opening) -> Self {
        let wake = Wake::new(ctx);
        let mut notes = Vec::new();
        let (recovery, left) = match opening.state.as_deref().map(Recovery::claim) {
            Some(Ok((recovery, left))) => (Some(recovery), left),
            Some(Err(e)) => {
                notes.push(format!("what you do is not written down for the case of a crash: {e}"));
                (None, None)
            }
            None => (None, None),
        };
        let first = builtin(0);
        let mut viewer = Self {
            model: Model::new(first, {
                let wake = wake.clone();
                move || wake.call()
            }),
            wake,
            panels: Panels::default(),
            picture: PictureView::default(),
            from_above: None,
            bookmarks: Vec::new(),
            remembered: opening.state.as_deref().map_or_else(Remembered::default, remembered),
            allowed: opening.allowed.clone(),
            trust: opening.trust.clone(),
            consent: None,
            state: opening.state.clone(),
            recovery,
            written: None,
            dirty_since: None,
            pending: None,
            dropped: None,
            chosen_input: None,
            chosen_output: None,
            help: false,
            times: Times::default(),
        };
        viewer.model.system_dialogs = opening.system_dialogs;
        match left {
            Some(left) if opening.files.is_empty() => {
                viewer.replace(left.editor);
                let extra: Extra = serde_json::from_value(left.extra).unwrap_or_default();
                (viewer.model.look, viewer.panels.tab) = (extra.look, extra.tab);
                viewer.bookmarks = extra.bookmarks;
                notes.push("The last session did not end as it should; here is its last state.".into());
            }
            Some(mut left) if left.editor.is_changed() => {
                let kept = opening.state.clone().unwrap_or_default().join("recovered.toml");
                let what = match left.editor.save(&kept) {
                    Ok(()) => format!("its unsaved scene is kept in {}", kept.display()),
                    Err(e) => format!("its unsaved scene could not be kept: {e}"),
                };
                notes.push(format!("The last session did not end as it should; {what}."));
            }
            Some(_) | None => {}
        }
        if !opening.files.is_empty() {
            viewer.open(opening.files.clone());
        }
        notes.into_iter().for_each(|note| viewer.model.notices.error(note));
        viewer
    }

    /// The document as it is.
    pub fn document(&self) -> &Arc<scene_file::Document> {
        self.model.document()
    }

    /// Whether the picture on the screen is that of the document, in full.
    pub fn rests(&self) -> bool {
        self.pending.is_none() && self.model.rests()
    }

    /// Whether the shares on the screen are measured for the current document.
    pub fn is_judged(&self) -> bool {
        self.model.is_judged()
    }

    /// Wakes the window; called by its workers.
    #[cfg(target_family = "wasm")]
    pub(crate) fn wake(&self) -> &Wake {
        &self.wake
    }

    /// Numbers of pictures and their times as JSON.
    #[cfg(target_family = "wasm")]
    pub(crate) fn times(&self) -> serde_json::Value {
        self.times.report(&self.model)
    }

    /// Opens files in the background.
    fn open(&mut self, paths: Vec<PathBuf>) {
        if let [path] = paths.as_slice() {
            self.remember(path);
        }
        let (outbox, inbox) = std::sync::mpsc::channel();
        let (allowed, trust, wake) = (self.allowed.clone(), self.trust.clone(), self.wake.clone());
        let at = Arc::new(Mutex::new("opening".to_owned()));
        self.model.opening = Some("opening".into());
        let current = self.model.shown.is_some().then(|| self.model.document().clone());
        let told = at.clone();
        let progress = Progress::new(move |stage, share| {
            // The main thread of a browser must not block on a lock.
            if let Ok(mut at) = told.try_lock() {
                *at = format!("opening: {stage}, {:.0} %", 100.0 * share);
            }
        });
        let work = move || {
            let opened = match (Consent::needed(&paths, &allowed, &trust), &current) {
                (Some(consent), _) => Err(Refusal::Asks(consent)),
                (None, Some(current)) => open_beside(current, &paths, &allowed, &trust, &progress).map_err(refusal),
                (None, None) => {
                    let editor = open_trusted(&paths, &allowed, &trust, &progress).map_err(refusal);
                    editor.map(|editor| Opened::Scene(Box::new(editor)))
                }
            };
            let _ = outbox.send(opened);
            wake.call();
        };
        if let Err(e) = beside(work) {
            self.model.notices.error(e);
            self.model.opening = None;
            return;
        }
        self.pending = Some(Pending { opened: inbox, at });
    }

    fn remember(&mut self, path: &Path) {
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let recent = &mut self.remembered.recent;
        recent.retain(|other| *other != path);
        recent.insert(0, path);
        recent.truncate(RECENT);
        self.write_remembered();
    }

    /// Keeps the bookmarks of a scene that has a file.
    fn remember_bookmarks(&mut self) {
        let scene = self.model.editor.place.scene.as_ref().and_then(|path| fs::canonicalize(path).ok());
        if let Some(scene) = scene {
            self.remembered.bookmarks.insert(scene, self.bookmarks.clone());
            self.write_remembered();
        }
    }

    fn write_remembered(&self) {
        if let Some(folder) = &self.state {
            let text = serde_json::to_string(&self.remembered).unwrap_or_default();
            // Errors are ignored: nothing depends on this state.
            let _ = std::fs::create_dir_all(folder);
            let _ = belvedere::output::write_text(&folder.join("remembered.json"), &text, true);
        }
    }

    /// Another document comes in place of this one.
    fn replace(&mut self, editor: Editor) {
        let scene = editor.place.scene.as_ref().and_then(|path| fs::canonicalize(path).ok());
        let known = scene.and_then(|scene| self.remembered.bookmarks.get(&scene).cloned());
        self.bookmarks = known.unwrap_or_default();
        self.model.replace(editor);
    }

    /// Takes the files that were chosen, dropped or opened in the background.
    fn arrivals(&mut self, ctx: &Context) {
        if let Some(pending) = &self.pending {
            if let Ok(at) = pending.at.try_lock() {
                self.model.opening = Some(at.clone());
            }
            ctx.request_repaint_after_secs(0.1);
            match pending.opened.try_recv() {
                Ok(Ok(Opened::Scene(editor))) => {
                    self.replace(*editor);
                    self.pending = None;
                }
                Ok(Ok(Opened::Layers(layers, folders))) => {
                    self.model.editor.add_layers(layers, folders);
                    self.pending = None;
                }
                Ok(Err(Refusal::Reason(reason))) => {
                    self.model.notices.error(reason);
                    self.pending = None;
                }
                Ok(Err(Refusal::Asks(consent))) => {
                    self.consent = Some(consent);
                    self.pending = None;
                }
                Err(TryRecvError::Disconnected) => {
                    self.model
                        .notices
                        .error("the file could not be opened: internal error; please report this with the file");
                    self.pending = None;
                }
                Err(TryRecvError::Empty) => {}
            }
            if self.pending.is_none() {
                self.model.opening = None;
            }
        }
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        if !dropped.is_empty() {
            self.dropped = Some(files::dropped(&dropped));
        }
        let dropped = self.dropped.as_ref().and_then(|inbox| inbox.try_recv().ok());
        let chosen = self.chosen_input.as_mut().and_then(|choosing| choosing.answer(ctx));
        self.dropped.take_if(|_| dropped.is_some());
        self.chosen_input.take_if(|_| chosen.is_some());
        if let Some(answer) = dropped.or(chosen) {
            match answer {
                Ok(paths) if paths.is_empty() => {}
                Ok(paths) => self.open(paths),
                Err(reason) => self.model.notices.error(reason),
            }
        }
        if let Some(answer) = self.chosen_output.as_mut().and_then(|choosing| choosing.answer(ctx)) {
            self.chosen_output = None;
            match answer {
                Ok(paths) => paths.iter().take(1).for_each(|path| self.save(ctx, path)),
                Err(reason) => self.model.notices.error(reason),
            }
        }
        if self.dropped.is_some() {
            ctx.request_repaint_after_secs(0.1);
        }
    }

    /// Asks for the consent that a scene lacks, and opens it once it has it.
    fn ask_for_consent(&mut self, ctx: &Context) {
        let Some(decision) = self.consent.as_ref().and_then(|consent| consent.show(ctx)) else { return };
        let Some(consent) = self.consent.take().filter(|_| decision == Decision::Allowed) else { return };
        if let Err(reason) = consent.give(&mut self.trust) {
            self.model.notices.error(reason);
        }
        self.open(vec![consent.scene]);
    }

    fn save(&mut self, ctx: &Context, path: &Path) {
        match self.model.editor.save(path) {
            Ok(()) => {
                self.remember(path);
                // The recovery file is written anew, since it says whether the scene is saved.
                self.written = None;
                let mut said = format!("Saved: {}", path.display());
                match consent::remember(&mut self.trust, path, &self.model.editor.outside()) {
                    Ok(is_remembered) if is_remembered || self.model.editor.outside().is_empty() => {}
                    Ok(_) => said += "; it names files outside its folder: the command line needs --allow-root DIR",
                    Err(reason) => self.model.notices.error(reason),
                }
                self.model.notices.say(said, ctx.input(|input| input.time));
                if let Err(reason) = files::hand_over(path) {
                    self.model.notices.error(reason);
                }
            }
            Err(e) => self.model.notices.error(e.to_string()),
        }
    }

    /// Lets the user choose where to write a scene.
    fn choose_output(&mut self) {
        let (folder, system) = (&self.model.editor.place.roots.scene_dir, self.model.system_dialogs);
        self.chosen_output = Some(files::choose_output(folder, "scene.toml", system));
    }

    fn command(&mut self, ctx: &Context, command: Command) {
        match command {
            Command::Open => self.chosen_input = Some(files::choose_input(self.model.system_dialogs)),
            Command::Save => match self.model.editor.place.scene.clone() {
                Some(path) => self.save(ctx, &path),
                None => self.choose_output(),
            },
            Command::SaveAs => self.choose_output(),
            Command::Undo => {
                self.model.editor.undo();
            }
            Command::Redo => {
                self.model.editor.redo();
            }
            Command::Bookmark => {
                if let Some(camera) = self.model.camera() {
                    let taken = |name: &String| self.bookmarks.iter().any(|bookmark| bookmark.name == *name);
                    let name = (1..).map(|n| format!("View {n}")).find(|name| !taken(name)).unwrap_or_default();
                    let camera = CameraDoc::of(&camera.pinhole, camera.target);
                    self.bookmarks.push(Bookmark { name, camera });
                    self.remember_bookmarks();
                }
            }
            Command::ShowAll => {
                if let Some(bounds) = self.model.shown.as_ref().map(|shown| shown.session.scene().bounds()) {
                    self.model.begin_gesture();
                    self.model.move_camera(|camera| camera.framing(&bounds));
                }
            }
            Command::Help => self.help = !self.help,
        }
    }

    fn choose(&mut self, ctx: &Context, choice: Choice) {
        match choice {
            Choice::Command(command) => self.command(ctx, command),
            Choice::Builtin(i) => self.replace(builtin(i)),
            Choice::Recent(path) => self.open(vec![path]),
            Choice::GoTo(i) => {
                if let Some(bookmark) = self.bookmarks.get(i).cloned() {
                    let image = self.model.document().camera.image;
                    self.model.edit(|document| document.camera = CameraDoc { image, ..bookmark.camera });
                }
            }
            Choice::Forget(i) => {
                if i < self.bookmarks.len() {
                    self.bookmarks.remove(i);
                    self.remember_bookmarks();
                }
            }
            Choice::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
        }
    }

    /// Shows the camera from above in a window of its own.
    fn overhead(&mut self, ctx: &Context) {
        if !self.model.look.overhead {
            return;
        }
        let mut open = true;
        let mut edit = None;
        // In the lower right corner, where the window does not hide the side panel.
        let corner = ctx.content_rect().right_bottom() - egui::vec2(490.0, 360.0);
        Window::new("Camera from above").open(&mut open).default_pos(corner).default_width(460.0).show(ctx, |ui| {
            let Some((frame, view)) = &self.model.overhead else {
                ui.label("drawing");
                return;
            };
            if self.from_above.as_ref().is_none_or(|(of, _)| *of != self.model.pictures) {
                let texture = ctx.load_texture("camera from above", image_of_frame(frame), TextureOptions::LINEAR);
                self.from_above = Some((self.model.pictures, texture));
            }
            let Some((_, texture)) = &self.from_above else { return };
            let turns = match self.model.stage("curved_rays") {
                Some(StageDoc::CurvedRays(stage)) => stage.turn.clone(),
                _ => Vec::new(),
            };
            edit = overhead(ui, ui.scope_id(), texture.id(), view, &turns);
            if let Some(reason) = &self.model.violated {
                ui.colored_label(egui::Color32::from_rgb(170, 50, 40), reason);
            }
        });
        self.model.look.overhead = open;
        let Some(edit) = edit else { return };
        if edit.begins {
            self.model.begin_gesture();
        }
        self.model.edit_on(|document| {
            let stage = document.stage.iter().find_map(|stage| match stage {
                StageDoc::CurvedRays(stage) => Some(stage.clone()),
                _ => None,
            });
            if let Some(mut stage) = stage
                && let Some(turn) = stage.turn.get_mut(edit.turn)
            {
                edit.apply(turn);
                set_stage(document, StageDoc::CurvedRays(stage));
            }
        });
    }

    /// Writes the recovery file some time after the last change.
    fn write_down(&mut self, ctx: &Context) {
        let Some(recovery) = &self.recovery else { return };
        let now = ctx.input(|input| input.time);
        let extra = Extra { look: self.model.look.clone(), tab: self.panels.tab, bookmarks: self.bookmarks.clone() };
        let is_written =
            |(written, beside): &(_, Extra)| Arc::ptr_eq(written, self.model.document()) && *beside == extra;
        // A document that is being opened replaces the current one, so this is not written.
        if self.written.as_ref().is_some_and(is_written) || (self.pending.is_some() && self.model.shown.is_none()) {
            self.dirty_since = None;
            return;
        }
        let since = *self.dirty_since.get_or_insert(now);
        if now - since < WRITE_AFTER {
            ctx.request_repaint_after_secs((WRITE_AFTER - (now - since)) as f32);
            return;
        }
        let beside = serde_json::to_value(&extra).unwrap_or_default();
        self.written = Some((self.model.document().clone(), extra));
        self.dirty_since = None;
        if let Err(e) = recovery.write(&self.model.editor, beside) {
            self.model.notices.error(format!("what you do could not be written down for the case of a crash: {e}"));
        }
    }
}

fn refusal(error: belvedere::BelvedereError) -> Refusal {
    Refusal::Reason(error.to_string())
}

/// A built-in scene.
fn builtin(i: usize) -> Editor {
    let text = BUILTIN.get(i).map_or("", |(_, text)| text);
    let parsed = scene_file::parse(Path::new("built-in.toml"), text);
    match parsed {
        Ok(source) => Editor::new(source.document, Place::default()),
        Err(e) => unreachable!("a built-in scene is broken: {e}"),
    }
}

fn remembered(folder: &Path) -> Remembered {
    let text = std::fs::read_to_string(folder.join("remembered.json")).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

impl eframe::App for Viewer {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        self.model.take_answers();
        self.arrivals(&ctx);
        if let Some(command) = keys::read(&ctx, &mut self.model) {
            self.command(&ctx, command);
        }
        self.panels.play(&ctx, &mut self.model);
        let choice = Panel::top("menu")
            .show(ui, |ui| menu::bar(ui, &self.model, &self.remembered.recent, &self.bookmarks))
            .inner;
        if let Some(choice) = choice {
            self.choose(&ctx, choice);
        }
        Panel::left("panels").default_size(330.0).show(ui, |ui| self.panels.show(ui, &mut self.model));
        CentralPanel::no_frame().show(ui, |ui| self.picture.show(ui, &mut self.model));
        self.overhead(&ctx);
        menu::help(&ctx, &mut self.help);
        self.ask_for_consent(&ctx);
        self.model.notices.show(&ctx);
        self.write_down(&ctx);
        self.times.note(&self.model);
    }

    #[cfg(target_family = "wasm")]
    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(self)
    }

    fn on_exit(&mut self, _: Option<&eframe::glow::Context>) {
        self.times.tell(&self.model);
        if let Some(recovery) = self.recovery.take() {
            recovery.end();
        }
    }
}
