//! Small texts: palettes, systems, tables, places.

use super::CORNER;

/// A world file over the middle of the ground.
pub fn world_file() -> Vec<u8> {
    format!("40\n0\n0\n-50\n{}\n{}\n", CORNER.x + 50.0, CORNER.y + 500.0).into_bytes()
}

/// GMT palettes.
pub fn cpts() -> Vec<Vec<u8>> {
    [
        "# COLOR_MODEL = RGB\n800 0 60 0 900 200 180 90\n900 200 180 90 1000 255 255 255 L\nB 0 0 80\nF 255 255 255\nN 128 128 128\n",
        "# COLOR_MODEL = +HSV\n# RANGE = -100/2000\n-1 200-0.5-0.9 0 120-1-0.4\n0 120-1-0.4 1 30-0.2-1\n",
        "#HARD_HINGE\n0 blue 1 #ff8800 ; sea\n1 white 2 red\n",
    ]
    .map(Vec::from)
    .into()
}

/// GDAL colour-relief texts.
pub fn gdal_ramps() -> Vec<Vec<u8>> {
    [
        "# ramp\n800 0 80 0\n50% 200,180,90\n1000:255:255:255:255\nnv 0 0 0 0\n",
        "0% black\n100% #ff0000\ndefault white\n",
    ]
    .map(Vec::from)
    .into()
}

const UTM: &str = r#"PROJCS["WGS_1984_UTM_Zone_32N",GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["False_Easting",500000.0],PARAMETER["False_Northing",0.0],PARAMETER["Central_Meridian",9.0],PARAMETER["Scale_Factor",0.9996],PARAMETER["Latitude_Of_Origin",0.0],UNIT["Meter",1.0]]"#;

/// The system of the ground as a `.prj`.
pub fn utm_prj() -> Vec<u8> {
    UTM.into()
}

/// `.prj` files: well-known text, and the parameters of ARC/INFO.
pub fn projections() -> Vec<Vec<u8>> {
    let arc = "Projection    UTM\r\nZone          32\r\nDatum         WGS84\r\nZunits        NO\r\nUnits         METERS\r\nSpheroid      WGS84\r\nXshift        0.0\r\nYshift        0.0\r\nParameters\r\n";
    vec![UTM.into(), arc.into()]
}

/// Systems as users write them.
pub fn systems() -> Vec<Vec<u8>> {
    let lambert = r#"PROJCS["a",GEOGCS["b",DATUM["c",SPHEROID["GRS 1980",6378137,298.257222101],TOWGS84[1,2,3,0.1,0.2,0.3,1]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Lambert_Conformal_Conic_2SP"],PARAMETER["standard_parallel_1",49],PARAMETER["standard_parallel_2",44],PARAMETER["latitude_of_origin",46.5],PARAMETER["central_meridian",3],PARAMETER["false_easting",700000],PARAMETER["false_northing",6600000],UNIT["metre",1]]"#;
    let proj = "+proj=tmerc +lat_0=49 +lon_0=-2 +k=0.9996012717 +x_0=400000 +y_0=-100000 +ellps=airy +towgs84=446.4,-125.1,542,0.15,0.247,0.842,-20.489 +units=m +no_defs";
    vec![UTM.into(), lambert.into(), proj.into(), "EPSG:32632".into(), "4326".into()]
}

/// Places as users write them.
pub fn places() -> Vec<Vec<u8>> {
    ["600100,5200200", "600100, 5200200, +30", "46.9N,10.3E", "46.9S,10.3W,1200", "10.3E,46.9N,+2"]
        .map(Vec::from)
        .into()
}

/// Boxes by rows.
pub fn boxes_csv() -> Vec<Vec<u8>> {
    vec!["x,y,z,size_x,size_y,size_z,yaw_deg,color\n0,0,0,2,3,5\n6,1,0,2,2,8,30,#aa8866\n3,8,0,4,1,3,-10,\n".into()]
}

/// Boxes as JSON.
pub fn boxes_json() -> Vec<Vec<u8>> {
    vec![r##"[{"base":[0,0,0],"size":[2,3,5]},{"base":[6,1,0],"size":[2,2,8],"yaw_deg":30,"color":"#aa8866"}]"##.into()]
}

/// Movements.
pub fn motions() -> Vec<Vec<u8>> {
    vec!["t,x,y,z,yaw_deg\n# a note\n0,0,0,0,0\n1.5,2,1,0,20\n4,3,4,0.5,90\n".into(), "0;0;0;0\n2;5;5;1\n".into()]
}

/// Paths through space.
pub fn paths() -> Vec<Vec<u8>> {
    let rows: String = (0..10).map(|i| format!("{},{},{}\n", -4 + i, -6 + 2 * i, 2.0 + 0.2 * f64::from(i))).collect();
    vec![format!("x,y,z\n{rows}").into_bytes(), rows.into_bytes()]
}
