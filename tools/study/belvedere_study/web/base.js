"use strict";
// What everything else uses: the data of the page, texts, elements, keys.

const DATA = JSON.parse(document.getElementById("data").textContent);

/** A text of the table, with the words in braces replaced. */
function t(key, values = {}) {
  const text = DATA.texts[key] === undefined ? key : DATA.texts[key];
  return text.replace(/\{(\w+)\}/g, (whole, name) => (name in values ? String(values[name]) : whole));
}

/** An element with properties and children; texts become text, never markup. */
function el(tag, properties = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (name in node) node[name] = value;
    else node.setAttribute(name, value);
  }
  node.append(...children);
  return node;
}

/** Shows these elements and nothing else. */
function screen(...children) {
  const main = document.getElementById("main");
  main.replaceChildren(...children);
  main.focus({ preventScroll: true });
  window.scrollTo(0, 0);
}

/** A page of text. */
function page(title, ...children) {
  onKeys(null);
  screen(el("div", { className: "text" }, el("h1", {}, title), ...children));
}

function button(text, action, kind = "") {
  return el("button", { type: "button", className: kind, onclick: action }, text);
}

function paragraph(text, kind = "") {
  return el("p", { className: kind }, text);
}

/** Says something to those who listen to the page. */
function say(text) {
  document.getElementById("live").textContent = text;
}

let keyHandler = null;

/** From now on keys go to this function, and to no other. */
function onKeys(handler) {
  keyHandler = handler;
}

function wait(milliseconds) {
  return new Promise((resolve) => setTimeout(resolve, milliseconds));
}

/** The time at which what was put on the page stands on the screen: after the second frame from now. */
function painted() {
  return new Promise((resolve) =>
    requestAnimationFrame(() => requestAnimationFrame(() => resolve(performance.now()))));
}

/** Waits for a click on the only main button, or for the space bar or Enter. */
function pressed(title, children, label) {
  return new Promise((resolve) => {
    const go = button(label, resolve, "main");
    page(title, ...children, el("div", { className: "bar" }, go));
    onKeys((event) => {
      if (event.key === " " || (event.key === "Enter" && event.target !== go)) {
        event.preventDefault();
        if (!event.repeat) resolve();
      }
    });
  });
}

/** What is kept between visits; `null` where the browser keeps nothing. */
const store = {
  get(key) {
    try {
      return JSON.parse(localStorage.getItem(key));
    } catch {
      return null;
    }
  },
  set(key, value) {
    try {
      localStorage.setItem(key, JSON.stringify(value));
      return true;
    } catch {
      return false;
    }
  },
  remove(key) {
    try {
      localStorage.removeItem(key);
    } catch {
      // Nothing was kept.
    }
  },
};
