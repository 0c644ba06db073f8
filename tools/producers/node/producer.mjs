#!/usr/bin/env node
// Plays the known stream of ../README.md from JavaScript, straight into the shared memory, through libwade_shm.so.
// The addon is found in build/release or where WADE_NODE_ADDON says.
import { createRequire } from "node:module";
import { existsSync } from "node:fs";
import { fileURLToPath } from "node:url";

const MASS_KG = 100, HEIGHT_M = 0.23, FRAME_RATE_HZ = 30;
const SPACING_M = 0.4642, ROWS = 50, FIRST_X_M = 60, FIRST_Z_M = 12, LENGTH_M = 100;
const USAGE = "Usage: producer.mjs [SCENE.json] --session NAME [--frames N] [--particles N] [--speed V] [--depth D]\n" +
  "       [--scene-hash HEX] [--attach-timeout-s T] [--step-timeout-s T] [--take-people]\n" +
  "Plays the known stream of tools/producers/README.md; the scene file is not read.";

function failure(exitCode, text) {
  return Object.assign(new Error(text), { exitCode });
}

const NUMBERS = {
  "--frames": [60, 1, 1e9], "--particles": [2000, 1, 1e7], "--depth": [1, 1, 63],
  "--speed": [1.5, -100, 100], "--attach-timeout-s": [10, 0, 86400], "--step-timeout-s": [60, 0, 86400],
};
const WHOLE = new Set(["--frames", "--particles", "--depth"]);

function readNumber(name, text) {
  const [, lowest, highest] = NUMBERS[name];
  const value = text.trim() === "" ? NaN : Number(text);
  if (!(value >= lowest && value <= highest) || (WHOLE.has(name) && !Number.isInteger(value)))
    throw failure(2, `${name}: ${text} is not allowed; allowed: ${WHOLE.has(name) ? "whole " : ""}numbers from ` +
      `${lowest} to ${highest}.`);
  return value;
}

function readOptions(words) {
  const options = { "--scene-hash": 0n, "--take-people": false };
  for (const name in NUMBERS) options[name] = NUMBERS[name][0];
  let scenes = 0;
  for (let i = 0; i < words.length; ++i) {
    const name = words[i];
    if (name === "--help") return null;
    if (!name.startsWith("-") && scenes++ === 0) continue;
    if (name === "--take-people") {
      options[name] = true;
      continue;
    }
    const text = words[++i];
    if (text === undefined || !(name in NUMBERS || name === "--scene-hash" || name === "--session"))
      throw failure(2, `${name}: unknown, or its value is missing (--help shows the options).`);
    if (name in NUMBERS) options[name] = readNumber(name, text);
    else if (name === "--session") options[name] = text;
    else if (/^[0-9a-fA-F]{1,16}$/.test(text)) options[name] = BigInt("0x" + text);
    else throw failure(2, `--scene-hash: ${text} is not allowed; allowed: 1 to 16 hexadecimal digits.`);
  }
  if (options["--session"] === undefined) throw failure(2, "--session NAME is required.");
  return options;
}

// All steps in double precision, each value rounded to float32 by the array.
function fill(slot, particles, speed) {
  const travelled = speed * slot.frame / FRAME_RATE_HZ;
  for (let k = 0; k < particles; ++k) {
    const x = FIRST_X_M + Math.floor(k / ROWS) * SPACING_M - travelled;
    slot.mass[k] = MASS_KG;
    slot.vx[k] = -speed;
    slot.vy[k] = slot.vz[k] = 0;
    slot.px[k] = x - LENGTH_M * Math.floor(x / LENGTH_M);
    slot.py[k] = HEIGHT_M;
    slot.pz[k] = FIRST_Z_M + k % ROWS * SPACING_M;
  }
}

// v -= w J / S over the cone w = 1 - r / R round a person, S = sum of w m, so that the water loses J. What it lost by that, rounded
// to float32, and what it did not have go into the account: taken along x and z, missing along x and z.
function takeImpulse(slot, particles, person, account) {
  const weightAt = (k) => slot.py[k] > person.submerged ? 0 :
    Math.max(0, 1 - Math.hypot(slot.px[k] - person.x, slot.pz[k] - person.z) / person.spread);
  let sum = 0;
  for (let k = 0; k < particles; ++k) sum += weightAt(k) * slot.mass[k];
  if (!(sum > 0)) {
    account[2] += person.jx;
    account[3] += person.jz;
    return;
  }
  for (let k = 0; k < particles; ++k) {
    const share = weightAt(k) / sum;
    if (!(share > 0)) continue;
    const vx = slot.vx[k], vz = slot.vz[k];
    slot.vx[k] = vx - share * person.jx;
    slot.vz[k] = vz - share * person.jz;
    account[0] += slot.mass[k] * (vx - slot.vx[k]);
    account[1] += slot.mass[k] * (vz - slot.vz[k]);
  }
}

// The agents that are due before this frame push it. False: the crowd has ended.
function letPeoplePush(shm, people, slot, particles, account) {
  if (slot.frame <= people.lag) return true;
  const agents = shm.takePeople(people);
  if (agents === null) return false;
  for (let a = 0; agents.jx !== null && a < agents.count; ++a) {
    if (agents.jx[a] === 0 && agents.jz[a] === 0) continue;
    takeImpulse(slot, particles, {
      x: agents.px[a], z: agents.pz[a], jx: agents.jx[a], jz: agents.jz[a],
      submerged: agents.submerged[a], spread: agents.spread[a],
    }, account);
  }
  return true;
}

function produce(shm, options) {
  const frames = options["--frames"], particles = options["--particles"];
  shm.catchSignals();
  const waiting = { attachTimeoutS: options["--attach-timeout-s"], stepTimeoutS: options["--step-timeout-s"] };
  const publisher = shm.open(options["--session"], {
    capacity: particles, depth: options["--depth"], producerName: "producer_node", sceneHash: options["--scene-hash"],
    particleRadius: SPACING_M / 2,
    ...waiting,
  });
  try {
    shm.waitForConsumers(publisher, 1);
    const people = options["--take-people"] ? shm.joinPeople(options["--session"], waiting) : null;
    const account = people === null ? null : [0, 0, 0, 0];
    for (let frame = 1; frame <= frames; ++frame) {
      if (shm.receivedSignal() !== 0) throw failure(130, `Interrupted after frame ${frame - 1}.`);
      const slot = shm.beginFrame(publisher);
      if (slot === null) break;
      fill(slot, particles, options["--speed"]);
      if (people !== null && !letPeoplePush(shm, people, slot, particles, account)) break;
      shm.endFrame(publisher, particles, frame === frames, account);
    }
    if (people !== null) shm.leavePeople(people);
    shm.close(publisher);
  } catch (error) {
    if (shm.receivedSignal() !== 0) error.exitCode = 128 + shm.receivedSignal();
    shm.abort(publisher, error.exitCode ?? 1, error.message);
    throw error;
  }
}

try {
  const options = readOptions(process.argv.slice(2));
  if (options === null) {
    console.log(USAGE);
  } else {
    const addon = process.env.WADE_NODE_ADDON ??
      fileURLToPath(new URL("../../../build/release/producers/wade_shm_node.node", import.meta.url));
    if (!existsSync(addon)) throw failure(2, `There is no addon ${addon}: build the target wade_shm_node.`);
    produce(createRequire(import.meta.url)(addon), options);
  }
} catch (error) {
  console.error(`producer_node: ${error.message}`);
  process.exitCode = error.exitCode ?? 1;
}
