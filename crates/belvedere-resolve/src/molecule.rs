//! Molecule layers: files or built in, selected, coloured and placed.

use super::builtin;
use super::color::{Complaint, color, optional_color};
use super::loader::Loader;
use super::mesh::turn;
use crate::BelvedereError;
use belvedere_core::DVec3;
use belvedere_core::{Warning, WarningKind};
use belvedere_document::{ModelsDoc, MoleculeDoc, TransformDoc};
use belvedere_io::{Models, MoleculeFile, Wanted, load_frames, load_model, load_trajectory};
use belvedere_scene::molecule::{ModelTransform, MoleculeColor, MoleculeFilm, Paint, Representation, Selection};
use belvedere_scene::{LayerKind, Molecule, MoleculeLayer, MoleculeStyle};

/// The layer.
pub(super) fn layer(loader: &mut Loader<'_>, index: usize, doc: &MoleculeDoc) -> Result<LayerKind, BelvedereError> {
    let (molecule, models) = source(loader, index, doc)?;
    let drawn_atoms = molecule.atoms().len() as u64;
    loader
        .options
        .limits()
        .ask("the picture of the molecule", drawn_atoms.saturating_mul(per_atom(doc, &molecule)))
        .map_err(|e| loader.fail(index, "source", e))?;
    let wanted =
        doc.select.as_deref().map(Selection::parse).transpose().map_err(|e| loader.fail(index, "select", e))?;
    let mut style = style(doc, wanted.as_ref()).map_err(|(key, reason)| loader.fail(index, key, reason))?;
    match &doc.style.selection {
        Some(_) => require_any(&style.selection, &molecule).map_err(|e| loader.fail(index, "style", e))?,
        None => {
            let (chosen, left_out) = without_water(&molecule);
            style.selection = chosen;
            if left_out > 0 {
                let note = format!(
                    "{left_out} atoms of water are not drawn; style.selection = \"all\" draws them, \"not water\" says that this is meant"
                );
                let warning = Warning::new(WarningKind::Ignored, note).with("count", left_out as f64);
                loader.note(index, [warning]);
            }
        }
    }
    if let Some(wanted) = &wanted {
        require_drawn(wanted, &style.selection, &molecule).map_err(|e| loader.fail(index, "select", e))?;
    }
    let placement = match &doc.transform {
        Some(transform) => placement(transform).map_err(|e| loader.fail(index, "transform", e))?,
        None => ModelTransform::default(),
    };
    let layer = MoleculeLayer::new(molecule, &style, placement).map_err(|e| loader.fail(index, "source", e))?;
    let layer = MoleculeLayer { label_px: doc.style.labels.then_some(doc.style.label_px), ..layer };
    let layer = match models_per_s(doc) {
        Some(models_per_s) => layer.filmed(MoleculeFilm { models, models_per_s, style }),
        None => layer,
    };
    let layer = match wanted {
        Some(wanted) => layer.wanting(wanted),
        None => layer,
    };
    Ok(layer.into())
}

/// Frames of a trajectory per second of film, unless stated.
const FRAMES_PER_S: f64 = 25.0;
/// Longest bond that is taken for one, angstrom: longer ones are those of molecules that a periodic box cuts.
const LONGEST_BOND: f64 = 4.0;

/// Models per second; `None` for what stands still.
fn models_per_s(doc: &MoleculeDoc) -> Option<f64> {
    doc.models_per_s.or(doc.trajectory.as_ref().map(|_| FRAMES_PER_S))
}

/// Bytes at the peak of making the triangles of an atom: 120 for each triangle, in sizes from 100,000 atoms on.
fn per_atom(doc: &MoleculeDoc, molecule: &Molecule) -> u64 {
    let cuts = u64::from(doc.style.detail.unwrap_or(1).clamp(1, 16));
    match doc.style.representation.of(molecule) {
        Representation::Surface => 2000,
        Representation::Ribbon => 1000,
        _ => 5000 * cuts * cuts,
    }
}

/// A molecule in the first frame of a trajectory, and the places of its atoms in all of them.
fn over_time(
    loader: &mut Loader<'_>,
    index: usize,
    (name, every): (&str, usize),
    file: MoleculeFile,
) -> Result<(Molecule, Vec<Vec<DVec3>>), BelvedereError> {
    let path = loader.file(index, "trajectory", name)?;
    loader.options.progress.tick("reading trajectories", 0.0)?;
    let read = load_trajectory(&path, &Wanted { first: 0, every, most: usize::MAX }, &loader.options.limits())?;
    let read = loader.take(index, read);
    let molecule = file.molecule;
    let count = molecule.atoms().len();
    if read.atoms != count {
        let left_out = match file.alternates {
            0 => String::new(),
            n => format!(", without {n} at alternate locations"),
        };
        let reason = format!(
            "trajectory {name} has {} atoms, the source {count}{left_out}; give the structure from which it was made, or write both for the same atoms",
            read.atoms
        );
        return Err(loader.fail(index, "trajectory", reason));
    }
    let place = |p: &[f32; 3]| DVec3::from_array(p.map(f64::from));
    let frames: Vec<Vec<DVec3>> = read.frames.iter().map(|frame| frame.iter().map(place).collect()).collect();
    let broken = |frame: &Vec<DVec3>| {
        let is_long = |[a, b]: [u32; 2]| frame[a as usize].distance(frame[b as usize]) > LONGEST_BOND;
        molecule.bonds().iter().filter(|bond| is_long(**bond)).count()
    };
    if let Some((k, n)) = frames.iter().map(broken).enumerate().find(|(_, n)| *n > 0) {
        let note = format!(
            "{n} bonds are longer than {LONGEST_BOND} angstrom in frame {}: the periodic box cuts molecules; make them whole in the trajectory first",
            k * every + 1
        );
        loader.note(index, [Warning::new(WarningKind::Suspect, note).with("bonds", n as f64)]);
    }
    let first = frames.first().map(|frame| molecule.at(frame)).unwrap_or(molecule);
    Ok((first, frames))
}

/// An error where keys about models contradict one another.
fn check_models(loader: &Loader<'_>, index: usize, doc: &MoleculeDoc) -> Result<(), BelvedereError> {
    if doc.model == Some(ModelsDoc::Number(0)) {
        return Err(loader.fail(index, "model", "model is 0, models are counted from 1"));
    }
    if matches!(doc.model, Some(ModelsDoc::All(_))) && doc.assembly.as_deref().is_some_and(|id| id != ASYMMETRIC) {
        let reason = "an assembly is made of one model; name one as model, or leave assembly out";
        return Err(loader.fail(index, "assembly", reason));
    }
    if doc.trajectory_every.is_some_and(|every| every == 0 || doc.trajectory.is_none()) {
        let reason = "trajectory_every is the step from 1 between the frames of a trajectory; name one as trajectory";
        return Err(loader.fail(index, "trajectory_every", reason));
    }
    if matches!(doc.model, Some(ModelsDoc::All(_))) && doc.trajectory.is_some() {
        let reason = "a trajectory is of one model; leave model or trajectory out";
        return Err(loader.fail(index, "model", reason));
    }
    if let Some(rate) = models_per_s(doc) {
        let reason = match rate > 0.0 && rate.is_finite() {
            false => format!("models_per_s is {rate}, it must be greater than 0"),
            true if doc.model.is_some() && doc.trajectory.is_none() => {
                "model chooses what stands still, models_per_s shows all one after the other; leave one of them out"
                    .into()
            }
            true if doc.assembly.as_deref().is_some_and(|id| id != ASYMMETRIC) => {
                "models of a film are those of the file, not of an assembly; leave assembly or models_per_s out".into()
            }
            true => String::new(),
        };
        if !reason.is_empty() {
            return Err(loader.fail(index, "models_per_s", reason));
        }
    }
    Ok(())
}

/// The molecule, and the places of its atoms in the models of a film.
fn source(
    loader: &mut Loader<'_>,
    index: usize,
    doc: &MoleculeDoc,
) -> Result<(Molecule, Vec<Vec<DVec3>>), BelvedereError> {
    if builtin::is_name(&doc.source) {
        let asked = [
            ("assembly", doc.assembly.is_some()),
            ("model", doc.model.is_some()),
            ("models_per_s", doc.models_per_s.is_some()),
            ("trajectory", doc.trajectory.is_some()),
        ];
        if let Some((key, _)) = asked.into_iter().find(|(_, asked)| *asked) {
            let reason = format!("{key} is for files, built-in molecules have none; leave it out");
            return Err(loader.fail(index, key, reason));
        }
        let molecule =
            loader.builtin(index, &doc.source, |kind| kind.molecule().map(|layer| Molecule::clone(&layer.molecule)))?;
        return Ok((molecule, Vec::new()));
    }
    let path = loader.source(index, &doc.source)?;
    loader.options.progress.tick("reading molecules", 0.0)?;
    check_models(loader, index, doc)?;
    let models = match doc.model {
        None => Models::First,
        Some(ModelsDoc::Number(number)) => Models::Number(number),
        Some(ModelsDoc::All(_)) => Models::All,
    };
    let (options, limits) = (loader.options, loader.options.limits());
    let of_models = doc.models_per_s.filter(|_| doc.trajectory.is_none());
    let file = match (options.arrays.find(&path)?, of_models) {
        (Some(array), rate) => {
            let loaded = array.atoms()?.molecule(&path, (models, rate.is_some()), &limits)?;
            loader.of_array(index, array, loaded)
        }
        (None, Some(_)) => loader.take(index, load_frames(&path, &limits)?),
        (None, None) => loader.take(index, load_model(&path, models, &limits)?),
    };
    if of_models.is_some() {
        return Ok((file.molecule, file.frames));
    }
    if let Some(name) = &doc.trajectory {
        return over_time(loader, index, (name, doc.trajectory_every.unwrap_or(1)), file);
    }
    let molecule = match doc.assembly.as_deref() {
        Some(ASYMMETRIC) => Ok(file.molecule),
        Some(id) => {
            let made = file.assemblies.assemble(&file.molecule, id, &limits);
            made.map_err(|e| loader.fail(index, "assembly", e))
        }
        None => {
            note_assembly(loader, index, &file);
            Ok(file.molecule)
        }
    };
    Ok((molecule?, Vec::new()))
}

/// Says that the file describes copies that are not drawn.
fn note_assembly(loader: &mut Loader<'_>, index: usize, file: &MoleculeFile) {
    if let Some(other) = file.assemblies.list().iter().find(|a| a.copies > 1) {
        let note = format!(
            "the file describes assembly {} of {} copies ({} atoms), and the {} atoms of the file are drawn; assembly = \"{}\" draws the copies, \"{ASYMMETRIC}\" says that this is meant",
            other.id,
            other.copies,
            other.atoms,
            file.molecule.atoms().len(),
            other.id
        );
        let note = Warning::new(WarningKind::Ignored, note).with("copies", other.copies as f64);
        loader.note(index, [note.settled_by("assembly")]);
    }
}

/// The assembly that is the atoms of the file alone.
const ASYMMETRIC: &str = "asymmetric";

/// Colours and selections of the document; also checks documents that are not opened.
pub(super) fn style(doc: &MoleculeDoc, wanted: Option<&Selection>) -> Result<MoleculeStyle, Complaint> {
    let parse = |key: &'static str, text: &str| Selection::parse(text).map_err(|e| (key, e.to_string()));
    let mut paint = Vec::new();
    for one in &doc.style.paint {
        paint.push(Paint { selection: parse("paint", &one.selection)?, color: color("paint", &one.color)? });
    }
    let highlight = optional_color("highlight", &doc.style.highlight)?;
    paint.extend(wanted.cloned().zip(highlight).map(|(selection, color)| Paint { selection, color }));
    if !(doc.style.label_px > 0.0 && doc.style.label_px <= 200.0) {
        return Err(("label_px", format!("label_px is {}, it must be in (0, 200]", doc.style.label_px)));
    }
    if let Some(detail) = doc.style.detail.filter(|d| !(1..=16).contains(d)) {
        return Err(("detail", format!("detail is {detail}, it must be in 1..=16")));
    }
    Ok(MoleculeStyle {
        representation: doc.style.representation,
        color: match doc.style.color.as_str() {
            "auto" => MoleculeColor::Auto,
            "element" => MoleculeColor::Element,
            "structure" => MoleculeColor::Structure,
            "chain" => MoleculeColor::Chain,
            "residue" => MoleculeColor::Residue,
            text => MoleculeColor::One(color("color", text).map_err(|(key, reason)| {
                (key, format!("{reason}, or one of auto, element, chain, residue and structure"))
            })?),
        },
        paint,
        selection: doc.style.selection.as_deref().map_or(Ok(Selection::all()), |text| parse("selection", text))?,
        detail: doc.style.detail,
        sticks: doc.style.sticks.as_deref().map(|text| parse("sticks", text)).transpose()?,
        orders: doc.style.bond_orders,
    })
}

/// All atoms except water, and the number of those left out; all atoms if there is only water.
fn without_water(molecule: &Molecule) -> (Selection, usize) {
    let dry = Selection::dry();
    let left_out = dry.mask(molecule).iter().filter(|kept| !**kept).count();
    if left_out == molecule.atoms().len() { (Selection::all(), 0) } else { (dry, left_out) }
}

fn require_any(selection: &Selection, molecule: &Molecule) -> Result<(), String> {
    if selection.mask(molecule).contains(&true) {
        return Ok(());
    }
    Err(format!(
        "selection \"{selection}\" matches none of the {} atoms; {}",
        molecule.atoms().len(),
        there_is(molecule)
    ))
}

fn require_drawn(wanted: &Selection, drawn: &Selection, molecule: &Molecule) -> Result<(), String> {
    require_any(wanted, molecule)?;
    if (0..molecule.atoms().len()).any(|i| wanted.holds(molecule, i) && drawn.holds(molecule, i)) {
        return Ok(());
    }
    Err(format!(
        "none of the atoms of \"{wanted}\" is drawn by style.selection \"{drawn}\"; select atoms that are drawn"
    ))
}

/// Names that can be selected instead.
fn there_is(molecule: &Molecule) -> String {
    let names: Vec<&str> = molecule.chains().into_iter().filter(|c| !c.is_empty()).take(20).collect();
    let numbers = molecule.residues().iter().map(|r| r.number);
    let (low, high) = (numbers.clone().min().unwrap_or(0), numbers.max().unwrap_or(0));
    let chains =
        if names.is_empty() { "there are no chains".to_owned() } else { format!("chains are {}", names.join(", ")) };
    format!("{chains}, residues are numbered {low} to {high}")
}

fn placement(transform: &TransformDoc) -> Result<ModelTransform, String> {
    if !(transform.scale > 0.0) {
        return Err(format!("scale is {}, it must be greater than 0", transform.scale));
    }
    Ok(ModelTransform { scale: transform.scale, turn: turn(transform), to: DVec3::from_array(transform.translate) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn doc(text: &str) -> MoleculeDoc {
        toml::from_str(&format!("id = \"m\"\nsource = \"m.pdb\"\n{text}")).unwrap()
    }

    #[test]
    fn styles_say_what_is_wrong() {
        for (text, key, said) in [
            ("style.color = \"blue\"", "color", "or one of auto, element, chain, residue and structure"),
            ("style.selection = \"chian A\"", "selection", "\"chian\" is no word"),
            ("style.paint = [{ selection = \"all\", color = \"x\" }]", "paint", "is no colour"),
            ("style.highlight = \"x\"", "highlight", "is no colour"),
            ("style.detail = 0", "detail", "detail is 0, it must be in 1..=16"),
        ] {
            let (found, reason) = style(&doc(text), None).unwrap_err();
            assert!(found == key && reason.contains(said), "{text}: {found} {reason}");
        }
        let wanted = Selection::parse("chain A").unwrap();
        let fine = style(&doc("style.color = \"chain\""), Some(&wanted)).unwrap();
        assert_eq!((fine.color, fine.paint.len()), (MoleculeColor::Chain, 1));
        assert_eq!(style(&doc("style.highlight = \"none\""), Some(&wanted)).unwrap().paint, []);
    }
}
