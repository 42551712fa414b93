"""Times of the frames of the page while it draws 30 s at 500 samples/s: `python -m benchmarks.live.curves`.

With `--uplot FILE` (uPlot.iife.min.js, from the package uplot of npm) the same samples are drawn by that library too.
"""

import argparse
import functools
import http.server
import json
import os
import shutil
import statistics
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matchset.live

PAGE = Path(matchset.live.__file__).parent / "page"
SECONDS = 8  # of measurement
BLANK = "<!doctype html><link rel=stylesheet href=style.css><link rel=stylesheet href=curves/curves.css>"
SECTION = """<section id=curves><canvas></canvas><canvas></canvas><canvas></canvas><canvas></canvas><p></p></section>"""

# Calls draw() once a frame and returns, in ms, the times between the frames and those of draw() itself.
MEASURE = """
const RATE = 500;
const value = (time, phase) => 1.5 + 0.4 * Math.sin(time + phase) + 0.004 * Math.sin(7919 * time);
async function measure(add, draw, seconds) {
  let time = 0;
  for (; time < 30; time += 1 / RATE) add(time);
  const begin = performance.now() - 1000 * time;
  const [gaps, costs] = [[], []];
  let last = null;
  await new Promise((done) => requestAnimationFrame(async function frame(now) {
    if (last !== null) gaps.push(now - last);
    last = now;
    const start = performance.now();
    while (1000 * time < start - begin) { add(time); time += 1 / RATE; }
    draw();
    await new Promise((drawn) => queueMicrotask(drawn)); // uPlot draws in a microtask
    costs.push(performance.now() - start);
    if (gaps.length && now > begin + 1000 * (30 + seconds)) done(); else requestAnimationFrame(frame);
  }));
  return { gaps, costs };
}
"""

OURS = """
import { Curves } from "./curves/curves.js";
const curves = new Curves(document.getElementById("curves"));
const add = (time) => {
  const found = time % 10 < 9;
  const [x, y, z] = [0, 2, 4].map((phase) => [value(time, phase), 0.002]);
  curves.note([{ id: 1, found, values: {}, position: found ? { x, y, z, distance: z } : undefined }], time);
};
window.result = measure(add, () => curves.draw(1), SECONDS);
"""

NOTHING = "window.result = measure(() => {}, () => {}, SECONDS);"  # what the machine leaves to any page

UPLOT = """
const section = document.getElementById("curves");
const data = [0, 1, 2].map(() => [[], [], [], []]);
const plots = [0, 2, 4].map((phase, index) => {
  const canvas = section.children[index];
  const div = document.createElement("div");
  const [width, height] = [canvas.clientWidth, canvas.clientHeight - 40];
  canvas.replaceWith(div);
  const series = [{}, { stroke: "#005a8c", width: 1.75 }, { stroke: "#0000" }, { stroke: "#0000" }];
  const bands = [{ series: [2, 3], fill: "#005a8c40" }];
  const without = { legend: { show: false }, cursor: { show: false }, scales: { x: { time: false } } };
  return new uPlot({ width, height, series, bands, ...without }, data[index], div);
});
const add = (time) => data.forEach((columns, index) => {
  const found = time % 10 < 9;
  const here = value(time, 2 * index);
  [time, found ? here : null, found ? here + 0.004 : null, found ? here - 0.004 : null].forEach((each, k) => {
    columns[k].push(each);
    if (columns[k].length > 30 * RATE) columns[k].shift();
  });
});
window.result = measure(add, () => plots.forEach((plot, index) => plot.setData(data[index])), SECONDS);
"""


class _Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002
        """Say nothing."""


@contextmanager
def served() -> Iterator[str]:
    """Serve the files of the page; gives the address."""
    handler = functools.partial(_Quiet, directory=str(PAGE))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


def run(page: Any, address: str, script: str, library: str = "") -> dict[str, list[float]]:
    """Return the times of one way of drawing, ms: `gaps` between frames, `costs` of drawing one."""
    kind = "" if library else " type=module"
    text = f"{BLANK}<body>{SECTION}<script>{library}</script><script{kind}>{MEASURE}{script}</script>"
    page.route("**/measure.html", lambda route: route.fulfill(body=text, content_type="text/html"))
    page.goto(address + "measure.html")
    page.wait_for_function("window.result", timeout=60_000)
    found: dict[str, list[float]] = page.evaluate("window.result")
    page.unroute("**/measure.html")
    return found


def row(name: str, times: dict[str, list[float]]) -> str:
    """Write a row of the table."""
    gaps, costs = sorted(times["gaps"]), sorted(times["costs"])
    shares = [1000.0 * len(gaps) / sum(gaps), statistics.median(gaps), gaps[int(0.99 * len(gaps))]]
    numbers = [*shares, statistics.median(costs), costs[int(0.99 * len(costs))]]
    return f"| {name} | " + " | ".join(f"{number:.1f}" for number in numbers) + " |"


def main() -> None:
    """Measure and print."""
    from playwright.sync_api import sync_playwright

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--uplot", type=Path, help="uPlot.iife.min.js")
    options = parser.parse_args()
    print(f"3 curves and the view from above, 30 s at 500 samples/s; load {os.getloadavg()[0]:.1f}\n")
    print("| drawn by | frames/s | between frames, median, ms | 99 % | drawing, median, ms | 99 % |")
    print("| --- | --- | --- | --- | --- | --- |")
    with served() as address, sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = chromium.new_page(viewport={"width": 1280, "height": 900})
        page.on("pageerror", lambda error: print("error:", error))
        seconds = json.dumps(SECONDS)
        print(row("matchset", run(page, address, OURS.replace("SECONDS", seconds))), flush=True)
        print(row("nothing", run(page, address, NOTHING.replace("SECONDS", seconds))), flush=True)
        if options.uplot is not None:
            library = options.uplot.read_text()
            print(row("uPlot", run(page, address, UPLOT.replace("SECONDS", seconds), library)), flush=True)
        chromium.close()


if __name__ == "__main__":
    main()
