use super::*;
use belvedere_scene::Heightfield;

/// Level ground of 10 km by 8 km at 500 m, around 11.3 E, 46.5 N in UTM 32.
fn scene(crs: Crs, north_west: [f64; 2]) -> Scene {
    let (cols, rows) = (101, 81);
    let heights = vec![500.0; cols * rows];
    let ground =
        Heightfield::measured(DVec2::from_array(north_west), DVec2::splat(100.0), cols, rows, heights).unwrap();
    Scene { crs, ..Scene::default() }.with_terrain("ground", ground)
}

fn alps() -> Scene {
    scene(Crs::Epsg(32632), [671_500.0, 5_156_000.0])
}

fn found(scene: &Scene, text: &str) -> (DVec3, Option<Warning>) {
    PlaceFinder::of(scene).find(&text.parse().unwrap(), "eye").unwrap()
}

#[test]
fn the_grammar_takes_numbers_letters_and_heights() {
    let place = |text: &str| text.parse::<Place>();
    let numbers = |x, y, height| Ok(Place { position: PlacePosition::Numbers([x, y]), height });
    let degrees = |lon, lat, height| Ok(Place { position: PlacePosition::LonLat([lon, lat]), height });
    assert_eq!(place("1,-2"), numbers(1.0, -2.0, PlaceHeight::OnGround));
    assert_eq!(place(" 1e3 , 2 , 30"), numbers(1000.0, 2.0, PlaceHeight::Metres(30.0)));
    assert_eq!(place("1,2,-5"), numbers(1.0, 2.0, PlaceHeight::Metres(-5.0)));
    assert_eq!(place("1,2,+5"), numbers(1.0, 2.0, PlaceHeight::AboveGround(5.0)));
    assert_eq!(place("46.5N,11.3E"), degrees(11.3, 46.5, PlaceHeight::OnGround));
    assert_eq!(place("11.3° e, 46.5°n,+20"), degrees(11.3, 46.5, PlaceHeight::AboveGround(20.0)));
    assert_eq!(place("33.9S,70.5w,6000"), degrees(-70.5, -33.9, PlaceHeight::Metres(6000.0)));
    for (bad, why) in [
        ("1", "1 parts"),
        ("1,2,3,4", "4 parts"),
        ("1,x", "\"x\" is not a number"),
        ("1,2,up", "\"up\" is not a height"),
        ("nan,1", "not a number"),
        ("46N,11", "only one"),
        ("46N,11S", "one of E, W"),
        ("95N,11E", "90N"),
        ("-46N,11E", "only one"),
    ] {
        assert!(place(bad).is_err_and(|e| e.contains(why)), "{bad}: {:?}", place(bad));
    }
}

#[test]
fn scene_coordinates_degrees_and_letters_are_the_same_place() {
    let scene = alps();
    let (by_letters, said) = found(&scene, "46.5N,11.3E,900");
    assert!(said.is_none() && by_letters.z == 900.0);
    let [x, y, _] = by_letters.to_array();
    for text in ["11.3,46.5,900".to_owned(), "11.3E,46.5N,+400".into(), format!("{x},{y},900")] {
        let (p, said) = found(&scene, &text);
        assert!(p.distance(by_letters) < 1e-6 && said.is_none(), "{text}: {p} {said:?}");
    }
    assert_eq!(found(&scene, "11.3,46.5").0.z, 500.0);
}

#[test]
fn exchanged_numbers_are_guessed_and_said() {
    let scene = alps();
    let (right, _) = found(&scene, "11.3,46.5,900");
    let [x, y, _] = right.to_array();
    for (text, words) in [
        ("46.5,11.3,900".to_owned(), "as lat,lon it lies on it, and is taken so; write 11.3,46.5"),
        (format!("{y},{x},900"), "as y,x of the scene it lies on it"),
    ] {
        let (p, said) = found(&scene, &text);
        let said = said.unwrap_or_else(|| panic!("{text} is not said"));
        assert!(p.distance(right) < 1e-6 && said.text().contains(words), "{text}: {p} {said}");
        assert_eq!((said.kind(), said.subject()), (WarningKind::Repaired, Some("eye")));
        assert!(said.figure("away_m").is_some_and(|m| m > 1e6), "{said}");
    }
    // Latitudes beyond 90 degrees are none, so the order is known from them too.
    let china = scene_at(110.2, 30.5);
    let (p, said) = found(&china, "30.5,110.2,900");
    assert!(p.distance(found(&china, "110.2,30.5,900").0) < 1e-6);
    assert!(said.is_some_and(|s| s.text().contains("lat,lon")));
}

/// Ground of 10 km by 8 km around a place, in its UTM zone.
fn scene_at(lon: f64, lat: f64) -> Scene {
    let crs = Crs::Epsg(belvedere_io::crs::utm_epsg(lon, lat).unwrap());
    let middle = Ground { crs, terrain: None }.position_of(lon, lat).unwrap();
    scene(crs, (middle + DVec2::new(-5000.0, 4000.0)).to_array())
}

#[test]
fn what_is_written_stands_unless_another_order_is_much_better() {
    // Outside the ground, but not far; and far, where the other order is no better.
    for text in ["11.45,46.5,900", "11.3,46.9,900", "60.0,10.0,900"] {
        let (p, said) = found(&alps(), text);
        assert!(said.is_none() && p.is_finite(), "{text}");
    }
    // Explicit letters are never doubted.
    assert!(found(&alps(), "11.3N,46.5E,900").1.is_none());
    // Where longitude and latitude are alike both orders lie near: the written one is taken.
    let alike = scene_at(10.0, 10.02);
    assert!(found(&alike, "10.02,10.0,900").1.is_none());
    // Coordinates without georeference are never degrees, and never exchanged.
    let local = scene(Crs::Local, [0.0, 8000.0]);
    assert_eq!(found(&local, "11.3,46.5,900"), (DVec3::new(11.3, 46.5, 900.0), None));
    assert_eq!(found(&local, "4000,90000,900"), (DVec3::new(4000.0, 90_000.0, 900.0), None));
}

#[test]
fn small_numbers_are_scene_coordinates_where_the_ground_lies_there() {
    let origin = scene(Crs::Epsg(32632), [-5000.0, 4000.0]);
    assert_eq!(found(&origin, "11.3,46.5,900").0, DVec3::new(11.3, 46.5, 900.0));
}

#[test]
fn heights_above_the_ground_need_ground() {
    let scene = alps();
    let far = "12.3,46.5,+20".parse().unwrap();
    let fail = PlaceFinder::of(&scene).find(&far, "eye").unwrap_err().to_string();
    assert!(fail.contains("outside the terrain"), "{fail}");
    let bare = Scene::default();
    let fail = PlaceFinder::of(&bare).find(&"1,2,+20".parse().unwrap(), "eye").unwrap_err().to_string();
    assert!(fail.contains("needs terrain"), "{fail}");
}
