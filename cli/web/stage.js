import {palette, onTheme} from './strip.js';

/** Corners of a capsule of 13 rings and 18 sides, as one strip of triangles, see `BONE_VERTEX`. */
const CAPSULE = 13 * 38;

const HEAD = `#version 300 es
precision highp float;
uniform mat4 camera;
uniform vec3 eye, middle, ground, lines;
`;
const VERTEX_HEAD = `${HEAD}
// The end has the radius beside it, the colour how striped it is.
layout(location=0) in vec4 start;
layout(location=1) in vec4 end;
layout(location=2) in vec4 colour;
`;

// A sphere whose upper half is moved to the end of the bone.
const BONE_VERTEX = `
out vec3 normal, place;
out vec4 tint;
out float along;
void main() {
	ivec2 at = ivec2(gl_VertexID / 38 + gl_VertexID % 2, gl_VertexID % 38 / 2);
	float upper = at.x > 6 ? 1. : 0.;
	float polar = ((float(at.x) - upper) / 12. - .5) * 3.14159265, turn = float(at.y) / 9. * 3.14159265;
	vec3 axis = (end - start).xyz;
	float size = length(axis);
	vec3 y = size > 1e-5 ? axis / size : vec3(0, 1, 0);
	vec3 x = normalize(cross(y, abs(y.y) < .9 ? vec3(0, 1, 0) : vec3(1, 0, 0)));
	normal = y * sin(polar) + (x * cos(turn) + cross(x, y) * sin(turn)) * cos(polar);
	place = mix(start, end, upper).xyz + normal * end.w;
	along = upper * size + sin(polar) * end.w;
	tint = colour;
	gl_Position = camera * vec4(place, 1);
}`;

const BONE_FRAGMENT = `
in vec3 normal, place;
in vec4 tint;
in float along;
out vec4 pixel;
void main() {
	vec3 n = normalize(normal), view = normalize(eye - place);
	vec3 lamp = normalize(cross(vec3(.001, 1, 0), view) * .5 + view * .55 + vec3(0, 1, 0));
	float soft = fwidth(along) * 40., sky = n.y * .5 + .5;
	float band = smoothstep(.5 - soft, .5 + soft, abs(fract(along * 20.) - .5) * 2.);
	vec3 base = mix(tint.rgb, vec3(1), tint.w * mix(.25, .72, band));
	vec3 lit = base * (.38 + .34 * sky + .5 * max(dot(n, lamp), 0.));
	pixel = vec4(lit + .2 * pow(1. - max(dot(n, view), 0.), 3.) * sky, 1);
}`;

const SHADOW_VERTEX = `
out vec2 place;
flat out vec4 from, to;
void main() {
	vec2 corner = vec2(gl_VertexID % 2, gl_VertexID / 2) * 2. - 1., axis = end.xz - start.xz;
	vec2 x = length(axis) > 1e-4 ? normalize(axis) : vec2(1, 0);
	float reach = end.w + .05 + .3 * max(start.y, end.y);
	place = (corner.x < 0. ? start.xz : end.xz) + (x * corner.x + vec2(-x.y, x.x) * corner.y) * reach;
	from = start;
	to = end;
	gl_Position = camera * vec4(place.x, 0, place.y, 1);
}`;

// The higher a part, the softer and fainter. Only alpha is written.
const SHADOW_FRAGMENT = `
in vec2 place;
flat in vec4 from, to;
out vec4 pixel;
void main() {
	vec2 axis = to.xz - from.xz, here = place - from.xz;
	float t = clamp(dot(here, axis) / max(dot(axis, axis), 1e-6), 0., 1.);
	float height = max(mix(from.y, to.y, t), 0.), blur = .03 + .28 * height;
	float dark = 1. - smoothstep(-.5 * blur - .01, blur, length(here - axis * t) - to.w);
	pixel = vec4(0, 0, 0, .7 * dark * exp(-1.5 * height) * to.w / (to.w + .1 * height));
}`;

const FLOOR_VERTEX = `
out vec2 place;
void main() {
	place = middle.xy + (vec2(gl_VertexID % 2, gl_VertexID / 2) * 2. - 1.) * middle.z;
	gl_Position = camera * vec4(place.x, 0, place.y, 1);
}`;

const FLOOR_FRAGMENT = `
in vec2 place;
out vec4 pixel;
float grid(float step) {
	vec2 at = place / step, wide = fwidth(at), near = abs(fract(at - .5) - .5) / wide;
	return (1. - min(min(near.x, near.y), 1.)) * (1. - smoothstep(.2, .6, max(wide.x, wide.y)));
}
void main() {
	float fade = 1. - smoothstep(.15, 1., length(place - middle.xy) / middle.z);
	float line = max(grid(.5) * .35, grid(1.) * .75);
	pixel = vec4(mix(ground, lines, line), 1) * fade * fade * mix(.75, 1., line);
}`;

const rgb = (colour) => [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16) / 255);

/**
 * Bodies over a floor, in WebGL 2; `failure` says why nothing can be drawn. A body is `{pose, figure, stripes}`: points in
 * metres, null for a missing one, and how striped it is, 0 to 1.
 */
export class Stage {
	/** `keep`: whether drawn pixels can be read later; `stale()` is called when what was drawn is outdated. */
	constructor(canvas, keep, stale) {
		const gl = this.gl = canvas.getContext('webgl2', {preserveDrawingBuffer: keep});
		if (!gl) {
			this.failure = 'Motion cannot be played: this browser has no WebGL 2.';
			return;
		}
		this.bones = this.#program(BONE_VERTEX, BONE_FRAGMENT);
		this.shadows = this.#program(SHADOW_VERTEX, SHADOW_FRAGMENT);
		this.floor = this.#program(FLOOR_VERTEX, FLOOR_FRAGMENT);
		gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
		for (const place of [0, 1, 2]) {
			gl.enableVertexAttribArray(place);
			gl.vertexAttribPointer(place, 4, gl.FLOAT, false, 48, place * 16);
			gl.vertexAttribDivisor(place, 1);
		}
		// The floor is darkened by the alpha that the shadows left.
		gl.blendFuncSeparate(gl.ONE_MINUS_DST_ALPHA, gl.ZERO, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
		new ResizeObserver(stale).observe(canvas);
		onTheme(stale);
	}

	#program(...texts) {
		const {gl} = this;
		const program = gl.createProgram();
		texts.forEach((text, k) => {
			const shader = gl.createShader(k ? gl.FRAGMENT_SHADER : gl.VERTEX_SHADER);
			gl.shaderSource(shader, (k ? HEAD : VERTEX_HEAD) + text);
			gl.compileShader(shader);
			gl.attachShader(program, shader);
		});
		gl.linkProgram(program);
		if (!gl.getProgramParameter(program, gl.LINK_STATUS)) this.failure = `A shader was refused: ${gl.getProgramInfoLog(program)}`;
		return program;
	}

	/** Draws views side by side, each `{bodies, target}`. */
	draw(views, camera) {
		const {gl} = this;
		if (this.failure || !gl.canvas.clientWidth) return;
		const {canvas} = gl;
		const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((size) => Math.round(size * Math.min(devicePixelRatio, 2)));
		if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, {width, height});
		gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
		const {ground, grid: lines, ...sides} = palette(rgb);
		views.forEach(({bodies, target}, k) => {
			const wide = width / views.length;
			gl.viewport(Math.round(k * wide), 0, Math.round(wide), height);
			const {matrix, eye, far} = camera.look(target, wide / height);
			const middle = [target[0], target[2], far * 1.5 + 2];
			const bones = bodies.flatMap(({pose, figure, stripes}) => figure.bones
				.filter(({from, to}) => pose[from] && pose[to])
				.map(({from, to, side, width}) => [...pose[from], 0, ...pose[to], width / 2000, ...sides[side], stripes]));
			gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(bones.flat()), gl.DYNAMIC_DRAW);
			const run = (program, corners, copies) => {
				const at = (name) => gl.getUniformLocation(program, name);
				gl.useProgram(program);
				gl.uniformMatrix4fv(at('camera'), false, matrix);
				for (const [name, value] of Object.entries({eye, middle, ground, lines})) gl.uniform3fv(at(name), value);
				gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, corners, copies);
			};
			gl.disable(gl.DEPTH_TEST);
			gl.enable(gl.BLEND);
			// The darkest wins: where limbs meet the floor is not darkened twice.
			gl.blendEquation(gl.MAX);
			run(this.shadows, 4, bones.length);
			gl.blendEquation(gl.FUNC_ADD);
			run(this.floor, 4, 1);
			gl.disable(gl.BLEND);
			gl.enable(gl.DEPTH_TEST);
			run(this.bones, CAPSULE, bones.length);
		});
	}
}
