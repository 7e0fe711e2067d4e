// The four tasks. Each shows its pictures, waits for the answer and tells what it was.

const thingOf = (item, number) => t(`${number}.${item.colour}.${item.what}`);

/** What is asked in a trial. */
function question({ task, item }) {
  if (task === "find") return t("task.find.ask", { thing: thingOf(item, "thing") });
  if (task === "count") return t("task.count.ask", { things: thingOf(item, "things") });
  return t(`task.${task}.ask`);
}

const TASKS = { find: findTask, count: countTask, path: pathTask, prefer: preferTask };

/** Find something and click it. Clicks beside it are counted, and hold up for a second. */
async function findTask(trial) {
  const shown = trial.item[trial.condition];
  const views = await Views.of(shown.pictures, trial.item.start);
  const note = el("div", { className: "note" });
  views.stage.classList.add("aim");
  const giveUp = button(t("task.find.giveup"), () => {});
  screen(paragraph(question(trial), "ask"), views.stage, views.bar, note, el("div", { className: "bar" }, giveUp));
  const started = await painted();
  return new Promise((resolve) => {
    let wrong = 0, heldUntil = 0, aim = DATA.kit.size.map((length) => length / 2);
    const end = (found, place, input) => {
      clearTimeout(timer);
      onKeys(null);
      resolve({
        ...timed(started), ...seen(views), answer: found ? "found" : "not found", correct: Number(found),
        timed_out: Number(!found), wrong_clicks: wrong, input,
        ...(place ? { x: place[0].toFixed(1), y: place[1].toFixed(1) } : {}),
      });
    };
    const click = (place, input) => {
      if (performance.now() < heldUntil) return;
      if (hit(shown.targets[views.at], place)) return end(true, place, input);
      wrong += 1;
      heldUntil = performance.now() + 1000;
      note.textContent = t("task.find.miss");
      setTimeout(() => (note.textContent = ""), 1000);
    };
    const timer = setTimeout(() => end(false, null, ""), DATA.kit.limits_s.find * 1000);
    giveUp.onclick = () => end(false, null, "mouse");
    views.stage.addEventListener("pointerdown", (event) => click(views.place(event), "mouse"));
    onKeys((event) => {
      const way = { w: [0, -1], s: [0, 1], a: [-1, 0], d: [1, 0] }[event.key.toLowerCase()];
      if (way) {
        const step = event.shiftKey ? 3 : 14;
        aim = aim.map((at, k) => Math.min(Math.max(at + step * way[k], 0), DATA.kit.size[k] - 1));
        views.put(views.cross, aim);
      } else if (event.key === "Enter" && event.target.tagName !== "BUTTON") click(aim, "key");
      else views.key(event);
    });
  });
}

/** Count things; the picture goes away when the time is up. */
async function countTask(trial) {
  const views = await Views.of(trial.item[trial.condition].pictures, trial.item.start);
  const field = el("input", { className: "number", inputMode: "numeric", maxLength: 3, autocomplete: "off" });
  const done = button(t("task.count.done"), () => {}, "main");
  const answer = el("div", { className: "bar" }, el("label", {}, `${t("task.count.answer")} `, field), done);
  screen(paragraph(question(trial), "ask"), views.stage, views.bar, answer);
  field.focus();
  const started = await painted();
  return new Promise((resolve) => {
    let late = 0;
    const width = views.width;
    const end = (input) => {
      if (!/^\d{1,3}$/.test(field.value.trim())) return field.focus();
      clearTimeout(timer);
      onKeys(null);
      const number = Number(field.value);
      resolve({
        ...timed(started), ...seen(views), picture_px: width, answer: number, right_answer: trial.item.answer,
        correct: Number(number === trial.item.answer), timed_out: late, input,
      });
    };
    const timer = setTimeout(() => {
      late = 1;
      views.stage.style.visibility = "hidden";
      views.bar.style.visibility = "hidden";
      field.focus();
    }, DATA.kit.limits_s.count * 1000);
    done.onclick = () => end("mouse");
    onKeys((event) => {
      if (event.key === "Enter" && event.target !== done) end("key");
      else if (!late) views.key(event);
    });
  });
}

/** Remember a route: its views pass by themselves, there and back; then choose a map. */
async function pathTask(trial) {
  const { pictures } = trial.item[trial.condition];
  const views = await Views.of(pictures, 0);
  screen(paragraph(question(trial), "ask"), views.stage);
  await painted();
  const width = views.width;
  for (const at of [...pictures.keys(), ...[...pictures.keys()].reverse().slice(1)]) {
    views.at = at;
    views.show();
    await wait(DATA.kit.limits_s.view * 1000);
  }
  const maps = trial.item.maps;
  // The right map is the first of the kit; the order of the table says which stands first on the screen.
  const places = maps.map((_, k) => (k + trial.shift) % maps.length);
  return new Promise((resolve) => {
    let started = 0;
    const choose = (place, input) => {
      if (!started) return;
      onKeys(null);
      const map = places[place];
      resolve({ ...timed(started), answer: map + 1, correct: Number(map === 0), input, picture_px: width });
    };
    const choices = places.map((map, k) => {
      const choice = button("", () => choose(k, "mouse"));
      choice.setAttribute("aria-label", t("map.alt", { number: k + 1 }));
      choice.append(mapOf(maps[map], maps), String(k + 1));
      return choice;
    });
    screen(paragraph(t("task.path.choose"), "ask"), el("div", { className: "maps" }, ...choices));
    onKeys((event) => "1234".includes(event.key) && event.key && choose(Number(event.key) - 1, "key"));
    painted().then((now) => (started = now));
  });
}

/** Say which of two pictures is better. */
async function preferTask(trial) {
  const images = await Promise.all([trial.left, trial.right].map((one) => picture(trial.item[one].picture)));
  const answers = [-2, -1, 0, 1, 2];
  return new Promise((resolve) => {
    let started = 0;
    const choose = (answer, input) => {
      if (!started) return;
      onKeys(null);
      resolve({ ...timed(started), answer, input, picture_px: Math.round(images[0].getBoundingClientRect().width) });
    };
    const choices = answers.map((answer, k) =>
      button(`${k + 1}  ${t(`task.prefer.${answer}`)}`, () => choose(answer, "mouse")));
    screen(paragraph(question(trial), "ask"), el("div", { className: "pair" }, ...images),
      el("div", { className: "bar" }, ...choices));
    onKeys((event) => "12345".includes(event.key) && event.key && choose(Number(event.key) - 3, "key"));
    painted().then((now) => (started = now));
  });
}

function timed(started) {
  return { time_ms: Math.round(performance.now() - started) };
}

function seen(views) {
  return { steps: views.steps, view: views.at, picture_px: views.width };
}
