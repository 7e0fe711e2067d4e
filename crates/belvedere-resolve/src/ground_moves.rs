//! Stages of ground that an author moves.

use super::context::StageContext;
use super::line_of_stage::LineOfStage;
use crate::BelvedereError;
use belvedere_construct::ground_moves::{
    GroundMovesFailure, GroundMovesReport, Handle, Kept, Move, ROUTES_WITHIN, ground_moves,
};
use belvedere_core::plain::number;
use belvedere_core::{DVec2, Stage, Warning, WarningKind};
use belvedere_document::{GroundMovesStageDoc, LayerDoc, MoveDoc, MoveKindDoc, StageDoc, Table};

/// Default distance up to which the ground moves in full, as a share of the reach.
const CORE: f64 = 0.25;
/// A route whose length changes by this share of what it may is what ends the moves.
const NEARLY: f64 = 0.95;
/// A move that is carried out by less than this is told.
const TOLD: f64 = 0.9;

/// The stage, its document and its report.
pub(super) fn resolve(
    context: &StageContext<'_>,
    doc: &GroundMovesStageDoc,
    warnings: &mut Vec<Warning>,
    at: Table<'_>,
) -> Result<(Stage, StageDoc, GroundMovesReport), BelvedereError> {
    let (mut moves, mut documents) = (Vec::new(), Vec::new());
    for (k, one) in doc.moves.iter().enumerate() {
        let index = k.to_string();
        let keys = ["move", index.as_str()];
        let found = LineOf { context, keys: &keys, at }.handle(one)?;
        let core = one.core_m.unwrap_or(CORE * one.reach_m);
        documents.push(MoveDoc { core_m: Some(core), ..one.clone() });
        moves.push(Move { handle: found, core, reach: one.reach_m });
    }
    let known: Vec<&str> = context.source.document.layer.iter().map(LayerDoc::id).collect();
    if let Some(unknown) = doc.rivers.iter().find(|id| !known.contains(&id.as_str())) {
        let hint = belvedere_document::suggestion(unknown, &known);
        return Err(at.error(&["rivers"], format!("rivers: there is no layer \"{unknown}\" ({hint})")).into());
    }
    let rises = doc.moves.iter().any(|one| one.kind == MoveKindDoc::Raise);
    let kept = Kept::of(context.scene, &doc.rivers, rises);
    let (map, report) = ground_moves(&moves, &kept).map_err(|e| match e {
        GroundMovesFailure::Handle { index, error } => {
            let text = format!("move {}: {error}", index + 1);
            BelvedereError::from(at.error(&["move", &index.to_string()], text))
        }
        e => at.error(&["move"], format!("ground_moves: {e}")).into(),
    })?;
    warnings.extend(remarks(&report));
    let document = GroundMovesStageDoc { moves: documents, rivers: doc.rivers.clone() };
    Ok((Stage::GroundMoves(map), StageDoc::GroundMoves(document), report))
}

/// What was not carried out.
fn remarks(report: &GroundMovesReport) -> Vec<Warning> {
    let text = |k: usize| {
        let one = &report.moves[k];
        let done = 100.0 * one.carried_out;
        let longest = report.routes.iter().map(|r| (r, (r.moved_length_m / r.length_m - 1.0).abs()));
        let longest = longest.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, change)| *change > NEARLY * ROUTES_WITHIN);
        let why = match longest {
            _ if report.share == 1.0 => "lakes, rivers, routes or other moves hold against it".to_owned(),
            Some((route, _)) => format!(
                "more would change the length of \"{}\" by more than {} %",
                route.name,
                number(100.0 * ROUTES_WITHIN)
            ),
            None => "more would fold the ground".to_owned(),
        };
        format!(
            "stage ground_moves: move {} ({}) is carried out by {done:.0} %: {why}; move less, or over a longer reach",
            k + 1,
            one.kind
        )
    };
    let short = |k: &usize| report.moves[*k].carried_out < TOLD;
    let one = |k: usize| {
        let warning = Warning::new(WarningKind::Limited, text(k)).about("ground_moves");
        warning.with("carried_out", report.moves[k].carried_out)
    };
    (0..report.moves.len()).filter(short).map(one).collect()
}

/// Where the line or the place of a move is looked for.
struct LineOf<'a> {
    context: &'a StageContext<'a>,
    keys: &'a [&'a str],
    at: Table<'a>,
}

impl LineOf<'_> {
    fn handle(&self, doc: &MoveDoc) -> Result<Handle, BelvedereError> {
        let name = name(doc.kind);
        self.refuse_others(doc, name)?;
        let place = || self.needed(doc.at, "at", name).map(|p| [DVec2::from_array(p)]);
        Ok(match doc.kind {
            MoveKindDoc::Shift => {
                Handle::Shift { at: place()?, by: DVec2::from_array(self.needed(doc.shift_m, "shift_m", name)?) }
            }
            MoveKindDoc::Turn => {
                Handle::Turn { at: place()?, angle: self.needed(doc.angle_deg, "angle_deg", name)?.to_radians() }
            }
            MoveKindDoc::Raise => Handle::Raise { at: place()?, by: self.needed(doc.by_m, "by_m", name)? },
            MoveKindDoc::Widen => {
                Handle::Widen { path: self.line(doc, name)?, by: self.needed(doc.by_m, "by_m", name)? }
            }
            MoveKindDoc::Straighten => {
                Handle::Straighten { path: self.line(doc, name)?, share: doc.share.unwrap_or(1.0) }
            }
        })
    }

    fn fail(&self, key: &str, text: String) -> BelvedereError {
        let keys: Vec<&str> = self.keys.iter().copied().chain([key]).collect();
        self.at.error(&keys, text).into()
    }

    fn needed<T>(&self, value: Option<T>, key: &str, name: &str) -> Result<T, BelvedereError> {
        value.ok_or_else(|| self.fail("kind", format!("a move of kind {name} needs {key}")))
    }

    /// Keys that another kind of move has would be without effect.
    fn refuse_others(&self, doc: &MoveDoc, name: &str) -> Result<(), BelvedereError> {
        let is_line = matches!(doc.kind, MoveKindDoc::Widen | MoveKindDoc::Straighten);
        let given = [
            ("at", doc.at.is_some(), !is_line),
            ("along", doc.along.is_some(), is_line),
            ("path", doc.path.is_some(), is_line),
            ("from_m", doc.from_m.is_some(), is_line),
            ("to_m", doc.to_m.is_some(), is_line),
            ("shift_m", doc.shift_m.is_some(), doc.kind == MoveKindDoc::Shift),
            ("angle_deg", doc.angle_deg.is_some(), doc.kind == MoveKindDoc::Turn),
            ("by_m", doc.by_m.is_some(), matches!(doc.kind, MoveKindDoc::Raise | MoveKindDoc::Widen)),
            ("share", doc.share.is_some(), doc.kind == MoveKindDoc::Straighten),
        ];
        match given.into_iter().find(|(_, is_given, fits)| *is_given && !fits) {
            Some((key, ..)) => Err(self.fail(key, format!("a move of kind {name} has no {key}; remove it"))),
            None => Ok(()),
        }
    }

    /// The line of a move, or its stretch.
    fn line(&self, doc: &MoveDoc, name: &str) -> Result<Vec<DVec2>, BelvedereError> {
        let what = format!("a move of kind {name}");
        let line =
            LineOfStage { along: doc.along.as_deref(), path: doc.path.as_deref(), within: self.keys, what: &what };
        let (points, _) = line.find(self.context, self.at)?;
        let (from, to) = (doc.from_m.unwrap_or(0.0), doc.to_m.unwrap_or(f64::INFINITY));
        if !(from >= 0.0 && from < to) {
            let text = format!(
                "{what} goes from {} to {} m along its line; from_m must be at least 0 and below to_m",
                number(from),
                number(to)
            );
            return Err(self.fail("from_m", text));
        }
        Ok(stretch(&points, from, to))
    }
}

/// The stretch of a line between two lengths along it.
fn stretch(points: &[DVec2], from: f64, to: f64) -> Vec<DVec2> {
    let (mut out, mut behind) = (Vec::new(), 0.0);
    for pair in points.windows(2) {
        let long = pair[0].distance(pair[1]);
        let share = |along: f64| ((along - behind) / long).clamp(0.0, 1.0);
        if long > 0.0 && behind + long > from && behind < to {
            if out.is_empty() {
                out.push(pair[0].lerp(pair[1], share(from)));
            }
            out.push(pair[0].lerp(pair[1], share(to)));
        }
        behind += long;
    }
    out
}

fn name(kind: MoveKindDoc) -> &'static str {
    match kind {
        MoveKindDoc::Shift => "shift",
        MoveKindDoc::Turn => "turn",
        MoveKindDoc::Raise => "raise",
        MoveKindDoc::Widen => "widen",
        MoveKindDoc::Straighten => "straighten",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretch_begins_and_ends_where_it_is_told() {
        let line = [[0.0, 0.0], [10.0, 0.0], [10.0, 0.0], [10.0, 10.0]].map(DVec2::from);
        assert_eq!(stretch(&line, 0.0, f64::INFINITY), [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]].map(DVec2::from));
        assert_eq!(stretch(&line, 4.0, 12.0), [[4.0, 0.0], [10.0, 0.0], [10.0, 2.0]].map(DVec2::from));
        assert!(stretch(&line, 40.0, 50.0).is_empty());
    }
}
