//! Options of `reveal` that are for terrain with features, not for models and cities.

use crate::args::RevealArgs;

/// Refuses options that say something of terrain with features where models or cities are shown.
pub(crate) fn check(args: &RevealArgs) -> anyhow::Result<()> {
    let (look, ground) = (&args.look_args, &args.ground);
    let given: Vec<&str> = [
        ("--relief", look.relief.is_some()),
        ("--hidden", look.hidden.is_some()),
        ("--exaggeration", look.exaggeration.is_some()),
        ("--fill-voids", look.fill_voids),
        ("--drape", !args.drape.is_empty()),
        ("--labels", args.labels),
        ("--keep-voids", args.keep_voids),
        ("--palette", args.palette.is_some()),
        ("--no-sea", args.no_sea),
        ("--area-style", args.area_style.is_some()),
        ("--curved-earth", args.curved_earth),
        ("--no-limits", args.no_limits),
        ("--crs", args.crs.is_some()),
        ("--source-crs", ground.source_crs.is_some()),
        ("--nodata", ground.nodata.is_some()),
        ("--vertical-unit", ground.vertical_unit.is_some()),
        ("--name-field", ground.name_field.is_some()),
    ]
    .into_iter()
    .filter_map(|(name, given)| given.then_some(name))
    .collect();
    let (is_are, it) = if given.len() == 1 { ("is", "it") } else { ("are", "them") };
    anyhow::ensure!(
        given.is_empty(),
        "{} {is_are} for terrain with features, not for models and cities; leave {it} out",
        given.join(", ")
    );
    Ok(())
}
