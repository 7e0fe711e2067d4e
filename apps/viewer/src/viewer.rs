//! The application as a whole: opening, saving, kept state; panels around the picture.

mod at_work;
mod bookmarks;
mod file_change;
mod from_above;
mod layout;
mod opening;
mod resumed;
mod thumbnails;
mod unsaved;
mod waiting;
mod welcome;

use crate::builtin::BUILTIN;
use crate::consent::Consent;
use crate::files;
use crate::find::{Find, Going};
use crate::keys::{self, Command};
use crate::language::{fill, tr};
use crate::menu::{self, Bookmark, Choice};
use crate::model::{Compare, Look, Model, Tool};
use crate::panels::{Panels, Tab};
use crate::picture::PictureView;
use crate::settings::Settings;
use crate::times::Times;
use crate::wake::Wake;
use belvedere::Trust;
use belvedere::io::fs;
use belvedere::placed::Place;
use belvedere::scene_file;
use belvedere_studio::{Editor, Recovery};
use eframe::egui::{Context, TextureHandle, Ui, vec2};
use layout::SMALL;
use opening::Pending;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use unsaved::{Next, Unsaved};

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
    /// State of an earlier run as a page keeps it; the scene of it comes instead of the files, if all its own files are there.
    pub left: Option<String>,
    /// Language of the system as a tag such as `de_CH.UTF-8`; empty: English.
    pub language: String,
}

impl Opening {
    /// The usual folder of the kept state.
    #[cfg(not(target_family = "wasm"))]
    pub fn usual_state() -> Option<PathBuf> {
        files::state_folder()
    }

    /// The language of the system, or of the browser; empty if it states none.
    pub fn usual_language() -> String {
        crate::language::of_system()
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
    /// Whether the tour was taken or skipped.
    toured: bool,
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
    /// States of scenes that wait for files.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    waiting: Vec<String>,
}

/// The application.
pub struct Viewer {
    model: Model,
    panels: Panels,
    picture: PictureView,
    from_above: Option<(u64, TextureHandle)>,
    bookmarks: Vec<Bookmark>,
    settings: Settings,
    remembered: Remembered,
    allowed: Vec<PathBuf>,
    trust: Trust,
    consent: Option<Consent>,
    state: Option<PathBuf>,
    recovery: Option<Recovery>,
    /// Last content of the recovery file, and the time since which the state differs from it.
    written: Option<(Arc<scene_file::Document>, Extra)>,
    dirty_since: Option<f64>,
    /// What a page keeps for the time when it is loaded again.
    resumed: resumed::Resumed,
    pending: Option<Pending>,
    dropped: Option<files::Inputs>,
    chosen_input: Option<files::Choosing>,
    chosen_output: Option<files::Choosing>,
    /// The question about unsaved changes, and what is done once they are saved.
    unsaved: Option<Unsaved>,
    /// The question about a scene file that another program changed.
    file_change: Option<file_change::Question>,
    after_saving: Option<Next>,
    /// The document with which the window may close, whatever is not saved of it.
    may_close: Option<Arc<scene_file::Document>>,
    /// Bookmarks of the scene that comes back if the new one cannot be drawn.
    bookmarks_before: Vec<Bookmark>,
    help: bool,
    find: Find,
    /// Whether the window of the bookmarks is open.
    lists_bookmarks: bool,
    bookmark_pictures: thumbnails::BookmarkPictures,
    welcome: welcome::Welcome,
    /// Whether the sheet of a small screen is open.
    sheet: bool,
    times: Times,
    wake: Wake,
}

impl Viewer {
    /// Opens the given files. After an instance that did not end properly its scene is restored, or kept in a file if others are opened.
    pub fn new(ctx: &Context, opening: &Opening) -> Self {
        let settings = Settings::new(ctx, opening.state.clone(), opening.language.clone());
        let wake = Wake::new(ctx);
        let mut notes = Vec::new();
        let (recovery, left) = match opening.state.as_deref().map(Recovery::claim) {
            Some(Ok((recovery, left))) => (Some(recovery), left),
            Some(Err(e)) => {
                notes.push(fill(tr("what you do is not written down for the case of a crash: {0}"), &[&e]));
                (None, None)
            }
            None => (None, None),
        };
        let woken = wake.clone();
        let mut viewer = Self {
            model: Model::new(builtin(0), move || woken.call()),
            wake,
            panels: Panels::default(),
            picture: PictureView::default(),
            from_above: None,
            bookmarks: Vec::new(),
            settings,
            remembered: opening.state.as_deref().map_or_else(Remembered::default, remembered),
            allowed: opening.allowed.clone(),
            trust: opening.trust.clone(),
            consent: None,
            state: opening.state.clone(),
            recovery,
            written: None,
            dirty_since: None,
            resumed: resumed::Resumed::new(!opening.files.is_empty()),
            pending: None,
            dropped: None,
            chosen_input: None,
            chosen_output: None,
            unsaved: None,
            file_change: None,
            after_saving: None,
            may_close: None,
            bookmarks_before: Vec::new(),
            help: false,
            find: Find::default(),
            lists_bookmarks: false,
            bookmark_pictures: thumbnails::BookmarkPictures::default(),
            welcome: welcome::Welcome::default(),
            sheet: false,
            times: Times::default(),
        };
        viewer.model.system_dialogs = opening.system_dialogs;
        notes.extend(viewer.put_left(left, opening));
        let is_resumed = opening.left.as_deref().is_some_and(|text| viewer.resume(text));
        if !is_resumed && !opening.files.is_empty() {
            viewer.open(opening.files.clone());
        }
        notes.into_iter().for_each(|note| viewer.model.notices.error(note));
        viewer
    }

    /// Takes up what an instance left that did not end properly, keeps it in a file if others are opened, or else welcomes. Returns what
    /// the user should know.
    fn put_left(&mut self, left: Option<belvedere_studio::Recovered>, opening: &Opening) -> Option<String> {
        match left {
            Some(left) if opening.files.is_empty() => {
                self.take_up(left);
                Some(tr("The last session did not end as it should; here is its last state.").into())
            }
            Some(mut left) if left.editor.is_changed() => {
                // What an earlier session left stays.
                let kept = files::free_name(&opening.state.clone().unwrap_or_default(), "recovered", "toml");
                let [is_kept, is_lost] = [
                    tr("The last session did not end as it should; its unsaved scene is kept in {0}."),
                    tr("The last session did not end as it should; its unsaved scene could not be kept: {0}."),
                ];
                Some(
                    left.editor
                        .save(&kept)
                        .map_or_else(|e| fill(is_lost, &[&e]), |()| fill(is_kept, &[&kept.display()])),
                )
            }
            Some(_) | None => {
                self.welcome.open = opening.files.is_empty() && opening.left.is_none();
                None
            }
        }
    }

    /// The document as it is.
    pub fn document(&self) -> &Arc<scene_file::Document> {
        self.model.document()
    }

    /// Whether the picture on the screen is that of the document, in full.
    pub fn rests(&self) -> bool {
        self.pending.is_none() && self.model.rests()
    }

    /// Whether there is a picture.
    #[cfg(target_family = "wasm")]
    pub(crate) fn is_drawn(&self) -> bool {
        self.model.pictures > 0
    }

    /// Whether every preset in the panel of the spline has its picture of the scene, or the reason why there is none.
    pub fn shows_presets(&self) -> bool {
        !self.panels.is_drawing()
    }

    /// Whether files are being opened.
    pub fn is_opening(&self) -> bool {
        self.pending.is_some() || self.dropped.is_some() || self.model.is_opening()
    }

    /// Whether the shares on the screen are measured for the current document.
    pub fn is_judged(&self) -> bool {
        self.model.is_judged()
    }

    /// The view as the end of the page's address.
    #[cfg(target_family = "wasm")]
    pub(crate) fn view(&self) -> Option<String> {
        crate::address::text_of(&self.model.document().camera)
    }

    /// Shows the view of an address; it counts as the scene's own, so nobody is asked to save it.
    #[cfg(target_family = "wasm")]
    pub(crate) fn go(&mut self, address: &str) {
        let mut document = (**self.model.document()).clone();
        if crate::address::put(address, &mut document.camera) {
            if self.model.editor.is_changed() {
                self.model.edit(|present| *present = document);
            } else {
                self.model.editor = self.model.editor.with_document(document);
            }
            self.wake.call();
        }
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

    fn remember(&mut self, path: &Path) {
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let recent = &mut self.remembered.recent;
        recent.retain(|other| *other != path);
        recent.insert(0, path);
        recent.truncate(RECENT);
        self.write_remembered();
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
        self.bookmarks_before = std::mem::replace(&mut self.bookmarks, known.unwrap_or_default());
        self.resumed.another();
        self.model.replace(editor);
    }

    fn command(&mut self, ctx: &Context, command: Command) {
        match command {
            Command::Open => self.chosen_input = Some(files::choose_input(self.model.system_dialogs)),
            Command::Save => match self.model.editor.place.scene.clone() {
                Some(path) => self.save(ctx, &path, None),
                None => self.choose_output(),
            },
            Command::SaveAs => self.choose_output(),
            Command::Undo => self.model.step(true),
            Command::Redo => self.model.step(false),
            // A page is closed by its browser.
            Command::Quit if cfg!(target_family = "wasm") => {}
            Command::Quit => self.go_on_to(ctx, Next::Quit),
            Command::Find => self.find.begin(),
            Command::Measure => {
                let look = &mut self.model.look;
                look.tool = if look.tool == Tool::Measure { Tool::Map } else { Tool::Measure };
            }
            Command::Bookmark => self.bookmark(),
            Command::Bookmarks => self.lists_bookmarks = !self.lists_bookmarks,
            Command::Bent => self.model.look.bent = !self.model.look.bent,
            Command::Compare => {
                let compare = &mut self.model.look.compare;
                *compare = match *compare {
                    Compare::Off => Compare::Split,
                    Compare::Split => Compare::Flicker,
                    Compare::Flicker => Compare::Off,
                };
            }
            Command::Inset => self.model.look.inset = !self.model.look.inset,
            Command::Overhead => self.model.look.overhead = !self.model.look.overhead,
            Command::Statistics => self.model.look.statistics = !self.model.look.statistics,
            Command::Panel => self.model.look.panel = !self.model.look.panel,
            Command::Welcome => self.welcome.open = true,
            Command::ShowAll => {
                if let Some(bounds) = self.model.shown.as_ref().map(|shown| shown.session.scene().bounds()) {
                    self.model.frame(&bounds);
                }
            }
            Command::Help => self.help = !self.help,
        }
    }

    /// Shows the field that finds things, and goes to what is chosen.
    fn finding(&mut self, ctx: &Context) {
        let busy = self.model.opening.is_some() || self.model.works_since().is_some() || self.model.is_stopped();
        let at = self.picture.middle_top + vec2(0.0, if busy { 54.0 } else { 10.0 });
        let room = 2.0 * (self.picture.middle - self.picture.middle_top).y;
        let room = vec2(ctx.content_rect().width(), room);
        match self.find.show(ctx, (at, room), &self.model, &self.bookmarks) {
            Some(Going::To(bounds)) => self.model.visit(&bounds, ctx),
            Some(Going::Bookmark(i)) => self.go_to_bookmark(ctx, i),
            None => {}
        }
    }

    fn choose(&mut self, ctx: &Context, choice: Choice) {
        match choice {
            Choice::Command(command) => self.command(ctx, command),
            Choice::Builtin(i) => self.go_on_to(ctx, Next::Show(Box::new(builtin(i)))),
            Choice::Recent(path) => self.open(vec![path]),
            Choice::GoTo(i) => self.go_to_bookmark(ctx, i),
            Choice::Forget(i) => self.forget_bookmark(i),
            Choice::Return(i) => self.call_waiting(ctx, i),
            Choice::GiveUp(i) => self.give_up(i),
            Choice::Step(steps) => self.model.go_to(steps),
            #[cfg(target_family = "wasm")]
            Choice::ForgetFiles => self.forget_files(ctx),
        }
    }

    /// Writes the recovery file some time after the last change.
    fn write_down(&mut self, ctx: &Context) {
        let Some(recovery) = &self.recovery else { return };
        let now = ctx.input(|input| input.time);
        let extra = self.extra();
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
            self.model
                .notices
                .error(fill(tr("what you do could not be written down for the case of a crash: {0}"), &[&e]));
        }
    }
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
        self.settings.speak();
        self.model.take_answers();
        if std::mem::take(&mut self.model.came_back) {
            self.bookmarks = std::mem::take(&mut self.bookmarks_before);
        }
        self.model.follow_focus(&ctx);
        self.model.fly_on(&ctx);
        self.closing(&ctx);
        self.arrivals(&ctx);
        if !self.asks()
            && let Some(command) = keys::read(&ctx, &mut self.model)
        {
            self.command(&ctx, command);
        }
        self.panels.play(&ctx, &mut self.model, &self.bookmarks);
        if ctx.content_rect().width() < SMALL {
            self.small(ui);
        } else {
            self.large(ui);
        }
        self.overhead(&ctx);
        self.finding(&ctx);
        self.draw_bookmarks(&ctx);
        self.bookmark_window(&ctx);
        self.welcome(&ctx);
        self.at_work(&ctx);
        menu::help(&ctx, &mut self.help);
        self.ask_for_consent(&ctx);
        self.model.notices.show(&ctx);
        self.question(&ctx);
        self.ask_about_file(&ctx);
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
