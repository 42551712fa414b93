// The page: joins connection, picture, reading, targets and curves.

import { CameraPanel } from "./camera.js";
import { CompilingPanel } from "./compiling.js";
import { Curve, ViewFromAbove } from "./curves.js";
import { FilePanel } from "./files.js";
import { FlightPanel } from "./flight.js";
import { Menu } from "./menu.js";
import { PictureView } from "./picture.js";
import { element, showReading } from "./reading.js";
import { RecordPanel } from "./record.js";
import { Connection } from "./socket.js";
import { TargetList } from "./targets.js";

const OLD = 500; // ms without a new picture, after which a veil says so
const find = (id) => document.getElementById(id);

const shape = () => find("shape").value;
const connection = new Connection(receive, receiveSession, (words) => {
  find("link").textContent = words;
  find("link").dataset.state = words ? "bad" : "";
});
const send = (message) => connection.send(message);
const picture = new PictureView(find("view"), (pick) => send({ type: "pick", ...pick, shape: shape() }),
  (outline) => send({ type: "outline", ...outline, shape: shape() }));
const targets = new TargetList(find("targets"), send);
const curves = [0, 1, 2].map((number) => new Curve(find(`curve-${number}`)));
const above = new ViewFromAbove(find("above"));
let painted = 0;
let newest = null;
let feed = null;
let drawn = null;

const flight = new FlightPanel(find("flight"), send);

// Panels of the page by their names: each has `update(state)`, and is hidden while the server has none of its name.
const panels = {
  flight,
  compiling: new CompilingPanel(find("compiling")),
  sources: new Menu(send),
  camera: new CameraPanel(find("camera-panel"), send, () => targets.chosen),
  record: new RecordPanel(find("record"), send),
  file: new FilePanel(find("file"), send, () => targets.chosen, () => {}),
};

function receiveSession(session) {
  find("source").textContent = session.title || "";
  find("notes").replaceChildren(...(session.notes || []).map((words) => element("p", "", words)));
  for (const [name, panel] of Object.entries(panels)) {
    const there = name in (session.panels || {});
    panel.root.hidden = !there;
    if (there) panel.update(session.panels[name] || {}, session);
  }
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
  const chosen = targets.update(state.targets || []);
  note(chosen, state.time);
  panels.file.painted(state);
  if (!drawn) drawn = requestAnimationFrame(refresh);
}

// Something else is shown from here on.
function startAgain(next) {
  feed = next;
  flight.restart();
  for (const curve of curves) curve.name = "";
  above.clear();
}

function note(chosen, time) {
  if (!chosen) return;
  const placed = chosen.position && chosen.position.distance;
  const values = placed ? chosen.position : chosen.values || {};
  const names = placed ? ["x", "y", "z"] : chosen.found ? Object.keys(values).slice(0, 3) : curves.map((curve) => curve.name);
  curves.forEach((curve, index) => {
    const name = names[index];
    if (!name) return;
    const [value, sigma] = values[name] || [NaN, 0];
    curve.add(name, placed || (!chosen.found && curve.unit === "m") ? "m" : "px", time, value, sigma);
  });
  if (placed) above.add(time, chosen.position.x[0], chosen.position.z[0]);
}

function refresh() {
  drawn = null;
  const { state, shownAge } = newest;
  showReading(find("reading"), (state.targets || []).find((target) => target.id === targets.chosen));
  find("hint").hidden = Boolean((state.targets || []).length);
  find("age").textContent = !state.live || shownAge < 0 ? "–" : `${(1000 * shownAge).toFixed(0)} ms`;
  find("camera-fps").textContent = state.camera_fps ? `${state.camera_fps.toFixed(0)}/s` : "–";
  find("fps").textContent = state.fps ? `${state.fps.toFixed(0)}/s` : "–";
  find("dropped").textContent = `${state.dropped || 0}`;
  for (const curve of curves) curve.draw();
  above.draw();
}

setInterval(() => {
  const veil = find("veil");
  const fault = newest && newest.state.fault;
  const age = performance.now() - painted;
  const words = fault || (painted && newest.state.live !== false && age > OLD ? `no new picture for ${(age / 1000).toFixed(1)} s` : "");
  veil.hidden = !words;
  veil.textContent = words;
}, 100);

for (const [id, name] of [["show-outline", "outline"], ["show-match-set", "matchSet"], ["show-trail", "trail"]]) {
  find(id).addEventListener("change", (event) => { picture.show[name] = event.target.checked; });
}
find("whole").addEventListener("click", () => picture.whole());
find("view-form").addEventListener("submit", (event) => {
  event.preventDefault();
  const degrees = parseFloat(find("fov").value.replace(",", "."));
  const valid = degrees > 5 && degrees < 175;
  find("fov-error").textContent = valid ? "" : "type an angle between 5 and 175 degrees, such as 60";
  if (valid) send({ type: "field_of_view", angle: degrees * Math.PI / 180 });
});
