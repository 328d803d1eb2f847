"use strict";
// The question: of the sizes that were run, the nearest; its methods, how sure they are, and the way to their rows.
const fields = JSON.parse(document.querySelector("#fields").textContent);
const form = document.querySelector("#ask"), answer = document.querySelector("#answer");
const first = { mechanics: "rough-discs", start: "r = 0", accuracy: "10⁻⁴" };
for (const pick of form.querySelectorAll("select")) {
  const values = [...new Set(fields.map(field => field[pick.name]))];
  values.sort((a, b) => pick.name === "accuracy" ? 0 : a.localeCompare(b, "en", { numeric: true }));
  if (!(pick.name in first)) pick.add(new Option("any", ""));
  for (const value of values) pick.add(new Option(value));
  if (values.includes(first[pick.name])) pick.value = first[pick.name];
}
const put = (parent, tag, text, attributes = {}) => {
  const node = parent.appendChild(document.createElement(tag));
  node.textContent = text;
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
};
const answered = () => {
  answer.replaceChildren();
  const asked = Object.fromEntries(new FormData(form)), grains = Number(asked.grains);
  const fits = field => ["mechanics", "friction", "state", "start", "accuracy"].every(key => !asked[key] || field[key] === asked[key]);
  const found = fields.filter(fits);
  if (!found.length || !(grains > 0)) return put(answer, "p", "No such problem was run.");
  const far = field => Math.abs(Math.log(field.grains / grains));
  const nearest = found.reduce((a, b) => far(b) < far(a) ? b : a).grains, rows = found.filter(field => field.grains === nearest);
  const solved = rows.filter(field => field.standings.length), best = new Map();
  for (const field of solved) for (const [label, , , , ties] of field.standings) if (ties) best.set(label, (best.get(label) ?? 0) + 1);
  const [label, kinds] = [...best].reduce((a, b) => b[1] > a[1] ? b : a, ["none", 0]);
  put(answer, "p", nearest === grains ? `Problems of ${grains} grains were run.`
    : `No such problem of ${grains} grains was run; the nearest size is ${nearest} grains.`, { class: "answer" });
  put(answer, "p", kinds ? `${label} is first, or not told from the first, in ${kinds} of ${rows.length} kinds of such problems.`
    : "No method reaches the accuracy.", { class: "answer" });
  const packings = rows.map(field => field.packings), [least, most] = [Math.min(...packings), Math.max(...packings)];
  put(answer, "p", `How sure: ${least === most ? least : `${least} to ${most}`} packings of each kind, which differ in their seeds; methods whose times cannot be told apart share a line.`
    + (most < 2 ? " One packing is an example, not a sample." : "") + (nearest === grains ? "" : " Another size may have another answer."));
  const table = put(put(answer, "div", "", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Methods" }), "table", "");
  const head = table.createTHead().insertRow();
  for (const text of ["problems, with their rows", "first", "seconds (interval)", "reached, of packings", "not told from it, × the fastest"]) put(head, "th", text, { scope: "col" });
  const body = table.createTBody();
  for (const field of rows) {
    const row = body.insertRow(), [winner, ...others] = field.standings;
    const ties = others.filter(other => other[4]).map(([name, , , ratio]) => `${name} ×${ratio}`).join("; ");
    const [median, low, high] = winner?.[2] ?? [];
    const cells = winner ? [winner[0], winner[1] > 1 ? `${median} (${low} to ${high})` : `${median} (one packing)`, `${winner[1]} of ${field.packings}`, ties || "none"]
      : ["none", "–", `0 of ${field.packings}`, "–"];
    const { mechanics, friction, state, start } = field;
    const query = new URLSearchParams({ study: field.study, mechanics, grains: field.grains, "μ": friction, state, start, reached: `natural map ≤ ${field.accuracy} (s)` });
    put(put(row, "td", ""), "a", `${state}, μ = ${friction}`, { href: `runs.html#${query}` });
    for (const text of cells) put(row, "td", text, text.length > 28 ? { class: "long" } : {});
  }
};
form.addEventListener("input", answered);
form.addEventListener("submit", event => event.preventDefault());
answered();
