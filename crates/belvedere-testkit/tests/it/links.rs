//! Links of the documents lead somewhere, and the book holds every page.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn pages(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("folder").map(|e| e.expect("entry").path()) {
        if entry.is_dir() {
            pages(&entry, out);
        } else if entry.extension().is_some_and(|e| e == "md") {
            out.push(entry);
        }
    }
}

/// Targets of the links and pictures of a page; code is left out.
fn targets(text: &str) -> Vec<String> {
    let mut out = Vec::new();
    let mut in_code = false;
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            in_code = !in_code;
        }
        if in_code {
            continue;
        }
        // Code between single ticks is every second part, but for a link whose words are code.
        let line = line.split('`').enumerate().map(|(i, part)| if i % 2 == 0 { part } else { "" }).collect::<String>();
        let found =
            line.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target.to_owned());
        out.extend(found);
    }
    out
}

/// The anchors of a page: its headings as GitHub and mdBook write them.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = text.lines().filter(|line| line.starts_with('#')).map(|line| line.trim_start_matches('#').trim());
    let slug = |heading: &str| {
        let kept = heading.to_lowercase();
        let kept = kept.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    headings.map(slug).collect()
}

/// Links of a page that lead nowhere.
fn broken(page: &Path, text: &str) -> Vec<String> {
    let is_outside = |target: &str| target.contains("://") || target.starts_with("mailto:");
    let is_broken = |target: &String| {
        let (file, anchor) =
            target.split_once('#').map_or((target.as_str(), None), |(file, anchor)| (file, Some(anchor)));
        let to = if file.is_empty() { page.to_owned() } else { page.parent().expect("a folder").join(file) };
        let is_page = to.extension().is_some_and(|e| e == "md");
        let has = |anchor: &str| match () {
            () if to == page => anchors(text).contains(anchor),
            () => fs::read_to_string(&to).is_ok_and(|text| anchors(&text).contains(anchor)),
        };
        !to.exists() || anchor.is_some_and(|anchor| is_page && !has(anchor))
    };
    let targets = targets(text).into_iter().filter(|target| !is_outside(target));
    targets.filter(is_broken).map(|target| format!("{}: {target}", page.display())).collect()
}

#[test]
fn links_of_documents_lead_somewhere() {
    let root = belvedere_testkit::workspace_root();
    let mut all = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(|name| root.join(name)).to_vec();
    pages(&root.join("docs"), &mut all);
    assert!(all.len() > 20, "{all:?}");
    let read = |page: &PathBuf| fs::read_to_string(page).expect("a page");
    let links: usize = all.iter().map(|page| targets(&read(page)).len()).sum();
    assert!(links > 100, "only {links} links are found");
    let found: Vec<String> = all.iter().flat_map(|page| broken(page, &read(page))).collect();
    assert_eq!(found, Vec::<String>::new());
}

#[test]
fn links_that_lead_nowhere_are_noticed() {
    let page = belvedere_testkit::workspace_root().join("docs/guide/README.md");
    let text = "# A page\n[a](films.md) [b](none.md) [c](#a-page) [d](#b) [e](../ARCHITECTURE.md#none) [f](https://x.org/)\n`[g](h.md)`\n";
    assert_eq!(broken(&page, text).len(), 3, "{:?}", broken(&page, text));
}

#[test]
fn the_book_holds_every_page() {
    let docs = belvedere_testkit::workspace_root().join("docs");
    let mut all = Vec::new();
    pages(&docs, &mut all);
    let summary = fs::read_to_string(docs.join("SUMMARY.md")).expect("the summary");
    let listed: BTreeSet<PathBuf> = targets(&summary).iter().map(|target| docs.join(target)).collect();
    let pages: BTreeSet<PathBuf> = all.into_iter().filter(|page| !page.ends_with("SUMMARY.md")).collect();
    assert_eq!(listed, pages, "left: docs/SUMMARY.md, right: docs");
}
