//! Five tasks of a newcomer, done by nothing but the names that the window tells a screen reader; their actions are counted.

use crate::{opened, wait_for};
use belvedere::scene_file::{LayerDoc, PresetsDoc, StageDoc};
use belvedere_viewer::{Opening, Viewer};
use eframe::egui::{
    DroppedFile, Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, TouchPhase, accesskit::Role, pos2, vec2,
};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Time of one click or entry, seconds, and that of a task.
const ACTION: f64 = 3.0;
const TASK: f64 = 180.0;

#[derive(Debug)]
struct Dropped(PathBuf);

impl DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|e| e.to_string())
    }
}

/// Height of the window, points.
const HEIGHT: f32 = 760.0;

/// Somebody who only knows the names on the screen.
struct Person {
    harness: Harness<'static, Viewer>,
    actions: Vec<String>,
    waited: Duration,
}

impl Person {
    fn before(opening: &Opening) -> Self {
        let opening = opening.clone();
        let builder = Harness::builder().with_size([900.0, HEIGHT]).with_max_steps(4);
        let mut harness = builder.build_eframe(move |cc| Viewer::new(&cc.egui_ctx, &opening));
        (0..3).for_each(|_| harness.step());
        Self { harness, actions: Vec::new(), waited: Duration::ZERO }
    }

    /// Turns the wheel over the panel until a control of that name is in sight.
    fn scroll_to(&mut self, name: &str) {
        for _ in 0..10 {
            // What touches the lower edge may be cut off there.
            if self.harness.query_all_by_label(name).any(|node| node.rect().bottom() < HEIGHT - 16.0) {
                return;
            }
            self.actions.push("wheel".into());
            self.harness.hover_at(pos2(150.0, 500.0));
            let (unit, delta, phase) = (MouseWheelUnit::Point, vec2(0.0, -240.0), TouchPhase::Move);
            self.harness.event(Event::MouseWheel {
                unit,
                delta,
                phase,
                modifiers: Modifiers::NONE,
                source: MouseWheelSource::Wheel,
            });
            (0..20).for_each(|_| self.harness.step());
        }
    }

    fn press(&mut self, name: &str) {
        self.scroll_to(name);
        self.actions.push(name.to_owned());
        let named: Vec<_> = self.harness.get_all_by_label(name).collect();
        let is_text = |node: &&egui_kittest::Node<'_>| node.accesskit_node().role() == Role::Label;
        // What lies over the rest, such as an open list, comes last.
        let control = named.iter().rev().find(|node| !is_text(node)).unwrap_or(&named[0]);
        control.click();
        (0..8).for_each(|_| self.harness.step());
    }

    fn enter(&mut self, name: &str, text: &str) {
        self.actions.push(format!("{name}: {text}"));
        self.harness.get_by_label(name).focus();
        self.harness.step();
        self.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        self.harness.event(Event::Text(text.into()));
        self.harness.step();
        self.harness.key_press(Key::Enter);
        (0..3).for_each(|_| self.harness.step());
    }

    fn drop_files(&mut self, files: &[PathBuf]) {
        self.actions.push("drop the files".into());
        for file in files {
            self.harness.input_mut().dropped_files.push(Arc::new(Dropped(file.clone())));
        }
        self.harness.step();
    }

    fn wait(&mut self, what: &str, holds: impl Fn(&Harness<'static, Viewer>) -> bool) {
        let began = Instant::now();
        wait_for(&mut self.harness, what, holds);
        self.waited += began.elapsed();
    }

    fn wait_for_picture(&mut self) {
        (0..2).for_each(|_| self.harness.step());
        self.wait("the picture", |harness| harness.state().rests());
    }

    /// Prints what it took, and holds it against the time of a task.
    #[allow(clippy::print_stderr)]
    fn done(self, task: &str) {
        let (actions, waited) = (self.actions.len(), self.waited.as_secs_f64());
        let all = ACTION * actions as f64 + waited;
        eprintln!("{task}: {actions} actions, {waited:.1} s of waiting, {all:.0} s: {}", self.actions.join(" > "));
        assert!(ACTION * actions as f64 <= TASK / 3.0, "{task}: {:?}", self.actions);
        // Without optimisation the waiting says nothing.
        assert!(cfg!(debug_assertions) || all <= TASK, "{task}: {all:.0} s");
    }
}

/// The elevation model and the route of the first and the last task.
fn pair() -> Option<[PathBuf; 2]> {
    Some([belvedere_testkit::data("cases/dem.tif")?, belvedere_testkit::data("cases/route.gpx")?])
}

#[test]
fn an_own_elevation_model_and_a_track_are_revealed() {
    let Some(pair) = pair() else { return };
    let mut person = Person::before(&Opening::default());
    person.harness.get_by_label("Drop an elevation model and a track");
    person.drop_files(&pair);
    person.wait("the scene", |harness| {
        let layers = &harness.state().document().layer;
        layers.iter().any(|layer| matches!(layer, LayerDoc::Line(_)) && layer.must_see())
    });
    person.wait_for_picture();
    person.wait("the share", |harness| harness.state().is_judged());
    let shares: Vec<String> = person
        .harness
        .query_all_by_label_contains(" visible, ")
        .filter_map(|node| node.accesskit_node().value().or(node.accesskit_node().label()))
        .collect();
    let seen = shares.iter().filter_map(|words| words.split(' ').next()?.parse::<f64>().ok()).next();
    assert!(seen.is_some_and(|share| share > 95.0), "{shares:?}");
    person.done("an own model and a track revealed");
}

#[test]
fn a_preset_of_three_sections_is_made_for_a_city() {
    let folder = tempfile::tempdir().expect("folder");
    let level = |id: &str, loa: u32| {
        format!("[[layer]]\nid = \"{id}\"\nkind = \"city\"\nsource = \"builtin:town?seed=7&size=500\"\nloa = {loa}\n")
    };
    let text = format!(
        "format = 1\ncrs = \"local\"\n[camera]\neye = [-60.0, -450.0, 160.0]\nlook_at = [0.0, -50.0, 0.0]\nimage = [160, 90]\n{}{}{}",
        level("houses", 0),
        level("blocks", 1),
        level("quarters", 2)
    );
    let path = folder.path().join("town.toml");
    std::fs::write(&path, text).expect("scene");
    let mut person = Person::before(&opened(&[path]));
    person.wait_for_picture();
    person.press("Spline");
    person.press("progressive");
    person.wait_for_picture();
    for n in sections(&person.harness).len()..3 {
        person.press(&format!("Split section {n} in two"));
        person.wait_for_picture();
    }
    for (n, layer) in [(1, "houses"), (2, "blocks"), (3, "quarters")] {
        person.press(&format!("Section {n}"));
        person.press(layer);
    }
    person.wait_for_picture();
    assert_eq!(sections(&person.harness), ["houses", "blocks", "quarters"]);
    person.done("a preset of three sections");
}

/// Sections of the first preset.
fn sections(harness: &Harness<'static, Viewer>) -> Vec<String> {
    match harness.state().document().stage.first() {
        Some(StageDoc::SplineBend(stage)) => match &stage.presets {
            PresetsDoc::Inline(presets) => presets.presets[0].sections.clone(),
            PresetsDoc::Named(name) => {
                belvedere::core::presets::PresetDocument::builtin(name).expect("built in").presets[0].sections.clone()
            }
        },
        _ => Vec::new(),
    }
}

#[test]
fn the_residues_of_a_molecule_are_told_apart_and_it_is_bent() {
    let Some(file) = belvedere_testkit::data("molecules/1bna.pdb") else { return };
    let mut person = Person::before(&Opening::default());
    person.press("Open files…");
    person.enter("File, or folder to go to", &file.display().to_string());
    person.wait("the molecule", |harness| {
        harness.state().document().layer.iter().any(|layer| matches!(layer, LayerDoc::Molecule(_)))
    });
    person.wait_for_picture();
    let id = person.harness.state().document().layer[0].id().to_owned();
    person.press(&format!("Style of {id}"));
    person.press(&format!("coloured by, {id}"));
    person.press("residue");
    person.wait_for_picture();
    person.press("Spline");
    person.press("progressive");
    person.wait_for_picture();
    let document = person.harness.state().document().clone();
    let LayerDoc::Molecule(molecule) = &document.layer[0] else { panic!("no molecule") };
    assert_eq!((molecule.style.color.as_str(), document.stage.len()), ("residue", 1));
    person.done("the residues of a molecule");
}

#[test]
fn a_hidden_residue_of_a_molecule_is_shown() {
    let Some(file) = belvedere_testkit::data("molecules/1bna.pdb") else { return };
    let mut person = Person::before(&Opening::default());
    person.press("Open files…");
    person.enter("File, or folder to go to", &file.display().to_string());
    person.wait("the molecule", |harness| {
        harness.state().document().layer.iter().any(|layer| matches!(layer, LayerDoc::Molecule(_)))
    });
    person.wait_for_picture();
    let id = person.harness.state().document().layer[0].id().to_owned();
    person.enter(&format!("atoms of {id} that must be seen"), "B 18");
    person.wait_for_picture();
    person.press(&format!("Bend rays to show it, {id}"));
    person.wait_for_picture();
    person.wait("the share", |harness| harness.state().is_judged());
    let document = person.harness.state().document().clone();
    let LayerDoc::Molecule(molecule) = &document.layer[0] else { panic!("no molecule") };
    assert_eq!((molecule.must_see, molecule.select.as_deref()), (true, Some("chain B and resi 18")));
    let target = document.constructor.as_ref().and_then(|constructor| constructor.target.as_deref());
    assert_eq!(target, Some("chain B and resi 18"));
    person.press("Curved rays");
    let said = |start: &str| person.harness.query_all_by_label_contains(start).next().is_some();
    assert!(said("chain B and resi 18"));
    person.done("a residue of a molecule shown");
}

#[test]
fn a_film_along_a_route_is_made() {
    let Some(pair) = pair() else { return };
    let folder = tempfile::tempdir().expect("folder");
    let mut person = Person::before(&Opening::default());
    person.drop_files(&pair);
    person.wait("the scene", |harness| harness.state().document().layer.iter().any(|layer| layer.must_see()));
    person.wait_for_picture();
    person.press("Export");
    person.enter("Width, pixels", "96");
    person.enter("Height, pixels", "54");
    person.press("Film");
    person.press("along a route");
    person.enter("Seconds", "0.5");
    person.enter("Frames per second", "4");
    person.press("Export film…");
    let out = folder.path().join("film");
    person.enter("File, or folder to go to", &out.display().to_string());
    person.wait("the film", |harness| harness.query_by_label_contains("Written:").is_some());
    assert!(out.read_dir().expect("frames").count() >= 2);
    person.done("a film along a route");
}
