//! The modules of a crate import each other in one direction: there are no circles at any level of the tree of modules.
//!
//! An edge leads from the module of a file to the module to which a path beginning with `crate`, `super`, `self` or a child refers,
//! through re-exports. Between two modules the edge counts at the level where their paths from the root diverge (their floor), so that
//! a child may use its parent and a parent its child.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};

type Module = Vec<String>;

/// The paths that a file uses and the names that it re-exports.
#[derive(Default)]
struct Said {
    paths: Vec<Vec<String>>,
    names: BTreeMap<String, Vec<String>>,
}

impl Said {
    fn tree(&mut self, tree: &syn::UseTree, before: &[String], gives_on: bool) {
        let with = |name: &syn::Ident| [before, &[name.to_string()]].concat();
        let (path, name) = match tree {
            syn::UseTree::Path(path) => return self.tree(&path.tree, &with(&path.ident), gives_on),
            syn::UseTree::Group(group) => return group.items.iter().for_each(|tree| self.tree(tree, before, gives_on)),
            syn::UseTree::Glob(_) => (before.to_vec(), None),
            syn::UseTree::Name(name) if name.ident == "self" => (before.to_vec(), before.last().cloned()),
            syn::UseTree::Name(name) => (with(&name.ident), Some(name.ident.to_string())),
            syn::UseTree::Rename(name) if name.ident == "self" => (before.to_vec(), Some(name.rename.to_string())),
            syn::UseTree::Rename(name) => (with(&name.ident), Some(name.rename.to_string())),
        };
        if let Some(name) = name.filter(|_| gives_on) {
            self.names.insert(name, path.clone());
        }
        self.paths.push(path);
    }
}

impl<'a> Visit<'a> for Said {
    fn visit_item_mod(&mut self, module: &'a syn::ItemMod) {
        // Tests may use whatever they like.
        if !module.attrs.iter().any(|a| a.path().is_ident("cfg")) {
            visit::visit_item_mod(self, module);
        }
    }

    fn visit_item_use(&mut self, item: &'a syn::ItemUse) {
        self.tree(&item.tree, &[], !matches!(item.vis, syn::Visibility::Inherited));
    }

    fn visit_path(&mut self, path: &'a syn::Path) {
        if path.segments.len() > 1 {
            self.paths.push(path.segments.iter().map(|s| s.ident.to_string()).collect());
        }
        visit::visit_path(self, path);
    }
}

/// The modules of a crate by their paths from its root.
struct Tree {
    said: BTreeMap<Module, Said>,
    known: BTreeSet<Module>,
}

impl Tree {
    fn of(files: &[(Module, String)]) -> Self {
        let said: BTreeMap<Module, Said> = files
            .iter()
            .map(|(module, text)| {
                let mut said = Said::default();
                said.visit_file(&syn::parse_file(text).expect("source"));
                (module.clone(), said)
            })
            .collect();
        let known = said.keys().flat_map(|m| (0..=m.len()).map(|n| m[..n].to_vec())).collect();
        Self { said, known }
    }

    fn in_folder(source: &Path) -> Self {
        let mut files = Vec::new();
        files_of(source, &Module::new(), &mut files);
        Self::of(&files)
    }

    /// A path from the root of the crate; `None` for paths of other crates and for names of the file itself.
    fn absolute(&self, module: &Module, path: &[String]) -> Option<Vec<String>> {
        let supers = path.iter().take_while(|name| *name == "super").count();
        match path.first()?.as_str() {
            "crate" => Some(path[1..].to_vec()),
            "self" => Some([module, &path[1..]].concat()),
            "super" => Some([&module[..module.len().saturating_sub(supers)], &path[supers..]].concat()),
            child => {
                self.known.contains(&[module.as_slice(), &[child.to_owned()]].concat()).then(|| [module, path].concat())
            }
        }
    }

    /// The module that a path leads to.
    fn module_of(&self, path: &[String], depth: usize) -> Module {
        let mut at = Module::new();
        for (i, name) in path.iter().enumerate() {
            let child = [at.as_slice(), std::slice::from_ref(name)].concat();
            if self.known.contains(&child) {
                at = child;
                continue;
            }
            let given_on = self.said.get(&at).and_then(|said| said.names.get(name)).filter(|_| depth < 8);
            let Some(target) = given_on.and_then(|path| self.absolute(&at, path)).filter(|target| *target != child)
            else {
                return at;
            };
            return self.module_of(&[target.as_slice(), &path[i + 1..]].concat(), depth + 1);
        }
        at
    }

    /// Which module uses which, with a path as evidence.
    fn uses(&self) -> impl Iterator<Item = (&Module, Module, String)> {
        self.said.iter().flat_map(move |(module, said)| {
            let paths = said.paths.iter().filter_map(move |path| self.absolute(module, path));
            paths.map(move |path| {
                let why = format!("{} uses {}", module.join("::"), path.join("::"));
                (module, self.module_of(&path, 0), why)
            })
        })
    }

    /// For each floor, which module imports which, with a path as evidence.
    fn floors(&self) -> BTreeMap<Module, BTreeMap<String, BTreeMap<String, String>>> {
        let mut floors: BTreeMap<_, BTreeMap<_, BTreeMap<_, _>>> = BTreeMap::new();
        for (module, target, why) in self.uses() {
            let common = module.iter().zip(&target).take_while(|(a, b)| a == b).count();
            if let (Some(from), Some(to)) = (module.get(common), target.get(common)) {
                let floor = floors.entry(module[..common].to_vec()).or_default();
                floor.entry(from.clone()).or_default().insert(to.clone(), why);
            }
        }
        floors
    }

    /// The edges that are part of circles, one sentence each.
    fn circles(&self) -> Vec<String> {
        let mut found = Vec::new();
        for edges in self.floors().values() {
            let reached = |from: &str| {
                let (mut seen, mut open) = (BTreeSet::new(), vec![from.to_owned()]);
                while let Some(at) = open.pop() {
                    for to in edges.get(&at).into_iter().flat_map(BTreeMap::keys) {
                        if seen.insert(to.clone()) {
                            open.push(to.clone());
                        }
                    }
                }
                seen
            };
            for (from, targets) in edges {
                found.extend(targets.iter().filter(|(to, _)| reached(to).contains(from)).map(|(_, why)| why.clone()));
            }
        }
        found
    }
}

fn files_of(folder: &Path, module: &Module, out: &mut Vec<(Module, String)>) {
    for entry in fs::read_dir(folder).expect("folder").map(|e| e.expect("entry").path()) {
        let stem = entry.file_stem().expect("name").to_string_lossy().into_owned();
        let child = [module.as_slice(), std::slice::from_ref(&stem)].concat();
        if entry.is_dir() {
            files_of(&entry, &child, out);
        } else if entry.extension().is_some_and(|e| e == "rs") && stem != "tests" {
            let is_folder_itself = stem == "mod" || (module.is_empty() && (stem == "lib" || stem == "main"));
            let text = fs::read_to_string(&entry).expect("source");
            out.push((if is_folder_itself { module.clone() } else { child }, text));
        }
    }
}

/// Sources of all crates of the workspace.
fn sources() -> Vec<PathBuf> {
    let root = belvedere_testkit::workspace_root();
    let grouped =
        ["crates", "apps", "tools"].into_iter().flat_map(|group| fs::read_dir(root.join(group)).expect("folder"));
    let crates = grouped.map(|entry| entry.expect("entry").path()).chain([root.join("python")]);
    crates.map(|folder| folder.join("src")).filter(|source| source.is_dir()).collect()
}

#[test]
fn modules_import_each_other_in_one_direction() {
    let mut found = Vec::new();
    for source in sources() {
        found.extend(Tree::in_folder(&source).circles().into_iter().map(|c| format!("{}: {c}", source.display())));
    }
    assert_eq!(found, Vec::<String>::new());
}

/// Verbs of the library that use another verb or live sessions, and why they still do.
const ABOVE_OTHERS: [(&str, &str); 3] = [
    // One request is handed to the verb that answers it.
    ("asked", "animate"),
    // What is opened is shown by `reveal`; a page holds what is opened.
    ("open_files", "reveal"),
    ("pack", "open_files"),
];

/// Public modules beside the verbs that are none themselves: what several of them share, and the schemas of all answers.
const NO_VERBS: [&str; 2] = ["moved", "schemas"];

/// Which module of the folder of verbs uses which verb other than itself, or live sessions.
fn above_others(tree: &Tree, verbs: &BTreeSet<String>) -> BTreeSet<(String, String)> {
    let pairs = tree.uses().filter_map(|(module, target, _)| {
        let ([folder, from, ..], [first, rest @ ..]) = (&module[..], &target[..]) else { return None };
        let to = match rest {
            _ if first == "live" => first,
            [verb, ..] if first == "verbs" && verbs.contains(verb) => verb,
            _ => return None,
        };
        (folder == "verbs" && from != to && from != "schemas").then(|| (from.clone(), to.clone()))
    });
    pairs.collect()
}

#[test]
fn verbs_use_no_other_verb_and_no_live_session() {
    let source = belvedere_testkit::workspace_root().join("crates/belvedere/src");
    let list = syn::parse_file(&fs::read_to_string(source.join("verbs/mod.rs")).expect("source")).expect("source");
    let public = list.items.iter().filter_map(|item| match item {
        syn::Item::Mod(module) if matches!(module.vis, syn::Visibility::Public(_)) => Some(module.ident.to_string()),
        _ => None,
    });
    let verbs: BTreeSet<String> = public.filter(|name| !NO_VERBS.contains(&name.as_str())).collect();
    assert!(verbs.len() > 10, "{verbs:?}");
    let allowed = ABOVE_OTHERS.map(|(from, to)| (from.to_owned(), to.to_owned()));
    assert_eq!(above_others(&Tree::in_folder(&source), &verbs), BTreeSet::from(allowed));
}

#[test]
fn a_verb_above_another_is_found() {
    let files = [
        ("", "mod live; mod verbs;"),
        ("live", "pub struct LiveSession;"),
        ("verbs", "pub mod a; pub mod b; mod shared;"),
        ("verbs::a", "use super::shared::Part; pub fn a(_: Part) {}"),
        ("verbs::b", "pub use super::a::a; fn b(_: crate::live::LiveSession) {}"),
        ("verbs::shared", "pub struct Part; fn f() { crate::verbs::b::a(Part) }"),
    ];
    let module = |way: &str| way.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect();
    let tree = Tree::of(&files.map(|(way, text)| (module(way), text.to_owned())));
    let verbs = BTreeSet::from(["a".to_owned(), "b".to_owned()]);
    let found = [("b", "a"), ("b", "live"), ("shared", "a")];
    assert_eq!(above_others(&tree, &verbs), BTreeSet::from(found.map(|(from, to)| (from.to_owned(), to.to_owned()))));
}

#[test]
fn a_circle_is_found_through_a_name_that_is_given_on() {
    let tree = |files: &[(&str, &str)]| {
        let module = |way: &str| way.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect();
        Tree::of(&files.iter().map(|(way, text)| (module(way), (*text).to_owned())).collect::<Vec<_>>())
    };
    let root = ("", "mod a; mod b; pub use a::{Thing as Other};");
    let down = ("a", "use crate::b::Part; pub struct Thing(Part);");
    assert_eq!(tree(&[root, down, ("b", "pub struct Part;")]).circles(), Vec::<String>::new());
    let circle = tree(&[root, down, ("b", "pub struct Part; fn f() -> crate::Other { crate::Other(Part) }")]).circles();
    assert_eq!(circle, ["a uses b::Part", "b uses Other"]);
    let inside =
        [("", "mod m;"), ("m", "mod x; mod y;"), ("m::x", "use super::y::Y;"), ("m::y", "fn f(x: super::x::X) {}")];
    assert_eq!(tree(&inside).circles().len(), 2);
    let of_a_parent =
        [("", "mod m;"), ("m", "mod x; use x::X; pub struct M;"), ("m::x", "use super::M; pub struct X;")];
    assert_eq!(tree(&of_a_parent).circles(), Vec::<String>::new());
}
