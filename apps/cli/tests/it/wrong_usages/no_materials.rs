//! Models whose materials are missing open all the same, and say which file is missing.

use super::good::MODEL;
use super::usage::usage;

const HEAD: &str = "mtllib wallhole.mtl\nv -1 0 -1\nv 1 0 -1\nv 0 0 1\n";

#[test]
fn a_model_without_its_materials_opens_with_a_warning_that_names_the_file() {
    for faces in [
        "usemtl red\nf 1 2 3\n",
        "usemtl\nf 1 2 3\n",
        "usemtl\tred\nf 1 2 3\n",
        "g a\nusemtl \nf 1 2 3\nusemtl red\nf 3 2 1\n",
    ] {
        let scene = MODEL.replace("cube.obj", "wallhole.obj");
        let files =
            |line: &str| usage(line).file("wallhole.obj", format!("{HEAD}{faces}")).file("s.toml", scene.clone());
        let answer = files("info wallhole.obj").run();
        assert_eq!(answer.code, Some(0), "{faces}: {}", answer.said);
        assert!(answer.printed.contains("its file of materials \"wallhole.mtl\" cannot be read"), "{}", answer.printed);
        let answer = files("render s.toml -o x.png").run();
        assert_eq!(answer.code, Some(0), "{faces}: {}", answer.said);
        assert!(
            answer.said.contains("wallhole.mtl") && answer.said.contains("the colour of the layer is used"),
            "{}",
            answer.said
        );
    }
}
