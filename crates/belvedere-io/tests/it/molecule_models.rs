//! Molecules of several models, and atoms of XYZ.

use crate::support_files::Folder;
use belvedere_core::WarningKind;
use belvedere_io::{
    Arrays, Known, Limits, Loaded, Models, MoleculeFile, formats::Reader, load_frames, load_model, load_molecule,
    load_terrain,
};
use belvedere_scene::Progress;
use belvedere_scene::molecule::Selection;
use belvedere_testkit::data;
use std::path::Path;

fn load(path: &Path, models: Models) -> Loaded<MoleculeFile> {
    load_model(path, models, &Limits::default()).unwrap_or_else(|e| panic!("{e}"))
}

const WATERS: &str = "3\nframe 1\nO 0.000 0.000 0.117\nH 0.000 0.757 -0.469\nH 0.000 -0.757 -0.469\n\
    3\nframe 2\nO 0.100 0.000 0.117\nH 0.100 0.757 -0.469\nH 0.100 -0.757 -0.469\n";

#[test]
fn an_assembly_written_as_models_has_all_of_them() {
    let Some(path) = data("cases/files/m08_assembly.pdb") else { return };
    let one = load(&path, Models::First);
    let said = one.warnings.iter().find(|w| w.text().contains("4 models")).expect("said");
    assert!(said.text().contains("model = \"all\"") && said.key() == Some("model"), "{said:?}");
    let all = load(&path, Models::All);
    assert!(all.warnings.iter().all(|w| !w.text().contains("models")), "{:?}", all.warnings);
    let (one, all) = (one.value.molecule, all.value.molecule);
    assert_eq!((all.atoms().len(), all.bonds().len()), (4 * one.atoms().len(), 4 * one.bonds().len()));
    let chains: Vec<String> = all.chains().into_iter().map(|chain| chain.to_string()).collect();
    assert_eq!(chains.len(), 4 * one.chains().len(), "{chains:?}");
    let n = one.atoms().len();
    let apart: Vec<f64> =
        (1..4).map(|k| all.atoms()[k * n].position.distance(all.atoms()[(k - 1) * n].position)).collect();
    assert!(apart.iter().all(|d| *d > 10.0), "{apart:?}");
    assert_eq!(Selection::parse("copy 3").unwrap().mask(&all).iter().filter(|m| **m).count(), n);
}

#[test]
fn models_over_one_another_share_no_bonds_whatever_the_format() {
    let folder = Folder::new();
    let atom = |model: usize, serial: usize, x: f64| {
        (
            format!("ATOM  {serial:>5}  C{serial}  LIG A   1    {x:8.3}   0.000   0.000  1.00  0.00           C\n"),
            format!("ATOM {serial} C C{serial} LIG A 1 {x} 0 0 {model}\n"),
        )
    };
    let (mut pdb, mut cif) = (String::new(), "data_a\nloop_\n".to_owned());
    for key in "group_PDB id type_symbol label_atom_id label_comp_id label_asym_id label_seq_id Cartn_x Cartn_y Cartn_z pdbx_PDB_model_num".split(' ') {
        cif += &format!("_atom_site.{key}\n");
    }
    for model in 1..=3 {
        pdb += &format!("MODEL     {model:>4}\n");
        for serial in 1..=2 {
            let (line, row) = atom(model, serial, 1.4 * serial as f64 + 0.05 * model as f64);
            pdb += &line;
            cif += &row;
        }
        pdb += "ENDMDL\n";
    }
    for path in [folder.file("a.pdb", pdb.as_bytes()), folder.file("a.cif", cif.as_bytes())] {
        let all = load(&path, Models::All).value;
        assert_eq!((all.models, all.molecule.atoms().len()), (3, 6), "{}", path.display());
        assert_eq!(all.molecule.bonds(), &[[0, 1], [2, 3], [4, 5]], "{}", path.display());
        let error = load_model(&path, Models::Number(4), &Limits::default()).unwrap_err().to_string();
        assert!(error.contains("it holds 3 models, there is no model 4"), "{error}");
    }
}

#[test]
fn xyz_of_atoms_is_told_from_a_grid_by_its_content() {
    let folder = Folder::new();
    let path = folder.file("water.xyz", WATERS.as_bytes());
    let reader = |path: &Path| Known::of(path, &Arrays::default()).expect("a file").reader;
    assert_eq!(reader(&path), Some(Reader::Molecule));
    assert_eq!(reader(&folder.file("nameless", WATERS.as_bytes())), Some(Reader::Molecule));
    let grid = "0 0 1\n1 0 2\n0 1 3\n1 1 4\n";
    let ground = folder.file("ground.xyz", grid.as_bytes());
    assert_eq!(reader(&ground), Some(Reader::Terrain));
    let loaded = load(&path, Models::First);
    let m = &loaded.value.molecule;
    let symbols: Vec<&str> = m.atoms().iter().map(|a| a.element.symbol()).collect();
    assert_eq!((loaded.value.format, loaded.value.models, symbols), ("XYZ", 2, vec!["O", "H", "H"]));
    assert_eq!(m.bonds(), &[[0, 1], [0, 2]]);
    assert!(loaded.warnings.iter().any(|w| w.text().contains("2 models; the first is taken")));
    assert_eq!(load(&path, Models::All).value.molecule.atoms().len(), 6);
    assert!((load(&path, Models::Number(2)).value.molecule.atoms()[0].position.x - 0.1).abs() < 1e-12);
    assert_eq!(load_frames(&path, &Limits::default()).unwrap().value.frames.len(), 2);
    // Each as the other.
    let error = load_terrain(&[path], &Default::default(), &Progress::silent()).unwrap_err().to_string();
    assert!(error.contains("XYZ of atoms") && error.contains("layers of kind molecule"), "{error}");
    let error = load_molecule(&ground, &Limits::default()).unwrap_err().to_string();
    assert!(error.contains("not a molecule: PDB, mmCIF or XYZ"), "{error}");
}

#[test]
fn xyz_has_numbers_for_elements_more_columns_and_the_extended_form() {
    let folder = Folder::new();
    let symbols = |text: &str| -> Vec<String> {
        let file = load(&folder.file("a.xyz", text.as_bytes()), Models::First).value;
        let of = |a: &belvedere_scene::molecule::Atom| format!("{} {}", a.element.symbol(), a.position.x);
        file.molecule.atoms().iter().map(of).collect()
    };
    assert_eq!(symbols("  2 \r\n\r\n6 1 0 0\r\n8\t2.2 0 0\r\n"), ["C 1", "O 2.2"]);
    assert_eq!(symbols("2\nq\nFE1 1 0 0 0.5 0.1\nQq 4 0 0\n"), ["Fe 1", "X 4"]);
    let extended =
        "1\nLattice=\"5 0 0 0 5 0 0 0 5\" Properties=species:S:1:pos:R:3:forces:R:3 pbc=\"T T T\"\nSi 1.5 0 0 9 9 9\n";
    assert_eq!(symbols(extended), ["Si 1.5"]);
    let moved = "1\nProperties=species:S:1:id:I:1:pos:R:3\nSi 7 1.5 0 0\n";
    assert_eq!(symbols(moved), ["Si 1.5"]);
}

#[test]
fn xyz_that_is_cut_or_damaged_gives_what_is_whole_or_one_error() {
    let folder = Folder::new();
    let mut before = 0;
    for cut in 0..=WATERS.len() {
        let path = folder.file("a.xyz", &WATERS.as_bytes()[..cut]);
        match load_model(&path, Models::All, &Limits::default()) {
            Ok(loaded) => {
                let count = loaded.value.molecule.atoms().len();
                assert!(count >= before && count <= 6, "{cut}: {count} after {before}");
                let said = loaded.warnings.iter().any(|w| w.kind() == WarningKind::Repaired);
                assert!(said || count == 3 || count == 6, "{cut}: {:?}", loaded.warnings);
                before = count;
            }
            Err(error) => {
                assert!(before == 0, "{cut}: {error}");
                assert!(!error.to_string().contains('\n'), "{error}");
            }
        }
    }
    assert_eq!(before, 6);
    for (text, want) in [
        ("2\n\nC 0 0 0\nC 0 x 0\n", "line 4: an atom is \"C 0 x 0\""),
        ("1\n\nC 0 0 0\nmore\nlines\n", "line 4 is \"more\", the number of atoms of a frame is needed"),
    ] {
        let path = folder.file("a.xyz", text.as_bytes());
        let error = load_model(&path, Models::All, &Limits::default()).unwrap_err().to_string();
        assert!(error.contains(want), "{error}");
    }
}
