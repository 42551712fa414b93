// The camera: what is known of it, a camera file, a calibration with a board, a ball at a known distance.

import { element } from "../reading/reading.js";
import { parseLength } from "../units.js";

const LARGEST = 65536; // bytes of a file that the server takes

export class CameraPanel {
  constructor(root, send, chosenTarget) {
    this.send = send;
    this.chosenTarget = chosenTarget;
    this.root = root;
    this.words = element("p", "known");
    const form = document.getElementById("view-form");
    (form || root).before(this.words);
    root.append(this.makeFiles(), this.makeBoard(), this.makeBall());
  }

  update(state) {
    this.words.textContent = state.words || "Not known yet: positions in meters need it.";
    const angle = document.getElementById("fov");
    const spread = state.fov_sigma ? ` ± ${Number(state.fov_sigma.toPrecision(2))}` : "";
    if (angle && state.fov && document.activeElement !== angle) angle.value = state.fov.toFixed(1) + spread;
    this.updateSheets(state.sheets || []);
    this.updateFiles(state.files || []);
    this.updateBoard(state.board);
    this.ballWords.textContent = state.ball || "";
  }

  // Camera files
  makeFiles() {
    const part = folded("camera file");
    this.files = element("div", "files");
    const label = element("label", "upload", "a file of this device: ");
    const input = element("input", "");
    input.type = "file";
    input.accept = ".toml,.yaml,.yml";
    label.append(input);
    this.uploaded = element("output", "");
    input.addEventListener("change", () => this.upload(input));
    part.append(this.files, label, this.uploaded);
    part.addEventListener("toggle", () => { if (part.open) this.send({ type: "look_for_camera_files" }); });
    return part;
  }

  updateFiles(files) {
    const written = JSON.stringify(files);
    if (written === this.written) return;
    this.written = written;
    this.files.replaceChildren(...files.map((file) => {
      const button = element("button", "entry");
      button.type = "button";
      button.append(element("span", "name", file.name), element("span", "soft", file.words));
      button.addEventListener("click", () => this.send({ type: "use_camera", key: file.key }));
      return button;
    }));
    if (!files.length) this.files.append(element("p", "soft", "no camera*.toml or .yaml in this folder"));
  }

  async upload(input) {
    const [file] = input.files;
    if (!file) return;
    this.uploaded.textContent = "";
    if (file.size > LARGEST) this.uploaded.textContent = `${file.name} has ${file.size} bytes: that is no camera file`;
    else {
      const address = `upload/camera?name=${encodeURIComponent(file.name)}`;
      const answer = await fetch(address, { method: "POST", body: file }).catch(() => null);
      if (!answer) this.uploaded.textContent = "no connection";
      else if (!answer.ok) this.uploaded.textContent = (await answer.json()).error;
    }
    input.value = "";
  }

  // A board
  makeBoard() {
    const part = folded("calibrate now, with a board");
    part.id = "board";
    this.boardForm = element("form", "");
    const [columns, rows] = [field("9", 3, "inner corners across"), field("6", 3, "inner corners down")];
    const square = field("25 mm", 8, "side of a square");
    const corners = element("label", "", "inner corners ");
    corners.append(columns, " × ", rows);
    const side = element("label", "", "square ");
    side.append(square);
    const start = element("button", "", "start");
    const error = element("output", "");
    this.boardForm.append(corners, side, start, error);
    this.sheets = element("p", "soft", "10 × 7 squares have 9 × 6 inner corners. To print, at 100 %: ");
    this.boardForm.append(this.sheets);
    this.boardFields = { columns, rows, square };
    this.boardForm.addEventListener("submit", (event) => {
      event.preventDefault();
      error.textContent = "";
      try {
        const sides = [columns, rows].map((input) => wholeNumber(input.value));
        this.send({ type: "calibrate_board", columns: sides[0], rows: sides[1], square: parseLength(square.value) });
      } catch (wrong) {
        error.textContent = wrong.message;
      }
    });
    this.boardState = element("div", "board-state");
    this.makeBoardState();
    part.append(this.boardForm, this.boardState);
    return part;
  }

  // A click on a sheet loads it, and fills in what it shows.
  updateSheets(sheets) {
    if (this.sheets.childElementCount === sheets.length) return;
    for (const sheet of sheets) {
      const link = element("a", "", `${sheet.paper === "a4" ? "A4" : "Letter"}, squares of ${1000 * sheet.square} mm`);
      link.href = `download/${sheet.name}`;
      link.setAttribute("download", sheet.name);
      link.addEventListener("click", () => {
        const { columns, rows, square } = this.boardFields;
        [columns.value, rows.value, square.value] = [sheet.columns, sheet.rows, `${1000 * sheet.square} mm`];
      });
      this.sheets.append(link, " ");
    }
  }

  makeBoardState() {
    this.boardWords = element("p", "next");
    this.boardWords.setAttribute("role", "status");
    this.share = element("progress", "");
    this.share.max = 1;
    this.share.setAttribute("aria-label", "share of the picture in which the board was seen");
    this.count = element("p", "soft count");
    this.coverage = element("img", "");
    this.coverage.alt = "where the board was seen";
    this.verdict = element("dl", "verdict");
    this.file = element("a", "", "camera.toml");
    this.file.setAttribute("download", "camera.toml");
    const buttons = element("p", "buttons");
    this.enough = element("button", "", "that is all");
    this.cancel = element("button", "", "cancel");
    for (const button of [this.enough, this.cancel]) button.type = "button";
    this.enough.addEventListener("click", () => this.send({ type: "end_board", use: true }));
    this.cancel.addEventListener("click", () => this.send({ type: "end_board", use: false }));
    buttons.append(this.enough, this.cancel, this.file);
    this.boardState.append(this.boardWords, this.share, this.count, this.coverage, this.verdict, buttons);
  }

  updateBoard(board) {
    const part = this.boardState.parentElement;
    this.boardState.hidden = !board;
    const runs = Boolean(board) && (board.phase === "looking" || board.phase === "computing");
    this.boardForm.hidden = runs;
    if (!board) return;
    if (runs && !this.ran) part.open = true;
    this.ran = runs;
    this.boardState.dataset.phase = board.phase;
    this.boardState.dataset.grade = board.grade || "";
    if (this.boardWords.textContent !== board.words) this.boardWords.textContent = board.words;
    this.share.value = board.share || 0;
    this.count.textContent = `${board.views || 0} different views, ${Math.round(100 * (board.share || 0))} % of the picture`;
    this.share.hidden = this.count.hidden = !runs;
    this.enough.hidden = board.phase !== "looking";
    this.cancel.textContent = runs ? "cancel" : "close";
    this.coverage.hidden = !board.picture;
    const address = board.picture ? `download/${board.picture}` : "";
    if (address && this.coverage.getAttribute("src") !== address) this.coverage.src = address;
    this.file.hidden = !board.file;
    if (board.file) this.file.href = `download/${board.file}`;
    this.verdict.replaceChildren(...(board.lines || []).map((line) => {
      const row = element("div", "");
      row.dataset.grade = line.grade;
      row.append(element("dt", "", `${line.name}: ${line.grade}`), element("dd", "", line.words));
      return row;
    }));
  }

  // A ball at a known distance
  makeBall() {
    const part = folded("the ball is at a known distance");
    const form = element("form", "");
    const input = field("1.5 m", 8, "distance from the lens to the nearest point of the ball");
    const label = element("label", "", "from the lens to its nearest point ");
    label.append(input);
    const error = element("output", "");
    this.ballWords = element("p", "next");
    this.ballWords.setAttribute("role", "status");
    form.append(label, element("button", "", "correct"), error);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      error.textContent = "";
      try {
        const meters = parseLength(input.value);
        const target = this.chosenTarget();
        if (target === null) throw new Error("click the ball first, and type its diameter");
        this.send({ type: "ball_at", target, meters });
      } catch (wrong) {
        error.textContent = wrong.message;
      }
    });
    part.append(form, this.ballWords, element("p", "soft", "The focal length is corrected so that the ball of the diameter typed is there."));
    return part;
  }
}

function folded(title) {
  const part = element("details", "");
  part.append(element("summary", "", title));
  return part;
}

function field(value, size, name) {
  const input = element("input", "");
  input.value = value;
  input.size = size;
  input.autocomplete = "off";
  input.setAttribute("aria-label", name);
  return input;
}

function wholeNumber(text) {
  if (!/^\s*\d{1,3}\s*$/.test(text)) throw new Error(`"${text}" is no number of corners`);
  const number = parseInt(text, 10);
  if (number < 3 || number > 100) throw new Error(`a board has 3 to 100 inner corners along a side, not ${number}`);
  return number;
}
