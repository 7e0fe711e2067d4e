// The trials of a session, in the order that the table of the kit gives to the number.

function trialsOf({ run, length, number }) {
  const table = DATA.order[length];
  const row = table[(number - 1) % table.length];
  const listed = [...(run.includes("A") ? row.a : []), ...(run.includes("B") ? row.b : [])];
  return listed.map(trialOf);
}

function trialOf([taskNumber, scene, one, two]) {
  const task = DATA.tasks[taskNumber];
  const item = DATA.kit[task][scene];
  const name = `${task}-${scene + 1}`;
  if (task === "prefer") {
    return { task, item, scene: name, condition: "", left: DATA.perspectives[one], right: DATA.perspectives[two] };
  }
  return { task, item, scene: name, condition: ["straight", "bent"][one], left: "", right: "", shift: two };
}

/** Practice before a task: bent, as that is what is new; a search is practised straight first. */
function practiceOf(task) {
  const [item] = DATA.kit.practice[task];
  const common = { task, item, scene: "practice", left: "", right: "", shift: 1 };
  if (task === "prefer") return [{ ...common, condition: "", left: "progressive", right: "straight" }];
  if (task === "find") return ["straight", "bent"].map((condition) => ({ ...common, condition }));
  return [{ ...common, condition: "bent" }];
}
