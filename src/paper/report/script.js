// Viewers of galleries: flip and wipe between two pictures, their difference, a zoomed inset, exposure.
"use strict";

const WHITE = 16; // exposed radiance from which on a pixel is full, as in fogbow's own PNG images
const BIAS = 128;
const NOISY = 1 / 3; // share of a picture's error from which on that of the reference shows
const INSET = 24; // pixels of a picture that the inset shows across
const HALF = 3; // units of a difference at which an error map has half of its colour
const TICKS = [1, 3, 10, 30]; // units that its legend names

// Radiances of a picture: mantissas in its upper half, exponents in its lower one.
function decode(image) {
  const width = Number(image.dataset.width), height = Number(image.dataset.height);
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = 2 * height;
  const context = canvas.getContext("2d", { willReadFrequently: true, colorSpace: "srgb" });
  context.drawImage(image, 0, 0);
  const bytes = context.getImageData(0, 0, width, 2 * height).data;
  const count = width * height, radiance = new Float32Array(3 * count);
  for (let i = 0; i < count; i++) {
    const scale = bytes[4 * (count + i)] === 0 ? 0 : 2 ** (bytes[4 * (count + i)] - BIAS) / 256;
    for (let c = 0; c < 3; c++) radiance[3 * i + c] = bytes[4 * i + c] * scale;
  }
  const { name, note } = image.dataset, rmse = Number(image.dataset.rmse ?? NaN);
  return { name, note, rmse, width, height, radiance };
}

const srgb = (x) => 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);

// The picture as it is shown: Reinhard's curve on the largest channel, then sRGB.
function expose(picture, stops) {
  const { width, height, radiance } = picture, scale = 2 ** stops, shown = new ImageData(width, height);
  for (let i = 0; i < width * height; i++) {
    const rgb = [0, 1, 2].map((c) => scale * radiance[3 * i + c]);
    const largest = Math.max(...rgb);
    const curve = largest < WHITE ? (1 + largest / (WHITE * WHITE)) / (1 + largest) : 1 / largest;
    for (let c = 0; c < 3; c++) shown.data[4 * i + c] = srgb(Math.min(1, curve * rgb[c]));
    shown.data[4 * i + 3] = 255;
  }
  return shown;
}

// How much colour a difference of so many units has: nearly none for small ones, and never all of it, so that large
// ones are told apart, too.
const colourOf = (units) => Math.abs(units) / (Math.abs(units) + HALF);

// White where there is no difference, red where it is above 0, blue below.
function tint(units) {
  const away = 245 * (1 - colourOf(units));
  return units > 0 ? [245, away, away, 255] : [away, away, 245, 255];
}

// Of pixel i, the difference of two pictures, the mean of the channels.
function differenceAt(a, b, i) {
  let sum = 0;
  for (let c = 0; c < 3; c++) sum += (a.radiance[3 * i + c] - b.radiance[3 * i + c]) / 3;
  return sum;
}

// The difference of two pictures, in units.
function difference(a, b, unit) {
  const shown = new ImageData(a.width, a.height);
  for (let i = 0; i < a.width * a.height; i++) shown.data.set(tint(differenceAt(a, b, i) / unit), 4 * i);
  return shown;
}

// Root mean square of the difference of two pictures.
function distance(a, b) {
  const count = Math.min(a.width * a.height, b.width * b.height);
  let squares = 0;
  for (let i = 0; i < count; i++) squares += differenceAt(a, b, i) ** 2 / count;
  return Math.sqrt(squares);
}

function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

function canvasOf(picture, shown) {
  const canvas = element("canvas", { width: picture.width, height: picture.height });
  canvas.getContext("2d").putImageData(shown, 0, 0);
  return canvas;
}

function label(picture) {
  return element("span", { className: "label" }, element("b", {}, picture.name), picture.note);
}

class Viewer {
  constructor(figure, pictures) {
    this.pictures = pictures;
    this.exposure = Number(figure.dataset.exposure);
    this.reference = figure.dataset.reference === "yes" ? pictures[pictures.length - 1] : null;
    // What error maps count in: the least error that is known of these pictures, or else what two of them differ by.
    this.unit = Number(figure.dataset.unit ?? 0) || distance(pictures[0], pictures[pictures.length > 1 ? 1 : 0]) || 1;
    this.stops = 0;
    this.mode = "wipe";
    this.split = 0.5;
    this.at = [0.5, 0.5];
    this.side = 0;
    this.a = 0;
    this.b = pictures.length - 1;
    this.build(figure);
    this.expose();
    if (pictures.length === 1) this.setMode("flip");
  }

  build(figure) {
    this.thumbs = element("div", { className: "thumbs" });
    const button = (mode, text, title) => {
      const made = element("button", { type: "button", title }, text);
      made.dataset.mode = mode;
      made.addEventListener("click", () => {
        if (mode === "flip" && this.mode === "flip") this.side = 1 - this.side;
        this.setMode(mode);
      });
      return made;
    };
    this.buttons = [
      button("flip", "flip", "one picture; click again, or press F, for the other"),
      button("wipe", "wipe", "both, on either side of the pointer"),
      button("error", "error map", "A minus B: red where A is brighter, blue where it is darker"),
    ];
    const select = (which) => {
      const options = this.pictures.map((picture, i) => element("option", { value: i }, picture.name));
      const made = element("select", {}, ...options);
      made.value = this[which];
      made.addEventListener("change", () => this.choose(which, Number(made.value)));
      return made;
    };
    this.selects = { a: select("a"), b: select("b") };
    this.slider = element("input", { type: "range", min: -6, max: 6, step: 0.25, value: 0 });
    this.value = element("output");
    this.slider.addEventListener("input", () => {
      this.stops = Number(this.slider.value);
      this.expose();
    });
    const comparing = this.pictures.length > 1;
    const controls = element("div", { className: "controls" });
    if (comparing) {
      controls.append(element("label", {}, "A ", this.selects.a), element("label", {}, "B ", this.selects.b));
      controls.append(element("span", {}, ...this.buttons));
    }
    controls.append(element("label", {}, "exposure ", this.slider, " ", this.value));
    this.canvas = element("canvas");
    this.caption = element("span", { className: "label" });
    this.view = element("div", { className: "view", tabIndex: 0 }, this.canvas, this.caption);
    this.view.addEventListener("pointermove", (event) => this.point(event));
    this.view.addEventListener("keydown", (event) => {
      if (event.key.toLowerCase() !== "f") return;
      this.side = 1 - this.side;
      this.setMode("flip");
    });
    this.zoom = element("canvas", { width: 240, height: 240 });
    this.reading = element("p");
    const inset = element("div", { className: "inset" }, this.zoom, this.reading);
    this.legend = element("div", { className: "legend", hidden: true });
    figure.append(this.thumbs, controls, element("div", { className: "stage" }, this.view, inset), this.legend);
  }

  // What error maps count in as it is shown: brighter pictures show smaller differences.
  shownUnit() {
    return this.unit / 2 ** this.stops;
  }

  // The colours of error maps, and of which differences they are.
  drawLegend() {
    this.legend.hidden = this.mode !== "error";
    const bar = element("canvas", { width: 401, height: 1 }), context = bar.getContext("2d");
    for (let x = 0; x < bar.width; x++) {
      const place = Math.max(-0.995, Math.min(0.995, 2 * x / (bar.width - 1) - 1));
      const units = HALF * place / (1 - Math.abs(place));
      context.putImageData(new ImageData(new Uint8ClampedArray(tint(units)), 1, 1), x, 0);
    }
    const tick = (units) => {
      const text = units === 0 ? "0" : (units * this.shownUnit()).toPrecision(2).replace(/^(-?)(.*)e\+?/, "$1$2e");
      const made = element("span", {}, text);
      made.style.left = `${50 + 50 * Math.sign(units) * colourOf(units)}%`;
      return made;
    };
    const ticks = [...TICKS.map((units) => -units).reverse(), 0, ...TICKS].map(tick);
    const least = this.pictures.find((picture) => picture.rmse === this.unit);
    const what = least ? `the first mark on either side is the RMSE of ${least.name}, the least of these`
      : "the first mark on either side is what the first two differ by, root mean square";
    const scale = this.stops === 0 ? "" : ", over the exposure";
    this.legend.replaceChildren(
      element("div", { className: "scale" }, bar, element("div", { className: "ticks" }, ...ticks)),
      element("p", {}, `Difference of radiances [W/(m^2 sr)], mean of the channels: ${what}${scale}.`),
    );
  }

  setMode(mode) {
    this.mode = mode;
    this.draw();
  }

  choose(which, index) {
    this[which] = index;
    this.selects[which].value = index;
    this.draw();
  }

  point(event) {
    const box = this.canvas.getBoundingClientRect();
    const inside = (x) => Math.max(0, Math.min(1, x));
    this.at = [inside((event.clientX - box.left) / box.width), inside((event.clientY - box.top) / box.height)];
    if (this.mode === "wipe") this.split = this.at[0];
    this.draw();
  }

  // Everything anew for another exposure.
  expose() {
    const stops = this.exposure + this.stops;
    this.value.textContent = `${this.stops >= 0 ? "+" : ""}${this.stops} EV`;
    this.shown = this.pictures.map((picture) => canvasOf(picture, expose(picture, stops)));
    const thumb = (picture, i) => {
      const made = element("button", { className: "thumb", type: "button", title: "click: A; shift and click: B" });
      const canvas = element("canvas", { width: picture.width, height: picture.height });
      canvas.getContext("2d").drawImage(this.shown[i], 0, 0);
      made.append(canvas, label(picture));
      made.addEventListener("click", (event) => this.choose(event.shiftKey ? "b" : "a", i));
      return made;
    };
    this.thumbs.replaceChildren(...this.pictures.map(thumb));
    this.draw();
  }

  // What an error map has to say of a reference that shows noise of its own.
  doubt(a, b) {
    if (this.reference === null || (a === b) || (a !== this.reference && b !== this.reference)) return "";
    const judged = a === this.reference ? b : a;
    if (!(this.reference.rmse > NOISY * judged.rmse)) return "";
    const share = Math.round(100 * this.reference.rmse / judged.rmse);
    return `; the reference's own error is ${share} % of that of ${judged.name}, part of what is seen`;
  }

  // What the view shows, at the size of the pictures.
  composed() {
    const a = this.pictures[this.a], b = this.pictures[this.b];
    const same = a.width === b.width && a.height === b.height;
    if (this.mode === "error" && same) {
      return [canvasOf(a, difference(a, b, this.shownUnit())), `${a.name} minus ${b.name}${this.doubt(a, b)}`];
    }
    if (this.mode === "flip" || !same) {
      const index = this.side === 0 ? this.a : this.b;
      return [this.shown[index], `${this.side === 0 ? "A" : "B"}: ${this.pictures[index].name}`];
    }
    const both = element("canvas", { width: a.width, height: a.height }), context = both.getContext("2d");
    const edge = Math.round(this.split * a.width);
    context.drawImage(this.shown[this.b], 0, 0);
    if (edge > 0) context.drawImage(this.shown[this.a], 0, 0, edge, a.height, 0, 0, edge, a.height);
    return [both, `${a.name} | ${b.name}`];
  }

  draw() {
    const [picture, text] = this.composed(), context = this.canvas.getContext("2d");
    this.canvas.width = picture.width;
    this.canvas.height = picture.height;
    context.drawImage(picture, 0, 0);
    if (this.mode === "wipe" && this.pictures.length > 1) {
      context.fillStyle = "rgba(255, 255, 255, 0.8)";
      context.fillRect(Math.round(this.split * picture.width), 0, 1, picture.height);
    }
    this.caption.textContent = text;
    for (const button of this.buttons) button.setAttribute("aria-pressed", button.dataset.mode === this.mode);
    [...this.thumbs.children].forEach((thumb, i) => {
      thumb.classList.toggle("a", i === this.a);
      thumb.classList.toggle("b", i === this.b && i !== this.a);
    });
    this.drawInset(picture);
    this.drawLegend();
  }

  drawInset(picture) {
    const { width, height } = picture, across = Math.min(INSET, width, height);
    const x = Math.min(width - 1, Math.floor(this.at[0] * width));
    const y = Math.min(height - 1, Math.floor(this.at[1] * height));
    const left = Math.max(0, Math.min(width - across, x - across / 2));
    const top = Math.max(0, Math.min(height - across, y - across / 2));
    const context = this.zoom.getContext("2d");
    context.imageSmoothingEnabled = false;
    context.drawImage(picture, left, top, across, across, 0, 0, 240, 240);
    const read = (index) => {
      const { name, radiance } = this.pictures[index];
      const rgb = [0, 1, 2].map((c) => radiance[3 * (y * width + x) + c].toPrecision(3));
      return `${name}: ${rgb.join(", ")}`;
    };
    const lines = [`pixel ${x}, ${y}`, read(this.a), ...(this.a === this.b ? [] : [read(this.b)])];
    this.reading.replaceChildren(...lines.flatMap((line) => [line, document.createElement("br")]));
  }
}

async function start(figure) {
  const images = [...figure.querySelectorAll("img.source")];
  await Promise.all(images.map((image) => image.decode()));
  figure.viewer = new Viewer(figure, images.map(decode));
  figure.dataset.ready = "yes";
}

Promise.all([...document.querySelectorAll(".gallery")].map(start)).then(() => {
  document.body.dataset.ready = "yes";
});
