//! Consent to files outside the folder of a scene.

use belvedere::trust::{Outside, outside};
use belvedere::{OpenOptions, Session, Trust};
use std::path::{Path, PathBuf};

const SCENE: &str = "format = 1\n[camera]\neye = [0, 0, 9]\nlook_at = [0, 1, 0]\n";

/// A folder with a scene in `scenes` that names files in `data`.
fn place(names: &[&str]) -> (tempfile::TempDir, PathBuf, PathBuf) {
    let dir = tempfile::tempdir().expect("folder");
    let root = dir.path().canonicalize().expect("folder");
    ["scenes", "data"].iter().for_each(|name| std::fs::create_dir(root.join(name)).expect("folder"));
    let scene = root.join("scenes/s.toml");
    write_scene(&scene, names);
    ["a.obj", "b.obj"].iter().for_each(|name| {
        std::fs::write(root.join("data").join(name), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("file")
    });
    (dir, root, scene)
}

fn write_scene(scene: &Path, names: &[&str]) {
    let layer = |(i, name): (usize, &&str)| format!("[[layer]]\nid = 'm{i}'\nkind = 'mesh'\nsource = '{name}'\n");
    let layers: String = names.iter().enumerate().map(layer).collect();
    std::fs::write(scene, SCENE.to_owned() + &layers).expect("scene");
}

/// Why a scene does not open; empty if it does.
fn refused(scene: &Path, trust: &Trust) -> String {
    let options = OpenOptions { trust: trust.clone(), ..Default::default() };
    Session::open(scene, &options).err().map_or_else(String::new, |e| e.to_string())
}

#[test]
fn consent_is_for_one_scene_and_the_files_that_it_named() {
    let (_dir, root, scene) = place(&["../data/a.obj"]);
    let trust = Trust::in_file(root.join("settings/trusted.json"));
    let found = outside(&scene, &[]).expect("scene");
    assert_eq!(found, Outside { files: vec![root.join("data/a.obj")], missing: vec![] });
    assert!(refused(&scene, &trust).contains("leaves the folder"));
    assert!(trust.remember(&scene, &found.files).expect("written"));
    assert_eq!(refused(&scene, &trust), "");
    write_scene(&scene, &["../data/a.obj", "../data/b.obj"]);
    assert!(refused(&scene, &trust).contains("\"../data/b.obj\" leaves the folder"), "{}", refused(&scene, &trust));
    let moved = root.join("data/moved.toml");
    write_scene(&moved, &["../data/a.obj"]);
    std::fs::create_dir(root.join("other")).expect("folder");
    std::fs::rename(&moved, root.join("other/s.toml")).expect("moved");
    assert!(refused(&root.join("other/s.toml"), &trust).contains("leaves the folder"));
    assert_eq!(trust.forget(Some(&scene)).expect("written"), 1);
    assert!(trust.list().is_empty() && trust.files_of(&scene).is_empty());
    assert!(!Trust::default().remember(&scene, &found.files).expect("nothing is written"));
}

#[cfg(unix)]
#[test]
fn a_link_that_leads_elsewhere_since_has_no_consent() {
    let (_dir, root, scene) = place(&["../data/link.obj"]);
    let link = root.join("data/link.obj");
    std::os::unix::fs::symlink(root.join("data/a.obj"), &link).expect("link");
    let trust = Trust::in_file(root.join("trusted.json"));
    trust.remember(&scene, &outside(&scene, &[]).expect("scene").files).expect("written");
    assert_eq!(refused(&scene, &trust), "");
    std::fs::remove_file(&link).expect("removed");
    std::os::unix::fs::symlink(root.join("data/b.obj"), &link).expect("link");
    assert!(refused(&scene, &trust).contains("leaves the folder"), "{}", refused(&scene, &trust));
}

#[cfg(unix)]
#[test]
fn the_record_is_private_and_worth_nothing_if_others_may_write_it() {
    use std::os::unix::fs::PermissionsExt;
    let (_dir, root, scene) = place(&["../data/a.obj"]);
    let path = root.join("settings/trusted.json");
    let trust = Trust::in_file(path.clone());
    trust.remember(&scene, &[root.join("data/a.obj")]).expect("written");
    let mode = |path: &Path| std::fs::metadata(path).expect("file").permissions().mode() & 0o777;
    assert_eq!((mode(&path), mode(&root.join("settings"))), (0o600, 0o700));
    std::fs::set_permissions(&path, PermissionsExt::from_mode(0o666)).expect("mode");
    assert!(trust.list().is_empty());
    trust.remember(&scene, &[root.join("data/a.obj")]).expect("written");
    assert_eq!((mode(&path), trust.list().len()), (0o600, 1));
    // Only the superuser can give a file away.
    match std::os::unix::fs::chown(&path, Some(12_345), None) {
        Ok(()) => assert!(trust.list().is_empty(), "the record is another user's"),
        Err(e) => assert_eq!(e.kind(), std::io::ErrorKind::PermissionDenied),
    }
}

#[test]
fn a_damaged_record_is_an_empty_one() {
    let (_dir, root, scene) = place(&["../data/a.obj"]);
    let path = root.join("trusted.json");
    let trust = Trust::in_file(path.clone());
    trust.remember(&scene, &[root.join("data/a.obj")]).expect("written");
    let good = std::fs::read(&path).expect("record");
    let huge = vec![b' '; (1 << 20) + 1];
    for bad in [&good[..good.len() / 2], b"", b"[]", b"{\"format\":2,\"scenes\":[]}", b"\xff\xfe", &huge] {
        std::fs::write(&path, bad).expect("damaged");
        assert!(trust.list().is_empty());
        trust.remember(&scene, &[root.join("data/a.obj")]).expect("written anew");
        assert_eq!(trust.list().len(), 1);
    }
}

#[test]
fn the_oldest_entries_make_room() {
    let (_dir, root, scene) = place(&[]);
    let trust = Trust::in_file(root.join("trusted.json"));
    let many = |n: usize| (0..n).map(|i| root.join(format!("data/{i:0>200}.tif"))).collect::<Vec<_>>();
    for i in 0..3 {
        let other = root.join(format!("scenes/{i}.toml"));
        std::fs::copy(&scene, &other).expect("scene");
        trust.remember(&other, &many(2000)).expect("written");
    }
    let kept: Vec<PathBuf> = trust.list().into_iter().map(|entry| entry.scene).collect();
    assert_eq!(kept, [root.join("scenes/1.toml"), root.join("scenes/2.toml")]);
    let refused = trust.remember(&scene, &many(10_000)).expect_err("too many").to_string();
    assert!(refused.contains("10000 files"), "{refused}");
    assert_eq!(trust.list().len(), 2, "what was there stays");
}

#[test]
fn programs_that_remember_at_the_same_time_lose_nothing() {
    let (_dir, root, scene) = place(&[]);
    let path = root.join("trusted.json");
    std::thread::scope(|threads| {
        for i in 0..8 {
            let (path, scene, root) = (&path, &scene, &root);
            threads.spawn(move || {
                let other = root.join(format!("scenes/{i}.toml"));
                std::fs::copy(scene, &other).expect("scene");
                Trust::in_file(path.clone()).remember(&other, &[root.join("data/a.obj")]).expect("written");
            });
        }
    });
    assert_eq!(Trust::in_file(path).list().len(), 8);
}
