//! Colours and sizes of lines, areas and points by a property of their file.

use belvedere::{OpenOptions, PictureOptions, Session};
use std::path::Path;

/// A scene from above over generated ground.
const SCENE: &str = r#"
format = 1
crs = "local"
[camera]
eye = [0.0, -10.0, 6000.0]
look_at = [0.0, 0.0, 0.0]
image = [200, 150]
[[layer]]
kind = "terrain"
id = "ground"
source = "builtin:massif?seed=7&size=65"
[[layer]]
id = "it"
"#;

/// Three parallel lines, three squares or three points, from west to east.
fn features(kind: &str, properties: [&str; 3]) -> String {
    let shape = |i: usize| {
        let x = -1500.0 + 1500.0 * i as f64;
        match kind {
            "line" => format!(r#""LineString", "coordinates": [[{x}, -1200], [{x}, 1200]]"#),
            "area" => {
                let (a, b) = (x - 500.0, x + 500.0);
                format!(
                    r#""Polygon", "coordinates": [[[{a}, -500], [{b}, -500], [{b}, 500], [{a}, 500], [{a}, -500]]]"#
                )
            }
            _ => format!(r#""Point", "coordinates": [{x}, 0]"#),
        }
    };
    let one = |(i, properties): (usize, &str)| {
        format!(r#"{{"type": "Feature", "properties": {properties}, "geometry": {{"type": {}}}}}"#, shape(i))
    };
    let all: Vec<String> = properties.into_iter().enumerate().map(one).collect();
    format!(r#"{{"type": "FeatureCollection", "features": [{}]}}"#, all.join(","))
}

fn open(folder: &Path, kind: &str, properties: [&str; 3], style: &str) -> Result<Session, belvedere::BelvedereError> {
    std::fs::write(folder.join("it.geojson"), features(kind, properties)).expect("features");
    let scene = folder.join("scene.toml");
    let text = format!("{SCENE}kind = \"{kind}\"\nsource = \"it.geojson\"\nstyle = {{ {style} }}\n");
    std::fs::write(&scene, text).expect("scene");
    Session::open(&scene, &OpenOptions::default())
}

/// Numbers of pixels near some colours.
fn pixels<const N: usize>(session: &Session, colors: [[u8; 3]; N]) -> [usize; N] {
    let picture = session.render(&PictureOptions::default()).expect("picture");
    let near = |pixel: &[u8; 3], color: &[u8; 3]| (0..3).all(|i| pixel[i].abs_diff(color[i]) < 24);
    colors.map(|color| picture.frame.color.iter().filter(|pixel| near(pixel, &color)).count())
}

const RED: [u8; 3] = [255, 0, 0];
const BLUE: [u8; 3] = [0, 0, 255];
const BLACK: [u8; 3] = [0, 0, 0];

#[test]
fn lines_have_the_colour_of_their_text_and_the_width_of_their_number() {
    let folder = tempfile::tempdir().expect("folder");
    let properties = [r#"{"road": "main", "lanes": 4}"#, r#"{"road": "lane", "lanes": "1"}"#, "{}"];
    let style = r##"color = "#000000", casing = "none", hidden = "show", width_px = 3,
        color_by = { property = "Road", values = { main = "#ff0000", lane = "#0000ff" } },
        width_by = { property = "lanes", px = [2, 8] }"##
        .replace('\n', " ");
    let session = open(folder.path(), "line", properties, &style).expect("scene");
    let [red, blue, black] = pixels(&session, [RED, BLUE, BLACK]);
    assert!(black > 0 && blue > 0, "the others keep the colour of the layer: {black} {blue}");
    assert!(red > 3 * blue && black > blue, "8, 2 and 3 pixels wide: {red} {blue} {black}");
    assert!(red < 6 * blue && black < red, "8, 2 and 3 pixels wide: {red} {blue} {black}");
}

#[test]
fn points_have_the_size_and_the_class_of_their_number() {
    let folder = tempfile::tempdir().expect("folder");
    let properties = [r#"{"people": 10}"#, r#"{"people": 20}"#, r#"{"people": 900}"#];
    let style = r##"casing = "none", hidden = "show", size_px = 10,
        color_by = { property = "people", scale = "blues", breaks = [100] },
        size_by = { property = "people", px = [6, 24], range = [0, 900] }"##
        .replace('\n', " ");
    let session = open(folder.path(), "point", properties, &style).expect("scene");
    let [few, many] = pixels(&session, [[239, 243, 255], [8, 81, 156]]);
    assert!(few > 20 && many > 300 && many < 560, "two small discs of the lower class, a large one: {few} {many}");
}

#[test]
fn areas_are_filled_by_their_texts_with_the_opacity_of_the_layer() {
    let folder = tempfile::tempdir().expect("folder");
    let properties = [r#"{"use": "wood"}"#, r#"{"use": "field"}"#, r#"{"use": "wood"}"#];
    let of = |alpha: &str| {
        let style = format!(
            r##"color = "#000000{alpha}", surface = "plain", outline = "none", color_by = {{ property = "use" }}"##
        );
        let session = open(folder.path(), "area", properties, &style).expect("scene");
        let picture = session.render(&PictureOptions::default()).expect("picture");
        let row = &picture.frame.color[75 * 200..76 * 200];
        // In the middle of the three squares.
        let at = |x: f64| row[(100.0 + x * 150.0 / (2.0 * 22.5f64.to_radians().tan() * 6000.0)) as usize];
        [at(-1500.0), at(0.0), at(1500.0)].map(|[r, _, b]| i32::from(r) - i32::from(b))
    };
    // The most frequent value is orange, the next one sky blue; the east lies in the shade of the ground.
    let [west, middle, east] = of("ff");
    assert!(west > 25 && east > 25 && middle < -25, "{west} {middle} {east}");
    let faint = of("20");
    assert!(faint[0] < west / 2 && faint[1] > middle / 2, "{faint:?} {west} {middle}");
}

#[test]
fn a_document_with_styles_by_property_is_read_as_it_was_written() {
    let folder = tempfile::tempdir().expect("folder");
    let properties = [r#"{"road": "main road"}"#, "{}", "{}"];
    let style = r##"color_by = { property = "road", values = { "main road" = "#ff000080" }, others = "#888888" }"##;
    let session = open(folder.path(), "line", properties, style).expect("scene");
    let document = session.resolved().expect("document");
    let text = belvedere::output::document_toml(document).expect("text");
    let again = belvedere::scene_file::parse(Path::new("again.toml"), &text).expect("it is read").document;
    assert_eq!(again.layer, document.layer);
    assert!(text.contains("main road"), "{text}");
}

#[test]
fn what_is_wrong_is_told_with_its_line_and_a_remedy() {
    let folder = tempfile::tempdir().expect("folder");
    let properties = [r#"{"highway": "main"}"#, "{}", "{}"];
    let cases = [
        (r#"color_by = { property = "higway" }"#, "did you mean \"highway\"?"),
        (r#"color_by = { property = "highway", classes = 4 }"#, "holds no number, the first value is \"main\""),
        (r#"color_by = { property = "highway", classes = 12 }"#, "it must be in 3..=7"),
        (r##"color_by = { property = "highway", scale = "blues", values = { main = "#ff0000" } }"##, "keep one kind"),
        (r#"color_by = { property = "highway", values = { main = "red" } }"#, "write #rrggbb"),
        (r#"width_by = { property = "highway" }"#, "choose another one"),
        (r#"width_by = { property = "highway", px = [0, 3] }"#, "must be greater than 0"),
        (r#"color_by = { propety = "highway" }"#, "property"),
    ];
    for (style, remedy) in cases {
        let said = open(folder.path(), "line", properties, style).expect_err(style).to_string();
        assert!(said.contains(remedy) && said.contains("scene.toml:16"), "{style}: {said}");
    }
    let styles = [
        ("line", "color_by.property = \"x\""),
        ("line", "label = \"name:de\""),
        ("point", "rank = \"population\""),
        ("point", "rank = \"stars\""),
    ];
    for (kind, style) in styles {
        let scene = format!("{SCENE}kind = \"{kind}\"\nsource = \"builtin:massif?seed=7\"\nstyle.{style}\n");
        std::fs::write(folder.path().join("scene.toml"), scene).expect("scene");
        let said = Session::open(&folder.path().join("scene.toml"), &OpenOptions::default()).expect_err(style);
        assert!(said.to_string().contains("has no properties; remove it"), "{said}");
    }
}

/// Six houses in two rows with a street between, seen straight down: their uses and the keys of the city's layer.
fn houses(folder: &Path, uses: [&str; 6], keys: &str) -> Result<Session, belvedere::BelvedereError> {
    let house = |(i, usage): (usize, &str)| {
        let [x, y] = [500_000.0 + 40.0 * (i / 2) as f64, 5_000_000.0 + 60.0 * (i % 2) as f64];
        let [far, north] = [x + 20.0, y + 20.0];
        format!(
            r#"{{"type": "Feature", "properties": {{"id": "h{i}", "height": {}, "building": "{usage}"}}, "geometry": {{"type": "Polygon",
            "coordinates": [[[{x}, {y}], [{far}, {y}], [{far}, {north}], [{x}, {north}], [{x}, {y}]]]}}}}"#,
            8 + i
        )
    };
    let street = r#"{"type": "Feature", "properties": {"highway": "primary"}, "geometry": {"type": "LineString",
        "coordinates": [[499900, 5000040], [500300, 5000040]]}}"#;
    let all: Vec<String> = uses.into_iter().enumerate().map(house).chain([street.to_owned()]).collect();
    let crs = r#""crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32632"}}"#;
    let text = format!(r#"{{"type": "FeatureCollection", {crs}, "features": [{}]}}"#, all.join(","));
    std::fs::write(folder.join("town.geojson"), text).expect("features");
    let scene = "format = 1\ncrs = \"EPSG:32632\"\n[camera]\neye = [500050, 5000039.9, 400]\nlook_at = [500050, 5000040, 0]\n\
        image = [200, 200]\n[[layer]]\nkind = \"city\"\nid = \"town\"\nsource = \"town.geojson\"\n";
    let path = folder.join("scene.toml");
    std::fs::write(&path, format!("{scene}{keys}\n")).expect("scene");
    Session::open(&path, &OpenOptions::default())
}

/// Pixels of a strong red and of a strong blue, as light may dim them.
fn red_and_blue(session: &Session) -> [usize; 2] {
    let picture = session.render(&PictureOptions::default()).expect("picture");
    let strong = |of: fn(&[u8; 3]) -> [u8; 2]| {
        let is = |pixel: &&[u8; 3]| of(pixel)[0] > 60 && u16::from(of(pixel)[0]) > 3 * u16::from(of(pixel)[1]);
        picture.frame.color.iter().filter(is).count()
    };
    [strong(|p| [p[0], p[2]]), strong(|p| [p[2], p[0]])]
}

#[test]
fn buildings_have_the_colour_of_their_use_and_blocks_that_of_most_of_their_volume() {
    let folder = tempfile::tempdir().expect("folder");
    let uses = ["shop", "house", "house", "house", "shop", "yes"];
    let by = r##"color_by = { property = "use", values = { shop = "#ff0000", house = "#0000ff" } }"##;
    let drawn = |keys: &str| red_and_blue(&houses(folder.path(), uses, keys).expect("a town"));
    assert_eq!(drawn(""), [0, 0], "roofs of one colour without it");
    let [red, blue] = drawn(&format!("style = {{ {by} }}"));
    assert!(
        red > 100 && (1.3..1.7).contains(&(blue as f64 / red as f64)),
        "two shops and three houses: {red} and {blue}"
    );
    // South of the street shop, house and shop: most is shop; north of it two houses and one of unknown use.
    let [red, blue] = drawn(&format!("loa = 1\nstyle = {{ {by} }}"));
    assert!(red > 300 && (0.6..1.6).contains(&(blue as f64 / red as f64)), "a block of each: {red} and {blue}");
    let style = r#"style = { color_by = { property = "colour of the door" } }"#;
    let refused = houses(folder.path(), uses, style).expect_err("no such property").to_string();
    assert!(refused.contains("no building has the property \"colour of the door\""), "{refused}");
    let style = r#"style = { color_by = { property = "height", classes = 99 } }"#;
    assert!(houses(folder.path(), uses, style).expect_err("99 classes").to_string().contains("classes is 99"));
}
