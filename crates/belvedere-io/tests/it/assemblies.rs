//! Biological assemblies, models, stated structure and orders of bonds: of real files, and of made-up ones that say the same in both formats.

use belvedere_io::{Limits, Loaded, Models, MoleculeFile, load_model, load_molecule};
use belvedere_scene::molecule::{Secondary, Selection};
use belvedere_testkit::data;
use glam::DVec3;

fn made(name: &str, text: &str, model: Option<usize>) -> Result<Loaded<MoleculeFile>, String> {
    let folder = tempfile::tempdir().expect("temporary folder");
    let path = folder.path().join(name);
    std::fs::write(&path, text).expect("written");
    load_model(&path, model.map_or(Models::First, Models::Number), &Limits::default()).map_err(|e| e.to_string())
}

#[test]
fn the_capsid_has_twelve_copies_of_its_fifteen_chains_none_of_them_distorted() {
    let Some(path) = data("molecules/4yvs.cif") else { return };
    let file = load_molecule(&path, &Limits::default()).expect("readable").value;
    let m = &file.molecule;
    let all = file.assemblies.list();
    assert_eq!(all.len(), 1);
    assert_eq!((all[0].id.as_str(), all[0].details.as_str()), ("1", "180-meric"));
    assert_eq!((all[0].copies, all[0].atoms), (12, 12 * 26_430));
    let whole = file.assemblies.assemble(m, "1", &Limits::default()).expect("made");
    assert_eq!((whole.atoms().len(), whole.chains().len()), (317_160, 180));
    assert_eq!(whole.bonds().len(), 12 * m.bonds().len());
    // Distances within a copy are those of the file; the middle of each copy lies as far from the centre.
    let n = m.atoms().len();
    let middle = |from: usize| whole.atoms()[from..from + n].iter().map(|a| a.position).sum::<DVec3>() / n as f64;
    let far = middle(0).length();
    assert!(far > 30.0, "{far}");
    for copy in 0..12 {
        assert!((middle(copy * n).length() - far).abs() < 1e-6);
        for (i, k) in [(0, n - 1), (17, 12_345), (400, 401), (9000, 20_000)] {
            let [here, there] = [(m, 0), (&whole, copy * n)]
                .map(|(m, from)| m.atoms()[from + i].position.distance(m.atoms()[from + k].position));
            assert!((here - there).abs() < 1e-9, "{copy}");
        }
    }
    // No two copies stand at one place.
    for copy in 1..12 {
        assert!(middle(copy * n).distance(middle(0)) > 10.0, "{copy}");
    }
    let count = |text: &str| Selection::parse(text).unwrap().mask(&whole).iter().filter(|b| **b).count();
    let one = count("chain A and copy 1");
    assert!(one > 1700 && count("chain A") == 12 * one && count("chain A-12") == one);
}

#[test]
fn a_dimer_of_dna_is_made_with_its_ions_and_water() {
    let Some(path) = data("molecules/4zkk.cif") else { return };
    let file = load_molecule(&path, &Limits::default()).expect("readable").value;
    let whole = file.assemblies.assemble(&file.molecule, "1", &Limits::default()).expect("made");
    assert_eq!(whole.atoms().len(), 2 * 229);
    assert_eq!(whole.chains(), ["A", "A-2"]);
}

#[test]
fn stated_structure_is_that_of_the_records() {
    for (name, helix, strand) in [("1kx5.pdb", true, true), ("4yvs.cif", true, true), ("1bna.pdb", false, false)] {
        let Some(path) = data(&format!("molecules/{name}")) else { continue };
        let m = load_molecule(&path, &Limits::default()).expect("readable").value.molecule;
        let count = |kind| m.structure().iter().filter(|s| **s == kind).count();
        let found = (count(Secondary::Helix), count(Secondary::Strand));
        assert_eq!((found.0 > 100, found.1 > 10), (helix, strand), "{name}: {found:?}");
        // The helices of a histone are those of its fold: half of the residues and more.
        if name == "1kx5.pdb" {
            assert!((400..700).contains(&found.0), "{found:?}");
        }
    }
}

const ATOM_LINES: &str = "\
ATOM      1  CA  ALA A   1       1.000   2.000   3.000  1.00  0.00           C
ATOM      2  CA  ALA A   2       4.800   2.000   3.000  1.00  0.00           C
ATOM      3  CA  ALA B   1      10.000   0.000   0.000  1.00  0.00           C
END
";

const REMARKS: &str = "\
REMARK 350 BIOMOLECULE: 1
REMARK 350 AUTHOR DETERMINED BIOLOGICAL UNIT: TETRAMERIC
REMARK 350 APPLY THE FOLLOWING TO CHAINS: A
REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000
REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000
REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000
REMARK 350   BIOMT1   2  0.000000 -1.000000  0.000000       50.00000
REMARK 350   BIOMT2   2  1.000000  0.000000  0.000000        0.50000
REMARK 350   BIOMT3   2  0.000000  0.000000  1.000000       -7.00000
REMARK 350 APPLY THE FOLLOWING TO CHAINS: B
REMARK 350   BIOMT1   1 -1.000000  0.000000  0.000000        0.00000
REMARK 350   BIOMT2   1  0.000000 -1.000000  0.000000        0.00000
REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        9.00000
REMARK 350
REMARK 350 BIOMOLECULE: 2
REMARK 350 APPLY THE FOLLOWING TO CHAINS: A,
REMARK 350                    AND CHAINS: B
REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000
REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000
REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000
";

/// The same as mmCIF; chains of the authors differ from those of the assemblies.
fn cif(expressions: [&str; 3], operations: &str) -> String {
    let [a, b, c] = expressions;
    format!(
        "data_X
loop_
_atom_site.group_PDB
_atom_site.id
_atom_site.type_symbol
_atom_site.label_atom_id
_atom_site.label_comp_id
_atom_site.label_asym_id
_atom_site.auth_asym_id
_atom_site.auth_seq_id
_atom_site.Cartn_x
_atom_site.Cartn_y
_atom_site.Cartn_z
ATOM 1 C CA ALA Q A 1 1 2 3
ATOM 2 C CA ALA Q A 2 4.8 2 3
ATOM 3 C CA ALA R B 1 10 0 0
loop_
_pdbx_struct_assembly_gen.assembly_id
_pdbx_struct_assembly_gen.oper_expression
_pdbx_struct_assembly_gen.asym_id_list
1 '{a}' Q
1 '{b}' R
2 '{c}' Q,R
_pdbx_struct_assembly.id 1
_pdbx_struct_assembly.oligomeric_details TETRAMERIC
loop_
_pdbx_struct_oper_list.id
_pdbx_struct_oper_list.matrix[1][1]
_pdbx_struct_oper_list.matrix[1][2]
_pdbx_struct_oper_list.matrix[1][3]
_pdbx_struct_oper_list.vector[1]
_pdbx_struct_oper_list.matrix[2][1]
_pdbx_struct_oper_list.matrix[2][2]
_pdbx_struct_oper_list.matrix[2][3]
_pdbx_struct_oper_list.vector[2]
_pdbx_struct_oper_list.matrix[3][1]
_pdbx_struct_oper_list.matrix[3][2]
_pdbx_struct_oper_list.matrix[3][3]
_pdbx_struct_oper_list.vector[3]
{operations}"
    )
}

const OPERATIONS: &str = "\
1 1 0 0 0 0 1 0 0 0 0 1 0
2 0 -1 0 50 1 0 0 0.5 0 0 1 -7
Z -1 0 0 0 0 -1 0 0 0 0 1 9
";

#[test]
fn both_formats_describe_the_same_assemblies() {
    let pdb = made("a.pdb", &format!("{REMARKS}{ATOM_LINES}"), None).expect("readable").value;
    let mmcif = made("a.cif", &cif(["(1-2)", "Z", "1"], OPERATIONS), None).expect("readable").value;
    for file in [&pdb, &mmcif] {
        let told: Vec<_> =
            file.assemblies.list().iter().map(|a| (a.id.as_str(), a.details.as_str(), a.copies, a.atoms)).collect();
        assert_eq!(told, [("1", "TETRAMERIC", 2, 5), ("2", "", 1, 3)], "{}", file.format);
    }
    for id in ["1", "2"] {
        assert_eq!(pdb.assemblies.operations(id).unwrap(), mmcif.assemblies.operations(id).unwrap());
        let [a, b] = [&pdb, &mmcif].map(|f| f.assemblies.assemble(&f.molecule, id, &Limits::default()).unwrap());
        assert_eq!(a, b, "{id}");
    }
    let whole = pdb.assemblies.assemble(&pdb.molecule, "1", &Limits::default()).unwrap();
    assert_eq!(whole.chains(), ["A", "A-2", "B"]);
    assert_eq!(whole.atoms()[2].position, DVec3::new(48.0, 1.5, -4.0));
    assert_eq!(whole.atoms()[4].position, DVec3::new(-10.0, 0.0, 9.0));
}

#[test]
fn assemblies_that_cannot_be_made_are_refused_in_one_line() {
    let refused = |text: String, id: &str, said: &str| {
        let file = made("a.cif", &text, None).expect("the atoms are read").value;
        let e = file.assemblies.assemble(&file.molecule, id, &Limits::default()).expect_err(said);
        assert!(e.contains(said) && e.lines().count() == 1 && e.len() <= 500, "{said}: {e}");
    };
    let many: String = (1..=100_000).map(|i| format!("{i} 1 0 0 {i} 0 1 0 0 0 0 1 0\n")).collect();
    refused(cif(["(1-100000)", "1", "1"], &many), "1", "has 100000 copies, at most 10000 are made");
    let absurd = "(1-18446744073709551615)(1-18446744073709551615)";
    refused(cif([absurd, "1", "1"], OPERATIONS), "1", "has 18446744073709551615 copies");
    refused(cif(["(1-3)", "Z", "1"], OPERATIONS), "1", "operation \"3\" has no matrix in the file");
    refused(cif(["1", "Z", "1"], OPERATIONS), "9", "there is no assembly \"9\", the file describes 1, 2");
    refused(cif(["1", "Z", "1"], &OPERATIONS.replace("2 0 -1 0 50", "2 0 -1 0 ?")), "9", "there is no assembly");
    refused(cif(["2", "Z", "1"], &OPERATIONS.replace("2 0 -1 0 50", "2 0 -1 0 ?")), "1", "a matrix is no rotation");
    refused(cif(["2", "Z", "1"], &OPERATIONS.replace("2 0 -1 0 50", "2 0 -7 0 50")), "1", "a matrix is no rotation");
    let none = made("a.pdb", ATOM_LINES, None).expect("readable").value;
    let e = none.assemblies.assemble(&none.molecule, "1", &Limits::default()).expect_err("none");
    assert!(e.contains("the file describes none; leave it out"), "{e}");
    // Little memory.
    let file = made("a.cif", &cif(["(1-2)", "Z", "1"], OPERATIONS), None).expect("readable").value;
    let e = file.assemblies.assemble(&file.molecule, "1", &Limits { max_bytes: 100 }).expect_err("too large");
    assert!(e.contains("copies of assembly 1"), "{e}");
    // What cannot be understood is told, and the rest stays.
    let loaded = made("a.cif", &cif(["(1-", "Z", "1"], OPERATIONS), None).expect("readable");
    let said: String = loaded.warnings.iter().map(|w| w.text()).collect();
    assert!(said.contains("assembly 1: the expression of operations \"(1-\" cannot be read"), "{said}");
    assert_eq!(loaded.value.assemblies.list().len(), 2);
}

#[test]
fn a_model_is_chosen_by_its_place() {
    let model = |number: usize, x: f64| {
        format!(
            "MODEL     {number:4}\nATOM      1  CA  ALA A   1    {x:8.3}   2.000   3.000  1.00  0.00           C\nENDMDL\n"
        )
    };
    // Numbers of models need not begin at 1.
    let pdb = [model(5, 1.0), model(9, 2.0), model(10, 3.0)].concat();
    let head = "data_X\nloop_\n_atom_site.id\n_atom_site.type_symbol\n_atom_site.label_atom_id\n_atom_site.label_comp_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n_atom_site.pdbx_PDB_model_num\n";
    let cif = format!("{head}1 C CA ALA 1 2 3 5\n2 C CA ALA 2 2 3 9\n3 C CA ALA 3 2 3 10\n");
    for (name, text) in [("a.pdb", &pdb), ("a.cif", &cif)] {
        for k in 1..=3usize {
            let loaded = made(name, text, Some(k)).expect("readable");
            assert_eq!(loaded.value.molecule.atoms()[0].position.x, k as f64, "{name}");
            assert_eq!((loaded.value.models, loaded.value.molecule.atoms().len()), (3, 1));
            assert!(loaded.warnings.iter().all(|w| !w.text().contains("models")), "it was chosen");
        }
        let e = made(name, text, Some(4)).expect_err("three");
        assert!(e.contains("it holds 3 models, there is no model 4; name one in 1..=3"), "{e}");
    }
}

#[test]
fn orders_of_bonds_are_told_by_connections_and_tables() {
    let line = |i: usize, name: &str, x: f64| {
        format!("HETATM{i:5}  {name:<3} LIG A   1    {x:8.3}   0.000   0.000  1.00  0.00           C\n")
    };
    let pdb = [
        &line(1, "C1", 0.0),
        &line(2, "C2", 1.3),
        &line(3, "C3", 2.5),
        &line(4, "C4", 4.0),
        "CONECT    1    2    2\nCONECT    2    1    1    3    3\nCONECT    2    3\nCONECT    3    2    2    2    4\nCONECT    4    3\n",
    ]
    .concat();
    let m = made("a.pdb", &pdb, None).expect("readable").value.molecule;
    assert_eq!((m.bonds(), m.orders()), (&[[0, 1], [1, 2], [2, 3]][..], &[2, 3, 1][..]));
    let head = "data_X\nloop_\n_atom_site.id\n_atom_site.type_symbol\n_atom_site.label_atom_id\n_atom_site.label_comp_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n";
    let table = "loop_\n_chem_comp_bond.comp_id\n_chem_comp_bond.atom_id_1\n_chem_comp_bond.atom_id_2\n_chem_comp_bond.value_order\nLIG C2 C1 DOUB\nLIG C2 C3 trip\nOTH C3 C4 DOUB\n";
    let cif = format!("{head}1 C C1 LIG 0 0 0\n2 C C2 LIG 1.3 0 0\n3 C C3 LIG 2.5 0 0\n4 C C4 LIG 4 0 0\n{table}");
    let m = made("a.cif", &cif, None).expect("readable").value.molecule;
    assert_eq!(m.orders(), [2, 3, 1]);
}
