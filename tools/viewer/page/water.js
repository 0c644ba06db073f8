// The water: its particles as points, and its surface as a height field over a grid, coloured by depth or speed.

import * as THREE from 'three';
import { hasFall } from './ground.js';
import { Grid } from './site.js';

// Cividis and a blue scale: both rise in lightness throughout, for the colour-blind and for print.
const SCALES = {
  depth: ['#e4f2fb', '#b3d6ec', '#74b0d8', '#3f86bf', '#1f5f9e', '#123f7a', '#0a2650'],
  speed: ['#00224e', '#35456c', '#666970', '#948e77', '#c8b866', '#fee838', '#fff6b8'],
};
const FALL_ROWS = 14, FALL_STEP_S = 0.105;

export function scaleColours(mode) {
  return SCALES[mode === 'speed' ? 'speed' : 'depth'];
}

/** A round number at or above a value. */
export function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(Math.max(value, 1e-3)));
  return [1, 1.5, 2, 3, 5, 7.5, 10].find((step) => step * power >= value * 0.999) * power;
}

// Interpolated in sRGB, as the gradient of the legend is, so that a colour of the water is one of the legend.
function paletteTexture() {
  const data = new Uint8Array(2 * 256 * 4);
  ['depth', 'speed'].forEach((mode, row) => {
    const colours = SCALES[mode].map((c) => [1, 3, 5].map((k) => parseInt(c.slice(k, k + 2), 16)));
    for (let k = 0; k < 256; ++k) {
      const at = (k / 255) * (colours.length - 1), low = Math.min(Math.floor(at), colours.length - 2);
      data.set([...colours[low].map((c, axis) => Math.round(c + (at - low) * (colours[low + 1][axis] - c))), 255], 4 * (row * 256 + k));
    }
  });
  const texture = new THREE.DataTexture(data, 256, 2);
  texture.magFilter = texture.minFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

const NOISE = `
  float hash(vec2 p) { p = fract(p * vec2(123.34, 345.45)); p += dot(p, p + 34.345); return fract(p.x * p.y); }
  float noise(vec2 p) { vec2 i = floor(p), f = fract(p); f = f * f * (3. - 2. * f);
    return mix(mix(hash(i), hash(i + vec2(1, 0)), f.x), mix(hash(i + vec2(0, 1)), hash(i + vec2(1, 1)), f.x), f.y); }
  float waves(vec2 p) { return .5 * noise(p) + .3 * noise(p * 2.13 + 7.1) + .2 * noise(p * 4.7 + 3.3); }`;

const SURFACE_VERTEX = `
  attribute vec4 state; // depth, slope x, slope z, foam
  attribute vec3 stream; // vx, vz, side
  varying vec3 at; varying vec4 s; varying vec3 w; varying float fogDepth;
  void main() { s = state; w = stream; vec4 p = modelMatrix * vec4(position, 1.); at = p.xyz;
    vec4 v = viewMatrix * p; fogDepth = -v.z; gl_Position = projectionMatrix * v; }`;

const SURFACE_FRAGMENT = `
  varying vec3 at; varying vec4 s; varying vec3 w; varying float fogDepth;
  uniform float time, mode, full; uniform sampler2D palette; uniform vec3 sky, horizon, sun, sunColour; uniform float light;
  ${NOISE}
  // Ripples go with the stream, in two phases that fade into one another.
  vec3 ripples(vec2 p, vec2 v) {
    vec3 sum = vec3(0.); float e = .04;
    for (int k = 0; k < 2; ++k) {
      float t = fract(time * .35 + .5 * float(k)), weight = 1. - abs(2. * t - 1.);
      vec2 q = (p - v * (t - .5) / .35 * .8) * 1.15 + 17. * float(k);
      float h = waves(q);
      sum += weight * vec3(waves(q + vec2(e, 0)) - h, h, waves(q + vec2(0, e)) - h) / vec3(e, 1., e);
    }
    return sum;
  }
  void main() {
    if (s.x < .012) discard;
    vec2 v = vec2(w.x, -w.y); float speed = length(v);
    if (mode > .5) { // data: the colour of the legend, without light, haze, foam or what lies below
      gl_FragColor = vec4(texture2D(palette, vec2(clamp((mode < 1.5 ? s.x : speed) / full, 0., 1.) * .99609375 + .001953125, mode < 1.5 ? .25 : .75)).rgb, 1.);
      return;
    }
    vec3 r = ripples(at.xz, v);
    float rough = .045 + .05 * min(speed, 3.);
    vec3 n = w.z > .5 ? vec3(0, 0, 1) : normalize(vec3(-s.y - rough * r.x, 1., s.z - rough * r.z));
    vec3 eye = normalize(cameraPosition - at);
    if (!gl_FrontFacing && w.z < .5) n = -n;
    float facing = clamp(abs(dot(n, eye)), 0., 1.);
    float fresnel = .02 + .98 * pow(1. - facing, 5.);
    vec3 up = reflect(-eye, n);
    vec3 mirror = mix(horizon, sky, pow(clamp(up.y, 0., 1.), .6));
    vec3 body = mix(vec3(.21, .47, .47), vec3(.012, .15, .25), 1. - exp(-1.3 * s.x));
    float lit = .62 + .5 * max(0., dot(n, sun));
    vec3 colour = body * lit * light;
    float alpha = mix(.38, .86, 1. - exp(-1.1 * s.x));
    colour = mix(colour, mirror, w.z > .5 ? .06 : fresnel * .8);
    float glint = pow(max(0., dot(up, sun)), 180.) * 1.6;
    colour += sunColour * glint * light * (w.z > .5 ? 0. : 1.);
    float foam = clamp(s.w, 0., 1.);
    float patchy = smoothstep(.62 - .45 * foam, .8 - .3 * foam, r.y + .12 * noise(at.xz * 9. - v * time * .5));
    float white = foam * patchy * .85;
    colour = mix(colour, vec3(.93, .97, .98) * light, white);
    alpha = max(alpha, white) * smoothstep(.012, .09, s.x);
    alpha = mix(alpha, 1., w.z > .5 ? 0. : fresnel * .5);
    if (w.z > .5) alpha *= .8;
    float haze = 1. - exp(-pow(fogDepth / 420., 2.));
    gl_FragColor = vec4(mix(colour, horizon, haze), alpha);
    #include <colorspace_fragment>
  }`;

const POINT_VERTEX = `
  attribute float px, py, pz, value; varying float v; uniform float size, full, scale;
  void main() { v = clamp(value / full, 0., 1.); vec4 p = modelViewMatrix * vec4(px, py, -pz, 1.);
    gl_Position = projectionMatrix * p; gl_PointSize = max(1.5, projectionMatrix[3][3] > .5 ? size * projectionMatrix[1][1] * scale : size * projectionMatrix[1][1] * scale / -p.z); }`;

const POINT_FRAGMENT = `
  varying float v; uniform sampler2D palette; uniform float row, light, mode;
  void main() { vec2 d = 2. * gl_PointCoord - 1.; float r = dot(d, d); if (r > 1.) discard;
    if (mode > .5) { gl_FragColor = vec4(texture2D(palette, vec2(v * .99609375 + .001953125, row)).rgb, 1.); return; }
    float shade = .72 + .38 * dot(normalize(vec3(d.x, -d.y, sqrt(1. - r))), normalize(vec3(.4, .8, .45)));
    gl_FragColor = vec4(vec3(.05, .23, .42) * shade * light, 1.);
    #include <colorspace_fragment>
  }`;

export class Water {
  /** ground: of a site, else null; gates: with lines and opening times, s; null for flood walls. */
  constructor(parent, scene, bounds, ground, gates = []) {
    this.scene = scene;
    this.ground = ground;
    this.most = { depth: 0, speed: 0 }; // of what was shown so far
    this.gates = gates;
    this.isBeyond = false; // a point has a speed above the last colour
    this.hasVelocity = true; // of the water that is shown
    this.inColumns = Boolean(ground) && scene.fluid.model !== 'dfsph'; // the particles of a message are columns as wide as cells
    this.spacing = (this.inColumns ? scene.fluid.shallow_water.cell_size_m : scene?.fluid?.particle_spacing_m) ?? bounds?.spacing ?? 0.5;
    const c = scene?.channel ?? bounds;
    const area = (c.x_max_m - c.x_min_m) * (c.z_max_m - c.z_min_m);
    const cell = Math.max((this.inColumns ? 1 : 0.72) * this.spacing, Math.sqrt(area / (ground ? 90000 : 40000)), 0.02);
    this.grid = new Grid(c.x_min_m, c.x_max_m, c.z_min_m, c.z_max_m, cell, ground ? (x, z) => ground.at(x, z) : undefined);
    this.fall = scene && hasFall(scene);
    this.gravity = scene?.world?.gravity_m_s2 ?? 9.81;
    this.stream = scene?.channel?.velocity_m_s ?? 0;
    this.uniforms = {
      time: { value: 0 }, mode: { value: 0 }, full: { value: 1 }, palette: { value: paletteTexture() }, light: { value: 1 },
      sky: { value: new THREE.Color() }, horizon: { value: new THREE.Color() }, sun: { value: new THREE.Vector3(0.4, 0.8, 0.45).normalize() },
      sunColour: { value: new THREE.Color('#fff3dd') },
    };
    this.mode = 'clear'; // clear, depth, speed
    this.makeSurface(parent);
    this.makePoints(parent);
    this.as('surface');
    this.bytes = 0; // sent to the graphics card by the last frame
  }

  makeSurface(parent) {
    const { nx, nz } = this.grid, extra = this.fall ? FALL_ROWS : 0, columns = nx + extra, skirt = 2 * (2 * nx + nz);
    this.rowLength = columns; // vertices of a row of the sheet
    const count = columns * nz + skirt;
    this.even = new Float32Array(nx * nz); // depths of the surface as it is drawn
    const geometry = new THREE.BufferGeometry();
    const buffer = (size) => new THREE.BufferAttribute(new Float32Array(size * count), size).setUsage(THREE.DynamicDrawUsage);
    geometry.setAttribute('position', buffer(3));
    geometry.setAttribute('state', buffer(4));
    geometry.setAttribute('stream', buffer(3));
    const material = new THREE.ShaderMaterial({
      uniforms: this.uniforms, vertexShader: SURFACE_VERTEX, fragmentShader: SURFACE_FRAGMENT, transparent: true, side: THREE.DoubleSide,
    });
    this.surface = new THREE.Mesh(geometry, material);
    this.surface.frustumCulled = false;
    this.surface.renderOrder = 5;
    parent.add(this.surface);
    this.shutGates(Infinity);
  }

  /** Cuts the sheet along the gates that are closed at a time, where it ends on both sides; true if that has changed. */
  shutGates(time) {
    const closed = this.gates.filter((gate) => time < (gate.opens_at ?? Infinity)), { nx, nz, x0, z0, cell } = this.grid;
    if (closed.length === this.closed) return false;
    this.closed = closed.length;
    this.cut = { right: new Uint8Array(nx * nz), down: new Uint8Array(nx * nz) }; // a gate lies between a cell and its neighbour
    this.moved = new Map(); // cell beside a gate -> the nearest point of the gate
    const centre = (c) => [x0 + cell * ((c % nx) + 0.5), z0 + cell * (Math.floor(c / nx) + 0.5)];
    const cross = (a, b, p) => (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    for (const { line } of closed)
      line.slice(1).forEach((b, k) => {
        const a = line[k], length2 = (b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2;
        const range = (axis, first, n) => [Math.min(a[axis], b[axis]), Math.max(a[axis], b[axis])].map((v, end) => Math.min(n - 1, Math.max(0, Math.floor((v - first) / cell) + (end ? 1 : -1))));
        const [i0, i1] = range(0, x0, nx), [j0, j1] = range(1, z0, nz);
        for (let j = j0; j <= j1; ++j)
          for (let i = i0; i <= i1; ++i)
            for (const [side, other, is] of [['right', 1, i + 1 < nx], ['down', nx, j + 1 < nz]]) {
              const c = j * nx + i;
              if (!is) continue;
              const p = centre(c), q = centre(c + other);
              if (cross(a, b, p) * cross(a, b, q) > 0 || cross(p, q, a) * cross(p, q, b) > 0) continue;
              this.cut[side][c] = 1;
              for (const [one, m] of [[c, p], [c + other, q]]) {
                const share = Math.min(1, Math.max(0, ((m[0] - a[0]) * (b[0] - a[0]) + (m[1] - a[1]) * (b[1] - a[1])) / length2));
                this.moved.set(one, [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]);
              }
            }
      });
    this.surface.geometry.setIndex(this.triangles());
    return true;
  }

  // Of the sheet, without those that a gate divides, and of the faces at the sides.
  triangles() {
    const { nx, nz } = this.grid, extra = this.rowLength - nx, index = [], { right, down } = this.cut;
    for (let j = 0; j + 1 < nz; ++j)
      for (let i = 0; i + 1 < this.rowLength; ++i) {
        const a = j * this.rowLength + i, b = a + this.rowLength, c = j * nx + i - extra;
        const cuts = i < extra ? [0, 0, 0, 0] : [right[c], down[c + 1], right[c + nx], down[c]]; // round the four corners
        const [up, east, low, west] = cuts, many = up + east + low + west;
        if (many === 0) index.push(a, b, a + 1, a + 1, b, b + 1);
        else if (many === 2 && west && up) index.push(a + 1, b, b + 1);
        else if (many === 2 && up && east) index.push(a, b, b + 1);
        else if (many === 2 && east && low) index.push(a, b, a + 1);
        else if (many === 2 && low && west) index.push(a, b + 1, a + 1);
      }
    let at = this.rowLength * nz;
    for (const length of [nx, nx, nz]) {
      for (let k = 0; k + 1 < length; ++k) {
        const a = at + 2 * k;
        index.push(a, a + 1, a + 2, a + 2, a + 1, a + 3);
      }
      at += 2 * length;
    }
    return index;
  }

  makePoints(parent) {
    const geometry = new THREE.BufferGeometry();
    this.points = new THREE.Points(geometry, new THREE.ShaderMaterial({
      uniforms: { ...this.uniforms, size: { value: 0.5 * this.spacing }, scale: { value: 500 }, row: { value: 0.25 } },
      vertexShader: POINT_VERTEX, fragmentShader: POINT_FRAGMENT,
    }));
    this.points.frustumCulled = false;
    parent.add(this.points);
  }

  as(form) {
    this.form = form;
    this.surface.visible = form !== 'points';
    this.points.visible = form === 'points';
  }

  light(sky, horizon, strength, sunColour) {
    this.uniforms.sky.value.set(sky);
    this.uniforms.horizon.value.set(horizon);
    this.uniforms.sunColour.value.set(sunColour);
    this.uniforms.light.value = strength;
  }

  /** Particles as they came. */
  take(message) {
    this.message = message;
    this.hasVelocity = true;
    const grid = this.grid;
    const [x, , z, vx, , vz, volume] = message.arrays;
    if (this.inColumns && message.stride === 1) {
      grid.fill(message.count, (k) => [x[k], z[k], volume[k], vx[k], vz[k]]);
    } else {
      grid.splat(message.arrays, message.count, 1.35 * this.spacing * Math.cbrt(message.stride));
      grid.smooth(grid.depth, 3);
    }
    this.even.set(grid.depth);
    this.time = message.time;
    this.refresh();
  }

  /** Takes the depths of a snapshot, interpolated by `share` to the next one; there are no particles then. */
  takeDepths(first, next, share) {
    this.message = null;
    this.hasVelocity = false;
    const message = share > 0 ? { ...first, arrays: [first.arrays[0].map((d, k) => d + share * (next.arrays[0][k] - d))], time: first.time + share * (next.time - first.time) } : first;
    const { columns, cell, x0, z0 } = message, depth = message.arrays[0];
    if (this.inColumns && cell <= 1.01 * this.grid.cell) {
      this.grid.fill(message.count, (k) => [x0 + cell * ((k % columns) + 0.5), z0 + cell * (Math.floor(k / columns) + 0.5), depth[k] * cell * cell, 0, 0]);
      this.even.set(this.grid.depth);
    } else {
      this.grid.resample(message, this.stream);
      this.even.set(this.grid.depth);
      this.grid.smooth(this.even, 4);
    }
    this.time = message.time;
    this.refresh();
  }

  setMode(mode) {
    this.mode = mode;
    this.refresh();
  }

  /** What the legend says: the name, the unit, and the value of the last colour, at least the largest that was shown so far. */
  legend() {
    const isSpeed = this.mode === 'speed', channel = this.scene?.channel;
    const named = this.ground ? [0.1] : (channel?.water_blocks ?? []).map((b) => b.depth_m).concat(channel?.flow !== 'closed' ? [channel?.depth_m ?? 1] : []);
    const least = this.ground ? 0.1 : isSpeed ? 2 * Math.max(this.stream, 0.5) : 1.5 * Math.max(...named.filter(Number.isFinite), 0.1);
    const full = roundUp(Math.max(least, this.most[isSpeed ? 'speed' : 'depth']));
    return isSpeed ? { name: 'speed of the water', unit: 'm/s', full, isBeyond: this.isBeyond } : { name: 'depth of the water', unit: 'm', full };
  }

  /** The scale grows with the largest values of wet cells, so that no colour stands for what is beyond it. */
  grow() {
    const { depth, vx, vz } = this.grid;
    for (let c = 0; c < depth.length; ++c) {
      if (!(depth[c] > 0.012)) continue;
      this.most.depth = Math.max(this.most.depth, depth[c]);
      if (this.hasVelocity) this.most.speed = Math.max(this.most.speed, Math.hypot(vx[c], vz[c]));
    }
  }

  refresh() {
    this.grow();
    const mode = this.mode === 'speed' && !this.hasVelocity ? 'clear' : this.mode;
    this.uniforms.mode.value = { clear: 0, depth: 1, speed: 2 }[mode];
    this.uniforms.full.value = this.legend().full;
    this.bytes = 0;
    if (this.form === 'points' && this.message) this.refreshPoints();
    if (this.form !== 'points') this.refreshSurface();
  }

  refreshPoints() {
    const m = this.message, geometry = this.points.geometry;
    ['px', 'py', 'pz'].forEach((name, k) => this.upload(geometry, name, m.arrays[k]));
    const value = this.values?.length === m.count ? this.values : (this.values = new Float32Array(m.count));
    const [x, , z, vx, vy, vz] = m.arrays, fast = this.mode === 'speed';
    this.isBeyond = false;
    for (let i = 0; i < m.count; ++i) value[i] = fast ? Math.hypot(vx[i], vy[i], vz[i]) : this.grid.at(x[i], z[i]);
    if (fast) this.isBeyond = value.some((v) => v > this.uniforms.full.value);
    this.upload(geometry, 'value', value);
    geometry.setDrawRange(0, m.count);
    this.points.material.uniforms.row.value = fast ? 0.75 : 0.25;
  }

  upload(geometry, name, array) {
    const old = geometry.attributes[name];
    if (old && old.array.length >= array.length) {
      old.array.set(array);
      old.clearUpdateRanges();
      old.addUpdateRange(0, array.length);
      old.needsUpdate = true;
    } else {
      const room = new Float32Array(Math.ceil(1.2 * array.length));
      room.set(array);
      geometry.setAttribute(name, new THREE.BufferAttribute(room, 1).setUsage(THREE.DynamicDrawUsage));
    }
    this.bytes += 4 * array.length;
  }

  refreshSurface() {
    const { nx, nz, x0, z0, cell, vx, vz, bed, part: level } = this.grid, extra = this.rowLength - nx, g = this.gravity, { right, down: below } = this.cut;
    const depth = this.levels(level);
    const { position, state, stream } = this.surface.geometry.attributes;
    const p = position.array, s = state.array, w = stream.array;
    const set = (k, x, y, z, d, sx, sz, foam, u, v, side) => {
      p[3 * k] = x, p[3 * k + 1] = y, p[3 * k + 2] = -z;
      s[4 * k] = d, s[4 * k + 1] = sx, s[4 * k + 2] = sz, s[4 * k + 3] = foam;
      w[3 * k] = u, w[3 * k + 1] = v, w[3 * k + 2] = side;
    };
    // The outermost vertices stand at the walls, not half a cell before them.
    const edgeX = (i) => x0 + cell * (i === 0 ? 0 : i === nx - 1 ? nx : i + 0.5), edgeZ = (j) => z0 + cell * (j === 0 ? 0 : j === nz - 1 ? nz : j + 0.5);
    for (let j = 0; j < nz; ++j) {
      const up = nx * Math.max(0, j - 1), down = nx * Math.min(nz - 1, j + 1), row = nx * j, z = edgeZ(j);
      for (let i = 0; i < nx; ++i) {
        const c = row + i, d = depth[c], west = i > 0 && !right[c - 1] ? c - 1 : c, east = i + 1 < nx && !right[c] ? c + 1 : c;
        const north = j > 0 && !below[c - nx] ? up + i : c, south = j + 1 < nz && !below[c] ? down + i : c;
        const sx = (level[east] - level[west]) / (cell * Math.max(1, east - west)), sz = (level[south] - level[north]) / (2 * cell);
        const steep = Math.hypot(sx, sz), fast = this.hasVelocity ? Math.hypot(vx[c], vz[c]) / Math.sqrt(g * Math.max(d, 0.05)) : 0;
        const thin = this.ground ? 0 : Math.max(0, 0.45 - 4 * d), slow = this.ground ? 0.5 : 0.22;
        const foam = Math.min(0.85, Math.max(0, 1.1 * (steep - slow)) + Math.min(0.1, Math.max(0, 0.05 * (fast - 1))) + thin);
        set(j * this.rowLength + extra + i, edgeX(i), level[c], z, d, sx, sz, foam, vx[c], vz[c], 0);
      }
      for (let k = 1; k <= extra; ++k) { // over the edge: a jet that falls freely, which is no data
        const t = k * FALL_STEP_S * Math.sqrt(9.81 / Math.max(g, 0.2)) * (g < 5 ? 0.45 : 1), d = depth[row], u = Math.max(0.6, -vx[row]);
        set(j * this.rowLength + extra - k, x0 - u * t, d - 0.5 * Math.max(g, 4) * t * t, z, this.uniforms.mode.value > 0 ? 0 : d, -2, 0, Math.min(0.95, 0.25 + 0.07 * k), vx[row] - 2, 0, 0);
      }
    }
    for (const [c, [x, z]] of this.moved) {
      const k = Math.floor(c / nx) * this.rowLength + extra + (c % nx);
      p[3 * k] = x, p[3 * k + 2] = -z;
    }
    let at = this.rowLength * nz;
    const face = (c, x, z) => {
      for (const y of [bed[c] + this.even[c], bed[c]]) set(at++, x, y, z, depth[c], 0, 0, 0, vx[c], vz[c], 1);
    };
    for (let i = 0; i < nx; ++i) face(i, edgeX(i), z0);
    for (let i = 0; i < nx; ++i) face((nz - 1) * nx + i, edgeX(i), z0 + cell * nz);
    for (let j = 0; j < nz; ++j) face(j * nx + nx - 1, x0 + cell * nx, edgeZ(j));
    for (const attribute of [position, state, stream]) {
      attribute.needsUpdate = true;
      this.bytes += attribute.array.byteLength;
    }
  }

  /**
   * Heights of the surface; returns the depths that are drawn. Where it is dry beside water in a site the sheet goes on level below
   * the ground, which hides its end, but not past a gate. The part of the wet cells' triangles there is drawn: thinner and thinner
   * where the water is clear, else in the colour of the wet cells.
   */
  levels(level) {
    const { nx, nz, depth, bed } = this.grid, { right, down } = this.cut;
    for (let c = 0; c < depth.length; ++c) level[c] = bed[c] + this.even[c];
    if (!this.ground) return depth;
    const drawn = (this.drawn ??= new Float32Array(depth.length)), isData = this.uniforms.mode.value > 0;
    drawn.set(depth);
    for (let j = 0; j < nz; ++j)
      for (let i = 0; i < nx; ++i) {
        const c = j * nx + i, isBeside = this.moved.has(c);
        if (depth[c] > 0.01) continue;
        let sum = 0, deep = 0, n = 0;
        for (let b = Math.max(0, j - 1); b <= Math.min(nz - 1, j + 1); ++b)
          for (let a = Math.max(0, i - 1); a <= Math.min(nx - 1, i + 1); ++a) {
            const o = b * nx + a;
            if (!(depth[o] > 0.01)) continue;
            const isCut = a === i ? down[Math.min(c, o)] : b === j ? right[Math.min(c, o)] : isBeside;
            if (!isCut) (sum += bed[o] + depth[o]), (deep += depth[o]), ++n;
          }
        level[c] = n ? Math.min(bed[c] - 0.02, sum / n) : bed[c] - 0.1;
        if (n) drawn[c] = isData ? deep / n : 0.0125;
      }
    return drawn;
  }

  animate(seconds, scale) {
    this.uniforms.time.value = seconds;
    this.points.material.uniforms.scale.value = scale;
  }
}

/** Where the particles of a message are, and their spacing, m: of water without a scene. */
export function boundsOf(message) {
  const [x, , z, , , , volume] = message.arrays, most = (a, f) => a.reduce((m, v) => f(m, v), a[0]);
  return { x_min_m: most(x, Math.min), x_max_m: most(x, Math.max), z_min_m: most(z, Math.min), z_max_m: most(z, Math.max), spacing: Math.cbrt(volume[0] / message.stride) };
}
