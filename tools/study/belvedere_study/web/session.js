// One participant's session: consent, practice, trials, breaks, the file at the end. It goes on after a reload.

const BREAK_EVERY = 12;

/** Runs the session of a code, from where it was. */
async function runSession(code) {
  const key = `belvedere-study:${DATA.kit.kit}:${code.code}`;
  const trials = trialsOf(code);
  const state = store.get(key) || { rows: [], next: 0, shown: -1, agreed: false, practised: [] };
  const keep = () => store.set(key, state);
  if (!state.agreed) await consent(code);
  else if (state.next < trials.length) {
    await pressed(t("title"), [paragraph(t("resume", { done: state.next, all: trials.length }))], t("next"));
  }
  state.agreed = true;
  const kept = keep();
  if (!kept) await pressed(t("title"), [paragraph(t("broken.storage"))], t("next"));
  while (state.next < trials.length) {
    const at = state.next, trial = trials[at];
    if (!state.practised.includes(trial.task)) {
      await introduce(trial.task);
      state.practised.push(trial.task);
      keep();
    } else if (at > 0 && at % BREAK_EVERY === 0) await rest(at, trials.length);
    await ready(trial, at, trials.length);
    const restarted = state.shown === at;
    state.shown = at;
    keep();
    const answer = await TASKS[trial.task](trial);
    state.rows.push(rowOf(code, at, trial, answer, restarted));
    state.next += 1;
    keep();
  }
  finish(code, key, state.rows);
}

function rowOf(code, at, trial, answer, restarted) {
  return {
    kit: DATA.kit.kit, class: code.word, participant: code.number,
    session: code.run + (code.length === "full" ? "F" : "S"), position: at + 1,
    task: trial.task, scene: trial.scene, condition: trial.condition, left: trial.left, right: trial.right,
    restarted: Number(restarted), ...answer,
  };
}

function consent(code) {
  return new Promise((resolve) => {
    const agree = el("input", { type: "checkbox", onchange: () => (go.disabled = !agree.checked) });
    const go = button(t("consent.go"), resolve, "main");
    go.disabled = true;
    const minutes = DATA.minutes[code.run][code.length];
    page(t("consent.title"), paragraph(t("consent.what", { minutes })), paragraph(t("consent.bent")),
      paragraph(t("consent.data")), el("label", { className: "line" }, agree, ` ${t("consent.agree")}`),
      el("div", { className: "bar" }, go));
  });
}

/** Tells what a task is, and lets it be tried. */
async function introduce(task) {
  const seconds = DATA.kit.limits_s.count;
  const more = task === "find" ? [paragraph(t("task.find.keys"), "soft")] : [];
  const text = [paragraph(t(`task.${task}.text`, { seconds })), ...more];
  await pressed(t(`task.${task}.title`), text, t("next"));
  for (const trial of practiceOf(task)) {
    await ready(trial);
    const answer = await TASKS[task](trial);
    await feedback(trial, answer);
  }
  if (task !== "prefer") await pressed(t(`task.${task}.title`), [paragraph(t("practice.done"))], t("next"));
}

/** What was right in practice. */
async function feedback(trial, answer) {
  if (trial.task === "prefer") return;
  const values = { answer: trial.task === "path" ? 1 + ((4 - trial.shift) % 4) : trial.item.answer };
  const hint = t(`task.${trial.task}.hint`, values);
  const text = answer.correct ? t("practice.right") : t("practice.wrong", { hint });
  const nodes = [el("p", { className: answer.correct ? "note good" : "note" }, text)];
  if (trial.task === "find" && !answer.correct) nodes.push((await pointedAt(trial)).stage);
  await pressed(t(`task.${trial.task}.title`), nodes, t("next"));
}

/** The view that shows most of what was sought, with a ring around it. */
async function pointedAt(trial) {
  const shown = trial.item[trial.condition];
  const sizes = shown.seen_px.map(([px]) => px);
  const best = sizes.indexOf(Math.max(...sizes));
  const views = await Views.of(shown.pictures, best);
  const ring = el("div", { className: "ring" });
  views.stage.append(ring);
  views.put(ring, middle(shown.targets[best]));
  return views;
}

/** The question, before its picture; then a cross to look at. */
async function ready(trial, at, all) {
  const practice = at === undefined;
  const above = practice
    ? [paragraph(t("practice"), "soft")]
    : [el("div", { className: "progress" }, el("i", { style: `width:${(100 * at) / all}%` })),
      paragraph(t("progress", { done: at, all }), "soft")];
  say(question(trial));
  await pressed(question(trial), [...above, paragraph(t("ready.hint"), "soft")], t("ready"));
  onKeys(null);
  screen(el("div", { className: "fixation" }, "+"));
  await wait(600);
}

async function rest(done, all) {
  await pressed(t("break.title"), [paragraph(t("break.text", { done, all }))], t("next"));
}

function finish(code, key, rows) {
  const text = csvText(rows);
  const box = el("textarea", { readOnly: true, value: text, "aria-label": t("end.text") });
  const note = el("div", { className: "note good" });
  const copy = button(t("end.copy"), () => {
    box.select();
    // The old way works from a file, too, where the new one may be refused.
    const done = document.execCommand("copy");
    note.textContent = done ? t("end.copied") : "";
  });
  const remove = button(t("end.delete"), () => {
    store.remove(key);
    note.textContent = t("end.deleted");
  });
  const save = saveLink(t("end.download"), `answers-${code.code}.csv`, text);
  page(t("end.title"), paragraph(t("end.text")), el("div", { className: "bar" }, save, copy, remove), box, note);
}
