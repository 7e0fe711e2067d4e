use super::*;

const KINDS: [WarningKind; 10] = [
    WarningKind::Repaired,
    WarningKind::Ignored,
    WarningKind::Assumed,
    WarningKind::Reduced,
    WarningKind::Inexact,
    WarningKind::Suspect,
    WarningKind::Limited,
    WarningKind::Hidden,
    WarningKind::Moved,
    WarningKind::Fallback,
];

#[test]
fn json_holds_what_there_is_and_gives_it_back() {
    let bare = Warning::new(WarningKind::Assumed, "metres are assumed");
    assert_eq!(serde_json::to_string(&bare).unwrap(), r#"{"kind":"assumed","text":"metres are assumed"}"#);
    let full = Warning::counted(WarningKind::Ignored, 3, "points were dropped").unwrap();
    let full = full.in_file(std::path::Path::new("a.gpx")).with("share", 0.25).with("odd", f64::NAN);
    let full = full.settled_by("nodata");
    let json = serde_json::to_value(&full).unwrap();
    let expected = serde_json::json!({ "kind": "ignored", "subject": "a.gpx",
        "figures": { "count": 3.0, "share": 0.25 }, "key": "nodata", "text": "a.gpx: 3 points were dropped" });
    assert_eq!(json, expected);
    for warning in [bare, full] {
        let text = serde_json::to_string(&warning).unwrap();
        assert_eq!(serde_json::from_str::<Warning>(&text).unwrap(), warning);
    }
}

#[test]
fn words_of_kinds_are_those_of_json() {
    for kind in KINDS {
        assert_eq!(serde_json::to_value(kind).unwrap(), kind.name());
    }
}

#[test]
fn the_text_alone_is_shown() {
    let warning = Warning::new(WarningKind::Moved, "the eye moved").about("camera").with("moved_m", 5.0);
    assert_eq!(warning.placed("scene").to_string(), "scene: the eye moved");
    assert_eq!(Warning::counted(WarningKind::Ignored, 0, "rings"), None);
}
