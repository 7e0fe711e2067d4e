use super::*;
use belvedere_core::presets::PresetDocument;
use std::path::Path;

fn parsed(layers: &[&str], presets: &str) -> Document {
    let layer =
        |id: &&str| format!("[[layer]]\nid = '{id}'\nkind = 'terrain'\nsource = 'builtin:massif?seed=7&size=65'\n");
    let text = format!(
        "format = 1\n[camera]\neye = [0, 0, 10]\nlook_at = [0, 1, 0]\n[representations]\nnear = ['a']\n{}\
            [[stage]]\nkind = 'spline_bend'\npresets = '{presets}'\n",
        layers.iter().map(layer).collect::<String>()
    );
    crate::scene_file::parse(Path::new("s.toml"), &text).expect("scene").document
}

fn fresh(document: &Document, roots: &Roots) -> Vec<Representation> {
    representations::of(&SourceDocument::new(document.clone()), roots).expect("known")
}

type Change = fn(&mut Document);

/// What is kept is replaced by a mark, which only a document that changes nothing of it brings back.
#[test]
fn representations_are_kept_until_the_document_changes_them() {
    let mark = vec![Representation { id: "mark".into(), layers: Vec::new() }];
    let changes: [(&str, bool, Change); 5] = [
        ("nothing", true, |_| ()),
        ("the camera", true, |d| d.camera.fov_y_deg = 20.0),
        ("a representation", false, |d| drop(d.representations.insert("far".into(), vec!["a".into()]))),
        ("a layer", false, |d| d.layer = parsed(&["a", "b"], "map").layer),
        ("a bend", false, |d| d.stage = parsed(&["a"], "progressive").stage),
    ];
    for (what, is_kept, change) in changes {
        let (mut named, roots, mut document) = (NamedSections::default(), Roots::default(), parsed(&["a"], "map"));
        assert_eq!(named.of(&document, &roots).expect("known"), fresh(&document, &roots));
        named.last.as_mut().expect("kept").1 = mark.clone();
        change(&mut document);
        let found = named.of(&document, &roots).expect("known");
        assert_eq!(found == mark, is_kept, "{what}");
        assert!(is_kept || found == fresh(&document, &roots), "{what}");
    }
    let mut document = parsed(&["a"], "map");
    document.representations.insert("wrong".into(), vec!["b".into()]);
    let mut named = NamedSections::default();
    assert!((0..2).all(|_| named.of(&document, &Roots::default()).is_err()));
}

#[test]
fn presets_in_a_file_are_read_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let roots = Roots { scene_dir: folder.path().to_owned(), ..Roots::default() };
    let document = parsed(&["a", "b", "c"], "p.json");
    let mut named = NamedSections::default();
    for section in ["b", "c"] {
        let mut presets = PresetDocument::builtin("map").expect("built in");
        presets.presets.iter_mut().flat_map(|preset| &mut preset.sections).for_each(|name| *name = section.into());
        let text = serde_json::to_string(&presets).expect("a document");
        std::fs::write(folder.path().join("p.json"), text).expect("written");
        let ids: Vec<String> = named.of(&document, &roots).expect("known").into_iter().map(|r| r.id).collect();
        assert_eq!(ids, [section, "near"]);
    }
}
