use super::*;

/// The characters from left to right; capitals stand for Hebrew letters, mirrored signs stay as they are.
fn shown(text: &str) -> String {
    let hebrew = |c: char| char::from_u32(0x5d0 + c as u32 - 'A' as u32).expect("a letter");
    let chars: Vec<char> = text.chars().map(|c| if c.is_ascii_uppercase() { hebrew(c) } else { c }).collect();
    let back: Vec<char> = text.chars().collect();
    let levels = levels(&chars);
    let runs = visual(&levels).into_iter().flat_map(|run| {
        let right_to_left = levels[run.start] % 2 == 1;
        let order: Vec<usize> = if right_to_left { run.rev().collect() } else { run.collect() };
        order
    });
    runs.map(|i| back[i]).collect()
}

#[test]
fn mixed_lines_run_as_the_standard_says() {
    // Examples of the standard, in its notation: capitals run to the left.
    assert_eq!(shown("car is THE CAR in arabic"), "car is RAC EHT in arabic");
    assert_eq!(shown("THE CAR"), "RAC EHT");
    assert_eq!(shown("HAR 2814 m"), "m 2814 RAH");
    assert_eq!(shown("he said THE VALUES ARE 123, 456, 789, OK"), "he said KO ,789 ,456 ,123 ERA SEULAV EHT");
    assert_eq!(shown("A 12-34 B"), "B 12-34 A");
    assert_eq!(shown("plain, 1:2"), "plain, 1:2");
    assert_eq!(shown(""), "");
    assert_eq!(shown("mont (HAR)"), "mont (RAH)");
    assert_eq!(shown("HAR  "), "  RAH");
    // Brackets are mirrored when they are drawn.
    assert_eq!(shown("mt HAR (12)"), "mt )12( RAH");
    assert_eq!(shown("mt HAR (b) x"), "mt RAH (b) x");
    assert_eq!(shown("HAR (ab)"), ")ab( RAH");
    assert_eq!(shown("HAR (ab) ["), "[ )ab( RAH");
}

#[test]
fn arabic_numbers_run_to_the_right_and_marks_stay_with_their_letters() {
    let text: Vec<char> = "جبل ١٢٣".chars().collect();
    assert_eq!(levels(&text), [1, 1, 1, 1, 2, 2, 2]);
    let text: Vec<char> = "ש\u{5b8}a\u{301}".chars().collect();
    assert_eq!(levels(&text), [1, 1, 2, 2]);
    // Devanagari vowel signs stay in their words.
    let text: Vec<char> = "सगरमाथा".chars().collect();
    assert!(levels(&text).iter().all(|level| *level == 0));
}
