//! Which atoms of a molecule must be seen: typed, chosen from a list, clicked in the picture.

use crate::language::{fill, tr};
use crate::model::{Model, Tool};
use crate::panels::rays::track;
use belvedere::scene_file::{LayerDoc, MoleculeDoc};
use belvedere_studio::{NamedResidue, read_residues, residues};
use eframe::egui::{Button, ComboBox, Id, TextEdit, Ui};
use std::sync::Arc;

/// Residues that the list shows; others are typed.
const MOST_RESIDUES: usize = 400;

/// The fields of a molecule.
pub(super) fn show(ui: &mut Ui, model: &mut Model, index: usize, doc: &MoleculeDoc) {
    let id = doc.id.as_str();
    let mut chosen = typed(ui, model, doc);
    let shown = doc.select.as_deref().unwrap_or(tr("all atoms"));
    ComboBox::from_label(fill(tr("residue of {0}"), &[&id])).selected_text(shown).truncate().show_ui(ui, |ui| {
        if ui.selectable_label(doc.select.is_none(), tr("all atoms")).clicked() {
            chosen = Some(None);
        }
        let all = listed(ui, model, doc);
        for residue in all.iter().take(MOST_RESIDUES) {
            if ui.selectable_label(doc.select.as_ref() == Some(&residue.select), &residue.name).clicked() {
                chosen = Some(Some(residue.select.clone()));
            }
        }
        if all.len() > MOST_RESIDUES {
            ui.weak(fill(tr("and {0} more: type chain and number"), &[&(all.len() - MOST_RESIDUES)]));
        }
    });
    if let Some(select) = chosen {
        choose(model, index, select);
    }
    ui.horizontal_wrapped(|ui| {
        let clicks = model.look.tool == Tool::Residue;
        let click = ui.add(Button::selectable(clicks, fill(tr("Click a residue of {0}"), &[&id])));
        if click.on_hover_text(tr("the next click in the picture chooses the residue of that atom")).clicked() {
            model.look.tool = if clicks { Tool::Map } else { Tool::Residue };
        }
        let bend = ui.add_enabled(doc.select.is_some(), Button::new(fill(tr("Bend rays to show it, {0}"), &[&id])));
        let bend = bend.on_hover_text(tr("rays are bent round what hides the chosen atoms"));
        if let Some(select) = doc.select.as_ref().filter(|_| bend.clicked()) {
            track(model, select);
        }
    });
}

/// The field for a residue; what was chosen with Enter, if it means atoms that are drawn.
fn typed(ui: &mut Ui, model: &mut Model, doc: &MoleculeDoc) -> Option<Option<String>> {
    let key = ui.scope_id().with(("residue", &doc.id));
    let held = ui.data(|data| data.get_temp::<String>(key));
    let mut text = held.clone().unwrap_or_else(|| doc.select.clone().unwrap_or_default());
    let label = ui.label(fill(tr("atoms of {0} that must be seen"), &[&doc.id]));
    let hint = tr("B 102, or chain B and resi 10-14");
    let field = ui.add(TextEdit::singleline(&mut text).hint_text(hint)).labelled_by(label.id);
    if !field.lost_focus() {
        if field.has_focus() {
            ui.data_mut(|data| data.insert_temp(key, text));
        }
        return None;
    }
    ui.data_mut(|data| data.remove::<String>(key));
    held?;
    if text.trim() == doc.select.as_deref().unwrap_or_default() {
        return None;
    }
    if text.trim().is_empty() {
        return Some(None);
    }
    let scene = model.shown.as_ref().map(|shown| shown.session.scene())?;
    match read_residues(scene, &doc.id, &text) {
        Ok(select) => Some(Some(select)),
        Err(e) => {
            model.notices.error(e.to_string());
            None
        }
    }
}

/// The residues that are drawn, read once for each file and selection.
fn listed(ui: &Ui, model: &Model, doc: &MoleculeDoc) -> Arc<Vec<NamedResidue>> {
    let key = Id::unique(("residues", &doc.id, &doc.source, &doc.style.selection, model.scenes));
    if let Some(known) = ui.data(|data| data.get_temp::<Arc<Vec<NamedResidue>>>(key)) {
        return known;
    }
    let scene = model.shown.as_ref().map(|shown| shown.session.scene());
    let found = Arc::new(scene.map_or_else(Vec::new, |scene| residues(scene, &doc.id)));
    if !found.is_empty() {
        ui.data_mut(|data| data.insert_temp(key, found.clone()));
    }
    found
}

/// The molecule must be seen, of it the atoms of a selection, if any; one step of undo.
fn choose(model: &mut Model, index: usize, select: Option<String>) {
    model.edit(|document| {
        if let Some(LayerDoc::Molecule(molecule)) = document.layer.get_mut(index) {
            (molecule.must_see, molecule.select) = (true, select);
        }
    });
}

/// A residue that was clicked must be seen. Whether the layer is a molecule.
pub(crate) fn choose_clicked(model: &mut Model, layer: &str, select: Option<String>) -> bool {
    let is_it = |one: &LayerDoc| one.id() == layer && matches!(one, LayerDoc::Molecule(_));
    let Some(index) = model.document().layer.iter().position(is_it) else { return false };
    if let Some(select) = select {
        choose(model, index, Some(select));
    }
    true
}
