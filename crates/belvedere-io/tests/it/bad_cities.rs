//! Cities broken in every way we know give one clear line with the place and what to do, or a counted repair; quickly and without NaN.

use crate::support_files::Folder;
use belvedere_io::{Limits, load_city};
use belvedere_scene::City;
use serde_json::{Value, json};
use std::time::Instant;

/// The change that breaks a file.
type Change = Box<dyn Fn(&mut Value)>;

/// The expected result of a file.
enum Want {
    /// An error that contains these words.
    Error(&'static str),
    /// A warning that contains these words.
    Warning(&'static str),
    /// No error and no warning.
    Fine,
}
use Want::{Error, Fine, Warning};

fn judge(folder: &Folder, name: &str, about: &str, content: &str, want: &Want) {
    let path = folder.file(name, content.as_ref());
    let start = Instant::now();
    let found = load_city(&path, None, &Limits::default());
    assert!(start.elapsed().as_secs_f64() < 2.0, "{about} takes {:?}", start.elapsed());
    match (want, found) {
        (Error(words), Err(e)) => {
            let text = e.to_string();
            assert!(text.contains(words), "{about}: {text}");
            assert!(text.lines().count() == 1 && text.contains(name), "{about}: one line that names the file: {text}");
            assert!(text.contains(';') && text.len() < 600, "{about}: says what to do: {text}");
        }
        (Warning(words), Ok(loaded)) => {
            let said = loaded.warnings.iter().map(|w| w.text()).collect::<Vec<_>>().join("\n");
            assert!(said.contains(words) && loaded.warnings.iter().all(|w| w.text().contains(name)), "{about}: {said}");
            assert!(is_finite(&loaded.value.city), "{about}");
        }
        (Fine, Ok(loaded)) => {
            assert!(loaded.warnings.is_empty() && is_finite(&loaded.value.city), "{about}: {:?}", loaded.warnings);
        }
        (_, Err(e)) => panic!("{about}: {e}"),
        (Error(words), Ok(loaded)) => panic!("{about}: no error \"{words}\", but {:?}", loaded.warnings),
    }
}

fn is_finite(city: &City) -> bool {
    let of = |b: &belvedere_scene::Building| {
        b.height_m.is_finite()
            && b.height_m > 0.0
            && b.base_m.is_none_or(f64::is_finite)
            && b.footprint.iter().flat_map(|p| p.holes.iter().chain([&p.outer])).flatten().all(|p| p.is_finite())
            && b.faces.iter().flat_map(|f| &f.rings).flatten().all(|p| p.is_finite())
    };
    city.buildings.iter().all(of)
}

/// A box of 10 x 10 x 8 m.
fn cube() -> Value {
    json!({
        "type": "CityJSON", "version": "2.0",
        "metadata": { "referenceSystem": "https://www.opengis.net/def/crs/EPSG/0/28992" },
        "transform": { "scale": [0.001, 0.001, 0.001], "translate": [85000, 446000, 0] },
        "CityObjects": { "b1": { "type": "Building", "attributes": {}, "geometry": [{ "type": "Solid", "lod": "2.2", "boundaries":
            [[[[0, 3, 2, 1]], [[4, 5, 6, 7]], [[0, 1, 5, 4]], [[1, 2, 6, 5]], [[2, 3, 7, 6]], [[3, 0, 4, 7]]]] }] } },
        "vertices": [[0, 0, 0], [10000, 0, 0], [10000, 10000, 0], [0, 10000, 0], [0, 0, 8000], [10000, 0, 8000],
            [10000, 10000, 8000], [0, 10000, 8000]],
    })
}

fn instance(template: usize) -> Value {
    json!({ "type": "SolitaryVegetationObject", "geometry": [{ "type": "GeometryInstance", "template": template, "boundaries": [0],
        "transformationMatrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }] })
}

#[test]
fn cityjson() {
    let folder = Folder::new();
    let solid = |c: &mut Value, change: fn(&mut Value)| change(&mut c["CityObjects"]["b1"]["geometry"][0]);
    let cases: Vec<(&str, Change, Want)> = vec![
        ("as it is", Box::new(|_| {}), Fine),
        (
            "no vertices",
            Box::new(|c| drop(c.as_object_mut().unwrap().remove("vertices"))),
            Error("has no list of vertices"),
        ),
        (
            "empty vertices",
            Box::new(|c| c["vertices"] = json!([])),
            Error("object \"b1\": vertex 0 does not exist, there are 0"),
        ),
        (
            "past the end",
            Box::new(move |c| solid(c, |g| g["boundaries"][0][0][0][1] = json!(99))),
            Error("object \"b1\": vertex 99"),
        ),
        (
            "negative number",
            Box::new(move |c| solid(c, |g| g["boundaries"][0][0][0][1] = json!(-1))),
            Error("-1 is no number of a vertex"),
        ),
        (
            "huge number",
            Box::new(move |c| solid(c, |g| g["boundaries"][0][0][0][1] = json!(1e30))),
            Error("is no number of a vertex"),
        ),
        ("far vertex", Box::new(|c| c["vertices"][3] = json!([1e300, 0, 0])), Error("vertex 3 lies at (1e297,")),
        (
            "text in a vertex",
            Box::new(|c| c["vertices"][3] = json!(["x", 0, 0])),
            Error("vertex 3 is not three finite numbers"),
        ),
        ("two numbers", Box::new(|c| c["vertices"][3] = json!([0, 0])), Error("vertex 3 is not three finite numbers")),
        ("scale 0", Box::new(|c| c["transform"]["scale"] = json!([0, 1, 1])), Error("its numbers must be above 0")),
        (
            "scale below 0",
            Box::new(|c| c["transform"]["scale"] = json!([1, -1, 1])),
            Error("its numbers must be above 0"),
        ),
        ("scale huge", Box::new(|c| c["transform"]["scale"] = json!([1e308, 1e308, 1e308])), Error("the limit is 1e8")),
        ("transform null", Box::new(|c| c["transform"] = Value::Null), Error("has no transform")),
        ("version 3.0", Box::new(|c| c["version"] = json!("3.0")), Error("is CityJSON 3.0; versions 1.0, 1.1 and 2.0")),
        ("version 2.01", Box::new(|c| c["version"] = json!("2.01")), Error("is CityJSON 2.01")),
        ("version empty", Box::new(|c| c["version"] = json!("")), Error("of no version")),
        (
            "unknown system",
            Box::new(|c| c["metadata"]["referenceSystem"] = json!("EPSG:999999")),
            Warning("EPSG:999999 is not known"),
        ),
        (
            "template past the end",
            Box::new(|c| c["CityObjects"]["t"] = instance(7)),
            Error("object \"t\": template 7 does not exist"),
        ),
        (
            "no boundaries",
            Box::new(move |c| solid(c, |g| g["boundaries"] = Value::Null)),
            Error("boundaries are not nested"),
        ),
        (
            "empty boundaries",
            Box::new(move |c| solid(c, |g| g["boundaries"] = json!([]))),
            Error("no geometry that is read"),
        ),
        (
            "empty ring",
            Box::new(move |c| solid(c, |g| g["boundaries"][0][2] = json!([[]]))),
            Warning("1 rings of fewer than 3"),
        ),
        (
            "too shallow",
            Box::new(move |c| solid(c, |g| g["boundaries"] = json!([[0, 1, 2]]))),
            Error("object \"b1\": boundaries are not nested"),
        ),
        (
            "too deep",
            Box::new(move |c| solid(c, |g| g["boundaries"] = json!([[[[[0, 1, 2]]]]]))),
            Error("is no number of a vertex"),
        ),
        (
            "bow-tie",
            Box::new(move |c| solid(c, |g| g["boundaries"][0][2] = json!([[0, 5, 1, 4]]))),
            Warning("1 rings without area"),
        ),
        (
            "crossing floor",
            Box::new(move |c| {
                c["vertices"][2] = json!([-9000, 4000, 0]);
                let kinds = json!([{ "type": "GroundSurface" }, { "type": "WallSurface" }]);
                c["CityObjects"]["b1"]["geometry"][0]["semantics"] =
                    json!({ "surfaces": kinds, "values": [[0, 1, 1, 1, 1, 1]] });
            }),
            Warning("1 footprints cross themselves"),
        ),
        (
            "repeated vertices",
            Box::new(move |c| solid(c, |g| g["boundaries"][0][0] = json!([[0, 0, 3, 3, 2, 1, 1, 0]]))),
            Fine,
        ),
        ("own parent", Box::new(|c| c["CityObjects"]["b1"]["parents"] = json!(["b1"])), Fine),
        (
            "object that is a number",
            Box::new(|c| c["CityObjects"]["b2"] = json!(5)),
            Error("object \"b2\": its geometry is no list"),
        ),
        (
            "geometry that is no list",
            Box::new(|c| c["CityObjects"]["b1"]["geometry"] = json!({})),
            Error("object \"b1\": its geometry is no list"),
        ),
        (
            "unknown geometry",
            Box::new(move |c| solid(c, |g| g["type"] = json!("Blob"))),
            Error("object \"b1\": geometry of type \"Blob\""),
        ),
        (
            "semantics past the end",
            Box::new(move |c| solid(c, |g| g["semantics"] = json!({ "surfaces": [], "values": [[9, 9, 9, 9, 9, 9]] }))),
            Fine,
        ),
        (
            "millimetres",
            Box::new(|c| c["transform"]["scale"] = json!([1, 1, 1])),
            Warning("1 buildings are higher than 2000 m"),
        ),
    ];
    for (about, change, want) in &cases {
        let mut city = cube();
        change(&mut city);
        judge(&folder, "a.city.json", about, &city.to_string(), want);
    }
    let text = cube().to_string();
    let nested = text.replacen('{', &format!("{{\"x\":{}{},", "[".repeat(5000), "]".repeat(5000)), 1);
    for (about, content, want) in [
        ("NaN", text.replacen("10000", "NaN", 1), Error("no valid JSON")),
        ("1e999", text.replacen("10000", "1e999", 1), Error("no valid JSON")),
        ("deep", nested, Error("recursion limit")),
    ] {
        judge(&folder, "a.city.json", about, &content, &want);
    }
    for k in 0..64 {
        judge(&folder, "a.city.json", &format!("cut at {k} of 64"), &text[..text.len() * k / 64], &Error(""));
    }
}

#[test]
fn cityjson_in_lines() {
    let folder = Folder::new();
    let cube = cube();
    let mut head = cube.clone();
    (head["CityObjects"], head["vertices"]) = (json!({}), json!([]));
    let part = json!({ "type": "CityJSONFeature", "id": "b1", "CityObjects": cube["CityObjects"], "vertices": cube["vertices"] });
    let (head, part) = (head.to_string(), part.to_string());
    let other = head.replace("2.0", "7.1");
    for (about, lines, want) in [
        ("as it is", vec![head.as_str(), &part, &part], Fine),
        ("bad line", vec![&head, &part, "{\"type\":", &part], Error("line 3: no valid JSON")),
        ("a number", vec![&head, &part, "5"], Error("line 3: has no CityObjects")),
        ("no head", vec![&part, &part], Error("line 1: is a feature without the document")),
        ("one feature", vec![&part], Error("is a feature without the document")),
        ("head of another version", vec![&other, &part], Error("line 1: is CityJSON 7.1")),
    ] {
        judge(&folder, "a.city.jsonl", about, &lines.join("\n"), &want);
    }
}

fn gml(faces: &str) -> String {
    format!(
        r#"<?xml version="1.0"?><CityModel xmlns="http://www.opengis.net/citygml/2.0" xmlns:bldg="http://www.opengis.net/citygml/building/2.0"
 xmlns:gml="http://www.opengis.net/gml" xmlns:xlink="http://www.w3.org/1999/xlink">
<gml:boundedBy><gml:Envelope srsName="EPSG:25833"/></gml:boundedBy><cityObjectMember><bldg:Building gml:id="b1"><bldg:lod1Solid>
<gml:Solid><gml:exterior><gml:CompositeSurface>{}{}{faces}</gml:CompositeSurface></gml:exterior></gml:Solid></bldg:lod1Solid>
</bldg:Building></cityObjectMember></CityModel>"#,
        face("0 0 33 0 9 33 9 9 33 9 0 33 0 0 33"),
        face("0 0 43 9 0 43 9 9 43 0 9 43 0 0 43")
    )
}

fn face(positions: &str) -> String {
    format!(
        "<gml:surfaceMember><gml:Polygon gml:id=\"p\"><gml:exterior><gml:LinearRing><gml:posList srsDimension=\"3\">{positions}</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon></gml:surfaceMember>"
    )
}

#[test]
fn citygml() {
    let folder = Folder::new();
    let plain = gml("");
    let with = |positions: &str| gml(&face(positions));
    for (about, content, want) in [
        ("as it is", plain.clone(), Fine),
        ("version 1", plain.replace("/2.0", "/1.0"), Fine),
        ("version 3", plain.replace("/2.0", "/3.0"), Error("is version 3")),
        (
            "unknown system",
            plain.replace("EPSG:25833", "urn:nothing:1"),
            Warning("\"urn:nothing:1\" is not known; set crs"),
        ),
        ("odd count", with("1 2 3 4"), Error("Building \"b1\": line 4: posList of 4 numbers")),
        ("NaN", with("1 2 NaN"), Error("\"NaN\" in posList is no finite number")),
        ("infinite", with("1 2 1e999"), Error("\"1e999\" in posList is no finite number")),
        ("far", with("1 2 1e300 1 3 5 1 4 6"), Error("line 4: a position lies at (1e0, 2e0, 1e300), the limit is 1e8")),
        ("not closed", with("0 0 5 9 0 5 9 9 9"), Fine),
        ("two positions", with("0 0 5 9 0 5"), Warning("1 rings of fewer than 3")),
        ("no positions", with(""), Warning("1 rings of fewer than 3")),
        ("a line", with("0 0 5 9 0 5 18 0 5 0 0 5"), Warning("1 rings without area")),
        (
            "lost reference",
            gml("<gml:surfaceMember xlink:href=\"#gone\"/>"),
            Warning("1 references to surfaces lead nowhere"),
        ),
        ("dimension 7", plain.replace("srsDimension=\"3\"", "srsDimension=\"7\""), Error("positions of 7")),
        ("millimetres", plain.replace(" 43", " 43000"), Warning("1 buildings are higher than 2000 m")),
        ("deep", gml(&"<a>".repeat(5000)), Error("deeper than 200")),
    ] {
        judge(&folder, "a.gml", about, &content, &want);
    }
    for k in 0..64 {
        judge(&folder, "a.gml", &format!("cut at {k} of 64"), &plain[..plain.len() * k / 64], &Error(""));
    }
}

fn square(x: f64, y: f64) -> Value {
    json!([[x, y], [x + 0.0002, y], [x + 0.0002, y + 0.0002], [x, y + 0.0002], [x, y]])
}

#[test]
fn footprints() {
    let folder = Folder::new();
    let file = |coordinates: Value, about: Value| {
        let house = |coordinates: Value, about: &Value| {
            let mut properties = json!({ "building": "yes" });
            properties.as_object_mut().unwrap().extend(about.as_object().unwrap().clone());
            json!({ "type": "Feature", "properties": properties, "geometry": { "type": "Polygon", "coordinates": coordinates } })
        };
        let fine = house(json!([square(14.4, 50.1)]), &json!({ "height": 9 }));
        json!({ "type": "FeatureCollection", "features": [fine, house(coordinates, &about)] })
    };
    let s = square(14.401, 50.1);
    let tie = json!([s[0], s[2], s[1], [14.401, 50.1004], s[0]]);
    let same = json!([s, s]);
    for (about, coordinates, want) in [
        ("as it is", json!([s]), Fine),
        ("bow-tie", json!([tie]), Warning("1 footprints cross themselves")),
        ("bow-tie of equal lobes", json!([[s[0], s[2], s[1], s[3], s[0]]]), Warning("1 rings without area")),
        ("repeated points", json!([[s[0], s[0], s[1], s[1], s[2], s[3], s[3]]]), Fine),
        ("two points", json!([[s[0], s[1]]]), Warning("1 polygon rings of fewer than 3 points")),
        (
            "on a line",
            json!([[[14.401, 50.1], [14.402, 50.1], [14.403, 50.1], [14.401, 50.1]]]),
            Warning("1 rings without area"),
        ),
        ("hole elsewhere", json!([s, square(14.41, 50.1)]), Warning("1 holes that are not within")),
        ("hole as large", same, Warning("1 holes that are not within")),
        ("no position", json!([square(14.0, 95.0)]), Error("is no longitude and latitude")),
        ("text", json!([[["x", 1.0], [1.0, 2.0]]]), Error("feature 1: position [\"x\",1.0]")),
    ] {
        judge(&folder, "a.geojson", about, &file(coordinates, json!({})).to_string(), &want);
    }
    let wrong = Warning("1 heights that are no numbers of metres in 0..2000 were not believed");
    for height in ["0", "-5", "NaN", "1e300", "inf", "tall", "99999"] {
        judge(&folder, "a.geojson", height, &file(json!([s]), json!({ "height": height })).to_string(), &wrong);
    }
    for (key, value) in
        [("height", "12 m"), ("height", "40'"), ("height", "2,5"), ("building:levels", "2.5"), ("building:levels", "0")]
    {
        judge(&folder, "a.geojson", value, &file(json!([s]), json!({ key: value })).to_string(), &Fine);
    }
    let mut far = file(json!([[[1e12, 1e12], [2e12, 1e12], [2e12, 2e12]]]), json!({}));
    far["crs"] = json!({ "type": "name", "properties": { "name": "EPSG:32633" } });
    judge(&folder, "a.geojson", "far", &far.to_string(), &Warning("1 polygons with coordinates beyond 1e8"));
}
