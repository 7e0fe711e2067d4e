//! Texts of lines that no first word tells.

/// Whether a text begins with lines of three numbers, perhaps behind a line of names.
pub(super) fn begins_as_points(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty()).peekable();
    if lines.peek().is_some_and(|line| line.starts_with(|c: char| c.is_ascii_alphabetic()) && words(line).count() == 3)
    {
        lines.next();
    }
    let is_triple = |line: &str| words(line).count() == 3 && words(line).all(|word| word.parse::<f64>().is_ok());
    let mut count = 0;
    lines.take(2).all(|line| {
        count += 1;
        is_triple(line)
    }) && count == 2
}

/// Words of a line, separated by white space, commas or semicolons.
pub(crate) fn words(line: &str) -> impl Iterator<Item = &str> {
    line.split(|c: char| c.is_whitespace() || c == ',' || c == ';').filter(|word| !word.is_empty())
}

/// Whether a text begins as a list of atoms: their number, a comment, and an element with its place.
pub(crate) fn begins_as_atoms(text: &str) -> bool {
    let mut lines = text.lines();
    let is_count = lines.next().is_some_and(|line| line.trim().parse::<u32>().is_ok());
    let is_atom = |line: &str| {
        let mut words = line.split_whitespace();
        let is_element =
            words.next().is_some_and(|word| word.len() <= 3 && word.starts_with(|c: char| c.is_ascii_alphanumeric()));
        is_element && words.clone().count() >= 3 && words.take(3).all(|word| word.parse::<f64>().is_ok())
    };
    is_count && lines.nth(1).is_some_and(is_atom)
}
