"use strict";
// Tables: a click on a heading sorts by it, a second click turns the order; words in the filter leave the rows that have all.
for (const box of document.querySelectorAll(".table")) {
  const table = box.querySelector("table");
  if (!table) continue;
  const body = table.tBodies[0], rows = [...body.rows], heads = [...table.tHead.rows[0].cells];
  const value = (row, i) => {
    const cell = row.cells[i], text = cell.dataset.v ?? cell.textContent;
    return text === "–" ? NaN : Number(text);
  };
  heads.forEach((head, i) => {
    const numeric = head.classList.contains("n");
    for (const row of rows) {
      if (numeric) row.cells[i].className = "n";
      else if (row.cells[i].textContent.length > 60) row.cells[i].className = "long";
    }
    head.firstChild.addEventListener("click", () => {
      const down = head.getAttribute("aria-sort") === "ascending";
      heads.forEach(other => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      const sign = down ? -1 : 1;
      const order = (a, b) => {
        if (!numeric) return sign * a.cells[i].textContent.localeCompare(b.cells[i].textContent, "en", { numeric: true });
        const [x, y] = [value(a, i), value(b, i)];
        // Rows without a value stay below.
        if (Number.isNaN(x) || Number.isNaN(y)) return Number.isNaN(x) - Number.isNaN(y);
        return sign * (x - y) || 0;
      };
      body.append(...rows.sort(order));
    });
  });
  // A selection keeps the rows with one value in its column; that of an accuracy, those with any value in that column.
  const place = name => heads.findIndex(head => head.textContent === name);
  const picks = [...box.querySelectorAll("select")];
  for (const pick of picks.filter(pick => pick.name !== "reached")) {
    const values = new Set(rows.map(row => row.cells[place(pick.name)].textContent));
    for (const value of [...values].sort((a, b) => a.localeCompare(b, "en", { numeric: true }))) pick.add(new Option(value));
  }
  // An address may ask for rows: #grains=250&words=nsgs.
  const asked = [...new URLSearchParams(location.hash.slice(1))], control = name => box.querySelector(`[name="${CSS.escape(name)}"]`);
  if (asked.every(([name]) => control(name))) for (const [name, value] of asked) {
    control(name).value = value;
    // No row has the value.
    if (control(name).selectedIndex < 0) { control(name).add(new Option(value)); control(name).value = value; }
  }
  const kept = (row, pick) => !pick.value || (pick.name === "reached"
    ? row.cells[place(pick.value)].textContent !== "–" : row.cells[place(pick.name)].textContent === pick.value);
  const count = box.querySelector(".count");
  const filter = () => {
    const words = box.querySelector("input").value.toLowerCase().split(/\s+/);
    let left = 0;
    for (const row of rows) {
      const text = row.textContent.toLowerCase();
      row.hidden = !words.every(word => text.includes(word)) || !picks.every(pick => kept(row, pick));
      left += !row.hidden;
    }
    count.textContent = `${left === rows.length ? "" : `${left} of `}${rows.length} row${rows.length === 1 ? "" : "s"}`;
  };
  for (const control of [box.querySelector("input"), ...picks]) control.addEventListener("input", filter);
  filter();
}
// Figures: a click, or Enter, shows one as large as the window.
const dialog = document.querySelector("dialog");
for (const button of document.querySelectorAll(".enlarge")) {
  button.addEventListener("click", () => {
    dialog.querySelector("div").replaceChildren(button.firstElementChild.cloneNode(true));
    dialog.showModal();
  });
}
dialog.addEventListener("click", event => {
  if (event.target === dialog || event.target.className === "close") dialog.close();
});
