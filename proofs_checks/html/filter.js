"use strict";
const articles = [...document.querySelectorAll("article[data-verdict]")];
const buttons = [...document.querySelectorAll(".filters button")];
const search = document.querySelector(".filters input");

function show() {
  const wanted = buttons.filter(b => b.getAttribute("aria-pressed") === "true").map(b => b.dataset.verdict);
  const text = search.value.trim().toLowerCase();
  for (const article of articles) {
    const fits = !wanted.length || wanted.includes(article.dataset.verdict);
    article.hidden = !fits || !article.dataset.words.includes(text);
  }
  for (const section of document.querySelectorAll("main > section:not(.theory)")) {
    section.hidden = !section.querySelector("article:not([hidden])");
  }
}

for (const button of buttons) {
  button.addEventListener("click", () => {
    button.setAttribute("aria-pressed", button.getAttribute("aria-pressed") !== "true");
    show();
  });
}
search.addEventListener("input", show);
window.addEventListener("beforeprint", () => {
  for (const fold of document.querySelectorAll("details")) fold.open = true;
});
