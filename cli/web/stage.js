import {palette, onTheme} from './strip.js';

/** Numbers per bone: start, end, radius, colour, stripes. */
const PER_BONE = 11;
/** Pixels of the side of the shadows' texture. */
const SHADOW_SIZE = 512;
/** Where light goes, in metres sideways per metre down; nearly from above, so shadows stand below the body. */
const SLANT = 'vec2(.22, .14)';

const BONE_VERTEX = `#version 300 es
layout(location=0) in vec4 shape;
layout(location=1) in vec3 start;
layout(location=2) in vec4 end;
layout(location=3) in vec4 colour;
uniform mat4 camera;
out vec3 normal, place, tint;
out float along, stripes;
void main() {
  vec3 axis = end.xyz - start;
  float size = length(axis);
  vec3 y = size > 1e-5 ? axis / size : vec3(0, 1, 0);
  vec3 x = normalize(cross(y, abs(y.y) < .9 ? vec3(0, 1, 0) : vec3(1, 0, 0)));
  normal = x * shape.x + y * shape.y + cross(x, y) * shape.z;
  place = mix(start, end.xyz, shape.w) + normal * end.w;
  along = shape.w * size + shape.y * end.w;
  tint = colour.rgb;
  stripes = colour.w;
  gl_Position = camera * vec4(place, 1);
}`;

const BONE_FRAGMENT = `#version 300 es
precision highp float;
in vec3 normal, place, tint;
in float along, stripes;
uniform vec3 eye;
out vec4 pixel;
void main() {
  vec3 n = normalize(normal);
  vec3 view = normalize(eye - place);
  vec3 lamp = normalize(normalize(cross(view, vec3(.001, 1, 0))) * -.5 + view * .55 + vec3(0, 1, 0));
  float band = abs(fract(along / .05) - .5) * 2.;
  float soft = fwidth(along) / .05 * 2.;
  vec3 base = mix(tint, vec3(1), stripes * mix(.25, .72, smoothstep(.5 - soft, .5 + soft, band)));
  float sky = n.y * .5 + .5;
  float rim = pow(1. - max(dot(n, view), 0.), 3.);
  vec3 lit = base * (.38 + .34 * sky + .5 * max(dot(n, lamp), 0.));
  lit += vec3(.30, .34, .40) * rim * (.35 + .65 * sky);
  lit += vec3(.10) * pow(max(dot(n, normalize(lamp + view)), 0.), 40.);
  pixel = vec4(lit * mix(.8, 1., smoothstep(0., .25, place.y)), 1);
}`;

const SHADOW_VERTEX = `#version 300 es
layout(location=0) in vec2 corner;
layout(location=1) in vec3 start;
layout(location=2) in vec4 end;
uniform vec3 area;
out vec2 place;
flat out vec4 line;
flat out vec3 size;
void main() {
  vec2 a = start.xz + start.y * ${SLANT}, b = end.xz + end.y * ${SLANT};
  float reach = end.w + .05 + .3 * max(start.y, end.y);
  vec2 axis = b - a;
  vec2 x = length(axis) > 1e-4 ? normalize(axis) : vec2(1, 0);
  place = mix(a, b, step(0., corner.x)) + (x * corner.x + vec2(-x.y, x.x) * corner.y) * reach;
  line = vec4(a, b);
  size = vec3(start.y, end.y, end.w);
  gl_Position = vec4((place - area.xy) / area.z, 0, 1);
}`;

const SHADOW_FRAGMENT = `#version 300 es
precision highp float;
in vec2 place;
flat in vec4 line;
flat in vec3 size;
out vec4 pixel;
void main() {
  vec2 axis = line.zw - line.xy, from = place - line.xy;
  float t = clamp(dot(from, axis) / max(dot(axis, axis), 1e-6), 0., 1.);
  float height = max(mix(size.x, size.y, t), 0.);
  float blur = .03 + .28 * height;
  float apart = length(from - axis * t) - size.z;
  float dark = 1. - smoothstep(-.5 * blur - .01, blur, apart);
  // A higher part is a smaller share of the sky: fainter.
  pixel = vec4(dark * exp(-1.5 * height) * size.z / (size.z + .1 * height));
}`;

const FLOOR_VERTEX = `#version 300 es
layout(location=0) in vec2 corner;
uniform mat4 camera;
uniform vec3 middle;
out vec2 place;
void main() {
  place = middle.xy + corner * middle.z;
  gl_Position = camera * vec4(place.x, 0, place.y, 1);
}`;

const FLOOR_FRAGMENT = `#version 300 es
precision highp float;
in vec2 place;
uniform vec3 middle, area, ground, lines;
uniform sampler2D shadows;
out vec4 pixel;
float grid(float step) {
  vec2 at = place / step, wide = fwidth(at);
  vec2 near = abs(fract(at - .5) - .5) / wide;
  return (1. - min(min(near.x, near.y), 1.)) * (1. - smoothstep(.2, .6, max(wide.x, wide.y)));
}
void main() {
  float fade = 1. - smoothstep(.15, 1., length(place - middle.xy) / middle.z);
  fade *= fade;
  vec2 inside = (place - area.xy) / area.z * .5 + .5;
  float dark = all(equal(inside, clamp(inside, 0., 1.))) ? texture(shadows, inside).r : 0.;
  float line = max(grid(.5) * .35, grid(1.) * .75);
  vec4 colour = vec4(mix(ground, lines, line), 1) * fade * mix(.75, 1., line);
  dark *= .7;
  pixel = vec4(colour.rgb * (1. - dark), colour.a + (1. - colour.a) * dark);
}`;

/** A sphere in two halves, `(x, y, z, which end)`, as strips of triangles. */
function capsuleShape(rings, sides) {
  const vertices = [];
  const point = (ring, side) => {
    const end = ring > rings / 2 ? 1 : 0;
    const polar = ((ring - end) / (rings - 1) - 0.5) * Math.PI;
    const turn = (side / sides) * 2 * Math.PI;
    vertices.push(Math.cos(polar) * Math.cos(turn), Math.sin(polar), Math.cos(polar) * Math.sin(turn), end);
  };
  for (let ring = 0; ring < rings; ring++) {
    for (let side = 0; side < sides; side++) {
      for (const [r, s] of [[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]]) point(ring + r, side + s);
    }
  }
  return new Float32Array(vertices);
}

function rgb(colour) {
  return [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16) / 255);
}

/**
 * Bodies over a floor, in WebGL 2. `failure` says why nothing can be drawn.
 * A body is `{pose: Float32Array(points × 3) metres with NaN for missing, figure, faint: 0…1}`.
 */
export class Stage {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {boolean} keep whether drawn pixels can be read later
   * @param {function(): void} stale called when what was drawn is gone or outdated
   */
  constructor(canvas, keep, stale) {
    this.canvas = canvas;
    this.failure = null;
    this.gl = canvas.getContext('webgl2', { antialias: true, preserveDrawingBuffer: keep });
    if (!this.gl) {
      this.failure = 'This browser has no WebGL 2, so motion cannot be played here. Pictures and tables still work.';
      return;
    }
    this.#build();
    canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      this.failure = 'The graphics card was taken away. Playback returns with it.';
      stale();
    });
    canvas.addEventListener('webglcontextrestored', () => {
      this.failure = null;
      this.#build();
      stale();
    });
    new ResizeObserver(stale).observe(canvas);
    onTheme(() => {
      this.#paint();
      stale();
    });
  }

  #build() {
    const gl = this.gl;
    this.bones = this.#program(BONE_VERTEX, BONE_FRAGMENT);
    this.shade = this.#program(SHADOW_VERTEX, SHADOW_FRAGMENT);
    this.floor = this.#program(FLOOR_VERTEX, FLOOR_FRAGMENT);
    const upload = (data) => {
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
      return buffer;
    };
    const shape = capsuleShape(13, 18);
    this.vertices = shape.length / 4;
    this.instances = gl.createBuffer();
    this.room = 0;
    const quad = upload(new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]));
    this.capsules = this.#array(upload(shape), 4, true);
    this.splats = this.#array(quad, 2, true);
    this.square = this.#array(quad, 2, false);
    this.texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, SHADOW_SIZE, SHADOW_SIZE);
    for (const name of ['MIN_FILTER', 'MAG_FILTER']) gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}`], gl.LINEAR);
    this.target = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.texture, 0);
    this.#paint();
  }

  #paint() {
    this.colours = Object.fromEntries(Object.entries(palette()).map(([name, colour]) => [name, rgb(colour)]));
  }

  /** A program, with its uniforms' places by name. */
  #program(vertex, fragment) {
    const gl = this.gl;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
      this.failure = `The shaders were refused: ${gl.getProgramInfoLog(program)}`;
    }
    const at = {};
    for (let k = 0; k < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); k++) {
      const { name } = gl.getActiveUniform(program, k);
      at[name] = gl.getUniformLocation(program, name);
    }
    return { program, at };
  }

  #array(buffer, size, instanced) {
    const gl = this.gl;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const attribute = (place, length, stride, offset) => {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, length, gl.FLOAT, false, stride, offset);
    };
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    attribute(0, size, 0, 0);
    if (instanced) {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.instances);
      [[1, 3, 0], [2, 4, 12], [3, 4, 28]].forEach(([place, length, offset]) => {
        attribute(place, length, PER_BONE * 4, offset);
        gl.vertexAttribDivisor(place, 1);
      });
    }
    return array;
  }

  /** Bones of which both ends are there, and the square on the floor that their shadows fall on. */
  #collect(bodies) {
    const bones = [];
    const low = [Infinity, Infinity];
    const high = [-Infinity, -Infinity];
    for (const { pose, figure, faint } of bodies) {
      for (const { from, to, side, width } of figure.bones) {
        const [a, b] = [from * 3, to * 3];
        if (Number.isNaN(pose[a] + pose[b])) continue;
        bones.push(pose[a], pose[a + 1], pose[a + 2], pose[b], pose[b + 1], pose[b + 2], width / 2000, ...this.colours[side], faint);
        for (const k of [0, 1]) {
          low[k] = Math.min(low[k], pose[a + 2 * k], pose[b + 2 * k]);
          high[k] = Math.max(high[k], pose[a + 2 * k], pose[b + 2 * k]);
        }
      }
    }
    const half = Math.max(high[0] - low[0], high[1] - low[1], 0) / 2 + 1;
    return { bones: new Float32Array(bones), area: bones.length ? [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, half] : [0, 0, 1] };
  }

  /**
   * Draws views side by side, each `{bodies, target}`.
   * @param {import('./camera.js').Camera} camera
   */
  draw(views, camera) {
    const { gl, canvas } = this;
    if (this.failure || !canvas.clientWidth) return;
    const sharp = Math.min(devicePixelRatio || 1, 2);
    const [width, height] = [Math.round(canvas.clientWidth * sharp), Math.round(canvas.clientHeight * sharp)];
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const share = width / views.length;
    views.forEach(({ bodies, target }, k) => {
      const left = Math.round(k * share);
      this.#view(bodies, target, camera, [left, 0, Math.round((k + 1) * share) - left, height]);
    });
  }

  #view(bodies, target, camera, box) {
    const { gl } = this;
    const { bones, area } = this.#collect(bodies);
    const n = bones.length / PER_BONE;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.instances);
    gl.bufferData(gl.ARRAY_BUFFER, bones, gl.DYNAMIC_DRAW);

    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.disable(gl.SCISSOR_TEST);
    gl.disable(gl.DEPTH_TEST);
    gl.viewport(0, 0, SHADOW_SIZE, SHADOW_SIZE);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.BLEND);
    // The darkest wins: where limbs meet the floor is not darkened twice.
    gl.blendEquation(gl.MAX);
    gl.useProgram(this.shade.program);
    gl.uniform3fv(this.shade.at.area, area);
    gl.bindVertexArray(this.splats);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, n);

    const { matrix, eye, far } = camera.look(target, box[2] / box[3]);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(...box);
    gl.viewport(...box);
    gl.blendEquation(gl.FUNC_ADD);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.useProgram(this.floor.program);
    gl.uniformMatrix4fv(this.floor.at.camera, false, matrix);
    gl.uniform3f(this.floor.at.middle, target[0], target[2], far * 1.5 + 2);
    gl.uniform3fv(this.floor.at.area, area);
    gl.uniform3fv(this.floor.at.ground, this.colours.ground);
    gl.uniform3fv(this.floor.at.lines, this.colours.grid);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.bindVertexArray(this.square);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);

    gl.disable(gl.BLEND);
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(this.bones.program);
    gl.uniformMatrix4fv(this.bones.at.camera, false, matrix);
    gl.uniform3fv(this.bones.at.eye, eye);
    gl.bindVertexArray(this.capsules);
    gl.drawArraysInstanced(gl.TRIANGLES, 0, this.vertices, n);
  }
}
