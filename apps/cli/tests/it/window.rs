//! The application as `belvedere view` starts it, and what it saves.

use super::{Place, read};
use belvedere_studio::Editor;
use std::os::unix::fs::PermissionsExt;
use std::process::Command;

const SCENE: &str = "format = 1\ncrs = \"local\"\n[camera]\neye = [6000.0, -5200.0, 3600.0]\nlook_at = [0.0, 0.0, 300.0]\nimage = [320, 180]\n\
    [[layer]]\nkind = \"terrain\"\nid = \"ground\"\nsource = \"builtin:massif?seed=7&size=129\"\n";

/// `belvedere view` of a copy of the program, in whose folder there is, or is not, an application.
fn view(place: &Place, application: Option<&str>, args: &[&str]) -> (Option<i32>, String, String) {
    let program = place.path("belvedere");
    std::fs::copy(env!("CARGO_BIN_EXE_belvedere"), &program).expect("copied");
    if let Some(script) = application {
        let path = place.write("belvedere-view", script);
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755)).expect("may be run");
    }
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    // A test that starts a program at the moment of the copy holds the file open for writing until its program runs.
    for _ in 0..100 {
        match Command::new(&program).current_dir(place.path("")).arg("view").args(args).env("PATH", "").output() {
            Ok(out) => {
                let said = text(out.stderr);
                if !said.contains("busy") {
                    return (out.status.code(), text(out.stdout), said);
                }
            }
            Err(e) if e.kind() == std::io::ErrorKind::ExecutableFileBusy => {}
            Err(e) => panic!("the program does not start: {e}"),
        }
        std::thread::sleep(std::time::Duration::from_millis(100));
    }
    panic!("the program stays busy");
}

#[test]
fn view_starts_the_application_beside_it_with_files_and_folders_and_ends_as_it_ends() {
    let place = Place::new();
    place.write("a scene.toml", SCENE);
    let script = "#!/bin/sh\nfor a in \"$@\"; do echo \"$a\"; done\nexit 7\n";
    let (code, said, _) = view(&place, Some(script), &["a scene.toml", "--allow-root", "data"]);
    assert_eq!((code, said.lines().collect::<Vec<_>>()), (Some(7), vec!["--allow-root", "data", "--", "a scene.toml"]));
}

#[test]
fn view_without_an_application_says_where_one_comes_from() {
    let place = Place::new();
    let (code, _, complaint) = view(&place, None, &[]);
    assert_eq!((code, complaint.lines().count()), (Some(2), 1), "{complaint}");
    assert!(
        complaint.contains("belvedere-view") && complaint.contains("cargo install --path apps/viewer"),
        "{complaint}"
    );
    assert!(place.fails(&["view", "none.tif"]).contains("there is no such file"));
}

#[test]
fn what_the_application_saves_is_drawn_by_the_command_line_byte_by_byte() {
    let place = Place::new();
    place.write("scene.toml", &format!("{SCENE}[[stage]]\nkind = \"spline_bend\"\npresets = \"progressive\"\n"));
    let progress = belvedere::scene::Progress::silent();
    let opened = belvedere::verbs::open_files::open_files(&[place.path("scene.toml")], &[], &progress);
    let mut editor = Editor::from(opened.expect("opened"));
    // As a drag and a slider change it: numbers with many digits.
    editor.edit(|document| {
        document.camera.eye = belvedere::scene_file::PointDoc::Scene([4_765.432_109_877, -5200.1, 3600.0]);
        document.camera.image = [333, 187];
    });
    editor.save(&place.path("saved.toml")).expect("saved");
    let session = editor.place.session((**editor.document()).clone(), &progress).expect("session");
    let shown = session.render(&belvedere::picture::PictureOptions::default()).expect("drawn");
    shown.write(&place.path("exported.png"), false).expect("exported");
    let saved = place.path("saved.toml");
    place.ok(&["render", saved.to_str().expect("name"), "-o", "rendered.png"]);
    assert!(read(&place.path("exported.png")) == read(&place.path("rendered.png")), "the pictures differ");
}
