//! Packs a scene, its files and the application into a folder that any web server can host.

use super::open_files::open_trusted;
use crate::guard::guarded;
use crate::placed::{Place, PlacedDocument};
use crate::{BelvedereError, DocumentError, Trust, output};
use belvedere_io::{InputFile, IoError, atomic, fs, join_table, split_table};
use belvedere_scene::Progress;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// The files of the page, for any application; its licences travel with it.
const PAGE: [&str; 6] = ["index.html", "page.css", "page.js", "kept.js", "mirror.js", "LICENCES.txt"];
/// The files of an application.
const PROGRAM: [&str; 2] = ["belvedere.js", "belvedere_bg.wasm"];
/// Folder of the multi-threaded application, if it was built.
const THREADS: &str = "threads";
/// Header file for servers that support it (such as Netlify and Cloudflare Pages).
const HEADERS: &str = "_headers";
/// List of the packed files, which the page reads first.
pub const BUNDLE: &str = "bundle.json";
/// Folder of the scene and its files.
const SCENE_FOLDER: &str = "scene";
/// Limit for the files of a page, bytes: the memory of WebAssembly ends at 4 GiB, and loaded data take more than their files.
const MAX_BYTES: u64 = 1 << 30;

/// Request for a package.
#[derive(Debug, Clone, Default)]
pub struct PackRequest {
    /// A scene file, or data as [`open_files`](super::open_files::open_files) takes them; empty = the built-in scenes.
    pub files: Vec<PathBuf>,
    /// Folders beside that of a scene file from which its files may come.
    pub allowed: Vec<PathBuf>,
    /// Consent that was given to the scene file.
    pub trust: Trust,
    /// Folder with the page, and the application with one thread and with many, as `apps/viewer/web/build` makes it.
    pub application: PathBuf,
    /// Whether the page gets the application for many threads, which needs a server that sends two headers; else the one for one thread,
    /// which runs on any.
    pub threads: bool,
    /// How the application is made, for the message that it is missing.
    pub remedy: String,
    /// The folder to be made.
    pub out: PathBuf,
    /// Whether existing files may be replaced.
    pub overwrite: bool,
}

/// Contents of a package, besides the application.
#[derive(Debug, Clone, Default, PartialEq, Eq, JsonSchema, Serialize)]
pub struct Bundle {
    /// Title of the scene.
    pub title: String,
    /// Whether the application is the one for many threads.
    pub threads: bool,
    /// Names of the files to open.
    pub open: Vec<String>,
    /// All files; paths relative to the folder, with `/`.
    pub files: Vec<InputFile>,
}

/// Result of packing.
#[derive(Debug, Clone, PartialEq, Eq, JsonSchema, Serialize)]
pub struct Packed {
    /// The folder.
    pub folder: PathBuf,
    /// The scene and its files.
    pub bundle: Bundle,
    /// Size of the application, bytes.
    pub application_bytes: u64,
    /// Size of the scene and its files, bytes.
    pub scene_bytes: u64,
}

/// Writes the folder: the application, the scene, and every file that it needs, under names that do not show their origin.
///
/// # Errors
/// [`BelvedereError`] of a scene that cannot be opened; [`BelvedereError::Output`] if the application is missing, or the
/// files are too large for a page; [`IoError::Exists`] for existing files.
pub fn pack(request: &PackRequest, progress: &Progress) -> Result<Packed, BelvedereError> {
    guarded(|| packed(request, progress))
}

fn packed(request: &PackRequest, progress: &Progress) -> Result<Packed, BelvedereError> {
    let application = application_files(request)?;
    let names = application.iter().map(|(name, _)| name.as_path()).chain([Path::new(BUNDLE)]);
    if request.out.is_dir() {
        names.into_iter().try_for_each(|name| atomic::check_output(&request.out.join(name), request.overwrite))?;
    }
    let (mut bundle, contents) =
        if request.files.is_empty() { Default::default() } else { scene_files(request, progress)? };
    let scene_bytes: u64 = bundle.files.iter().map(|file| file.bytes).sum();
    if scene_bytes > MAX_BYTES {
        let mib = |bytes: u64| bytes >> 20;
        let reason = format!(
            "the files of the scene have {} MiB, a page can load at most {} MiB; cut out the part that is seen",
            mib(scene_bytes),
            mib(MAX_BYTES)
        );
        return Err(BelvedereError::Output { path: request.out.clone(), reason });
    }
    bundle.threads = request.threads;
    // A page of the old list and new files would be neither.
    let list = request.out.join(BUNDLE);
    if request.overwrite && list.is_file() {
        std::fs::remove_file(&list).map_err(|e| IoError::os(&list, e))?;
    }
    let mut application_bytes = 0;
    for (name, bytes) in &application {
        application_bytes += bytes.len() as u64;
        put(&request.out.join(name), bytes, request.overwrite)?;
    }
    for (i, (file, bytes)) in bundle.files.iter().zip(&contents).enumerate() {
        progress.tick("writing", i as f64 / contents.len() as f64)?;
        put(&request.out.join(&file.path), bytes, request.overwrite)?;
    }
    // Written last, so that a page that finds it finds all files.
    output::write_text(&request.out.join(BUNDLE), &output::pretty(&bundle)?, request.overwrite)?;
    Ok(Packed { folder: request.out.clone(), bundle, application_bytes, scene_bytes })
}

/// Files of the page and of its one application: names relative to its folder, and contents.
fn application_files(request: &PackRequest) -> Result<Vec<(PathBuf, Vec<u8>)>, BelvedereError> {
    let folder = &request.application;
    let program = if request.threads { folder.join(THREADS) } else { folder.clone() };
    let mut names: Vec<PathBuf> = PROGRAM.into_iter().map(PathBuf::from).collect();
    // The scripts that start the threads.
    if request.threads {
        names_below(&program, Path::new("snippets"), &mut names);
    }
    let page = PAGE.into_iter().map(|name| (folder, PathBuf::from(name)));
    let read = |(from, name): (&PathBuf, PathBuf)| match fs::read(from.join(&name)) {
        Ok(bytes) => Ok((name, bytes)),
        Err(e) => Err(BelvedereError::Output {
            path: folder.to_owned(),
            reason: format!(
                "holds no application for browsers{} ({}: {}); {}",
                if request.threads && from == &program { " with many threads" } else { "" },
                name.display(),
                belvedere_io::said(&e),
                request.remedy
            ),
        }),
    };
    let mut files: Vec<_> =
        page.chain(names.into_iter().map(|name| (&program, name))).map(read).collect::<Result<_, _>>()?;
    let headers = headers(files.first().map_or(&[], |(_, page)| page), request.threads);
    files.push((HEADERS.into(), headers.into_bytes()));
    Ok(files)
}

/// The header file: the page's own policy again, and what lets workers share memory.
fn headers(page: &[u8], threads: bool) -> String {
    let page = String::from_utf8_lossy(page);
    let policy = page.split_once("Content-Security-Policy\" content=\"").and_then(|(_, rest)| rest.split_once('"'));
    let mut text = "/*\n  X-Content-Type-Options: nosniff\n  Referrer-Policy: no-referrer\n".to_owned();
    if let Some((policy, _)) = policy {
        text += &format!("  Content-Security-Policy: {policy}\n");
    }
    if threads {
        text += "  Cross-Origin-Opener-Policy: same-origin\n  Cross-Origin-Embedder-Policy: require-corp\n";
    }
    text
}

/// Adds the names of all files below a folder, if it exists.
fn names_below(root: &Path, folder: &Path, names: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(root.join(folder)) else { return };
    for entry in entries.flatten() {
        let name = folder.join(entry.file_name());
        match entry.file_type() {
            Ok(kind) if kind.is_dir() => names_below(root, &name, names),
            Ok(kind) if kind.is_file() => names.push(name),
            // A link would copy a file of elsewhere into the page.
            _ => {}
        }
    }
}

/// The scene with names valid in the bundle, and every file that it needs, with contents.
fn scene_files(request: &PackRequest, progress: &Progress) -> Result<(Bundle, Vec<Vec<u8>>), BelvedereError> {
    let PlacedDocument { mut document, place, .. } =
        open_trusted(&request.files, &request.allowed, &request.trust, progress)?;
    let session = place.session(document.clone(), progress)?;
    let mut layout = Layout::new(&place);
    let mut failed = None;
    document.for_each_path(&mut |name| {
        let packed = place.roots.resolve(name).map_err(Into::into).and_then(|file| layout.place(&file));
        match packed {
            Ok(packed) => *name = packed,
            Err(e) => failed = Some(e),
        }
    });
    if let Some(e) = failed {
        return Err(e);
    }
    // Files that the named files refer to, such as materials and tables.
    for input in session.input_paths() {
        if place.scene.as_deref().is_none_or(|scene| !same(scene, &input)) {
            layout.place(&input)?;
        }
    }
    let name = place.scene.as_deref().and_then(|scene| scene.file_stem()?.to_str()).unwrap_or("scene");
    let scene = format!("{SCENE_FOLDER}/{name}.toml");
    let text = output::document_toml(&document)?.into_bytes();
    let title = document.title.clone();
    let mut bundle = Bundle {
        title,
        threads: false,
        open: vec![scene.clone()],
        files: vec![InputFile::of(Path::new(&scene), &text)],
    };
    let mut contents = vec![text];
    let count = layout.files.len() as f64;
    for (i, (file, packed)) in layout.files.into_iter().enumerate() {
        progress.tick("reading", i as f64 / count)?;
        let (bytes, record) = InputFile::read(&file)?;
        bundle.files.push(InputFile { path: format!("{SCENE_FOLDER}/{packed}").into(), ..record });
        contents.push(bytes);
    }
    Ok((bundle, contents))
}

fn same(a: &Path, b: &Path) -> bool {
    fs::canonicalize(a).is_ok_and(|a| fs::canonicalize(b).is_ok_and(|b| a == b))
}

/// Names of files in the bundle: files of one folder stay together, so that relative references hold.
struct Layout {
    /// Folders of the scene: its own, then the allowed ones.
    folders: Vec<PathBuf>,
    /// Name of each file, relative to the folder of the scene.
    files: BTreeMap<PathBuf, String>,
}

impl Layout {
    fn new(Place { roots, .. }: &Place) -> Self {
        let own = (!roots.scene_dir.as_os_str().is_empty()).then_some(&roots.scene_dir);
        let folders = own.into_iter().chain(&roots.allowed).filter_map(|folder| fs::canonicalize(folder).ok());
        // Beside single files that the user allowed lie those that they refer to.
        let beside = roots.files.iter().filter_map(|file| file.parent().map(Path::to_owned));
        let mut folders: Vec<PathBuf> = folders.chain(beside).collect();
        let mut seen = std::collections::BTreeSet::new();
        folders.retain(|folder| seen.insert(folder.clone()));
        Self { folders, files: BTreeMap::new() }
    }

    /// Name of a file in the bundle, relative to the folder of the scene, with its table.
    fn place(&mut self, file: &Path) -> Result<String, BelvedereError> {
        let (file, table) = split_table(file);
        let packed = PathBuf::from(self.place_file(file)?);
        Ok(join_table(packed, table).display().to_string())
    }

    fn place_file(&mut self, file: &Path) -> Result<String, BelvedereError> {
        let real = fs::canonicalize(file).map_err(|e| IoError::os(file, e))?;
        if let Some(packed) = self.files.get(&real) {
            return Ok(packed.clone());
        }
        let below = self.folders.iter().enumerate().find_map(|(i, folder)| Some((i, real.strip_prefix(folder).ok()?)));
        let Some((i, below)) = below else {
            let reason = "lies in no folder of the scene".into();
            return Err(DocumentError::Path { name: real.display().to_string(), reason, root_missing: true }.into());
        };
        let parts = below.components().filter_map(|part| match part {
            Component::Normal(part) => {
                Some(part.to_str().ok_or_else(|| BelvedereError::not_utf8(&real.display().to_string())))
            }
            _ => None,
        });
        let below = parts.collect::<Result<Vec<_>, _>>()?.join("/");
        let packed = format!("data-{i}/{below}");
        self.files.insert(real, packed.clone());
        Ok(packed)
    }
}

fn put(path: &Path, bytes: &[u8], overwrite: bool) -> Result<(), BelvedereError> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(|e| IoError::os(folder, e))?;
    }
    Ok(atomic::write_atomic(path, overwrite, |out| out.write_all(bytes))?)
}
