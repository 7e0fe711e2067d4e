//! `figures` as a reader of the papers meets them.

use super::{Place, read};

/// A small area: every figure, little work.
fn area(name: &str, place: &Place) -> String {
    let text = "format = 1\ncrs = \"local\"\n\
        [camera]\neye = [-7000.0, -7000.0, 3000.0]\nlook_at = [1000.0, 1000.0, 900.0]\nfov_y_deg = 45.0\nimage = [1280, 720]\n\
        [[layer]]\nkind = \"terrain\"\nid = \"ground\"\nsource = \"builtin:massif?seed=3&size=65\"\n\
        [[layer]]\nkind = \"line\"\nid = \"trail\"\nsource = \"builtin:massif?seed=3&size=65\"\nmust_see = true\n\
        [[stage]]\nkind = \"terrain_disocclusion\"\nspacing = 1.0\ncandidates = 0.5\nsolver_nodes = 33\n";
    place.write(name, text);
    name.to_owned()
}

#[test]
#[ignore = "long; .ci/long runs it"]
fn pictures_tables_and_trends_of_an_area() {
    let place = Place::new();
    let scene = area("small.toml", &place);
    place.ok(&["figures", "terrain", &scene, "-o", "figures"]);
    let page = String::from_utf8(read(&place.path("figures/index.html"))).expect("UTF-8");
    let record: serde_json::Value = serde_json::from_slice(&read(&place.path("figures/figures.json"))).expect("JSON");
    let area = &record[0];
    let pictures = area["pictures"].as_array().expect("pictures");
    for what in ["pair", "steps", "profile", "w", "eta"] {
        let name = format!("small_{what}.png");
        assert!(pictures.iter().any(|p| p == name.as_str()) && page.contains(&name), "{name} is not shown");
        assert!(read(&place.path(&format!("figures/{name}"))).starts_with(b"\x89PNG"), "{name}");
    }
    let number = |v: &serde_json::Value| v.as_f64().unwrap_or_else(|| panic!("{v} is no number"));
    let [paper, both, qp] = [0, 1, 2].map(|i| &area["modes"][i]);
    // What the scene leaves open is each mode's own.
    for (mode, w, detail) in [(paper, 0.6, "scaled"), (both, 0.6, "scaled"), (qp, 0.3, "plain")] {
        assert_eq!((number(&mode["w"]), mode["parameters"]["detail"].as_str()), (w, Some(detail)), "{mode}");
    }
    assert!(number(&qp["visible_before"]) < 0.9, "the area hides something");
    assert!(number(&qp["visible"]) >= number(&paper["visible"]));
    assert!(
        number(&qp["rms_m"]) < number(&paper["rms_m"]),
        "the program moves less ground than the paper's two passes"
    );
    // Between the ends of the sweep, what is seen and how rough the ground is both rise.
    let over_w = area["w"].as_array().expect("w");
    let ends = [&over_w[0]["report"], &over_w[over_w.len() - 1]["report"]];
    for key in ["visible", "step_p999_m"] {
        assert!(number(&ends[0][key]) <= number(&ends[1][key]), "{key}");
    }
    assert_eq!(area["eta"].as_array().map(Vec::len), Some(5));
    let heights: Vec<f64> =
        area["eyes"].as_array().expect("eyes").iter().map(|e| number(&e["above_ground_m"])).collect();
    assert!([2.0, 30.0, 100.0].iter().all(|h| heights.contains(h)), "{heights:?}");
    // Times are those of the paper's grid, cells and unknowns.
    let timing = &area["timing"];
    assert_eq!(timing["own_nodes"], serde_json::json!([65, 65]));
    assert_eq!(timing["nodes"], serde_json::json!([1025, 1025]));
    assert_eq!(timing["unknowns"], 129 * 129);
    assert!((20.0..=651.0).contains(&number(&timing["cells"])), "so small an area has few summits: {timing}");
    assert!(number(&timing["cells_ms"]) > 0.0);
}

#[test]
#[ignore = "long; .ci/long runs it"]
fn figures_of_curved_rays_show_what_was_hidden() {
    let place = Place::new();
    place.ok(&["figures", "curved", "-o", "rays", "--scale", "0.5"]);
    let page = String::from_utf8(read(&place.path("rays/curved.html"))).expect("UTF-8");
    let record: serde_json::Value = serde_json::from_slice(&read(&place.path("rays/curved.json"))).expect("JSON");
    let figures = record.as_array().expect("figures");
    for figure in figures {
        let picture = figure["picture"].as_str().expect("picture");
        assert!(page.contains(picture) && read(&place.path("rays").join(picture)).starts_with(b"\x89PNG"), "{picture}");
    }
    let seen = |name: &str| -> Vec<f64> {
        let figure = figures.iter().find(|f| f["name"] == name).unwrap_or_else(|| panic!("no figure {name}"));
        figure["seen"].as_array().expect("seen").iter().map(|v| v.as_f64().expect("number")).collect()
    };
    let fact = |name: &str, key: &str| -> f64 {
        let figure = figures.iter().find(|f| f["name"] == name).unwrap_or_else(|| panic!("no figure {name}"));
        figure["facts"][key].as_f64().unwrap_or_else(|| panic!("{name} says nothing of {key}: {}", figure["facts"]))
    };
    // Straight rays show none of the vehicles, every bend its own.
    let street = seen("street");
    assert!(street.len() >= 5 && street[0] == 0.0 && street[1..].iter().all(|n| *n > 125.0), "{street:?}");
    // Rays end in the streets that they turn into, those of either half in theirs.
    for way in
        ["To the left", "To the right", "Forward, then to the right", "both: left", "both: right", "ahead", "aside"]
    {
        assert!(fact("street_rays", way) > 0.8, "{way}: {}", fact("street_rays", way));
    }
    assert_eq!(fact("together", "straight: car, pixels"), 0.0);
    assert!(fact("together", "together: car, pixels") > 125.0 && fact("together", "together: tram, pixels") > 250.0);
    // What is marked is seen whole, in its box.
    let helix = seen("helix");
    assert!(helix[0] < 0.05 && helix[1] > 0.95, "{helix:?}");
    assert!(fact("helix", "marked atoms in their box") > 0.999);
    // Curved rays bend a car less than rays with a kink.
    assert!(fact("car", "straight") < 1e-9 && fact("car", "curved") < 0.5 * fact("car", "kink"));
    assert!(seen("car").iter().all(|pixels| *pixels > 2500.0), "{:?}", seen("car"));
    assert_eq!(fact("between", "viewpoints between"), 7.0);
    // Modified rays run over original ones, and both are there to see.
    assert!(fact("models", "rays, most apart, m") < 0.01 * fact("models", "arcs, longest, m"));
    assert!(fact("models", "pixels of modified rays") > 250.0 && fact("models", "pixels of original rays") > 250.0);
    // The planes of a turn draw together on the way to it.
    let planes = seen("collapse_path");
    assert!(planes[0] > 0.0 && planes.windows(2).all(|w| w[0] >= w[1]) && planes[3] < 0.2 * planes[0], "{planes:?}");
    // Rays that parted are one again behind what they passed.
    let merge = seen("merge");
    // A pixel beside one that shows the target counts as seen, so straight rays show 6 %.
    assert!(merge[0] < 0.1 && merge[1] > 0.8, "{merge:?}");
    assert!(fact("merge", "seam: apart amid") > 20.0 && fact("merge", "seam: apart past the merge") < 1e-3);
    let table = figures.iter().find(|f| f["name"] == "table").expect("a table");
    assert_eq!(table["table"]["rows"].as_array().map(Vec::len), Some(5));
    assert!(page.contains("<td>canyon</td>"), "the page shows the table");
    // Further bends show more.
    for (name, times) in [("viewpoints", 2.0), ("preview", 2.0)] {
        let seen = seen(name);
        assert!(seen.windows(2).all(|w| w[0] < w[1]) && seen[seen.len() - 1] > times * seen[0], "{name}: {seen:?}");
    }
    // Nothing before the position is cut away.
    for name in ["preview", "turns"] {
        assert!(fact(name, "sky in the lower half") < 0.05, "{name}: {}", fact(name, "sky in the lower half"));
    }
    assert!(place.fails(&["figures", "curved", "-o", "rays"]).contains("curved_street.png"));
}

#[test]
fn every_means_shows_the_target_and_curved_rays_bend_edges_less_than_broken_ones() {
    let place = Place::new();
    place.ok(&["figures", "compare", "-o", "means", "--scale", "0.5"]);
    assert!(read(&place.path("means/compare.png")).starts_with(b"\x89PNG"));
    let rows: serde_json::Value = serde_json::from_slice(&read(&place.path("means/compare.json"))).expect("JSON");
    let rows = rows.as_array().expect("rows");
    let of = |key: &str| -> Vec<f64> { rows.iter().map(|r| r[key].as_f64().expect("number")).collect() };
    let (visible, bent) = (of("visible"), of("bent_edges"));
    assert_eq!(visible.len(), 6);
    assert!(visible[0] < 0.5 && visible[1..].iter().all(|v| *v > 0.95), "{visible:?}");
    assert!(bent[..4].iter().all(|b| *b < 1e-9) && bent[5] > 0.01 && bent[5] < 0.5 * bent[4], "{bent:?}");
}

#[test]
#[ignore = "long; .ci/long runs it"]
fn charts_of_the_documents_are_drawn() {
    let place = Place::new();
    place.ok(&["figures", "algorithms", "-o", "charts"]);
    let committed = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/images/algorithms");
    let names: Vec<_> = std::fs::read_dir(committed).expect("folder").map(|e| e.expect("entry").file_name()).collect();
    assert_eq!(names.len(), 6);
    for name in names {
        let bytes = read(&place.path("charts").join(&name));
        assert!(bytes.starts_with(b"\x89PNG") && (20_000..80_000).contains(&bytes.len()), "{name:?}: {}", bytes.len());
    }
    assert!(place.fails(&["figures", "algorithms", "-o", "charts"]).contains("curved-rays.png"));
}

#[test]
fn unknown_figures_and_scenes_of_one_name_are_refused() {
    let place = Place::new();
    assert!(place.fails(&["figures", "terrane", "-o", "figures"]).contains("terrain"));
    assert!(place.fails(&["figures", "curved", "-o", "figures", "--scale", "2"]).contains("0.1..=1"));
    std::fs::create_dir(place.path("other")).expect("folder");
    let (one, two) = (area("small.toml", &place), area("other/small.toml", &place));
    let error = place.fails(&["figures", "terrain", &one, &two, "-o", "figures"]);
    assert!(error.contains("small") && error.contains("rename"), "{error}");
    std::fs::create_dir_all(place.path("figures")).expect("folder");
    place.write("figures/small_eta.png", "mine");
    let error = place.fails(&["figures", "terrain", &one, "-o", "figures"]);
    assert!(error.contains("small_eta.png") && !place.path("figures/small_pair.png").exists(), "{error}");
}

#[test]
#[ignore = "long; .ci/long runs it"]
fn figures_of_multi_perspective_views_are_all_there() {
    let place = Place::new();
    place.ok(&["figures", "spline", "-o", "views", "--scale", "0.5"]);
    let page = String::from_utf8(read(&place.path("views/spline.html"))).expect("UTF-8");
    let record: serde_json::Value = serde_json::from_slice(&read(&place.path("views/spline.json"))).expect("JSON");
    let figures = record.as_array().expect("figures");
    for name in ["town", "canyon", "corners", "styles", "angles", "relief", "arc_length", "frames", "chain"] {
        let figure = figures.iter().find(|f| f["name"] == name).unwrap_or_else(|| panic!("no figure {name}"));
        let picture = figure["picture"].as_str().expect("picture");
        assert!(
            page.contains(picture) && read(&place.path("views").join(picture)).starts_with(b"\x89PNG"),
            "{picture}"
        );
        assert!(figure["panels"].as_array().is_some_and(|p| p.len() > 1), "{figure}");
    }
}

#[test]
fn the_pictures_of_the_guide_are_those_that_it_shows() {
    let place = Place::new();
    place.ok(&["figures", "guide", "-o", "guide"]);
    let guide = belvedere_testkit::workspace_root().join("docs/guide");
    let pages: String = ["curved-rays", "terrain", "spline"]
        .iter()
        .map(|page| String::from_utf8(read(&guide.join(format!("{page}.md")))).expect("UTF-8"))
        .collect();
    for what in ["curved_rays", "merge", "terrain", "spline"] {
        let name = format!("guide_{what}.png");
        assert!(pages.contains(&format!("images/{name}")), "{name} is shown nowhere");
        // Rounding may differ from machine to machine; another picture has another size.
        let [new, old] = [read(&place.path(&format!("guide/{name}"))), read(&guide.join("images").join(&name))];
        assert!(new.len().abs_diff(old.len()) * 50 < old.len(), "{name} is old: {} and {} bytes", new.len(), old.len());
    }
}
