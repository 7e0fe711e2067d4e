use super::*;

/// One text in every encoding that can express it, with its declaration.
#[test]
fn a_declared_encoding_is_believed() {
    for (label, word) in [
        ("ISO-8859-1", "Tälchenweg"),
        ("iso-8859-2", "Łysa Góra"),
        ("windows-1250", "Říp"),
        ("Windows-1251", "Эльбрус"),
        ("KOI8-R", "Эльбрус"),
        ("Shift_JIS", "富士山"),
        ("GB2312", "黄山"),
        ("EUC-KR", "한라산"),
        ("UTF-8", "Tälchenweg 富士山"),
    ] {
        let text = format!("<?xml version='1.0' encoding='{label}'?><gpx>{word}</gpx>");
        let encoding = Encoding::for_label(label.as_bytes()).expect("known");
        let (bytes, _, lost) = encoding.encode(&text);
        assert!(!lost, "{label}");
        let mut warnings = Vec::new();
        assert_eq!(text_of(&bytes, &mut warnings), text, "{label}");
        assert_eq!(warnings, Vec::<Warning>::new(), "{label}");
    }
}

#[test]
fn text_of_two_bytes_is_read_with_a_mark_and_without() {
    let text = "<?xml version=\"1.0\" encoding=\"UTF-16\"?><gpx>Tälchen</gpx>";
    for (mark, unit) in [([0xff, 0xfe], u16::to_le_bytes as fn(u16) -> [u8; 2]), ([0xfe, 0xff], u16::to_be_bytes)] {
        let plain: Vec<u8> = text.encode_utf16().flat_map(unit).collect();
        let marked: Vec<u8> = mark.into_iter().chain(plain.iter().copied()).collect();
        for bytes in [plain, marked] {
            let mut warnings = Vec::new();
            assert_eq!(text_of(&bytes, &mut warnings), text);
            assert!(warnings.is_empty());
        }
    }
}

#[test]
fn text_of_four_bytes_is_read() {
    let text = "<gpx>Tälchen 富士山</gpx>";
    for (mark, unit) in
        [([0xff, 0xfe, 0, 0], u32::to_le_bytes as fn(u32) -> [u8; 4]), ([0, 0, 0xfe, 0xff], u32::to_be_bytes)]
    {
        let bytes: Vec<u8> = mark.into_iter().chain(text.chars().flat_map(|c| unit(u32::from(c)))).collect();
        assert_eq!(text_of(&bytes, &mut Vec::new()), text);
    }
}

#[test]
fn what_declares_nothing_or_something_unknown_is_said() {
    let mut warnings = Vec::new();
    assert_eq!(text_of(b"{\"a\":\"T\xe4l\"}", &mut warnings), "{\"a\":\"Täl\"}");
    assert!(warnings[0].text().contains("Windows-1252"), "{warnings:?}");
    warnings.clear();
    assert_eq!(text_of(b"<?xml encoding=\"klingon\"?><gpx/>", &mut warnings), "<?xml encoding=\"klingon\"?><gpx/>");
    assert!(warnings[0].text().contains("klingon"), "{warnings:?}");
}

#[test]
fn tables_say_their_code_page() {
    for (cpg, language, name) in [
        (Some("UTF-8"), 0x57, "UTF-8"),
        (Some("1250\r\n"), 0, "windows-1250"),
        (Some("CP1251"), 0, "windows-1251"),
        (Some("ISO-8859-1"), 0, "windows-1252"),
        (Some("Big5"), 0, "Big5"),
        (Some("936"), 0, "GBK"),
        (None, 0xc9, "windows-1251"),
        (None, 0x57, "windows-1252"),
    ] {
        assert_eq!(table_encoding(cpg, language).map(Encoding::name), Some(name), "{cpg:?} {language:x}");
    }
    assert_eq!(table_encoding(None, 0), None);
}
