//! GeoPackages as a user meets them.

use super::Place;
use belvedere_testkit::data;

#[test]
fn geopackages_are_read_by_every_verb() {
    let Some(path) = data("city_bubenec/bubenec.gpkg") else { return };
    let (root, path) = (path.parent().and_then(|p| p.to_str()).expect("folder"), path.to_str().expect("UTF-8"));
    let [buildings, streets] = ["buildings", "streets"].map(|table| format!("{path}?table={table}"));
    let place = Place::new();
    let scene = format!(
        "format = 1\n[[layer]]\nid = \"town\"\nkind = \"city\"\nsource = \"{buildings}\"\n[[layer]]\nid = \"ways\"\nkind = \"line\"\n\
         source = \"{streets}\"\n[[layer]]\nid = \"plots\"\nkind = \"area\"\nsource = \"{path}?table=plots\"\n\
         [camera]\neye = [457100, 5549600, 400]\nlook_at = [457180, 5550000, 0]\nimage = [160, 90]\n"
    );
    place.write("s.toml", &scene);
    let generalise = ["generalise", buildings.as_str(), &streets, "-o", "out"];
    let render = ["render", "s.toml", "-o", "a.png", "--allow-root", root];
    let said = place.ok(&["info", &buildings]);
    assert!(said.contains("areas: 144") && said.contains("EPSG:3857"), "{said}");
    let report = &place.json(&[&generalise[..], &["--json"]].concat());
    assert_eq!((report["buildings"].as_u64(), report["levels"][0]["blocks"].as_u64()), (Some(144), Some(8)));
    place.ok(&render);
    let sidecar: serde_json::Value = serde_json::from_slice(&super::read(&place.path("a.png.json"))).expect("JSON");
    let inputs: Vec<&str> =
        sidecar["inputs"].as_array().expect("inputs").iter().filter_map(|i| i["path"].as_str()).collect();
    assert!(
        inputs.iter().filter(|i| i.ends_with("bubenec.gpkg")).count() == 1 && !inputs.iter().any(|i| i.contains('?')),
        "{inputs:?}"
    );
    // Show writes the names as they were, and they are read again.
    place.ok(&["show", "s.toml", "-o", "t.toml", "--allow-root", root]);
    place.ok(&["render", "t.toml", "-o", "b.png", "--allow-root", root]);
    assert!(super::read(&place.path("a.png")).len().abs_diff(super::read(&place.path("b.png")).len()) < 200);
    assert!(
        place
            .fails(&["info", &format!("{path}?table=trams")])
            .contains("it has buildings, plots, streets, tessellation")
    );
}
