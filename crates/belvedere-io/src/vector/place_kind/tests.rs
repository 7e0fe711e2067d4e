use super::*;

fn of(pairs: &[(&str, &str)]) -> BTreeMap<String, String> {
    pairs.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect()
}

#[test]
fn kinds_are_told_by_tags_and_by_words_but_not_by_parts_of_words() {
    for (pairs, wanted) in [
        (&[("natural", "peak"), ("name", "a")][..], Some(PlaceKind::Peak)),
        (&[("natural", "saddle")], Some(PlaceKind::Pass)),
        (&[("tourism", "alpine_hut")], Some(PlaceKind::Hut)),
        (&[("place", "village"), ("population", "120")], Some(PlaceKind::Village)),
        (&[("fclass", "peak")], Some(PlaceKind::Peak)),
        (&[("FEATURECLA", "Mountain")], Some(PlaceKind::Peak)),
        (&[("featurecla", "Mountain pass")], Some(PlaceKind::Pass)),
        (&[("Objektart", "Gipfel")], Some(PlaceKind::Peak)),
        (&[("type", "Passau")], None),
        (&[("kind", "carpet")], None),
        (&[("name", "peak")], None),
        (&[], None),
    ] {
        assert_eq!(place_kind(&of(pairs)), wanted, "{pairs:?}");
    }
}

#[test]
fn heights_and_people_are_read_as_they_are_written() {
    for (text, wanted) in [
        ("2864,4", Some(2864.4)),
        ("2,864", Some(2864.0)),
        ("1,234.5", Some(1234.5)),
        ("4'478 m", Some(4478.0)),
        ("10000 ft", Some(3048.0)),
        (" -12 ", Some(-12.0)),
        ("12;13", None),
        ("high", None),
        ("", None),
        ("1e999", None),
        (".", None),
    ] {
        assert_eq!(number(text).map(|v| (v * 1e6).round() / 1e6), wanted, "{text}");
    }
    assert_eq!(stated_height(&of(&[("Elevation", "3 007")])), Some(3007.0));
    assert_eq!(stated_height(&of(&[("ele", "99999")])), None);
    assert_eq!(stated_people(&of(&[("population", "0"), ("POP_MAX", "12,345")])), Some(12345.0));
}
