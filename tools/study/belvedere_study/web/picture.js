// Pictures on the screen: a place seen from several views, and where in it a click was.

function picture(name) {
  const image = el("img", { src: DATA.pictures[name], alt: t("picture.alt"), draggable: false });
  // Drawn before it is shown, so that the time does not hold the decoding.
  return image.decode().then(() => image, () => image);
}

function setRatio() {
  const [width, height] = DATA.kit.size;
  document.documentElement.style.setProperty("--ratio", width / height);
}

/** A place that is seen from several views. */
class Views {
  static async of(names, start) {
    const views = new Views();
    views.images = await Promise.all(names.map(picture));
    views.cross = el("div", { className: "cross" });
    views.stage = el("div", { className: "stage" }, ...views.images, views.cross);
    views.left = button(`◀ ${t("view.left")}`, () => views.step(-1));
    views.right = button(`${t("view.right")} ▶`, () => views.step(1));
    views.label = el("span", { className: "soft" });
    views.bar = el("div", { className: "bar" }, views.left, views.label, views.right);
    views.at = start;
    views.steps = 0;
    views.show();
    return views;
  }

  show() {
    this.images.forEach((image, k) => image.classList.toggle("on", k === this.at));
    this.left.disabled = this.at === 0;
    this.right.disabled = this.at === this.images.length - 1;
    this.label.textContent = t("view.at", { view: this.at + 1, all: this.images.length });
  }

  step(by) {
    const to = this.at + by;
    if (to < 0 || to >= this.images.length) return;
    this.at = to;
    this.steps += 1;
    this.show();
  }

  /** Steps with the arrow keys; whether it was one. */
  key(event) {
    const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!by) return false;
    event.preventDefault();
    this.step(by);
    return true;
  }

  /** Where in the picture an event is, pixels of the picture. */
  place(event) {
    const box = this.stage.getBoundingClientRect();
    const [width, height] = DATA.kit.size;
    return [((event.clientX - box.left) / box.width) * width, ((event.clientY - box.top) / box.height) * height];
  }

  /** Puts the cross, or a ring, at a place of the picture. */
  put(node, [x, y]) {
    const [width, height] = DATA.kit.size;
    node.style.left = `${(100 * x) / width}%`;
    node.style.top = `${(100 * y) / height}%`;
    node.style.display = "block";
  }

  get width() {
    return Math.round(this.stage.getBoundingClientRect().width);
  }
}

/** Whether a place lies in runs of pixels: row, first column, column after the last. */
function hit(runs, [x, y]) {
  return runs.some(([row, start, end]) => row <= y && y < row + 1 && start <= x && x < end);
}

/** A place in the middle of runs of pixels. */
function middle(runs) {
  const [row, start, end] = runs[Math.floor(runs.length / 2)];
  return [(start + end) / 2, row + 0.5];
}

/** A map of a route, as markup of numbers alone; all maps of a trial have one scale. */
function mapOf(corners, all) {
  const xs = all.flat().map(([x]) => x), ys = all.flat().map(([, y]) => y);
  const [left, right, low, high] = [Math.min(...xs) - 1, Math.max(...xs) + 1, Math.min(...ys) - 1, Math.max(...ys) + 1];
  const at = ([x, y]) => `${(x - left) * 20},${(high - y) * 20}`;
  const [[x0, y0]] = corners;
  let grid = "";
  for (let x = left; x <= right; x++) grid += `M${at([x, low])}L${at([x, high])}`;
  for (let y = low; y <= high; y++) grid += `M${at([left, y])}L${at([right, y])}`;
  const box = el("div");
  box.innerHTML =
    `<svg viewBox="0 0 ${(right - left) * 20} ${(high - low) * 20}" aria-hidden="true">` +
    `<path d="${grid}" stroke="#d5dae1" stroke-width="3" fill="none"/>` +
    `<polyline points="${corners.map(at).join(" ")}" stroke="#d7301f" stroke-width="4" fill="none" ` +
    `stroke-linejoin="round" stroke-linecap="round"/>` +
    `<circle cx="${(x0 - left) * 20}" cy="${(high - y0) * 20}" r="6" fill="#d7301f"/></svg>`;
  return box;
}
