// Answers as rows of CSV, with the columns of the analysis.

function csvText(rows) {
  const cell = (value) => (/[",\r\n]/.test(value) ? `"${value.replace(/"/g, '""')}"` : value);
  const line = (cells) => cells.map((value) => cell(String(value ?? ""))).join(",") + "\r\n";
  return line(DATA.columns) + rows.map((row) => line(DATA.columns.map((column) => row[column]))).join("");
}

/** Rows of a text, or `null` if it holds no answers of this kit. */
function csvRows(text) {
  const [head, ...lines] = csvCells(text.replace(/^\ufeff/, ""));
  if (!head || DATA.columns.some((column) => !head.includes(column))) return null;
  const rows = lines
    .filter((cells) => cells.length === head.length)
    .map((cells) => Object.fromEntries(head.map((column, k) => [column, cells[k]])));
  return rows.every((row) => row.kit === DATA.kit.kit) ? rows : null;
}

function csvCells(text) {
  const lines = [];
  let cells = [], cell = "", quoted = false;
  for (let k = 0; k < text.length; k++) {
    const letter = text[k];
    if (quoted) {
      if (letter === '"' && text[k + 1] === '"') cell += text[++k];
      else if (letter === '"') quoted = false;
      else cell += letter;
    } else if (letter === '"') quoted = true;
    else if (letter === ",") {
      cells.push(cell);
      cell = "";
    } else if (letter === "\n") {
      lines.push([...cells, cell]);
      [cells, cell] = [[], ""];
    } else if (letter !== "\r") cell += letter;
  }
  if (cell || cells.length) lines.push([...cells, cell]);
  return lines;
}

/** One row for every position of every participant, the first that came. */
function uniqueRows(rows) {
  const kept = new Map();
  for (const row of rows) {
    const key = [row.class, row.participant, row.position].join("\n");
    if (!kept.has(key)) kept.set(key, row);
  }
  return [...kept.values()];
}

/** A link that saves a text as a file. */
function saveLink(label, name, text) {
  const address = URL.createObjectURL(new Blob([text], { type: "text/csv;charset=utf-8" }));
  return el("a", { href: address, download: name, className: "button" }, label);
}
