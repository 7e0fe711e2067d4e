// Codes of participants, such as ROSE-ABF-07-K: word of the class, what is run and how long, number, and a letter that
// tells slips of the pen.

const CHECK_LETTERS = "ABCDEFGHJKLMNPRSTUVWXYZ";

function makeCode({ word, run, length, number }) {
  const parts = [...(word ? [word] : []), run + (length === "full" ? "F" : "S"), String(number).padStart(2, "0")];
  const text = parts.join("-");
  return `${text}-${checkLetter(text)}`;
}

/** What a code says, or `null`. */
function readCode(typed) {
  const text = typed.trim().toUpperCase().replace(/[\s_\u2010-\u2015]+/g, "-");
  const found = /^((?:([A-Z]+)-)?(AB|A|B)([FS])-(\d{1,4}))-([A-Z])$/.exec(text);
  if (!found) return null;
  const [, , word = "", run, length, number, letter] = found;
  const read = { word, run, length: length === "F" ? "full" : "short", number: Number(number) };
  // The number may be typed without its leading zero.
  const code = makeCode(read);
  return read.number >= 1 && code.endsWith(`-${letter}`) ? { ...read, code } : null;
}

function checkLetter(text) {
  let sum = 0;
  for (let k = 0; k < text.length; k++) sum += (k + 1) * text.charCodeAt(k);
  return CHECK_LETTERS[sum % CHECK_LETTERS.length];
}
