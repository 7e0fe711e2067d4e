//! The schema of a database: what it holds, and the columns of a table out of the statement that made it.

use super::damaged;
use super::record::Value;
use std::borrow::Cow;

/// What an entry of the schema is. Indices and triggers are passed over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Table,
    Virtual,
    View,
}

/// An entry of the schema.
#[derive(Debug)]
pub(super) struct Object {
    pub(super) kind: Kind,
    pub(super) name: String,
    /// First page of its tree.
    pub(super) root: u32,
    /// The statement that made it.
    pub(super) sql: String,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    pub(super) name: String,
    /// Whether it stands for the number of the row.
    pub(super) is_row: bool,
    /// Whether it is the first of the primary key.
    pub(super) is_key: bool,
    /// Whether its whole numbers are numbers with a point.
    pub(super) is_real: bool,
    /// Whether rows hold it; others are computed.
    pub(super) is_stored: bool,
    is_text: bool,
    is_numeric: bool,
    default: Value<'static>,
}

impl Object {
    /// An entry out of a row of the schema.
    pub(super) fn of(values: &[Value<'_>]) -> Option<Self> {
        let [kind, name, _, root, sql, ..] = values else { return None };
        let sql = sql.text().unwrap_or_default().to_owned();
        let is_virtual = || tokens(&sql).nth(1).is_some_and(|token| token.is("virtual"));
        let kind = match kind.text()? {
            "table" if is_virtual() => Kind::Virtual,
            "table" => Kind::Table,
            "view" => Kind::View,
            _ => return None,
        };
        let root = root.integer().and_then(|root| u32::try_from(root).ok()).unwrap_or(0);
        Some(Self { kind, name: name.text()?.to_owned(), root, sql })
    }
}

impl Column {
    /// The value of rows that are older than the column.
    pub(super) fn default(&self) -> Value<'static> {
        match &self.default {
            Value::Text(text) if self.is_numeric || self.is_real => match (text.parse(), text.parse()) {
                (Ok(number), _) if !self.is_real => Value::Integer(number),
                (_, Ok(number)) => Value::Real(number),
                _ => self.default.clone(),
            },
            Value::Integer(number) if self.is_text => Value::Text(number.to_string().into()),
            Value::Real(number) if self.is_text => Value::Text(format!("{number:?}").into()),
            other => other.clone(),
        }
    }
}

/// A word, name, text, number or sign of a statement.
#[derive(Debug, Clone, PartialEq)]
struct Token<'s> {
    text: Cow<'s, str>,
    /// The quote around it; a blank for none.
    quote: char,
}

impl Token<'_> {
    /// Whether it is a word or sign, in any case of its letters.
    fn is(&self, word: &str) -> bool {
        self.quote == ' ' && self.text.eq_ignore_ascii_case(word)
    }

    fn is_one_of(&self, words: &[&str]) -> bool {
        words.iter().any(|word| self.is(word))
    }
}

/// The tokens of a statement, without blanks and comments.
fn tokens(sql: &str) -> impl Iterator<Item = Token<'_>> {
    let mut rest = sql;
    std::iter::from_fn(move || {
        loop {
            rest = rest.trim_start();
            let comment = match rest.get(..2) {
                Some("--") => "\n",
                Some("/*") => "*/",
                _ => break,
            };
            rest = rest[2..].split_once(comment).map_or("", |(_, after)| after);
        }
        let first = rest.chars().next()?;
        let close = match first {
            '"' | '\'' | '`' => first,
            '[' => ']',
            _ => {
                let is_word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '$' | '.');
                let end = rest.find(|c| !is_word(c)).unwrap_or(rest.len()).max(first.len_utf8());
                let (word, after) = rest.split_at(end);
                rest = after;
                return Some(Token { text: word.into(), quote: ' ' });
            }
        };
        let inner = &rest[1..];
        let mut at = 0;
        // A quote inside of a name or text stands twice.
        let end = loop {
            let Some(found) = inner[at..].find(close) else { break inner.len() };
            at += found + 1;
            if close == ']' || !inner[at..].starts_with(close) {
                break at - 1;
            }
            at += 1;
        };
        rest = inner.get(end + 1..).unwrap_or_default();
        let doubled: String = [close, close].iter().collect();
        let text = if close == ']' {
            inner[..end].into()
        } else {
            Cow::from(inner[..end].replace(&doubled, &close.to_string()))
        };
        Some(Token { text, quote: first })
    })
}

/// The columns of a table.
///
/// * `sql`: the statement that made it.
///
/// # Errors
/// A predicate for tables without row numbers, and for statements that are not understood.
pub(super) fn columns(sql: &str) -> Result<Vec<Column>, String> {
    let mut tokens = tokens(sql).skip_while(|token| !token.is("("));
    tokens.next();
    let (mut depth, mut parts) = (1, vec![Vec::new()]);
    for token in tokens.by_ref() {
        depth += i32::from(token.is("(")) - i32::from(token.is(")"));
        match parts.last_mut() {
            _ if depth == 0 => break,
            _ if depth == 1 && token.is(",") => parts.push(Vec::new()),
            Some(part) => part.push(token),
            None => {}
        }
    }
    if tokens.any(|token| token.is("without")) {
        return Err("is stored WITHOUT ROWID, which is not read; export it again".into());
    }
    let is_constraint =
        |part: &[Token<'_>]| part[0].is_one_of(&["constraint", "primary", "unique", "check", "foreign"]);
    let parts: Vec<Vec<Token<'_>>> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    let mut columns: Vec<Column> = parts.iter().filter(|part| !is_constraint(part)).map(|part| column(part)).collect();
    for part in parts.iter().filter(|part| is_constraint(part)) {
        let Some(at) = part.windows(2).position(|pair| pair[0].is("primary") && pair[1].is("key")) else { continue };
        let names: Vec<&Token<'_>> = part[at + 2..].iter().skip(1).take_while(|token| !token.is(")")).collect();
        let first = names.first().and_then(|name| columns.iter_mut().find(|c| c.name.eq_ignore_ascii_case(&name.text)));
        if let Some(column) = first {
            column.is_key = true;
            let alone = !names.iter().any(|token| token.is(","));
            // Only such a column was given this mark; see `column`.
            column.is_row = alone && column.is_row;
        }
    }
    columns.iter_mut().for_each(|column| column.is_row &= column.is_key);
    if columns.is_empty() {
        return Err(damaged("the statement of a table names no columns"));
    }
    Ok(columns)
}

/// A column by its definition. One of the type INTEGER is marked as the row's number; it is if it is the key.
fn column(part: &[Token<'_>]) -> Column {
    const CONSTRAINTS: [&str; 11] = [
        "constraint",
        "primary",
        "not",
        "null",
        "unique",
        "check",
        "default",
        "collate",
        "references",
        "generated",
        "as",
    ];
    let rest = part.get(1..).unwrap_or_default();
    let split = rest.iter().position(|token| token.is_one_of(&CONSTRAINTS)).unwrap_or(rest.len());
    let (kind, rules) = rest.split_at(split);
    let kind: Vec<String> = kind.iter().map(|token| token.text.to_ascii_uppercase()).collect();
    let kind = kind.join(" ");
    let has = |words: &[&str]| words.iter().any(|word| kind.contains(word));
    let is_integer = has(&["INT"]);
    let is_text = !is_integer && has(&["CHAR", "CLOB", "TEXT"]);
    let is_blob = !is_integer && !is_text && (has(&["BLOB"]) || kind.is_empty());
    let is_real = !is_integer && !is_text && !is_blob && has(&["REAL", "FLOA", "DOUB"]);
    let key = rules.windows(2).position(|pair| pair[0].is("primary") && pair[1].is("key"));
    let falls = key.and_then(|at| rules.get(at + 2)).is_some_and(|token| token.is("desc"));
    let computed = rules.iter().any(|token| token.is("as"));
    let default = rules.iter().position(|token| token.is("default"));
    Column {
        name: part[0].text.clone().into_owned(),
        is_row: kind == "INTEGER" && !falls,
        is_key: key.is_some(),
        is_real,
        is_stored: !computed || rules.iter().any(|token| token.is("stored")),
        is_text,
        is_numeric: !is_text && !is_blob && !is_real,
        default: default.map_or(Value::Null, |at| literal(&rules[at + 1..])),
    }
}

/// The value of a plain number, text or binary.
fn literal(tokens: &[Token<'_>]) -> Value<'static> {
    let (sign, tokens) = match tokens {
        [minus, rest @ ..] if minus.is("-") => (-1, rest),
        [plus, rest @ ..] if plus.is("+") => (1, rest),
        _ => (1, tokens),
    };
    match tokens {
        [mark, bytes, ..] if mark.is("x") && bytes.quote == '\'' => {
            let digit = |c: &u8| char::from(*c).to_digit(16).unwrap_or(0) as u8;
            Value::Blob(
                bytes.text.as_bytes().chunks(2).map(|pair| pair.iter().fold(0, |n, c| n << 4 | digit(c))).collect(),
            )
        }
        [token, ..] if matches!(token.quote, '\'' | '"') => Value::Text(token.text.clone().into_owned().into()),
        [token, ..] if token.is("true") || token.is("false") => Value::Integer(token.is("true").into()),
        _ => number(tokens, sign),
    }
}

/// The value of a number without its sign; none for words.
fn number(tokens: &[Token<'_>], sign: i64) -> Value<'static> {
    let Some(first) = tokens.first() else { return Value::Null };
    // The sign of an exponent is a token of its own.
    let is_open = first.text.ends_with(['e', 'E']) && first.text.starts_with(|c: char| c.is_ascii_digit() || c == '.');
    let text: String = tokens.iter().take(if is_open { 3 } else { 1 }).map(|token| token.text.as_ref()).collect();
    match (text.parse::<i64>(), text.parse::<f64>()) {
        (Ok(number), _) => Value::Integer(sign * number),
        (_, Ok(number)) if number.is_finite() => Value::Real(sign as f64 * number),
        _ => Value::Null,
    }
}
