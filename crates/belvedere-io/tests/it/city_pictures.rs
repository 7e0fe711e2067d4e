//! Pictures on the faces of city models: every point has the right part of the right picture; and models with missing or broken pictures.

use crate::support_files::Folder;
use belvedere_io::city::{CityColors, CityGround, surface};
use belvedere_io::png::{self, Channels};
use belvedere_io::{CityFile, Limits, Loaded, load_city};
use belvedere_scene::{Color, Mesh};
use glam::DVec3;
use serde_json::{Value, json};
use std::path::Path;

const RED: [u8; 3] = [200, 30, 30];
const GREEN: [u8; 3] = [30, 190, 40];
const BLUE: [u8; 3] = [40, 50, 210];
const WHITE: [u8; 3] = [250, 250, 250];

/// Red and green over blue and white, 2 x 2 pixels.
fn write_picture(path: &Path) {
    png::write(path, false, 2, 2, Channels::Rgb, &[RED, GREEN, BLUE, WHITE].concat(), &[]).expect("a picture");
}

/// A block of 10 m whose south wall (y = 0) has the picture upright.
fn city_json(image: &str, wall: Value) -> Value {
    let none = json!([[null]]);
    json!({
        "type": "CityJSON", "version": "2.0", "transform": {"scale": [1, 1, 1], "translate": [0, 0, 0]},
        "appearance": {
            "textures": [{"type": "PNG", "image": image, "wrapMode": "wrap"}],
            "vertices-texture": [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            "default-theme-texture": "summer"
        },
        "CityObjects": {"b": {"type": "Building", "geometry": [{
            "type": "Solid", "lod": "2",
            "boundaries": [[[[0, 3, 2, 1]], [[4, 5, 6, 7]], [[0, 1, 5, 4]], [[1, 2, 6, 5]], [[2, 3, 7, 6]], [[3, 0, 4, 7]]]],
            "texture": {
                "winter": {"values": [[none, none, none, none, none, none]]},
                "summer": {"values": [[none, none, wall, none, none, none]]}
            }
        }]}},
        "vertices": [[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0], [0, 0, 10], [10, 0, 10], [10, 10, 10], [0, 10, 10]]
    })
}

fn ring(id: &str, corners: &str) -> String {
    format!(
        r#"<gml:surfaceMember><gml:Polygon gml:id="p{id}"><gml:exterior><gml:LinearRing gml:id="{id}"><gml:posList>{corners}</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon></gml:surfaceMember>"#
    )
}

/// The same block in CityGML.
fn city_gml(image: &str) -> String {
    let rings = [
        ring("floor", "0 0 0 0 10 0 10 10 0 10 0 0 0 0 0"),
        ring("roof", "0 0 10 10 0 10 10 10 10 0 10 10 0 0 10"),
        ring("south", "0 0 0 10 0 0 10 0 10 0 0 10 0 0 0"),
        ring("east", "10 0 0 10 10 0 10 10 10 10 0 10 10 0 0"),
        ring("north", "10 10 0 0 10 0 0 10 10 10 10 10 10 10 0"),
        ring("west", "0 10 0 0 0 0 0 0 10 0 10 10 0 10 0"),
    ];
    format!(
        r##"<?xml version="1.0"?>
<core:CityModel xmlns:core="http://www.opengis.net/citygml/2.0" xmlns:gml="http://www.opengis.net/gml"
 xmlns:bldg="http://www.opengis.net/citygml/building/2.0" xmlns:app="http://www.opengis.net/citygml/appearance/2.0">
<gml:boundedBy><gml:Envelope srsName="urn:ogc:def:crs,crs:EPSG::25832,crs:EPSG::5783" srsDimension="3"/></gml:boundedBy>
<app:appearanceMember><app:Appearance><app:theme>summer</app:theme><app:surfaceDataMember><app:ParameterizedTexture>
<app:imageURI>{image}</app:imageURI><app:wrapMode>wrap</app:wrapMode>
<app:target uri="#psouth"><app:TexCoordList><app:textureCoordinates ring="#south">0 0 1 0 1 1 0 1 0 0</app:textureCoordinates></app:TexCoordList></app:target>
</app:ParameterizedTexture></app:surfaceDataMember></app:Appearance></app:appearanceMember>
<core:cityObjectMember><bldg:Building gml:id="b"><bldg:lod2Solid><gml:Solid><gml:exterior><gml:CompositeSurface>
{}</gml:CompositeSurface></gml:exterior></gml:Solid></bldg:lod2Solid></bldg:Building></core:cityObjectMember></core:CityModel>"##,
        rings.concat()
    )
}

/// Loads a model from a folder that also has its picture.
fn load(name: &str, text: &str) -> Loaded<CityFile> {
    let folder = Folder::new();
    let model = folder.file(name, text.as_bytes());
    let looks = model.with_file_name("looks");
    std::fs::create_dir(&looks).expect("a folder");
    write_picture(&looks.join("wall.png"));
    load_city(&model, None, &Limits::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn mesh(city: &CityFile) -> Mesh {
    let file = surface(&city.city, &CityColors::default(), CityGround::Plate(0.0, &[]));
    Mesh::textured(&file.positions, file.triangles, file.colors, file.parts, file.texturing).expect("a mesh")
}

/// The colour of a mesh at a point on one of its triangles; `None` elsewhere.
fn color(mesh: &Mesh, place: DVec3) -> Option<Color> {
    (0..mesh.triangles().len()).find_map(|t| {
        let [a, b, c] = mesh.corners(t);
        let n = (b - a).cross(c - a);
        let of = |p: DVec3, q: DVec3| (p - place).cross(q - place).dot(n) / n.length_squared();
        let weights = [of(b, c), of(c, a), of(a, b)];
        let inside = weights.iter().all(|w| *w >= -1e-9) && (place - a).dot(n.normalize()).abs() < 1e-9;
        inside.then(|| mesh.surface_color_at(t, weights, 0.0)).flatten()
    })
}

#[test]
fn walls_of_both_formats_wear_their_picture_upright() {
    let json = city_json("looks/wall.png", json!([[0, 0, 1, 2, 3]])).to_string();
    for (name, text) in [("town.city.json", json), ("town.gml", city_gml("looks/wall.png"))] {
        let loaded = load(name, &text);
        assert!(loaded.warnings.iter().all(|w| !w.text().contains("picture")), "{name}: {:?}", loaded.warnings);
        assert!(loaded.files.iter().any(|f| f.path.ends_with("looks/wall.png")), "{name}: the picture is an input");
        let mesh = mesh(&loaded.value);
        for (x, z, want) in [(2.5, 7.5, RED), (7.5, 7.5, GREEN), (2.5, 2.5, BLUE), (7.5, 2.5, WHITE)] {
            let found = color(&mesh, DVec3::new(x, 0.0, z)).map(|c| [c.r, c.g, c.b]);
            assert_eq!(found, Some(want), "{name} at {x}, {z}");
        }
        let plain = CityColors::default();
        assert_eq!(color(&mesh, DVec3::new(5.0, 10.0, 4.0)), Some(plain.wall), "{name}: the north wall wears none");
    }
}

#[test]
fn pictures_that_are_amiss_leave_plain_faces_and_a_word() {
    let plain = Some(CityColors::default().wall);
    let missing = city_json("looks/gone.png", json!([[0, 0, 1, 2, 3]]));
    let short = city_json("looks/wall.png", json!([[0, 0, 1]]));
    let beyond = city_json("looks/wall.png", json!([[0, 0, 1, 2, 99]]));
    let unknown = city_json("looks/wall.png", json!([[7, 0, 1, 2, 3]]));
    let outside = city_json("../../../../etc/hostname", json!([[0, 0, 1, 2, 3]]));
    for (model, word) in [
        (missing, "1 of 1 pictures cannot be read and 1 faces go without"),
        (short, "1 faces go without their picture"),
        (beyond, "1 faces go without their picture"),
        (unknown, "1 faces go without their picture"),
        (outside, "1 of 1 pictures cannot be read and 1 faces go without"),
    ] {
        let loaded = load("town.city.json", &model.to_string());
        assert!(loaded.warnings.iter().any(|w| w.text().contains(word)), "{word}: {:?}", loaded.warnings);
        assert_eq!(color(&mesh(&loaded.value), DVec3::new(2.5, 0.0, 7.5)), plain, "{word}");
    }
}
