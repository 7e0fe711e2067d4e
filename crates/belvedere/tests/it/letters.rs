//! Names in scripts that the embedded font lacks: which font sets them, in which order, what files of vectors say, and that none is lost in
//! silence; ranks, heights and symbols of points.

use belvedere::composite::canvas::{Canvas, CanvasShape, Fonts, fonts_in};
use belvedere::core::DVec2;
use belvedere::picture::PictureOptions;
use belvedere::scene::{Color, FontFile, PlaceKind, Symbol};
use belvedere::scene_file::parse;
use belvedere::vectors::VectorContent;
use belvedere::{OpenOptions, Session};
use belvedere_testkit::font::tiny_font;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

const FUJI: &str = "富士山";
const BLACK: Color = Color::rgb(0, 0, 0);

fn fonts(letters: &str) -> Fonts {
    let bytes = Arc::new(tiny_font("Tiny Squares", &letters.chars().collect::<Vec<_>>()));
    Fonts::with(&[FontFile { name: "tiny.ttf".into(), bytes, index: 0 }])
}

#[test]
fn letters_that_the_embedded_font_lacks_are_set_by_the_next() {
    let (embedded, fonts) = (Fonts::default(), fonts("富士山שלום"));
    assert!(embedded.can_set("Fuji Ελ Эль") && !embedded.can_set(FUJI) && fonts.can_set(FUJI));
    assert_eq!(fonts.lacks("富山湖").into_iter().collect::<String>(), "湖");
    assert_eq!(fonts.families(), ["Tiny Squares"]);
    let letters = fonts.letters("Fuji 富士山");
    let told: Vec<(usize, &str)> = letters.iter().map(|l| (l.font, l.characters.as_str())).collect();
    assert_eq!(told, [(0, "F"), (0, "u"), (0, "j"), (0, "i"), (0, " "), (1, "富"), (1, "士"), (1, "山")]);
    assert!(letters.windows(2).all(|pair| pair[0].at[0] < pair[1].at[0]));
    assert!((fonts.text_size(20.0, FUJI).width - 30.0).abs() < 0.01);
    // A letter of no font is an empty box, not nothing.
    let lost = fonts.letters("湖");
    assert_eq!((lost.len(), lost[0].font, lost[0].glyph), (1, 0, 0));
}

#[test]
fn names_from_right_to_left_run_so_and_numbers_in_them_do_not() {
    let fonts = fonts("שלום");
    let letters = fonts.letters("שלום 2814");
    let shown: String = letters.iter().map(|l| l.characters.as_str()).collect();
    assert_eq!(shown, "2814 םולש");
    assert!(letters.windows(2).all(|pair| pair[0].at[0] < pair[1].at[0]), "{letters:?}");
    let mixed: String = fonts.letters("Har שלום").iter().map(|l| l.characters.clone()).collect();
    assert_eq!(mixed, "Har םולש");
}

#[test]
fn letters_of_further_fonts_have_ink_straight_and_along_curves() {
    let fonts = fonts(FUJI);
    let ink = |draw: &dyn Fn(&mut Canvas<'_>)| {
        let mut pixels = vec![[255u8; 3]; 200 * 100];
        draw(Canvas::new(&mut pixels, 200).in_fonts(&fonts));
        pixels.iter().map(|p| 1.0 - f64::from(p[0]) / 255.0).sum::<f64>()
    };
    // Squares of 0.4 em; pixels that they cover in part are lighter, for colours blend in linear light.
    let wanted = 3.0 * (0.4 * 30.0f64).powi(2);
    let straight = ink(&|canvas| canvas.text(DVec2::new(20.0, 60.0), 30.0, FUJI, BLACK, None));
    assert!((straight / wanted - 1.0).abs() < 0.08, "{straight} of {wanted}");
    let bow: Vec<DVec2> = (0..150).map(|i| DVec2::new(20.0 + f64::from(i), 60.0 - 0.002 * f64::from(i * i))).collect();
    let curved = ink(&|canvas| canvas.text_along(&bow, 30.0, FUJI, BLACK, None));
    assert!((curved / wanted - 1.0).abs() < 0.08, "{curved} of {wanted}");
    let mut shapes = Vec::new();
    Canvas::recording(&mut shapes, [200, 100]).in_fonts(&fonts).text_along(&bow, 30.0, FUJI, BLACK, None);
    assert!(matches!(&shapes[0], CanvasShape::Text { along, .. } if along.len() == bow.len()));
}

#[test]
fn files_that_are_no_fonts_have_none() {
    let wanted: BTreeSet<char> = FUJI.chars().collect();
    assert_eq!(fonts_in(&tiny_font("T", &['富']), &wanted, true), [BTreeSet::from(['富'])]);
    for bytes in [&b""[..], b"plain words", b"ttcf\0\x01\0\0\0\0\0\x02", &tiny_font("T", &['富'])[..40]] {
        assert!(fonts_in(bytes, &wanted, false).iter().all(BTreeSet::is_empty));
    }
    // Damaged in any byte it is read or refused, and draws without end or panic.
    let whole = tiny_font("T", &['富', '士', '山']);
    for i in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[i] ^= 0xff;
        let fonts = Fonts::with(&[FontFile { name: "t".into(), bytes: Arc::new(bytes), index: 0 }]);
        let mut pixels = vec![[255u8; 3]; 60 * 30];
        Canvas::new(&mut pixels, 60).in_fonts(&fonts).text(DVec2::new(5.0, 20.0), 14.0, FUJI, BLACK, None);
    }
}

/// A scene of points over the built-in massif in a folder of its own.
fn scene(folder: &Path, points: &str, style: &str, text: &str) -> Result<Session, belvedere::BelvedereError> {
    std::fs::write(folder.join("points.geojson"), points).expect("written");
    let document = format!(
        "format = 1\ncrs = 'local'\n{text}\n[[layer]]\nid = 'ground'\nkind = 'terrain'\n\
         source = 'builtin:massif?seed=7&size=129'\n[[layer]]\nid = 'places'\nkind = 'point'\n\
         source = 'points.geojson'\nstyle = {{ {style} }}\n[camera]\neye = [0, -4000, 22000]\nlook_at = [0, 0, 2000]\n\
         fov_y_deg = 40\nimage = [400, 300]\n"
    );
    let path = folder.join("scene.toml");
    Session::from_document(parse(&path, &document).expect("scene"), &OpenOptions::default())
}

fn points(all: &[(&str, [f64; 2], &str)]) -> String {
    let feature = |(name, [x, y], more): &(&str, [f64; 2], &str)| {
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"name\":\"{name}\"{more}}},\
             \"geometry\":{{\"type\":\"Point\",\"coordinates\":[{x},{y}]}}}}"
        )
    };
    let features: Vec<String> = all.iter().map(feature).collect();
    format!("{{\"type\":\"FeatureCollection\",\"features\":[{}]}}", features.join(","))
}

#[test]
fn a_scene_names_its_fonts_and_what_no_font_sets_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("tiny.ttf"), tiny_font("Tiny", &FUJI.chars().collect::<Vec<_>>())).expect("font");
    let places = points(&[(FUJI, [0.0, 0.0], ""), ("湖", [900.0, 900.0], ""), ("Fuji", [-900.0, -900.0], "")]);
    let alone = "[text]\nsystem_fonts = false";
    let unset = |session: &Session| {
        session.warnings().iter().find(|w| w.text().contains("no font")).map(|w| w.text().to_owned())
    };
    let session = scene(folder.path(), &places, "labels = true", alone).expect("opens");
    assert!(unset(&session).is_some_and(|said| said.contains("2 names")), "{:?}", session.warnings());
    let with = "[text]\nsystem_fonts = false\nfonts = 'tiny.ttf'";
    let session = scene(folder.path(), &places, "labels = true", with).expect("opens");
    assert!(
        unset(&session).is_some_and(|said| said.contains("1 name") && said.contains('湖')),
        "{:?}",
        session.warnings()
    );
    assert!(session.inputs().iter().any(|file| file.path.ends_with("tiny.ttf") && file.sha256.len() == 64));
    // Copied text is that of the names, in PDF and in SVG.
    let picture = session.render(&PictureOptions { vectors: VectorContent::Alone, ..PictureOptions::default() });
    let picture = picture.expect("drawn");
    let pdf = picture.to_pdf().expect("written").expect("vectors");
    let has = |bytes: &[u8]| pdf.windows(bytes.len()).any(|part| part == bytes);
    assert!(has(b"/Type3") && has(b"/CharProcs") && has(b"/ToUnicode"));
    assert!(picture.to_svg().expect("written").expect("vectors").contains(FUJI));
    // Refusals.
    for (fonts, wanted) in
        [("points.geojson", "no font"), ("../tiny.ttf", "leaves the folder"), ("absent.ttf", "not there")]
    {
        let said = scene(folder.path(), &places, "labels = true", &format!("[text]\nfonts = '{fonts}'"));
        let said = said.expect_err("refused").to_string();
        assert!(said.contains(wanted) && said.chars().count() <= 500, "{said}");
    }
}

#[test]
fn points_have_the_symbols_ranks_and_heights_that_they_say() {
    let folder = tempfile::tempdir().expect("a folder");
    let places = points(&[
        ("Hut", [0.0, 0.0], ",\"tourism\":\"alpine_hut\""),
        ("Peak", [900.0, 900.0], ",\"natural\":\"peak\",\"ele\":\"2814,6\",\"name:de\":\"Gipfel\""),
        ("Town", [-900.0, -900.0], ",\"place\":\"town\",\"population\":\"12000\""),
        ("Odd", [-900.0, 900.0], ",\"weight\":\"7\""),
    ]);
    let features = |style: &str| {
        let session = scene(folder.path(), &places, style, "").expect("opens");
        let layer = &session.scene().layers.iter().find(|layer| layer.id == "places").expect("there").kind;
        let Some(layer) = layer.points() else { panic!("points") };
        layer.features.clone()
    };
    let own = features("label = 'name:de'");
    let style = |i: usize| own[i].style.unwrap_or_default();
    assert_eq!([0, 1, 2, 3].map(|i| own[i].name.as_str()), ["Hut", "Gipfel", "Town", "Odd"]);
    assert_eq!(
        [0, 1, 2, 3].map(|i| style(i).symbol),
        [Some(Symbol::Hut), Some(Symbol::Triangle), Some(Symbol::Target), None]
    );
    assert_eq!(style(1).kind, Some(PlaceKind::Peak));
    assert_eq!([0, 1, 2, 3].map(|i| style(i).height.map(|h| h.to_string())), [None, Some("2815 m".into()), None, None]);
    assert!(style(2).rank > style(0).rank && style(1).rank.is_some() && style(3).rank.is_none());
    assert!(style(2).scale > 1.0);
    // A stated symbol is that of all, a property ranks, heights are written where they are asked for.
    let own = features("labels = true, symbol = 'pin', rank = 'weight', label_elevation = true");
    assert!(own.iter().all(|f| f.style.is_some_and(|style| style.symbol.is_none() && style.height.is_some())));
    assert_eq!(own[3].style.and_then(|style| style.rank), Some(7.0));
    let said = scene(folder.path(), &places, "labels = true, rank = 'wait'", "").expect_err("refused").to_string();
    assert!(said.contains("weight") && said.contains("rank"), "{said}");
    let said = scene(folder.path(), &places, "label = 'name:xx'", "").expect_err("refused").to_string();
    assert!(said.contains("name:de") && said.contains("label"), "{said}");
}

#[test]
fn symbols_of_ones_own_are_drawn_in_their_colours() {
    let folder = tempfile::tempdir().expect("a folder");
    let svg = "<svg viewBox='0 0 10 10'><rect width='10' height='10' fill='#ff00fe'/></svg>";
    std::fs::write(folder.path().join("own.svg"), svg).expect("written");
    let places = points(&[("A", [0.0, 0.0], "")]);
    let session =
        scene(folder.path(), &places, "symbol = 'own.svg', size_px = 20, hidden = 'show'", "").expect("opens");
    let picture = session.render(&PictureOptions::default()).expect("drawn");
    let frame = &picture.frame;
    let pink = frame.color.iter().filter(|p| **p == [255, 0, 254]).count();
    assert!((340..=441).contains(&pink), "{pink} pixels of the symbol");
    let found = frame.id.iter().filter(|id| **id == 2).count();
    assert!(found > 200, "{found} pixels are found");
    let said = scene(folder.path(), &places, "symbol = 'dat'", "").expect_err("refused").to_string();
    assert!(said.contains("dot"), "{said}");
    std::fs::write(folder.path().join("own.svg"), svg.replace("fill=", "stroke='#000' fill=")).expect("written");
    let said = scene(folder.path(), &places, "symbol = 'own.svg'", "").expect_err("refused").to_string();
    assert!(said.contains("stroke") && said.chars().count() <= 500, "{said}");
}
