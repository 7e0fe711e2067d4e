//! Pictures on paper, and the formats that names choose.

use super::{Place, read};
use std::path::Path;

const SCENE: &str = "format = 1
crs = 'local'
[[layer]]
id = 'ground'
kind = 'terrain'
source = 'builtin:massif?size=65'
[[layer]]
id = 'trail'
kind = 'line'
source = 'builtin:massif?size=65'
style = { color = '#ff00ff', casing = '#00ff00', width_px = 6.0, hidden = 'show' }
[camera]
eye = [7971.7, -7336.9, 3780.0]
look_at = [-952.3, 1587.0, 2400.0]
fov_y_deg = 51
image = [320, 180]
";

/// Width and height of a PNG.
fn size(png: &[u8]) -> [u32; 2] {
    [16, 20].map(|at| u32::from_be_bytes([png[at], png[at + 1], png[at + 2], png[at + 3]]))
}

/// Share of the ids of a picture that are those of the trail.
fn share_of_trail(place: &Place, name: &str) -> f64 {
    let npy = read(&place.path(name));
    let start = 10 + usize::from(u16::from_le_bytes([npy[8], npy[9]]));
    let ids = npy[start..].chunks_exact(4);
    let all = ids.len() as f64;
    ids.filter(|id| id[0] == 2).count() as f64 / all
}

#[test]
fn a_poster_and_its_preview_look_alike() {
    let place = Place::new();
    place.write("s.toml", SCENE);
    let paper = ["render", "s.toml", "--paper", "160x90mm", "--aux", "id", "-o"];
    place.ok(&[&paper[..], &["poster.png", "--dpi", "192"]].concat());
    place.ok(&[&paper[..], &["preview.png", "--size", "302x170"]].concat());
    let poster = read(&place.path("poster.png"));
    assert_eq!(size(&poster), [1209, 680], "160 x 90 mm at 192 per inch");
    // pHYs: 7559 per metre, twice, by the metre.
    let at = poster.windows(4).position(|w| w == b"pHYs").expect("a resolution");
    assert_eq!(poster[at + 4..at + 13], [0, 0, 0x1d, 0x87, 0, 0, 0x1d, 0x87, 1]);
    let [a, b] = ["poster.id.npy", "preview.id.npy"].map(|name| share_of_trail(&place, name));
    assert!(a > 0.003 && (a / b - 1.0).abs() < 0.1, "{a} of the poster and {b} of the preview are trail");
    let record: serde_json::Value = serde_json::from_slice(&read(&place.path("poster.png.json"))).expect("JSON");
    assert_eq!(record["print"], serde_json::json!({ "paper_mm": [160.0, 90.0], "margin_mm": 0.0, "dpi": 192.0 }));
    assert_eq!(record["scene"]["print"]["dpi"], 192.0);
    // A scene that states its paper draws the same.
    place.write("p.toml", &SCENE.replace("[camera]", "[print]\npaper = '160x90mm'\ndpi = 192\n[camera]"));
    place.ok(&["render", "p.toml", "-o", "stated.png"]);
    let pixels = super::light_and_tints::pixels;
    assert!(pixels(&read(&place.path("stated.png"))) == pixels(&poster));
}

#[test]
fn the_ending_of_a_name_chooses_the_format() {
    let place = Place::new();
    place.write("s.toml", SCENE);
    let begins: [(&str, &[u8]); 7] = [
        ("a.png", b"\x89PNG"),
        ("a.tif", b"II*\0"),
        ("a.jpg", b"\xff\xd8\xff"),
        ("a.webp", b"RIFF"),
        ("a.svg", b"<?xml"),
        ("a.pdf", b"%PDF-"),
        ("a.JPEG", b"\xff\xd8\xff"),
    ];
    for (name, beginning) in begins {
        place.ok(&["render", "s.toml", "-o", name, "--dpi", "100"]);
        assert!(read(&place.path(name)).starts_with(beginning), "{name}");
        assert!(Path::new(&place.path(&format!("{name}.json"))).exists());
    }
    // Layers of a PDF, and letters that can be copied.
    let pdf = read(&place.path("a.pdf"));
    let has = |words: &[u8]| pdf.windows(words.len()).any(|w| w == words);
    assert!(has(b"/OCProperties") && has(b"/Order") && has(b"(trail)") && has(b"(surfaces)"));
    place.ok(&["render", "s.toml", "-o", "alone.svg", "--vectors-only"]);
    let alone = String::from_utf8(read(&place.path("alone.svg"))).expect("UTF-8");
    assert!(!alone.contains("<image") && alone.contains("inkscape:label=\"trail\""));
    let reveal = ["reveal", "builtin:massif?seed=7&size=65", "builtin:massif?seed=7&size=65"];
    place.ok(&[&reveal[..], &["-o", "r.svg", "--paper", "A6", "--dpi", "60", "--scene", "r.toml"]].concat());
    let scene = String::from_utf8(read(&place.path("r.toml"))).expect("UTF-8");
    assert!(scene.contains("[print]") && scene.contains("paper = \"148x105mm\""), "{scene}");
    assert!(!place.path("r.pair.png").exists() && place.path("r.svg").exists());
}

#[test]
fn papers_that_cannot_be_drawn_are_refused_in_one_line() {
    let place = Place::new();
    place.write("s.toml", SCENE);
    place.write("p.toml", &SCENE.replace("[camera]", "[print]\npaper = 'A9'\n[camera]"));
    let cases: [(&[&str], &str); 9] = [
        (&["s.toml", "-o", "a.png", "--paper", "B4"], "is not a paper; give A0 to A6"),
        (&["s.toml", "-o", "a.png", "--paper", "A4", "--dpi", "3"], "must be in 10..=2400 (--dpi)"),
        (&["s.toml", "-o", "a.png", "--paper", "A6", "--margin-mm", "90"], "leaves nothing of 148 x 105 mm"),
        (&["s.toml", "-o", "a.png", "--margin-mm", "9"], "a margin needs a paper"),
        (&["s.toml", "-o", "a.png", "--paper", "A4", "--dpi", "90", "--size", "9x9"], "size and dpi contradict"),
        (&["s.toml", "-o", "a.png", "--compare", "--paper", "A0", "--max-mem", "300MiB"], "--max-mem"),
        (&["s.toml", "-o", "a.png", "--vectors-only"], "--vectors-only needs an output named .svg or .pdf"),
        (&["s.toml", "-o", "a.svg", "--compare"], "two pictures of pixels"),
        (&["p.toml", "-o", "a.png"], "p.toml:13: \"A9\" is not a paper"),
    ];
    for (args, words) in cases {
        let said = place.fails(&[&["render"], args].concat());
        assert!(said.contains(words), "{args:?}: {said}");
    }
    assert!(!place.path("a.png").exists());
}
