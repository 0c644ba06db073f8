// People as figures: one instanced body of thirteen bones, bent in the vertex shader by what the run says of each person.

import * as THREE from 'three';
import { GROUP_COLOURS } from './ground.js';

// Of the height (Drillis and Contini 1966). x forward, y up from the hips, z to the right.
const HIP = 0.53, LEG = 0.53 - 0.039, BONES = { pelvis: 0, chest: 1, head: 2, armL: 3, foreL: 4, armR: 5, foreR: 6, thighL: 7, shinL: 8, footL: 9, thighR: 10, shinR: 11, footR: 12 };
const SKIN = 0, SHIRT = 1, TROUSERS = 2, SHOE = 3, HAIR = 4;

/** Rings of [x, y, z, depth, width, first bone, second bone, share of the second, part], joined to a skin. */
function loft(out, rings, around) {
  const start = out.position.length / 3;
  for (const [x, y, z, deep, wide, b0, b1, share, part] of rings) {
    for (let k = 0; k < around; ++k) {
      const a = (2 * Math.PI * k) / around;
      out.position.push(x + deep * Math.cos(a), y - HIP, z + wide * Math.sin(a));
      out.bone.push(b0, b1, share, part);
    }
  }
  for (let j = 0; j + 1 < rings.length; ++j) {
    for (let k = 0; k < around; ++k) {
      const a = start + j * around + k, b = start + j * around + ((k + 1) % around), c = a + around, d = b + around;
      out.index.push(a, c, b, b, c, d);
    }
  }
  for (const [row, turn] of [[0, 1], [rings.length - 1, 0]]) { // lids
    for (let k = 1; k + 1 < around; ++k) {
      const a = start + row * around, b = a + k, c = a + k + 1;
      out.index.push(a, ...(turn ? [b, c] : [c, b]));
    }
  }
}

function bodyGeometry(fine) {
  const out = { position: [], bone: [], index: [] }, B = BONES, n = fine ? 12 : 6, m = fine ? 9 : 5;
  const flip = (rings) => (rings[0][1] > rings[rings.length - 1][1] ? rings.reverse() : rings);
  loft(out, [
    [0, 0.475, 0, 0.045, 0.06, B.pelvis, 0, 0, TROUSERS], [0, 0.51, 0, 0.066, 0.09, B.pelvis, 0, 0, TROUSERS],
    [-0.002, 0.56, 0, 0.062, 0.086, B.pelvis, 0, 0, TROUSERS], [0, 0.6, 0, 0.056, 0.076, B.pelvis, B.chest, 0.35, SHIRT],
    [0.003, 0.655, 0, 0.06, 0.082, B.pelvis, B.chest, 0.8, SHIRT], [0.004, 0.72, 0, 0.067, 0.096, B.chest, 0, 0, SHIRT],
    [0, 0.775, 0, 0.064, 0.108, B.chest, 0, 0, SHIRT], [-0.003, 0.81, 0, 0.05, 0.102, B.chest, 0, 0, SHIRT],
    [-0.003, 0.832, 0, 0.034, 0.06, B.chest, 0, 0, SHIRT], [0, 0.842, 0, 0.028, 0.032, B.chest, B.head, 0.3, SKIN],
    [0.004, 0.87, 0, 0.027, 0.029, B.chest, B.head, 0.7, SKIN],
  ], n);
  loft(out, [
    [0.012, 0.86, 0, 0.02, 0.02, B.head, 0, 0, SKIN], [0.014, 0.872, 0, 0.042, 0.034, B.head, 0, 0, SKIN],
    [0.009, 0.9, 0, 0.052, 0.042, B.head, 0, 0, SKIN], [0.004, 0.935, 0, 0.056, 0.046, B.head, 0, 0, SKIN],
    [0, 0.965, 0, 0.054, 0.045, B.head, 0, 0, SKIN], [-0.004, 0.988, 0, 0.04, 0.034, B.head, 0, 0, SKIN],
  ], n);
  loft(out, [ // hair, further back than the face
    [-0.026, 0.885, 0, 0.026, 0.035, B.head, 0, 0, HAIR], [-0.02, 0.915, 0, 0.042, 0.046, B.head, 0, 0, HAIR],
    [-0.012, 0.945, 0, 0.052, 0.0495, B.head, 0, 0, HAIR], [-0.003, 0.968, 0, 0.06, 0.05, B.head, 0, 0, HAIR],
    [-0.004, 0.989, 0, 0.048, 0.04, B.head, 0, 0, HAIR], [-0.006, 1.003, 0, 0.02, 0.016, B.head, 0, 0, HAIR],
  ], n);
  if (fine) loft(out, [[0.058, 0.899, 0, 0.009, 0.007, B.head, 0, 0, SKIN], [0.061, 0.912, 0, 0.008, 0.006, B.head, 0, 0, SKIN], [0.056, 0.93, 0, 0.004, 0.004, B.head, 0, 0, SKIN]], 5);
  for (const side of [-1, 1]) {
    const [arm, fore, thigh, shin, foot] = side < 0 ? [B.armL, B.foreL, B.thighL, B.shinL, B.footL] : [B.armR, B.foreR, B.thighR, B.shinR, B.footR];
    const s = 0.118 * side, h = 0.05 * side;
    loft(out, flip([
      [0, 0.828, 0.085 * side, 0.026, 0.02, B.chest, arm, 0.4, SHIRT], [0, 0.812, s, 0.031, 0.027, B.chest, arm, 0.75, SHIRT],
      [0, 0.775, s, 0.03, 0.027, arm, 0, 0, SHIRT], [0, 0.705, s, 0.026, 0.024, arm, 0, 0, SHIRT], [0.001, 0.7, s, 0.022, 0.02, arm, 0, 0, SKIN],
      [0, 0.632, s, 0.021, 0.02, arm, fore, 0.5, SKIN], [0, 0.585, s, 0.021, 0.02, fore, 0, 0, SKIN], [0, 0.5, s, 0.014, 0.014, fore, 0, 0, SKIN],
      [0.004, 0.476, s, 0.02, 0.012, fore, 0, 0, SKIN], [0.006, 0.44, s, 0.021, 0.012, fore, 0, 0, SKIN], [0.006, 0.402, s, 0.01, 0.007, fore, 0, 0, SKIN],
    ]), m);
    loft(out, flip([
      [0, 0.545, h, 0.056, 0.045, B.pelvis, thigh, 0.3, TROUSERS], [0, 0.5, h, 0.056, 0.047, B.pelvis, thigh, 0.65, TROUSERS],
      [0.003, 0.42, h, 0.05, 0.044, thigh, 0, 0, TROUSERS], [0.004, 0.33, h, 0.039, 0.035, thigh, 0, 0, TROUSERS],
      [0.003, 0.285, h, 0.036, 0.033, thigh, shin, 0.5, TROUSERS], [-0.003, 0.235, h, 0.036, 0.032, shin, 0, 0, TROUSERS],
      [-0.002, 0.15, h, 0.03, 0.027, shin, 0, 0, TROUSERS], [0, 0.062, h, 0.028, 0.025, shin, 0, 0, TROUSERS], [0, 0.035, h, 0.022, 0.02, shin, foot, 0.6, SKIN],
    ]), m);
    loft(out, flip([
      [0, 0.05, h, 0.024, 0.021, foot, 0, 0, SHOE], [0.012, 0.034, h, 0.045, 0.025, foot, 0, 0, SHOE], [0.03, 0.018, h, 0.066, 0.029, foot, 0, 0, SHOE],
      [0.031, 0.001, h, 0.069, 0.03, foot, 0, 0, SHOE],
    ]), m);
  }
  const geometry = new THREE.InstancedBufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(out.position, 3));
  geometry.setAttribute('bone', new THREE.Float32BufferAttribute(out.bone, 4));
  geometry.setIndex(out.index.reverse());
  geometry.computeVertexNormals();
  return geometry;
}

const BEND = `
  attribute vec4 bone, iRoot, iTilt, iLegs, iArms, iBody, iCloth;
  varying vec3 cloth;
  vec3 rotX(vec3 p, float a) { float c = cos(a), s = sin(a); return vec3(p.x, c * p.y - s * p.z, s * p.y + c * p.z); }
  vec3 rotY(vec3 p, float a) { float c = cos(a), s = sin(a); return vec3(c * p.x + s * p.z, p.y, c * p.z - s * p.x); }
  vec3 rotZ(vec3 p, float a) { float c = cos(a), s = sin(a); return vec3(c * p.x - s * p.y, s * p.x + c * p.y, p.z); }
  // A joint: p turns about the pivot; is 0 for normals.
  vec3 joint(vec3 p, vec3 pivot, float bend, float spread, float is) { return rotZ(rotX(p - is * pivot, spread), bend) + is * pivot; }
  vec3 posed(float b, vec3 p, float is) {
    if (b < .5) return p;
    if (b < 6.5) {
      if (b > 2.5) {
        bool left = b < 4.5; float side = left ? -1. : 1.;
        if (b > 3.5 && b < 4.5 || b > 5.5) p = joint(p, vec3(0., .632 - .53, .118 * side), left ? iArms.z : iArms.w, 0., is);
        p = joint(p, vec3(0., .812 - .53, .108 * side), left ? iArms.x : iArms.y, left ? iBody.x : -iBody.y, is);
      } else if (b > 1.5) p = joint(p, vec3(0., .85 - .53, 0.), iBody.w, 0., is);
      return joint(p, vec3(0., .6 - .53, 0.), -iBody.z, 0., is);
    }
    bool left = b < 9.5; float side = left ? -1. : 1., hip = left ? iLegs.x : iLegs.y, knee = left ? iLegs.z : iLegs.w;
    float part = left ? b - 7. : b - 10.;
    if (part > 1.5) p = joint(p, vec3(0., .039 - .53, .05 * side), clamp(knee - hip, -.5, .8) * (1. - .9 * iCloth.w), 0., is);
    if (part > .5) p = joint(p, vec3(0., .285 - .53, .05 * side), -knee, 0., is);
    return joint(p, vec3(0., 0., .05 * side), hip, -side * .06 * (1. + 3. * iCloth.w), is);
  }
  vec3 bent(vec3 p, float is) { return mix(posed(bone.x, p, is), posed(bone.y, p, is), bone.z); }
  // Roll about the body's length, heading, then out of the vertical towards (iTilt.x, iTilt.y), then about the vertical.
  vec3 laid(vec3 p) {
    p = rotY(p, iTilt.z); p = rotY(p, iRoot.w);
    float a = length(iTilt.xy);
    if (a > 1e-4) { vec2 d = iTilt.xy / a; vec3 k = vec3(d.y, 0., -d.x); p = p * cos(a) + cross(k, p) * sin(a) + k * dot(k, p) * (1. - cos(a)); }
    return p;
  }`;

// Skins and hair of a crowd, by a number of each person.
const COLOURS = `
  vec3 skinOf(float r) { return mix(vec3(.26, .14, .085), vec3(.8, .57, .43), r); }
  vec3 hairOf(float r) { return r < .35 ? vec3(.02, .017, .016) : r < .7 ? vec3(.09, .05, .03) : r < .9 ? vec3(.32, .2, .09) : vec3(.35, .34, .33); }
  vec3 trousersOf(float r) { return r < .3 ? vec3(.035, .06, .13) : r < .55 ? vec3(.045, .045, .05) : r < .8 ? vec3(.19, .15, .1) : vec3(.1, .12, .1); }`;

function bendable(material) {
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', `#include <common>\n${BEND}\n${COLOURS}`)
      .replace('#include <beginnormal_vertex>', 'vec3 objectNormal = laid(bent(normal, 0.));')
      .replace('#include <begin_vertex>', `vec3 transformed = laid(bent(position, 1.) * iTilt.w) + iRoot.xyz;
        float r = fract(sin(dot(iCloth.rgb, vec3(12.9, 78.2, 37.7)) + iTilt.w * 91.7) * 43758.5), q = fract(r * 7.31), u = fract(r * 13.7);
        cloth = bone.w < .5 ? skinOf(r) : bone.w < 1.5 ? iCloth.rgb : bone.w < 2.5 ? trousersOf(q) : bone.w < 3.5 ? vec3(.03) : hairOf(u);`);
    if (!material.isMeshDepthMaterial)
      shader.fragmentShader = shader.fragmentShader
        .replace('#include <common>', '#include <common>\nvarying vec3 cloth;')
        .replace('#include <color_fragment>', 'diffuseColor.rgb *= cloth;');
  };
  return material;
}

/** State of people before their end where the files hold no states (-1), and of a state that is not in the list. */
export const UNTOLD = 'active', UNKNOWN = 'unknown';

// Joint angles, rad: legs (thigh L R, knee L R), arms (swing L R, elbow L R), spread L R, trunk, neck; last: feet hang.
const POSES = {
  upright: [0, 0, 0, 0, 0, 0, 0.25, 0.25, 0.1, 0.1, 0, 0, 0],
  falling: [0.5, -0.2, 0.7, 0.5, 1.1, 0.7, 0.5, 0.9, 1.0, 0.8, 0.25, 0.2, 0.4],
  lying: [0.3, 0.05, 0.5, 0.25, 0.25, 0.1, 0.45, 0.3, 1.15, 0.85, 0.1, 0.1, 1],
  floating: [0.55, 0.2, 0.8, 0.6, 0.7, 0.7, 0.5, 0.5, 1.0, 1.0, 0, 0.15, 1],
  swimming: [0.1, -0.1, 0.25, 0.25, 2.6, 2.2, 0.3, 0.5, 0.3, 0.3, -0.1, 0.6, 1],
  sitting: [1.45, 1.3, 1.2, 1.0, -0.3, -0.5, 0.3, 0.2, 0.5, 0.5, 0.15, 0, 0],
  kneeling: [0.1, 0.9, 1.6, 1.3, 0.5, 0.4, 0.6, 0.6, 0.4, 0.3, 0.35, 0.1, 0.2],
  squatting: [1.9, 1.8, 2.2, 2.1, 0.9, 0.8, 0.5, 0.5, 0.5, 0.5, 0.5, 0.1, 0],
  rising: [0.9, 0.4, 1.1, 0.8, 0.6, 0.5, 0.5, 0.6, 0.6, 0.5, 0.5, 0.1, 0],
};
const ANGLES = 13;
const ARM = { shoulder: 0.282, side: 0.108, length: 0.385 }; // above the hip, beside the middle, down to the palm; of the height
const WILD = { effort: [0.75, 0.75, 0.22], sliding: [1.25, 1.15, -0.12] }; // arms out, trunk

/** Returns links between people, both directions, as indices in the frame by index; a row names one held person. */
function linksOf(frame) {
  const places = new Map(), links = new Map();
  for (let k = 0; k < frame.count; ++k) places.set(frame.arrays[0][k], k);
  const add = (k, other) => (links.get(k) ?? links.set(k, new Set()).get(k)).add(other);
  for (let k = 0; k < frame.count; ++k) {
    const held = frame.arrays[15][k] < 0 ? undefined : places.get(frame.arrays[15][k]);
    if (held !== undefined) add(k, held), add(held, k);
  }
  return links;
}

/** Swing and spread of an arm that meets the palm of a person `ahead` and `beside` (to this arm's side), m, halfway. */
function reach(ahead, beside, height) {
  const length = ARM.length * height, x = ahead / 2, z = beside / 2 - ARM.side * height;
  const far = Math.hypot(x, z), shorter = far > 0.98 * length ? (0.98 * length) / far : 1; // the two are too far apart
  const down = Math.sqrt(length * length - shorter * shorter * far * far);
  return [Math.atan2(shorter * x, down), Math.asin((shorter * z) / length)];
}

export class People {
  /** period: after which the world repeats along x, m; 0: it does not. */
  constructor(parent, heights, groups, groundAt, period = 0) {
    this.period = period;
    this.groundAt = groundAt; // of x, z, m
    this.parent = parent;
    this.heights = heights; // of id, m
    this.groups = groups; // of id, index in the scene's list
    this.memory = new Map(); // of id: angles, spin, walked
    this.capacity = 0;
    this.count = 0;
    this.shown = []; // as drawn: id, x, y, z, state
    this.bytes = 0;
  }

  grow(count) {
    if (count <= this.capacity) return;
    this.capacity = Math.ceil(count * 1.2) + 8;
    this.mesh?.removeFromParent();
    const geometry = bodyGeometry(count <= 150);
    this.arrays = {};
    for (const name of ['iRoot', 'iTilt', 'iLegs', 'iArms', 'iBody', 'iCloth']) {
      const attribute = new THREE.InstancedBufferAttribute(new Float32Array(4 * this.capacity), 4).setUsage(THREE.DynamicDrawUsage);
      geometry.setAttribute(name, attribute);
      this.arrays[name] = attribute.array;
    }
    this.mesh = new THREE.Mesh(geometry, bendable(new THREE.MeshStandardMaterial({ roughness: 0.78 })));
    this.mesh.customDepthMaterial = bendable(new THREE.MeshDepthMaterial({ depthPacking: THREE.RGBADepthPacking }));
    this.mesh.frustumCulled = false;
    this.mesh.castShadow = this.capacity < 1500;
    this.mesh.receiveShadow = true;
    this.parent.add(this.mesh);
  }

  /** Two frames of the run, and how far between them the page is; step: simulated seconds since the last picture. */
  update(before, after, share, words, step, clock) {
    this.grow(Math.max(before.count, 1));
    const places = after ? new Map(Array.from(after.arrays[0], (id, k) => [id, k])) : new Map();
    const jumps = step < 0 || step > 1, keep = jumps ? 0 : Math.exp(-step / 0.16);
    this.count = before.count;
    this.shown.length = 0;
    this.links = linksOf(before);
    this.frame = before;
    for (let k = 0; k < before.count; ++k) {
      const id = before.arrays[0][k], other = places.get(id);
      const seam = other === undefined || !this.period ? 0 : this.period * Math.round((after.arrays[1][other] - before.arrays[1][k]) / this.period);
      const value = (f) => {
        const a = before.arrays[f][k];
        if (other === undefined) return a;
        const b = a + share * (after.arrays[f][other] - a - (f === 1 ? seam : 0));
        return f === 1 && seam ? b - this.period * Math.floor(b / this.period) : b;
      };
      this.one(k, id, value, before.arrays[3][k] === -1 ? UNTOLD : words.states[before.arrays[3][k]] ?? UNKNOWN, words.postures[before.arrays[4][k]], {
        phase: this.phase(before, after, k, other, share), keep, step: jumps ? 0 : step, clock, poses: words.poses,
      });
    }
    this.send();
  }

  phase(before, after, k, other, share) {
    const a = before.arrays[7][k];
    if (other === undefined) return a;
    const d = after.arrays[7][other] - a;
    return a + share * (d < -0.5 ? d + 1 : d > 0.5 ? d - 1 : d);
  }

  one(k, id, value, state, posture, now) {
    const height = this.heights(id), speed = value(6);
    const m = this.memory.get(id) ?? { angles: null, spin: 0, walked: 0, lies: undefined };
    const up = posture === 'upright' || posture === 'rising' || posture === 'squatting';
    let phase = now.phase, length = value(8);
    if (!now.poses) { // only paths: steps as long as people of this height and speed take (Inman et al. 1981)
      length = Math.sqrt(0.24 * height * speed);
      m.walked += speed * now.step;
      phase = length > 0.05 ? m.walked / (2 * length) : 0;
    }
    const target = this.target(id, state, posture, phase, length, height, now.clock);
    this.holdHands(target, k, posture, height);
    if (!m.angles || now.keep === 0) m.angles = target.slice();
    const gait = posture === 'upright' ? Math.min(now.keep, 0.35) : now.keep; // legs follow the gait at once
    for (let a = 0; a < ANGLES; ++a) m.angles[a] = target[a] + (m.angles[a] - target[a]) * (a < 6 ? gait : now.keep);
    const afloat = posture === 'lying' || posture === 'floating' || posture === 'swimming';
    m.spin = afloat ? m.spin - value(13) * now.step : m.spin * now.keep;
    this.memory.set(id, m);

    const hip = now.poses ? value(9) : HIP * height;
    const lx = value(10), lz = -value(11), lean = Math.hypot(lx, lz), plant = up ? 1 : 0;
    const swing = posture === 'upright' ? Math.min(0.6, length / (2 * LEG * height)) : 0;
    const drop = LEG * height * (1 - Math.cos(swing * Math.cos(2 * Math.PI * phase)));
    const x = value(1) + plant * (lean > 1e-4 ? (lx / lean) * Math.sin(lean) * hip : 0);
    const z = -value(2) + plant * (lean > 1e-4 ? (lz / lean) * Math.sin(lean) * hip : 0);
    const y = this.groundAt(value(1), value(2)) + hip * (plant ? Math.cos(lean) : 1) - drop + (afloat ? 0.035 * Math.sin(2.2 * now.clock + 1.7 * id) : 0);
    // A lying person turns onto the back or the front. The file leaves this open: by id, two of three lie on the back.
    m.lies = (posture === 'lying' ? 1 : 0) + ((m.lies ?? (posture === 'lying' ? 1 : 0)) - (posture === 'lying' ? 1 : 0)) * now.keep;
    const along = lean > 0.05 ? Math.atan2(-lz, lx) + (id % 3 ? Math.PI : 0) : value(5);
    const turn = Math.atan2(Math.sin(along - value(5)), Math.cos(along - value(5))) * m.lies;
    const roll = m.lies * 0.25 * Math.sin(0.9 * now.clock + 2.1 * id);
    const c = Math.cos(m.spin), s = Math.sin(m.spin);
    const A = this.arrays, at = 4 * k, a = m.angles;
    A.iRoot.set([x, y, z, value(5) + turn + m.spin], at);
    A.iTilt.set([lx * c + lz * s, lz * c - lx * s, roll, height], at);
    A.iLegs.set([a[0], a[1], a[2], a[3]], at);
    A.iArms.set([a[4], a[5], a[6], a[7]], at);
    A.iBody.set([a[8], a[9], a[10], a[11]], at);
    A.iCloth.set([...this.shirt(id), a[12]], at);
    this.shown.push({ id, x: value(1), z: value(2), y, height, state, posture, speed, heading: value(5) });
  }

  target(id, state, posture, phase, length, height, clock) {
    const t = (POSES[posture] ?? POSES.upright).slice(), turn = 2 * Math.PI * phase;
    const swing = Math.asin(Math.min(0.6, length / (2 * LEG * height)));
    if (posture === 'upright') {
      t[0] = swing * Math.cos(turn);
      t[1] = -t[0];
      t[2] = 0.08 + 2.1 * swing * Math.max(0, Math.sin(turn - Math.PI));
      t[3] = 0.08 + 2.1 * swing * Math.max(0, Math.sin(turn));
      t[4] = -0.85 * t[0];
      t[5] = 0.85 * t[0];
      t[6] += 0.5 * swing;
      t[7] += 0.5 * swing;
      t[10] = 0.1 * swing;
      const wild = WILD[state];
      if (wild) {
        t[8] = wild[0] + 0.2 * Math.sin(3.1 * clock + id);
        t[9] = wild[1] + 0.2 * Math.sin(2.7 * clock + 2 * id);
        t[10] += wild[2];
        t[2] += 0.2;
        t[3] += 0.2;
      }
    } else if (posture === 'lying') {
      for (let a = 0; a < 12; ++a) t[a] += (a < 4 ? 0.2 : a < 6 ? 0.22 : a < 8 ? 0.35 : 0.15) * Math.sin(1.6 * clock + 1.3 * a + 2.3 * id);
    } else if (posture === 'floating') {
      for (let a = 0; a < 10; ++a) t[a] += (a < 4 ? 0.4 : 0.35) * Math.sin(3.4 * clock + (a % 2) * Math.PI + a + id);
    } else if (posture === 'swimming') {
      const stroke = 2.6 * clock + id;
      t[4] = stroke % (2 * Math.PI);
      t[5] = (stroke + Math.PI) % (2 * Math.PI);
      t[0] = 0.25 * Math.sin(9 * clock + id);
      t[1] = -t[0];
    }
    return t;
  }

  /** Whoever is held on to at the right gets the right hand; arms that hold are straight, and meet halfway. */
  holdHands(target, k, posture, height) {
    const held = this.links.get(k);
    if (!held || posture === 'lying' || posture === 'floating' || posture === 'swimming') return;
    const [, x, z, , , heading] = this.frame.arrays.map((values) => values[k]), c = Math.cos(heading), s = Math.sin(heading);
    const others = Array.from(held, (other) => {
      const dx = this.frame.arrays[1][other] - x, dz = this.frame.arrays[2][other] - z;
      return { ahead: c * dx + s * dz, right: s * dx - c * dz };
    }).sort((a, b) => a.right - b.right);
    const [left, right] = others.length > 1 ? [others[0], others[others.length - 1]] : others[0].right < 0 ? [others[0]] : [undefined, others[0]];
    if (left) [target[4], target[8]] = reach(left.ahead, -left.right, height), target[6] = 0.05;
    if (right) [target[5], target[9]] = reach(right.ahead, right.right, height), target[7] = 0.05;
  }

  shirt(id) {
    const group = this.groups(id);
    this.palette ??= ['#c8402f', '#2f6db5', '#e8e4d8', '#3f8f6b', '#d9a441', '#6d4f9c', '#4a4f57', '#d77a9a', '#7fa7c9', '#8a5a3c', '#a8b545', '#1f7f86']
      .map((c) => new THREE.Color(c).toArray());
    this.grouped ??= GROUP_COLOURS.map((c) => new THREE.Color(c).toArray());
    return group < 0 ? this.palette[(id * 7 + Math.floor(id / 12)) % this.palette.length] : this.grouped[group % this.grouped.length];
  }

  send() {
    const geometry = this.mesh.geometry;
    geometry.instanceCount = this.count;
    this.bytes = 0;
    for (const name of Object.keys(this.arrays)) {
      const attribute = geometry.attributes[name];
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, 4 * this.count);
      attribute.needsUpdate = true;
      this.bytes += 16 * this.count;
    }
  }
}
