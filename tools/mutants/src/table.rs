//! The results of the run, as text.

use crate::Plan;
use crate::find::Fault;
use crate::hunt::Results;

/// A fault as one line: its place, the original text and the replacement.
pub(crate) fn line(fault: &Fault) -> String {
    let short = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|");
    let mutated = if fault.statement { "nothing".into() } else { format!("`{}`", short(&fault.mutated)) };
    format!("{}:{} | `{}` | {mutated}", fault.file.display(), fault.line, short(&fault.original))
}

/// Counts by package, then the faults that were missed, then the faults that were noticed, each with the test that noticed it.
pub(crate) fn report(plan: &Plan, results: &Results) -> String {
    let mut out = format!(
        "Seed {}, commit {}.\n\n| package | faults | noticed | missed |\n|---|---|---|---|\n",
        plan.seed, plan.commit
    );
    let mut row = |name: &str, of: &dyn Fn(&Fault) -> bool| {
        let all: Vec<_> = plan.chosen.iter().filter(|id| of(&plan.faults[**id])).collect();
        let noticed = all.iter().filter(|id| results.noticed.contains_key(id)).count();
        let share = 100.0 * noticed as f64 / all.len().max(1) as f64;
        out += &format!("| {name} | {} | {noticed} ({share:.0} %) | {} |\n", all.len(), all.len() - noticed);
    };
    for package in plan.packages.iter().filter(|p| plan.only.as_ref().is_none_or(|o| o == *p)) {
        row(package, &|f| f.package == *package);
    }
    row("all", &|_| true);
    out += "\n| missed | original | mutated | tests that come to it | level |\n|---|---|---|---|---|\n";
    for id in plan.chosen.iter().filter(|id| !results.noticed.contains_key(id)) {
        let tests = results.tests.get(id).copied().unwrap_or(0);
        let level = results.levels.get(id).map_or("-".into(), usize::to_string);
        out += &format!("| {} | {tests} | {level} |\n", line(&plan.faults[*id]));
    }
    out += "\n| noticed | original | mutated | by |\n|---|---|---|---|\n";
    for (id, test) in &results.noticed {
        out += &format!("| {} | {test} |\n", line(&plan.faults[*id]));
    }
    if !results.broken.is_empty() {
        out += &format!("\nFail without a fault, left out: {}.\n", results.broken.join(", "));
    }
    out
}
