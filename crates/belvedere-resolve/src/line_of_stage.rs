//! The line that a stage follows: points of its own, or a line layer.

use super::context::StageContext;
use crate::BelvedereError;
use belvedere_core::DVec2;
use belvedere_document::Table;

/// Where a stage states its line: `along`, the id of a line layer, or `path`, its points.
pub(super) struct LineOfStage<'a> {
    pub(super) along: Option<&'a str>,
    pub(super) path: Option<&'a [[f64; 2]]>,
    /// Keys of the table that states them, inside the stage.
    pub(super) within: &'a [&'a str],
    /// What follows the line, for messages.
    pub(super) what: &'a str,
}

impl LineOfStage<'_> {
    /// The line in plan, and the key that names it.
    pub(super) fn find(
        &self,
        context: &StageContext<'_>,
        at: Table<'_>,
    ) -> Result<(Vec<DVec2>, &'static str), BelvedereError> {
        let what = self.what;
        let fail = |text: String| {
            let keys: Vec<&str> = self.within.iter().copied().chain(["along"]).collect();
            BelvedereError::from(at.error(&keys, text))
        };
        let id = match (self.along, self.path) {
            (Some(id), None) => id,
            (None, Some(path)) => return Ok((path.iter().copied().map(DVec2::from_array).collect(), "path")),
            (along, _) => {
                let given = if along.is_some() { "both are given" } else { "neither is given" };
                return Err(fail(format!("{what} needs along or path, {given}; give exactly one")));
            }
        };
        let Some(layer) = context.scene.layers.iter().find(|l| l.id == *id) else {
            let ids: Vec<&str> = context.source.document.layer.iter().map(|l| l.id()).collect();
            let hint = belvedere_document::suggestion(id, &ids);
            return Err(fail(format!("{what} along \"{id}\": there is no such layer ({hint})")));
        };
        let Some(line) = layer.kind.lines() else {
            return Err(fail(format!("{what} along \"{id}\": the layer is no line; name a layer of kind line")));
        };
        let gap = context.ground.terrain.map_or(1.0, |t| 20.0 * t.spacing().max_element());
        Ok((line.longest_chain(gap).iter().map(|p| p.truncate()).collect(), "along"))
    }
}
