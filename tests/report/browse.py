#!/usr/bin/env python3
"""Uses a report of `fogbow paper` in headless Chromium, through chromedriver.

Usage: browse.py REPORT.html [FOLDER]       (screenshots go to FOLDER)"""

import pathlib
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from browser import Browser  # noqa: E402: is beside this folder


# The viewer of the item called by the first argument, and a number that stands for what a canvas shows.
TOOLS = """
const figure = document.querySelector(`#${arguments[0]} .gallery`), viewer = figure.viewer;
const sum = (canvas) => {
  const bytes = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  return bytes.reduce((sum, byte, i) => (31 * sum + byte * (1 + i % 7)) % 1000003, 7);
};
const click = (text) => [...figure.querySelectorAll("button")].find((button) => button.textContent === text).click();
const move = (x, y) => {
  const box = viewer.canvas.getBoundingClientRect();
  const at = { clientX: box.left + x * box.width, clientY: box.top + y * box.height, bubbles: true };
  viewer.view.dispatchEvent(new PointerEvent("pointermove", at));
};
"""


def check(holds, claim):
    if not holds:
        sys.exit(f"FAILED: {claim}")
    print(f"  {claim}")


def use(browser, item):
    """Everything that the viewer of `item` can do."""
    tool = lambda script: browser.run(TOOLS + script, item)  # noqa: E731
    flips = tool("click('flip'); const a = sum(viewer.canvas); click('flip'); return [a, sum(viewer.canvas)];")
    check(flips[0] != flips[1], f"{item}: flip shows one picture and then the other")
    back = tool("click('flip'); return sum(viewer.canvas);")
    check(back == flips[0], f"{item}: and back")
    wipes = tool("click('wipe'); return [0, 0.3, 0.999].map((x) => { move(x, 0.5); return sum(viewer.canvas); });")
    check(len(set(wipes)) == 3, f"{item}: wipe follows the pointer")
    error = tool("click('error map'); return [sum(viewer.canvas), viewer.caption.textContent];")
    check(error[0] not in flips and "minus" in error[1], f"{item}: the error map is another picture")
    legend = tool("return [viewer.legend.hidden, viewer.legend.innerText, viewer.unit];")
    check(not legend[0] and "W/(m^2 sr)" in legend[1] and legend[2] > 0, f"{item}: a legend says what its colours are")
    pale = tool("""
      if (viewer.reference === null) return [0, 1];
      const colour = (a) => {
        viewer.choose('a', a);
        const { data } = viewer.canvas.getContext("2d").getImageData(0, 0, viewer.canvas.width, viewer.canvas.height);
        let sum = 0;
        for (let i = 0; i < data.length; i += 4) sum += 245 - Math.min(data[i], data[i + 2]);
        return sum / (data.length / 4) / 245;
      };
      const colours = [colour(0), colour(viewer.pictures.length - 2)];
      viewer.choose('a', 0);
      return colours;""")
    check(pale[0] < pale[1], f"{item}: the best one's error map is paler, {pale[0]:.2f} and {pale[1]:.2f} of all colour")
    same = tool("viewer.choose('b', viewer.a); return [...viewer.canvas.getContext('2d')"
                ".getImageData(0, 0, viewer.canvas.width, viewer.canvas.height).data].every((x) => x >= 245);")
    check(same, f"{item}: no picture differs from itself")
    tool("viewer.choose('b', viewer.pictures.length - 1); click('wipe');")
    check(tool("return viewer.legend.hidden;"), f"{item}: the legend goes with the error map")
    insets = tool("return [0.1, 0.8].map((x) => { move(x, 0.4);"
                  "return [sum(viewer.zoom), viewer.reading.innerText]; });")
    check(insets[0] != insets[1] and "pixel" in insets[0][1], f"{item}: the inset shows where the pointer is")
    bright = tool("""
      const mean = () => {
        const { width, height } = viewer.shown[0];
        const { data } = viewer.shown[0].getContext("2d").getImageData(0, 0, width, height);
        return data.reduce((sum, byte) => sum + byte, 0) / data.length;
      };
      return [-2, 0, 2].map((stops) => {
        viewer.slider.value = stops;
        viewer.slider.dispatchEvent(new Event("input"));
        return mean();
      });""")
    check(bright[0] < bright[1] < bright[2], f"{item}: exposure brightens")
    tool("viewer.slider.value = 0; viewer.slider.dispatchEvent(new Event('input')); move(0.5, 0.5);")
    notes = tool("return [...figure.querySelectorAll('.thumb .label')].map((label) => label.innerText);")
    check(all(notes), f"{item}: every picture has its name and note")


def plots(browser):
    """The number of plots, and captions of those without width. They load as they come into view."""
    count = browser.run("return document.querySelectorAll('.plot img').length")
    for index in range(count):
        browser.run("document.querySelectorAll('.plot img')[arguments[0]].scrollIntoView()", index)
        for _ in range(100):
            if browser.run("return document.querySelectorAll('.plot img')[arguments[0]].complete", index):
                break
            time.sleep(0.05)
    empty = "return [...document.querySelectorAll('.plot img')].filter((image) => !(image.naturalWidth > 1)).map((i) => i.alt)"
    return count, browser.run(empty)


def doubts(browser):
    """Error maps beside a reference say when it is noisy itself."""
    said = browser.run("""
      const figure = document.querySelector(".gallery[data-reference=yes]");
      if (!figure) return null;
      const viewer = figure.viewer;
      viewer.setMode("error");
      const told = (share) => {
        viewer.reference.rmse = share * viewer.pictures[viewer.a].rmse;
        viewer.draw();
        return viewer.caption.textContent;
      };
      viewer.choose("a", 0);
      viewer.choose("b", viewer.pictures.length - 1);
      const { rmse } = viewer.reference, texts = [told(0.3), told(0.5)];
      viewer.reference.rmse = rmse;
      viewer.setMode("wipe");
      return texts;""")
    if said:
        check("own error" not in said[0] and "own error is 50 %" in said[1], "error maps say when references are noisy")


def main():
    report = pathlib.Path(sys.argv[1]).resolve()
    shots = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = Browser(profile, "1240,1600")
        try:
            browser.open(report.as_uri())
            for _ in range(300):
                if browser.run("return document.body.dataset.ready || null"):
                    break
                time.sleep(0.1)
            else:
                sys.exit("FAILED: the script of the page does not come to its end")
            loaded = browser.run("return performance.getEntriesByType('resource').map((entry) => entry.name)")
            outside = [name for name in loaded if not name.startswith("data:")]
            check(not outside, f"nothing is loaded from outside the page ({len(outside)} names)")
            pictures, empty = plots(browser)
            check(pictures and not empty, f"all {pictures} plots can be read ({', '.join(empty) or 'none is empty'})")
            items = browser.run("return [...document.querySelectorAll('section')].map((section) => section.id)")
            check(items, f"there are sections: {', '.join(items)}")
            for item in items:
                pictures = browser.run("const viewer = document.querySelector(`#${arguments[0]} .gallery`)?.viewer;"
                                       "return viewer ? viewer.pictures.length : 0", item)
                if pictures > 1:
                    use(browser, item)
            doubts(browser)
            check(not browser.run("return document.body.innerText.includes('`')"), "no mark of code is left in the text")
            if shots:
                shots.mkdir(parents=True, exist_ok=True)
                browser.run("scrollTo(0, 0)")
                time.sleep(0.3)
                (shots / "top.png").write_bytes(browser.picture())
                for item in items:
                    browser.run("document.getElementById(arguments[0]).scrollIntoView()", item)
                    time.sleep(0.3)
                    (shots / f"{item}.png").write_bytes(browser.picture())
        finally:
            browser.close()


if __name__ == "__main__":
    main()
