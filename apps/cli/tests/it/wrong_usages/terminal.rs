//! Names from files and command lines cannot steer the terminal: control characters are written out, lines stay single.

use super::good::SCENE;
use super::usage::usage;

/// Characters that colour, erase, ring, break lines or turn the direction of reading.
const EVIL: &str = "a\u{1b}[31m\u{7}\u{9b}2J\u{202e}b";

/// EVIL as TOML, JSON and XML write it.
const AS_TOML: &str = "a\\u001b[31m\\u0007\\u009b2J\\u202eb";

fn steers(text: &str) -> bool {
    text.chars().any(|c| c.is_control() && c != '\n' && c != '\t' || c == '\u{202e}')
}

#[test]
fn names_from_files_are_printed_without_control_characters() {
    let id = SCENE.replace("id = 'way'", &format!("id = \"{AS_TOML}\""));
    let title = SCENE.replace("'hill'", &format!("\"{AS_TOML}\\n\""));
    let unknown = SCENE.replace("must_see", &format!("\"{AS_TOML}\""));
    let value = SCENE.replace("'route.gpx'", &format!("\"{AS_TOML}\\nmore\""));
    let track = |name: &str| {
        format!(
            "<gpx version=\"1.1\"><trk><name>{name}</name><trkseg><trkpt lat=\"46.009\" lon=\"10.002\"/><trkpt lat=\"46.009\" lon=\"10.009\"/></trkseg></trk></gpx>"
        )
    };
    let property = format!(
        r#"{{"type":"Feature","properties":{{"{AS_TOML}\n":"{AS_TOML}"}},"geometry":{{"type":"Point","coordinates":[10.004,46.004]}}}}"#
    );
    let evil = |line: &str| {
        let mut usage = usage(line);
        usage.words.iter_mut().for_each(|word| *word = word.replace("EVIL", EVIL));
        usage
    };
    for usage in [
        usage("check s.toml").file("s.toml", id.clone()),
        usage("show s.toml").file("s.toml", title),
        usage("check s.toml").file("s.toml", unknown),
        usage("check s.toml").file("s.toml", value),
        usage("measure s.toml").file("s.toml", id),
        usage("info way.geojson").file("way.geojson", property.clone()),
        usage("info way.geojson --name-field x").file("way.geojson", property),
        usage("info route.gpx").file("route.gpx", track("a&#27;[31m&#x9b;2Jb&#x202e;")),
        usage("reveal dem.asc route.gpx -o x.png --size 64x48 --eye 10.006,45.995,1500 --look 10.006,46.009 --labels")
            .file("route.gpx", track("a&#x9b;2Jb&#x202e;")),
        evil("info EVIL.tif"),
        evil("check EVIL"),
        evil("render scene.toml -o EVIL/x.png"),
        evil("render scene.toml -o x.png --size EVIL"),
        evil("EVIL"),
        evil("reveal cube.obj -o x.png --see EVIL"),
        evil("preset show EVIL"),
    ] {
        let answer = usage.run();
        assert!(!steers(&answer.said), "{}: {:?}", usage.title(), answer.said);
        assert!(!steers(&answer.printed), "{}: {:?}", usage.title(), answer.printed);
        let errors = answer.said.lines().filter(|line| !line.contains("warning: ")).count();
        assert_eq!(errors, usize::from(answer.code == Some(2)), "{}: {}", usage.title(), answer.said);
    }
}

#[test]
fn errors_have_at_most_500_characters() {
    let long = "x".repeat(5000);
    for usage in [
        usage(&format!("info {long}.tif")),
        usage(&format!("{long} dem.asc")),
        usage(&format!("render scene.toml -o x.png --size {long}")),
        usage(&format!("reveal cube.obj -o x.png --see {long}")),
        usage("check s.toml").file("s.toml", format!("{SCENE}{long} = 3\n")),
        usage("check s.toml").file("s.toml", SCENE.replace("dem.asc", &long)),
        usage("info way.geojson").file("way.geojson", format!("{{\"type\": \"{long}\"}}")),
    ] {
        let answer = usage.run();
        let length = answer.said.trim_end().chars().count();
        assert!(
            answer.code == Some(2) && length <= 500 && answer.said.lines().count() == 1,
            "{length}: {}",
            answer.said
        );
    }
}
