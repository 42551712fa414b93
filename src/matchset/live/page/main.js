// The page: joins the connection and the panels. Folders: picture (what is seen, drawn over, clicked), reading (numbers
// and targets), curves, source (menu, camera, settings), file (player, time line), flight, record, sharing.

import { CameraPanel } from "./source/camera.js";
import { CompilingPanel } from "./compiling.js";
import { Curves } from "./curves/curves.js";
import { FilePanel } from "./file/files.js";
import { FlightPanel } from "./flight/flight.js";
import { wireLayers } from "./picture/layers.js";
import { Menu } from "./source/menu.js";
import { PictureView } from "./picture/picture.js";
import { element, Reading } from "./reading/reading.js";
import { RecordPanel } from "./record/record.js";
import { SettingsPanel } from "./source/settings.js";
import { SharingPanel } from "./sharing/sharing.js";
import { Connection } from "./socket.js";
import { TargetList } from "./reading/targets.js";
import { parseDegrees, times } from "./units.js";

const OLD = 500; // ms without a new picture, after which a veil says so
const find = (id) => document.getElementById(id);

const shape = () => find("shape").value;
const connection = new Connection(receive, receiveSession, (words) => {
  find("link").textContent = words;
  find("link").dataset.state = words ? "bad" : "";
});
const send = (message) => connection.send(message);
const picture = new PictureView(find("view"), {
  onPick: (pick) => send({ type: "pick", ...pick, shape: shape() }),
  onOutline: (outline) => send({ type: "outline", ...outline, shape: shape() }),
  onHold: (hold) => send({ type: "hold", ...hold }),
  onSelect: (id) => targets.choose(id),
});
const targets = new TargetList(find("targets"), send, askPoint);
const reading = new Reading(find("reading"));
const curves = new Curves(find("curves"), (id) => targets.choose(id));
let painted = 0;
let newest = null;
let seconds = 0; // time of the picture on the screen
let feed = null;
let drawn = null;

const flight = new FlightPanel(find("flight"), send);

// Panels of the page by their names: each has `update(state)`, and is hidden while the server has none of its name.
const panels = {
  flight,
  sharing: new SharingPanel(find("sharing")),
  compiling: new CompilingPanel(find("compiling")),
  sources: new Menu(send),
  camera: new CameraPanel(find("camera-panel"), send, () => targets.chosen),
  settings: new SettingsPanel(find("settings"), send),
  record: new RecordPanel(find("record"), send),
  file: new FilePanel(find("file"), find("file-results"), find("file-curves"), send, () => targets.chosen, askPoint, (id) => targets.choose(id)),
};

function receiveSession(session) {
  find("source").textContent = session.title || "";
  picture.clicks.answered(session.panels?.targets?.answered);
  const said = picture.clicks.refused?.words; // stands on the picture
  const notes = (session.notes || []).filter((words) => !said || !words.startsWith(said));
  find("notes").replaceChildren(...notes.map((words) => element("p", "", words)));
  for (const [name, panel] of Object.entries(panels)) {
    const there = name in (session.panels || {});
    panel.root.hidden = !there;
    if (there) panel.update(session.panels[name] || {}, session);
  }
  document.body.dataset.kind = session.kind || "";
  find("of-rate").textContent = session.kind === "file" ? "video" : "camera";
  document.body.classList.toggle("of-flight", flight.shown);
}

async function receive(packet) {
  if (packet.feed !== feed) startAgain(packet.feed);
  if (flight.shown) return flight.receive(packet);
  if (!await picture.paint(packet)) { send({ type: "ack", sequence: packet.sequence, stream: packet.stream }); return; }
  painted = performance.now();
  newest = packet;
  requestAnimationFrame(() => send({ type: "ack", sequence: packet.sequence, stream: packet.stream }));
  const { state } = packet;
  targets.update(state.targets || []);
  picture.chosen = targets.chosen;
  if (state.live === false && state.time < seconds) curves.clear(); // a video that went back
  seconds = state.time;
  if (packet.jpeg) curves.note(state.targets || [], state.time);
  panels.file.painted(state);
  if (!drawn) drawn = requestAnimationFrame(refresh);
}

// Something else is shown from here on.
function startAgain(next) {
  feed = next;
  flight.restart();
  curves.clear();
}

function refresh() {
  drawn = null;
  const { state, shownAge } = newest;
  const list = state.targets || [];
  reading.show(list.find((target) => target.id === targets.chosen), list);
  picture.clicks.follows(list.length > 0);
  find("age").textContent = state.live === false || shownAge < 0 ? "–" : `${(1000 * shownAge).toFixed(0)} ms`;
  find("camera-fps").textContent = state.camera_fps ? `${state.camera_fps.toFixed(0)}/s` : "–";
  find("fps").textContent = state.fps ? `${state.fps.toFixed(0)}/s` : "–";
  targets.showCrowd(find("crowd"), state.crowd);
  const words = times(state.computing);
  find("computing").hidden = !words;
  find("computing").textContent = `computing a picture: ${words}`;
  find("dropped").textContent = `${state.dropped || 0}`;
  curves.draw(targets.chosen);
}

setInterval(() => {
  const veil = find("veil");
  const fault = newest && newest.state.fault;
  const age = performance.now() - painted;
  const gone = find("link").dataset.state === "bad" && painted;
  const words = gone ? "no connection: this picture is old" : fault || (painted && newest.state.live !== false && age > OLD ? `no new picture for ${(age / 1000).toFixed(1)} s` : "");
  veil.hidden = !words;
  veil.textContent = words;
}, 100);

// The next click in the picture is a point for somebody, and no ball.
function askPoint(words, take) {
  picture.take = (point) => { picture.take = null; picture.clicks.ask(""); take(point); };
  picture.clicks.ask(words);
  find("view").focus();
}

wireLayers(find("switches"), picture);
picture.onZoom = (scale) => {
  find("whole").hidden = find("drag").hidden = scale === 1;
  picture.gestures.moves = scale > 1 && find("drag-moves").checked;
};
find("drag-moves").addEventListener("change", () => picture.onZoom(picture.zoom.scale));
find("whole").addEventListener("click", () => picture.zoom.whole());
find("fullscreen").hidden = !document.fullscreenEnabled;
find("fullscreen").addEventListener("click", () => {
  if (document.fullscreenElement) document.exitFullscreen(); else find("stage").requestFullscreen();
});
find("view-form").addEventListener("submit", (event) => {
  event.preventDefault();
  find("fov-error").textContent = "";
  try {
    const [angle, sigma] = parseDegrees(find("fov").value).map((degrees) => degrees * Math.PI / 180);
    send({ type: "field_of_view", angle, sigma });
  } catch (wrong) {
    find("fov-error").textContent = wrong.message;
  }
});

// On this computer nobody else can listen; elsewhere a person should know that others can.
find("plain").hidden = location.protocol !== "http:" || /^(127\.0\.0\.1|localhost|\[::1\])$/.test(location.hostname);
