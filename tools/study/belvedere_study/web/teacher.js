// The teacher's page: codes for a class, and a first look at its answers.

function teacherPage() {
  const codes = el("div"), have = el("div");
  page(t("teacher.title"), el("h2", {}, t("teacher.start")), classForm(codes), codes,
    el("div", { className: "noprint" }, el("h2", {}, t("teacher.merge")), paragraph(t("teacher.merge.text")),
      dropZone(have), have));
}

function classForm(codes) {
  const word = el("input", { value: "", maxLength: 12 });
  const people = numberField(24, 1, 1000), from = numberField(1, 1, 9000), minutes = numberField(20, 1, 120);
  const run = el("select", {}, ...["AB", "A", "B"].map((one) => el("option", { value: one }, t(`teacher.run.${one}`))));
  const length = el("p", { className: "soft" });
  const choose = () => {
    const needs = DATA.minutes[run.value];
    const chosen = Number(minutes.value) >= needs.full ? "full" : "short";
    length.textContent = Number(minutes.value) < needs.short
      ? t("teacher.tight", { minutes: needs.short })
      : t("teacher.length", { length: t(`teacher.length.${chosen}`), minutes: needs[chosen] });
    return chosen;
  };
  run.onchange = minutes.oninput = choose;
  choose();
  const list = button(t("teacher.codes"), () => {
    const letters = word.value.toUpperCase().replace(/[^A-Z]/g, "");
    const numbers = Array.from({ length: Number(people.value) }, (_, k) => Number(from.value) + k);
    const common = { word: letters, run: run.value, length: choose() };
    codes.replaceChildren(...codeList(numbers.map((number) => makeCode({ ...common, number }))));
  }, "main");
  const line = (text, field) => el("label", { className: "line" }, `${text} `, field);
  return el("div", { className: "noprint" }, line(t("teacher.word"), word), line(t("teacher.people"), people),
    line(t("teacher.from"), from), line(t("teacher.run"), run), line(t("teacher.minutes"), minutes), length, list);
}

function numberField(value, min, max) {
  return el("input", { type: "number", value: String(value), min: String(min), max: String(max) });
}

function codeList(codes) {
  const here = location.href.split("#")[0];
  const rows = codes.map((code) => {
    const address = `${here}#code=${code}`;
    return el("tr", {}, el("td", { className: "code" }, code),
      el("td", { className: "link" }, el("a", { href: address, target: "_blank" }, address)));
  });
  const head = el("tr", {}, el("th", {}, t("teacher.code")), el("th", {}, t("teacher.link")));
  const how = paragraph(t("teacher.codes.text"), "noprint");
  return [el("h2", {}, t("teacher.codes")), how, el("table", {}, head, ...rows)];
}

function dropZone(have) {
  const all = [];
  const take = async (files) => {
    const notes = [];
    for (const file of files) {
      const rows = csvRows(await file.text());
      if (rows) all.push(...rows);
      else notes.push(t("teacher.foreign", { file: file.name }));
    }
    show(notes);
  };
  const show = (notes) => {
    const rows = uniqueRows(all);
    if (rows.length < all.length) notes.push(t("teacher.twice", { rows: all.length - rows.length }));
    have.replaceChildren(...summary(rows), ...notes.map((note) => el("p", { className: "note" }, note)));
  };
  const input = el("input", { type: "file", multiple: true, accept: ".csv,text/csv" });
  input.onchange = () => take(input.files);
  const paste = el("textarea", { className: "small" });
  paste.oninput = () => {
    if (!paste.value.trim()) return;
    const rows = csvRows(paste.value);
    if (rows) all.push(...rows);
    show(rows ? [] : [t("teacher.foreign", { file: t("teacher.pasted") })]);
    paste.value = "";
  };
  const zone = el("div", { className: "drop" }, el("label", {}, `${t("teacher.choose")} `, input),
    el("label", { className: "line" }, t("teacher.paste"), paste));
  zone.addEventListener("dragover", (event) => {
    event.preventDefault();
    zone.classList.add("over");
  });
  zone.addEventListener("dragleave", () => zone.classList.remove("over"));
  zone.addEventListener("drop", (event) => {
    event.preventDefault();
    zone.classList.remove("over");
    take(event.dataTransfer.files);
  });
  return zone;
}

/** A first look: means of all trials, without intervals. */
function summary(rows) {
  if (!rows.length) return [];
  const who = (row) => `${row.class} ${row.participant}`.trim();
  const people = new Map();
  rows.forEach((row) => people.set(who(row), [...(people.get(who(row)) || []), row]));
  const open = [...people].filter(([, mine]) => mine.length < expected(mine[0])).map(([name]) => name);
  return [
    paragraph(t("teacher.have", { people: people.size, rows: rows.length })),
    ...(open.length ? [paragraph(t("teacher.unfinished", { who: open.join(", ") }))] : []),
    taskTable(rows), preferTable(rows),
    el("div", { className: "bar" }, saveLink(t("teacher.save"), "answers-all.csv", csvText(rows))),
  ];
}

function expected(row) {
  const length = row.session.endsWith("F") ? "full" : "short";
  return trialsOf({ run: row.session.slice(0, -1), length, number: Number(row.participant) }).length;
}

function taskTable(rows) {
  const of = (task, condition) => rows.filter((row) => row.task === task && row.condition === condition);
  const right = (list) => mean(list.map((row) => Number(row.correct)));
  const percent = (list) => (list.length ? `${(100 * right(list)).toFixed(0)} %` : t("sum.none"));
  const seconds = (list) =>
    list.length ? (Math.exp(mean(list.map((row) => Math.log(row.time_ms)))) / 1000).toFixed(1) : t("sum.none");
  const line = (name, task, show) =>
    el("tr", {}, el("td", {}, name), ...["straight", "bent"].map((one) => el("td", {}, show(of(task, one)))));
  return el("table", {},
    el("tr", {}, ...["sum.task", "sum.straight", "sum.bent"].map((key) => el("th", {}, t(key)))),
    line(t("sum.find.time"), "find", seconds), line(t("sum.find.found"), "find", percent),
    line(t("sum.count"), "count", percent), line(t("sum.path"), "path", percent));
}

function preferTable(rows) {
  const score = (one) => {
    const answers = rows
      .filter((row) => row.task === "prefer" && (row.left === one || row.right === one))
      .map((row) => Number(row.answer) * (row.right === one ? 1 : -1));
    return answers.length ? mean(answers).toFixed(2) : t("sum.none");
  };
  return el("table", {},
    el("tr", {}, el("th", {}, t("sum.prefer")), el("th", {}, t("sum.score"))),
    ...DATA.perspectives.map((one) => el("tr", {}, el("td", {}, t(`perspective.${one}`)), el("td", {}, score(one)))));
}

function mean(values) {
  return values.reduce((sum, value) => sum + value, 0) / values.length;
}
