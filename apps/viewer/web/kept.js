// Files that a visitor gave, kept in the browser (IndexedDB) for the tab that they were given to.

// Most bytes of one tab; the memory of a page takes no more.
const MOST = 2 ** 30;
// Share of the browser's room that is left to others.
const LEFT = 0.1;
// Tabs that were not seen for this long are closed: their files are forgotten.
const CLOSED_MS = 7 * 24 * 3600e3;
// For files of a tab that is open, room is made of those that were not seen for this long.
const OLD_MS = 24 * 3600e3;

// A browser whose store answers nothing for so long, milliseconds, counts as one that keeps nothing; files take longer.
const ANSWER_MS = 5e3, FILE_MS = 30e3;

const within = (answer, time) => new Promise((done, fail) => {
  const timer = setTimeout(() => fail(new Error("the browser's store does not answer")), time);
  answer.then(done, fail).finally(() => clearTimeout(timer));
});
const result = (request, time = ANSWER_MS) => within(new Promise((done, fail) => {
  request.onsuccess = () => done(request.result);
  request.onerror = () => fail(request.error);
}), time);
const ended = (change, time = ANSWER_MS) => within(new Promise((done, fail) => {
  change.oncomplete = () => done();
  change.onerror = change.onabort = () => fail(change.error);
}), time);
const all = (tab) => IDBKeyRange.bound([tab], [tab, []]);

export class Kept {
  #db; #tab; #sizes = new Map();

  // `tab`: the name of this tab and page. `from`: that of the tab that this one is a duplicate of; its files are copied.
  static async open(tab, from) {
    const request = indexedDB.open("belvedere", 1);
    request.onupgradeneeded = () => ["files", "tabs"].forEach((name) => request.result.createObjectStore(name));
    const kept = new Kept();
    [kept.#db, kept.#tab] = [await result(request), tab];
    await kept.touch();
    await kept.#forgetTabs(CLOSED_MS);
    if (from) await kept.#copy(from);
    return kept;
  }

  // Says that the tab is open.
  async touch() {
    const change = this.#db.transaction("tabs", "readwrite");
    change.objectStore("tabs").put(Date.now(), this.#tab);
    await ended(change);
  }

  // Names and bytes of the tab's files.
  async files() {
    const named = await this.#read(this.#tab);
    this.#sizes = new Map(named.map(([name, bytes]) => [name, bytes.length]));
    return named;
  }

  async #read(tab) {
    const files = this.#db.transaction("files").objectStore("files");
    const [keys, contents] = await Promise.all([files.getAllKeys(all(tab)), files.getAll(all(tab))].map((request) => result(request, FILE_MS)));
    return keys.map(([, name], i) => [name, contents[i]]);
  }

  // Copies the files of another tab, as far as there is room: what either tab forgets stays with the other.
  async #copy(tab) {
    try {
      for (const [name, bytes] of await this.#read(tab)) await this.put(name, bytes);
    } catch { /* The scene says which files are missing. */ }
  }

  // Keeps a file; fails with a RangeError if there is no room for it.
  async put(name, bytes) {
    const others = [...this.#sizes].reduce((sum, [other, size]) => sum + (other === name ? 0 : size), 0);
    if (others + bytes.length > MOST) throw new RangeError("full");
    if (!(await this.#hasRoom(bytes.length))) {
      await this.#forgetTabs(OLD_MS);
      if (!(await this.#hasRoom(bytes.length))) throw new RangeError("full");
    }
    this.#sizes.set(name, bytes.length);
    try {
      const change = this.#db.transaction("files", "readwrite");
      change.objectStore("files").put(bytes, [this.#tab, name]);
      await ended(change, FILE_MS);
    } catch (e) {
      this.#sizes.delete(name);
      throw e?.name === "QuotaExceededError" ? new RangeError("full") : e;
    }
  }

  // Forgets all files but those that `stays` names.
  async retain(stays) {
    const gone = [...this.#sizes.keys()].filter((name) => !stays(name));
    if (!gone.length) return;
    gone.forEach((name) => this.#sizes.delete(name));
    const change = this.#db.transaction("files", "readwrite");
    gone.forEach((name) => change.objectStore("files").delete([this.#tab, name]));
    await ended(change);
  }

  async #hasRoom(bytes) {
    const { quota, usage } = (await navigator.storage?.estimate?.()) ?? {};
    return !quota || usage + bytes < (1 - LEFT) * quota;
  }

  // Forgets the files of the other tabs that were not seen for a time, milliseconds.
  async #forgetTabs(age) {
    const change = this.#db.transaction(["files", "tabs"], "readwrite");
    const [files, tabs] = ["files", "tabs"].map((name) => change.objectStore(name));
    const request = tabs.openCursor();
    request.onsuccess = () => {
      const cursor = request.result;
      if (!cursor) return;
      if (cursor.key !== this.#tab && cursor.value < Date.now() - age) {
        files.delete(all(cursor.key));
        cursor.delete();
      }
      cursor.continue();
    };
    await ended(change);
  }
}
