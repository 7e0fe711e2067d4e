//! wasm-bindgen for the application: `bindgen FILE.wasm FOLDER` writes `belvedere.js` and `belvedere_bg.wasm`.

use anyhow::{Context, Result};
use wasm_bindgen_cli_support::Bindgen;

fn main() -> Result<()> {
    let mut args = std::env::args_os().skip(1);
    let (module, folder) = args.next().zip(args.next()).context("usage: bindgen FILE.wasm FOLDER")?;
    Bindgen::new()
        .input_path(module)
        .out_name("belvedere")
        .typescript(false)
        // Names of functions are 14 of 32 MB.
        .remove_name_section(true)
        .omit_default_module_path(false)
        .web(true)?
        .generate(folder)
}
