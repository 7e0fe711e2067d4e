//! Coordinate systems against PROJ 9.5.1 (through pyproj 3.7.2, no grids), and the laws of transforms.

use belvedere_io::crs::{CoordinateSystem, CrsError, Transform, gaussian_radius_m, utm_epsg};
use glam::DVec2;

/// EPSG code, longitude, latitude, x, y from `Transformer.from_crs(4326, code, always_xy=True)`.
#[rustfmt::skip]
const PROJ_EXACT: [(u32, f64, f64, f64, f64); 21] = [
    (32631, 1.5218, 42.5063, 378553.0202367856, 4707051.275479188),
    (32631, 3.0, 0.0, 500000.0, 0.0),
    (32733, 20.4540104625, -34.0103928885, 1003891.2667000765, 6223252.725224335),
    (32612, -112.5, 36.1, 364974.69201325224, 3996081.537189341),
    (32601, -179.9, 65.2, 364306.5659522542, 7233862.721566781),
    (32760, 179.2, -44.1, 676087.9496304803, 5114667.056193397),
    (3857, -113.02734375, 36.1733569352216, -12582146.351966292, 4324501.312262133),
    (3857, 179.99, -84.9, 20036395.14788131, -19845401.33549638),
    (3857, 0.0, 0.0, 0.0, 0.0),
    (2056, 7.9885, 46.0211, 2642582.703499255, 1096765.8511952756),
    (21781, 8.5, 46.6, 681323.0306204081, 161520.30478848185),
    (25833, 13.375, 52.516, 389733.88403561176, 5819672.673288685),
    (26912, -105.7, 40.35, 950192.6329398599, 4480107.224278985),
    (3031, 45.0, -75.0, 1158794.7407726075, 1158794.7407726077),
    (3031, -120.5, -89.5, -46809.34134385045, -27572.80924052358),
    (3413, -40.0, 72.5, 166468.23426017255, -1902740.6243420998),
    (3035, 13.0, 46.5, 4551457.567580768, 2603177.175431109),
    (2154, 6.8652, 45.8326, 999929.3850023798, 6533226.239685999),
    (5070, -105.5, 40.3, -799222.3720468193, 1960569.398264937),
    (2193, 170.14, -43.6, 1369162.3490171302, 5168577.914458797),
    (32661, 10.0, 87.0, 2057849.932797522, 1671916.7278593064),
];

#[test]
fn transforms_agree_with_proj_to_a_micrometre() {
    for (code, lon, lat, x, y) in PROJ_EXACT {
        let t = Transform::between_epsg(4326, code).unwrap();
        let got = t.forward_one(DVec2::new(lon, lat)).unwrap();
        let off = (got - DVec2::new(x, y)).length();
        assert!(off < 1e-6, "EPSG:{code} at {lon}, {lat}: {got} is {off:e} m from PROJ");
        let back = t.inverse_one(got).unwrap();
        let off_deg = (back - DVec2::new(lon, lat)).length();
        // a Helmert shift in two dimensions forgets the height it made: a millimetre or two per round trip
        let limit = if t.to().datum_note().is_some() { 5e-8 } else { 1e-11 };
        assert!(off_deg < limit, "EPSG:{code} at {lon}, {lat}: comes back as {back}, {off_deg:e} deg off");
    }
}

/// Where PROJ chooses between several datum shifts by area, ours stays within the stated accuracy and says so.
#[test]
fn approximate_datum_shifts_are_close_and_noted() {
    // code, lon, lat, PROJ's x, y, tolerance in units of the system
    let cases = [
        (26712, -112.187, 36.058, 393159.41734611633, 3990831.7814843818, 10.0),
        (26711, -117.64, 33.9, 440907.23055133666, 3751056.220027738, 10.0),
        (27700, -3.2117, 56.7969, 326090.100598094, 767917.3710764296, 3.0),
        (31287, 13.0, 47.2, 374805.44540368975, 366770.3971576631, 3.0),
        (28992, 5.387, 52.156, 154986.07323428942, 463092.0905035016, 1.0),
    ];
    for (code, lon, lat, x, y, tolerance) in cases {
        let t = Transform::between_epsg(4326, code).unwrap();
        let got = t.forward_one(DVec2::new(lon, lat)).unwrap();
        let off = (got - DVec2::new(x, y)).length();
        assert!(off < tolerance, "EPSG:{code}: {off} m from PROJ, {tolerance} allowed");
        assert!(
            t.to().datum_note().is_some_and(|n| n.text().contains(&format!("EPSG:{code}"))),
            "EPSG:{code} has no note"
        );
    }
    for code in [4326, 3857, 32631, 25833, 26912, 3035, 3031] {
        let system = CoordinateSystem::from_epsg(code).unwrap();
        assert_eq!(system.datum_note(), None, "EPSG:{code}");
    }
    // the shift that stands in for NAD27's grids, given to PROJ explicitly
    let nad27 = Transform::between_epsg(4326, 26712).unwrap().forward_one(DVec2::new(-112.187, 36.058)).unwrap();
    assert!((nad27 - DVec2::new(393159.778346672, 3990830.4238946433)).length() < 1e-6, "{nad27}");
}

#[test]
fn feet_are_feet() {
    let california = CoordinateSystem::from_epsg(2230).unwrap();
    assert!((california.metres_per_unit().unwrap() - 1200.0 / 3937.0).abs() < 1e-12);
    assert!(!california.suits_scenes());
    let t = Transform::between_epsg(4326, 2230).unwrap();
    let got = t.forward_one(DVec2::new(-117.0, 33.0)).unwrap();
    assert!((got - DVec2::new(6331721.996647694, 1944453.9283243052)).length() < 1e-5, "{got}");
}

#[test]
fn scenes_take_only_metric_east_north_systems() {
    for (code, suits) in [(32631, true), (3857, true), (2056, true), (4326, false), (2263, false), (2048, false)] {
        assert_eq!(CoordinateSystem::from_epsg(code).unwrap().suits_scenes(), suits, "EPSG:{code}");
    }
}

#[test]
fn nothing_outside_the_domain_and_nothing_that_is_not_a_number_comes_out() {
    let inputs = [
        (f64::NAN, 0.0),
        (0.0, f64::INFINITY),
        (1e300, 1e300),
        (10.0, 90.1),
        (10.0, -91.0),
        (1e9, 45.0),
        (-1e7, 1e7),
        (180.0, 90.0),
        (-180.0, -90.0),
        (0.0, 0.0),
        (93.0, 0.0),
        (-87.0, 0.0),
    ];
    let codes = [4326, 3857, 32631, 32733, 2056, 27700, 3031, 3413, 3035, 2154, 5070, 2193, 26712, 5514, 28992, 3042];
    for code in codes {
        let t = Transform::between_epsg(4326, code).unwrap();
        for (x, y) in inputs {
            for out in [t.forward_one(DVec2::new(x, y)), t.inverse_one(DVec2::new(x, y))].into_iter().flatten() {
                assert!(out.is_finite() && out.abs().max_element() <= 1e8, "EPSG:{code} ({x}, {y}): {out}");
            }
            if y.abs() > 90.0 || !x.is_finite() || x.abs() > 1e8 {
                assert_eq!(t.forward_one(DVec2::new(x, y)), None, "EPSG:{code} ({x}, {y})");
            }
        }
    }
    // the pole lies at infinity in Mercator
    assert_eq!(Transform::between_epsg(4326, 3857).unwrap().forward_one(DVec2::new(0.0, 90.0)), None);
}

#[test]
fn bulk_equals_one_by_one_bit_for_bit() {
    let t = Transform::between_epsg(4326, 32631).unwrap();
    let points: Vec<DVec2> = (0..10_000).map(|i| DVec2::new(f64::from(i) * 0.05, f64::from(i % 200) - 99.5)).collect();
    let bulk = t.forward(&points);
    assert!(bulk.iter().any(Option::is_none) && bulk.iter().any(Option::is_some));
    for (p, q) in points.iter().zip(&bulk) {
        assert_eq!(t.forward_one(*p), *q);
    }
    let same = Transform::between_epsg(32631, 32631).unwrap();
    assert!(same.is_identity());
    assert_eq!(same.forward_one(DVec2::new(0.1, 0.2)), Some(DVec2::new(0.1, 0.2)));
}

#[test]
fn well_known_text_of_the_usual_kinds() {
    let esri_wgs84 = r#"GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["Degree",0.017453292519943295]]"#;
    let esri_utm = r#"PROJCS["WGS_1984_UTM_Zone_33S",GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],UNIT["Meter",1.0]]"#;
    let compound = r#"COMPD_CS["a + b",PROJCS["ETRS89 / UTM zone 33N",GEOGCS["ETRS89",DATUM["x",SPHEROID["GRS 1980",6378137,298.257222101]],AUTHORITY["EPSG","4258"]],AUTHORITY["EPSG","25833"]],VERT_CS["DHHN92",AUTHORITY["EPSG","5783"]]]"#;
    let wkt2 = r#"GEOGCRS["WGS 84",DATUM["World Geodetic System 1984",ELLIPSOID["WGS 84",6378137,298.257223563]],CS[ellipsoidal,2],ID["EPSG",4326]]"#;
    for (text, code) in [(esri_wgs84, 4326), (esri_utm, 32733), (compound, 25833), (wkt2, 4326)] {
        assert_eq!(CoordinateSystem::from_wkt(text).unwrap().epsg(), Some(code), "{text}");
    }
    // no code and no known name: by the parameters
    let albers = r#"PROJCS["USA_Contiguous_Albers_Equal_Area_Conic_USGS_version",GEOGCS["GCS_North_American_1983",DATUM["D_North_American_1983",SPHEROID["GRS_1980",6378137.0,298.257222101]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Albers"],PARAMETER["false_easting",0.0],PARAMETER["false_northing",0.0],PARAMETER["central_meridian",-96.0],PARAMETER["standard_parallel_1",29.5],PARAMETER["standard_parallel_2",45.5],PARAMETER["latitude_of_origin",23.0],UNIT["Meter",1.0]]"#;
    let system = CoordinateSystem::from_wkt(albers).unwrap();
    let t = Transform::new(&CoordinateSystem::wgs84().unwrap(), &system).unwrap();
    let got = t.forward_one(DVec2::new(-105.5, 40.3)).unwrap();
    assert!((got - DVec2::new(-799222.3720468193, 1960569.398264937)).length() < 1e-6, "{got}");
    assert_eq!(system.epsg(), Some(5070), "by its parameters");
}

/// The codes are those of the EPSG register.
#[test]
fn systems_without_a_code_are_known_by_their_usual_names() {
    let geographic =
        r#"DATUM["D",SPHEROID["S",6378137,298.257]],PRIMEM["Greenwich",0],UNIT["Degree",0.0174532925199433]"#;
    for (name, code) in [
        ("GCS_WGS_1984", 4326),
        ("GCS_North_American_1983", 4269),
        ("GCS_North_American_1927", 4267),
        ("GCS_ETRS_1989", 4258),
        ("WGS_1984_Web_Mercator_Auxiliary_Sphere", 3857),
        ("CH1903+_LV95", 2056),
        ("British_National_Grid", 27700),
        ("RGF_1993_Lambert_93", 2154),
        ("ETRS_1989_LAEA", 3035),
        ("WGS_1984_UTM_Zone_60S", 32760),
        ("ETRS_1989_UTM_Zone_28N", 25828),
        ("ETRS_1989_UTM_Zone_38N", 25838),
        ("NAD_1983_UTM_Zone_23N", 26923),
        ("NAD_1927_UTM_Zone_22N", 26722),
    ] {
        let system = CoordinateSystem::from_wkt(&format!("GEOGCS[\"{name}\",{geographic}]")).unwrap();
        assert_eq!(system.epsg(), Some(code), "{name}");
    }
    let system = CoordinateSystem::from_wkt(&format!("GEOGCS[\"WGS_1984_UTM_Zone_61N\",{geographic}]")).unwrap();
    assert_eq!(system.epsg(), None);
    // What GDAL writes for the web's Mercator: the parameters would give the ellipsoidal projection.
    let text = format!(
        r#"PROJCS["Web",GEOGCS["G",{geographic}],PROJECTION["Mercator_1SP"],UNIT["metre",1],EXTENSION["PROJ4","+proj=merc +a=6378137 +b=6378137 +units=m +no_defs"]]"#
    );
    let (from, p) = (CoordinateSystem::wgs84().unwrap(), DVec2::new(8.0, 46.0));
    let got = Transform::new(&from, &CoordinateSystem::from_wkt(&text).unwrap()).unwrap().forward_one(p).unwrap();
    let wanted = Transform::between_epsg(4326, 3857).unwrap().forward_one(p).unwrap();
    assert!((got - wanted).length() < 1e-6, "{got} {wanted}");
}

#[test]
fn broken_well_known_text_is_one_sentence() {
    let deep = "A[".repeat(100_000);
    let long_quote = format!("GEOGCS[\"{}", "x".repeat(100_000));
    for text in
        ["", "[", "GEOGCS", "GEOGCS[", "GEOGCS[\"a\"", "GEOGCS[]", "GEOGCS[\"é\"\"]", "é[1]", &deep, &long_quote]
    {
        let error = CoordinateSystem::from_wkt(text).unwrap_err();
        assert!(matches!(error, CrsError::Text { .. }) && error.to_string().len() < 300, "{text:.40}: {error}");
    }
    assert!(matches!(CoordinateSystem::from_epsg(1), Err(CrsError::UnknownCode { code: 1 })));
    assert!(matches!(CoordinateSystem::from_epsg(70_000), Err(CrsError::UnknownCode { .. })));
    assert!(matches!(CoordinateSystem::from_epsg(4978), Err(CrsError::Unsupported { .. })));
}

#[test]
fn utm_zones() {
    let cases = [
        (1.5, 42.5, 32631),
        (8.5, 46.5, 32632),
        (20.45, -34.0, 32734),
        (-180.0, 10.0, 32601),
        (180.0, 10.0, 32601),
        (179.999, 10.0, 32660),
        (6.0, 0.0, 32632),
        (5.999, -0.1, 32731),
        (0.0, 88.0, 32661),
        (0.0, -85.0, 32761),
        (187.0, 10.0, 32602),
    ];
    for (lon, lat, code) in cases {
        assert_eq!(utm_epsg(lon, lat), Some(code), "{lon}, {lat}");
        assert!(CoordinateSystem::from_epsg(code).unwrap().suits_scenes(), "EPSG:{code}");
    }
    assert_eq!(utm_epsg(f64::NAN, 0.0), None);
    assert_eq!(utm_epsg(0.0, 91.0), None);
}

/// Law: R^2 = M N, with M and N from finite differences of positions on the ellipsoid through a projection that is
/// conformal: at the centre of a transverse Mercator zone with k = 0.9996, scale is known exactly.
#[test]
fn gaussian_radius_is_the_mean_of_the_two_curvatures() {
    let t = Transform::between_epsg(4326, 32631).unwrap();
    for lat in [0.5, 30.0, 46.5, 70.0] {
        let d = 1e-4f64;
        let at = |lon: f64, lat: f64| t.forward_one(DVec2::new(lon, lat)).unwrap() / 0.9996;
        let m = (at(3.0, lat + d) - at(3.0, lat - d)).length() / (2.0 * d).to_radians();
        let n = (at(3.0 + d, lat) - at(3.0 - d, lat)).length() / (2.0 * d).to_radians() / lat.to_radians().cos();
        let r = gaussian_radius_m(lat);
        assert!((r - (m * n).sqrt()).abs() < 1.0, "at {lat}: {r} against {}", (m * n).sqrt());
    }
    assert!((gaussian_radius_m(90.0) - 6_399_593.626).abs() < 0.01);
    assert!(gaussian_radius_m(f64::NAN).is_finite());
}

#[test]
fn the_code_of_a_system_is_its_own_whatever_its_name_and_brackets() {
    let datum =
        r#"DATUM["D",SPHEROID["S",6378137,298.257,AUTHORITY["EPSG","7019"]]],UNIT["Degree",0.0174532925199433]"#;
    let system = |id: &str| format!("GEOGCS[\"ours\",{datum},{id}]");
    for (id, code) in [
        (r#"AUTHORITY["EPSG","4258"]"#, Some(4258)),
        (r#"AUTHORITY["EPSG",4258]"#, Some(4258)),
        (r#"ID["EPSG",4258]"#, Some(4258)),
        (r#"AUTHORITY["ESRI","4258"]"#, None),
        (r#"AUTHORITY["EPSG","none"]"#, None),
    ] {
        let text = system(id);
        let round = text.replace('[', "(").replace(']', ")");
        for text in [&text, &round] {
            assert_eq!(CoordinateSystem::from_wkt(text).unwrap().epsg(), code, "{text}");
        }
    }
    let wrapped = |n: usize| format!("{}{}{}", "BOUNDCRS[".repeat(n), system(r#"ID["EPSG",4258]"#), "]".repeat(n));
    assert_eq!(CoordinateSystem::from_wkt(&wrapped(20)).unwrap().epsg(), Some(4258));
    assert!(CoordinateSystem::from_wkt(&wrapped(40)).unwrap_err().to_string().contains("nested"));
}
