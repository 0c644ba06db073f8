// Makes the grids of columns.txt, as JSON on stdin, columns by the addon: node columns.mjs ADDON SESSION. Prints for each its stream
// and particles, or what was refused, as JSON.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const [, , addon, session] = process.argv;
const shm = createRequire(import.meta.url)(addon);
const FIELDS = ["mass", "vx", "vy", "vz", "px", "py", "pz"];

function columnsOf(grid) {
  for (const name in grid)  // JSON knows no NaN and no infinity
    grid[name] = Array.isArray(grid[name]) ? Float64Array.from(grid[name], Number) : Number(grid[name]);
  let publisher = null;
  try {
    const stream = shm.columnStream(grid);
    publisher = shm.open(session, { ...stream, producerName: "columns" });
    const slot = shm.beginFrame(publisher);
    const count = shm.columns(publisher, grid);
    const particles = Array.from({ length: count }, (_, k) => FIELDS.map((name) => slot[name][k]));
    shm.endFrame(publisher, count, true, null);
    let late = "";
    try {
      shm.columns(publisher, grid);
    } catch (error) {
      late = error.message;
    }
    shm.close(publisher);
    return { stream: [...stream.columnWidth, stream.capacity], particles, late };
  } catch (error) {
    if (publisher !== null) shm.abort(publisher, 1, error.message);
    return { refused: error.message, exitCode: error.exitCode };
  }
}

console.log(JSON.stringify(JSON.parse(readFileSync(0, "utf-8")).map(columnsOf)));
