// The application's tree of accessibility as elements of the page, where screen readers find roles, names, values and places.
// What is done to an element goes back to the application.

const TAGS = { button: "button", textbox: "input", slider: "input", spinbutton: "input" };
const TYPES = { textbox: "text", slider: "range", spinbutton: "number" };
const idOf = (id) => `node-${id}`;

const set = (element, name, value) => {
  if (value === undefined || value === null) element.removeAttribute(name);
  else if (element.getAttribute(name) !== `${value}`) element.setAttribute(name, value);
};

export class Mirror {
  #place; #canvas; #act; #elements = new Map(); #waiting = []; #focus = null;

  // `act(id, action, text, number)` asks the application for an action.
  constructor(place, canvas, act) {
    [this.#place, this.#canvas, this.#act] = [place, canvas, act];
    const of = (event) => event.target.dataset?.node;
    place.addEventListener("click", (event) => {
      event.stopPropagation();
      if (event.target.tagName !== "INPUT") act(of(event), "click");
    });
    place.addEventListener("focusin", (event) => {
      if (of(event) !== this.#focus) act(of(event), "focus");
    });
    const change = (event) => {
      const { type, value, valueAsNumber } = event.target;
      if (type === "text") act(of(event), "text", value);
      else if (Number.isFinite(valueAsNumber)) act(of(event), "number", undefined, valueAsNumber);
    };
    place.addEventListener("input", (event) => event.target.type !== "number" && change(event));
    place.addEventListener("change", (event) => event.target.type === "number" && change(event));
    place.addEventListener("keydown", (event) => {
      const [tag, presses] = [event.target.tagName, ["Enter", " "].includes(event.key)];
      if (tag === "INPUT" ? !["Tab", "Escape"].includes(event.key) : tag === "BUTTON" && presses) return;
      if (presses) {
        // Only buttons press themselves.
        event.preventDefault();
        event.stopPropagation();
        act(of(event), "click");
        return;
      }
      // Other keys are the application's.
      event.preventDefault();
      event.stopPropagation();
      canvas.focus({ preventScroll: true });
      canvas.dispatchEvent(new KeyboardEvent("keydown", event));
    });
  }

  // Takes an update. It is applied when the application has returned, since elements that go take the focus with them.
  take(text) {
    this.#waiting.push(text);
    if (this.#waiting.length === 1) queueMicrotask(() => this.#waiting.splice(0).forEach((one) => this.#apply(JSON.parse(one))));
  }

  #apply({ root, focus, nodes, gone }) {
    const within = this.#place.contains(document.activeElement);
    nodes.forEach((node) => this.#show(node));
    for (const { id, children } of nodes) {
      const parent = this.#elements.get(id);
      let next = parent.firstElementChild;
      for (const child of children) {
        const element = this.#elements.get(child);
        if (!element) continue;
        if (element === next) next = next.nextElementSibling;
        else parent.insertBefore(element, next);
      }
    }
    for (const id of gone) {
      this.#elements.get(id)?.remove();
      this.#elements.delete(id);
    }
    const top = this.#elements.get(root);
    if (top && top.parentElement !== this.#place) this.#place.replaceChildren(top);
    const focused = focus === root ? null : this.#elements.get(focus);
    set(this.#canvas, "aria-activedescendant", focused && idOf(focus));
    const moved = focus !== this.#focus;
    this.#focus = focus;
    if (within && moved && focused) focused.focus({ preventScroll: true });
    if (within && !this.#place.contains(document.activeElement)) this.#canvas.focus({ preventScroll: true });
  }

  #show(node) {
    const tag = TAGS[node.role] ?? "div";
    let element = this.#elements.get(node.id);
    if (element?.tagName !== tag.toUpperCase()) {
      const old = element;
      element = document.createElement(tag);
      [element.id, element.tabIndex, element.dataset.node] = [idOf(node.id), -1, node.id];
      if (old) {
        element.append(...old.childNodes);
        old.replaceWith(element);
      }
      this.#elements.set(node.id, element);
    }
    const isInput = tag === "input";
    set(element, "type", TYPES[node.role] ?? (tag === "button" ? "button" : undefined));
    set(element, "role", TAGS[node.role] ? undefined : node.role);
    set(element, "aria-label", node.name);
    set(element, "aria-labelledby", node.named_by?.map(idOf).join(" "));
    set(element, "aria-description", node.description);
    set(element, "aria-disabled", node.disabled ? true : undefined);
    set(element, "aria-hidden", node.hidden ? true : undefined);
    set(element, "aria-live", node.live);
    set(element, "aria-expanded", node.expanded);
    set(element, ["checkbox", "radio", "switch"].includes(node.role) ? "aria-checked" : "aria-pressed", node.toggled);
    set(element, "aria-selected", node.selected);
    if (isInput) {
      set(element, "step", node.role === "textbox" ? undefined : "any");
      set(element, "min", node.min);
      set(element, "max", node.max);
      const value = `${node.role === "textbox" ? (node.value ?? "") : (node.number ?? "")}`;
      if (element.value !== value) element.value = value;
    } else {
      set(element, "aria-valuenow", node.number);
      set(element, "aria-valuemin", node.min);
      set(element, "aria-valuemax", node.max);
      set(element, "aria-valuetext", node.number === undefined ? undefined : node.value);
      const text = node.number === undefined && !node.children.length ? (node.value ?? "") : null;
      if (text !== null && element.textContent !== text) element.textContent = text;
    }
    const [x, y, w, h] = node.place ?? [0, 0, 0, 0];
    Object.assign(element.style, { left: `${x}px`, top: `${y}px`, width: `${w}px`, height: `${h}px` });
  }
}
