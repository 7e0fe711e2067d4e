use super::*;
use crate::geotiff::write_geotiff;
use crate::{Affine, CrsKind, RasterInfo, SampleType, Samples, SourceCrs};
use belvedere_scene::NodeState;

/// Distance of the first node from the corner of the ground, to the east and to the south.
const CORNER: f32 = 15.0;

/// Ground of 60 x 40 nodes, 30 m apart, in UTM zone 32.
fn ground() -> Heightfield {
    let (cols, rows) = (60, 40);
    let (heights, states) = (vec![500.0; cols * rows], vec![NodeState::Measured; cols * rows]);
    Heightfield::new(DVec2::new(600_000.0, 5_200_000.0), DVec2::splat(30.0), cols, rows, heights, states)
        .expect("ground")
}

/// A raster of classes of 10 m over the ground.
fn raster(path: &Path, class: impl Fn(usize, usize) -> u8) {
    let (width, height) = (200, 140);
    let pixels = (0..width * height).map(|i| class(i % width, i / width)).collect();
    let mut info = RasterInfo::new(path, width, height, SampleType::U8);
    info.pixel_to_model = Some(Affine([10.0, 0.0, 599_900.0, 0.0, -10.0, 5_200_100.0]));
    info.crs = SourceCrs::Epsg(32632);
    info.crs_kind = CrsKind::Projected;
    write_geotiff(path, &Raster { info, samples: Samples::U8(pixels), mask: None }, true).expect("file");
}

#[test]
fn cells_have_the_class_of_the_pixel_that_they_lie_in() {
    let dir = tempfile::tempdir().expect("folder");
    let path = dir.path().join("worldcover.tif");
    let class = |c: usize, r: usize| match (c / 50, r / 50) {
        (0, _) => 10,
        (1, 0) => 70,
        (2, 1) => 80,
        _ => 30,
    };
    raster(&path, class);
    let (ground, quiet) = (ground(), Progress::silent());
    let land = load_land_cover(&path, Crs::Epsg(32632), &ground, Limits::default(), &quiet).expect("land cover").value;
    assert_eq!(land.legend, "ESA WorldCover");
    for (east, south) in [(5.0, 5.0), (385.0, 5.0), (415.0, 5.0), (415.0, 700.0), (1200.0, 700.0), (1700.0, 1100.0)] {
        let [c, r] = [(east + 100.0) / 10.0, (south + 100.0) / 10.0].map(|v: f64| v as usize);
        let wanted = Legend::of(&[10, 30, 70, 80]).expect("legend").cover(class(c, r).into());
        assert_eq!(Some(land.at([east as f32 + CORNER, south as f32 + CORNER])), wanted, "{east} east, {south} south");
    }
}

#[test]
fn rasters_of_other_classes_or_other_places_are_refused() {
    let dir = tempfile::tempdir().expect("folder");
    let path = dir.path().join("strange.tif");
    raster(&path, |c, _| 3 + (c % 3) as u8 * 80);
    let quiet = Progress::silent();
    let error = load_land_cover(&path, Crs::Epsg(32632), &ground(), Limits::default(), &quiet).unwrap_err();
    assert!(error.to_string().contains("3, 83, 163"), "{error}");
    let error = load_land_cover(&path, Crs::Epsg(32633), &ground(), Limits::default(), &quiet).unwrap_err();
    assert!(error.to_string().contains("does not touch"), "{error}");
}

#[test]
fn areas_cover_what_their_tags_say_and_water_lies_above_forest() {
    let dir = tempfile::tempdir().expect("folder");
    let path = dir.path().join("areas.geojson");
    let area = |tags: &str, [x0, y0, x1, y1]: [f64; 4]| {
        format!(
            r#"{{"type":"Feature","properties":{{{tags}}},"geometry":{{"type":"Polygon","coordinates":[[[{x0},{y0}],[{x1},{y0}],[{x1},{y1}],[{x0},{y1}],[{x0},{y0}]]]}}}}"#
        )
    };
    let areas = [
        area(r#""natural":"water""#, [600_600.0, 5_199_300.0, 600_900.0, 5_199_600.0]),
        area(r#""landuse":"forest""#, [600_300.0, 5_199_000.0, 601_200.0, 5_199_900.0]),
        area(r#""name":"a park""#, [600_000.0, 5_199_000.0, 600_200.0, 5_199_900.0]),
    ];
    let crs = r#""crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::32632"}}"#;
    let text = format!(r#"{{"type":"FeatureCollection",{crs},"features":[{}]}}"#, areas.join(","));
    std::fs::write(&path, text).expect("file");
    let vectors = crate::load_vectors(&path).expect("areas").value;
    let land = land_cover_of_areas(&vectors, Crs::Epsg(32632), &ground()).expect("land cover").value;
    for ([east, south], wanted) in [
        ([750.0, 550.0], Cover::Water),
        ([400.0, 550.0], Cover::Forest),
        ([750.0, 150.0], Cover::Forest),
        ([100.0, 550.0], Cover::Unknown),
        ([1400.0, 550.0], Cover::Unknown),
    ] {
        assert_eq!(land.at([east + CORNER, south + CORNER]), wanted, "{east} east, {south} south");
    }
    let parks = Vectors { features: vec![vectors.features[2].clone()], ..vectors };
    let error = land_cover_of_areas(&parks, Crs::Epsg(32632), &ground()).unwrap_err();
    assert!(error.to_string().contains("natural, landuse"), "{error}");
}
