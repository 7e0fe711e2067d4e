//! Names of undo steps, found by comparing the document before and after.

use super::Editor;
use belvedere::scene_file::{CameraDoc, ConstructorKind, Document, LayerDoc, StageDoc};

impl Editor {
    /// Names of all steps, oldest first, and the number of those that are not undone.
    pub fn history(&self) -> (Vec<String>, usize) {
        let states: Vec<&Document> =
            self.past.iter().chain([&self.present]).chain(self.future.iter().rev()).map(|state| &**state).collect();
        (states.windows(2).map(|pair| step_name(pair[0], pair[1])).collect(), self.past.len())
    }

    /// Undoes or redoes until `steps` steps are not undone; at most as many as there are.
    pub fn go_to(&mut self, steps: usize) {
        while self.past.len() > steps && self.undo() {}
        while self.past.len() < steps && self.redo() {}
    }
}

/// What a step changed, as a sentence without a subject, such as "moved the eye".
pub fn step_name(before: &Document, after: &Document) -> String {
    let mut names = Vec::new();
    if before.camera != after.camera {
        names.push(camera(&before.camera, &after.camera).to_owned());
    }
    if before.layer != after.layer {
        names.push(layers(&before.layer, &after.layer));
    }
    if before.hidden != after.hidden {
        let differs = |a: &Document, b: &Document| a.hidden.iter().find(|id| !b.hidden.contains(id)).cloned();
        let (hid, shown) = (differs(after, before), differs(before, after));
        let named = hid.map(|id| format!("hid {id}")).or(shown.map(|id| format!("showed {id}")));
        names.extend(named.filter(|_| before.layer.len() == after.layer.len()));
    }
    if before.constructor != after.constructor {
        names.push(constructor(before, after).to_owned());
    }
    names.extend(stages(&before.stage, &after.stage));
    let parts = [
        (before.title != after.title, "changed the title"),
        (before.light != after.light, "changed the light"),
        (before.overlay != after.overlay, "changed the marks"),
        (before.text != after.text, "changed the fonts"),
        (before.stylisation != after.stylisation, "changed the stylisation"),
        (before.representations != after.representations, "changed the representations"),
        (before.animation != after.animation, "changed the animation"),
    ];
    names.extend(parts.into_iter().filter(|(differs, _)| *differs).map(|(_, name)| name.to_owned()));
    match names.as_slice() {
        [] => "changed the scene".into(),
        [one] => one.clone(),
        [first, ..] => format!("{first}, and more"),
    }
}

fn camera(before: &CameraDoc, after: &CameraDoc) -> &'static str {
    let lens = |doc: &CameraDoc| (doc.fov_y_deg, doc.ortho_height_m, doc.projection);
    let aim = |doc: &CameraDoc| (doc.look_at, doc.heading_deg, doc.pitch_deg, doc.up);
    match (before.eye != after.eye, aim(before) != aim(after), lens(before) != lens(after)) {
        (true, true, _) => "moved the camera",
        (true, false, _) => "moved the eye",
        (false, true, _) => "turned the camera",
        (false, false, true) => "changed the field of view",
        (false, false, false) => "changed the size of the picture",
    }
}

fn layers(before: &[LayerDoc], after: &[LayerDoc]) -> String {
    let has = |layers: &[LayerDoc], id: &str| layers.iter().any(|layer| layer.id() == id);
    let added: Vec<&str> = after.iter().map(LayerDoc::id).filter(|id| !has(before, id)).collect();
    let removed: Vec<&str> = before.iter().map(LayerDoc::id).filter(|id| !has(after, id)).collect();
    match (added.as_slice(), removed.as_slice()) {
        ([new], [old]) => format!("renamed {old} to {new}"),
        ([], [old]) => format!("removed {old}"),
        ([new], []) => format!("added {new}"),
        ([], []) => {
            let Some((old, new)) = before.iter().zip(after).find(|(old, new)| old != new) else {
                return "changed the layers".into();
            };
            if old.id() != new.id() {
                return "changed the order of the layers".into();
            }
            if old.with_must_see(new.must_see()) == *new {
                return match new.must_see() {
                    true => format!("{} must be seen", new.id()),
                    false => format!("{} need not be seen", new.id()),
                };
            }
            format!("changed the style of {}", new.id())
        }
        (added, removed) => format!("added {} layers, removed {}", added.len(), removed.len()),
    }
}

fn constructor(before: &Document, after: &Document) -> &'static str {
    let kind = |document: &Document| document.constructor.as_ref().map(|doc| doc.kind);
    match (kind(before), kind(after)) {
        (_, None | Some(ConstructorKind::Manual)) => "bent rays by hand",
        (Some(old), Some(new)) if old == new && new == ConstructorKind::PathPreview => "moved along the path",
        (_, Some(ConstructorKind::PathPreview)) => "looked along a path",
        (_, Some(ConstructorKind::TargetTracking)) => "chose what stays in sight",
        (_, Some(ConstructorKind::AutoProbe)) => "looked into what is hidden",
    }
}

/// Name of a stage for readers.
fn stage_name(kind: &str) -> &'static str {
    match kind {
        "terrain_disocclusion" => "ground that makes way",
        "strip" => "strip",
        "tube" => "tube",
        "unroll" => "circle",
        "relief" => "relief",
        "spline_bend" => "spline",
        "curved_rays" => "curved rays",
        _ => "bend",
    }
}

fn stages(before: &[StageDoc], after: &[StageDoc]) -> Vec<String> {
    let of = |stages: &[StageDoc], kind: &str| stages.iter().find(|stage| stage.kind() == kind).cloned();
    let mut kinds: Vec<&str> = before.iter().chain(after).map(StageDoc::kind).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let named = kinds.into_iter().filter_map(|kind| {
        let name = stage_name(kind);
        match (of(before, kind), of(after, kind)) {
            (None, Some(_)) => Some(format!("added {name}")),
            (Some(_), None) => Some(format!("removed {name}")),
            (Some(StageDoc::CurvedRays(old)), Some(StageDoc::CurvedRays(new))) if old != new => {
                Some(match new.turn.len().cmp(&old.turn.len()) {
                    std::cmp::Ordering::Greater => "added a turn".into(),
                    std::cmp::Ordering::Less => "removed a turn".into(),
                    std::cmp::Ordering::Equal => "changed a turn".into(),
                })
            }
            (old, new) => (old != new).then(|| format!("changed the {name}")),
        }
    });
    named.collect()
}

#[cfg(test)]
mod tests;
