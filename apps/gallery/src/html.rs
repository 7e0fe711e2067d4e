//! Style and frame common to all generated pages.

/// Style of pages: light and dark, readable lines, pictures as wide as the page.
const STYLE: &str = ":root{color-scheme:light dark}body{font:17px/1.5 system-ui,sans-serif;max-width:84rem;margin:0 auto;\
padding:2.5rem 1.5rem;color:#222;background:#fafaf8}h1{font-size:2.1rem;margin:0}h2{font-size:1.35rem;margin:3rem 0 0}\
p{max-width:46rem;margin:.4rem 0 1rem}figure{margin:0}img{display:block;width:100%;height:auto;border-radius:6px}\
figcaption{display:grid;grid-template-columns:1fr 1fr;gap:.5rem;padding:.5rem 0;font-weight:600}\
.pair{display:grid;grid-template-columns:1fr 1fr;gap:.5rem;margin-top:.5rem}.pair figcaption{grid-column:1/3}\
.small{font-size:.9rem;color:#666;max-width:none}a{color:#1f5fa8}code{font-size:.95em}\
@media(prefers-color-scheme:dark){body{color:#e4e4e0;background:#191b1d}.small{color:#a0a4a8}a{color:#8bbdf0}}";

/// Style of tables, for pages that have some.
pub(crate) const TABLES: &str = "table{border-collapse:collapse;margin:.6rem 0 1.4rem;font-size:.9rem}td,th{padding:.2rem .7rem;\
text-align:right;border-bottom:1px solid #8884}th:first-child,td:first-child{text-align:left}";

/// A page: `title` of the window, `style` besides that of every page, and what it shows.
pub(crate) fn page(title: &str, style: &str, body: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>{title}</title>\n\
         <style>{STYLE}{style}</style>\n</head>\n<body>\n{body}</body>\n</html>\n"
    )
}

/// A picture that leads to its file; both texts for HTML.
pub(crate) fn picture(file: &str, says: &str) -> String {
    format!("<a href=\"{file}\"><img src=\"{file}\" alt=\"{says}\"></a>")
}

/// Text for HTML.
pub(crate) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('"', "&quot;").replace('<', "&lt;").replace('>', "&gt;")
}
