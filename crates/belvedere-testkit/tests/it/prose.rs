//! Kinds decide, prose never: libraries name no options of a program in their texts, and nothing is decided by what an error or a warning
//! says.

use std::fs;
use std::path::{Path, PathBuf};
use syn::parse::{ParseBuffer, ParseStream};
use syn::punctuated::Punctuated;
use syn::visit::{self, Visit};
use syn::{Attribute, Expr, ExprMethodCall, ItemFn, ItemMod, Lit, LitStr, Macro, Token, token};

/// Texts of libraries that may name an option, by a part of them.
const OPTIONS: [&str; 2] = [
    // Title of the schema of what the program prints.
    "belvedere {verb} --json",
    // Of another program.
    "as with gdcmconv --raw",
];

/// Decisions on a text, by file and part, that are right: the texts are contents of files or come from elsewhere without a kind.
const DECISIONS: [(&str, &str); 12] = [
    ("belvedere-document/src/rewritten/toml_text.rs", "\r\n"),
    // Whether paths are to be shortened in the texts of warnings.
    ("belvedere/src/session.rs", "MAIN_SEPARATOR"),
    ("belvedere-io/src/city/citygml.rs", "opengis.net/citygml/2.0"),
    ("belvedere-io/src/city/citygml.rs", "opengis.net/citygml/3."),
    ("belvedere-io/src/crs.rs", "+pm="),
    ("belvedere-io/src/crs.rs", "+proj=longlat"),
    ("belvedere-io/src/crs.rs", "proj="),
    // Errors of a foreign crate, which gives texts alone.
    ("belvedere-io/src/mesh/ply.rs", "UTF-8"),
    ("belvedere-io/src/mesh/ply.rs", "end of file"),
    ("belvedere-io/src/volume/nrrd.rs", ":="),
    ("cli/src/stdin.rs", "\"CityJSON\""),
    ("gallery/src/curved/canyon.rs", "POSITION"),
];

/// Names of variables and fields for what an error or a warning says.
const SAID: [&str; 10] = ["e", "err", "error", "message", "reason", "refused", "said", "text", "warning", "why"];

/// What a file says in its texts, and the parts of texts by which it decides.
#[derive(Default)]
struct Prose {
    texts: Vec<String>,
    decisions: Vec<String>,
}

impl Prose {
    fn of(source: &str) -> Self {
        let mut prose = Self::default();
        prose.visit_file(&syn::parse_file(source).expect("source"));
        prose
    }

    /// The texts among any tokens.
    fn loose(&mut self, input: ParseStream<'_>) -> syn::Result<()> {
        while !input.is_empty() {
            if input.peek(LitStr) {
                self.texts.push(input.parse::<LitStr>()?.value());
            } else if let Some(content) = group(input)? {
                self.loose(&content)?;
            } else {
                input.step(|cursor| {
                    cursor.token_tree().map(|(_, rest)| ((), rest)).ok_or_else(|| cursor.error("end"))
                })?;
            }
        }
        Ok(())
    }
}

/// What stands between brackets, if they are next.
fn group<'a>(input: ParseStream<'a>) -> syn::Result<Option<ParseBuffer<'a>>> {
    let content;
    if input.peek(token::Paren) {
        syn::parenthesized!(content in input);
    } else if input.peek(token::Brace) {
        syn::braced!(content in input);
    } else if input.peek(token::Bracket) {
        syn::bracketed!(content in input);
    } else {
        return Ok(None);
    }
    Ok(Some(content))
}

fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|a| {
        a.path().is_ident("test") || a.path().is_ident("cfg") && a.parse_args::<syn::Ident>().is_ok_and(|i| i == "test")
    })
}

/// Whether an expression is the text of an error or a warning, as far as its form tells.
fn is_said(receiver: &Expr) -> bool {
    let named = |name: &syn::Ident| SAID.contains(&name.to_string().as_str());
    match receiver {
        Expr::Path(path) => path.path.get_ident().is_some_and(named),
        Expr::Field(field) => matches!(&field.member, syn::Member::Named(name) if named(name)),
        Expr::MethodCall(call) => call.args.is_empty() && (call.method == "to_string" || call.method == "text"),
        Expr::Reference(of) => is_said(&of.expr),
        Expr::Paren(inner) => is_said(&inner.expr),
        _ => false,
    }
}

/// The fixed text that an argument is: a literal, or the name of a constant.
fn fixed(argument: &Expr) -> Option<String> {
    match argument {
        Expr::Lit(literal) => match &literal.lit {
            Lit::Str(text) => Some(text.value()),
            _ => None,
        },
        Expr::Path(path) => {
            let name = path.path.segments.last()?.ident.to_string();
            name.chars().all(|c| c.is_ascii_uppercase() || c == '_').then_some(name)
        }
        _ => None,
    }
}

impl<'a> Visit<'a> for Prose {
    fn visit_item_mod(&mut self, module: &'a ItemMod) {
        if !is_test(&module.attrs) {
            visit::visit_item_mod(self, module);
        }
    }

    fn visit_item_fn(&mut self, function: &'a ItemFn) {
        if !is_test(&function.attrs) {
            visit::visit_item_fn(self, function);
        }
    }

    fn visit_attribute(&mut self, attribute: &'a Attribute) {
        // Comments are attributes, too; of the others only this one is a text.
        if attribute.path().is_ident("error")
            && let Ok(arguments) = attribute.parse_args_with(Punctuated::<Expr, Token![,]>::parse_terminated)
        {
            arguments.iter().for_each(|argument| self.visit_expr(argument));
        }
    }

    fn visit_macro(&mut self, called: &'a Macro) {
        if let Ok(arguments) = called.parse_body_with(Punctuated::<Expr, Token![,]>::parse_terminated) {
            arguments.iter().for_each(|argument| self.visit_expr(argument));
        } else {
            // Of another grammar, such as that of `json!`.
            called.parse_body_with(|input: ParseStream<'_>| self.loose(input)).expect("tokens");
        }
    }

    fn visit_lit_str(&mut self, text: &'a LitStr) {
        self.texts.push(text.value());
    }

    fn visit_expr_method_call(&mut self, call: &'a ExprMethodCall) {
        let by_text = ["contains", "starts_with", "ends_with"].iter().any(|method| call.method == method);
        if by_text && is_said(&call.receiver) {
            self.decisions.extend(call.args.first().and_then(fixed));
        }
        visit::visit_expr_method_call(self, call);
    }
}

/// Whether a text names an option of a command line.
fn names_an_option(text: &str) -> bool {
    let is_name = |c: &u8| c.is_ascii_lowercase() || *c == b'-';
    text.match_indices("--").any(|(at, _)| {
        let name = &text.as_bytes()[at + 2..];
        name.first().is_some_and(u8::is_ascii_lowercase) && name.get(1).is_some_and(is_name)
    })
}

fn rust_files(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("folder").map(|e| e.expect("entry").path()) {
        if entry.is_dir() {
            rust_files(&entry, out);
        } else if entry.extension().is_some_and(|e| e == "rs") && entry.file_stem().is_some_and(|stem| stem != "tests")
        {
            out.push(entry);
        }
    }
}

/// Names of the sources of what is shipped, from the workspace's folder, and what they say.
fn shipped() -> Vec<(String, Prose)> {
    let root = belvedere_testkit::workspace_root();
    let mut files = Vec::new();
    for folder in ["crates", "apps"].map(|group| root.join(group)) {
        for entry in fs::read_dir(folder).expect("folder").map(|e| e.expect("entry")) {
            let source = entry.path().join("src");
            if source.is_dir() && entry.file_name() != "belvedere-testkit" {
                rust_files(&source, &mut files);
            }
        }
    }
    rust_files(&root.join("python/src"), &mut files);
    assert!(files.len() > 300, "only {} source files found", files.len());
    let read = |file: PathBuf| {
        let name = file.strip_prefix(&root).expect("below the root").to_string_lossy().replace('\\', "/");
        (name, Prose::of(&fs::read_to_string(file).expect("source")))
    };
    files.into_iter().map(read).collect()
}

#[test]
fn libraries_name_no_options_of_the_command_line() {
    let mut allowed = OPTIONS.to_vec();
    let mut found = Vec::new();
    for (file, prose) in shipped().into_iter().filter(|(file, _)| file.starts_with("crates/")) {
        for text in prose.texts.into_iter().filter(|text| names_an_option(text)) {
            match allowed.iter().position(|part| text.contains(part)) {
                Some(at) => drop(allowed.remove(at)),
                None => found.push(format!("{file}: {text}")),
            }
        }
    }
    assert_eq!(found, Vec::<String>::new(), "name a key, or the argument by `Advice`; the program names its option");
    assert_eq!(allowed, Vec::<&str>::new(), "no longer there");
}

#[test]
fn nothing_is_decided_by_the_text_of_an_error() {
    let mut allowed = DECISIONS.to_vec();
    let mut found = Vec::new();
    for (file, prose) in shipped() {
        for part in prose.decisions {
            match allowed.iter().position(|(name, text)| file.ends_with(name) && part == *text) {
                Some(at) => drop(allowed.remove(at)),
                None => found.push(format!("{file}: {part:?}")),
            }
        }
    }
    assert_eq!(found, Vec::<String>::new(), "give the error a kind or a key, and decide by that");
    assert_eq!(allowed, Vec::<(&str, &str)>::new(), "no longer there");
}

#[test]
fn options_and_decisions_are_found_wherever_they_stand() {
    let source = r#"
        /// Gives --all, see text.contains("x").
        #[derive(Error)]
        enum E { #[error("{0}; give --far")] Far(f64) }
        const MARK: &str = "mark";
        fn f(e: &E, reason: &str) -> String {
            if reason.starts_with("crs ") || e.to_string().contains(MARK) { return "leave \
                --up out".into(); }
            let at = matches!(e, E::Far(_)) && assert(reason.contains(['a', 'b']));
            json!({ "title": [1, "--json"] });
            format!("{}; --see WHAT", e.reason.ends_with("."))
        }
        #[cfg(test)]
        mod tests { fn g(e: E) { assert!(e.to_string().contains("give --far")); } }
    "#;
    let prose = Prose::of(source);
    let options: Vec<&String> = prose.texts.iter().filter(|text| names_an_option(text)).collect();
    assert_eq!(options, ["{0}; give --far", "leave --up out", "--json", "{}; --see WHAT"]);
    assert_eq!(prose.decisions, ["crs ", "MARK", "."]);
    assert!(!names_an_option("a -- b --- c --1 --x") && names_an_option("--to"));
}
