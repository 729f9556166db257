// Leaves those cards that fit the filter: a family, words that all occur, scenes in which another engine is better.
"use strict";
(() => {
  const form = document.querySelector("#scenes .filters");
  if (!form) return;
  const family = document.getElementById("gallery-family"), words = document.getElementById("gallery-words");
  const behind = document.getElementById("gallery-behind"), told = document.getElementById("gallery-count");
  const cards = [...document.querySelectorAll(".scene-card")];
  function filter() {
    const wanted = words.value.toLowerCase().split(/\s+/).filter(Boolean);
    let left = 0;
    for (const card of cards) {
      const fits = (!family.value || card.dataset.family === family.value)
        && wanted.every((word) => card.dataset.words.includes(word)) && (!behind.checked || "behind" in card.dataset);
      card.hidden = !fits;
      left += fits;
    }
    told.textContent = left === cards.length ? `${left} scenes` : `${left} of ${cards.length} scenes`;
  }
  // a link to a scene that the filter has taken away brings all scenes back
  function reach() {
    const card = cards.find((one) => `#${one.id}` === decodeURIComponent(location.hash));
    if (card && card.hidden) { form.reset(); filter(); card.scrollIntoView(); }
  }
  form.hidden = false;
  form.addEventListener("submit", (event) => event.preventDefault());
  for (const control of [family, words, behind]) control.addEventListener("input", filter);
  window.addEventListener("hashchange", reach);
  filter();
})();
