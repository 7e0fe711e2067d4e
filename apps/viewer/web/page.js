// Loads the application and its scene, and keeps in the browser what is done in the tab.

import { Kept } from "./kept.js";
import { Mirror } from "./mirror.js";

const word = document.getElementById("word"), text = document.getElementById("text"), share = document.getElementById("share");
const canvas = document.getElementById("canvas");
const fail = (what) => { text.textContent = what; share.hidden = true; word.hidden = false; };

// The application asks for every frame of the screen, for ever. Between changes it gets one a second.
const LONGEST_MS = 1000, AWAKE_MS = 250, HELD = -1;
const request = window.requestAnimationFrame.bind(window), cancel = window.cancelAnimationFrame.bind(window);
let held = null, released = 0, timer = 0, rests_until = 0, awake_until = 0;
const release = () => {
  clearTimeout(timer);
  if (held) released = request(held);
  held = null;
};
const wake = () => {
  awake_until = performance.now() + AWAKE_MS;
  release();
};
// Nothing changes for so long, milliseconds.
const rest_for = (time) => { rests_until = performance.now() + Math.min(time, LONGEST_MS); };
window.requestAnimationFrame = (draw) => {
  const left = rests_until - performance.now();
  if (left <= 0 && performance.now() >= awake_until) rests_until = performance.now() + LONGEST_MS;
  if (left <= 0 || performance.now() < awake_until) return request(draw);
  held = draw;
  timer = setTimeout(release, left);
  return HELD;
};
window.cancelAnimationFrame = (id) => {
  if (id !== HELD) return cancel(id);
  clearTimeout(timer);
  if (!held) cancel(released);
  held = null;
};
const EVENTS = "pointerdown pointermove pointerup pointercancel pointerleave mousemove mouseleave touchstart touchmove touchend touchcancel wheel " +
  "keydown keyup input compositionstart compositionend focus blur copy cut paste dragenter dragover dragleave drop resize visibilitychange hashchange";
for (const kind of EVENTS.split(" ")) addEventListener(kind, wake, { capture: true, passive: true });
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", wake);

// What the tab remembers; a browser may refuse it.
const place = `belvedere ${location.pathname}`;
const remembered = (name) => { try { return sessionStorage.getItem(name); } catch { return null; } };
// `true`, or why it is not remembered: `full` or `refused`.
const remember = (name, value) => {
  try {
    sessionStorage.setItem(name, value);
    return true;
  } catch (e) {
    return e?.name === "QuotaExceededError" ? "full" : "refused";
  }
};
// The name of the tab. A duplicate begins with what the other tab remembers, its name included; the other holds the lock of that name as
// long as it is open, so the duplicate takes a new one. A page that is loaded again waits until its former self has gone.
const LOCK_MS = 500;
const held_alone = async (name) => {
  if (!navigator.locks) return true;
  return new Promise((done) => {
    const held = () => {
      done(true);
      return new Promise(() => {});
    };
    navigator.locks.request(`${name} ${place}`, { signal: AbortSignal.timeout(LOCK_MS) }, held).catch((e) => done(e?.name !== "TimeoutError"));
  });
};
const new_name = () => Array.from(crypto.getRandomValues(new Uint32Array(4)), (n) => n.toString(36)).join("");
let tab = remembered(`belvedere tab ${location.pathname}`) ?? new_name(), duplicate_of = null;
if (!(await held_alone(tab))) {
  [duplicate_of, tab] = [tab, new_name()];
  await held_alone(tab);
}
remember(`belvedere tab ${location.pathname}`, tab);

// The bytes of a file; `told` hears how many came.
const bytes = async (path, told) => {
  const answer = await fetch(path.split("/").map(encodeURIComponent).join("/"));
  if (!answer.ok) throw new Error(`${path}: the server answers ${answer.status}`);
  const parts = [];
  for (const reader = answer.body.getReader(); ;) {
    const { done, value } = await reader.read();
    if (done) break;
    parts.push(value);
    told(value.length);
  }
  return new Uint8Array(await new Blob(parts).arrayBuffer());
};

// Files that the visitor picks: names and bytes; `null` if the browser opens no dialog, as without a press.
const choose = () => new Promise((done, failed) => {
  if (navigator.userActivation?.isActive === false) return done(null);
  const input = document.createElement("input");
  [input.type, input.multiple] = ["file", true];
  const read = async (file) => [file.name, new Uint8Array(await file.arrayBuffer())];
  input.addEventListener("change", () => Promise.all([...input.files].map(read)).then(done, (e) => failed(e.message ?? `${e}`)));
  input.addEventListener("cancel", () => done([]));
  input.click();
});

try {
  const began = performance.now();
  const answer = await fetch("bundle.json");
  const bundle = answer.ok ? await answer.json() : { title: "", open: [], files: [] };
  if (bundle.threads && !crossOriginIsolated) {
    throw new Error("this page was packed for many threads, and its server does not send the two headers in the file _headers; pack it without --all-cores");
  }
  const threads = bundle.threads ? Math.max(2, navigator.hardwareConcurrency ?? 2) : 0;
  const { default: init, Application, initThreadPool } = await import("./belvedere.js");
  if (bundle.title) document.title = `${bundle.title} – Belvedere`;
  const total = bundle.files.reduce((sum, file) => sum + file.bytes, 0);
  let come = 0;
  const told = (n) => { come += n; if (total) share.value = come / total; };
  const [, ...files] = await Promise.all([init(), ...bundle.files.map((file) => bytes(file.path, told))]);
  if (threads) await initThreadPool(threads);
  const application = new Application();
  bundle.files.forEach((file, i) => {
    if (files[i].length !== file.bytes) throw new Error(`${file.path} has ${files[i].length} bytes, ${file.bytes} were packed; pack it again`);
    application.put(file.path, files[i]);
  });

  // The visitor's own files, kept for this tab. `since` is the number of the scene that was open when a file came.
  const kept = await Kept.open(`${tab} ${place}`, duplicate_of && `${duplicate_of} ${place}`).catch(() => null);
  const since = new Map();
  let scene_number = 0;
  try {
    for (const [name, content] of (await kept?.files()) ?? []) application.put(name, content);
  } catch { /* The scene says which files are missing. */ }
  const mirror = new Mirror(document.getElementById("mirror"), canvas, (id, action, words, number) => application.act(id, action, words, number));
  // What the application calls.
  globalThis.belvederePage = {
    choose,
    given: (name, content) => {
      since.set(name, scene_number);
      if (!kept) return setTimeout(() => application.not_kept(false));
      kept.put(name, content).catch((e) => application.not_kept(e instanceof RangeError));
    },
    forget: () => void kept?.retain(() => false),
    mirror: (update) => mirror.take(update),
    wake,
    rest_for,
  };

  // What was being done in this tab comes back, whether it was loaded again or crashed.
  const before = remembered(place);
  text.textContent = "Drawing";
  await application.start(canvas, bundle.open, before ?? undefined);
  word.hidden = true;
  if (threads) setInterval(() => application.attend(), 8);
  window.belvedere = { application, threads, loaded_ms: performance.now() - began };
  let not_kept = true;
  const keep = () => {
    const failure = application.failure();
    if (failure) return fail(`Internal error; please report it with the scene, and load the page again. ${failure}`);
    const left = application.left();
    if (!left) return;
    const is_kept = remember(place, left);
    // Each cause is told once, until the scene is remembered again.
    if (is_kept !== true && is_kept !== not_kept) application.not_remembered(is_kept === "full");
    not_kept = is_kept;
  };
  // The files of a scene that was left are forgotten.
  const tidy = () => {
    const number = application.scene_number();
    if (number === undefined || number === scene_number) return;
    const stem = (name) => name.replace(/\.[^./]*$/, "");
    const needed = new Set(application.needs()), stems = new Set([...needed].map(stem));
    // A file that came after the scene is for what is opened next; files of the same name belong together.
    kept?.retain((name) => needed.has(name) || stems.has(stem(name)) || since.get(name) === number).catch(() => {});
    scene_number = number;
  };
  // The view is in the address, for links.
  let told_view = null;
  const link = () => {
    if (!application.is_drawn()) return;
    const view = application.view();
    if (told_view === null) {
      if (!before && location.hash) application.go(location.hash);
    } else if (view && view !== told_view) {
      history.replaceState(null, "", `#${view}`);
    }
    told_view = view ?? told_view ?? "";
  };
  setInterval(() => { keep(); if (!application.failure()) { tidy(); link(); } }, 1000);
  addEventListener("hashchange", () => application.go(location.hash));
  addEventListener("visibilitychange", () => kept?.touch().catch(() => {}));
  addEventListener("pagehide", keep);
  addEventListener("beforeunload", (event) => {
    keep();
    if (application.changed()) {
      event.preventDefault();
      event.returnValue = true;
    }
  });
} catch (e) {
  fail(`Belvedere could not start: ${e.message ?? e}`);
  throw e;
}
