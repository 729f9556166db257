// The page of a clip: the player, and a time line of all frames that shows where it is and leads it.
const clip = JSON.parse(document.getElementById("clip").textContent);
const line = document.getElementById("line"), now = document.getElementById("now");
document.addEventListener("shown-time", (event) => now.setAttribute("x", clip.frames[event.detail.state]));
line.addEventListener("click", (event) => {
  const box = line.getBoundingClientRect(), wanted = Math.floor((event.clientX - box.left) / box.width * (clip.frames.at(-1) + 1));
  const state = clip.frames.findIndex((frame) => frame >= wanted);
  document.dispatchEvent(new CustomEvent("seek-time", { detail: clip.times[state] }));
});
startPlayer(document.getElementById("replay"), clip);
