//! Output files are written whole or not at all.

use belvedere_io::IoError;
use belvedere_io::atomic::{check_output, write_atomic};
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A temporary folder, removed at the end.
pub(crate) struct Folder(pub(crate) PathBuf);

impl Folder {
    pub(crate) fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("belvedere-io-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(&self.0).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn text(path: &Path, overwrite: bool, content: &str) -> Result<(), IoError> {
    write_atomic(path, overwrite, |out| out.write_all(content.as_bytes()))
}

#[test]
fn writes_new_files_and_replaces_only_when_told() {
    let folder = Folder::new("atomic-replace");
    let path = folder.0.join("out.png");
    text(&path, false, "one").unwrap();
    let error = text(&path, false, "two").unwrap_err();
    assert!(matches!(error, IoError::Exists { .. }));
    assert!(error.to_string().contains("out.png: exists already and may not be replaced"), "{error}");
    assert_eq!(fs::read_to_string(&path).unwrap(), "one");
    text(&path, true, "three").unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "three");
    assert_eq!(folder.names(), ["out.png"]);
}

#[test]
fn a_failed_write_leaves_nothing_and_keeps_the_old_file() {
    let folder = Folder::new("atomic-fail");
    let path = folder.0.join("out.bin");
    let fail = |out: &mut dyn Write| -> io::Result<()> {
        out.write_all(&[7; 300_000])?;
        Err(io::Error::other("the sky fell"))
    };
    let error = write_atomic(&path, false, fail).unwrap_err();
    assert!(error.to_string().contains("the sky fell"), "{error}");
    assert!(folder.names().is_empty(), "{:?}", folder.names());
    text(&path, false, "old").unwrap();
    write_atomic(&path, true, fail).unwrap_err();
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(folder.names(), ["out.bin"]);
    let panicked = std::panic::catch_unwind(|| write_atomic(&path, true, |_| panic!("no")));
    assert!(panicked.is_err());
    assert_eq!(folder.names(), ["out.bin"]);
}

#[test]
fn a_file_that_appears_during_the_work_is_not_lost() {
    let folder = Folder::new("atomic-race");
    let path = folder.0.join("out.txt");
    let error = write_atomic(&path, false, |out| {
        fs::write(&path, "somebody else's")?;
        out.write_all(b"ours")
    });
    assert!(matches!(error, Err(IoError::Exists { .. })));
    assert_eq!(fs::read_to_string(&path).unwrap(), "somebody else's");
    assert_eq!(folder.names(), ["out.txt"]);
}

#[test]
fn outputs_that_cannot_be_are_refused_before_the_work() {
    let folder = Folder::new("atomic-refuse");
    let file = folder.0.join("file");
    fs::write(&file, "x").unwrap();
    for (path, words) in [
        (folder.0.clone(), "is a folder"),
        (folder.0.join("nowhere/out.png"), "does not exist"),
        (file.join("out.png"), "file"),
        (PathBuf::from(".."), "file name"),
        (PathBuf::new(), "file name"),
    ] {
        let error = check_output(&path, true).unwrap_err().to_string();
        assert!(error.contains(words), "{}: {error}", path.display());
        write_atomic(&path, true, |_| unreachable!("the work must not start")).unwrap_err();
    }
    assert!(check_output(&folder.0.join("new"), false).is_ok());
    assert!(matches!(check_output(&file, false), Err(IoError::Exists { .. })));
    assert!(check_output(&file, true).is_ok());
}

#[cfg(unix)]
#[test]
fn outputs_have_the_permissions_of_any_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new("atomic-mode");
    let mode = |name: &str| fs::metadata(folder.0.join(name)).unwrap().permissions().mode();
    fs::write(folder.0.join("plain"), "x").unwrap();
    text(&folder.0.join("ours"), false, "x").unwrap();
    assert_eq!(mode("ours"), mode("plain"));
}

#[cfg(unix)]
#[test]
fn links_are_followed_and_devices_written_directly() {
    let folder = Folder::new("atomic-links");
    let (real, link) = (folder.0.join("real"), folder.0.join("link"));
    fs::write(&real, "old").unwrap();
    std::os::unix::fs::symlink(&real, &link).unwrap();
    assert!(matches!(text(&link, false, "new"), Err(IoError::Exists { .. })));
    text(&link, true, "new").unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read_to_string(&real).unwrap(), "new");
    text(Path::new("/dev/null"), false, "nothing").unwrap();
    assert!(!fs::symlink_metadata("/dev/null").unwrap().is_file());
}
