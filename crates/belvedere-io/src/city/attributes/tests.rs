use super::*;

impl Attributes for &[(&str, &str)] {
    fn text(&self, key: &str) -> Option<String> {
        self.iter().find(|(k, _)| *k == key).map(|(_, v)| (*v).to_owned())
    }
}

#[test]
fn heights_are_stated_or_follow_from_storeys_or_are_assumed() {
    let mut repairs = Repairs::default();
    for (attributes, want, source) in [
        (&[("height", "12,5 m")][..], 12.5, HeightSource::Stated),
        (&[("height", "18m")][..], 18.0, HeightSource::Stated),
        (&[("height", "40 ft")][..], 12.192, HeightSource::Stated),
        (&[("height", "40'")][..], 12.192, HeightSource::Stated),
        (&[("height", "65'6\"")][..], 19.9644, HeightSource::Stated),
        (&[("height", "1e2")][..], 100.0, HeightSource::Stated),
        (&[("height", "10-12 ft")][..], 3.6576, HeightSource::Stated),
        (&[("height", "30 – 25,5 m")][..], 30.0, HeightSource::Stated),
        (&[("height", "~18")][..], 18.0, HeightSource::Stated),
        (&[("height", "ca. 18 m")][..], 18.0, HeightSource::Stated),
        (&[("building:levels", "5;7")][..], 22.0, HeightSource::Levels),
        (&[("building:levels", "2.5")][..], 8.5, HeightSource::Levels),
        (&[("building:levels", "~4")][..], 13.0, HeightSource::Levels),
        (&[("levels", "0")][..], 9.0, HeightSource::Assumed),
        (&[][..], 9.0, HeightSource::Assumed),
    ] {
        let (height, from) = height(&attributes, &mut repairs);
        assert!((height - want).abs() < 1e-9 && from == source, "{attributes:?}: {height} {from:?}");
    }
    assert_eq!([repairs.heights, repairs.about, repairs.several], [0, 3, 3]);
    let of = |attributes: &[(&str, &str)], repairs: &mut Repairs| height(&attributes, repairs);
    assert_eq!(of(&[("height", "-4"), ("levels", "3")], &mut repairs), (10.0, HeightSource::Levels));
    for text in ["99999", "1e300", "1e999", "NaN", "inf", "0", "tall", "~", "-", ";", "~tall"] {
        assert_eq!(of(&[("height", text)], &mut repairs), (9.0, HeightSource::Assumed), "{text}");
    }
    assert_eq!(of(&[("height", "tall"), ("levels", "4")], &mut repairs), (13.0, HeightSource::Levels));
    for text in ["-1", "1000", "two"] {
        assert_eq!(of(&[("levels", text)], &mut repairs), (9.0, HeightSource::Assumed), "{text}");
    }
    assert_eq!(repairs.heights, 1 + 11 + 1 + 3);
    assert!(is_landmark(&&[("building", "Church;ruins")][..]) && !is_landmark(&&[("building", "towerblock")][..]));
}
