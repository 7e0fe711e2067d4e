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
