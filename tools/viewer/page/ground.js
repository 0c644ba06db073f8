// What stands still: sky, light, ground, bed, walls, boxes, goals, the fall.
//
// Coordinates: the scene has x upstream, y up, z across; seen from above with x to the right, z points up the page, as in all pictures
// of Wade. That is a left-handed frame (Unity's). Three.js is right-handed, so the page draws (x, y, z) at (x, y, -z): what one sees
// is not mirrored.

import * as THREE from 'three';

export const STAR = 0xffc928;
// Of groups, where there are several: told apart by the colour-blind, too (Okabe and Ito 2008); then they repeat.
export const GROUP_COLOURS = ['#e69f00', '#cc79a7', '#f0e442', '#d55e00', '#009e73', '#56b4e9', '#0072b2', '#bbbbbb'];

const SHARP = location.hash.includes('quality=low') ? 1 : 8;

export const place = (x, y, z) => new THREE.Vector3(x, y, -z);

export function noise(width, height, seed, paint) {
  const canvas = document.createElement('canvas');
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext('2d');
  const image = context.createImageData(width, height);
  let s = seed;
  const random = () => ((s = (s * 1664525 + 1013904223) >>> 0) / 4294967296);
  const sizes = [4, 8, 16, 32, 64, 128];
  const grids = sizes.map((n) => Float32Array.from({ length: n * n }, random));
  for (let j = 0; j < height; ++j) {
    for (let i = 0; i < width; ++i) {
      let value = 0, weight = 0;
      sizes.forEach((n, k) => {
        const x = (i / width) * n, y = (j / height) * n, i0 = Math.floor(x), j0 = Math.floor(y);
        const fade = (t) => t * t * (3 - 2 * t), fx = fade(x - i0), fy = fade(y - j0);
        const at = (a, b) => grids[k][(b % n) * n + (a % n)];
        const low = at(i0, j0) + fx * (at(i0 + 1, j0) - at(i0, j0));
        const high = at(i0, j0 + 1) + fx * (at(i0 + 1, j0 + 1) - at(i0, j0 + 1));
        value += (low + fy * (high - low)) / (k + 1.5);
        weight += 1 / (k + 1.5);
      });
      const [r, g, b] = paint(value / weight, random());
      image.data.set([r, g, b, 255], 4 * (j * width + i));
    }
  }
  context.putImageData(image, 0, 0);
  const texture = new THREE.CanvasTexture(canvas);
  texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.anisotropy = SHARP;
  return texture;
}

export const mixed = (a, b, t) => a.map((v, k) => v + (b[k] - v) * Math.min(1, Math.max(0, t)));

function flat(x0, x1, z0, z1, y, material, repeat) {
  const geometry = new THREE.PlaneGeometry(x1 - x0, z1 - z0);
  const uv = geometry.attributes.uv;
  for (let k = 0; k < uv.count; ++k) uv.setXY(k, uv.getX(k) * (x1 - x0) / repeat, uv.getY(k) * (z1 - z0) / repeat);
  const mesh = new THREE.Mesh(geometry, material);
  mesh.rotation.x = -Math.PI / 2;
  mesh.position.copy(place((x0 + x1) / 2, y, (z0 + z1) / 2));
  mesh.receiveShadow = true;
  return mesh;
}

function wallTexture(wide, high) {
  const canvas = document.createElement('canvas');
  canvas.width = 256;
  canvas.height = 128;
  const c = canvas.getContext('2d');
  c.fillStyle = '#d9cfbd';
  c.fillRect(0, 0, 256, 128);
  for (let k = 0; k < 900; ++k) {
    c.fillStyle = `rgba(${90 + (k * 37) % 80},${80 + (k * 37) % 70},60,0.05)`;
    c.fillRect((k * 73) % 256, (k * 131) % 128, 5, 3);
  }
  if (high >= 2.2) {
    const windows = Math.max(1, Math.round(wide / 2.4));
    for (let k = 0; k < windows; ++k) {
      const x = (256 * (k + 0.5)) / windows - 18;
      c.fillStyle = '#f4efe4';
      c.fillRect(x - 4, 34, 44, 48);
      c.fillStyle = '#40505e';
      c.fillRect(x, 38, 17, 40);
      c.fillRect(x + 19, 38, 17, 40);
    }
  }
  c.fillStyle = 'rgba(70,58,40,0.35)';
  c.fillRect(0, 112, 256, 16);
  const texture = new THREE.CanvasTexture(canvas);
  texture.colorSpace = THREE.SRGBColorSpace;
  return texture;
}

function box(b) {
  const wide = b.x_max_m - b.x_min_m, deep = b.z_max_m - b.z_min_m, high = b.height_m ?? 2;
  const side = (w) => new THREE.MeshStandardMaterial({ map: wallTexture(w, high), roughness: 0.95 });
  const top = new THREE.MeshStandardMaterial({ color: high >= 2.2 ? 0x9c5a45 : 0x9b9689, roughness: 0.9 });
  const along = side(wide), across = side(deep);
  const mesh = new THREE.Mesh(new THREE.BoxGeometry(wide, high, deep), [across, across, top, top, along, along]);
  mesh.position.copy(place(b.x_min_m + wide / 2, high / 2, b.z_min_m + deep / 2));
  mesh.castShadow = mesh.receiveShadow = true;
  const edge = new THREE.LineSegments(new THREE.EdgesGeometry(mesh.geometry), new THREE.LineBasicMaterial({ color: 0x4a4238 }));
  mesh.add(edge);
  return mesh;
}

export function starShape(outer, inner) {
  const shape = new THREE.Shape();
  for (let k = 0; k < 10; ++k) {
    const r = k % 2 ? inner : outer, a = Math.PI / 2 + (k * Math.PI) / 5;
    shape[k ? 'lineTo' : 'moveTo'](r * Math.cos(a), r * Math.sin(a));
  }
  shape.closePath();
  return shape;
}

export function goal(x, z, radius, colour) {
  const group = new THREE.Group();
  const form = new THREE.ExtrudeGeometry(starShape(1.15, 0.5), { depth: 0.3, bevelSize: 0.06, bevelThickness: 0.06 });
  form.translate(0, 0, -0.15);
  const gold = new THREE.MeshStandardMaterial({ color: colour, roughness: 0.35, metalness: 0.3, emissive: colour, emissiveIntensity: 0.25 });
  const star = new THREE.Mesh(form, gold);
  star.position.y = 2.4;
  star.castShadow = true;
  group.add(star);
  const reach = Math.max(radius, 0.5);
  const lying = new THREE.Mesh(new THREE.ShapeGeometry(starShape(0.8 * reach, 0.36 * reach)), new THREE.MeshBasicMaterial({ color: colour }));
  lying.rotation.x = -Math.PI / 2; // as a star from above, too
  lying.position.y = 0.035;
  group.add(lying);
  const ring = new THREE.Mesh(new THREE.RingGeometry(reach - 0.09, reach, 64), new THREE.MeshBasicMaterial({ color: colour, side: THREE.DoubleSide }));
  ring.rotation.x = -Math.PI / 2;
  ring.position.y = 0.04;
  group.add(ring);
  group.position.copy(place(x, 0, z));
  group.userData.star = star;
  return group;
}

/** Whether the water leaves the world over a fall at x = 0. */
export const hasFall = (scene) => scene.channel.flow !== 'closed' && scene.world.ends !== 'periodic' && scene.channel.x_min_m <= 0.01;

export function goalsOf(scene) {
  const found = new Map();
  scene.crowd.groups.forEach((group, k) => {
    if (group.goal.to === 'shelters') return;
    const key = `${group.goal.x_m} ${group.goal.z_m}`;
    const one = found.get(key) ?? { x: group.goal.x_m, z: group.goal.z_m, groups: [] };
    one.groups.push(k);
    found.set(key, one);
  });
  return [...found.values()].slice(0, 200);
}

export function makeSky(dark) {
  const material = new THREE.ShaderMaterial({
    side: THREE.BackSide, depthWrite: false, fog: false,
    uniforms: { low: { value: new THREE.Color() }, high: { value: new THREE.Color() }, below: { value: new THREE.Color() } },
    vertexShader: 'varying vec3 d; void main() { d = position; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.); }',
    fragmentShader: `varying vec3 d; uniform vec3 low, high, below;
      void main() { float h = normalize(d).y;
        vec3 c = h > 0. ? mix(low, high, pow(h, .5)) : mix(low, below, pow(-h, .35));
        gl_FragColor = vec4(c, 1.); #include <colorspace_fragment>
      }`.replace('1.); #', '1.);\n#'),
  });
  const sky = new THREE.Mesh(new THREE.SphereGeometry(900, 32, 16), material);
  sky.userData.dark = dark;
  return sky;
}

export const LIGHTS = {
  light: { low: '#dfeaf2', high: '#6fa3d4', below: '#b9c2c2', sun: 3.0, ambient: 1.15, sunColour: '#fff3dd' },
  dark: { low: '#2c3848', high: '#0b1220', below: '#10161e', sun: 1.5, ambient: 0.55, sunColour: '#cfdcff' },
};

/** All that stands still of a scene. */
export function makeGround(scene) {
  const world = new THREE.Group();
  const { length_m: length, width_m: width } = scene.world, channel = scene.channel;
  const fall = hasFall(scene), margin = Math.max(12, 0.25 * Math.max(length, width));
  const west = fall ? 0 : -margin, east = length + margin;
  const grass = noise(256, 256, 7, (v, r) => mixed([116, 128, 84], [167, 160, 118], (v - 0.3) * 2.2).map((c) => c + 14 * (r - 0.5)));
  const bed = noise(256, 256, 19, (v, r) => mixed([128, 116, 95], [186, 170, 138], (v - 0.3) * 2.4).map((c) => c + 26 * (r - 0.5)));
  const soil = new THREE.MeshStandardMaterial({ map: grass, roughness: 1 });
  const gravel = new THREE.MeshStandardMaterial({ map: bed, roughness: 1 });
  world.add(flat(west, east, -margin, width + margin, 0, soil, 14));
  if (channel.flow !== 'closed' || (channel.water_blocks ?? []).length) {
    const x0 = fall ? 0 : channel.x_min_m;
    world.add(flat(x0, channel.x_max_m, channel.z_min_m, channel.z_max_m, 0.012, gravel, 9));
    const line = new THREE.MeshStandardMaterial({ color: 0x8d8570, roughness: 1 });
    for (const z of [channel.z_min_m, channel.z_max_m]) {
      const curb = new THREE.Mesh(new THREE.BoxGeometry(channel.x_max_m - x0, 0.1, 0.22), line);
      curb.position.copy(place((channel.x_max_m + x0) / 2, 0.05, z));
      curb.receiveShadow = true;
      world.add(curb);
    }
  }
  if (fall) world.add(...cliff(width, margin, grass));
  const border = new THREE.BufferGeometry().setFromPoints([place(0, 0.03, 0), place(length, 0.03, 0), place(length, 0.03, width), place(0, 0.03, width), place(0, 0.03, 0)]);
  world.add(new THREE.Line(border, new THREE.LineBasicMaterial({ color: 0x3c3a34, transparent: true, opacity: 0.6 })));
  for (const b of scene.obstacles ?? []) world.add(box(b));
  const several = scene.crowd.groups.length > 1;
  world.userData.stars = [];
  for (const g of goalsOf(scene)) {
    const periodic = scene.world.ends === 'periodic' && (g.x < 0 || g.x > length);
    if (periodic) continue; // a direction rather than a position
    const one = several && g.groups.length === 1 ? new THREE.Color(GROUP_COLOURS[g.groups[0] % GROUP_COLOURS.length]) : new THREE.Color(STAR);
    const mark = goal(g.x, g.z, scene.crowd.goal_radius_m ?? 1, one);
    world.userData.stars.push(mark.userData.star);
    world.add(mark);
  }
  return world;
}

const CLIFF_M = 9;

function cliff(width, margin, grass) {
  const rock = noise(256, 256, 41, (v, r) => mixed([72, 66, 60], [140, 130, 116], (v - 0.25) * 2).map((c) => c + 22 * (r - 0.5)));
  const face = new THREE.Mesh(new THREE.PlaneGeometry(width + 2 * margin, CLIFF_M, 60, 8), new THREE.MeshStandardMaterial({ map: rock, roughness: 1 }));
  const at = face.geometry.attributes.position;
  for (let k = 0; k < at.count; ++k) if (at.getY(k) < CLIFF_M / 2 - 0.1) at.setZ(k, 0.9 * Math.sin(k * 12.9898) * Math.sin(k * 4.1));
  face.geometry.attributes.uv.array.forEach((v, k, uv) => (uv[k] = v * (k % 2 ? 1 : (width + 2 * margin) / CLIFF_M)));
  face.geometry.computeVertexNormals();
  face.rotation.y = -Math.PI / 2;
  face.position.copy(place(0, -CLIFF_M / 2, width / 2));
  const pool = flat(-60, 0, -margin, width + margin, -CLIFF_M, new THREE.MeshStandardMaterial({ color: 0x3f6f86, roughness: 0.25 }), 20);
  const text = new THREE.Mesh(new THREE.PlaneGeometry(5, 1.6), new THREE.MeshBasicMaterial({ map: words('the fall'), transparent: true }));
  text.rotation.set(-Math.PI / 2, 0, Math.PI / 2);
  text.position.copy(place(1.4, 0.06, width * 0.06));
  return [face, pool, text];
}

function words(text) {
  const canvas = document.createElement('canvas');
  canvas.width = 320;
  canvas.height = 102;
  const c = canvas.getContext('2d');
  c.font = '600 62px system-ui, sans-serif';
  c.fillStyle = 'rgba(40,36,30,0.8)';
  c.textAlign = 'center';
  c.fillText(text, 160, 72);
  return new THREE.CanvasTexture(canvas);
}

/** A text that faces the eye and is `high` metres high. */
export function textSprite(text, colour, high) {
  const canvas = document.createElement('canvas'), c = canvas.getContext('2d'), font = '600 44px system-ui, sans-serif';
  c.font = font;
  canvas.width = Math.ceil(c.measureText(text).width) + 36;
  canvas.height = 64;
  c.font = font;
  c.fillStyle = 'rgba(255,255,255,0.86)';
  c.roundRect(0, 0, canvas.width, 64, 14);
  c.fill();
  c.fillStyle = colour;
  c.fillText(text, 18, 47);
  const map = new THREE.CanvasTexture(canvas);
  map.colorSpace = THREE.SRGBColorSpace;
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({ map, transparent: true, depthWrite: false, fog: false }));
  sprite.scale.set((high * canvas.width) / 64, high, 1);
  sprite.renderOrder = 7;
  return sprite;
}

/** Sky, fog, sun and ambient light of the day or the night, for a world of this size, m; returns what was taken of LIGHTS. */
export function lightUp(stage, sky, sun, ambient, dark, size) {
  const l = LIGHTS[dark ? 'dark' : 'light'];
  for (const name of ['low', 'high', 'below']) sky.material.uniforms[name].value.set(l[name]);
  stage.fog = new THREE.Fog(l.low, Math.max(160, size), Math.max(620, 5 * size));
  sun.intensity = l.sun;
  sun.color.set(l.sunColour);
  ambient.intensity = l.ambient;
  return l;
}

/** Lets the sun throw shadows over what lies up to `half` from the centre. */
export function castShadows(sun, centre, reach, half) {
  sun.position.copy(centre).add(new THREE.Vector3(0.35 * reach, 0.9 * reach, 0.5 * reach));
  sun.target.position.copy(centre);
  Object.assign(sun.shadow.camera, { left: -half, right: half, top: half, bottom: -half, near: 1, far: 4 * reach });
  sun.shadow.camera.updateProjectionMatrix();
  sun.shadow.mapSize.set(2048, 2048);
  sun.shadow.bias = -0.0008;
  sun.shadow.normalBias = 0.03;
  sun.castShadow = true;
}

/** The part of the picture, -1 to 1 along both axes, that no panel covers: left, right, low, high. */
export const inner = (wide, high, above, below) => [-0.94, 0.94, -1 + (2 * (below + 10)) / high, 1 - (2 * (above + 10)) / high];

/** Puts a camera so near that all points are seen within a part of the picture, along a direction from them to the camera. */
export function fit(camera, points, direction, [left, right, low, high]) {
  camera.position.set(0, 0, 0);
  camera.up.set(0, 1, 0);
  camera.lookAt(direction.clone().negate());
  camera.updateMatrixWorld();
  const [x, y, back] = [0, 1, 2].map((k) => new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, k));
  const tangent = Math.tan((camera.fov * Math.PI) / 360), most = (f) => points.reduce((m, p) => Math.max(m, f(p)), -Infinity);
  // Of each axis: where the two outermost rays that bound the points meet.
  const along = [[x, -left * tangent * camera.aspect, right * tangent * camera.aspect], [y, -low * tangent, high * tangent]].map(([axis, below, above]) => {
    const a = most((p) => p.dot(axis) + above * p.dot(back)), b = most((p) => -p.dot(axis) + below * p.dot(back));
    return { near: (a + b) / (above + below), at: (d) => (a - above * d + below * d - b) / 2 };
  });
  const far = Math.max(along[0].near, along[1].near);
  camera.position.copy(x.multiplyScalar(along[0].at(far))).addScaledVector(y, along[1].at(far)).addScaledVector(back, far);
  camera.updateMatrixWorld();
}

/** Sets a camera over the world up to `high`, as the paper's pictures are seen from, within a part of the picture; share: of the
 * window's width in its height. */
export function lookDown(camera, [length, width, high = 0], share, [left, right, low, above]) {
  const half = Math.max((1.06 * width + 4) / (above - low), (1.04 * length) / (share * (right - left))), x = (left + right) / 2, y = (low + above) / 2;
  Object.assign(camera, { left: -half * share * (1 + x), right: half * share * (1 - x), top: half * (1 - y), bottom: -half * (1 + y) });
  camera.position.copy(place(length / 2, high + 300, width / 2));
  camera.up.set(0, 0, -1); // z points up the page
  camera.lookAt(place(length / 2, 0, width / 2));
  camera.updateProjectionMatrix();
}
