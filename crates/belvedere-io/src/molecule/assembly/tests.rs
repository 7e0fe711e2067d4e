use super::*;

fn shifts() -> HashMap<String, Operation> {
    let shift = |x: f64| Operation { turn: DMat3::IDENTITY, to: x * DVec3::X };
    let named = |(name, x): (&str, f64)| (name.to_owned(), shift(x));
    [("1", 1.0), ("2", 2.0), ("3", 3.0), ("X0", 100.0), ("P", 1000.0)].map(named).into()
}

fn sums(text: &str) -> Vec<f64> {
    let e = Expression::parse(text).unwrap();
    let all = e.operations(&shifts()).unwrap();
    assert_eq!(e.count(), all.len() as u64);
    all.iter().map(|o| o.to.x).collect()
}

#[test]
fn expressions_mean_lists_ranges_and_products() {
    assert_eq!(sums("1"), [1.0]);
    assert_eq!(sums("1,2, 3"), [1.0, 2.0, 3.0]);
    assert_eq!(sums("(1-3)"), [1.0, 2.0, 3.0]);
    assert_eq!(sums("(X0)(1-2,P)"), [101.0, 102.0, 1100.0]);
    assert_eq!(sums("(1,2)(X0)(1-2)"), [102.0, 103.0, 103.0, 104.0]);
    assert_eq!(sums("P(1-2)"), [1001.0, 1002.0]);
    for text in ["", "()", "(1-2", "1,,2", "(3-1)", "((1))", "1)"] {
        let error = Expression::parse(text).unwrap_err();
        assert!(error.contains("cannot be read") && error.len() < 200, "{text}: {error}");
    }
    assert!(
        Expression::parse("4").unwrap().operations(&shifts()).unwrap_err().contains("operation \"4\" has no matrix")
    );
}

#[test]
fn counts_of_absurd_expressions_are_known_without_making_them() {
    assert_eq!(Expression::parse("(1-100000)").unwrap().count(), 100_000);
    let absurd = "(1-18446744073709551615)(1-18446744073709551615)";
    assert_eq!(Expression::parse(absurd).unwrap().count(), u64::MAX);
}

#[test]
fn the_last_group_is_done_first() {
    let turn = Operation { turn: DMat3::from_rotation_z(std::f64::consts::FRAC_PI_2), to: DVec3::ZERO };
    let known = HashMap::from([("T".to_owned(), turn), ("1".to_owned(), shifts()["1"])]);
    let all = Expression::parse("(T)(1)").unwrap().operations(&known).unwrap();
    assert!(all[0].apply(DVec3::ZERO).distance(DVec3::Y) < 1e-12);
}
