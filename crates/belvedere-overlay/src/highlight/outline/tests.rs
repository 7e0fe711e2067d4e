use super::*;

/// Six columns: a block of 3 x 3 and a speck.
fn mask() -> Vec<bool> {
    let rows = ["......", ".###..", ".###..", ".###..", "......", ".....#"];
    rows.iter().flat_map(|r| r.bytes().map(|c| c == b'#')).collect()
}

#[test]
fn specks_go_gaps_close_and_regions_stay() {
    let lines = |rows: &[&str], close, open| {
        let mask: Vec<bool> = rows.iter().flat_map(|r| r.bytes().map(|c| c == b'#')).collect();
        let out = regions(&mask, rows[0].len(), close, open);
        let text = |r: &[bool]| r.iter().map(|&v| if v { '#' } else { '.' }).collect::<String>();
        out.chunks(rows[0].len()).map(text).collect::<Vec<_>>()
    };
    let speck = ["......#", ".###...", ".###...", ".###...", "......."];
    assert_eq!(lines(&speck, 0, 1), [".......", ".###...", ".###...", ".###...", "......."]);
    assert_eq!(lines(&speck, 0, 0), speck);
    let [none, gap, whole] = ["...........", "..###.###..", "..#######.."];
    let gap = [none, none, gap, gap, gap, none, none];
    assert_eq!(lines(&gap, 1, 1), [none, none, whole, whole, whole, none, none]);
    assert_eq!(lines(&gap, 0, 1), gap);
    assert_eq!(regions(&[true; 12], 4, 5, 2), [true; 12]);
    assert_eq!(regions(&[], 0, 5, 2).len(), 0);
}

#[test]
fn spreading_is_what_looking_at_every_neighbour_finds() {
    // Bits without a pattern.
    let mask: Vec<bool> = (0u64..13 * 9).map(|i| i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 61 == 0).collect();
    for (reach, value) in [(1, true), (2, true), (1, false), (4, true), (20, false)] {
        let near = |i: usize| {
            let away = |k: usize| (k % 13).abs_diff(i % 13).pow(2) + (k / 13).abs_diff(i / 13).pow(2);
            let is_near = |k: &usize| away(*k) as f64 <= (reach as f64 + 0.5).powi(2);
            let found = (0..mask.len()).filter(is_near).any(|k| mask[k] == value);
            if found { value } else { !value }
        };
        let expected: Vec<bool> = (0..mask.len()).map(near).collect();
        assert_eq!(spread(&mask, 13, reach, value), expected, "{reach} {value}");
    }
}

#[test]
fn the_border_is_the_rim_of_the_region_and_not_that_of_the_picture() {
    let border = border(&mask(), 6);
    assert_eq!(border, [7, 8, 9, 13, 15, 19, 20, 21, 35]);
    assert_eq!(super::border(&[true; 12], 4), [] as [usize; 0]);
}
