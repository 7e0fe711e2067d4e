//! Properties of the files of layers, read beside the window when a style is opened.

use crate::language::{fill, tr};
use crate::model::Model;
use belvedere::by_property::{Field, fields};
use belvedere::scene_file::LayerDoc;
use belvedere_studio::beside;
use eframe::egui::{Id, Ui};
use std::sync::{Arc, OnceLock};

/// Sample values that are told.
const SAMPLES: usize = 3;
/// Letters of a sample value.
const LETTERS: usize = 16;
/// Time after which the window looks again, seconds.
const AGAIN: f32 = 0.1;

/// The properties, once they are read.
pub(super) type Reading = Arc<OnceLock<Result<Vec<Field>, String>>>;

/// The properties of a layer's files; reads them at the first call.
pub(super) fn of(ui: &Ui, model: &Model, layer: &LayerDoc) -> Reading {
    let roots = &model.editor.place.roots;
    let source = match layer {
        LayerDoc::Line(l) => format!("{:?} {:?}", l.source, l.select),
        LayerDoc::Area(l) => format!("{:?}", l.source),
        LayerDoc::Point(l) => format!("{:?}", l.source),
        _ => String::new(),
    };
    let place = (&roots.scene_dir, &roots.allowed, &roots.files, model.scenes);
    let key = Id::unique(("properties", layer.kind(), source, place));
    if let Some(reading) = ui.data(|data| data.get_temp::<Reading>(key)) {
        if reading.get().is_none() {
            ui.request_repaint_after_secs(AGAIN);
        }
        return reading;
    }
    let reading = Reading::default();
    ui.data_mut(|data| data.insert_temp(key, reading.clone()));
    let (layer, roots, inbox) = (layer.clone(), roots.clone(), reading.clone());
    let read = move || drop(inbox.set(fields(&layer, &roots).map_err(|e| e.to_string())));
    if let Err(reason) = beside(read) {
        let _ = reading.set(Err(reason));
    }
    ui.request_repaint_after_secs(AGAIN);
    reading
}

/// The name of a property with a few of its values.
pub(super) fn described(field: &Field) -> String {
    let short = |value: &str| match value.chars().count() > LETTERS {
        true => value.chars().take(LETTERS - 1).chain(['…']).collect::<String>(),
        false => value.to_owned(),
    };
    let samples: Vec<String> = field.values.iter().take(SAMPLES).map(|(value, _)| short(value)).collect();
    let more = if field.values.len() > SAMPLES { ", …" } else { "" };
    fill(tr("{0}: {1}{2}"), &[&field.name, &samples.join(", "), &more])
}
