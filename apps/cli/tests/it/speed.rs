//! Level of detail, and the measurement of this machine.

use super::Place;

#[test]
fn less_detail_is_an_option_of_render() {
    let place = Place::new();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/massif.toml");
    let drawn = |lod: &str| {
        let out = format!("p{lod}.png");
        place.ok(&["render", scene, "-o", &out, "--size", "160x90", "--samples", "1", "--lod", lod]);
        let text = super::read(&place.path(&format!("{out}.json")));
        let record: serde_json::Value = serde_json::from_slice(&text).expect("JSON");
        record["stats"]["triangles_drawn"].as_u64().expect("a number")
    };
    assert!(drawn("8") < drawn("0"));
    assert!(place.fails(&["render", scene, "-o", "x.png", "--lod", "-1"]).contains("0..=64"));
}

#[test]
fn bench_reports_as_a_table_and_as_json() {
    let place = Place::new();
    let args = ["bench", "--rounds", "1", "--nodes", "65", "--size", "64x36"];
    let table = place.ok(&args);
    assert!(table.contains("curved rays") && table.contains("growth with pixels"), "{table}");
    let report = place.json(&[&args[..], &["--json"]].concat());
    assert_eq!(report["frames"].as_array().map(Vec::len), Some(12));
    assert!(report["projection"][1]["mpts_per_core_s"].as_f64().is_some_and(|v| v > 0.0));
    // The paper's way to solve the smooth pass, without and with elevation rows, gives the same ground as ours.
    assert!(table.contains("by sparse Cholesky factor"), "{table}");
    for cost in report["smooth"].as_array().expect("a list") {
        let of = |key: &str| cost["sparse"][key].as_f64().expect("a number");
        assert!(of("factor_ms") > 0.0 && of("solve_ms") > 0.0 && of("entries") > 65.0 * 65.0, "{cost}");
        assert!(of("differs_m") <= 1e-8 * of("largest_m") && of("largest_m") > 10.0, "{cost}");
    }
    assert_eq!(report["smooth"].as_array().map(Vec::len), Some(2));
    assert!(place.fails(&["bench", "--nodes", "1"]).contains("33..=8193"));
}

#[test]
fn the_collection_is_measured_and_compared_with_an_earlier_report() {
    let Some(molecules) = belvedere_testkit::data("molecules") else { return };
    let place = Place::new();
    let data = molecules.parent().expect("a folder").display().to_string();
    let args = ["bench", "--collection", &data, "--only", "559 atoms", "--rounds", "1", "--size", "64x36"];
    let table = place.ok(&[&args[..], &["-o", "now.json"]].concat());
    assert!(table.contains("| molecule, 559 atoms |") && !table.contains("slower"), "{table}");
    let mut report: serde_json::Value = serde_json::from_slice(&super::read(&place.path("now.json"))).expect("JSON");
    let cost = &mut report["scenes"][0];
    assert!(["straight_ms", "bent_ms", "moving_ms"].iter().all(|key| cost[key].as_f64().is_some_and(|ms| ms > 0.0)));
    cost["bent_to_straight"] = 1e-3.into();
    std::fs::write(place.path("then.json"), report.to_string()).expect("file");
    let compared = [&args[..], &["--against", "then.json", "--strict"]].concat();
    let out = place.run(&compared);
    assert_eq!(out.status.code(), Some(1), "{}", String::from_utf8_lossy(&out.stderr));
    let table = String::from_utf8(out.stdout).expect("UTF-8");
    assert!(table.contains("slower: molecule, 559 atoms: bent to straight"), "{table}");
    assert!(place.fails(&["bench", "--collection", &data, "--only", "moon"]).contains("andorra, GR 11, bent"));
}
