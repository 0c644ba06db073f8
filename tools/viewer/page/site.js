// A site: its ground as it rises and falls, houses, shelters, gates, and where water comes in and leaves. And the grid over it or over
// a channel that the water is put on.

import * as THREE from 'three';
import { GROUP_COLOURS, STAR, goal, goalsOf, mixed, noise, place, textSprite } from './ground.js';

const WALLS = ['#d9cfbd', '#e6dfd1', '#cdbfa6', '#d8c7b6', '#c9cbc6'], ROOFS = ['#9c5a45', '#8a4f3f', '#7d6a5d', '#a4664c', '#6f7378'];
const SAFE = 0x009e73, WATER = 0x2f86c5;

/** Heights at the points of a square grid; of a scene without a site 0 everywhere. */
export class Ground {
  constructor(message) {
    this.columns = message.columns;
    this.rows = message.count / message.columns;
    this.step = message.cell;
    this.heights = message.arrays[0];
    const known = this.heights.filter(Number.isFinite);
    this.low = known.reduce((a, b) => Math.min(a, b), Infinity);
    this.high = known.reduce((a, b) => Math.max(a, b), -Infinity);
  }

  /** m; straight between the points, the lowest where there is none. */
  at(x, z) {
    const gx = Math.min(this.columns - 1.001, Math.max(0, x / this.step)), gz = Math.min(this.rows - 1.001, Math.max(0, z / this.step));
    const i = Math.floor(gx), j = Math.floor(gz), s = gx - i, t = gz - j, h = this.heights, k = j * this.columns + i;
    const value = (1 - t) * ((1 - s) * h[k] + s * h[k + 1]) + t * ((1 - s) * h[k + this.columns] + s * h[k + this.columns + 1]);
    return Number.isFinite(value) ? value : this.low;
  }
}

function terrain(ground, length, width) {
  const { columns, rows, step, heights } = ground, n = columns * rows, turf = Math.max(14, Math.max(length, width) / 12), position = new Float32Array(3 * n), uv = new Float32Array(2 * n), index = [];
  for (let k = 0; k < n; ++k) {
    const x = Math.min(length, step * (k % columns)), z = Math.min(width, step * Math.floor(k / columns));
    position.set([x, Number.isFinite(heights[k]) ? heights[k] : ground.low, -z], 3 * k);
    uv.set([x / turf, z / turf], 2 * k);
  }
  for (let j = 0; j + 1 < rows; ++j)
    for (let i = 0; i + 1 < columns; ++i) {
      const a = j * columns + i, b = a + columns;
      if ([a, b, a + 1, b + 1].every((k) => Number.isFinite(heights[k]))) index.push(a, a + 1, b, a + 1, b + 1, b);
    }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(position, 3));
  geometry.setAttribute('uv', new THREE.BufferAttribute(uv, 2));
  geometry.setIndex(index);
  geometry.computeVertexNormals();
  const normal = geometry.attributes.normal.array, colour = new Float32Array(3 * n);
  for (let k = 0; k < n; ++k) colour.set(mixed([1, 1, 1], [0.86, 0.74, 0.58], (0.985 - normal[3 * k + 1]) * 9), 3 * k);
  geometry.setAttribute('color', new THREE.BufferAttribute(colour, 3));
  const grass = noise(256, 256, 7, (v, r) => mixed([116, 128, 84], [167, 160, 118], (v - 0.3) * 2.2).map((c) => c + 14 * (r - 0.5)));
  const mesh = new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({ map: grass, vertexColors: true, roughness: 1 }));
  mesh.receiveShadow = true;
  return mesh;
}

/** The sides of the block that the ground is cut out of. */
function sides(ground, length, width) {
  const floor = ground.low - 0.03 * Math.max(length, width), position = [], index = [];
  for (const [a, b] of [[[0, 0], [length, 0]], [[length, 0], [length, width]], [[length, width], [0, width]], [[0, width], [0, 0]]]) {
    const parts = Math.max(1, Math.ceil(Math.hypot(b[0] - a[0], b[1] - a[1]) / ground.step));
    for (let k = 0; k <= parts; ++k) {
      const x = a[0] + ((b[0] - a[0]) * k) / parts, z = a[1] + ((b[1] - a[1]) * k) / parts, at = position.length / 3;
      position.push(x, ground.at(x, z), -z, x, floor, -z);
      if (k < parts) index.push(at, at + 1, at + 2, at + 2, at + 1, at + 3);
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(position, 3));
  geometry.setIndex(index);
  geometry.computeVertexNormals();
  return new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({ color: 0x8b7a61, roughness: 1, side: THREE.DoubleSide }));
}

const inside = ([x, z], ring) => ring.reduce((is, a, k) => {
  const b = ring[(k + ring.length - 1) % ring.length];
  return a[1] > z !== b[1] > z && x < a[0] + ((b[0] - a[0]) * (z - a[1])) / (b[1] - a[1]) ? !is : is;
}, false);

/** Returns outlines with their holes. A ring is a hole if it lies within an odd number of other rings. */
function shapesOf(rings) {
  const around = rings.map((ring) => rings.filter((other) => other !== ring && inside(ring[0], other)));
  return rings.flatMap((ring, k) => {
    if (around[k].length % 2) return [];
    const shape = new THREE.Shape(ring.map(([x, z]) => new THREE.Vector2(x, z)));
    shape.holes = rings.filter((_, h) => around[h].length % 2 && around[h].includes(ring)).map((hole) => new THREE.Path(hole.map(([x, z]) => new THREE.Vector2(x, z))));
    return [{ shape, ring }];
  });
}

function facade() {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 128;
  const c = canvas.getContext('2d');
  c.fillStyle = '#ffffff';
  c.fillRect(0, 0, 128, 128);
  c.fillStyle = '#f7f3ea';
  c.fillRect(38, 30, 52, 58);
  c.fillStyle = '#55636f';
  c.fillRect(42, 34, 21, 50);
  c.fillRect(66, 34, 20, 50);
  c.fillStyle = 'rgba(60,50,40,0.18)';
  c.fillRect(0, 122, 128, 6);
  const texture = new THREE.CanvasTexture(canvas);
  texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.anisotropy = 8;
  return texture;
}

/** All houses in two draw calls: walls with a row of windows for each storey, and roofs. */
function houses(list, ground) {
  const walls = { position: [], uv: [], color: [] }, roofs = { position: [], uv: [], color: [] };
  list.forEach((house, number) => {
    const storey = Math.min(3, house.height), wall = new THREE.Color(WALLS[number % WALLS.length]), roof = new THREE.Color(ROOFS[(number * 3) % ROOFS.length]);
    for (const { shape, ring } of shapesOf(house.rings)) {
      const grounds = ring.map(([x, z]) => ground.at(x, z)), low = Math.min(...grounds) - 0.05 * storey, top = grounds.reduce((a, b) => a + b, 0) / grounds.length + house.height;
      for (const line of [shape, ...shape.holes]) {
        const points = line.getPoints(), clockwise = THREE.ShapeUtils.isClockWise(points) !== (line !== shape);
        points.forEach((a, k) => {
          const b = points[(k + 1) % points.length], wide = a.distanceTo(b), windows = Math.max(1, Math.round(wide / (1.2 * storey)));
          const [left, right] = clockwise ? [b, a] : [a, b], v = (y) => (y - top) / storey;
          for (const [p, y, u] of [[left, low, 0], [right, low, 1], [right, top, 1], [left, low, 0], [right, top, 1], [left, top, 0]]) {
            walls.position.push(p.x, y, -p.y);
            walls.uv.push(u * windows, v(y));
            walls.color.push(wall.r, wall.g, wall.b);
          }
        });
      }
      const flat = new THREE.ShapeGeometry(shape).toNonIndexed().attributes.position;
      for (let k = 0; k < flat.count; ++k) {
        roofs.position.push(flat.getX(k), top, -flat.getY(k));
        roofs.uv.push(flat.getX(k), flat.getY(k));
        roofs.color.push(roof.r, roof.g, roof.b);
      }
    }
  });
  return [[walls, facade()], [roofs, null]].filter(([parts]) => parts.position.length).map(([parts, map]) => {
    const geometry = new THREE.BufferGeometry();
    for (const [name, size] of [['position', 3], ['uv', 2], ['color', 3]]) geometry.setAttribute(name, new THREE.Float32BufferAttribute(parts[name], size));
    geometry.computeVertexNormals();
    const mesh = new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({ map, vertexColors: true, roughness: 0.92, side: THREE.DoubleSide }));
    mesh.castShadow = mesh.receiveShadow = true;
    return mesh;
  });
}

/** A wall along points, from the ground to a height above it or to a level, whichever is higher. */
function wallAlong(points, ground, above, level, material) {
  const position = [], index = [];
  points.slice(1).forEach((b, k) => {
    const a = points[k], parts = Math.max(1, Math.ceil(Math.hypot(b[0] - a[0], b[1] - a[1]) / ground.step));
    for (let i = 0; i <= parts; ++i) {
      const x = a[0] + ((b[0] - a[0]) * i) / parts, z = a[1] + ((b[1] - a[1]) * i) / parts, y = ground.at(x, z), at = position.length / 3;
      position.push(x, Math.max(y + above, level), -z, x, y - 0.1, -z);
      if (i < parts) index.push(at, at + 1, at + 2, at + 2, at + 1, at + 3);
    }
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(position, 3));
  geometry.setIndex(index);
  geometry.computeVertexNormals();
  return new THREE.Mesh(geometry, material);
}

const middle = (points) => [0, 1].map((k) => points.reduce((sum, p) => sum + p[k], 0) / points.length);

// Makes a label, `high` in metres. Seen from near it takes no more than a twentieth of the picture.
function label(text, [x, z], ground, high, colour) {
  const sprite = textSprite(text, colour, high);
  sprite.position.copy(place(x, ground.at(x, z) + 2.2 * high, z));
  sprite.userData.scale = sprite.scale.clone();
  sprite.onBeforeRender = (renderer, scene, camera) => {
    const share = camera.isPerspectiveCamera ? Math.min(1, (0.05 * camera.position.distanceTo(sprite.position)) / high) : 1;
    sprite.scale.copy(sprite.userData.scale).multiplyScalar(share);
  };
  return sprite;
}

/** All that stands in a site. userData: stars that turn, gates that open, as those of makeGround. */
export function makeSite(scene, described, ground) {
  const world = new THREE.Group(), { length_m: length, width_m: width } = scene.world, size = Math.max(length, width), high = size / 55;
  world.add(terrain(ground, length, width), sides(ground, length, width), ...houses(described.houses, ground));
  world.userData.stars = [];
  const fence = new THREE.MeshStandardMaterial({ color: SAFE, transparent: true, opacity: 0.55, side: THREE.DoubleSide, depthWrite: false });
  for (const { name, rings } of described.shelters) {
    for (const ring of rings) world.add(wallAlong([...ring, ring[0]], ground, size / 160, -Infinity, fence));
    if (!rings.length) continue;
    const [x, z] = middle(rings[0]), star = goal(x, z, 1.5, STAR);
    star.position.y = ground.at(x, z);
    star.scale.setScalar(size / 160);
    world.add(star, label(name || 'shelter', [x, z], ground, high, '#00513b'));
    world.userData.stars.push(star.userData.star);
  }
  const blue = new THREE.MeshStandardMaterial({ color: WATER, transparent: true, opacity: 0.5, side: THREE.DoubleSide, depthWrite: false });
  for (const [list, word] of [[described.sources, 'source'], [described.outlets, 'outlet']]) {
    for (const { name, rings, line } of list) {
      const lines = rings.map((ring) => [...ring, ring[0]]).concat(line.length ? [line] : []);
      for (const one of lines) world.add(wallAlong(one, ground, size / 300, -Infinity, blue));
      if (lines.length) world.add(label(name || word, middle(lines[0]), ground, 0.7 * high, '#0b3d66'));
    }
  }
  const concrete = new THREE.MeshStandardMaterial({ color: 0x7c7f82, roughness: 0.9, side: THREE.DoubleSide });
  const gates = described.gates.map(({ name, crest, opens_at: opens, line }) => {
    const gate = new THREE.Group(), top = crest ?? (described.highest_water ?? -Infinity) + size / 400;
    gate.add(wallAlong(line, ground, crest === null ? size / 200 : 0, top, concrete), label(name || (opens === null ? 'wall' : 'gate'), middle(line), ground, 0.7 * high, '#3a3a40'));
    gate.userData.opens = opens ?? Infinity;
    return gate;
  });
  if (gates.length) world.add(...gates);
  world.userData.at = (time) => gates.forEach((gate) => (gate.visible = time < gate.userData.opens));
  const several = scene.crowd.groups.length > 1;
  for (const g of goalsOf(scene)) {
    const star = goal(g.x, g.z, scene.crowd.goal_radius_m, several && g.groups.length === 1 ? new THREE.Color(GROUP_COLOURS[g.groups[0] % GROUP_COLOURS.length]) : new THREE.Color(STAR));
    star.position.y = ground.at(g.x, g.z);
    world.add(star);
    world.userData.stars.push(star.userData.star);
  }
  return world;
}

/** A grid over the channel: depth, momentum and what the surface needs of them. */
export class Grid {
  constructor(x0, x1, z0, z1, cell, groundAt = () => 0) {
    Object.assign(this, { x0, z0, cell });
    this.nx = Math.max(2, Math.round((x1 - x0) / cell));
    this.nz = Math.max(2, Math.round((z1 - z0) / cell));
    const n = this.nx * this.nz;
    for (const name of ['depth', 'vx', 'vz', 'part', 'bed']) this[name] = new Float32Array(n);
    for (let c = 0; c < n; ++c) this.bed[c] = groundAt(x0 + cell * ((c % this.nx) + 0.5), z0 + cell * (Math.floor(c / this.nx) + 0.5));
  }

  /** Each particle's volume, dealt over a cone; walls keep it in, so that depth does not fall off beside them. */
  splat(arrays, count, reach) {
    const [x, , z, vx, , vz, volume] = arrays, { nx, nz, cell, depth, vx: mx, vz: mz } = this;
    depth.fill(0);
    mx.fill(0);
    mz.fill(0);
    const r = Math.max(1, Math.min(4, reach / cell)), wide = Math.ceil(r);
    const weight = new Float32Array((2 * wide + 1) ** 2), inside = (k, n) => (k < 0 ? -1 - k : k >= n ? 2 * n - 1 - k : k);
    for (let i = 0; i < count; ++i) {
      const gx = (x[i] - this.x0) / cell - 0.5, gz = (z[i] - this.z0) / cell - 0.5;
      const ci = Math.round(gx), cj = Math.round(gz);
      if (ci < -1 || cj < -1 || ci > nx || cj > nz) continue;
      let sum = 0, k = 0;
      for (let b = -wide; b <= wide; ++b) {
        for (let a = -wide; a <= wide; ++a, ++k) {
          const d = 1 - ((ci + a - gx) ** 2 + (cj + b - gz) ** 2) / ((r + 0.7) ** 2);
          weight[k] = d > 0 ? d * d : 0;
          sum += weight[k];
        }
      }
      k = 0;
      const share = volume[i] / (sum * cell * cell);
      for (let b = -wide; b <= wide; ++b) {
        const row = nx * inside(cj + b, nz);
        for (let a = -wide; a <= wide; ++a, ++k) {
          if (weight[k] === 0) continue;
          const at = row + inside(ci + a, nx), d = share * weight[k];
          depth[at] += d;
          mx[at] += d * vx[i];
          mz[at] += d * vz[i];
        }
      }
    }
    for (let c = 0; c < depth.length; ++c) if (depth[c] > 0) (mx[c] /= depth[c]), (mz[c] /= depth[c]);
  }

  /** Puts volumes, m3, into the cells that they lie in. */
  fill(count, of) {
    const { nx, nz, cell, depth, vx, vz } = this;
    for (const field of [depth, vx, vz]) field.fill(0);
    for (let k = 0; k < count; ++k) {
      const [x, z, volume, u, v] = of(k), i = Math.floor((x - this.x0) / cell), j = Math.floor((z - this.z0) / cell);
      if (!(volume > 0) || i < 0 || j < 0 || i >= nx || j >= nz) continue;
      const d = volume / (cell * cell), at = j * nx + i;
      depth[at] += d;
      vx[at] += d * u;
      vz[at] += d * v;
    }
    for (let c = 0; c < depth.length; ++c) if (depth[c] > 0) (vx[c] /= depth[c]), (vz[c] /= depth[c]);
  }

  /** Depths of another grid, which know no velocity: that of the scene's stream stands for it, drawn only as ripples. */
  resample(message, stream) {
    const { nx, nz, cell, depth } = this, from = message.arrays[0], rows = message.count / message.columns;
    for (let j = 0; j < nz; ++j) {
      for (let i = 0; i < nx; ++i) {
        const gx = (this.x0 + (i + 0.5) * cell - message.x0) / message.cell - 0.5;
        const gz = (this.z0 + (j + 0.5) * cell - message.z0) / message.cell - 0.5;
        const a = Math.max(0, Math.min(message.columns - 2, Math.floor(gx))), b = Math.max(0, Math.min(rows - 2, Math.floor(gz)));
        const s = Math.min(1, Math.max(0, gx - a)), t = Math.min(1, Math.max(0, gz - b)), at = b * message.columns + a;
        const low = from[at] + s * (from[at + 1] - from[at]);
        const high = from[at + message.columns] + s * (from[at + message.columns + 1] - from[at + message.columns]);
        depth[j * nx + i] = low + t * (high - low);
      }
    }
    this.vx.fill(-stream);
    this.vz.fill(0);
  }

  /** Evens out single particles: `times` passes of a small kernel over a field; volume stays. */
  smooth(field, times) {
    const { nx, nz, part } = this;
    for (; times > 0; --times) {
      part.set(field);
      for (let j = 0; j < nz; ++j) {
        const up = nx * Math.max(0, j - 1), down = nx * Math.min(nz - 1, j + 1), row = nx * j;
        for (let i = 0; i < nx; ++i) {
          const l = Math.max(0, i - 1), r = Math.min(nx - 1, i + 1);
          field[row + i] = 0.5 * part[row + i] + 0.125 * (part[row + l] + part[row + r] + part[up + i] + part[down + i]);
        }
      }
    }
  }

  at(x, z) {
    const i = Math.floor((x - this.x0) / this.cell), j = Math.floor((z - this.z0) / this.cell);
    return i < 0 || j < 0 || i >= this.nx || j >= this.nz ? 0 : this.depth[j * this.nx + i];
  }
}
