import {palette, onTheme} from './strip.js';

/** Numbers per bone: start, end, radius, colour, stripes. */
const PER_BONE = 11;
/** Triangles' corners of a capsule of 13 rings and 18 sides, see `BONE_VERTEX`. */
const CAPSULE = 13 * 18 * 6;
/** Pixels of a side of the shadows' texture. */
const SHADOW_SIZE = 512;

const HEAD = '#version 300 es\nprecision highp float;\n';
const CORNERS = `const ivec2 CORNERS[6] = ivec2[](ivec2(0), ivec2(1, 0), ivec2(1), ivec2(0), ivec2(1), ivec2(0, 1));
`;
const BONE_INPUT = `${HEAD}${CORNERS}
layout(location=0) in vec3 start;
layout(location=1) in vec4 end;
layout(location=2) in vec4 colour;
`;

// A sphere whose upper half is moved to the end of the bone.
const BONE_VERTEX = `${BONE_INPUT}
uniform mat4 camera;
out vec3 normal, place, tint;
out float along, stripes;
void main() {
  ivec2 at = ivec2(gl_VertexID / 108, gl_VertexID / 6 % 18) + CORNERS[gl_VertexID % 6];
  float upper = at.x > 6 ? 1. : 0.;
  float polar = ((float(at.x) - upper) / 12. - .5) * 3.14159265, turn = float(at.y) / 9. * 3.14159265;
  vec3 axis = end.xyz - start;
  float size = length(axis);
  vec3 y = size > 1e-5 ? axis / size : vec3(0, 1, 0);
  vec3 x = normalize(cross(y, abs(y.y) < .9 ? vec3(0, 1, 0) : vec3(1, 0, 0)));
  normal = y * sin(polar) + (x * cos(turn) + cross(x, y) * sin(turn)) * cos(polar);
  place = mix(start, end.xyz, upper) + normal * end.w;
  along = upper * size + sin(polar) * end.w;
  tint = colour.rgb;
  stripes = colour.w;
  gl_Position = camera * vec4(place, 1);
}`;

const BONE_FRAGMENT = `${HEAD}
in vec3 normal, place, tint;
in float along, stripes;
uniform vec3 eye;
out vec4 pixel;
void main() {
  vec3 n = normalize(normal), view = normalize(eye - place);
  vec3 lamp = normalize(cross(vec3(.001, 1, 0), view) * .5 + view * .55 + vec3(0, 1, 0));
  float soft = fwidth(along) * 40.;
  float band = smoothstep(.5 - soft, .5 + soft, abs(fract(along * 20.) - .5) * 2.);
  vec3 base = mix(tint, vec3(1), stripes * mix(.25, .72, band));
  float sky = n.y * .5 + .5;
  vec3 lit = base * (.38 + .34 * sky + .5 * max(dot(n, lamp), 0.));
  lit += vec3(.3, .34, .4) * pow(1. - max(dot(n, view), 0.), 3.) * (.35 + .65 * sky);
  pixel = vec4(lit * mix(.8, 1., smoothstep(0., .25, place.y)), 1);
}`;

const SHADOW_VERTEX = `${BONE_INPUT}
uniform vec3 area;
out vec2 place;
flat out vec4 line;
flat out vec3 size;
void main() {
  vec2 corner = vec2(CORNERS[gl_VertexID]) * 2. - 1., axis = end.xz - start.xz;
  vec2 x = length(axis) > 1e-4 ? normalize(axis) : vec2(1, 0);
  float reach = end.w + .05 + .3 * max(start.y, end.y);
  place = (corner.x < 0. ? start.xz : end.xz) + (x * corner.x + vec2(-x.y, x.x) * corner.y) * reach;
  line = vec4(start.xz, end.xz);
  size = vec3(start.y, end.y, end.w);
  gl_Position = vec4((place - area.xy) / area.z, 0, 1);
}`;

// The higher a part, the softer and fainter.
const SHADOW_FRAGMENT = `${HEAD}
in vec2 place;
flat in vec4 line;
flat in vec3 size;
out vec4 pixel;
void main() {
  vec2 axis = line.zw - line.xy, from = place - line.xy;
  float t = clamp(dot(from, axis) / max(dot(axis, axis), 1e-6), 0., 1.);
  float height = max(mix(size.x, size.y, t), 0.), blur = .03 + .28 * height;
  float dark = 1. - smoothstep(-.5 * blur - .01, blur, length(from - axis * t) - size.z);
  pixel = vec4(dark * exp(-1.5 * height) * size.z / (size.z + .1 * height));
}`;

const FLOOR_VERTEX = `${HEAD}${CORNERS}
uniform mat4 camera;
uniform vec3 middle;
out vec2 place;
void main() {
  place = middle.xy + (vec2(CORNERS[gl_VertexID]) * 2. - 1.) * middle.z;
  gl_Position = camera * vec4(place.x, 0, place.y, 1);
}`;

const FLOOR_FRAGMENT = `${HEAD}
in vec2 place;
uniform vec3 middle, area, ground, lines;
uniform sampler2D shadows;
out vec4 pixel;
float grid(float step) {
  vec2 at = place / step, wide = fwidth(at), near = abs(fract(at - .5) - .5) / wide;
  return (1. - min(min(near.x, near.y), 1.)) * (1. - smoothstep(.2, .6, max(wide.x, wide.y)));
}
void main() {
  float fade = 1. - smoothstep(.15, 1., length(place - middle.xy) / middle.z);
  vec2 inside = (place - area.xy) / area.z * .5 + .5;
  float dark = inside == clamp(inside, 0., 1.) ? texture(shadows, inside).r * .7 : 0.;
  float line = max(grid(.5) * .35, grid(1.) * .75);
  vec4 colour = vec4(mix(ground, lines, line), 1) * fade * fade * mix(.75, 1., line);
  pixel = vec4(colour.rgb * (1. - dark), colour.a + (1. - colour.a) * dark);
}`;

const rgb = (colour) => [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16) / 255);

/**
 * Bodies over a floor, in WebGL 2; `failure` says why nothing can be drawn. A body is `{pose, figure, stripes}`: metres,
 * `(points, 3)`, NaN for a missing point, and how striped it is, 0 to 1.
 */
export class Stage {
  /** `keep`: whether drawn pixels can be read later; `stale()` is called when what was drawn is gone or outdated. */
  constructor(canvas, keep, stale) {
    this.canvas = canvas;
    this.gl = canvas.getContext('webgl2', {preserveDrawingBuffer: keep});
    this.failure = 'This browser has no WebGL 2, so motion cannot be played here. Pictures and tables still work.';
    if (!this.gl) return;
    this.#build();
    canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      this.failure = 'The graphics card was taken away. Playback returns with it.';
      stale();
    });
    canvas.addEventListener('webglcontextrestored', () => {
      this.#build();
      stale();
    });
    new ResizeObserver(stale).observe(canvas);
    onTheme(stale);
  }

  #build() {
    const {gl} = this;
    this.failure = null;
    this.bones = this.#program(BONE_VERTEX, BONE_FRAGMENT);
    this.shade = this.#program(SHADOW_VERTEX, SHADOW_FRAGMENT);
    this.floor = this.#program(FLOOR_VERTEX, FLOOR_FRAGMENT);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    for (const [place, size, offset] of [[0, 3, 0], [1, 4, 12], [2, 4, 28]]) {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, PER_BONE * 4, offset);
      gl.vertexAttribDivisor(place, 1);
    }
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, SHADOW_SIZE, SHADOW_SIZE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    this.shadows = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadows);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  #program(vertex, fragment) {
    const {gl} = this;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
      this.failure = `The graphics card refused a shader: ${gl.getProgramInfoLog(program)}`;
    }
    return program;
  }

  #use(program, uniforms) {
    const {gl} = this;
    gl.useProgram(program);
    for (const [name, value] of Object.entries(uniforms)) {
      const at = gl.getUniformLocation(program, name);
      if (name === 'camera') gl.uniformMatrix4fv(at, false, value);
      else gl.uniform3fv(at, value);
    }
  }

  /** Bones of which both ends are there, and the square of the floor below them: its middle and half its side. */
  #collect(bodies, colours) {
    const [bones, xs, zs] = [[], [], []];
    for (const {pose, figure, stripes} of bodies) {
      for (const {from, to, side, width} of figure.bones) {
        const ends = [...pose.subarray(from * 3, from * 3 + 3), ...pose.subarray(to * 3, to * 3 + 3)];
        if (ends.some(Number.isNaN)) continue;
        bones.push(...ends, width / 2000, ...colours[side], stripes);
        xs.push(ends[0], ends[3]);
        zs.push(ends[2], ends[5]);
      }
    }
    const spans = [xs, zs].map((all) => (all.length ? [Math.min(...all), Math.max(...all)] : [0, 0]));
    const half = Math.max(...spans.map(([low, high]) => high - low)) / 2 + 1;
    return {bones: new Float32Array(bones), area: [...spans.map(([low, high]) => (low + high) / 2), half]};
  }

  /** Draws views side by side, each `{bodies, target}`. */
  draw(views, camera) {
    const {gl, canvas} = this;
    if (this.failure || !canvas.clientWidth) return;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((size) => Math.round(size * Math.min(devicePixelRatio, 2)));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, {width, height});
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const colours = Object.fromEntries(Object.entries(palette()).map(([name, colour]) => [name, rgb(colour)]));
    views.forEach((view, k) => {
      const [left, right] = [k, k + 1].map((n) => Math.round((n * width) / views.length));
      this.#view(view, camera, colours, [left, 0, right - left, height]);
    });
  }

  #view({bodies, target}, camera, colours, box) {
    const {gl} = this;
    const {bones, area} = this.#collect(bodies, colours);
    const count = bones.length / PER_BONE;
    gl.bufferData(gl.ARRAY_BUFFER, bones, gl.DYNAMIC_DRAW);

    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadows);
    gl.disable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.viewport(0, 0, SHADOW_SIZE, SHADOW_SIZE);
    gl.clear(gl.COLOR_BUFFER_BIT);
    // The darkest wins: where limbs meet the floor is not darkened twice.
    gl.blendEquation(gl.MAX);
    this.#use(this.shade, {area});
    gl.drawArraysInstanced(gl.TRIANGLES, 0, 6, count);

    const {matrix, eye, far} = camera.look(target, box[2] / box[3]);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(...box);
    gl.blendEquation(gl.FUNC_ADD);
    const middle = [target[0], target[2], far * 1.5 + 2];
    this.#use(this.floor, {camera: matrix, middle, area, ground: colours.ground, lines: colours.grid});
    gl.drawArrays(gl.TRIANGLES, 0, 6);

    gl.disable(gl.BLEND);
    gl.enable(gl.DEPTH_TEST);
    this.#use(this.bones, {camera: matrix, eye});
    gl.drawArraysInstanced(gl.TRIANGLES, 0, CAPSULE, count);
  }
}
