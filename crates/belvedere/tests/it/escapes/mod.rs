//! Whatever a file names, nothing outside the folder of the scene is read.
//!
//! Every place in which a file can name another one is crossed with every way out that a name can be. A file outside holds what would be read
//! with pleasure; its time of access tells whether it was.
#![cfg(unix)]

mod carriers;

use belvedere::scene::Progress;
use belvedere::verbs::pack::{PackRequest, pack};
use belvedere::{OpenOptions, Session};
use carriers::{CARRIERS, Carrier, SIDECARS};
use std::fs::{self, File, FileTimes};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant, SystemTime};

/// Time for one scene.
const SOON: Duration = Duration::from_secs(60);

/// `inside/` with the scene, and beside it `outside/` with the file that must not be read.
struct Folders {
    _root: tempfile::TempDir,
    inside: PathBuf,
    canary: PathBuf,
}

impl Folders {
    fn new(carrier: &Carrier) -> Self {
        let root = tempfile::tempdir().expect("folder");
        let [inside, outside] = ["inside", "outside"].map(|name| root.path().join(name));
        [&inside, &outside].into_iter().for_each(|folder| fs::create_dir(folder).expect("folder"));
        let canary = outside.join(format!("canary.{}", carrier.ending));
        fs::write(&canary, (carrier.content)()).expect("written");
        Self { _root: root, inside, canary }
    }

    /// Opens the scene of a carrier that names `name`. Returns everything that is told of it.
    fn opened(&self, carrier: &Carrier, name: &str) -> String {
        for (file, content) in (carrier.files)(name) {
            fs::write(self.inside.join(file), content).expect("written");
        }
        opened(&self.inside, &(carrier.scene)(name))
    }
}

fn opened(folder: &Path, scene: &str) -> String {
    let path = folder.join("scene.toml");
    fs::write(&path, format!("format = 1\ncrs = \"local\"\n{scene}\n{}", carriers::CAMERA)).expect("written");
    let began = Instant::now();
    let told = match Session::open(&path, &OpenOptions::default()) {
        Ok(session) => format!("{:?} {:?}", session.warnings(), session.input_paths()),
        Err(e) => e.to_string(),
    };
    assert!(began.elapsed() < SOON, "{scene}: {:?}", began.elapsed());
    told
}

/// Sets the time of access back, so that the next reading changes it.
fn forget_reading(path: &Path) {
    let (long_ago, now) = (SystemTime::UNIX_EPOCH + Duration::from_secs(1_000_000_000), SystemTime::now());
    let file = File::options().write(true).open(path).expect("opened");
    file.set_times(FileTimes::new().set_accessed(long_ago).set_modified(now)).expect("times are set");
}

fn was_read(path: &Path) -> bool {
    let accessed = fs::metadata(path).and_then(|m| m.accessed()).expect("time of access");
    accessed > SystemTime::UNIX_EPOCH + Duration::from_secs(1_500_000_000)
}

/// Whether this file system tells of readings.
fn tells(folder: &Path) -> bool {
    let probe = folder.join("probe");
    fs::write(&probe, "x").expect("written");
    forget_reading(&probe);
    fs::read(&probe).expect("read");
    let tells = was_read(&probe);
    fs::remove_file(probe).expect("removed");
    tells
}

/// Ways out of the folder, and things that are no regular files.
fn ways_out(folders: &Folders, ending: &str) -> Vec<String> {
    let (inside, canary) = (&folders.inside, &folders.canary);
    let file = canary.file_name().and_then(|name| name.to_str()).expect("name");
    let at = |name: &str| inside.join(format!("{name}.{ending}"));
    fs::create_dir_all(inside.join("sub")).expect("folder");
    fs::create_dir_all(at("folder")).expect("folder");
    symlink(canary, at("link")).expect("link");
    symlink("link-2", at("link-1")).expect("link");
    symlink(format!("../outside/{file}"), inside.join("link-2")).expect("link");
    symlink(canary.parent().expect("folder"), inside.join("elsewhere")).expect("link");
    symlink("..", inside.join("sub/up")).expect("link");
    symlink("/dev/zero", at("endless")).expect("link");
    symlink(at("round"), at("round")).expect("link");
    assert!(Command::new("mkfifo").arg(at("pipe")).status().expect("mkfifo").success());
    let socket = std::os::unix::net::UnixListener::bind(at("socket"));
    drop(socket);
    let whole = canary.display();
    let hexed: String = format!("../outside/{file}").bytes().map(|b| format!("%{b:02x}")).collect();
    vec![
        whole.to_string(),
        format!("../outside/{file}"),
        format!("sub/../../outside/{file}"),
        format!("./.././outside/{file}"),
        format!("sub/up/../outside/{file}"),
        format!("sub/up/up/outside/{file}"),
        format!("elsewhere/{file}"),
        format!("elsewhere/../outside/{file}"),
        format!("link.{ending}"),
        format!("link-1.{ending}"),
        format!("LINK.{ending}"),
        format!("file://{whole}"),
        format!("file:../outside/{file}"),
        format!("file://localhost{whole}"),
        format!("..%2foutside%2f{file}"),
        format!("%2e%2e/outside/{file}"),
        format!("elsewhere%2f{file}"),
        hexed,
        format!("..%252foutside%252f{file}"),
        format!("..\\outside\\{file}"),
        format!("\\\\localhost{whole}"),
        format!("//localhost{whole}"),
        format!("http://localhost{whole}"),
        format!("~/{file}"),
        format!("$PWD/../outside/{file}"),
        format!("../outside/{file}\0.{ending}"),
        format!("x\n../outside/{file}"),
        format!("\"../outside/{file}\""),
        format!(" ../outside/{file} "),
        format!("zip.zip/../../outside/{file}"),
        format!("{}.{ending}", "n".repeat(5000)),
        format!("{}x.{ending}", "d/".repeat(3000)),
        format!("endless.{ending}"),
        format!("round.{ending}"),
        format!("pipe.{ending}"),
        format!("socket.{ending}"),
        format!("folder.{ending}"),
        "/dev/zero".into(),
        "/dev/stdin".into(),
        "/proc/self/environ".into(),
        "/proc/self/fd/0".into(),
        "data:,canary".into(),
        "data:application/octet-stream;base64,!!!!".into(),
        ".".into(),
        "..".into(),
        String::new(),
    ]
}

#[test]
fn no_name_leads_out_of_the_folder_of_the_scene() {
    let mut count = 0;
    for (number, carrier) in CARRIERS.iter().enumerate() {
        let folders = Folders::new(carrier);
        let tells = tells(&folders.inside);
        // The place is one from which files are read.
        let own = format!("own.{}", carrier.ending);
        let there = folders.inside.join(&own);
        fs::write(&there, (carrier.content)()).expect("written");
        forget_reading(&there);
        let told = folders.opened(carrier, &own);
        assert!(was_read(&there) || !tells, "{} reads nothing: {told}", carrier.name);
        // Scenes that are made take long; others meet every way out.
        let step = if (carrier.scene)("").contains("builtin:") { 4 } else { 1 };
        for name in ways_out(&folders, carrier.ending).into_iter().skip(number % step).step_by(step) {
            forget_reading(&folders.canary);
            let told = folders.opened(carrier, &name);
            assert!(!was_read(&folders.canary), "{} read {name:?}: {told}", carrier.name);
            assert!(!told.contains("CANARY"), "{} tells what {name:?} holds: {told}", carrier.name);
            count += 1;
        }
    }
    assert!(count >= 700, "{count}");
}

#[test]
fn files_beside_files_are_no_links_out_of_the_folder() {
    for carrier in SIDECARS {
        let folders = Folders::new(carrier);
        let tells = tells(&folders.inside);
        let there = folders.inside.join(carrier.name);
        fs::write(&there, (carrier.content)()).expect("written");
        forget_reading(&there);
        let told = folders.opened(carrier, "");
        assert!(was_read(&there) || !tells, "{} is not read: {told}", carrier.name);
        for what in ["link", "/dev/zero", "pipe", "folder", "/proc/self/environ"] {
            let _ = fs::remove_file(&there);
            match what {
                "link" => symlink(&folders.canary, &there).expect("link"),
                "pipe" => assert!(Command::new("mkfifo").arg(&there).status().expect("mkfifo").success()),
                "folder" => fs::create_dir(&there).expect("folder"),
                device => symlink(device, &there).expect("link"),
            }
            forget_reading(&folders.canary);
            let told = folders.opened(carrier, "");
            assert!(!was_read(&folders.canary) && !told.contains("CANARY"), "{}: {told}", carrier.name);
            let refused = what != "link" || told.contains("a link that leads out of its folder");
            assert!(refused, "{} as a link is passed over in silence: {told}", carrier.name);
            if what == "folder" {
                fs::remove_dir(&there).expect("removed");
            }
        }
    }
}

/// A store of hashes below the folder of the scene, as of git-annex: links lead into it, and no further.
#[test]
fn links_into_a_store_of_the_scene_are_followed_and_others_are_not() {
    for carrier in SIDECARS {
        let folders = Folders::new(carrier);
        let tells = tells(&folders.inside);
        folders.opened(carrier, "");
        let store = folders.inside.join(".git/annex/objects");
        let into_the_store = |name: &str| {
            let (kept, link) = (store.join(name).join(name), folders.inside.join(name));
            fs::create_dir_all(kept.parent().expect("folder")).expect("folder");
            if fs::symlink_metadata(&link).is_ok() {
                fs::rename(&link, &kept).expect("moved");
            } else {
                fs::write(&kept, (carrier.content)()).expect("written");
            }
            symlink(&kept, &link).expect("link");
            kept
        };
        let scene = (carrier.scene)("");
        let main = (carrier.files)("").into_iter().map(|(name, _)| name).find(|name| scene.contains(name));
        into_the_store(main.expect("the file of the layer"));
        let kept = into_the_store(carrier.name);
        forget_reading(&kept);
        let told = opened(&folders.inside, &scene);
        assert!(was_read(&kept) || !tells, "{} is not read: {told}", carrier.name);
        // The file of the layer is a link into the store, the one beside it leads elsewhere.
        let link = folders.inside.join(carrier.name);
        fs::remove_file(&link).expect("removed");
        symlink(&folders.canary, &link).expect("link");
        forget_reading(&folders.canary);
        let told = opened(&folders.inside, &scene);
        assert!(!was_read(&folders.canary) && !told.contains("CANARY"), "{}: {told}", carrier.name);
        assert!(told.contains("a link that leads out of its folder"), "{}: {told}", carrier.name);
    }
}

#[test]
fn a_page_holds_no_file_from_elsewhere() {
    let carrier = CARRIERS.iter().find(|carrier| carrier.name == "picture of an OBJ").expect("carrier");
    let folders = Folders::new(carrier);
    symlink(&folders.canary, folders.inside.join("link.png")).expect("link");
    folders.opened(carrier, "link.png");
    let app = folders.inside.join("app");
    fs::create_dir_all(app.join("threads/snippets")).expect("folder");
    let page = ["index.html", "page.css", "page.js", "kept.js", "mirror.js", "LICENCES.txt"];
    let program = ["threads/belvedere.js", "threads/belvedere_bg.wasm"];
    page.iter().chain(&program).for_each(|name| fs::write(app.join(name), "app").expect("written"));
    symlink(&folders.canary, app.join("threads/snippets/worker.js")).expect("link");
    let out = folders.inside.join("page");
    forget_reading(&folders.canary);
    let request = PackRequest {
        files: vec![folders.inside.join("scene.toml")],
        application: app,
        threads: true,
        out: out.clone(),
        ..PackRequest::default()
    };
    let packed = pack(&request, &Progress::silent()).expect("packed");
    assert!(packed.bundle.files.iter().all(|file| !file.path.ends_with("link.png")), "{packed:?}");
    assert!(!was_read(&folders.canary) && !out.join("snippets/worker.js").exists());
}
