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
        (format!("{HEAD}{DNA}style.color = 'blue'\n"), "or one of auto, element, chain, residue and structure"),
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

/// Two chains' worth of one: a file with an assembly of three copies and two models.
const TRIMER: &str = "\
REMARK 350 BIOMOLECULE: 1
REMARK 350 APPLY THE FOLLOWING TO CHAINS: A
REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000
REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000
REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000
REMARK 350   BIOMT1   2  1.000000  0.000000  0.000000        0.00000
REMARK 350   BIOMT2   2  0.000000  1.000000  0.000000        0.00000
REMARK 350   BIOMT3   2  0.000000  0.000000  1.000000       12.00000
REMARK 350   BIOMT1   3  1.000000  0.000000  0.000000        0.00000
REMARK 350   BIOMT2   3  0.000000  1.000000  0.000000        0.00000
REMARK 350   BIOMT3   3  0.000000  0.000000  1.000000      -12.00000
MODEL        1
ATOM      1  CA  ALA A   1      -5.700   0.000   0.000  1.00  0.00           C
ATOM      2  CB  ALA A   1      -5.700   0.000   1.530  1.00  0.00           C
ATOM      3  CA  ALA A   2      -1.900   0.000   0.000  1.00  0.00           C
ATOM      4  CA  ALA A   3       1.900   0.000   0.000  1.00  0.00           C
ATOM      5  CA  ALA A   4       5.700   0.000   0.000  1.00  0.00           C
ENDMDL
MODEL        2
ATOM      1  CA  ALA A   1      -5.700   0.000   5.000  1.00  0.00           C
ATOM      2  CB  ALA A   1      -5.700   0.000   6.530  1.00  0.00           C
ATOM      3  CA  ALA A   2      -1.900   0.000   5.000  1.00  0.00           C
ATOM      4  CA  ALA A   3       1.900   0.000   5.000  1.00  0.00           C
ATOM      5  CA  ALA A   4       5.700   0.000   5.000  1.00  0.00           C
ENDMDL
";

#[test]
fn representations_assemblies_and_models_are_chosen_on_the_command_line_and_in_scenes() {
    let place = Place::new();
    place.write("t.pdb", TRIMER);
    let layer = "[[layer]]\nkind = 'molecule'\nid = 't'\nsource = 't.pdb'\n";
    place.write("s.toml", &format!("{HEAD}{layer}"));
    let record_of = |name: &str| -> serde_json::Value {
        serde_json::from_slice(&read(&place.path(&format!("{name}.json")))).expect("a record")
    };
    let record = |name: &str| record_of(name)["molecules"][0].clone();
    let mut pictures = Vec::new();
    for kind in ["ball-and-stick", "spheres", "sticks", "ribbon", "surface"] {
        let name = format!("{kind}.png");
        let said = place.run(&["render", "s.toml", "--representation", kind, "--assembly", "1", "-o", &name]);
        assert!(said.status.success(), "{kind}: {}", String::from_utf8_lossy(&said.stderr));
        let m = record(&name);
        assert_eq!(m["drawn_atoms"], 15, "{kind}: {m}");
        assert!(m["triangles"].as_u64().is_some_and(|count| count > 1000), "{kind}: {m}");
        pictures.push(record_of(&name)["picture_sha256"].clone());
    }
    pictures.sort_unstable_by_key(ToString::to_string);
    pictures.dedup();
    assert_eq!(pictures.len(), 5, "each is drawn in another way: {pictures:?}");
    // Pieces of ribbons are named by their residues; chains of copies by their number.
    place.write("r.toml", &format!("{HEAD}{layer}assembly = '1'\nstyle.representation = 'cartoon'\n"));
    place.write("at.json", "[[1.9, 0, 0], [1.9, 0, 12], [1.9, 0, 5]]");
    let pick = |scene: &str| {
        let images = place.json(&["project", scene, "--points", "at.json"]);
        let pixels: Vec<_> = (0..3).map(|i| images["points"][i]["pixel"].clone()).collect();
        place.write("p.json", &serde_json::json!(pixels).to_string());
        let answer = place.json(&["pick", scene, "--pixels", "p.json"]);
        (0..3).map(|i| answer["pixels"][i]["feature"].as_str().map(str::to_owned)).collect::<Vec<_>>()
    };
    assert_eq!(pick("r.toml"), [Some("chain A ALA 3".to_owned()), Some("chain A-2 ALA 3".to_owned()), None]);
    place.write("m.toml", &format!("{HEAD}{layer}model = 2\nstyle.representation = 'space_filling'\n"));
    assert_eq!(pick("m.toml"), [None, None, Some("atom CA of chain A ALA 3".to_owned())]);
    let info = place.json(&["info", "t.pdb", "--json"]);
    let file = &info["files"][0];
    assert_eq!(
        (&file["models"], &file["assemblies"][0]["copies"], &file["assemblies"][0]["atoms"]),
        (&2.into(), &3.into(), &15.into())
    );
    // What is in the file and not drawn is told.
    let said = place.run(&["check", "s.toml"]);
    let said = String::from_utf8_lossy(&said.stderr).into_owned() + &String::from_utf8_lossy(&said.stdout);
    assert!(said.contains("describes assembly 1 of 3 copies (15 atoms)"), "{said}");
}

#[test]
fn wrong_assemblies_and_models_are_told_in_one_line() {
    let place = Place::new();
    place.write("t.pdb", TRIMER);
    let layer = "[[layer]]\nkind = 'molecule'\nid = 't'\nsource = 't.pdb'\n";
    for (keys, said) in [
        ("assembly = '7'", "there is no assembly \"7\", the file describes 1"),
        ("model = 0", "models are counted from 1"),
        ("model = 3", "it holds 2 models, there is no model 3"),
        ("models_per_s = 0.0", "models_per_s is 0, it must be greater than 0"),
        ("models_per_s = 5.0\nmodel = 1", "leave one of them out"),
        ("models_per_s = 5.0\nassembly = '1'", "leave assembly or models_per_s out"),
        ("style.sticks = 'chian A'", "is no word of selections"),
        ("style.representation = 'balls'", "balls"),
    ] {
        place.write("s.toml", &format!("{HEAD}{layer}{keys}\n"));
        let out = place.run(&["check", "s.toml"]);
        let text = String::from_utf8_lossy(&out.stderr).into_owned();
        assert!(!out.status.success() && text.contains(said) && text.len() < 600, "{keys}: {text}");
    }
    place.write("d.toml", &format!("{HEAD}{DNA}"));
    let out = place.run(&["render", "d.toml", "--assembly", "1", "-o", "a.png"]);
    let text = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(!out.status.success() && text.contains("built-in molecules have none"), "{text}");
    let camera = "format = 1\n[camera]\neye = [0, -80, 10]\nlook_at = [0, 0, 0]\nimage = [40, 40]\n";
    place.write("p.toml", &format!("{camera}[[layer]]\nkind = 'volume'\nid = 'v'\nsource = 'builtin:tube'\n"));
    let out = place.run(&["render", "p.toml", "--representation", "ribbon", "-o", "a.png"]);
    let text = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(!out.status.success() && text.contains("--representation is for molecules, and there is none"), "{text}");
}

#[test]
fn models_follow_each_other_in_films() {
    let place = Place::new();
    place.write("t.pdb", TRIMER);
    let layer = "[[layer]]\nkind = 'molecule'\nid = 't'\nsource = 't.pdb'\nmodels_per_s = 10.0\nstyle.representation = 'space_filling'\n";
    // A camera that stands still.
    place.write(
        "path.json",
        r#"[{"eye": [0, -80, 10], "look_at": [0, 0, 0]}, {"eye": [0, -80, 10], "look_at": [0, 0, 0.001]}]"#,
    );
    place.write("s.toml", &format!("{HEAD}{layer}[animation]\nfps = 10\ncamera = 'path.json'\n"));
    place.ok(&["animate", "s.toml", "-o", "film", "--frames", "3"]);
    let frames: Vec<Vec<u8>> = std::fs::read_dir(place.path("film"))
        .map(|all| {
            let mut all: Vec<_> = all.filter_map(|f| Some(f.ok()?.path())).collect();
            all.retain(|path| path.extension().is_some_and(|e| e == "png"));
            all.sort();
            all.iter().map(|path| read(path)).collect()
        })
        .expect("frames");
    assert_eq!(frames.len(), 3);
    assert!(frames[0] != frames[1], "the second model");
}

/// A DCD file of frames of atoms, as NAMD writes it without a unit cell.
fn dcd(frames: &[Vec<[f32; 3]>]) -> Vec<u8> {
    let record = |content: Vec<u8>| {
        let length = (content.len() as u32).to_le_bytes();
        [&length[..], &content, &length].concat()
    };
    let words = |words: &[u32]| words.iter().flat_map(|w| w.to_le_bytes()).collect::<Vec<u8>>();
    let mut control = [0u32; 20];
    (control[0], control[2], control[19]) = (frames.len() as u32, 1, 24);
    let mut out = record([b"CORD".to_vec(), words(&control)].concat());
    out.extend(record([words(&[1]), vec![b' '; 80]].concat()));
    out.extend(record(words(&[frames[0].len() as u32])));
    for frame in frames {
        for axis in 0..3 {
            out.extend(record(frame.iter().flat_map(|p| p[axis].to_le_bytes()).collect()));
        }
    }
    out
}

#[test]
fn a_trajectory_moves_its_atoms_and_a_camera_follows_them() {
    let place = Place::new();
    place.write("w.pdb", WATER);
    let at = |x: f32| vec![[x, 0.0, 0.0], [x + 0.96, 0.0, 0.0], [x, 0.0, 8.0]];
    let frames: Vec<_> = (0..40).map(|k| at(0.5 * k as f32)).collect();
    std::fs::write(place.path("w.dcd"), dcd(&frames)).expect("written");
    std::fs::write(place.path("two.dcd"), dcd(&[vec![[0.0; 3]; 2]])).expect("written");
    let layer = "[[layer]]\nkind = 'molecule'\nid = 'w'\nsource = 'w.pdb'\nstyle.selection = 'all'\nstyle.representation = 'space_filling'\n";
    let scene = |keys: &str, animation: &str| format!("{HEAD}{layer}{keys}\n[animation]\nfps = 10\n{animation}\n");
    let film = |name: &str, text: &str| -> (Vec<f64>, usize) {
        place.write("s.toml", text);
        place.ok(&["animate", "s.toml", "-o", name]);
        let manifest = read(&place.path(&format!("{name}/animation.json")));
        let manifest: serde_json::Value = serde_json::from_slice(&manifest).expect("json");
        let frames = manifest["frames"].as_array().expect("frames");
        let eyes = frames.iter().map(|frame| frame["view"]["eye"][0].as_f64().expect("a number")).collect();
        let mut pictures: Vec<&str> = frames.iter().filter_map(|frame| frame["sha256"].as_str()).collect();
        pictures.sort_unstable();
        pictures.dedup();
        (eyes, pictures.len())
    };
    // Every fourth of forty frames, ten per second: one per frame of the film.
    let keys = "trajectory = 'w.dcd'\ntrajectory_every = 4\nmodels_per_s = 10.0";
    let (eyes, pictures) = film("free", &scene(keys, ""));
    assert!(eyes == [0.0; 10] && pictures == 10, "{eyes:?} {pictures}");
    let (eyes, pictures) = film("followed", &scene(keys, "follow = 'w'"));
    // The atoms move by two angstrom a frame; at the ends, where they start and stop, the camera lags behind.
    assert!(eyes.windows(2).all(|pair| (0.3..2.1).contains(&(pair[1] - pair[0]))), "{eyes:?}");
    assert!((6.0..18.1).contains(&eyes[9]) && pictures == 10, "{eyes:?}");
    // A molecule as a whole moves by a file, too.
    place.write("m.csv", "t,x,y,z\n0,0,0,0\n1,20,0,0\n");
    let (_, pictures) = film("pushed", &scene("motion = 'm.csv'", "frames = 3"));
    assert_eq!(pictures, 3);
    // Data alone, by an option.
    place.ok(&["animate", "w.pdb", "--trajectory", "w.dcd", "-o", "alone", "--frames", "2", "--size", "40x40"]);
    for (keys, animation, said) in [
        ("trajectory = 'two.dcd'", "", "trajectory two.dcd has 2 atoms, the source 3"),
        ("trajectory = 'w.pdb'", "", "which is neither XTC nor DCD"),
        ("trajectory = 'gone.xtc'", "", "gone.xtc"),
        ("trajectory = 'w.dcd'\ntrajectory_every = 0", "", "trajectory_every"),
        ("trajectory_every = 2", "turntable = { deg_per_s = 9 }", "trajectory_every"),
        ("trajectory = 'w.dcd'\nmodel = 'all'", "", "leave model or trajectory out"),
        (keys, "follow = 'v'", "\"v\" is no layer that moves"),
    ] {
        place.write("s.toml", &scene(keys, animation));
        let text = place.fails(&["animate", "s.toml", "-o", "bad"]);
        assert!(text.contains(said), "{keys}: {text}");
    }
    let text = place.ok(&["info", "w.dcd"]);
    assert!(text.contains("name it as trajectory"), "{text}");
}
