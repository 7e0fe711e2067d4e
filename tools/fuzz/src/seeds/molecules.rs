//! Molecules.

/// Atoms: name, residue, number of the residue, position, element.
const ATOMS: [(&str, &str, u32, [f64; 3], &str); 8] = [
    ("N", "ALA", 1, [1.104, 2.134, 3.504], "N"),
    ("CA", "ALA", 1, [2.390, 2.790, 3.180], "C"),
    ("C", "ALA", 1, [3.480, 1.750, 3.020], "C"),
    ("O", "ALA", 1, [3.290, 0.560, 3.280], "O"),
    ("N", "GLY", 2, [4.640, 2.210, 2.560], "N"),
    ("CA", "GLY", 2, [5.780, 1.320, 2.360], "C"),
    ("FE", "HEM", 101, [7.500, 6.500, 4.000], "FE"),
    ("O", "HOH", 201, [8.500, 1.000, 6.000], "O"),
];

/// PDB with two models and named bonds.
pub fn pdb() -> Vec<Vec<u8>> {
    let atom = |(i, (name, residue, number, [x, y, z], element)): (usize, &(&str, &str, u32, [f64; 3], &str))| {
        let record = if *number > 100 { "HETATM" } else { "ATOM  " };
        format!(
            "{record}{:>5} {:<4} {residue:>3} A{number:>4}    {x:>8.3}{y:>8.3}{z:>8.3}  1.00 12.50          {element:>2}\n",
            i + 1,
            format!(" {name}")
        )
    };
    let atoms: String = ATOMS.iter().enumerate().map(atom).collect();
    let text = format!(
        "HEADER    A SEED\nHELIX    1   1 ALA A    1  GLY A    2  1\nMODEL        1\n{atoms}TER\nENDMDL\nMODEL        2\n{atoms}ENDMDL\nCONECT    1    2    7\nEND\n"
    );
    vec![text.into_bytes(), format!("{atoms}END\n").into_bytes()]
}

/// XYZ of two frames, plain and with named columns.
pub fn xyz() -> Vec<Vec<u8>> {
    let atoms = |before: &str| -> String {
        let line =
            |(.., [x, y, z], element): &(&str, &str, u32, [f64; 3], &str)| format!("{element}{before} {x} {y} {z}\n");
        ATOMS.iter().map(line).collect()
    };
    let named = format!("8\nProperties=species:S:1:id:I:1:pos:R:3\n{}", atoms(" 7"));
    vec![format!("8\na seed\n{0}8\n\n{0}", atoms("")).into_bytes(), named.into_bytes()]
}

/// mmCIF with quotes, a text and named bonds.
pub fn mmcif() -> Vec<Vec<u8>> {
    let mut text = "data_SEED\n_entry.id 'it''s a seed'\n_struct.title\n;a text\nof two lines\n;\nloop_\n".to_owned();
    for name in [
        "group_PDB",
        "id",
        "type_symbol",
        "label_atom_id",
        "label_alt_id",
        "label_comp_id",
        "label_asym_id",
        "label_seq_id",
        "Cartn_x",
        "Cartn_y",
        "Cartn_z",
        "occupancy",
        "auth_seq_id",
        "auth_asym_id",
        "pdbx_PDB_model_num",
    ] {
        text += &format!("_atom_site.{name}\n");
    }
    for (i, (name, residue, number, [x, y, z], element)) in ATOMS.iter().enumerate() {
        let group = if *number > 100 { "HETATM" } else { "ATOM" };
        text += &format!(
            "{group} {} {element} \"{name}\" . {residue} A {number} {x} {y} {z} 1.0 {number} A 1 # atom\n",
            i + 1
        );
    }
    text += "#\nloop_\n";
    for name in [
        "conn_type_id",
        "ptnr1_auth_asym_id",
        "ptnr1_auth_seq_id",
        "ptnr1_label_atom_id",
        "ptnr2_auth_asym_id",
        "ptnr2_auth_seq_id",
        "ptnr2_label_atom_id",
    ] {
        text += &format!("_struct_conn.{name}\n");
    }
    text += "metalc A 1 N A 101 FE\n";
    vec![text.into_bytes()]
}
