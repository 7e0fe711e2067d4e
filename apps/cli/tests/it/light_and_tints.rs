//! Light, tints and surfaces, as the command line reaches them.

use super::Place;

/// A scene of a mountain with a lake, with more keys.
fn scene(light: &str, terrain: &str, lake: &str) -> String {
    format!(
        "format = 1
crs = 'local'
[camera]
eye = [0, -9000, 6000]
look_at = [0, 0, 800]
image = [96, 64]
{light}
[[layer]]
id = 'ground'
kind = 'terrain'
source = 'builtin:massif?size=129'
[layer.style]
{terrain}
[[layer]]
id = 'lake'
kind = 'area'
source = 'builtin:massif?size=129'
[layer.style]
{lake}
"
    )
}

/// The bytes of the picture of a scene.
fn picture(place: &Place, scene: &str, more: &[&str]) -> Vec<u8> {
    place.write("s.toml", scene);
    place.ok(&[&["render", "s.toml", "-o", "p.png", "--samples", "1", "--overwrite"], more].concat());
    pixels(&super::read(&place.path("p.png")))
}

/// The compressed pixels of a PNG, without the record of the scene that it carries.
pub(super) fn pixels(png: &[u8]) -> Vec<u8> {
    let (mut at, mut out) = (8, Vec::new());
    while at + 8 <= png.len() {
        let length = u32::from_be_bytes([png[at], png[at + 1], png[at + 2], png[at + 3]]) as usize;
        if &png[at + 4..at + 8] == b"IDAT" {
            out.extend_from_slice(&png[at + 8..at + 8 + length]);
        }
        at += 12 + length;
    }
    assert!(!out.is_empty(), "no pixels");
    out
}

#[test]
fn shadows_and_the_time_of_day_change_the_picture() {
    let place = Place::new();
    let of = |light: &str| picture(&place, &scene(light, "relief = 'sun'", ""), &[]);
    let low = "[light]\nazimuth_deg = 250\naltitude_deg = 12\n";
    let (bright, shadows) = (of(low), of(&format!("{low}shadows = true")));
    assert!(bright != shadows && shadows == of(&format!("{low}shadows = true")));
    place.write("s.toml", &scene("[light]\ntime = '2026-07-01T15:00:00Z'\nshadows = true", "", ""));
    assert!(place.fails(&["check", "s.toml"]).contains("georeferenced"));
    let georeferenced = scene("[light]\ntime = '2026-07-01T23:30:00Z'\nshadows = true", "", "")
        .replace("crs = 'local'", "crs = 'EPSG:32632'")
        .replace("eye = [0, -9000, 6000]", "eye = [500000, 5100000, 6000]")
        .replace("look_at = [0, 0, 800]", "look_at = [500000, 5110000, 6000]");
    let without_layers = georeferenced.split("[[layer]]").next().expect("text").to_owned();
    place.write("s.toml", &without_layers);
    let result = place.json(&["render", "s.toml", "-o", "night.png", "--json"]);
    assert!(result["warnings"].to_string().contains("below the horizon"), "{result}");
}

#[test]
fn a_palette_is_a_name_or_a_file_in_the_scene_and_on_the_command_line() {
    let place = Place::new();
    place.write("ramp.txt", "# red low, white high\n0% 200 20 20\n100% white\nnv 0 0 0\n");
    place.write("ramp.cpt", "# COLOR_MODEL = RGB\n0 200/20/20 1 255/255/255\n");
    let auto = picture(&place, &scene("", "", ""), &[]);
    let text = picture(&place, &scene("", "palette = 'ramp.txt'", ""), &[]);
    assert!(auto != text && auto != picture(&place, &scene("", "palette = 'clear'", ""), &[]));
    assert_eq!(
        text,
        picture(&place, &scene("", "palette = 'ramp.cpt'", ""), &[]),
        "the same colours from both formats"
    );
    assert_eq!(text, picture(&place, &scene("", "", ""), &["--palette", "ramp.txt"]));
    let line = place.fails(&["render", "s.toml", "-o", "x.png", "--palette", "alpin"]);
    assert!(line.contains("alpin") && line.contains("alpine"), "{line}");
    place.write("ramp.txt", "0 1 2 3\n100 1 2 red\n");
    place.write("s.toml", &scene("", "palette = 'ramp.txt'", ""));
    let line = place.fails(&["render", "s.toml", "-o", "x.png"]);
    assert!(line.contains("ramp.txt") && line.contains("line 2") && line.contains("s.toml:"), "{line}");
}

#[test]
fn sky_and_haze_are_keys_and_options() {
    let place = Place::new();
    let plain = picture(&place, &scene("", "", ""), &[]);
    let dusk = picture(&place, &scene("[light]\nsky = 'dusk'\nhaze = 2.5", "", ""), &[]);
    assert!(plain != dusk);
    assert_eq!(dusk, picture(&place, &scene("", "", ""), &["--sky", "dusk", "--haze", "2.5"]));
    assert_eq!(plain, picture(&place, &scene("[light]\nsky = 'auto'\nhaze = true", "", ""), &[]));
    place.ok(&["render", "s.toml", "-o", "clear.png", "--sky", "transparent"]);
    let bytes = super::read(&place.path("clear.png"));
    assert_eq!(bytes[25], 6, "a PNG with alpha");
    assert!(place.fails(&["render", "s.toml", "-o", "clear.jpg", "--sky", "transparent"]).contains("PNG"));
    let clear = picture(&place, &scene("[light]\nhaze = false", "", ""), &[]);
    assert!(clear != plain && clear == picture(&place, &scene("", "", ""), &["--haze", "off"]));
    let clouds = picture(&place, &scene("[light]\nclouds = 0.5", "", ""), &[]);
    assert!(clouds != plain && clouds == picture(&place, &scene("", "", ""), &["--clouds=0.5"]));
    assert!(place.fails(&["render", "s.toml", "-o", "x.png", "--clouds", "--sky", "white"]).contains("--clouds"));
    let line = place.fails(&["render", "s.toml", "-o", "x.png", "--sky", "pink"]);
    assert!(line.contains("--sky") && !line.contains("s.toml:"), "{line}");
    let massif = [
        "reveal",
        "builtin:massif?size=65",
        "builtin:massif?size=65",
        "--eye",
        "7972,-7337,3780",
        "--look=-952,1587,221",
    ];
    place.ok(&[&massif[..], &["--size", "96x64", "--sky", "transparent", "-o", "bent.png"]].concat());
    assert_eq!(super::read(&place.path("bent.png"))[25], 6, "a bent picture with alpha, without a pair");
    for (light, named) in [
        ("sky = 'pink'", "pink"),
        ("haze = -1.0", "-1"),
        ("clouds = 2.0", "clouds is 2"),
        ("haze = 'thick'", "kilometres"),
    ] {
        place.write("s.toml", &scene(&format!("[light]\n{light}"), "", ""));
        let line = place.fails(&["check", "s.toml"]);
        assert!(line.contains(named) && line.contains("s.toml:"), "{line}");
    }
}

#[test]
fn the_seasons_of_a_place_on_the_earth_differ() {
    let place = Place::new();
    // The massif, in the Alps.
    let there = |palette: &str| {
        let local = scene("", &format!("palette = '{palette}'"), "");
        picture(&place, &local.replace("crs = 'local'", "crs = 'EPSG:32632'"), &[])
    };
    let looks = ["auto", "winter", "autumn", "atlas", "alpine", "desert", "night"].map(there);
    for (i, a) in looks.iter().enumerate() {
        assert!(looks[i + 1..].iter().all(|b| a != b), "look {i} is also another one");
    }
}

#[test]
fn surfaces_are_chosen_by_key_and_look_their_own() {
    let place = Place::new();
    let of = |lake: &str| picture(&place, &scene("", "", lake), &[]);
    let looks = ["", "surface = 'plain'", "surface = 'forest'", "surface = 'glacier'"].map(of);
    for (i, a) in looks.iter().enumerate() {
        for b in &looks[i + 1..] {
            assert!(a != b, "two surfaces look alike");
        }
    }
    assert_eq!(looks[0], of("surface = 'water'"));
    assert_eq!(looks[0], of("water = true"), "the built-in lake has its own colour of water");
    place.write("s.toml", &scene("", "", "surface = 'water'\nwater = true"));
    assert!(place.fails(&["check", "s.toml"]).contains("remove water"));
    place.write("s.toml", &scene("", "", "surface = 'swamp'"));
    assert!(place.fails(&["check", "s.toml"]).contains("swamp"));
}
