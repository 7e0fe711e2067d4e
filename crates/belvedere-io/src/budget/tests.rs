use super::*;

#[test]
fn what_just_fits_is_allowed() {
    assert_eq!(ask_of(3 << 20, "the raster", 3 << 20), Ok(()));
    let text = ask_of(3 << 20, "the raster", (3 << 20) + 1).unwrap_err().to_string();
    assert!(text.contains("the raster needs 4 MiB") && text.contains("more than 3 MiB"), "{text}");
}

#[test]
fn room_beyond_the_machine_is_an_error() {
    assert!(room::<u64>("the raster", usize::MAX).is_err());
    assert!(room::<u64>("the raster", 100).is_ok_and(|room| room.capacity() >= 100));
}

#[test]
fn what_the_system_does_not_give_is_refused() {
    let text = ask_of(u64::MAX, "the raster", 1 << 62).unwrap_err().to_string();
    assert!(text.contains("which the system does not give"), "{text}");
    assert_eq!(ask_of(u64::MAX, "the raster", 2 * TRIED), Ok(()));
    assert!(left_beside(5, 7) == 0 && left_beside(7 << 20, 5 << 20) == 2 << 20);
}

#[test]
fn files_leave_the_work_in_any_order() {
    let [first, second] = ["budget_c", "budget_d"].map(|name| work_on(Path::new(name)));
    drop(first);
    let has = |name: &str| IN_WORK.lock().expect("free").iter().any(|p| p == Path::new(name));
    assert!(has("budget_d") && !has("budget_c"));
    drop(second);
    assert!(!has("budget_d"));
}

#[test]
fn the_last_file_is_in_work() {
    let _first = work_on(Path::new("budget_a"));
    {
        let _second = work_on(Path::new("budget_b"));
        assert!(bytes() > 0);
    }
    assert!(IN_WORK.lock().expect("free").iter().any(|p| p == Path::new("budget_a")));
}
