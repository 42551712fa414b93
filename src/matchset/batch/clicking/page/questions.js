// One thumbnail for each doubtful video; a click on the ball answers it.
const LOOK = 1000; // ms between two looks for new questions
const shown = new Map(); // figure by number

async function look() {
  const questions = await (await fetch("questions.json")).json();
  for (const question of questions) show(question);
  const open = questions.filter((each) => !each.answer).length;
  document.getElementById("words").textContent = open
    ? `Click the ball once in each of ${open} picture${open > 1 ? "s" : ""}; the batch goes on by itself.`
    : "Nothing is doubtful now. The page may be closed when the batch has ended.";
}

function show(question) {
  if (!shown.has(question.number)) shown.set(question.number, made(question));
  shown.get(question.number).classList.toggle("answered", Boolean(question.answer));
}

function made(question) {
  const figure = document.getElementById("question").content.cloneNode(true).querySelector("figure");
  figure.querySelector(".name").textContent = question.video;
  figure.querySelector(".reason").textContent = question.reason;
  const picture = figure.querySelector("img");
  picture.src = `frame/${question.number}.png`;
  figure.querySelector(".picture").addEventListener("click", (event) => {
    const box = picture.getBoundingClientRect();
    const scale = picture.naturalWidth / box.width;
    const x = (event.clientX - box.left) * scale - 0.5;
    const y = (event.clientY - box.top) * scale - 0.5;
    place(figure.querySelector(".mark"), x / picture.naturalWidth, y / picture.naturalHeight);
    send(`click/${question.number}?x=${Math.max(x, 0).toFixed(1)}&y=${Math.max(y, 0).toFixed(1)}`);
  });
  const marked = figure.querySelector(".marked");
  if (question.guess) {
    const [x, y] = question.guess;
    picture.addEventListener("load", () =>
      place(figure.querySelector(".guess"), x / picture.naturalWidth, y / picture.naturalHeight));
    marked.addEventListener("click", () => send(`click/${question.number}?x=${x}&y=${y}`));
  } else {
    marked.remove();
  }
  figure.querySelector(".skip").addEventListener("click", () => send(`skip/${question.number}`));
  document.getElementById("questions").append(figure);
  return figure;
}

function place(mark, x, y) {
  mark.style.left = `${100 * x}%`;
  mark.style.top = `${100 * y}%`;
  mark.hidden = false;
}

async function send(path) {
  const answer = await fetch(path, { method: "POST" });
  if (!answer.ok) document.getElementById("words").textContent = await answer.text();
  await look();
}

function stopped() {
  document.getElementById("words").textContent = "The batch has ended, or does not answer.";
}

setInterval(() => look().catch(stopped), LOOK);
look().catch(stopped);
