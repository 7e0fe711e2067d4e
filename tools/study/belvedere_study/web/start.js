// Which page is shown: the teacher's, a session, or the question for a code.

function start() {
  setRatio();
  document.addEventListener("keydown", (event) => {
    const typing = event.target.tagName === "INPUT" && event.key.length === 1;
    if (keyHandler && !typing && !event.ctrlKey && !event.metaKey && !event.altKey) keyHandler(event);
  });
  window.addEventListener("hashchange", () => location.reload());
  if (location.hash === "#teacher") return teacherPage();
  const code = readCode(decodeURIComponent(location.hash.replace(/^#code=/, "")));
  return code ? runSession(code) : askCode();
}

function askCode() {
  const example = makeCode({ word: "", run: "AB", length: "short", number: 1 });
  const field = el("input", { className: "code", autocomplete: "off", spellcheck: false });
  const note = el("div", { className: "note" });
  const go = () => {
    const code = readCode(field.value);
    if (!code) note.textContent = t("code.bad", { example });
    // The code stands in the address from now on, so that the session goes on after a reload.
    else location.hash = `code=${code.code}`;
  };
  page(t("title"), paragraph(t("lead")), el("label", { className: "line" }, `${t("code.ask")} `, el("br"), field),
    el("div", { className: "bar" }, button(t("code.start"), go, "main")), note,
    paragraph(t("code.none", { example }), "soft"));
  field.focus();
  onKeys((event) => event.key === "Enter" && event.target === field && go());
}

start();
