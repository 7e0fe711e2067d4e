//! Opening and saving: files arrive in the background.

use super::file_change::Question;
use super::unsaved::Next;
use super::{Refusal, Viewer};
use crate::consent::{self, Consent, Decision};
use crate::files;
use crate::language::{fill, heard, tr};
use belvedere::scene::Progress;
use belvedere::verbs::open_files::{Opened, open_beside, open_trusted};
use belvedere_studio::beside;
use eframe::egui::Context;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, TryRecvError};
use std::sync::{Arc, Mutex};

/// A file that is being opened in the background, and the progress in words.
pub(super) struct Pending {
    opened: Receiver<Result<Opened, Refusal>>,
    /// What is being done, and the share of it.
    at: Arc<Mutex<(String, f64)>>,
    pub(super) progress: Progress,
}

impl Viewer {
    /// Opens files in the background.
    pub(super) fn open(&mut self, paths: Vec<PathBuf>) {
        if let [path] = paths.as_slice() {
            self.remember(path);
        }
        let (outbox, inbox) = std::sync::mpsc::channel();
        let (allowed, trust, wake) = (self.allowed.clone(), self.trust.clone(), self.wake.clone());
        let at = Arc::new(Mutex::new((String::new(), 0.0)));
        let current = self.model.shown.is_some().then(|| self.model.document().clone());
        let told = at.clone();
        let progress = Progress::new(move |stage, share| {
            // The main thread of a browser must not block on a lock.
            if let Ok(mut at) = told.try_lock() {
                *at = (stage.to_owned(), share);
            }
        });
        let cancel = progress.clone();
        let work = move || {
            let opened = match (Consent::needed(&paths, &allowed, &trust), &current) {
                (Some(consent), _) => Ok(Err(Refusal::Asks(consent))),
                (None, Some(current)) => open_beside(current, &paths, &allowed, &trust, &progress).map(Ok),
                (None, None) => {
                    open_trusted(&paths, &allowed, &trust, &progress).map(|scene| Ok(Opened::Scene(Box::new(scene))))
                }
            };
            let opened = match opened {
                // Nobody waits for it any more.
                Err(e) if e.is_cancelled() => return wake.call(),
                opened => opened.unwrap_or_else(|e| Err(Refusal::Reason(e.to_string()))),
            };
            let _ = outbox.send(opened);
            wake.call();
        };
        if let Err(e) = beside(work) {
            self.model.notices.error(e);
            return;
        }
        self.cancel_opening();
        self.model.opening = Some(tr("opening").into());
        self.pending = Some(Pending { opened: inbox, at, progress: cancel });
    }

    /// Gives up the file that is being opened; the scene stays as it is.
    pub(super) fn cancel_opening(&mut self) {
        if let Some(pending) = self.pending.take() {
            pending.progress.cancel_flag().store(true, Ordering::Relaxed);
        }
        self.model.opening = None;
    }

    /// Takes what was opened in the background, or tells how far that is.
    fn take_opened(&mut self, ctx: &Context) {
        let Some(pending) = &self.pending else { return };
        if let Ok(at) = pending.at.try_lock()
            && !at.0.is_empty()
        {
            let share = format!("{:.0}", 100.0 * at.1);
            self.model.opening = Some(fill(tr("opening: {0}, {1} %"), &[&heard(&at.0), &share]));
        }
        ctx.request_repaint_after_secs(0.1);
        let opened = match pending.opened.try_recv() {
            Err(TryRecvError::Empty) => return,
            opened => opened,
        };
        (self.pending, self.model.opening) = (None, None);
        match opened {
            Ok(Ok(Opened::Scene(scene))) => self.go_on_to(ctx, Next::Show(Box::new((*scene).into()))),
            Ok(Ok(Opened::Layers(layers, folders))) => self.model.editor.add_layers(layers, folders),
            Ok(Err(Refusal::Reason(reason))) => self.model.notices.error(reason),
            Ok(Err(Refusal::Asks(consent))) => self.consent = Some(consent),
            Err(_) => self
                .model
                .notices
                .error(tr("the file could not be opened: internal error; please report this with the file")),
        }
    }

    /// Takes the files that were chosen, dropped or opened in the background.
    pub(super) fn arrivals(&mut self, ctx: &Context) {
        self.take_opened(ctx);
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
                Ok(_) if self.resumes(ctx) => {}
                Ok(paths) => self.open(paths),
                Err(reason) => self.model.notices.error(reason),
            }
        }
        if let Some(answer) = self.chosen_output.as_mut().and_then(|choosing| choosing.answer(ctx)) {
            self.chosen_output = None;
            // What waited for it is given up if nothing is saved.
            let mut next = self.after_saving.take();
            match answer {
                Ok(paths) => paths.iter().take(1).for_each(|path| self.save(ctx, path, next.take())),
                Err(reason) => self.model.notices.error(reason),
            }
        }
        if self.dropped.is_some() {
            ctx.request_repaint_after_secs(0.1);
        }
    }

    /// Asks for the consent that a scene lacks, and opens it once it has it.
    pub(super) fn ask_for_consent(&mut self, ctx: &Context) {
        let Some(decision) = self.consent.as_ref().and_then(|consent| consent.show(ctx)) else { return };
        let Some(consent) = self.consent.take().filter(|_| decision == Decision::Allowed) else { return };
        if let Err(reason) = consent.give(&mut self.trust) {
            self.model.notices.error(reason);
        }
        self.open(vec![consent.scene]);
    }

    /// Writes the scene to a file, and does what waited for it; asks first if it is its own file and another program changed it.
    pub(super) fn save(&mut self, ctx: &Context, path: &Path, next: Option<Next>) {
        match self.model.editor.file_change().filter(|_| self.model.editor.is_own(path)) {
            Some(change) => self.file_change = Some(Question::new(change, next)),
            None => self.save_over(ctx, path, next),
        }
    }

    /// Writes the scene to a file, whatever it holds now, and does what waited for it.
    pub(super) fn save_over(&mut self, ctx: &Context, path: &Path, next: Option<Next>) {
        let saved = self.model.editor.save_over(path).map_err(|e| e.to_string());
        let saved = saved.and_then(|()| {
            self.remember(path);
            self.remember_bookmarks();
            // The recovery file is written anew, since it says whether the scene is saved.
            self.written = None;
            let mut said = fill(tr("Saved: {0}"), &[&path.display()]);
            match consent::remember(&mut self.trust, path, &self.model.editor.outside()) {
                Ok(is_remembered) if is_remembered || self.model.editor.outside().is_empty() => {}
                Ok(_) => said += tr("; it names files outside its folder: the command line needs --allow-root DIR"),
                Err(reason) => self.model.notices.error(reason),
            }
            self.model.notices.say(said, ctx.input(|input| input.time));
            files::hand_over(path)
        });
        match (saved, next) {
            (Ok(()), Some(next)) => self.go_on(ctx, next),
            (Ok(()), None) => {}
            (Err(reason), _) => self.model.notices.error(reason),
        }
    }

    /// Lets the user choose where to write a scene.
    pub(super) fn choose_output(&mut self) {
        let (folder, system) = (&self.model.editor.place.roots.scene_dir, self.model.system_dialogs);
        self.chosen_output = Some(files::choose_output(folder, "scene.toml", system));
    }
}
