// Files that a visitor gave, kept in the browser (IndexedDB) for the tab that they were given to.

// Most bytes of one tab; the memory of a page takes no more.
const MOST = 2 ** 30;
// Share of the browser's room that is left to others.
const LEFT = 0.1;
// Tabs that were not seen for this long are closed: their files are forgotten.
const CLOSED_MS = 7 * 24 * 3600e3;
// For files of a tab that is open, room is made of those that were not seen for this long.
const OLD_MS = 24 * 3600e3;

const result = (request) => new Promise((done, fail) => {
  request.onsuccess = () => done(request.result);
  request.onerror = () => fail(request.error);
});
const ended = (change) => new Promise((done, fail) => {
  change.oncomplete = () => done();
  change.onerror = change.onabort = () => fail(change.error);
});
const all = (tab) => IDBKeyRange.bound([tab], [tab, []]);

export class Kept {
  #db; #tab; #sizes = new Map();

  // `tab`: the name of this tab and page.
  static async open(tab) {
    const request = indexedDB.open("belvedere", 1);
    request.onupgradeneeded = () => ["files", "tabs"].forEach((name) => request.result.createObjectStore(name));
    const kept = new Kept();
    [kept.#db, kept.#tab] = [await result(request), tab];
    await kept.touch();
    await kept.#forgetTabs(CLOSED_MS);
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
    const files = this.#db.transaction("files").objectStore("files");
    const [keys, contents] = await Promise.all([result(files.getAllKeys(all(this.#tab))), result(files.getAll(all(this.#tab)))]);
    const named = keys.map(([, name], i) => [name, contents[i]]);
    this.#sizes = new Map(named.map(([name, bytes]) => [name, bytes.length]));
    return named;
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
      await ended(change);
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
