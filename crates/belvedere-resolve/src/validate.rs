//! Checks of a document without its files.

use super::color::{Complaint, color, optional_color};
use crate::BelvedereError;
use belvedere_core::plain::number;
use belvedere_document::Fallback;
use belvedere_document::{
    AnimationDoc, AutoOrLength, ConstructorDoc, ConstructorKind, FurnitureDoc, LayerDoc, Paths, ScaleDoc,
    SourceDocument, StageDoc, SwitchOrLength, suggestion,
};
use belvedere_overlay::highlight;
use belvedere_overlay::sheet::Sheet;
use belvedere_scene::Unit;
use std::collections::HashSet;

/// Ids, ranges and combinations of keys.
pub fn document(source: &SourceDocument) -> Result<(), BelvedereError> {
    let mut ids = HashSet::new();
    for (i, layer) in source.document.layer.iter().enumerate() {
        let at = i.to_string();
        let fail = |key: &str, reason: String| source.error(&["layer", &at, key], reason);
        if layer.id().trim().is_empty() {
            return Err(fail("id", "the id is empty; give the layer a name of its own".into()).into());
        }
        if !ids.insert(layer.id()) {
            return Err(fail("id", format!("two layers have the id \"{}\"; give each its own", layer.id())).into());
        }
        if matches!(layer, LayerDoc::Molecule(_)) && source.document.unit != Unit::Angstrom {
            let reason = "molecules are measured in angstrom; write unit = \"angstrom\" at the top of the scene";
            return Err(fail("kind", format!("layer \"{}\": {reason}", layer.id())).into());
        }
        layer_sources(layer).map_err(|(key, reason)| fail(key, format!("layer \"{}\": {reason}", layer.id())))?;
        by_property(layer).map_err(|(keys, reason)| {
            let keys: Vec<&str> = ["layer", &at, "style"].into_iter().chain(keys).collect();
            source.error(&keys, format!("layer \"{}\": {reason}", layer.id()))
        })?;
        layer_style(layer).map_err(|(key, reason)| {
            source.error(&["layer", &at, "style", key], format!("layer \"{}\": {reason}", layer.id()))
        })?;
    }
    stage_order(source)?;
    terrain_intent(source)?;
    if let Some(SwitchOrLength::Length(spacing)) = source.document.overlay.as_ref().and_then(|o| o.grid) {
        within("grid", spacing, 0.0, 1e9).map_err(|(key, reason)| source.error(&["overlay", key], reason))?;
    }
    if let Some(doc) = &source.document.print {
        Sheet::of(doc, None, source.document.camera.image).map_err(|e| source.error(&["print", e.key], e.reason))?;
    }
    if let Some(doc) = &source.document.furniture {
        furniture(doc, &ids).map_err(|(key, reason)| source.error(&["furniture", key], reason))?;
    }
    if let Some(doc) = &source.document.stylisation {
        doc.strengths().map_err(|(key, reason)| source.error(&["stylisation", key], reason))?;
    }
    if let Some(doc) = &source.document.overlay {
        within("highlight_px", doc.highlight_px, 0.0, 1e6)
            .map_err(|(key, reason)| source.error(&["overlay", key], reason))?;
        if let Some(reason) = highlight::conflict(&doc.highlight, doc.heatmap) {
            return Err(source.error(&["overlay", "highlight"], reason).into());
        }
    }
    super::wall::check(source, super::constructor::previews(source))?;
    if let Some(doc) = &source.document.constructor {
        constructor(doc)
            .map_err(|(key, reason)| source.error(&["constructor", key], format!("constructor: {reason}")))?;
        super::constructor::check_stages(source)?;
    }
    if let Some(doc) = &source.document.animation {
        let goes_on = |kind| matches!(kind, ConstructorKind::PathPreview | ConstructorKind::AutoProbe);
        let constructs = source.document.constructor.as_ref().is_some_and(|c| goes_on(c.kind));
        let moves = constructs || source.document.layer.iter().any(LayerDoc::moves);
        animation(doc, moves)
            .map_err(|(key, reason)| source.error(&["animation", key], format!("animation: {reason}")))?;
    }
    Ok(())
}

/// Most bars of the local scale.
const MOST_BARS: usize = 20;

/// Checks the furniture; `ids` are those of the layers.
fn furniture(doc: &FurnitureDoc, ids: &HashSet<&str>) -> Result<(), Complaint> {
    for (key, table) in [("names", &doc.names), ("credits", &doc.credits)] {
        // The sea has no table of its own.
        let unknown = table.keys().find(|id| !ids.contains(id.as_str()) && id.as_str() != "sea");
        if let Some(id) = unknown {
            let known: Vec<&str> = ids.iter().copied().collect();
            return Err((key, format!("furniture {key}: no layer has the id \"{id}\"; {}", suggestion(id, &known))));
        }
    }
    if let Some(ScaleDoc::At(places)) = &doc.scale {
        if places.is_empty() || places.len() > MOST_BARS {
            let reason = format!("furniture scale names {} places, 1 to {MOST_BARS} are possible", places.len());
            return Err(("scale", reason));
        }
        if let Some(place) = places.iter().find(|place| !place.iter().all(|v| v.is_finite())) {
            return Err(("scale", format!("furniture scale holds the place {place:?}; give finite numbers")));
        }
    }
    Ok(())
}

/// Checks the inputs of the terrain solver besides its parameters.
fn terrain_intent(source: &SourceDocument) -> Result<(), BelvedereError> {
    let layers = &source.document.layer;
    for (i, stage) in source.document.stage.iter().enumerate() {
        let StageDoc::TerrainDisocclusion(doc) = stage else { continue };
        if doc.delta.is_some() {
            continue;
        }
        let at = i.to_string();
        let fail = |key: &[&str], reason: &str| source.error(&[&["stage", &at[..]], key].concat(), reason);
        if !layers.iter().any(|l| matches!(l, LayerDoc::Terrain(_))) {
            return Err(fail(
                &["kind"],
                "terrain_disocclusion needs a layer of kind terrain; add one, or remove the stage",
            )
            .into());
        }
        if !layers.iter().any(LayerDoc::must_see) {
            return Err(fail(
                &["kind"],
                "terrain_disocclusion needs features that must be seen; set must_see = true for at least one layer",
            )
            .into());
        }
        let is_line = |id: &str| layers.iter().any(|l| matches!(l, LayerDoc::Line(line) if line.id == id));
        if let Some(id) = doc.rivers.iter().find(|id| !is_line(id)) {
            let lines: Vec<&str> = layers.iter().filter(|l| matches!(l, LayerDoc::Line(_))).map(LayerDoc::id).collect();
            let hint = suggestion(id, &lines);
            return Err(fail(&["rivers"], &format!("rivers: \"{id}\" is no line layer of the scene; {hint}")).into());
        }
        super::terrain::check(doc).map_err(|(key, reason)| fail(&[key], &reason))?;
    }
    Ok(())
}

fn layer_sources(layer: &LayerDoc) -> Result<(), Complaint> {
    match layer {
        LayerDoc::Line(l) if l.source.is_some() == l.route.is_some() => {
            Err(("source", one_of("source", "route", l.source.is_some())))
        }
        LayerDoc::City(l) if l.loa > 2 => Err((
            "loa",
            format!("loa is {}, it must be 0 (as it is), 1 (blocks) or 2 (blocks between main streets)", l.loa),
        )),
        LayerDoc::Boxes(l) if l.source.is_some() == l.boxes.is_some() => {
            Err(("source", one_of("source", "boxes", l.source.is_some())))
        }
        _ => Ok(()),
    }
}

/// Styles and names by a property: the keys that lead to the mistake, and the reason.
fn by_property(layer: &LayerDoc) -> Result<(), (Vec<&'static str>, String)> {
    let made = match layer {
        LayerDoc::Line(l) => l.route.is_some() || l.source.as_ref().is_some_and(is_builtin),
        LayerDoc::Area(l) => is_builtin(&l.source),
        LayerDoc::Point(l) => is_builtin(&l.source),
        _ => false,
    };
    match super::by_property::key_of(layer).or(super::named::key_of(layer)).filter(|_| made) {
        Some(key) => {
            Err((vec![key], format!("{key} needs a file, for what is generated has no properties; remove it")))
        }
        None => super::by_property::check_layer(layer)
            .map_err(|(table, (key, reason))| (vec![table, key], format!("{table}: {reason}"))),
    }
}

fn is_builtin(source: &Paths) -> bool {
    source.as_slice().iter().any(|name| super::builtin::is_name(name))
}

/// The complaint about two keys of which one is needed.
fn one_of(a: &str, b: &str, both: bool) -> String {
    match both {
        true => format!("{a} and {b} are both given; keep one"),
        false => format!("neither {a} nor {b} is given; give one"),
    }
}

fn layer_style(layer: &LayerDoc) -> Result<(), Complaint> {
    let width = |v: f64| within("width_px", v, 0.0, 100.0);
    if let Some(opacity) = layer.opacity().filter(|opacity| !(0.0..=1.0).contains(opacity)) {
        return Err(("opacity", format!("opacity is {}, it must be in 0..=1", number(opacity))));
    }
    match layer {
        LayerDoc::Terrain(l) => {
            l.largest_hole.map_or(Ok(()), |share| within("largest_hole", share, 0.0, 1.0))?;
            if let Some(SwitchOrLength::Length(interval)) = l.style.contours {
                within("contours", interval, 0.0, 1e9)?;
            }
            within("exaggeration", l.style.exaggeration, 0.0, 100.0)
        }
        LayerDoc::Line(l) => {
            color("color", &l.style.color)?;
            optional_color("casing", &l.style.casing)?;
            width(l.style.width_px)?;
            if let Some(AutoOrLength::Length(every)) = l.style.distance_markers_m {
                within("distance_markers_m", every, 0.0, 1e9)?;
            }
            within("label_px", l.style.label_px, 0.0, 200.0)?;
            lift(l.style.lift_m)
        }
        LayerDoc::Area(l) => {
            l.style.color.as_deref().map_or(Ok(()), |c| color("color", c).map(|_| ()))?;
            if l.style.surface.is_some() && l.style.water.is_some() {
                return Err(("surface", "surface and water are both given; surface says all, remove water".into()));
            }
            l.style.outline.as_deref().map_or(Ok(()), |c| optional_color("outline", c).map(|_| ()))?;
            width(l.style.width_px)?;
            within("label_px", l.style.label_px, 0.0, 200.0)?;
            lift(l.style.lift_m)
        }
        LayerDoc::Point(l) => {
            color("color", &l.style.color)?;
            optional_color("casing", &l.style.casing)?;
            within("size_px", l.style.size_px, 0.0, 200.0)?;
            within("label_px", l.style.label_px, 0.0, 200.0)?;
            lift(l.style.lift_m)
        }
        LayerDoc::Boxes(l) => color("color", &l.style.color).map(|_| ()),
        LayerDoc::Mesh(l) => color("color", &l.style.color).map(|_| ()),
        LayerDoc::Molecule(l) => super::molecule::style(l, None).map(|_| ()),
        LayerDoc::Volume(l) => {
            if !(0.01..=8.0).contains(&l.step) {
                return Err(("step", format!("step is {}, it must be in 0.01..=8 voxel edges", number(l.step))));
            }
            match l.spacing.filter(|s| !s.iter().all(|v| *v > 0.0 && v.is_finite())) {
                Some(s) => Err(("spacing", format!("spacing is {s:?}, every distance must be greater than 0"))),
                None => Ok(()),
            }
        }
        LayerDoc::City(_) => Ok(()),
    }
}

/// Checks that a value is above `low` and at most `high`.
fn within(key: &'static str, value: f64, low: f64, high: f64) -> Result<(), Complaint> {
    if value > low && value <= high {
        return Ok(());
    }
    Err((key, format!("{key} is {}, it must be greater than {low} and at most {high}", number(value))))
}

fn lift(value: f64) -> Result<(), Complaint> {
    if (0.0..=1000.0).contains(&value) {
        return Ok(());
    }
    Err(("lift_m", format!("lift_m is {}, it must be in 0..=1000", number(value))))
}

fn rank(stage: &StageDoc) -> u32 {
    match stage {
        StageDoc::TerrainDisocclusion(_) => 1,
        StageDoc::GroundMoves(_) => 2,
        StageDoc::Strip(_) | StageDoc::Tube(_) | StageDoc::Unroll(_) => 3,
        StageDoc::Relief(_) => 4,
        StageDoc::SplineBend(_) => 5,
        StageDoc::CurvedRays(_) => 6,
    }
}

/// The same rule as `View::new`, with the line of the stage that breaks it.
fn stage_order(source: &SourceDocument) -> Result<(), BelvedereError> {
    for (i, pair) in source.document.stage.windows(2).enumerate() {
        if rank(&pair[0]) >= rank(&pair[1]) {
            let error = belvedere_core::ViewError::Order { first: pair[0].kind(), second: pair[1].kind() };
            return Err(source.error(&["stage", &(i + 1).to_string(), "kind"], error).into());
        }
    }
    Ok(())
}

fn constructor(doc: &ConstructorDoc) -> Result<(), Complaint> {
    if !doc.fallback.is_empty() && doc.target.is_none() {
        return Err((
            "fallback",
            "fallback needs target, what must be seen; name a layer, a part, atoms or a point x,y,z".into(),
        ));
    }
    for rule in &doc.fallback {
        rule.parse::<Fallback>().map_err(|reason| ("fallback", reason))?;
    }
    match doc.kind {
        ConstructorKind::TargetTracking if doc.target.is_none() => {
            Err(("kind", "target_tracking needs target, the layer, part or box to keep in view".into()))
        }
        ConstructorKind::PathPreview if doc.path.is_some() == doc.centreline.is_some() => {
            let given = if doc.path.is_some() { "both are given" } else { "neither is given" };
            Err(("kind", format!("path_preview needs path or centreline, {given}; give exactly one")))
        }
        _ => {
            let lens = doc.lens.unwrap_or_default();
            let stage = [("z0", doc.z0), ("a", doc.a), ("f_step", doc.f_step), ("cap_per_s", doc.cap_per_s)];
            let path = [("preview_m", doc.preview_m), ("behind_m", lens.behind_m), ("width_m", lens.width_m)];
            for (key, value) in stage.into_iter().chain(path).chain([("reach_m", doc.reach_m)]) {
                if let Some(v) = value.filter(|v| !(*v > 0.0)) {
                    return Err((key, format!("{key} is {}, it must be greater than 0", number(v))));
                }
            }
            if let Some(n) = doc.turns.filter(|n| !(1..=6).contains(n)) {
                return Err(("turns", format!("turns is {n}, it must be a whole number in 1..=6")));
            }
            for (key, value) in [("position_m", doc.position_m), ("rise_m", lens.rise_m), ("grow_px", doc.grow_px)] {
                if let Some(v) = value.filter(|v| !(*v >= 0.0)) {
                    return Err((key, format!("{key} is {v}, it must be 0 or more")));
                }
            }
            Ok(())
        }
    }
}

/// Ranges and combinations of keys of an animation.
///
/// * `may_rest`: whether the camera may rest, because something else moves.
pub fn animation(doc: &AnimationDoc, may_rest: bool) -> Result<(), Complaint> {
    let ways = [doc.along.is_some(), doc.camera.is_some(), doc.sweep.is_some(), doc.turntable.is_some()];
    let given = ways.iter().filter(|w| **w).count();
    if given != 1 && !(given == 0 && may_rest) {
        let given = if given == 0 { "none is given" } else { "several are given" };
        return Err(("", format!("exactly one of along, camera, sweep and turntable is needed, {given}")));
    }
    match doc.frames {
        Some(0) => return Err(("frames", "frames is 0, it must be at least 1".into())),
        Some(n) if n > MAX_FRAMES => return Err(("frames", format!("frames is {n}, at most {MAX_FRAMES} are drawn"))),
        _ => {}
    }
    let positive =
        [("fps", doc.fps), ("speed_mps", doc.speed_mps), ("behind_m", doc.behind_m), ("above_m", doc.above_m)];
    for (key, value) in positive.into_iter().chain([("ahead_m", doc.ahead_m)]) {
        if let Some(v) = value.filter(|v| !(*v > 0.0 && *v <= 1e9)) {
            return Err((key, format!("{key} is {}, it must be greater than 0", number(v))));
        }
    }
    if let Some(v) = doc.start_m.filter(|v| !(*v >= 0.0 && v.is_finite())) {
        return Err(("start_m", format!("start_m is {v}, it must be 0 or more")));
    }
    let over = [("marker", doc.marker), ("clock", doc.clock), ("profile", doc.profile)];
    if let Some((key, _)) = over.into_iter().find(|(_, flag)| *flag == Some(true) && doc.along.is_none()) {
        return Err((key, format!("{key} follows a walker along a route; give along, the id of a line layer")));
    }
    if let Some(t) = doc.turntable.as_ref().filter(|t| t.deg_per_s == 0.0 || !t.deg_per_s.is_finite()) {
        return Err(("turntable", format!("deg_per_s is {}, it must not be 0; 12 turns once in 30 s", t.deg_per_s)));
    }
    match doc.sweep.as_ref().map(|s| s.phi_deg) {
        Some([first, last, step])
            if !([first, last].iter().all(|v| (0.0..=90.0).contains(v)) && step > 0.0 && first != last) =>
        {
            Err((
                "sweep",
                format!(
                    "phi_deg is [{first}, {last}, {step}]; give first and last in 0..=90, apart, and a step above 0"
                ),
            ))
        }
        _ => Ok(()),
    }
}

/// Most frames of an animation.
pub const MAX_FRAMES: u32 = 100_000;
