//! Molecules of the data collection and made-up ones: counts by a script that shares no code with the readers, and broken files.

use belvedere_io::{Limits, Loaded, MoleculeFile, load_molecule};
use belvedere_scene::molecule::Selection;
use belvedere_testkit::data;
use glam::DVec3;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

/// File, atoms, residues, chains, waters, alternate positions, and the number of atoms of some elements.
type Row = (&'static str, usize, usize, usize, usize, usize, &'static [(&'static str, usize)]);

const FILES: &[Row] = &[
    ("1bna.pdb", 559, 97, 2, 73, 0, &[("P", 22), ("N", 92)]),
    ("1kx5.pdb", 16_755, 4416, 10, 3130, 0, &[("P", 292), ("Mn", 14), ("S", 12)]),
    ("4zkk.cif", 229, 37, 1, 24, 3, &[("P", 9), ("Co", 3)]),
    ("4yvs.cif", 26_430, 3405, 15, 0, 0, &[("S", 150), ("C", 16_965)]),
    ("adk_oplsaa.pdb", 47_681, 11_302, 1, 11_084, 0, &[("Na", 4), ("S", 7), ("X", 11_084)]),
];

fn load(path: &Path) -> Result<Loaded<MoleculeFile>, belvedere_io::IoError> {
    load_molecule(path, &Limits::default())
}

#[test]
fn real_molecules_hold_what_a_script_counts() {
    for &(name, atoms, residues, chains, waters, alternates, elements) in FILES {
        let Some(path) = data(&format!("molecules/{name}")) else { continue };
        let file = load(&path).unwrap_or_else(|e| panic!("{e}")).value;
        let m = &file.molecule;
        let found = (m.atoms().len(), m.residues().len(), m.chains().len(), file.alternates, file.models);
        assert_eq!(found, (atoms, residues, chains, alternates, 1), "{name}");
        assert_eq!(m.residues().iter().filter(|r| r.is_water()).count(), waters, "{name}");
        for &(symbol, n) in elements {
            assert_eq!(m.atoms().iter().filter(|a| a.element.symbol() == symbol).count(), n, "{name} {symbol}");
        }
        // Chemistry: hardly any atom has more bonds than its element allows, and nearly every hydrogen has one.
        let mut partners = vec![0usize; m.atoms().len()];
        m.bonds().iter().flatten().for_each(|&i| partners[i as usize] += 1);
        let crowded = m.atoms().iter().zip(&partners).filter(|(a, n)| {
            let most = BTreeMap::from([("H", 1), ("C", 4), ("N", 4), ("O", 3), ("P", 4), ("S", 4)]);
            most.get(a.element.symbol()).is_some_and(|most| *n > most)
        });
        assert!(crowded.count() * 2000 <= atoms, "{name}");
        let hydrogens = m.atoms().iter().zip(&partners).filter(|(a, _)| a.element.symbol() == "H");
        assert!(hydrogens.clone().filter(|(_, n)| **n == 0).count() * 1000 <= hydrogens.count(), "{name}");
    }
}

#[test]
fn the_dodecamer_has_a_bond_for_every_step_of_its_chains_and_rings() {
    let Some(path) = data("molecules/1bna.pdb") else { return };
    let m = load(&path).expect("readable").value.molecule;
    let dry = Selection::dry().mask(&m);
    let atoms = dry.iter().filter(|d| **d).count();
    let bonds = m.bonds().iter().filter(|b| b.iter().all(|&i| dry[i as usize])).count();
    // Two chains, and rings: a sugar and one or two of the base in each of 24 nucleotides.
    let rings = 12 * 3 + 12 * 2;
    assert_eq!((atoms, bonds), (486, 486 - 2 + rings));
}

const ATOMS: &str = "\
HEADER    MADE UP
MODEL        1
ATOM      1  N   ALA A   5      11.104   6.134  -6.504  1.00  0.00           N
ATOM      2  CA AALA A   5      11.639   6.071  -5.147  0.40  0.00           C
ATOM      3  CA BALA A   5      11.700   6.100  -5.200  0.60  0.00           C
ATOM      4  CB AALA A   5      13.000   6.600  -5.100  0.40  0.00           C
HETATM    5 FE   HEM A 201A     20.000   0.000   0.000  1.00  0.00          FE
HETATM    6  O   HOH B   1      30.000   0.000   0.000
TER
ENDMDL
MODEL        2
ATOM      1  N   ALA A   5      99.000   6.134  -6.504  1.00  0.00           N
ENDMDL
CONECT    1    5
CONECT    5    1    9
END
";

fn made(name: &str, bytes: &[u8]) -> Result<Loaded<MoleculeFile>, String> {
    let folder = tempfile::tempdir().expect("temporary folder");
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("written");
    load(&path).map_err(|e| e.to_string())
}

#[test]
fn models_locations_hetero_groups_and_named_bonds() {
    let loaded = made("a.pdb", ATOMS.as_bytes()).expect("readable");
    let file = &loaded.value;
    let m = &file.molecule;
    assert_eq!((file.models, file.alternates, file.named_bonds), (2, 1, 1));
    let told: Vec<_> = (0..m.atoms().len()).map(|i| (m.atoms()[i].serial, m.name_of(i))).collect();
    // CA at its likelier position, CB at its only one.
    let expected = [
        (1, "atom N of chain A ALA 5"),
        (3, "atom CA of chain A ALA 5"),
        (4, "atom CB of chain A ALA 5"),
        (5, "atom FE of chain A HEM 201A"),
        (6, "atom O of chain B HOH 1"),
    ];
    assert_eq!(told, expected.map(|(n, s)| (n, s.to_owned())));
    assert_eq!(m.atoms()[1].position, DVec3::new(11.7, 6.1, -5.2));
    assert_eq!(m.bonds(), [[0, 1], [0, 3], [1, 2]]);
    assert!(m.residues()[1].hetero && m.residues()[2].is_water());
    let said = loaded.warnings.iter().map(|w| w.text()).collect::<Vec<_>>().join("\n");
    for part in ["2 models; the first is taken", "1 atoms at alternate locations", "1 atoms name no element"] {
        assert!(said.contains(part), "{said}");
    }
}

const CIF: &str = "\
data_MADE
_entry.id 'it''s made up'
_struct.title
;a text
loop_ _atom_site.id
;
loop_
_atom_site.group_PDB
_atom_site.id
_atom_site.type_symbol
_atom_site.label_atom_id
_atom_site.label_alt_id
_atom_site.label_comp_id
_atom_site.label_asym_id
_atom_site.label_seq_id
_atom_site.Cartn_x
_atom_site.Cartn_y
_atom_site.Cartn_z
_atom_site.occupancy
_atom_site.auth_seq_id
_atom_site.auth_asym_id
_atom_site.pdbx_PDB_model_num
ATOM 1 O \"O5'\" . DC A 1 18.935 34.195 25.617 1.00 7 X 1 # a comment
ATOM 2 C 'C5\\'' . DC A 1 19.130 33.921 24.219 . 7 X 1
HETATM 3 CO CO . CO B . 8.926 11.381 -8.148 0.5 101 X 1
ATOM 1 O \"O5'\" . DC A 1 0 0 0 1 7 X 2
#
loop_
_struct_conn.conn_type_id
_struct_conn.ptnr1_auth_asym_id
_struct_conn.ptnr1_auth_seq_id
_struct_conn.ptnr1_label_atom_id
_struct_conn.ptnr2_auth_asym_id
_struct_conn.ptnr2_auth_seq_id
_struct_conn.ptnr2_label_atom_id
_struct_conn.ptnr2_symmetry
_struct_conn.ptnr1_symmetry
metalc X 7 O5' X 101 CO 1_555 1_555
metalc X 7 O5' X 101 CO 2_555 1_555
hydrog X 7 O5' X 101 CO 1_555 1_555
";

#[test]
fn quotes_texts_comments_and_the_authors_names() {
    let file = made("a.cif", CIF.as_bytes()).expect("readable").value;
    let m = &file.molecule;
    let names: Vec<_> = (0..m.atoms().len()).map(|i| m.name_of(i)).collect();
    assert_eq!(names, ["atom O5' of chain X DC 7", "atom C5\\' of chain X DC 7", "atom CO of chain X CO 101"]);
    assert_eq!((file.models, file.named_bonds), (2, 1));
    assert_eq!(m.bonds(), [[0, 1], [0, 2]]);
    assert_eq!(m.atoms()[1].position, DVec3::new(19.13, 33.921, 24.219));
}

#[test]
fn gzipped_files_are_read_and_their_damage_told() {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packed.write_all(ATOMS.as_bytes()).expect("packed");
    let packed = packed.finish().expect("packed");
    let plain = made("a.pdb", ATOMS.as_bytes()).expect("readable").value;
    assert_eq!(made("a.pdb.gz", &packed).expect("readable").value, plain);
    let cut = made("a.pdb.gz", &packed[..packed.len() / 2]).expect_err("damaged");
    assert!(cut.contains("a.pdb.gz cannot be unpacked") && cut.contains("get it again"), "{cut}");
}

#[test]
fn broken_files_say_where_and_what() {
    let with = |from: &str, to: &str| ATOMS.replace(from, to);
    let cif = |from: &str, to: &str| CIF.replace(from, to);
    for (name, text, said) in [
        ("a.pdb", String::new(), "is empty"),
        ("a.pdb", with("11.104", "11.1x4"), "line 3: x is \"11.1x4\", a number is needed in columns 31 to 38"),
        ("a.pdb", with("11.104", "   nan"), "line 3: x is \"nan\""),
        ("a.pdb", with("  6.134  -6.504  1.00  0.00           N", ""), "line 3: the line of an atom has 39 columns"),
        ("a.pdb", with(" N   ALA", " N\u{e9}  ALA"), "letters beyond ASCII"),
        ("a.pdb", with("  11.104", "99999999"), "beyond the 1000000 angstrom"),
        ("a.cif", String::new(), "is empty"),
        ("a.cif", cif("_atom_site.Cartn_z\n", "_atom_site.other\n"), "have no _atom_site.Cartn_z"),
        ("a.cif", cif("18.935", "?"), "line 23: x is \"?\", a number is needed"),
        ("a.cif", cif("18.935 ", ""), "values for 15 columns"),
        ("a.cif", cif(";\nloop_", "loop_"), "a text field is not closed"),
        ("a.cif", cif("\"O5'\" . DC", "\"O5' . DC"), "a quote is not closed"),
    ] {
        let e = made(name, text.as_bytes()).expect_err(said);
        assert!(e.contains(said) && e.lines().count() == 1, "{said}: {e}");
    }
}

#[test]
fn files_cut_short_anywhere_are_read_or_told() {
    let mut read = 0;
    for (name, text) in [("a.pdb", ATOMS), ("a.cif", CIF)] {
        for length in 0..text.len() {
            match made(name, &text.as_bytes()[..length]) {
                Ok(_) => read += 1,
                Err(e) => assert_eq!(e.lines().count(), 1, "{length}: {e}"),
            }
        }
    }
    assert!(read > 100, "what is whole is read: {read}");
    // Random bytes.
    let noise: Vec<u8> = (0..20_000u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    for name in ["a.pdb", "a.cif", "a.pdb.gz", "a.ent"] {
        made(name, &noise).expect_err("no molecule");
    }
}

/// Bonds are sought between all atoms that are near each other, so that atoms at one place would take for ever.
#[test]
fn atoms_that_all_lie_at_one_place_are_refused_soon() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("heap.pdb");
    let line = |i: usize, apart: f64| {
        let [x, y, z] = [i % 50, i / 50 % 50, i / 2500].map(|n| n as f64 * apart);
        format!("ATOM  {:5}  CA  ALA A{:4}    {x:8.3}{y:8.3}{z:8.3}  1.00  0.00           C  \n", i % 99_999, i % 9_999)
    };
    let text = |apart: f64| (0..30_000).map(|i| line(i, apart)).collect::<String>();
    std::fs::write(&path, text(0.0)).expect("written");
    let error = load(&path).unwrap_err().to_string();
    assert!(error.contains("all 30000 atoms stand at exactly one place with more than 9 others (0 0 0)"), "{error}");
    std::fs::write(&path, text(0.001)).expect("written");
    let error = load(&path).unwrap_err().to_string();
    assert!(error.contains("atoms lie in the cube of one angstrom at 0 0 0"), "{error}");
    // 39 atoms in every cube of an angstrom.
    std::fs::write(&path, text(0.295)).expect("written");
    let error = load(&path).unwrap_err().to_string();
    assert!(error.contains("in its cube of four angstrom on the average, at most 300 are read"), "{error}");
    std::fs::write(&path, text(1.5)).expect("written");
    assert_eq!(load(&path).expect("a crystal").value.molecule.atoms().len(), 30_000);
}

/// Models whose unknown places are all written as 0 0 0: the other atoms are read, and bonds named to what is left out are none.
#[test]
fn atoms_of_unknown_places_are_left_out() {
    let line = |i: usize, [x, y, z]: [f64; 3]| {
        format!("ATOM  {i:5}  CA  ALA A{i:4}    {x:8.3}{y:8.3}{z:8.3}  1.00  0.00           C  \n")
    };
    let chain: String = (1..=40).map(|i| line(i, [3.8 * i as f64, 1.0, 2.0])).collect();
    let with = |count: usize| {
        let unknown: String =
            (41..41 + count).map(|i| line(i, [0.0, 0.0, if i % 2 == 0 { 0.0 } else { -0.0 }])).collect();
        made("a.pdb", format!("{chain}{unknown}CONECT   40   41\n").as_bytes()).expect("readable")
    };
    let (many, few) = (with(500), with(10));
    assert_eq!((many.value.molecule.atoms().len(), many.value.named_bonds), (40, 0));
    let said = many.warnings.iter().map(|w| w.text()).collect::<Vec<_>>().join("\n");
    assert!(said.contains("500 atoms stand at exactly one place with more than 9 others (0 0 0)"), "{said}");
    assert_eq!(
        (few.value.molecule.atoms().len(), few.value.named_bonds),
        (50, 1),
        "places that few atoms share are theirs"
    );
    assert!(few.warnings.is_empty(), "{:?}", few.warnings);
}
