//! Volumes that a path preview runs through are drawn as their wall.

use belvedere::scene::{LayerKind, TransferFunction};
use belvedere::{BelvedereError, OpenOptions, PictureOptions, Session};
use std::path::Path;

const SCENE: &str = r#"
format = 1
crs = "local"
unit = "voxel"
[[layer]]
id = "tube"
kind = "volume"
source = "tube.nrrd"
[camera]
eye = [100.0, -60.0, 50.0]
look_at = [12.0, 12.0, 20.0]
image = [64, 36]
"#;
const PREVIEW: &str = r#"
[constructor]
kind = "path_preview"
path = "path.csv"
preview_m = 20.0
"#;

/// A tube along z in a folder: 25 in it, its wall of 150 from 5 voxels off the middle on, nothing around; and the path through it.
fn tube(folder: &Path, path: &str) {
    let value = |i: i32| {
        let [x, y] = [i % 24, i / 24 % 24].map(|v| f64::from(v) - 12.0);
        let off = x.hypot(y);
        let share = |beyond: f64| (0.5 + 0.5 * beyond).clamp(0.0, 1.0);
        (25.0 + 125.0 * share(off - 5.0)) * (1.0 - share(off - 9.0))
    };
    let values: String = (0..24 * 24 * 40).map(|i| format!("{:.0} ", value(i))).collect();
    let header = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 24 24 40\nencoding: ascii\n\n";
    std::fs::write(folder.join("tube.nrrd"), header.to_owned() + &values).unwrap();
    std::fs::write(folder.join("path.csv"), path).unwrap();
}

fn open(folder: &Path, text: &str) -> Result<Session, BelvedereError> {
    let file = folder.join("scene.toml");
    std::fs::write(&file, text).unwrap();
    Session::open(&file, &OpenOptions::default())
}

fn transfer(session: &Session) -> &TransferFunction {
    let LayerKind::Volume(volume) = &session.scene().layers[0].kind else { panic!("a volume") };
    &volume.transfer
}

fn with(transfer: &str) -> String {
    SCENE.replace("source =", &format!("transfer = \"{transfer}\"\nsource ="))
}

#[test]
fn previews_draw_the_wall_unless_another_function_is_named() {
    let folder = tempfile::tempdir().unwrap();
    tube(folder.path(), "x,y,z\n12,12,2\n12.5,12,15\n12,12,37\n");
    for text in [SCENE.to_owned(), with("auto"), with("wall")] {
        let session = open(folder.path(), &(text + PREVIEW)).unwrap();
        let f = transfer(&session);
        assert_eq!((f.name(), f.at(25.0)[3], f.at(75.0)[3], f.at(150.0)[3]), ("wall", 0.0, 0.0, 1.0));
        let sidecar = session.render(&PictureOptions::default()).unwrap().sidecar;
        let report = serde_json::to_value(&sidecar).unwrap();
        let wall = &report["constructor"]["walls"][0];
        let isovalue = wall["isovalue"].as_f64().unwrap();
        assert!(wall["layer"] == "tube" && (isovalue - 87.5).abs() < 8.0, "{wall}");
        assert_eq!(report["volumes"][0]["transfer"], "wall");
    }
    let named = open(folder.path(), &(with("solid") + PREVIEW)).unwrap();
    assert_eq!(transfer(&named).name(), "solid");
    assert_eq!(transfer(&open(folder.path(), SCENE).unwrap()).name(), "auto");
}

#[test]
fn walls_of_no_path_are_refused_and_paths_without_a_wall_are_said() {
    let folder = tempfile::tempdir().unwrap();
    // A path along an edge of the volume, where the volume is empty.
    tube(folder.path(), "x,y,z\n1,1,2\n1,1,20\n1,1.5,37\n");
    let error = open(folder.path(), &with("wall")).unwrap_err().to_string();
    assert!(error.contains("layer \"tube\"") && error.contains("path_preview"), "{error}");
    let session = open(folder.path(), &(SCENE.to_owned() + PREVIEW)).unwrap();
    let warnings = session.warnings();
    assert!(
        warnings.iter().any(|w| w.text().contains("no wall lies around the path") && w.text().contains("auto")),
        "{warnings:?}"
    );
    assert_eq!(transfer(&session).name(), "auto");
    let error = open(folder.path(), &(with("wall") + PREVIEW)).unwrap_err().to_string();
    assert!(error.contains("no wall lies around the path"), "{error}");
}
