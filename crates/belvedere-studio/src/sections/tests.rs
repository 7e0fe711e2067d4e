use super::*;
use belvedere::scene_file::{SourceDocument, parse};
use belvedere::{OpenOptions, Session};
use std::path::Path;

const TOWN: &str = "format = 1\n[camera]\neye = [-120.0, -900.0, 330.0]\nlook_at = [0.0, -100.0, 0.0]\nimage = [96, 54]\n\
        [[layer]]\nid = 'town'\nkind = 'city'\nsource = 'builtin:town?seed=7&size=800'\n\
        [[stage]]\nkind = 'spline_bend'\npresets = 'progressive'\n";

fn opened(text: &str) -> (Document, PresetDocument) {
    let document = parse(Path::new("s.toml"), text).expect("scene").document;
    (document, PresetDocument::builtin("progressive").expect("built in"))
}

fn sections(document: &Document) -> Vec<String> {
    let StageDoc::SplineBend(stage) = &document.stage[0] else { panic!("no spline") };
    let PresetsDoc::Inline(presets) = &stage.presets else { panic!("not stated") };
    presets.presets[0].sections.clone()
}

#[test]
fn a_city_gets_three_sections_and_the_layers_that_they_show() {
    let (document, presets) = opened(TOWN);
    let next = with_levels(&document, &presets, 0, "town").expect("levels");
    assert_eq!(sections(&next), ["town", "town, blocks", "town, main blocks"]);
    let levels: Vec<(&str, u8)> = next
        .layer
        .iter()
        .map(|layer| match layer {
            LayerDoc::City(city) => (city.id.as_str(), city.loa),
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(levels, [("town", 0), ("town, blocks", 1), ("town, main blocks", 2)]);
    let again = with_levels(&next, &presets, 0, "town").expect("levels");
    assert_eq!(again.layer, next.layer, "layers that are there are used");
    let session = Session::from_document(SourceDocument::new(next), &OpenOptions::default()).expect("session");
    assert_eq!(session.scene().representations.len(), 3);
    assert!(with_levels(&document, &presets, 0, "village").is_err());
    assert!(with_levels(&document, &presets, 4, "town").is_err());
}

#[test]
fn a_section_gets_a_style_of_its_own_and_the_others_keep_theirs() {
    let (document, mut presets) = opened(TOWN);
    presets.presets[0].sections = vec!["all".into(), "all".into()];
    presets.presets[0].tags = vec![TagPoint { u: 0.5, delta: 0.05 }];
    let (next, copy) = with_own_style(&document, &presets, [0, 1], "town").expect("a copy");
    assert_eq!((copy.as_str(), sections(&next)), ("town, section 2", vec!["town".to_owned(), copy.clone()]));
    let mut grouped = document.clone();
    grouped.representations.insert("near".into(), vec!["town".into()]);
    presets.presets[0].sections = vec!["near".into(), "near".into()];
    let (next, copy) = with_own_style(&grouped, &presets, [0, 1], "town").expect("a copy");
    assert_eq!(sections(&next), ["near", "near, section 2"]);
    assert_eq!(next.representations["near, section 2"], [copy]);
    assert!(with_own_style(&document, &presets, [0, 2], "town").is_err());
    assert!(Session::from_document(SourceDocument::new(next), &OpenOptions::default()).is_ok());
}
