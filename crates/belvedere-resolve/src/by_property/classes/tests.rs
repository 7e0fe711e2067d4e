use super::*;

fn counted(values: &[&str]) -> Vec<Counted> {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    values.iter().for_each(|v| *counts.entry((*v).to_owned()).or_default() += 1);
    counts.into_iter().collect()
}

fn told(coloring: &Coloring) -> Vec<(&str, usize)> {
    coloring.classes.iter().map(|c| (c.name.as_str(), c.count)).collect()
}

#[test]
fn the_most_frequent_texts_get_a_colour_and_the_rest_are_others() {
    let mut values = vec!["track"; 5];
    values.extend(["path"; 9]);
    let rare: Vec<String> = (0..7).map(|i| format!("rare {i}")).collect();
    values.extend(rare.iter().map(String::as_str));
    let coloring = Coloring::new(&ColorByDoc::of("highway"), &counted(&values)).unwrap();
    assert_eq!(told(&coloring)[..2], [("path", 9), ("track", 5)]);
    assert_eq!((coloring.classes.len(), coloring.others), (7, 2));
    assert_eq!(coloring.color_of("path"), Some(CATEGORIES[0]));
    assert_eq!(coloring.color_of("rare 6"), None);
}

#[test]
fn stated_values_keep_their_colours_even_where_they_are_numbers() {
    let values = BTreeMap::from([("1".to_owned(), "#ff0000".to_owned())]);
    let doc = ColorByDoc { values, ..ColorByDoc::of("lanes") };
    let coloring = Coloring::new(&doc, &counted(&["1", "1", "2"])).unwrap();
    assert_eq!((told(&coloring), coloring.others), (vec![("1", 2)], 1));
    assert_eq!((coloring.color_of("1"), coloring.color_of("2")), (Some(Color::rgb(255, 0, 0)), None));
}

#[test]
fn quantiles_hold_about_as_many_each_and_equal_steps_are_equally_wide() {
    let values: Vec<String> = (0..100).map(|i| (i * i).to_string()).collect();
    let values = counted(&values.iter().map(String::as_str).collect::<Vec<_>>());
    let doc = ColorByDoc { classes: Some(4), ..ColorByDoc::of("height") };
    let quantiles = Coloring::new(&doc, &values).unwrap();
    assert_eq!(quantiles.breaks(), Some(&[625.0, 2500.0, 5625.0][..]));
    assert!(quantiles.classes.iter().all(|c| c.count == 25), "{:?}", quantiles.classes);
    let equal = Coloring::new(&ColorByDoc { steps: Some(StepsDoc::Equal), ..doc }, &values).unwrap();
    assert_eq!(equal.breaks(), Some(&[2450.25, 4900.5, 7350.75][..]));
    assert_eq!(equal.color_of("2450"), equal.color_of("0"));
    assert_ne!(equal.color_of("2451"), equal.color_of("0"));
    assert_eq!(equal.color_of("much"), None);
}

#[test]
fn few_numbers_are_their_own_classes_and_one_number_is_one_class() {
    let coloring = Coloring::new(&ColorByDoc::of("lanes"), &counted(&["1", "2", "2", "4"])).unwrap();
    assert_eq!(told(&coloring), [("1", 1), ("2", 2), ("4", 1)]);
    let one = Coloring::new(&ColorByDoc::of("lanes"), &counted(&["3", "3"])).unwrap();
    assert_eq!(told(&one), [("3", 2)]);
    for steps in [StepsDoc::Equal, StepsDoc::Smooth] {
        let doc = ColorByDoc { steps: Some(steps), ..ColorByDoc::of("lanes") };
        assert!(Coloring::new(&doc, &counted(&["3"])).unwrap().color_of("3").is_some());
    }
}

#[test]
fn what_is_wrong_is_told_with_its_key() {
    let complaint = |doc: ColorByDoc, values: &[&str]| Coloring::new(&doc, &counted(values)).unwrap_err();
    let of = || ColorByDoc::of("p");
    assert_eq!(complaint(ColorByDoc { classes: Some(9), ..of() }, &["1"]).0, "classes");
    assert_eq!(complaint(ColorByDoc { breaks: Some(vec![2.0, 1.0]), ..of() }, &["1"]).0, "breaks");
    assert_eq!(complaint(ColorByDoc { others: Some("red".into()), ..of() }, &["1"]).0, "others");
    let (key, reason) = complaint(ColorByDoc { classes: Some(4), ..of() }, &["grass"]);
    assert!(key == "property" && reason.contains("grass"), "{reason}");
}

#[test]
fn sizes_run_from_the_lowest_number_to_the_highest() {
    let sizing = Sizing::new(&SizeByDoc::of("width"), &counted(&["2", "4", "10", "wide"])).unwrap();
    assert_eq!(sizing.px_of("2"), Some(1.0));
    assert_eq!(sizing.px_of("99"), Some(8.0));
    let middle = sizing.px_of("6").unwrap();
    assert!((middle - 4.5).abs() < 0.2, "{middle}");
    assert_eq!(sizing.px_of("wide"), None);
    assert!(Sizing::new(&SizeByDoc::of("width"), &counted(&["wide"])).is_err());
}
