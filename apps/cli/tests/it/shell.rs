//! Completions and manual pages.

use super::Place;
use std::io::Write;
use std::process::{Command, Stdio};

#[test]
fn completions_know_the_verbs_and_their_options() {
    let place = Place::new();
    for shell in ["bash", "zsh", "fish", "powershell"] {
        let text = place.ok(&["completions", shell]);
        for word in ["belvedere", "disocclude", "must be seen", "curved-earth"] {
            let wanted = shell != "bash" || word != "must be seen";
            assert!(!wanted || text.contains(word), "{shell}: {word}");
        }
        let file = format!("belvedere.{shell}");
        place.ok(&["completions", shell, "-o", &file]);
        assert_eq!(String::from_utf8(super::read(&place.path(&file))).expect("UTF-8"), text);
    }
    assert!(place.fails(&["completions", "tcsh"]).contains("bash"));
}

#[test]
fn bash_takes_its_completions_and_completes_a_verb() {
    let script = Place::new().ok(&["completions", "bash"]);
    let ask =
        "COMP_WORDS=(belvedere disoc); COMP_CWORD=1; _belvedere belvedere disoc belvedere; echo \"${COMPREPLY[@]}\"";
    let Ok(mut bash) = Command::new("bash").stdin(Stdio::piped()).stdout(Stdio::piped()).spawn() else {
        let _ = writeln!(std::io::stderr(), "SKIPPED: there is no bash on this machine");
        return;
    };
    bash.stdin.take().expect("a pipe").write_all(format!("{script}\n{ask}\n").as_bytes()).expect("written");
    let out = bash.wait_with_output().expect("it ends");
    assert_eq!(String::from_utf8_lossy(&out.stdout).trim(), "disocclude");
}

#[test]
fn every_verb_has_its_manual_page() {
    let place = Place::new();
    assert!(place.ok(&["man", "pages"]).contains("pages in pages"));
    let page = |name: &str| String::from_utf8(super::read(&place.path(&format!("pages/{name}.1")))).expect("UTF-8");
    let verbs = "demo reveal disocclude generalise preset render animate export project rays displace pick measure check info show schema bench \
                 figures view pack trust completions man";
    for verb in verbs.split_whitespace() {
        let text = page(&format!("belvedere-{verb}"));
        assert!(text.contains(".SH NAME") && text.contains("\\-\\-json"), "{verb}");
        assert!(page("belvedere").contains(&format!("belvedere\\-{verb}")), "{verb}");
    }
    assert!(page("belvedere-preset-list").contains(".SH NAME"));
    let said = place.fails(&["man", "pages"]);
    assert!(said.contains("--overwrite"), "{said}");
    assert!(place.fails(&["man", "-"]).contains("name a folder"));
}
