// SPDX-License-Identifier: Apache-2.0
// The data of the page, what is shown where, and what the pointer does.
"use strict";
const $ = id => document.getElementById(id);
const meta = JSON.parse($("meta").textContent);

// An array of the page: base64 of what zlib packed. Least byte first, as on all machines with browsers.
async function array(name, Type) {
  const element = $("data-" + name);
  if (!element) return null;
  const text = atob(element.textContent.trim());
  element.remove();
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Type(await new Response(stream).arrayBuffer());
}

function say(text) { $("under").textContent = text; document.body.dataset.state = "failed"; }

class Mesh {
  static async load() {
    const mesh = new Mesh();
    [mesh.places, mesh.triangles, mesh.constrained, mesh.region, mesh.depth, mesh.winding, mesh.pieces, mesh.offsets, mesh.sources] =
      await Promise.all([array("places", Float64Array), array("triangles", Uint32Array), array("constrained", Uint8Array),
                         array("region", Uint32Array), array("depth", Uint32Array), array("winding", Int32Array),
                         array("pieces", Uint32Array), array("offsets", Uint32Array), array("sources", Uint32Array)]);
    mesh.attributes = [];
    for (let k = 0; k < meta.attributes; ++k) mesh.attributes.push(await array("attribute" + k, Float64Array));
    const least = [Infinity, Infinity], most = [-Infinity, -Infinity];
    for (let i = 0; i < mesh.places.length; ++i) {
      least[i & 1] = Math.min(least[i & 1], mesh.places[i]);
      most[i & 1] = Math.max(most[i & 1], mesh.places[i]);
    }
    if (mesh.places.length == 0) least.fill(0), most.fill(0);
    mesh.middle = [least[0] / 2 + most[0] / 2, least[1] / 2 + most[1] / 2];
    mesh.sides = [most[0] - least[0], most[1] - least[1]];
    mesh.half = Math.max(...mesh.sides) / 2 || 1;
    return mesh;
  }
  corner(t, k) { const v = this.triangles[3 * t + k]; return [this.places[2 * v], this.places[2 * v + 1]]; }
  /// The least triangle that the point is in; -1 for none.
  at(x, y) {
    const p = this.places, side = (a, b) => (p[b] - p[a]) * (y - p[a + 1]) - (p[b + 1] - p[a + 1]) * (x - p[a]);
    for (let i = 0; i < this.triangles.length; i += 3) {
      const a = 2 * this.triangles[i], b = 2 * this.triangles[i + 1], c = 2 * this.triangles[i + 2];
      if (side(a, b) >= 0 && side(b, c) >= 0 && side(c, a) >= 0) return i / 3;
    }
    return -1;
  }
  weights(t, x, y) {
    const [a, b, c] = [0, 1, 2].map(k => this.corner(t, k));
    const area = (p, q, r) => (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    const all = area(a, b, c), at = [x, y];
    return [area(b, c, at) / all, area(c, a, at) / all, area(a, b, at) / all];
  }
  /// The numbers of the input's constraints along an edge.
  along(a, b) {
    if (!this.pieces) return null;
    for (let i = 0; i < this.pieces.length; i += 2)
      if (this.pieces[i] == a && this.pieces[i + 1] == b || this.pieces[i] == b && this.pieces[i + 1] == a)
        return Array.from(this.sources.subarray(this.offsets[i / 2], this.offsets[i / 2 + 1]), c => c + meta.firstConstraint);
    return null;
  }
}

const shown = n => Math.abs(n) >= 1e-4 && Math.abs(n) < 1e9 || n == 0 ? String(+n.toPrecision(9)) : n.toPrecision(6);

class Page {
  constructor(mesh, picture) {
    Object.assign(this, {mesh, picture, chosen: -1, kept: false, mode: 0, ranges: []});
    this.canvas = picture.gl.canvas;
    $("title").textContent = meta.title;
    $("counts").textContent = `${meta.triangles.toLocaleString("en")} triangles, ${meta.vertices.toLocaleString("en")} vertices`;
    $("ramp").style.background = `linear-gradient(to right, ${ramp.map(c => `rgb(${c.join(",")})`).join(",")})`;
    const modes = ["none", ...(mesh.region ? ["region"] : []), "smallest angle", ...mesh.attributes.map((_, k) => `attribute ${k + 1}`)];
    this.numbers = {"none": 0, "region": 1, "smallest angle": 2};
    for (const name of modes) $("colour").add(new Option(name));
    this.all();
    this.restore();
    this.listen();
    // At once: this is before the frame is shown, which would stretch the picture of the old size.
    new ResizeObserver(() => this.paint()).observe(this.canvas);
  }
  all() {
    const {clientWidth: w, clientHeight: h} = this.canvas, [x, y] = this.mesh.middle;
    this.view = {x, y, scale: 0.94 * Math.min(w / (this.mesh.sides[0] || 1), h / (this.mesh.sides[1] || 1))};
    this.redraw();
  }
  /// What the address says after '#': x, y, scale, colour, pick=X,Y.
  restore() {
    const said = new URLSearchParams(location.hash.slice(1));
    for (const name of ["x", "y", "scale"])
      if (said.has(name) && Number.isFinite(+said.get(name))) this.view[name] = +said.get(name);
    const names = Array.from($("colour").options, option => option.value);
    const regions = this.mesh.region?.some(region => region != this.mesh.region[0]);
    $("colour").value = names.includes(said.get("colour")) ? said.get("colour") : regions ? "region" : "smallest angle";
    this.recolour();
    if (said.has("pick")) {
      const [x, y] = said.get("pick").split(",").map(Number);
      this.show(x, y);
      this.kept = this.chosen >= 0;
    }
  }
  recolour() {
    const name = $("colour").value, k = parseInt(name.slice("attribute ".length)) - 1;
    this.mode = name in this.numbers ? this.numbers[name] : 3 + k;
    $("legend").hidden = this.mode < 2;
    if (this.mode == 2) [$("least").textContent, $("most").textContent] = ["0°", "60°"];
    if (this.mode > 2) {
      const values = this.mesh.attributes[k];
      let least = Infinity, most = -Infinity;
      for (const v of values) if (Number.isFinite(v)) least = Math.min(least, v), most = Math.max(most, v);
      this.picture.values(Float32Array.from(values, v => (v - least) / (most - least || 1)));
      [$("least").textContent, $("most").textContent] = [shown(least), shown(most)];
    }
    this.redraw();
  }
  redraw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.paint();
    });
  }
  paint() {
    const c = this.canvas, w = Math.round(c.clientWidth * devicePixelRatio), h = Math.round(c.clientHeight * devicePixelRatio);
    if (c.width != w || c.height != h) [c.width, c.height] = [w, h];
    this.picture.draw(this.view, this.mode, $("edges").checked, this.chosen);
    this.scale();
    document.body.dataset.state = "drawn";
  }
  scale() {
    const room = 140 / this.view.scale, power = 10 ** Math.floor(Math.log10(room));
    const length = power * (room >= 5 * power ? 5 : room >= 2 * power ? 2 : 1);
    $("scale").style.width = `${length * this.view.scale}px`;
    $("scale").textContent = shown(length);
  }
  place(event) {
    const box = this.canvas.getBoundingClientRect();
    return [this.view.x + (event.clientX - box.left - box.width / 2) / this.view.scale,
            this.view.y - (event.clientY - box.top - box.height / 2) / this.view.scale];
  }
  zoom(factor, x = this.view.x, y = this.view.y) {
    const scale = Math.min(Math.max(this.view.scale * factor, 1 / this.mesh.half), 1e14 / this.mesh.half);
    const by = 1 - this.view.scale / scale;
    this.view = {x: this.view.x + (x - this.view.x) * by, y: this.view.y + (y - this.view.y) * by, scale};
    this.redraw();
  }
  listen() {
    const pointers = new Map();
    let moved = 0;
    this.canvas.addEventListener("pointerdown", e => {
      this.canvas.setPointerCapture(e.pointerId);
      pointers.set(e.pointerId, e);
      moved = 0;
    });
    this.canvas.addEventListener("pointermove", e => {
      const before = pointers.get(e.pointerId);
      if (!before) {
        if (!this.kept) this.later(() => this.show(...this.place(e)));
        return;
      }
      this.canvas.classList.add("dragged");
      moved += Math.hypot(e.clientX - before.clientX, e.clientY - before.clientY);
      const [x, y] = this.place(before), [u, v] = this.place(e);
      if (pointers.size == 2) {
        const other = [...pointers.values()].find(p => p.pointerId != e.pointerId);
        const distance = p => Math.hypot(p.clientX - other.clientX, p.clientY - other.clientY);
        if (distance(before) > 0) this.zoom(distance(e) / distance(before), ...this.place(other));
      } else {
        this.view = {...this.view, x: this.view.x + x - u, y: this.view.y + y - v};
      }
      pointers.set(e.pointerId, e);
      this.redraw();
    });
    for (const end of ["pointerup", "pointercancel"])
      this.canvas.addEventListener(end, e => {
        this.canvas.classList.remove("dragged");
        if (pointers.delete(e.pointerId) && moved < 4 && end == "pointerup") {
          this.kept = !this.kept;
          this.show(...this.place(e));
        }
      });
    this.canvas.addEventListener("wheel", e => {
      e.preventDefault();
      this.zoom(2 ** (-e.deltaY * (e.deltaMode == 1 ? 20 : 1) / 300), ...this.place(e));
    }, {passive: false});
    this.canvas.addEventListener("keydown", e => {
      const step = 60 / this.view.scale;
      const moves = {ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step]};
      if (e.key in moves) {
        this.view = {...this.view, x: this.view.x + moves[e.key][0], y: this.view.y + moves[e.key][1]};
        this.redraw();
      } else if (e.key == "+" || e.key == "=") this.zoom(1.4);
      else if (e.key == "-") this.zoom(1 / 1.4);
      else if (e.key == "0") this.all();
    });
    $("colour").addEventListener("change", () => this.recolour());
    $("edges").addEventListener("change", () => this.redraw());
  }
  /// Once a frame at most: a look through a million triangles takes some milliseconds.
  later(action) {
    const idle = !this.next;
    this.next = action;
    if (idle) requestAnimationFrame(() => { const next = this.next; this.next = null; next(); });
  }
  show(x, y) {
    const t = this.chosen = this.mesh.at(x, y);
    this.redraw();
    $("under").replaceChildren();
    document.body.dataset.picked = t < 0 ? "" : t + meta.first;
    if (t < 0) return;
    const rows = [], mesh = this.mesh;
    const corners = [0, 1, 2].map(k => mesh.corner(t, k)), numbers = [0, 1, 2].map(k => mesh.triangles[3 * t + k]);
    const weights = mesh.weights(t, x, y);
    rows.push(["pointer", `${shown(x)}, ${shown(y)}`]);
    for (let k = 0; k < 3; ++k) rows.push([`vertex ${numbers[k] + meta.first}`, corners[k].map(shown).join(", ")]);
    const angle = k => {
      const [p, q, r] = [0, 1, 2].map(i => corners[(k + i) % 3]), a = [q[0] - p[0], q[1] - p[1]], b = [r[0] - p[0], r[1] - p[1]];
      return Math.atan2(Math.abs(a[0] * b[1] - a[1] * b[0]), a[0] * b[0] + a[1] * b[1]) * 180 / Math.PI;
    };
    rows.push(["angles", [0, 1, 2].map(k => angle(k).toFixed(2) + "°").join(", ")]);
    const [a, b, c] = corners;
    rows.push(["area", shown(((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2)]);
    for (const name of ["region", "depth", "winding"]) if (mesh[name]) rows.push([name, mesh[name][t]]);
    mesh.attributes.forEach((values, k) =>
      rows.push([`attribute ${k + 1}`, shown(weights.reduce((sum, w, i) => sum + w * values[numbers[i]], 0))]));
    for (let k = 0; k < 3; ++k) {
      if (!mesh.constrained || !(mesh.constrained[t] >> k & 1)) continue;
      const [u, v] = [numbers[(k + 1) % 3], numbers[(k + 2) % 3]], along = mesh.along(u, v);
      rows.push([`edge ${u + meta.first}, ${v + meta.first}`, along ? `constraint ${along.join(", ")}` : "constrained"]);
    }
    const head = document.createElement("h2"), table = document.createElement("table");
    head.textContent = `triangle ${t + meta.first}${this.kept ? " (kept)" : ""}`;
    for (const row of rows) {
      const line = table.insertRow();
      for (const text of row) line.insertCell().textContent = text;
    }
    $("under").append(head, table);
  }
}

async function start() {
  try {
    const gl = $("canvas").getContext("webgl2", {antialias: true});
    if (!gl) throw new Error("This browser has no WebGL 2, or it is switched off.");
    const mesh = await Mesh.load();
    window.page = new Page(mesh, new Picture(gl, mesh));
  } catch (error) {
    say(String(error.message || error));
  }
}
