use super::*;

#[test]
fn contents_tell_formats_apart() {
    let of = |head: &[u8]| of_content(head).map(|format| format.name);
    let atom = b"REMARK x\nATOM      1  O5'  DC A   1      18.935  34.195  25.617  1.00 64.35           O\n";
    let osm = b"\0\0\0\x0d\x0a\x09OSMHeader\x18";
    let mut package = b"SQLite format 3\0".to_vec();
    package.resize(68, 1);
    package.extend(b"GPKG");
    for (head, format) in [
        (&b"<VTKFile type=\"PolyData\">"[..], "VTK XML"),
        (b"{\"type\":\"CityJSON\",\"version\":\"2.0\"}", "CityJSON"),
        (b"{\"type\":\"CityJSON\"}\n{\"type\":\"CityJSONFeature\"}", "CityJSONSeq"),
        (b"<core:CityModel xmlns:gml=\"http://www.opengis.net/gml\">", "CityGML"),
        (b"<wfs xmlns:gml=\"http://www.opengis.net/gml/3.2\">", "GML"),
        (b"data_4ZKK\n#\nloop_\n_atom_site.group_PDB\n", "mmCIF"),
        (atom, "PDB"),
        (osm, "OSM PBF"),
        (b"<osm version=\"0.6\">", "OSM XML"),
    ] {
        assert_eq!(of(head), Some(format), "{}", String::from_utf8_lossy(head));
    }
    assert_eq!(of(&package), Some("GeoPackage"));
    let at = |offset: usize, mark: &[u8]| [vec![0; offset], mark.to_vec(), vec![0; 20]].concat();
    for (head, format) in [
        (at(0, b"CDF\x05"), "netCDF"),
        (at(0, b"AC1027"), "DWG"),
        (b"999\ncomment\n0\nSECTION\n2\nHEADER\n".to_vec(), "DXF"),
        (at(0, b"MM\x40\0\0\0\x02\0\x0a"), "3D Studio"),
        (b"; FBX 7.3.0 project file\n".to_vec(), "FBX"),
        (at(0, b"\xff\x4f\xff\x51"), "JPEG 2000"),
        ([at(0, b"SQLite format 3\0"), at(32, b"MPBX")].concat(), "MBTiles"),
        (at(344, b"n+1\0"), "NIfTI"),
        (b"<!DOCTYPE html>\n<html><body>404</body></html>".to_vec(), "HTML"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:1\n".to_vec(), "Git LFS pointer"),
        (b"{ \"type\" : \"Topology\", \"arcs\": [] }".to_vec(), "TopoJSON"),
        (b"{\"geometryType\":\"esriGeometryPolyline\",\"features\":[]}".to_vec(), "ESRI JSON"),
        (b"RIFF\x10\0\0\0WEBPVP8 ".to_vec(), "WebP"),
    ] {
        assert_eq!(of(&head), Some(format), "{}", String::from_utf8_lossy(&head));
    }
    for read in [
        &b"<?xml version=\"1.0\"?><gpx version=\"1.1\"><trk/></gpx>"[..],
        b"{\"type\":\"FeatureCollection\",\"name\":\"CityJSON\",\"about\":\"CityModel\",\"features\":[]}",
        b"ncols 4\nnrows 4\n",
        b"v 0 0 0\nf 1 2 3\n",
        b"ply\nformat ascii 1.0\n",
        b"glTF\x02\0\0\0",
        b"II*\0",
        b"",
    ] {
        assert_eq!(of(read), None, "{}", String::from_utf8_lossy(read));
    }
}

#[test]
fn contents_tell_what_is_read_without_a_name() {
    let of = |head: &[u8]| readable_content(head).map(|format| format.name);
    for (head, format) in [
        (&b"\n<?xml version=\"1.0\"?><gpx version=\"1.1\">"[..], "GPX"),
        (b"{ \"type\": \"FeatureCollection\", \"features\": []", "GeoJSON"),
        (b"NCOLS 4\r\nNROWS 4\r\n", "ESRI ASCII"),
        (b"MM\0*\0\0\0\x08", "GeoTIFF"),
        (b"glTF\x02\0\0\0", "glTF"),
        (b"ply\nformat ascii 1.0\n", "PLY"),
        (b"solid x\nfacet normal 0 0 1\n", "STL"),
        (b"NRRD0004\ntype: uint8\n", "NRRD"),
        (b"{\"type\":\"CityJSON\"}", "CityJSON"),
    ] {
        assert_eq!(of(head), Some(format), "{}", String::from_utf8_lossy(head));
    }
    let wide: Vec<u8> = "<?xml version=\"1.0\"?><gpx/>".encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert_eq!(of(&wide), Some("GPX"));
    for (head, format) in [
        (&b"<k:kml xmlns:k=\"x\">"[..], "KML"),
        (b"<TrainingCenterDatabase>", "TCX"),
        (b"fgb\x03fgb\0", "FlatGeobuf"),
        (b"\xef\xbb\xbfname;Longitude;Latitude\r\n", "CSV"),
    ] {
        assert_eq!(of(head), Some(format), "{}", String::from_utf8_lossy(head));
    }
    for other in [&b"<dae/>"[..], b"hello, world", b"", b"MM\x40\0\0\0\x02\0", b"{\"a\":1}"] {
        assert_eq!(of(other), None, "{}", String::from_utf8_lossy(other));
    }
}

#[test]
fn names_tell_formats_by_their_longest_ending() {
    let of = |name: &str| of_name(Path::new(name)).map(|format| format.name);
    for (name, format) in [
        ("Alps.TIF", "GeoTIFF"),
        ("a.tar.gz", "tar"),
        ("a.raw.gz", "raw samples"),
        ("a.city.json", "CityJSON"),
        ("b.osm.bz2", "bzip2"),
        ("c.bz2", "bzip2"),
        ("1abc.ent", "PDB"),
    ] {
        assert_eq!(of(name), Some(format), "{name}");
    }
    assert_eq!(of("a.json"), None);
    assert!(City.may_read(Path::new("a.json")) && City.may_read(Path::new("a.shp")));
    assert!(!Mesh.may_read(Path::new("a.json")) && Mesh.reads(Path::new("a.GLB")));
}

#[test]
fn no_ending_belongs_to_two_formats() {
    // But for that of grids and of atoms, which their contents tell apart.
    let others = FORMATS.iter().filter(|format| format.name != "XYZ of atoms");
    let mut endings: Vec<_> = others.flat_map(|format| format.endings).collect();
    endings.sort();
    let all = endings.len();
    endings.dedup();
    assert_eq!(endings.len(), all);
    for format in FORMATS {
        assert!(format.endings.iter().all(|e| e.starts_with('.') && e.to_lowercase() == **e), "{}", format.name);
        assert!(format.reader.is_some() || !format.meanwhile.is_empty(), "{}", format.name);
    }
}
