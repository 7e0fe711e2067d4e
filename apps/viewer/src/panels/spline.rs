//! Multi-perspective views: presets over the viewing angle, their curves, sections and representations.

use super::gallery::{Galleries, variant};
use super::number;
use super::sections::{self, SectionEdit};
use crate::handles::Handles;
use crate::language::{fill, tr};
use crate::model::Model;
use crate::widgets::curve::curve;
use crate::widgets::ruler::{RANGE, RulerEdit, ruler};
use belvedere::core::presets::PresetDocument;
use belvedere::core::presets::edit::{PresetChange, PresetOperation};
use belvedere::scene_file::{PresetsDoc, SplineStageDoc, StageDoc};
use belvedere::verbs::preset::{sketch, viewing_angle};
use eframe::egui::{CollapsingHeader, Context, Id, Ui};

const KIND: &str = "spline_bend";
/// Speed of a played sweep, degrees per second.
const SWEEP: f64 = 12.0;

/// State of the panel.
#[derive(Debug, Default)]
pub(crate) struct SplinePanel {
    galleries: Galleries,
    /// Position of the edited preset in the document.
    chosen: usize,
    playing: bool,
    played_at: f64,
    downwards: bool,
    /// Message about a value of the last change that was stopped at its limit.
    clamped: Option<String>,
    /// The same for a change that is not made yet.
    stopped: Option<String>,
}

impl SplinePanel {
    /// Shows the panel.
    pub(crate) fn show(&mut self, ui: &mut Ui, model: &mut Model) {
        let stage = match model.stage(KIND) {
            Some(StageDoc::SplineBend(stage)) => Some(stage.clone()),
            _ => None,
        };
        self.builtins(ui, model, stage.as_ref());
        let Some(stage) = stage else {
            ui.label(tr("Choose presets to bend the picture along a spline over the ground."));
            return;
        };
        if ui.button(tr("No spline")).clicked() {
            model.edit(|document| document.stage.retain(|stage| stage.kind() != KIND));
            return;
        }
        let Some(presets) = presets_of(model, &stage) else {
            ui.label(tr("The presets come from a file that is not open yet."));
            return;
        };
        self.chosen = self.chosen.min(presets.presets.len().saturating_sub(1));
        let phi = model.shown.as_ref().and_then(|shown| viewing_angle(&shown.session).ok());
        self.angles(ui, model, &presets, phi);
        // A preset may have been copied or removed.
        let presets = match model.stage(KIND) {
            Some(StageDoc::SplineBend(stage)) => presets_of(model, stage).unwrap_or(presets),
            _ => presets,
        };
        self.chosen = self.chosen.min(presets.presets.len().saturating_sub(1));
        let Some(preset) = presets.presets.get(self.chosen) else { return };
        ui.strong(if preset.name.is_empty() {
            fill(tr("Preset {0}"), &[&(self.chosen + 1)])
        } else {
            preset.name.clone()
        });
        let Some(drawing) = sketch(&presets, preset.phi, distance_of(model)) else { return };
        let id = ui.scope_id().with(("curve", self.chosen));
        if let Some(edit) = curve(ui, id, &drawing, self.clamped.as_deref()) {
            if edit.begins {
                model.begin_gesture();
            }
            self.change(model, Id::unique("curve"), &presets, edit.change);
        }
        self.sections(ui, model, &presets);
        self.numbers(ui, model, &presets);
        model.handles = Some(Handles::Preset(Box::new(presets), self.chosen));
    }

    /// The built-in documents, as pictures of this scene.
    fn builtins(&mut self, ui: &mut Ui, model: &mut Model, stage: Option<&SplineStageDoc>) {
        let present = match stage.map(|stage| &stage.presets) {
            Some(PresetsDoc::Named(name)) => Some(name.as_str()),
            _ => None,
        };
        let galleries = &mut self.galleries;
        let shown = CollapsingHeader::new(tr("Presets")).default_open(true).show(ui, |ui| galleries.show(ui, present));
        if let Some(builtin) = shown.body_returned.flatten() {
            self.chosen = 0;
            let next = variant(model.document(), builtin.name);
            model.edit(|document| *document = next);
        }
    }

    /// Whether pictures of presets are still to be drawn.
    pub(crate) fn is_drawing(&self) -> bool {
        self.galleries.is_drawing()
    }

    /// The ruler, and the operations on whole presets.
    fn angles(&mut self, ui: &mut Ui, model: &mut Model, presets: &PresetDocument, phi: Option<f64>) {
        let listed: Vec<(String, f64)> = presets.presets.iter().map(|p| (p.name.clone(), p.phi)).collect();
        match ruler(ui, ui.scope_id().with("ruler"), &listed, self.chosen, phi) {
            Some(RulerEdit::Choose(i)) => self.chosen = i,
            Some(RulerEdit::Move(i, to, begins)) => {
                self.chosen = i;
                if begins {
                    model.begin_gesture();
                }
                let to = self.within(tr("the viewing angle"), to, RANGE);
                self.change(model, Id::unique("ruler"), presets, PresetChange::Phi(to));
            }
            None => {}
        }
        // Two rows: the lower one keeps its identities when the angle of the camera is known.
        ui.horizontal_wrapped(|ui| {
            if let Some(phi) = phi {
                ui.label(fill(tr("camera {0}°"), &[&format!("{phi:.1}")]));
                if ui
                    .button(tr("Capture camera"))
                    .on_hover_text(tr("the preset is for the angle of the camera"))
                    .clicked()
                {
                    self.step(model, presets, PresetChange::Phi((10.0 * phi).round() / 10.0));
                }
                let name = free_name(presets);
                if ui.button(tr("Copy for this camera")).clicked() {
                    self.step(model, presets, PresetChange::Duplicate { name, phi: (10.0 * phi).round() / 10.0 });
                    self.chosen = presets.presets.len();
                }
            }
        });
        ui.horizontal_wrapped(|ui| {
            if ui.button(tr("Mirror")).on_hover_text(tr("near and far change places")).clicked() {
                self.step(model, presets, PresetChange::Mirror);
            }
            if presets.presets.len() > 1 && ui.button(tr("Remove preset")).clicked() {
                self.step(model, presets, PresetChange::Remove);
            }
            let name = tr(if self.playing { "Pause sweep" } else { "Play sweep" });
            if ui.button(name).on_hover_text(tr("the camera tilts through the viewing angles")).clicked() {
                self.playing = !self.playing;
                self.played_at = ui.input(|input| input.time);
                model.begin_gesture_of(sweep());
            }
        });
    }

    /// The sections, near to far.
    fn sections(&mut self, ui: &mut Ui, model: &mut Model, presets: &PresetDocument) {
        match sections::show(ui, model, presets, self.chosen) {
            Some(SectionEdit::Preset(changes, begins)) => {
                if begins {
                    model.begin_gesture();
                }
                let mut presets = presets.clone();
                for change in changes {
                    self.change(model, Id::unique("sections"), &presets, change);
                    if let Some(StageDoc::SplineBend(stage)) = model.stage(KIND) {
                        presets = presets_of(model, stage).unwrap_or(presets);
                    }
                }
            }
            Some(SectionEdit::Document(next)) => model.edit(|document| *document = *next),
            None => {}
        }
    }

    fn numbers(&mut self, ui: &mut Ui, model: &mut Model, presets: &PresetDocument) {
        let preset = presets.presets[self.chosen].clone();
        if let Some((by, tau)) =
            number(ui, model, tr("holds within ± degrees"), preset.tau, 0.1, tr("half width of the range of angles"))
        {
            let tau = self.within(tr("the range of angles"), tau, [0.0, 90.0]);
            self.change(model, by, presets, PresetChange::Tau(tau));
        }
        let own = preset.fov_y_deg;
        let mut has = own.is_some();
        if ui.checkbox(&mut has, tr("field of view of its own")).changed() {
            self.step(model, presets, PresetChange::FieldOfView(has.then_some(45.0)));
        }
        if let Some(fov) = own
            && let Some((by, fov)) = number(ui, model, tr("field of view"), fov, 0.2, tr("degrees"))
        {
            let fov = self.within(tr("the field of view"), fov, [0.05, 170.0]);
            self.change(model, by, presets, PresetChange::FieldOfView(Some(fov)));
        }
        for (i, tag) in preset.tags.iter().enumerate() {
            let name = fill(tr("transition of tag {0}"), &[&(i + 1)]);
            if let Some((by, delta)) =
                number(ui, model, &name, tag.delta, 0.002, tr("half width, share of the curve's length"))
            {
                let delta = self.within(tr("the half width of a transition"), delta, [0.0, 0.5]);
                self.change(model, by, presets, PresetChange::TagWidth(i + 1, delta));
            }
        }
    }

    /// Makes a change that is one step of undo.
    fn step(&mut self, model: &mut Model, presets: &PresetDocument, change: PresetChange) {
        model.begin_gesture();
        self.change(model, Id::unique("presets"), presets, change);
    }

    /// Changes the chosen preset within a gesture of `by`; an error is shown.
    fn change(&mut self, model: &mut Model, by: Id, presets: &PresetDocument, change: PresetChange) {
        let preset = (self.chosen + 1).to_string();
        let stopped = self.stopped.take();
        match presets.edited_saying(&PresetOperation::Preset { preset, change }) {
            Ok((next, clamped)) => {
                self.clamped = stopped.or_else(|| clamped.first().map(ToString::to_string));
                model.edit_on(by, |document| {
                    let stages = document.stage.iter_mut();
                    for stage in stages {
                        if let StageDoc::SplineBend(stage) = stage {
                            stage.presets = PresetsDoc::Inline(Box::new(next.clone()));
                        }
                    }
                });
            }
            Err(e) => model.violated = Some(e.to_string()),
        }
    }

    /// A value clamped to its limits; a message is kept for the next change if it was clamped.
    fn within(&mut self, what: &str, value: f64, [least, most]: [f64; 2]) -> f64 {
        let stopped = !(least..=most).contains(&value);
        self.stopped =
            stopped.then(|| fill(tr("{0} stops at its limit: {1} to {2} are possible"), &[&what, &least, &most]));
        value.clamp(least, most)
    }

    /// Draws missing pictures of presets, and advances the sweep: up and down through the viewing angles.
    pub(crate) fn play(&mut self, ctx: &Context, model: &mut Model) {
        self.galleries.draw(ctx, model);
        // It ends where something else edits.
        self.playing &= model.was_edited_by(sweep());
        if !self.playing {
            return;
        }
        let now = ctx.input(|input| input.time);
        let by = (SWEEP * (now - self.played_at).clamp(0.0, 0.2)).to_radians();
        self.played_at = now;
        let phi = model.shown.as_ref().and_then(|shown| viewing_angle(&shown.session).ok());
        let Some(phi) = phi else {
            self.playing = false;
            return;
        };
        if phi > 88.0 {
            self.downwards = true;
        } else if phi < 8.0 {
            self.downwards = false;
        }
        let by = if self.downwards { -by } else { by };
        model.move_camera(sweep(), |camera| camera.orbited(0.0, by));
        ctx.request_repaint();
    }
}

/// What edits while a sweep is played.
fn sweep() -> Id {
    Id::unique("played sweep")
}

/// The presets of a stage, as the picture shows them.
fn presets_of(model: &Model, stage: &SplineStageDoc) -> Option<PresetDocument> {
    match &stage.presets {
        PresetsDoc::Inline(document) => Some((**document).clone()),
        PresetsDoc::Named(name) => PresetDocument::builtin(name).ok().or_else(|| {
            let resolved = model.shown.as_ref()?.session.resolved()?;
            resolved.stage.iter().find_map(|stage| match stage {
                StageDoc::SplineBend(SplineStageDoc { presets: PresetsDoc::Inline(document), .. }) => {
                    Some((**document).clone())
                }
                _ => None,
            })
        }),
    }
}

/// Distance of the camera from the pivot of the spline.
fn distance_of(model: &Model) -> Option<f64> {
    let stages = model.shown.as_ref()?.session.view().stages();
    stages.iter().find_map(|stage| match stage {
        belvedere::core::Stage::SplineBend(bend) => Some(bend.resolved().distance),
        _ => None,
    })
}

fn free_name(presets: &PresetDocument) -> String {
    let taken = |name: &str| presets.presets.iter().any(|p| p.name == name);
    (1..).map(|n| format!("preset {n}")).find(|name| !taken(name)).unwrap_or_default()
}
