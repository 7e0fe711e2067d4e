//! Calls to the page (web/page.js), which keeps files and shows elements.

use wasm_bindgen::{JsCast, JsValue};
use web_sys::js_sys::{Array, Function, Reflect, global};

/// Calls a function of the page; `None` if the page does not have it, or it failed.
pub(crate) fn call(name: &str, arguments: &[&JsValue]) -> Option<JsValue> {
    let page = Reflect::get(&global(), &"belvederePage".into()).ok()?;
    let function: Function = Reflect::get(&page, &name.into()).ok()?.dyn_into().ok()?;
    let list = Array::new();
    arguments.iter().for_each(|argument| {
        list.push(argument);
    });
    function.apply(&page, &list).ok()
}
