//! Pages: one application in a folder, under one policy.

use super::schema_check::{Strictness, check};
use super::{Place, read};
use serde_json::Value;
use std::path::Path;

/// The real page around programs of no use.
fn with_application() -> Place {
    let place = Place::new();
    std::fs::create_dir_all(place.path("app/threads/snippets/helper")).expect("folder");
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../viewer/web");
    for name in ["index.html", "page.css", "page.js", "kept.js", "mirror.js"] {
        std::fs::copy(page.join(name), place.path("app").join(name)).expect("the page");
    }
    place.write("app/LICENCES.txt", "licences");
    for (folder, word) in [("app", "one"), ("app/threads", "many")] {
        ["belvedere.js", "belvedere_bg.wasm"]
            .iter()
            .for_each(|name| drop(place.write(&format!("{folder}/{name}"), word)));
    }
    place.write("app/threads/snippets/helper/workers.js", "many");
    place
}

fn pack(place: &Place, out: &str, more: &[&str]) -> Value {
    let answer = place.json(&[&["pack", "-o", out, "--app", "app", "--json"], more].concat());
    let schema = place.json(&["schema", "pack"]);
    assert_eq!(check(&schema, &answer, Strictness::NoUnknownKeys), Ok(()));
    answer
}

#[test]
fn a_folder_holds_one_application() {
    let place = with_application();
    for (out, more, word, threads) in [("plain", &[][..], "one", false), ("fast", &["--all-cores"][..], "many", true)] {
        let report = &pack(&place, out, more);
        let bundle: Value = serde_json::from_slice(&read(&place.path(&format!("{out}/bundle.json")))).expect("JSON");
        assert_eq!((&bundle["threads"], &report["bundle"]["threads"]), (&threads.into(), &threads.into()));
        for name in ["belvedere.js", "belvedere_bg.wasm"] {
            assert_eq!(read(&place.path(&format!("{out}/{name}"))), word.as_bytes());
        }
        assert_eq!(read(&place.path(&format!("{out}/LICENCES.txt"))), b"licences");
        assert!(!place.path(&format!("{out}/threads")).exists());
        assert_eq!(place.path(&format!("{out}/snippets/helper/workers.js")).exists(), threads);
        let headers = String::from_utf8(read(&place.path(&format!("{out}/_headers")))).expect("text");
        assert_eq!(headers.contains("Cross-Origin-Embedder-Policy: require-corp"), threads, "{headers}");
    }
}

#[test]
fn the_policy_of_the_page_stands_in_its_headers_and_lets_nothing_of_others_in() {
    let place = with_application();
    pack(&place, "page", &[]);
    let page = String::from_utf8(read(&place.path("page/index.html"))).expect("text");
    let headers = String::from_utf8(read(&place.path("page/_headers"))).expect("text");
    let line =
        headers.lines().find_map(|line| line.trim().strip_prefix("Content-Security-Policy: ")).expect("a policy");
    assert!(page.contains(&format!("content=\"{line}\"")), "{line}");
    assert!(
        line.starts_with("default-src 'none'") && !line.contains("unsafe-inline") && !line.contains("'unsafe-eval'")
    );
    assert!(!page.contains("<style") && !page.contains(" style=") && !page.contains(" onload="), "{page}");
    assert_eq!(
        page.matches("<script").count(),
        page.matches("<script type=\"module\" src=\"page.js\"></script>").count()
    );
    for name in ["index.html", "page.css", "page.js", "kept.js", "mirror.js"] {
        let text = String::from_utf8(read(&place.path(&format!("page/{name}")))).expect("text");
        assert!(!text.contains("https://") && !text.contains("http://"), "{name} names another server");
    }
}

#[test]
fn a_missing_application_is_said_with_the_one_command_that_builds_it() {
    let place = with_application();
    std::fs::remove_dir_all(place.path("app/threads")).expect("removed");
    for (app, more, what) in [
        ("app", &["--all-cores"][..], "holds no application for browsers with many threads"),
        ("gone", &[][..], "holds no application for browsers (index.html"),
    ] {
        let said = place.fails(&[&["pack", "-o", "page", "--app", app], more].concat());
        let command = format!("apps/viewer/web/build {app}");
        assert!(said.contains(what) && said.ends_with(&command), "{said}");
        assert!(!place.path("page").exists(), "{said}");
    }
}

#[test]
fn the_hint_to_try_a_page_serves_it_to_this_machine_alone() {
    let place = with_application();
    let said = place.ok(&["pack", "-o", "page", "--app", "app"]);
    assert!(said.contains("python3 -m http.server --bind 127.0.0.1 -d page\n"), "{said}");
}
