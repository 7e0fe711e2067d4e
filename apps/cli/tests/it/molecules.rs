//! Molecules through the command line: described, drawn, picked, chosen from.

use super::{Place, read};

const HEAD: &str = "format = 1\nunit = 'angstrom'\n[camera]\neye = [0, -80, 10]\nlook_at = [0, 0, 0]\nfov_y_deg = 35\nimage = [200, 200]\n";
const DNA: &str = "[[layer]]\nkind = 'molecule'\nid = 'dna'\nsource = 'builtin:dna?pairs=8&seed=2'\n";

const WATER: &str = "\
HETATM    1  O   HOH A   1       0.000   0.000   0.000  1.00  0.00           O
HETATM    2  H1  HOH A   1       0.960   0.000   0.000  1.00  0.00           H
ATOM      3  FE  HEM B   7       0.000   0.000   8.000  1.00  0.00          FE
";

#[test]
fn an_atom_is_named_where_it_is_picked() {
    let place = Place::new();
    place.write("w.pdb", WATER);
    let layer = "[[layer]]\nkind = 'molecule'\nid = 'w'\nsource = 'w.pdb'\nstyle.selection = 'all'\n";
    place.write("s.toml", &format!("{HEAD}{layer}"));
    place.write("at.json", "[[0, 0, 0], [0, 0, 8], [0, 0, 4]]");
    let images = place.json(&["project", "s.toml", "--points", "at.json"]);
    let pixels: Vec<_> = (0..3).map(|i| images["points"][i]["pixel"].clone()).collect();
    place.write("p.json", &serde_json::json!(pixels).to_string());
    let answer = place.json(&["pick", "s.toml", "--pixels", "p.json"]);
    let features: Vec<_> = (0..3).map(|i| answer["pixels"][i]["feature"].as_str()).collect();
    assert_eq!(features, [Some("atom O of chain A HOH 1"), Some("atom FE of chain B HEM 7"), None], "{answer}");
    assert_eq!(answer["pixels"][0]["layer"], "w");
    let check = place.ok(&["check", "s.toml"]);
    assert!(check.contains("w (molecule): 3"), "{check}");
}

#[test]
fn the_record_counts_atoms_and_bonds_and_info_describes_files() {
    let place = Place::new();
    place.write("w.pdb", WATER);
    place.write(
        "s.toml",
        &format!("{HEAD}{DNA}select = 'resi 3'\nstyle = {{ selection = 'chain A', color = 'chain' }}\n"),
    );
    place.ok(&["render", "s.toml", "-o", "a.png"]);
    let record: serde_json::Value = serde_json::from_slice(&read(&place.path("a.png.json"))).expect("a record");
    let m = &record["molecules"][0];
    let count = |key: &str| m[key].as_u64().unwrap_or_else(|| panic!("{m}"));
    assert!(count("atoms") > 300 && count("drawn_atoms") * 2 < count("atoms") + 20, "{m}");
    assert!(count("drawn_bonds") > count("drawn_atoms") && count("triangles") > 10_000, "{m}");
    let info = place.json(&["info", "w.pdb", "--json"]);
    let file = &info["files"][0];
    assert_eq!(
        (file["atoms"].as_u64(), file["bonds"].as_u64(), file["waters"].as_u64()),
        (Some(3), Some(1), Some(1)),
        "{info}"
    );
    assert_eq!(file["elements"]["Fe"], 1);
}

#[test]
fn water_is_left_out_with_a_word_unless_it_is_asked_for() {
    let place = Place::new();
    place.write("w.pdb", WATER);
    place.write("s.toml", &format!("{HEAD}[[layer]]\nkind = 'molecule'\nid = 'w'\nsource = 'w.pdb'\n"));
    let out = place.run(&["check", "s.toml"]);
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(said.contains("2 atoms of water are not drawn"), "{said}");
    assert!(String::from_utf8_lossy(&out.stdout).contains("w (molecule): 1"));
}

#[test]
fn mistakes_are_told_in_one_line() {
    let place = Place::new();
    for (scene, said) in [
        (
            HEAD.replace("unit = 'angstrom'\n", "") + DNA,
            "molecules are measured in angstrom; write unit = \"angstrom\"",
        ),
        (format!("{HEAD}{DNA}select = 'chian A'\n"), "\"chian\" is no word of selections"),
        (
            format!("{HEAD}{DNA}select = 'chain Z'\n"),
            "matches none of the 322 atoms; chains are A, B, residues are numbered 1 to 16",
        ),
        (format!("{HEAD}{DNA}style.selection = 'water'\n"), "matches none of the"),
        (format!("{HEAD}{DNA}select = 'chain A'\nstyle.selection = 'chain B'\n"), "is drawn by style.selection"),
        (format!("{HEAD}{DNA}style.color = 'blue'\n"), "or one of element, chain and residue"),
        (format!("{HEAD}{}", DNA.replace("pairs=8", "pairs=1")), "DNA of 1 base pairs is not possible"),
        (format!("{HEAD}{}", DNA.replace("pairs", "pears")), "pairs=N (dna)"),
    ] {
        place.write("s.toml", &scene);
        let line = place.fails(&["check", "s.toml"]);
        assert!(line.contains(said), "{said}: {line}");
    }
}

#[test]
fn the_ready_scene_shows_what_the_front_helix_hides() {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/dna.toml");
    let answer = Place::new().json(&["measure", scene]);
    let share = |picture: &str, method: &str| answer["surfaces"][picture][method]["share"].as_f64().expect("a share");
    for method in ["sight", "buffer"] {
        assert!(share("straight", method) < 0.01 && share("bent", method) > 0.28, "{method}: {answer}");
    }
    assert!((share("bent", "sight") - share("bent", "buffer")).abs() < 0.02, "{answer}");
}
