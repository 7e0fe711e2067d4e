//! Pictures, films, scenes and models of data without a scene file.

use super::light_and_tints::pixels;
use super::{Place, read};

const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
const ATOMS: &str = "\
ATOM      1  N   ALA A   1      11.104   6.134  -6.504  1.00  0.00           N
ATOM      2  CA  ALA A   1      11.639   6.071  -5.147  1.00  0.00           C
ATOM      3  C   ALA A   1      12.123   7.437  -4.670  1.00  0.00           C
END
";

fn hills(file: &str, west: f64, place: &Place) {
    let mut text =
        format!("ncols 40\nnrows 30\nxllcorner {west}\nyllcorner 5100000\ncellsize 30\nNODATA_value -9999\n");
    for row in 0..30 {
        let heights: Vec<String> = (0..40).map(|col| (500 + 7 * col + 90 * (row % 9)).to_string()).collect();
        text += &format!("{}\n", heights.join(" "));
    }
    place.write(file, &text);
}

/// What the pixels of a picture of 120 x 90 show: 0 is sky.
fn drawn(place: &Place, input: &str) -> Vec<u32> {
    place.ok(&["render", input, "-o", "x.png", "--size", "120x90", "--aux", "id", "--overwrite"]);
    let npy = read(&place.path("x.id.npy"));
    npy[npy.len() - 4 * 120 * 90..].as_chunks::<4>().0.iter().map(|b| u32::from_le_bytes(*b)).collect()
}

#[test]
fn models_are_shown_whole_and_ground_fills_the_picture_under_a_sky() {
    let place = Place::new();
    hills("hills.asc", 500_000.0, &place);
    std::fs::create_dir(place.path("tiles")).expect("folder");
    hills("tiles/a.asc", 500_000.0, &place);
    hills("tiles/b.asc", 501_200.0, &place);
    place.write("cube.obj", CUBE);
    place.write("atoms.pdb", ATOMS);
    for input in ["hills.asc", "tiles", "cube.obj", "atoms.pdb", "builtin:massif?seed=7&size=65", "builtin:dna"] {
        let seen = drawn(&place, input);
        let (inside, border): (Vec<usize>, Vec<usize>) =
            (0..seen.len()).partition(|i| (1..119).contains(&(i % 120)) && (1..89).contains(&(i / 120)));
        let shown = inside.iter().filter(|i| seen[**i] > 0).count();
        let is_ground = !["cube.obj", "atoms.pdb", "builtin:dna"].contains(&input);
        if is_ground {
            assert!(shown * 20 > 9 * seen.len(), "{input} fills {shown} pixels");
            let row = |y: usize| seen[120 * y..120 * (y + 1)].iter().filter(|id| **id > 0).count();
            assert!(row(0) == 0 && row(4) == 0 && row(60) > 60, "{input}: {} of row 60", row(60));
        } else {
            assert!(shown * 12 > seen.len(), "{input} fills {shown} pixels");
            assert!(border.iter().all(|i| seen[*i] == 0), "{input} is cut off");
        }
    }
}

#[test]
fn the_scene_of_data_is_written_and_draws_the_same_picture() {
    let place = Place::new();
    hills("hills.asc", 500_000.0, &place);
    let said = place.run(&["show", "hills.asc", "-o", "scene.toml"]).stderr;
    let said = String::from_utf8(said).expect("UTF-8");
    assert!(said.contains("the ground fills the picture"), "{said}");
    let scene = String::from_utf8(read(&place.path("scene.toml"))).expect("UTF-8");
    assert!(scene.contains("source = \"hills.asc\"") && scene.contains("title = \"hills\""), "{scene}");
    place.ok(&["show", "hills.asc", "-o", "scene.json"]);
    place.ok(&["render", "scene.toml", "-o", "scene.png"]);
    place.ok(&["render", "hills.asc", "-o", "usual.png"]);
    let drawn = |name: &str| pixels(&read(&place.path(name)));
    assert!(drawn("scene.png") == drawn("usual.png"), "the scene draws what the data drew");
    place.ok(&["export", "hills.asc", "-o", "hills.glb"]);
    place.ok(&["animate", "hills.asc", "-o", "frames", "--turntable", "--frames", "2", "--size", "64x48"]);
    assert_eq!(
        std::fs::read_dir(place.path("frames"))
            .expect("frames")
            .filter(|f| { f.as_ref().is_ok_and(|f| f.path().extension().is_some_and(|e| e == "png")) })
            .count(),
        2
    );
}

#[test]
fn a_file_that_holds_a_scene_is_one_whatever_its_name() {
    let place = Place::new();
    let layer = "[[layer]]\nid = 'ground'\nkind = 'terrain'\nsource = 'builtin:massif?seed=7&size=65'\n";
    let scene = format!("{}{layer}", super::BARE);
    // Endings of elevation models and of a mesh in text.
    for name in ["scene.toml", "scene", "scene.txt", "scene.grd", "scene.asc", "scene.obj"] {
        place.write(name, &scene);
        assert!(place.ok(&["show", name]).contains("eye = [0.0, 0.0, 0.0]"), "{name}");
    }
}

#[test]
fn a_town_in_degrees_is_as_wide_as_it_is_on_the_earth() {
    let place = Place::new();
    let corners = [(42.5, 1.5), (42.5, 1.501), (42.5005, 1.501), (42.5005, 1.5)];
    let nodes: String =
        (1..).zip(corners).map(|(id, (lat, lon))| format!("<node id='{id}' lat='{lat}' lon='{lon}'/>")).collect();
    let refs: String = [1, 2, 3, 4, 1].iter().map(|id| format!("<nd ref='{id}'/>")).collect();
    let way = format!("<way id='9'>{refs}<tag k='building' v='yes'/><tag k='height' v='12'/></way>");
    place.write("town.osm", &format!("<osm version='0.6'>{nodes}{way}</osm>"));
    let scene = place.ok(&["show", "town.osm"]);
    assert!(scene.contains("crs = \"EPSG:32631\""), "{scene}");
    // A house 82 m wide and 12 m high fills the picture: in degrees it would be a needle.
    assert!(drawn(&place, "town.osm").iter().filter(|id| **id > 0).count() > 120 * 90 / 4);
}

#[test]
fn several_files_are_drawn_together_whatever_their_order() {
    let place = Place::new();
    hills("west.asc", 500_000.0, &place);
    hills("east.asc", 501_200.0, &place);
    // Across both tiles, near their middle.
    place.write("way.geojson", r#"{"type":"LineString","coordinates":[[9.004,46.0552],[9.026,46.0555]]}"#);
    let drawn = |files: &[&str]| {
        let options = ["-o", "x.png", "--size", "120x90", "--source-crs", "EPSG:32632", "--overwrite"];
        place.ok(&[&["render"], files, &options].concat());
        pixels(&read(&place.path("x.png")))
    };
    let all = drawn(&["west.asc", "east.asc", "way.geojson"]);
    assert!(all == drawn(&["way.geojson", "east.asc", "west.asc"]), "another order");
    assert!(all != drawn(&["west.asc", "east.asc"]), "the way is drawn");
    assert!(drawn(&["west.asc", "east.asc"]) != drawn(&["west.asc"]), "both tiles are drawn");
}

#[test]
fn what_makes_no_picture_alone_is_an_error_that_helps() {
    let place = Place::new();
    place.write("way.geojson", r#"{"type":"LineString","coordinates":[[9,46],[9.01,46]]}"#);
    hills("hills.asc", 500_000.0, &place);
    std::fs::create_dir(place.path("empty")).expect("folder");
    let error = place.fails(&["render", "way.geojson", "-o", "x.png"]);
    assert!(error.contains("not a scene document") && error.contains("belvedere info way.geojson"), "{error}");
    let error = place.fails(&["render", "hills.asc", "way.geojson", "-o", "x.png"]);
    assert!(error.contains("way.geojson") && error.contains("--source-crs"), "{error}");
    place.write("way2.geojson", r#"{"type":"LineString","coordinates":[[9,46],[9.02,46]]}"#);
    let error = place.fails(&["render", "way.geojson", "way2.geojson", "-o", "x.png"]);
    assert!(
        error.contains("make no picture together") && error.contains("an elevation model together with"),
        "{error}"
    );
    let error = place.fails(&["check", "hills.asc"]);
    assert!(error.contains("belvedere show hills.asc -o hills.toml"), "{error}");
    let error = place.fails(&["render", "empty", "-o", "x.png"]);
    assert!(error.contains("without elevation models"), "{error}");
}

#[test]
fn what_data_alone_do_not_say_is_said_by_options_and_refused_where_it_says_nothing() {
    let place = Place::new();
    hills("hills.asc", 500_000.0, &place);
    let document = |args: &[&str]| place.ok(&[&["show", "hills.asc"], args].concat());
    let said = document(&["--source-crs", "EPSG:32632", "--nodata", "-1", "--vertical-unit", "ft", "--curved-earth"]);
    for key in ["source_crs = \"EPSG:32632\"", "nodata = -1.0", "vertical_unit = \"ft\"", "earth = \"curved\""] {
        assert!(said.contains(key), "{key}: {said}");
    }
    assert!(document(&["--crs", "local"]).contains("crs = \"local\""));
    place.ok(&["render", "hills.asc", "--vertical-unit", "ft", "-o", "feet.png"]);
    place.ok(&["render", "hills.asc", "-o", "metres.png"]);
    assert_ne!(read(&place.path("feet.png")), read(&place.path("metres.png")));
    place.write("s.toml", super::BARE);
    let refused = place.fails(&["render", "s.toml", "--nodata", "0", "--crs", "local", "-o", "s.png"]);
    assert!(refused.contains("--crs, --nodata are for data alone, and a scene file says it itself"), "{refused}");
    place.write("box.obj", CUBE);
    for (option, value, what) in [
        ("--nodata", "0", "for an elevation model, and this is none"),
        ("--source-crs", "EPSG:32632", "for elevation models and cities, and this is neither"),
    ] {
        let refused = place.fails(&["render", "box.obj", option, value, "-o", "box.png"]);
        assert!(refused.contains(&format!("{option} is {what}")), "{refused}");
    }
}
