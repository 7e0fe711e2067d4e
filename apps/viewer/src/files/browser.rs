//! Files in a browser: given by the user into memory, handed back as downloads.

use super::Inputs;
use crate::browser::page;
use crate::language::{fill, tr};
use belvedere::io::fs;
use eframe::egui::{Context, DroppedFileHandle};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Sender, TryRecvError};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::js_sys::{Array, Promise, Uint8Array};
use web_sys::{Blob, HtmlAnchorElement, Url};

/// A pending question for files.
#[derive(Debug)]
pub(crate) struct Choosing(Inputs);

impl Choosing {
    /// The answer, if it has arrived; empty if the user cancelled.
    ///
    /// # Errors
    /// One sentence about a file that could not be read.
    pub(crate) fn answer(&mut self, ctx: &Context) -> Option<Result<Vec<PathBuf>, String>> {
        match self.0.try_recv() {
            Ok(answer) => Some(answer),
            Err(TryRecvError::Disconnected) => Some(Ok(Vec::new())),
            Err(TryRecvError::Empty) => {
                ctx.request_repaint_after_secs(0.1);
                None
            }
        }
    }
}

/// Path of the output: the usual name beside the scene, without a question; the browser asks the user when it is downloaded.
pub(crate) fn choose_output(folder: &Path, name: &str, _: bool) -> Choosing {
    let (outbox, inbox) = mpsc::channel();
    let _ = outbox.send(Ok(vec![folder.join(name)]));
    Choosing(inbox)
}

/// Lets the user choose a scene, or data.
pub(crate) fn choose_input(_: bool) -> Choosing {
    Choosing(later(|outbox| async move {
        let _ = outbox.send(picked().await);
    }))
}

/// Files that the user picks in the browser's dialog; none if it is cancelled.
async fn picked() -> Result<Vec<PathBuf>, String> {
    let failed = |e: &JsValue| {
        fill(tr("the files could not be read: {0}"), &[&e.as_string().unwrap_or_else(|| format!("{e:?}"))])
    };
    let promise: Option<Promise> = page::call("choose", &[]).and_then(|value| value.dyn_into().ok());
    let Some(promise) = promise else { return Ok(Vec::new()) };
    let files = JsFuture::from(promise).await.map_err(|e| failed(&e))?;
    if files.is_null() {
        return Err(
            tr("the browser opens its dialog only just after a press: press Open again, or drop the files").into()
        );
    }
    let files = Array::from(&files);
    let kept = files.iter().map(|file| {
        let pair = Array::from(&file);
        let bytes = pair.get(1).dyn_into::<Uint8Array>().map(|bytes| bytes.to_vec());
        keep(&pair.get(0).as_string().unwrap_or_default(), bytes.map_err(|e| format!("{e:?}")))
    });
    kept.collect()
}

/// Files that were dropped on the page.
pub(crate) fn dropped(files: &[DroppedFileHandle]) -> Inputs {
    let files = files.to_vec();
    later(|outbox| async move {
        let mut paths = Vec::new();
        for file in &files {
            paths.push(keep(&file.path().to_string_lossy(), file.bytes_async().await));
        }
        let _ = outbox.send(paths.into_iter().collect());
    })
}

fn later<F: Future<Output = ()> + 'static>(work: impl FnOnce(Sender<Result<Vec<PathBuf>, String>>) -> F) -> Inputs {
    let (outbox, inbox) = mpsc::channel();
    spawn_local(work(outbox));
    inbox
}

/// Puts a file into memory, and lets the browser keep it.
fn keep(name: &str, bytes: Result<Vec<u8>, String>) -> Result<PathBuf, String> {
    let path = PathBuf::from(name);
    let bytes = bytes.map_err(|e| fill(tr("{0} could not be read: {1}"), &[&name, &e]))?;
    let copy = Uint8Array::from(bytes.as_slice());
    fs::write(&path, bytes).map_err(|e| fill(tr("{0} could not be kept: {1}"), &[&name, &e]))?;
    page::call("given", &[&name.into(), &copy]);
    Ok(path)
}

/// Hands a written file to the user as a download.
pub(crate) fn hand_over(path: &Path) -> Result<(), String> {
    let bytes = fs::read(path).map_err(|e| e.to_string())?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    download(&name, &bytes).map_err(|e| fill(tr("{0} could not be handed over: {1}"), &[&name, &format!("{e:?}")]))
}

fn download(name: &str, bytes: &[u8]) -> Result<(), JsValue> {
    let blob = Blob::new_with_u8_array_sequence(&Array::of1(&Uint8Array::from(bytes)))?;
    let address = Url::create_object_url_with_blob(&blob)?;
    let document = web_sys::window().and_then(|window| window.document()).ok_or("there is no page")?;
    let link: HtmlAnchorElement = document.create_element("a")?.dyn_into()?;
    link.set_href(&address);
    link.set_download(name);
    link.click();
    Url::revoke_object_url(&address)
}
