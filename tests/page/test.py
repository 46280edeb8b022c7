#!/usr/bin/env python3
"""Looks at the page of --serve with headless Chromium, while a scene is rendered and after that.

FOGBOW is the program (default: the release build), SCREENSHOTS a folder that is to get screenshots (default: none are
kept). Needs chromium and chromedriver (Debian: chromium, chromium-driver), and nothing else but Python. Takes about
a minute. Exit code 77: not run.
"""

import base64
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import zlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from browser import PATIENCE, Browser as Chromium  # noqa: E402: is beside this folder

ROOT = pathlib.Path(__file__).resolve().parents[2]
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
FOGBOW = os.environ.get("FOGBOW", str(TARGET / "release" / "fogbow"))


def step(text):
    print(f"== {text}", flush=True)


def wait_for(what, condition):
    """The first true value of condition(), asked again and again."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if value := condition():
            return value
        time.sleep(0.1)
    raise AssertionError(f"{what} takes too long")


class Browser(Chromium):
    """The page in a browser."""

    def text(self, element):
        return self.run(f"return document.getElementById('{element}').textContent")

    def click(self, element):
        self.run(f"document.getElementById('{element}').click()")

    def rows(self, table):
        cells = "[...row.cells].map(cell => cell.textContent)"
        return self.run(f"return [...document.querySelectorAll('#{table} tr')].map(row => {cells})")

    def canvas(self):
        """Width, height and bytes, red, green, blue, alpha, of the image."""
        width, height, text = self.run(
            "const c = document.getElementById('image'); "
            "const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let s = ''; "
            "for (let i = 0; i < d.length; i += 8192) s += String.fromCharCode(...d.subarray(i, i + 8192)); return [c.width, c.height, btoa(s)]"
        )
        return width, height, base64.b64decode(text)

    def point_at(self, x, y):
        """Moves the mouse to the middle of a pixel of the image."""
        script = f"return [left + zoom * ({x} + 0.5), top_ + zoom * ({y} + 0.5)]"
        left, top = self.run(f"{script}.map((v, i) => v + view.getBoundingClientRect()[i ? 'top' : 'left'])")
        move = {"type": "pointerMove", "duration": 0, "x": round(left), "y": round(top)}
        mouse = {"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": [move]}
        self.call("POST", "/actions", {"actions": [mouse]})

    def errors(self):
        log = self.call("POST", "/se/log", {"type": "browser"})
        return [entry["message"] for entry in log if entry["level"] == "SEVERE" and "503" not in entry["message"]]

    def resize(self, width, height):
        """Has the page be so many pixels wide and high; the window itself may not be as narrow."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        body = {"cmd": "Emulation.setDeviceMetricsOverride", "params": size}
        self.call("POST", "/goog/cdp/execute", body)

    def screenshot(self, name):
        if folder := os.environ.get("SCREENSHOTS"):
            path = pathlib.Path(folder)
            path.mkdir(parents=True, exist_ok=True)
            (path / f"{name}.png").write_bytes(self.picture())


def read_png(path):
    """Width, height and rows of a PNG image of 8-bit RGB."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        (length,), kind = struct.unpack(">I", data[at : at + 4]), data[at + 4 : at + 8]
        body = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height = struct.unpack(">II", body[:8])
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    raw, stride, before, pixels = zlib.decompress(packed), 3 * width, bytes(3 * width), []
    for y in range(height):
        kind, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1 : (y + 1) * (stride + 1)])
        for i in range(stride):
            a = row[i - 3] if i >= 3 else 0
            b, c = before[i], before[i - 3] if i >= 3 else 0
            p = a + b - c
            nearest = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            row[i] = (row[i] + [0, a, b, (a + b) // 2, nearest][kind]) & 255
        before = bytes(row)
        pixels.append(before)
    return width, height, b"".join(pixels)


def started(work, flags):
    """A render that has opened its page, and where that is."""
    command = [FOGBOW, "render", *flags, "--serve", "0", "--progress", "json"]
    render = subprocess.Popen(command, cwd=work, stderr=subprocess.PIPE, text=True)
    for line in render.stderr:
        if json.loads(line)["event"] == "serving":
            return render, json.loads(line)["url"]
    raise AssertionError("the render does not say where its page is")


def watch(browser, work):
    step("the page shows a running render")
    scene = str(ROOT / "scenes" / "spotlight")
    render, url = started(work, [scene, "-o", "a.png", "--size", "320x240", "--time", "15s"])
    assert url.startswith("http://127.0.0.1:"), url
    browser.open(url)
    wait_for("the first picture", lambda: browser.run("return picture !== null"))
    wait_for("statistics", lambda: len(browser.rows("stages")) > 5)
    assert browser.text("scene") == "spotlight" and browser.text("phase") == "rendering"
    assert any(row[0] == "bridge" for row in browser.rows("connections")), browser.rows("connections")
    shares = [float(row[-1].rstrip(" %")) for row in browser.rows("stages")[1:]]
    assert abs(sum(shares) - 100) < 1, shares
    wait_for("the noise", lambda: "noise" in dict(browser.rows("progress")))
    progress = dict(browser.rows("progress"))
    assert {"samples", "rate", "noise", "time", "left", "until", "technique"} <= progress.keys(), progress
    width, height, before = browser.canvas()
    assert (width, height) == (320, 240) and max(before[0::4]) > 100
    browser.screenshot("1-image")

    step("it gets better")
    samples = browser.run("return picture.samples")
    wait_for("the next picture", lambda: browser.run(f"return picture.samples > {samples}"))

    step("the pixel under the mouse")
    browser.point_at(160, 200)
    assert browser.text("pixel") == "160, 200" and len(browser.text("radiance").split()) == 3
    assert browser.text("noise").endswith("%") or browser.text("noise") == "unknown"

    step("exposure")
    browser.run("slider.value = stops + 3; slider.dispatchEvent(new Event('input'))")
    brighter = browser.canvas()[2]
    assert sum(brighter[0::4]) > 1.2 * sum(before[0::4])
    browser.screenshot("2-exposed")
    browser.click("auto")

    step("noise in false colour")
    browser.click("show-noise")
    colours = browser.canvas()[2]
    assert len(set(zip(colours[0::4], colours[1::4], colours[2::4]))) > 50
    browser.screenshot("3-noise")
    browser.click("show-image")
    assert not browser.errors(), browser.errors()

    step("the last picture is that of the PNG image, and stays")
    render.wait(PATIENCE)
    assert render.returncode == 0
    wait_for("the end", lambda: browser.text("phase") == "finished")
    wait_for("the last picture", lambda: browser.run("return picture.samples === last.samples"))
    assert dict(browser.rows("progress"))["ended by"] == "the time", browser.rows("progress")
    time.sleep(2)
    assert browser.text("phase") == "finished"
    width, height, shown = browser.canvas()
    expected = read_png(work / "a.png")
    assert expected[:2] == (width, height)
    shown = bytes(byte for at, byte in enumerate(shown) if at % 4 < 3)
    largest = max(abs(a - b) for a, b in zip(shown, expected[2]))
    assert largest <= 1, f"the page and the PNG image differ by {largest} of 255"
    browser.screenshot("4-finished")


def widths(browser, work):
    step("narrow and wide windows")
    scene = work / "a scene with a name that is rather long for a header" / "scene.toml"
    scene.parent.mkdir()
    scene.write_text((ROOT / "scenes" / "fog-facing" / "scene.toml").read_text())
    flags = [str(scene.parent), "-o", "w.png", "--size", "320x240", "--time", "20s", "--noise", "1e-5"]
    render, url = started(work, [*flags, "--technique", "path,nee,mvnee,bridge"])
    browser.open(url)
    wait_for("the first picture", lambda: browser.run("return picture !== null"))
    wait_for("statistics", lambda: len(browser.rows("stages")) > 5 and len(browser.rows("connections")) > 3)
    for width, height in ((400, 800), (900, 700), (1600, 900)):
        browser.resize(width, height)
        time.sleep(0.5)
        # What is wider than the page, or than its own box: nobody is to scroll sideways.
        wide = browser.run(
            "const all = [...document.querySelectorAll('body, header, main, aside, footer, section, table, .row')];"
            "return all.filter(e => e.getBoundingClientRect().right > innerWidth + 1 || (e.tagName !== 'MAIN' && "
            "e.scrollWidth > e.clientWidth + 1 && e.clientWidth)).map(e => e.id || e.tagName)"
        )
        assert not wide, f"{width}: {wide}"
        assert browser.run("return document.documentElement.scrollWidth") <= width
        shown = browser.run("const b = canvas.getBoundingClientRect(); return [b.left, b.right, b.top, b.bottom]")
        assert shown[0] >= 0 and shown[1] <= width and shown[2] >= 0 and shown[3] <= height, (width, shown)
        browser.point_at(160, 120)
        assert browser.text("pixel") == "160, 120"
        browser.screenshot(f"7-{width}")
    browser.call("POST", "/goog/cdp/execute", {"cmd": "Emulation.clearDeviceMetricsOverride", "params": {}})
    render.send_signal(2)
    render.wait(PATIENCE)


def dark(browser, work):
    step("scenes of any brightness can be exposed")
    for radiance in ("1e-7", "1e9"):
        flags = [str(ROOT / "scenes" / "fog-facing"), "-o", "d.png", "--size", "64x64", "--time", "20s"]
        render, url = started(work, [*flags, "--set", f"light[0].radiance={radiance}"])
        browser.open(url)
        wait_for("the first picture", lambda: browser.run("return picture !== null"))
        least, stops, most = browser.run("return [+slider.min, stops, +slider.max]")
        assert abs(stops) > 10 and least <= stops - 9.9 and most >= stops + 9.9, (least, stops, most)
        assert abs(browser.run("return +slider.value") - stops) < 0.1
        light = browser.canvas()[2]
        assert 20 < sum(light[0::4]) / len(light[0::4]) < 235
        browser.run("slider.value = stops + 2; slider.dispatchEvent(new Event('input'))")
        assert sum(browser.canvas()[2][0::4]) > 1.1 * sum(light[0::4])
        browser.screenshot(f"8-{radiance}")
        render.send_signal(2)
        render.wait(PATIENCE)


def crop(browser, work):
    step("a crop, its noise and its end by Ctrl-C")
    scene = str(ROOT / "scenes" / "cornell-fog")
    flags = [scene, "-o", "b.exr", "--size", "200x200", "--crop", "50,60,180,160", "--noise", "0.001"]
    render, url = started(work, flags)
    browser.open(url)
    wait_for("the first picture", lambda: browser.run("return picture !== null"))
    browser.point_at(0, 0)
    assert browser.text("pixel") == "50, 60"
    browser.click("show-noise")
    assert browser.run("return document.querySelectorAll('#legend i').length") == 1, "the target is marked"
    wait_for("the noise", lambda: "noise" in dict(browser.rows("progress")))
    assert dict(browser.rows("progress"))["noise"].endswith(" %, target 0.1 %"), browser.rows("progress")
    # In one go: the next picture may come at any time.
    known = "picture.values.forEach((value, i, all) => { if (i % 4 === 3) all[i] = 0.1; }); draw(); "
    hidden = "[true, false].map(known => { if (!known) picture.values[3] = NaN; draw(); return unknown.hidden; })"
    assert browser.run(f"{known} return {hidden}") == [True, False], "black is explained where it is"
    assert browser.run("return unknown.textContent.includes('noise unknown')")
    assert browser.run("show('image'); return unknown.hidden"), "it is about noise alone"
    browser.click("show-noise")
    browser.screenshot("5-crop")
    render.send_signal(2)
    render.wait(PATIENCE)
    assert render.returncode == 130
    wait_for("the end", lambda: browser.text("phase") == "stopped")
    assert dict(browser.rows("progress"))["ended by"] == "a signal", browser.rows("progress")


def unfinished(browser, work):
    step("where there are no samples yet, the image is chequered and says so")
    scene = str(ROOT / "scenes" / "fog-facing")
    flags = [scene, "-o", "u.png", "--size", "200x150", "--exposure", "0", "--reference", "all", "--threads", "1"]
    render, url = started(work, [*flags, "--samples", "100000", "--checkpoint", "off"])
    browser.open(url)
    wait_for("the first picture", lambda: browser.run("return picture !== null"))
    place = browser.run("return picture.values.findIndex((value, i) => i % 4 === 0 && isNaN(value)) / 4")
    assert place >= 0, "the first picture has all pixels"
    place = int(place)
    assert browser.canvas()[2][4 * place] in (0x48, 0x58), "it is grey"
    assert browser.run("return !nothing.hidden && nothing.textContent.includes('nothing yet')")
    browser.point_at(place % 200, place // 200)
    assert browser.text("radiance") == "nothing yet" and browser.text("exposed") == "-"
    wait_for("numbers of a later moment", lambda: "samples in the image" in dict(browser.rows("progress")))
    browser.run("tell({ ...last, samples: picture.samples - 1 })")
    assert "samples in the image" not in dict(browser.rows("progress")), "never more than there are"
    browser.screenshot("9-unfinished")
    render.send_signal(2)
    render.wait(PATIENCE)


def frames(browser, work):
    step("frames of an animation")
    scene = str(ROOT / "scenes" / "fog-facing")
    render, url = started(work, [scene, "-o", "c.##.exr", "--size", "64x64", "--frames", "7-8", "--time", "4s"])
    browser.open(url)
    for text in ("frame 7 (1 of 2)", "frame 8 (2 of 2)"):
        wait_for(text, lambda text=text: browser.text("frame") == text and browser.run("return picture !== null"))
    browser.screenshot("6-frames")
    render.wait(PATIENCE)
    wait_for("the end", lambda: browser.text("phase") == "finished")


def main():
    for name in ("chromium", "chromedriver"):
        if not shutil.which(name):
            print(f"not run: there is no {name}")
            sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        browser = Browser(work / "profile")
        try:
            watch(browser, work)
            widths(browser, work)
            dark(browser, work)
            crop(browser, work)
            unfinished(browser, work)
            frames(browser, work)
        finally:
            browser.close()
    step("all well")


main()
