// What a person brings to the menu: the address of a stream, or a video of the device on which the page is seen.

import { element } from "../reading/reading.js";

const MB = 1e6; // bytes
const STREAM = /^(https?|rtsps?|rtmp|rtp|srt|tcp|udp):\/\/\S+$/i;

export class Brought {
  // `asked()` is told that something will be shown, if it can be.
  constructor(send, asked) {
    Object.assign(this, { send, asked, room: 0 });
    this.root = element("div", "brought");
    this.root.append(this.makeAddress(), this.makeUpload());
  }

  // Bytes that may still be sent.
  allow(room) {
    this.room = room;
    const words = `It is kept on the computer that runs matchset until that ends, and then removed. There is room for ${(room / MB).toFixed(0)} MB.`;
    if (this.where.textContent !== words) this.where.textContent = words;
  }

  makeAddress() {
    const form = element("form", "address");
    const label = element("label", "", "address of a camera in the network ");
    const input = element("input", "");
    Object.assign(input, { id: "address", inputMode: "url", autocomplete: "off", spellcheck: false, placeholder: "rtsp://camera/live" });
    const error = element("output", "");
    label.append(input);
    form.append(label, element("button", "", "open"), error);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const url = input.value.trim();
      const valid = STREAM.test(url);
      error.textContent = valid ? "" : "type an address such as rtsp://camera/live or http://camera:8080/video";
      input.toggleAttribute("aria-invalid", false);
      if (!valid) { input.setAttribute("aria-invalid", "true"); return; }
      this.asked();
      if (!this.send({ type: "show_address", url })) error.textContent = "no connection";
    });
    return form;
  }

  makeUpload() {
    const form = element("form", "upload");
    const label = element("label", "", "a video of this device ");
    this.input = element("input", "");
    Object.assign(this.input, { id: "upload", type: "file", accept: "video/*,.mkv,.bag,.mjpg,.ts" });
    label.append(this.input);
    this.progress = element("progress", "");
    this.progress.max = 1;
    this.progress.setAttribute("aria-label", "sent so far");
    this.stop = element("button", "", "stop");
    this.stop.type = "button";
    this.stop.addEventListener("click", () => this.request?.abort());
    this.said = element("output", "");
    this.where = element("p", "soft");
    form.append(label, this.progress, this.stop, this.said, this.where);
    this.input.addEventListener("change", () => this.upload());
    this.show(false);
    return form;
  }

  // fetch() does not tell how much was sent.
  upload() {
    const [file] = this.input.files;
    if (!file) return;
    this.said.textContent = "";
    if (file.size > this.room) {
      this.said.textContent = `${file.name} has ${(file.size / MB).toFixed(0)} MB, and there is room for ${(this.room / MB).toFixed(0)} MB`;
      return;
    }
    const request = this.request = new XMLHttpRequest();
    const over = (words) => { this.show(false); this.said.textContent = words; this.input.value = ""; };
    request.upload.addEventListener("progress", (event) => { this.progress.value = event.loaded / event.total; });
    request.addEventListener("load", () => {
      if (request.status === 204) { this.asked(); over(""); return; }
      try { over(JSON.parse(request.responseText).error); } catch { over(`it was not taken: ${request.status}`); }
    });
    request.addEventListener("error", () => over("no connection, or it was not taken"));
    request.addEventListener("abort", () => over("stopped: what was sent is removed"));
    request.open("POST", `upload/video?name=${encodeURIComponent(file.name)}`);
    request.send(file);
    this.progress.value = 0;
    this.show(true);
  }

  show(running) {
    this.progress.hidden = this.stop.hidden = !running;
    this.input.disabled = running;
  }
}
