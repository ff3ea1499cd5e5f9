"use strict";
// Shows the pictures of what is pointed at, and else of what was chosen last.
const byRow = (selector) => new Map([...document.querySelectorAll(selector)].map((e) => [Number(e.dataset.row), e]));
const lines = byRow("tbody tr");
const links = byRow("tbody a");
const marks = byRow(".mark");
// Marks are gone through from the fastest to the slowest, lines from the first to the last.
const place = (row) => marks.get(row).querySelector("circle").cx.baseVal.value;
const orders = [[links, [...links.keys()]], [marks, [...marks.keys()].sort((a, b) => place(a) - place(b))]];
let chosen = 0;

function show(row) {
  for (const i of lines.keys()) {
    for (const element of [document.getElementById(`s${i}`), lines.get(i), marks.get(i)]) {
      element?.classList.toggle("shown", i === row);
    }
  }
}

function choose(row) {
  chosen = row;
  // The plot takes one stop of the tab key.
  const stop = marks.has(row) ? row : orders[1][1][0];
  for (const [i, mark] of marks) mark.setAttribute("tabindex", i === stop ? "0" : "-1");
  show(row);
}

function go(event) {
  const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
  const [elements, order] = orders.find(([elements]) => [...elements.values()].includes(event.currentTarget));
  const to = order[order.indexOf(Number(event.currentTarget.dataset.row)) + step];
  if (step === undefined || event.altKey || event.ctrlKey || event.metaKey) return;
  event.preventDefault();
  elements.get(to)?.focus();
}

document.body.classList.add("script");
for (const element of [...marks.values(), ...lines.values()]) {
  const row = Number(element.dataset.row);
  element.addEventListener("pointerenter", () => show(row));
  element.addEventListener("pointerleave", () => show(chosen));
  element.addEventListener("click", (event) => {
    event.preventDefault();
    choose(row);
    history.replaceState(null, "", `#s${row}`);
  });
}
for (const element of [...marks.values(), ...links.values()]) {
  element.addEventListener("focus", () => choose(Number(element.dataset.row)));
  element.addEventListener("keydown", go);
}
const wanted = /^#s(\d+)$/.exec(location.hash);
choose(wanted && lines.has(Number(wanted[1])) ? Number(wanted[1]) : 0);
