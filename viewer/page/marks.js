// What is drawn over the scene: traces of the paths, symbols of states and outcomes, the ring round who is looked at.

import * as THREE from 'three';

// Shape and colour of each state, so that neither is needed alone.
export const SYMBOLS = {
  walking: null, standing: ['square', '#bbbbbb'], effort: ['bars', '#f0e442'], sliding: ['chevron', '#e69f00'], toppled: ['triangle', '#d55e00'],
  afloat: ['drop', '#56b4e9'], carried: ['waves', '#0072b2'], recovering: ['plus', '#ffffff'], holding: ['ring', '#cc79a7'],
  drowned: ['cross', '#16161a'], dead: ['cross', '#16161a'], arrived: ['tick', '#009e73'],
};
export const LYING = ['waves', '#0072b2']; // of who walks by his state and lies by his posture: tumbled by the water
const CELL = 64, SHAPES = ['square', 'bars', 'chevron', 'triangle', 'drop', 'waves', 'plus', 'ring', 'cross', 'tick'];

export function drawSymbol(c, shape, colour, size) {
  const dark = colour === '#16161a';
  c.save();
  c.scale(size / 64, size / 64);
  c.translate(32, 32);
  c.beginPath();
  c.arc(0, 0, 29, 0, 2 * Math.PI);
  c.fillStyle = dark ? '#ffffff' : '#1c2530';
  c.fill();
  c.lineWidth = 3;
  c.strokeStyle = dark ? '#16161a' : '#ffffff';
  c.stroke();
  c.strokeStyle = c.fillStyle = colour;
  c.lineWidth = 7;
  c.lineCap = c.lineJoin = 'round';
  c.beginPath();
  const line = (...points) => points.forEach(([x, y], k) => c[k ? 'lineTo' : 'moveTo'](x, y));
  if (shape === 'square') c.rect(-11, -11, 22, 22), c.fill();
  if (shape === 'bars') line([-10, -13], [-10, 13]), line([10, -13], [10, 13]);
  if (shape === 'chevron') line([-14, 2], [0, -11], [14, 2]), line([-14, 15], [0, 2], [14, 15]);
  if (shape === 'triangle') line([0, -15], [16, 12], [-16, 12], [0, -15]), c.fill();
  if (shape === 'drop') line([0, -17], [12, 4]), c.arc(0, 5, 12, 0, Math.PI), c.lineTo(0, -17), c.fill();
  if (shape === 'waves') for (const y of [-9, 6]) { c.moveTo(-18, y); c.bezierCurveTo(-9, y - 12, -6, y + 14, 2, y + 2); c.bezierCurveTo(8, y - 8, 12, y - 6, 18, y + 2); }
  if (shape === 'plus') line([0, -15], [0, 15]), line([-15, 0], [15, 0]);
  if (shape === 'ring') c.arc(0, 0, 13, 0, 2 * Math.PI);
  if (shape === 'cross') line([-13, -13], [13, 13]), line([-13, 13], [13, -13]);
  if (shape === 'tick') line([-15, 1], [-4, 13], [15, -12]);
  c.stroke();
  c.restore();
}

const TRACE_VERTEX = `
  attribute vec2 corner; attribute vec4 ends; attribute vec4 more; // ta, tb, colour r g packed
  uniform vec2 screen; uniform float width, now, lift, past; uniform vec3 colours[9]; varying vec4 tint;
  void main() {
    vec4 a = projectionMatrix * viewMatrix * vec4(ends.x, lift, -ends.y, 1.), b = projectionMatrix * viewMatrix * vec4(ends.z, lift, -ends.w, 1.);
    tint = vec4(colours[int(more.z)], more.w > .5 ? 1. : .85);
    if (more.x > now || a.w < .1 || b.w < .1) { gl_Position = vec4(2., 2., 2., 1.); return; }
    float reach = clamp((now - more.x) / max(1e-4, more.y - more.x), 0., 1.);
    b = mix(a, b, reach);
    vec2 d = (b.xy / b.w - a.xy / a.w) * screen; d = length(d) > 1e-5 ? normalize(d) : vec2(1., 0.);
    vec4 p = corner.x < .5 ? a : b;
    float wide = width * (more.w > .5 ? 2. : 1.);
    p.xy += p.w * wide * (vec2(-d.y, d.x) * corner.y + d * (corner.x < .5 ? -.5 : .5)) / screen;
    gl_Position = p;
  }`;

export class Traces {
  constructor(parent, colours) {
    const g = new THREE.InstancedBufferGeometry();
    g.setAttribute('corner', new THREE.Float32BufferAttribute([0, -1, 1, -1, 0, 1, 1, 1], 2));
    g.setIndex([0, 1, 2, 2, 1, 3]);
    g.instanceCount = 0;
    this.uniforms = { screen: { value: new THREE.Vector2(1, 1) }, width: { value: 1.6 }, now: { value: 0 }, lift: { value: 0.06 }, past: { value: 0 }, colours: { value: colours.map((c) => new THREE.Color(c)) } };
    const material = new THREE.ShaderMaterial({ uniforms: this.uniforms, vertexShader: TRACE_VERTEX, transparent: true, depthWrite: false, side: THREE.DoubleSide,
      fragmentShader: 'varying vec4 tint; void main() { gl_FragColor = tint;\n#include <colorspace_fragment>\n}' });
    this.mesh = new THREE.Mesh(g, material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 4; // before the water, through which they are seen
    parent.add(this.mesh);
    this.last = new Map(); // of id: time, x, z
    this.segments = [];
    this.until = -1;
  }

  /** Points in the order of ids and times, after those before. */
  take(message, colourOf, period) {
    const [id, t, x, z] = message.arrays;
    for (let k = 0; k < message.count; ++k) {
      const before = this.last.get(id[k]);
      if (before && t[k] <= before[0]) continue;
      if (before && !(period && Math.abs(x[k] - before[1]) > period / 2)) this.segments.push([before[1], before[2], x[k], z[k], before[0], t[k], colourOf(id[k]), id[k]]);
      this.last.set(id[k], [t[k], x[k], z[k]]);
      this.until = Math.max(this.until, t[k]);
    }
    this.rebuild();
  }

  rebuild(selected = this.selected) {
    this.selected = selected;
    const n = this.segments.length, ends = new Float32Array(4 * n), more = new Float32Array(4 * n);
    this.segments.forEach((s, k) => {
      ends.set([s[0], s[1], s[2], s[3]], 4 * k);
      more.set([s[4], s[5], s[6], s[7] === selected ? 1 : 0], 4 * k);
    });
    const g = this.mesh.geometry;
    g.setAttribute('ends', new THREE.InstancedBufferAttribute(ends, 4));
    g.setAttribute('more', new THREE.InstancedBufferAttribute(more, 4));
    g.instanceCount = n;
  }
}

export class Symbols {
  constructor(parent) {
    const canvas = document.createElement('canvas');
    canvas.width = 4 * CELL;
    canvas.height = 4 * CELL;
    const c = canvas.getContext('2d');
    this.cells = new Map();
    Object.entries({ ...SYMBOLS, tumbled: LYING }).filter(([, s]) => s).forEach(([state, [shape, colour]], k) => {
      c.save();
      c.translate((k % 4) * CELL, Math.floor(k / 4) * CELL);
      drawSymbol(c, shape, colour, CELL);
      c.restore();
      this.cells.set(state, k);
    });
    const texture = new THREE.CanvasTexture(canvas);
    texture.colorSpace = THREE.SRGBColorSpace;
    texture.flipY = false;
    this.uniforms = { map: { value: texture }, size: { value: 15 } };
    this.points = new THREE.Points(new THREE.BufferGeometry(), new THREE.ShaderMaterial({
      uniforms: this.uniforms, transparent: true, depthTest: false, depthWrite: false,
      vertexShader: `attribute float cell; uniform float size; varying float c;
        void main() { c = cell; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.);
          gl_PointSize = size * clamp(26. / max(1., gl_Position.w), .55, 1.3); }`,
      fragmentShader: `uniform sampler2D map; varying float c;
        void main() { vec4 t = texture2D(map, (vec2(mod(c, 4.), floor(c / 4.)) + gl_PointCoord) / 4.); if (t.a < .1) discard; gl_FragColor = t;
        #include <colorspace_fragment>
        }`,
    }));
    this.points.frustumCulled = false;
    this.points.renderOrder = 9;
    parent.add(this.points);
  }

  /** list: x, y, z and state. */
  show(list) {
    const known = list.filter((p) => this.cells.has(p.state)), g = this.points.geometry;
    const position = new Float32Array(3 * known.length), cell = new Float32Array(known.length);
    known.forEach((p, k) => {
      position.set([p.x, p.y, -p.z], 3 * k);
      cell[k] = this.cells.get(p.state);
    });
    g.setAttribute('position', new THREE.BufferAttribute(position, 3));
    g.setAttribute('cell', new THREE.BufferAttribute(cell, 1));
    g.setDrawRange(0, known.length);
  }
}

export function makeRing(parent) {
  const ring = new THREE.Mesh(new THREE.TorusGeometry(0.75, 0.06, 8, 40), new THREE.MeshBasicMaterial({ color: 0xffffff, depthTest: false, transparent: true, opacity: 0.95 }));
  ring.rotation.x = Math.PI / 2;
  ring.renderOrder = 8;
  ring.visible = false;
  parent.add(ring);
  return ring;
}

export { SHAPES };
