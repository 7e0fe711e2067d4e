//! The field that names features.

/// Usual fields of names, the best first: words for name in many languages, and those of wide-spread collections. Letters and digits
/// alone, in lower case.
const USUAL: [&str; 45] = [
    "name",
    "nameen",
    "intname",
    "title",
    "label",
    "nom",
    "nombre",
    "nome",
    "namn",
    "navn",
    "naam",
    "nazwa",
    "nazev",
    "název",
    "nazov",
    "názov",
    "naziv",
    "ime",
    "nimi",
    "nev",
    "név",
    "nume",
    "isim",
    "isimler",
    "nama",
    "tên",
    "название",
    "наименование",
    "имя",
    "назва",
    "име",
    "όνομα",
    "ονομα",
    "名称",
    "名稱",
    "名前",
    "이름",
    "bezeichnung",
    "bezeichnun",
    "bezeichn",
    "toponym",
    "toponimo",
    "topónimo",
    "titulo",
    "título",
];
/// Words for name, which stand with others in the names of fields (`naam_nl`, `NAMN1`, `NAZ_OBJ`, `gnis_name`, `NOM_VOIE`).
const WORDS: [&str; 20] = [
    "name",
    "fullname",
    "lakename",
    "nom",
    "nombre",
    "nome",
    "namn",
    "navn",
    "naam",
    "nazwa",
    "naz",
    "nazev",
    "naziv",
    "nimi",
    "bezeichnung",
    "toponym",
    "название",
    "имя",
    "όνομα",
    "名称",
];
/// Words of fields whose names are of something else.
const OTHERS: [&str; 12] =
    ["file", "layer", "user", "table", "path", "space", "class", "type", "key", "alt", "old", "id"];
/// Fields that name where no other does.
const LAST: [&str; 3] = ["ref", "gn", "etiket"];

/// The field that names features among these, if any: a usual one in any spelling (`NAME`, `Naam`, `name:en`, `BEZEICHN`), else the
/// first in which a word for name stands among others (`NAME_1`, `naam_nl`, `gnis_name`), but not with one for something else
/// (`file_name`), else a reference.
pub fn name_field<'k>(keys: impl Iterator<Item = &'k str> + Clone) -> Option<&'k str> {
    let plain =
        |key: &str| key.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect::<String>();
    let one_of = |fields: &[&str]| fields.iter().find_map(|field| keys.clone().find(|k| plain(k) == *field));
    let numbered =
        || USUAL.iter().find_map(|f| keys.clone().find(|k| plain(k).trim_end_matches(char::is_numeric) == *f));
    one_of(&USUAL).or_else(numbered).or_else(|| keys.clone().find(|key| names(key))).or_else(|| one_of(&LAST))
}

/// Whether a word for name stands among the words of a field.
fn names(field: &str) -> bool {
    let lower = field.to_lowercase();
    let words = || lower.split(|c: char| !c.is_alphabetic()).filter(|word| !word.is_empty());
    let other = |word: &str| {
        OTHERS.iter().any(|o| word == *o || (word.len() > o.len() && word.starts_with(o) && word.ends_with("name")))
    };
    let named = |word: &str| WORDS.contains(&word) || (word.ends_with("name") && word.is_ascii());
    words().any(named) && !words().any(other)
}

#[cfg(test)]
mod tests;
