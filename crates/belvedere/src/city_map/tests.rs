use super::*;
use belvedere_scene::city::{CityArea, HeightSource, LandCover, Polygon, Way, WayClass};
use belvedere_scene::{Crs, Heightfield, Progress};

fn square(low: [f64; 2], side: f64) -> Vec<Polygon> {
    let low = DVec2::from(low);
    let outer = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]].map(|d| low + DVec2::from(d)).to_vec();
    vec![Polygon { outer, holes: Vec::new() }]
}

fn city() -> City {
    let building = Building {
        id: String::new(),
        name: String::new(),
        landmark: false,
        footprint: square([500_020.0, 6_200_020.0], 40.0),
        base_m: None,
        height_m: 9.0,
        height_source: HeightSource::Assumed,
        faces: Vec::new(),
    };
    let pond =
        CityArea { name: String::new(), cover: LandCover::Water, polygons: square([500_100.0, 6_200_020.0], 40.0) };
    let street = Way {
        name: String::new(),
        class: WayClass::Primary,
        points: vec![DVec2::new(500_000.0, 6_200_080.0), DVec2::new(500_160.0, 6_200_080.0)],
    };
    City { buildings: vec![building], areas: vec![pond], ways: vec![street], ..City::default() }
}

#[test]
fn a_map_lies_where_the_city_lies_and_comes_back_as_a_drape() {
    let (city, box2) = (city(), [DVec2::new(500_000.0, 6_200_000.0), DVec2::new(500_160.0, 6_200_100.0)]);
    let map = map_picture(&city, &city.buildings, box2, 320, 0.1);
    assert_eq!([map.width, map.height], [320, 200]);
    let at = |x: f64, y: f64| map.pixels[(200 - (y * 2.0) as usize) * 320 + (x * 2.0) as usize];
    assert_eq!(at(40.0, 40.0)[..3], [FILLS[0].r, FILLS[0].g, FILLS[0].b]);
    let [water, road, casing, paper] = [at(120.0, 40.0), at(80.0, 80.0), at(80.0, 88.25), at(10.0, 10.0)];
    assert!(water[2] > water[0] && road != paper && casing[0] < road[0], "{water:?} {road:?} {casing:?} {paper:?}");
    let folder = tempfile::tempdir().expect("a folder");
    for epsg in [Some(32734), None] {
        map.write(folder.path(), epsg, false).expect("written");
        let ground =
            Heightfield::measured(DVec2::new(500_000.0, 6_200_100.0), DVec2::splat(10.0), 17, 11, vec![0.0; 17 * 11])
                .expect("ground");
        let crs = epsg.map_or(Crs::Local, Crs::Epsg);
        let file = &MapPicture::files(folder.path(), epsg)[0];
        let drape =
            belvedere_io::load_drape(file, crs, &ground, &Default::default(), &Progress::silent()).expect("a drape");
        assert!(drape.value.pixels.contains(&water), "{epsg:?}");
    }
}
