//! Finds the expressions of the library code in which a fault can be planted, with the text that replaces each.

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::path::{Path, PathBuf};
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Attribute, BinOp, Expr, Item, Lit, RangeLimits, Stmt, UnOp};

/// One small change of the source.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Fault {
    /// Package it is planted in.
    pub(crate) package: String,
    /// File, relative to the workspace.
    pub(crate) file: PathBuf,
    /// Line of the file, from 1.
    pub(crate) line: usize,
    /// Path of its module inside the crate, `a::b`; empty for the root.
    pub(crate) module: String,
    /// Bytes of the file that are replaced.
    pub(crate) bytes: Range<usize>,
    /// The original text.
    pub(crate) original: String,
    /// The text that takes its place when the fault is switched on.
    pub(crate) mutated: String,
    /// Whether it replaces a whole statement, not a value.
    pub(crate) statement: bool,
}

/// Every fault that can be planted in the crate whose root is the file `root`, in the order of the source.
///
/// Only modules reachable from the root are read, so tests and files that are not compiled are left out.
pub(crate) fn faults(workspace: &Path, package: &str, root: &Path) -> Result<Vec<Fault>> {
    let mut found = Vec::new();
    let folder = root.parent().context("a source file lies in a folder")?;
    let mut files = vec![(root.to_owned(), folder.to_owned(), String::new())];
    while let Some((path, children, module)) = files.pop() {
        let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        let file = path.strip_prefix(workspace)?.to_owned();
        let mut finder = Finder::new(&text, module);
        finder.visit_file(&syn::parse_file(&text).with_context(|| path.display().to_string())?);
        found.extend(finder.found.into_iter().map(|f| Fault { package: package.to_owned(), file: file.clone(), ..f }));
        for module in finder.files {
            let base = children.join(module.rsplit("::").next().unwrap_or_default());
            let flat = base.with_extension("rs");
            files.push((if flat.exists() { flat } else { base.join("mod.rs") }, base, module));
        }
    }
    found.sort_by(|a, b| (&a.file, a.bytes.start).cmp(&(&b.file, b.bytes.start)));
    Ok(found)
}

struct Finder<'a> {
    text: &'a str,
    module: String,
    found: Vec<Fault>,
    /// Modules that lie in files of their own.
    files: Vec<String>,
}

impl<'a> Finder<'a> {
    fn new(text: &'a str, module: String) -> Self {
        Self { text, module, found: Vec::new(), files: Vec::new() }
    }

    fn source(&self, node: &impl Spanned) -> &'a str {
        &self.text[node.span().byte_range()]
    }

    fn add(&mut self, node: &impl Spanned, mutated: String, statement: bool) {
        let bytes = node.span().byte_range();
        self.found.push(Fault {
            package: String::new(),
            file: PathBuf::new(),
            line: node.span().start().line,
            module: self.module.clone(),
            original: self.text[bytes.clone()].to_owned(),
            bytes,
            mutated,
            statement,
        });
    }

    fn binary(&mut self, whole: &Expr, e: &syn::ExprBinary) {
        let others: &[&str] = match e.op {
            BinOp::Lt(_) => &["<=", ">="],
            BinOp::Le(_) => &["<", ">"],
            BinOp::Gt(_) => &[">=", "<="],
            BinOp::Ge(_) => &[">", "<"],
            BinOp::Eq(_) => &["!="],
            BinOp::Ne(_) => &["=="],
            BinOp::Add(_) => &["-"],
            BinOp::Sub(_) => &["+"],
            BinOp::Mul(_) => &["/"],
            BinOp::Div(_) => &["*"],
            BinOp::AddAssign(_) => &["-="],
            BinOp::SubAssign(_) => &["+="],
            BinOp::MulAssign(_) => &["/="],
            BinOp::DivAssign(_) => &["*="],
            BinOp::And(_) if !binds(&e.left) && !binds(&e.right) => &["||"],
            BinOp::Or(_) => &["&&"],
            _ => &[],
        };
        for other in others {
            self.add(whole, format!("({}) {other} ({})", self.source(&e.left), self.source(&e.right)), false);
        }
    }

    fn literal(&mut self, e: &syn::ExprLit) {
        match &e.lit {
            Lit::Bool(b) => self.add(e, (!b.value).to_string(), false),
            Lit::Int(n) => {
                if let Ok(value) = n.base10_parse::<u64>() {
                    self.add(e, format!("{}{}", value + 1, n.suffix()), false);
                }
            }
            Lit::Float(x) => {
                // Tolerances are chosen, not derived, so a tolerance a quarter larger is no fault.
                if let Ok(value) = x.base10_parse::<f64>()
                    && (value == 0.0 || value > 1e-5)
                {
                    let nudged = if value == 0.0 { 1.0 } else { 1.25 * value };
                    self.add(e, format!("{nudged:?}{}", x.suffix()), false);
                }
            }
            _ => {}
        }
    }

    fn method(&mut self, whole: &Expr, call: &syn::ExprMethodCall) {
        let other = match (call.method.to_string().as_str(), call.args.len()) {
            ("min", 1) => "max",
            ("max", 1) => "min",
            ("floor", 0) => "ceil",
            ("ceil", 0) => "floor",
            _ => return,
        };
        let (start, name) = (whole.span().byte_range().start, call.method.span().byte_range());
        let mut mutated = self.source(whole).to_owned();
        mutated.replace_range(name.start - start..name.end - start, other);
        self.add(whole, mutated, false);
    }
}

/// Whether a condition binds names (`if let`). Such a condition cannot be moved into another expression.
fn binds(e: &Expr) -> bool {
    match e {
        Expr::Let(_) => true,
        Expr::Binary(b) => binds(&b.left) || binds(&b.right),
        _ => false,
    }
}

fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|a| {
        let says_test = || a.meta.require_list().is_ok_and(|l| l.tokens.to_string() == "test");
        a.path().is_ident("test") || a.path().is_ident("cfg") && says_test()
    })
}

impl<'ast> Visit<'ast> for Finder<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        let skipped = match item {
            Item::Const(_) | Item::Static(_) | Item::Macro(_) => true,
            Item::Fn(f) => f.sig.constness.is_some() || is_test(&f.attrs),
            Item::Impl(i) => is_test(&i.attrs),
            Item::Mod(m) => is_test(&m.attrs),
            _ => false,
        };
        if !skipped {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        let outer = self.module.clone();
        self.module = if outer.is_empty() { item.ident.to_string() } else { format!("{outer}::{}", item.ident) };
        match item.content {
            Some(_) => visit::visit_item_mod(self, item),
            None => self.files.push(self.module.clone()),
        }
        self.module = outer;
    }

    fn visit_impl_item_fn(&mut self, f: &'ast syn::ImplItemFn) {
        if f.sig.constness.is_none() && !is_test(&f.attrs) {
            visit::visit_impl_item_fn(self, f);
        }
    }

    // Constants, types, patterns and attributes contain no code that runs.
    fn visit_impl_item_const(&mut self, _: &'ast syn::ImplItemConst) {}
    fn visit_trait_item_const(&mut self, _: &'ast syn::TraitItemConst) {}
    fn visit_expr_const(&mut self, _: &'ast syn::ExprConst) {}
    fn visit_expr_repeat(&mut self, e: &'ast syn::ExprRepeat) {
        self.visit_expr(&e.expr);
    }
    fn visit_variant(&mut self, _: &'ast syn::Variant) {}
    fn visit_generics(&mut self, _: &'ast syn::Generics) {}
    fn visit_path(&mut self, _: &'ast syn::Path) {}
    fn visit_angle_bracketed_generic_arguments(&mut self, _: &'ast syn::AngleBracketedGenericArguments) {}
    fn visit_type(&mut self, _: &'ast syn::Type) {}
    fn visit_pat(&mut self, _: &'ast syn::Pat) {}
    fn visit_attribute(&mut self, _: &'ast Attribute) {}

    fn visit_stmt(&mut self, s: &'ast Stmt) {
        if let Stmt::Expr(Expr::Call(_) | Expr::MethodCall(_) | Expr::Try(_), Some(_)) = s {
            self.add(s, String::new(), true);
        }
        visit::visit_stmt(self, s);
    }

    fn visit_expr(&mut self, e: &'ast Expr) {
        match e {
            Expr::Binary(b) => self.binary(e, b),
            Expr::Lit(l) => self.literal(l),
            Expr::MethodCall(call) => self.method(e, call),
            Expr::If(i) if !binds(&i.cond) => self.add(&i.cond, format!("!({})", self.source(&i.cond)), false),
            Expr::Unary(u) if matches!(u.op, UnOp::Not(_)) => self.add(e, self.source(&u.expr).to_owned(), false),
            Expr::Range(r) => {
                // `a..b` and `a..=b` have different types, so the end is moved by one instead.
                if let Some(end) = &r.end {
                    let sign = if matches!(r.limits, RangeLimits::HalfOpen(_)) { '+' } else { '-' };
                    self.add(end, format!("({}) {sign} 1", self.source(end)), false);
                }
            }
            _ => {}
        }
        visit::visit_expr(self, e);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> Vec<(usize, String, String)> {
        let mut finder = Finder::new(text, String::new());
        finder.visit_file(&syn::parse_file(text).expect("Rust"));
        finder.found.into_iter().map(|f| (f.line, f.original, f.mutated)).collect()
    }

    fn changes(body: &str) -> Vec<(String, String)> {
        let text = format!("fn f() {{ {body} }}");
        found(&text).into_iter().map(|(_, original, mutated)| (original, mutated)).collect()
    }

    fn pair(original: &str, mutated: &str) -> (String, String) {
        (original.into(), mutated.into())
    }

    #[test]
    fn operators_literals_and_calls_change() {
        assert_eq!(changes("a < b"), [pair("a < b", "(a) <= (b)"), pair("a < b", "(a) >= (b)")]);
        assert_eq!(
            changes("a += b.min(c);"),
            [pair("a += b.min(c)", "(a) -= (b.min(c))"), pair("b.min(c)", "b.max(c)")]
        );
        assert_eq!(changes("return 0.0;"), [pair("0.0", "1.0")]);
        assert_eq!(changes("if !a {}"), [pair("!a", "!(!a)"), pair("!a", "a")]);
        assert_eq!(changes("a..n"), [pair("n", "(n) + 1")]);
        assert_eq!(changes("push(x);"), [pair("push(x);", "")]);
    }

    #[test]
    fn conditions_that_bind_stay_whole() {
        assert_eq!(changes("if let Some(x) = y && x != z {}"), [pair("x != z", "(x) == (z)")]);
    }

    #[test]
    fn tests_constants_patterns_and_types_are_left_alone() {
        let text = "const A: usize = 1 + 2;\nconst fn g() -> bool { 1 < 2 }\n#[cfg(test)]\nmod tests { fn f() { 1 + 1; } }\n\
                    #[test]\nfn t() { 1 + 1; }\nfn f(x: [u8; 3]) { match x[0] { 1..3 => {}, 7 => {}, _ => {} } [y; 4]; m!(1 + 2); }";
        assert_eq!(found(text), [(7, "0".to_owned(), "1".to_owned())]);
    }
}
