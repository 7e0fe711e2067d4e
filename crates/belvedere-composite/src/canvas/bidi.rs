//! Order of letters of a line with scripts of both directions: the implicit rules of the Unicode bidirectional algorithm (UAX #9: P2, W1 to
//! W7, N0 to N2, I1, I2, L1, L2). Signs that state a direction are no part of names and are left out.

/// Class of a character.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Class {
    Left,
    Right,
    Arabic,
    Number,
    ArabicNumber,
    Sign,
    Currency,
    Separator,
    Mark,
    Neutral,
}

/// Whether a sign only states a direction: embeddings, overrides, isolates.
pub(super) fn states_direction(c: char) -> bool {
    matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Whether a sign belongs to the letter before it.
pub(super) fn is_mark(c: char) -> bool {
    class(c) == Class::Mark
}

fn class(c: char) -> Class {
    match c {
        '0'..='9' | '\u{6f0}'..='\u{6f9}' => Class::Number,
        '\u{660}'..='\u{669}' | '\u{66b}' | '\u{66c}' | '\u{600}'..='\u{605}' | '\u{6dd}' => Class::ArabicNumber,
        '+' | '-' | '\u{2212}' => Class::Sign,
        '#'..='%' | '\u{a2}'..='\u{a5}' | '\u{b0}' | '\u{b1}' | '\u{66a}' | '\u{2030}'..='\u{2034}' => Class::Currency,
        '\u{20a0}'..='\u{20cf}' => Class::Currency,
        ',' | '.' | '/' | ':' | '\u{a0}' | '\u{60c}' | '\u{202f}' | '\u{2044}' => Class::Separator,
        '\u{200e}' => Class::Left,
        '\u{200f}' => Class::Right,
        '\u{61c}' => Class::Arabic,
        // Marks over letters take the direction of their letter; those of scripts from left to right do so in any class.
        '\u{300}'..='\u{36f}' | '\u{483}'..='\u{489}' | '\u{1ab0}'..='\u{1aff}' | '\u{1dc0}'..='\u{1dff}' => {
            Class::Mark
        }
        '\u{20d0}'..='\u{20ff}' | '\u{fe00}'..='\u{fe0f}' | '\u{fe20}'..='\u{fe2f}' | '\u{200c}' | '\u{200d}' => {
            Class::Mark
        }
        '\u{591}'..='\u{5bd}' | '\u{5bf}' | '\u{5c1}' | '\u{5c2}' | '\u{5c4}' | '\u{5c5}' | '\u{5c7}' => Class::Mark,
        '\u{610}'..='\u{61a}' | '\u{64b}'..='\u{65f}' | '\u{670}' | '\u{6d6}'..='\u{6dc}' | '\u{6df}'..='\u{6e4}' => {
            Class::Mark
        }
        '\u{6e7}' | '\u{6e8}' | '\u{6ea}'..='\u{6ed}' | '\u{711}' | '\u{730}'..='\u{74a}' | '\u{7a6}'..='\u{7b0}' => {
            Class::Mark
        }
        '\u{8ca}'..='\u{8e1}' | '\u{8e3}'..='\u{8ff}' | '\u{fb1e}' => Class::Mark,
        '\u{600}'..='\u{7bf}' | '\u{860}'..='\u{8ff}' | '\u{fb50}'..='\u{fdff}' | '\u{fe70}'..='\u{fefe}' => {
            Class::Arabic
        }
        '\u{590}'..='\u{5ff}' | '\u{7c0}'..='\u{85f}' | '\u{fb1d}'..='\u{fb4f}' => Class::Right,
        '\u{10d00}'..='\u{10d3f}' | '\u{10ec0}'..='\u{10eff}' | '\u{10f30}'..='\u{10f6f}' => Class::Arabic,
        '\u{1ec70}'..='\u{1ecbf}' | '\u{1ed00}'..='\u{1ed4f}' | '\u{1ee00}'..='\u{1eeff}' => Class::Arabic,
        '\u{10800}'..='\u{10fff}' | '\u{1e800}'..='\u{1efff}' => Class::Right,
        c if c.is_alphanumeric() => Class::Left,
        // Vowel signs of Indic scripts stand in words from left to right.
        '\u{900}'..='\u{1cff}' => Class::Left,
        _ => Class::Neutral,
    }
}

/// Embedding levels of the characters of one line: even ones run to the right, odd ones to the left.
pub(super) fn levels(text: &[char]) -> Vec<u8> {
    let first: Vec<Class> = text.iter().map(|c| class(*c)).collect();
    let strong = first.iter().find(|c| matches!(c, Class::Left | Class::Right | Class::Arabic));
    let base = u8::from(matches!(strong, Some(Class::Right | Class::Arabic)));
    let own = if base == 1 { Class::Right } else { Class::Left };
    let mut kinds = first;
    weak(&mut kinds, own);
    brackets(&mut kinds, text, own);
    neutral(&mut kinds, own);
    let mut levels: Vec<u8> = kinds
        .iter()
        .map(|kind| match (kind, base) {
            (Class::Right, 0) | (Class::Left | Class::Number | Class::ArabicNumber, 1) => base + 1,
            (Class::Number | Class::ArabicNumber, _) => base + 2,
            _ => base,
        })
        .collect();
    // Blanks at the end stand at the end of the line.
    for (level, _) in levels.iter_mut().zip(text).rev().take_while(|(_, c)| c.is_whitespace()) {
        *level = base;
    }
    levels
}

/// Marks, numbers and what stands beside numbers.
fn weak(kinds: &mut [Class], own: Class) {
    let (mut before, mut strong) = (own, own);
    for kind in kinds.iter_mut() {
        if *kind == Class::Mark {
            *kind = before;
        }
        before = *kind;
        match *kind {
            Class::Left | Class::Right | Class::Arabic => strong = *kind,
            Class::Number if strong == Class::Arabic => *kind = Class::ArabicNumber,
            _ => {}
        }
    }
    for kind in kinds.iter_mut().filter(|kind| **kind == Class::Arabic) {
        *kind = Class::Right;
    }
    for i in 1..kinds.len().saturating_sub(1) {
        let (a, b) = (kinds[i - 1], kinds[i + 1]);
        kinds[i] = match kinds[i] {
            Class::Sign if a == Class::Number && b == a => a,
            Class::Separator if matches!(a, Class::Number | Class::ArabicNumber) && b == a => a,
            kind => kind,
        };
    }
    let mut at = 0;
    while at < kinds.len() {
        let end = at + kinds[at..].iter().take_while(|kind| **kind == Class::Currency).count();
        if end > at {
            let beside = [at.checked_sub(1), Some(end)].into_iter().flatten().filter_map(|i| kinds.get(i));
            let number = beside.into_iter().any(|kind| *kind == Class::Number);
            kinds[at..end].fill(if number { Class::Number } else { Class::Neutral });
        }
        at = end.max(at + 1);
    }
    let mut strong = own;
    for kind in kinds {
        match *kind {
            Class::Sign | Class::Separator => *kind = Class::Neutral,
            Class::Left | Class::Right => strong = *kind,
            Class::Number if strong == Class::Left => *kind = Class::Left,
            _ => {}
        }
    }
}

/// Brackets of a pair take one direction: that of the line if anything inside has it, else that of what is inside where it also stands before.
fn brackets(kinds: &mut [Class], text: &[char], own: Class) {
    const PAIRS: [(char, char); 6] = [('(', ')'), ('[', ']'), ('{', '}'), ('（', '）'), ('「', '」'), ('【', '】')];
    let mut open: Vec<(char, usize)> = Vec::new();
    let mut pairs: Vec<[usize; 2]> = Vec::new();
    for (i, c) in text.iter().enumerate().filter(|(i, _)| kinds[*i] == Class::Neutral) {
        if let Some((_, close)) = PAIRS.iter().find(|(first, _)| first == c) {
            open.push((*close, i));
        } else if let Some(at) = open.iter().rposition(|(close, _)| close == c) {
            pairs.push([open[at].1, i]);
            open.truncate(at);
        }
    }
    pairs.sort_unstable();
    let side = |kind: Class| match kind {
        Class::Left => Some(Class::Left),
        Class::Right | Class::Number | Class::ArabicNumber => Some(Class::Right),
        _ => None,
    };
    for [from, to] in pairs {
        let inside = |wanted: bool| kinds[from + 1..to].iter().filter_map(|k| side(*k)).any(|k| (k == own) == wanted);
        let before = kinds[..from].iter().rev().find_map(|kind| side(*kind)).unwrap_or(own);
        let direction = match (inside(true), inside(false)) {
            (true, _) => own,
            (false, true) => before,
            (false, false) => continue,
        };
        (kinds[from], kinds[to]) = (direction, direction);
    }
}

/// Neutral characters take the direction of what stands on both sides, else that of the line.
fn neutral(kinds: &mut [Class], own: Class) {
    let side = |kind: Class| if kind == Class::Left { Class::Left } else { Class::Right };
    let mut at = 0;
    while at < kinds.len() {
        let end = at + kinds[at..].iter().take_while(|kind| **kind == Class::Neutral).count();
        if end > at {
            let before = at.checked_sub(1).map_or(own, |i| side(kinds[i]));
            let after = kinds.get(end).map_or(own, |kind| side(*kind));
            kinds[at..end].fill(if before == after { before } else { own });
        }
        at = end.max(at + 1);
    }
}

/// Runs of one level in the order from left to right.
pub(super) fn visual(levels: &[u8]) -> Vec<std::ops::Range<usize>> {
    let mut runs: Vec<std::ops::Range<usize>> = Vec::new();
    for i in 0..levels.len() {
        match runs.last_mut() {
            Some(run) if levels[run.start] == levels[i] => run.end = i + 1,
            _ => runs.push(i..i + 1),
        }
    }
    let level = |run: &std::ops::Range<usize>| levels[run.start];
    for least in (1..=levels.iter().copied().max().unwrap_or(0)).rev() {
        let mut at = 0;
        while at < runs.len() {
            let end = at + runs[at..].iter().take_while(|run| level(run) >= least).count();
            runs[at..end].reverse();
            at = end.max(at + 1);
        }
    }
    runs
}

#[cfg(test)]
mod tests;
