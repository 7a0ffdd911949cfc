// SPDX-License-Identifier: Apache-2.0
// The mesh drawn by WebGL 2: three textures, no vertex buffers; edges are drawn where the weights of corners are small.

// Colour ramp, from dark blue through green to yellow: even for most eyes.
const ramp = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
const rampText = ramp.map(c => `vec3(${c.map(v => (v / 255).toFixed(4)).join(",")})`).join(",");

const vertexShader = `#version 300 es
precision highp float; precision highp int; precision highp usampler2D; precision highp sampler2D;
uniform usampler2D triangles;  // corners, and region * 8 + constrained
uniform sampler2D places, values;  // places in two parts, whose sum is one of about 48 bits
uniform vec4 centre; uniform vec2 zoom; uniform bool valued;
out vec3 weight; out float value;
flat out float quality; flat out uint told; flat out int number;
ivec2 at(int i) { return ivec2(i & 2047, i >> 11); }
vec2 place(uint v) {
  vec4 p = texelFetch(places, at(int(v)), 0);
  return (p.xy - centre.xy) + (p.zw - centre.zw);
}
float angle(vec2 a, vec2 b) { return atan(abs(a.x * b.y - a.y * b.x), dot(a, b)); }
void main() {
  number = gl_VertexID / 3;
  int k = gl_VertexID - 3 * number;
  uvec4 t = texelFetch(triangles, at(number), 0);
  vec2 a = place(t.x), b = place(t.y), c = place(t.z);
  told = t.w;
  weight = vec3(k == 0, k == 1, k == 2);
  quality = min(angle(b - a, c - a), min(angle(c - b, a - b), angle(a - c, b - c))) / radians(60.0);
  uint v = k == 0 ? t.x : k == 1 ? t.y : t.z;
  value = valued ? texelFetch(values, at(int(v)), 0).r : 0.0;
  gl_Position = vec4((k == 0 ? a : k == 1 ? b : c) * zoom, 0, 1);
}`;
const fragmentShader = `#version 300 es
precision highp float; precision highp int;
uniform int mode, chosen; uniform bool edges; uniform float pixel;
in vec3 weight; in float value;
flat in float quality; flat in uint told; flat in int number;
out vec4 colour;
vec3 ramped(float x) {
  vec3 c[5] = vec3[5](${rampText});
  float at = clamp(x, 0.0, 1.0) * 4.0;
  int i = min(int(at), 3);
  return mix(c[i], c[i + 1], at - float(i));
}
vec3 region(uint r) {  // far apart for neighbours in number
  float hue = fract(float(r) * 0.61803398875) * 6.2831853;
  return 0.82 + 0.11 * vec3(cos(hue), cos(hue - 2.0944), cos(hue + 2.0944));
}
void main() {
  vec3 c = mode == 0 ? vec3(0.93, 0.95, 0.97) : mode == 1 ? region(told >> 3) : mode == 2 ? ramped(quality)
         : isnan(value) ? vec3(0.8) : ramped(value);
  if (mode >= 2) c = mix(c, vec3(1), 0.15);
  if (number == chosen) c = mix(c, vec3(1, 0.45, 0.1), 0.6);
  vec3 slope = max(fwidth(weight), 1e-12);
  for (int k = 0; k < 3; ++k) {
    bool bold = (told >> k & 1u) == 1u;
    if (!edges && !bold) continue;
    float pixels = weight[k] / slope[k] / pixel, high = 1.0 / slope[k] / pixel;
    float ink = bold ? 1.0 - smoothstep(0.8, 1.6, pixels) : (1.0 - smoothstep(0.2, 0.9, pixels)) * smoothstep(1.0, 9.0, high) * 0.7;
    c = mix(c, bold ? vec3(0.07, 0.0, 0.2) : vec3(0.25, 0.4, 0.42), ink);
  }
  colour = vec4(c, 1);
}`;

const columns = 2048;  // of a texture: every WebGL 2 has that many

class Picture {
  constructor(gl, mesh) {
    this.gl = gl;
    this.mesh = mesh;
    this.program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertexShader], [gl.FRAGMENT_SHADER, fragmentShader]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(this.program, shader);
    }
    gl.linkProgram(this.program);
    if (!gl.getProgramParameter(this.program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(this.program));
    gl.useProgram(this.program);
    this.uniforms = {};
    for (const name of ["triangles", "places", "values", "centre", "zoom", "valued", "mode", "chosen", "edges", "pixel"])
      this.uniforms[name] = gl.getUniformLocation(this.program, name);
    gl.bindVertexArray(gl.createVertexArray());
    this.textures = [gl.createTexture(), gl.createTexture(), gl.createTexture()];
    const n = mesh.places.length / 2, t = mesh.triangles.length / 3;
    const places = new Float32Array(this.size(n) * 4);
    for (let v = 0; v < n; ++v)
      for (let k = 0; k < 2; ++k) {
        const c = this.canonical(mesh.places[2 * v + k], k), high = Math.fround(c);
        places[4 * v + k] = high;
        places[4 * v + 2 + k] = c - high;
      }
    this.fill(1, gl.RGBA32F, gl.RGBA, gl.FLOAT, places, 4);
    const told = new Uint32Array(this.size(t) * 4);
    for (let i = 0; i < t; ++i) {
      told.set(mesh.triangles.subarray(3 * i, 3 * i + 3), 4 * i);
      told[4 * i + 3] = ((mesh.region ? mesh.region[i] : 0) << 3 | (mesh.constrained ? mesh.constrained[i] : 0)) >>> 0;
    }
    this.fill(0, gl.RGBA32UI, gl.RGBA_INTEGER, gl.UNSIGNED_INT, told, 4);
    this.fill(2, gl.R32F, gl.RED, gl.FLOAT, new Float32Array(columns), 1);
    gl.uniform1i(this.uniforms.triangles, 0);
    gl.uniform1i(this.uniforms.places, 1);
    gl.uniform1i(this.uniforms.values, 2);
    gl.clearColor(1, 1, 1, 1);
  }
  canonical(c, axis) { return (c - this.mesh.middle[axis]) / this.mesh.half; }
  size(count) { return Math.max(1, Math.ceil(count / columns)) * columns; }
  fill(unit, inner, format, type, data, width) {
    const gl = this.gl, rows = data.length / width / columns;
    if (rows > gl.getParameter(gl.MAX_TEXTURE_SIZE)) throw new Error("The mesh is too large for this graphics driver.");
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, this.textures[unit]);
    gl.texImage2D(gl.TEXTURE_2D, 0, inner, columns, rows, 0, format, type, data);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  }
  /// Values of vertices, from 0 to 1.
  values(values) {
    const padded = new Float32Array(this.size(values.length));
    padded.set(values);
    this.fill(2, this.gl.R32F, this.gl.RED, this.gl.FLOAT, padded, 1);
  }
  draw(view, mode, edges, chosen) {
    const gl = this.gl, canvas = gl.canvas, u = this.uniforms;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clear(gl.COLOR_BUFFER_BIT);
    const c = [this.canonical(view.x, 0), this.canonical(view.y, 1)], high = c.map(Math.fround);
    gl.uniform4f(u.centre, high[0], high[1], c[0] - high[0], c[1] - high[1]);
    const scale = 2 * view.scale * this.mesh.half * devicePixelRatio;  // of a canonical unit, in half canvases
    gl.uniform2f(u.zoom, scale / canvas.width, scale / canvas.height);
    gl.uniform1i(u.valued, mode > 2);
    gl.uniform1i(u.mode, Math.min(mode, 3));
    gl.uniform1i(u.edges, edges);
    gl.uniform1i(u.chosen, chosen);
    gl.uniform1f(u.pixel, Math.max(1, devicePixelRatio));
    gl.drawArrays(gl.TRIANGLES, 0, this.mesh.triangles.length);
  }
}
