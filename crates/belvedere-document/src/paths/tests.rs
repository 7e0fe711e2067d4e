use super::*;

#[test]
fn names_that_leave_the_folder_are_refused() {
    let roots = Roots { scene_dir: env!("CARGO_MANIFEST_DIR").into(), ..Roots::default() };
    for name in ["../belvedere-core/Cargo.toml", "src/../../x", "/etc/passwd", "C:\\x", "\\\\host\\x", "..\\x"] {
        let refused = roots.resolve(name).expect_err(name);
        assert!(matches!(refused, DocumentError::Path { root_missing: true, .. }), "{name}: {refused}");
    }
    assert!(roots.resolve("Cargo.toml").is_ok());
    assert!(roots.resolve("src/lib.rs").is_ok());
}

#[test]
fn an_allowed_file_is_that_file_alone() {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).canonicalize().expect("folder");
    let roots = Roots { scene_dir: dir.join("src"), files: vec![dir.join("Cargo.toml")], ..Roots::default() };
    assert_eq!(roots.resolve("../Cargo.toml").ok(), Some(dir.join("Cargo.toml")));
    assert_eq!(roots.resolve("Cargo.toml").ok(), Some(dir.join("Cargo.toml")), "as found in a folder that was allowed");
    assert!(roots.resolve("../tests/it/main.rs").is_err());
    assert!(roots.resolve("../tests").is_err() && roots.resolve("../no-such-file").is_err());
    assert!(roots.resolve(dir.join("Cargo.toml").to_str().expect("UTF-8")).is_ok());
}

#[test]
fn names_are_relative_upwards_too() {
    let seen = |from: &str, to: &str| relative(Path::new(from), Path::new(to));
    assert_eq!(seen("/a/b", "/a/b/c/d.tif").as_deref(), Some("c/d.tif"));
    assert_eq!(seen("/a/b", "/a/data/d.tif").as_deref(), Some("../data/d.tif"));
    assert_eq!(seen("/a/b", "/x/d.tif").as_deref(), Some("../../x/d.tif"));
    assert_eq!(seen("/a", "/a/x:y.tif").as_deref(), Some("./x:y.tif"));
    assert_eq!((seen("/a", "/a"), seen("/a", "x/d.tif")), (None, None));
}

#[test]
#[cfg(windows)]
fn files_of_another_drive_have_no_relative_name() {
    assert_eq!(relative(Path::new(r"C:\a"), Path::new(r"D:\x.tif")), None);
    assert_eq!(relative(Path::new(r"C:\a\b"), Path::new(r"C:\a\x.tif")).as_deref(), Some("../x.tif"));
}

#[test]
fn addresses_and_devices_are_always_refused() {
    let roots = Roots { scene_dir: env!("CARGO_MANIFEST_DIR").into(), allowed: vec!["/".into()], files: vec![] };
    for name in [
        "file:///etc/passwd",
        "http://x/y.tif",
        "HTTPS://x",
        "s3:x",
        "array:x",
        "CON",
        "a/nul.tif",
        "com1.txt",
        "",
        "a\0b",
        "src",
    ] {
        assert!(roots.resolve(name).is_err(), "{name:?} was accepted");
    }
    assert!(roots.resolve("/dev/zero").is_err());
}

#[test]
fn an_allowed_root_is_searched_and_enough() {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR"));
    let roots = Roots { scene_dir: dir.join("src"), allowed: vec![dir.to_owned()], files: vec![] };
    assert_eq!(roots.resolve("Cargo.toml").ok(), dir.join("Cargo.toml").canonicalize().ok());
    assert!(roots.resolve("../Cargo.toml").is_ok());
    assert!(roots.resolve("../../belvedere-core/Cargo.toml").is_err());
}
