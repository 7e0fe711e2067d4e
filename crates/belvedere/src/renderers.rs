//! Renderers by name: those of this program, and those that a program registers.

use crate::BelvedereError;
use crate::scene_file::request::RendererName;
use crate::scene_file::suggestion;
use belvedere_cpu::{CpuRenderer, ExactRenderer};
use belvedere_scene::Renderer;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError, RwLock};

/// A renderer that threads and sessions share.
pub type SharedRenderer = Arc<dyn Renderer + Send + Sync>;
type Make = Arc<dyn Fn() -> SharedRenderer + Send + Sync>;

static REGISTERED: RwLock<BTreeMap<String, Make>> = RwLock::new(BTreeMap::new());

/// Names a renderer for every door of this process: `--renderer NAME`, the key `renderer` of scene files, the options of pictures, Python.
///
/// * `make`: makes one; each session makes its own once, so that it may keep a cache.
///
/// An earlier one of the same name is replaced. The names `auto`, `cpu` and `exact` stay those of this program.
pub fn register(name: &str, make: impl Fn() -> SharedRenderer + Send + Sync + 'static) {
    REGISTERED.write().unwrap_or_else(PoisonError::into_inner).insert(name.trim().to_owned(), Arc::new(make));
}

/// Names of all renderers, without `auto`.
pub fn names() -> Vec<String> {
    let registered = REGISTERED.read().unwrap_or_else(PoisonError::into_inner);
    let own = [RendererName::CPU, RendererName::EXACT].map(|name| name.to_string());
    let others = registered.keys().filter(|name| !own.contains(name)).cloned().collect();
    [own.to_vec(), others].concat()
}

/// Refuses the name of a renderer that does not exist.
pub(crate) fn check(name: &RendererName) -> Result<(), BelvedereError> {
    if *name == RendererName::AUTO || names().iter().any(|known| known == name.as_str()) {
        return Ok(());
    }
    let known = [vec!["auto".to_owned()], names()].concat();
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    Err(BelvedereError::NoRenderer { name: name.to_string(), advice: suggestion(name.as_str(), &known) })
}

fn made(name: &RendererName) -> Result<SharedRenderer, BelvedereError> {
    check(name)?;
    let registered = REGISTERED.read().unwrap_or_else(PoisonError::into_inner).get(name.as_str()).cloned();
    Ok(match (name.as_str(), registered) {
        ("exact", _) => Arc::new(ExactRenderer),
        ("cpu", _) | (_, None) => Arc::new(CpuRenderer::default()),
        (_, Some(make)) => make(),
    })
}

/// Renderers of a session, each made once and kept with its caches. Clones share them.
#[derive(Clone)]
pub(crate) struct Renderers {
    /// The one that `auto` is.
    usual: RendererName,
    /// The one that a caller gave, which then `auto` is.
    given: Option<SharedRenderer>,
    made: Arc<Mutex<BTreeMap<String, SharedRenderer>>>,
}

impl Renderers {
    /// * `usual`: what `auto` means.
    pub(crate) fn new(usual: RendererName) -> Self {
        let usual = if usual == RendererName::AUTO { RendererName::CPU } else { usual };
        Self { usual, given: None, made: Arc::default() }
    }

    /// Those of a caller who brings his own.
    pub(crate) fn of(given: SharedRenderer) -> Self {
        Self { given: Some(given), ..Self::new(RendererName::AUTO) }
    }

    /// The renderer of a name.
    ///
    /// # Errors
    /// [`BelvedereError::NoRenderer`].
    pub(crate) fn get(&self, name: &RendererName) -> Result<SharedRenderer, BelvedereError> {
        let is_usual = *name == RendererName::AUTO;
        if let Some(given) = self.given.as_ref().filter(|given| is_usual || given.name() == name.as_str()) {
            return Ok(given.clone());
        }
        let name = if is_usual { &self.usual } else { name };
        let mut all = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(made) = all.get(name.as_str()) {
            return Ok(made.clone());
        }
        let renderer = made(name)?;
        all.insert(name.to_string(), renderer.clone());
        Ok(renderer)
    }
}
