//! Links that a user made: a file given by name may be one, and so may those beside it if they lead to where it lies.
#![cfg(unix)]

use belvedere_io::load_vectors;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

/// A shapefile of one point.
fn shape() -> Vec<u8> {
    let header = |bytes: u32| {
        let mut out = [9994u32, 0, 0, 0, 0, 0, bytes / 2].map(u32::to_be_bytes).concat();
        out.extend([1000u32, 1].map(u32::to_le_bytes).concat());
        out.resize(100, 0);
        out
    };
    let mut out = header(128);
    out.extend([1u32, 10].map(u32::to_be_bytes).concat());
    out.extend(1u32.to_le_bytes());
    out.extend([8.0f64, 46.0].map(f64::to_le_bytes).concat());
    out
}

/// Puts a file into `store` and a link to it, of another name, into `folder`.
fn linked(folder: &Path, name: &str, store: &Path, content: &[u8]) -> PathBuf {
    fs::create_dir_all(store).expect("folder");
    let kept = store.join(format!("kept-{}", name.replace('.', "-")));
    fs::write(&kept, content).expect("written");
    let link = folder.join(name);
    let _ = fs::remove_file(&link);
    symlink(&kept, &link).expect("link");
    link
}

#[test]
fn neighbours_of_a_link_may_lead_to_where_it_leads_and_no_further() {
    const PRJ: &[u8] = br#"GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]]"#;
    let root = tempfile::tempdir().expect("folder");
    let at = |name: &str| root.path().join(name);
    let work = at("work");
    fs::create_dir(&work).expect("folder");
    for (main, beside, is_read) in [
        ("data", "data", true),
        ("data", "data/more", true),
        (".dvc/cache/files/md5/ab", ".dvc/cache/files/md5/cd", true),
        (".git/annex/objects/a/b", ".git/annex/objects/c/d", true),
        ("data", "elsewhere", false),
        ("data/more", "data", false),
        ("data/ab", "data/cd", false),
        (".dvc/cache/files/md5/ab", "other/.dvc/cache/files/md5/cd", false),
    ] {
        let path = linked(&work, "p.shp", &at(main), &shape());
        linked(&work, "p.prj", &at(beside), PRJ);
        let loaded = load_vectors(&path);
        let told = loaded.as_ref().map_or_else(|e| e.to_string(), |l| format!("{:?}", l.warnings));
        assert_eq!(loaded.is_ok(), is_read, "{main}, {beside}: {told}");
        assert!(is_read || told.contains("a link that leads out of its folder"), "{told}");
        assert!(!is_read || !told.contains("no .prj"), "{told}");
    }
    // The file itself is none, so that what lies beside it must lie there.
    fs::remove_file(work.join("p.shp")).expect("removed");
    fs::write(work.join("p.shp"), shape()).expect("written");
    linked(&work, "p.prj", &at("data"), PRJ);
    assert!(load_vectors(&work.join("p.shp")).is_err());
}
