// node check_scene.js FILE...: holds binary glTF files against what the drafts KHR_physics_rigid_bodies, KHR_implicit_shapes and
// KHR_audio_rigid_bodies allow: which members each object has, which it must have, their types, ranges and words, and that
// every number of another thing names one. A line for each fault; exit code 1 when there is one.
const fs = require("fs");

const number = (low = -Infinity, high = Infinity, open = false) => (v) =>
  typeof v === "number" && Number.isFinite(v) && (open ? v > low : v >= low) && v <= high;
const flag = (v) => typeof v === "boolean";
const text = (v) => typeof v === "string";
const word = (...words) => (v) => words.includes(v);
const list = (of, least, most = least) => (v) =>
  Array.isArray(v) && v.length >= least && v.length <= most && v.every(of);
const axis = word(0, 1, 2);
const axes = (v) => list(axis, 1, 3)(v) && new Set(v).size === v.length;
const unit = (v) => list(number(-1, 1), 4)(v) && Math.abs(Math.hypot(...v) - 1) < 1e-3;
const systems = (v) => list(text, 1, 1e6)(v) && new Set(v).size === v.length;
const names = (where) => ({ where });  // a number of an element of that list
const object = (kind) => ({ kind });
const objects = (kind) => ({ kinds: kind });

const kPhysics = "KHR_physics_rigid_bodies", kShapes = "KHR_implicit_shapes", kAudio = "KHR_audio_rigid_bodies";
const accessor = names((file) => file.accessors);
const extended = (extension, key) => names((file) => file.extensions?.[extension]?.[key]);

// Of each kind of object its members; those with a "!" must be there. `one` members exclude each other.
const kKinds = {
  physics: { physicsMaterials: objects("physicsMaterial"), collisionFilters: objects("filter"), physicsJoints: objects("joint") },
  physicsMaterial: { staticFriction: number(0), dynamicFriction: number(0), restitution: number(0),
                     frictionCombine: word("average", "minimum", "maximum", "multiply"),
                     restitutionCombine: word("average", "minimum", "maximum", "multiply") },
  filter: { collisionSystems: systems, collideWithSystems: systems, notCollideWithSystems: systems },
  joint: { limits: objects("limit"), drives: objects("drive") },
  limit: { linearAxes: axes, angularAxes: axes, min: number(), max: number(), stiffness: number(0, Infinity, true),
           damping: number(0) },
  drive: { "type!": word("linear", "angular"), "mode!": word("force", "acceleration"), "axis!": axis, maxForce: number(0),
           positionTarget: number(), velocityTarget: number(), stiffness: number(0), damping: number(0) },
  physicsNode: { motion: object("motion"), collider: object("collider"), trigger: object("trigger"),
                 joint: object("nodeJoint") },
  motion: { isKinematic: flag, mass: number(0), centerOfMass: list(number(), 3), inertiaDiagonal: list(number(0), 3),
            inertiaOrientation: unit, linearVelocity: list(number(), 3), angularVelocity: list(number(), 3),
            gravityFactor: number() },
  collider: { "geometry!": object("geometry"), physicsMaterial: extended(kPhysics, "physicsMaterials"),
              collisionFilter: extended(kPhysics, "collisionFilters") },
  trigger: { geometry: object("geometry"), nodes: list(number(0), 1, 1e6), collisionFilter: extended(kPhysics, "collisionFilters") },
  geometry: { shape: extended(kShapes, "shapes"), node: names((file) => file.nodes), convexHull: flag },
  nodeJoint: { "connectedNode!": names((file) => file.nodes), "joint!": extended(kPhysics, "physicsJoints"),
               enableCollision: flag },
  shapes: { "shapes!": objects("shape") },
  shape: { "type!": text, box: object("box"), sphere: object("sphere"), capsule: object("capsule"),
           cylinder: object("capsule"), plane: object("plane") },
  box: { size: list(number(0), 3) },
  sphere: { radius: number(0) },
  capsule: { height: number(0, Infinity, true), radiusBottom: number(0), radiusTop: number(0) },
  plane: { sizeX: number(0, Infinity, true), sizeZ: number(0, Infinity, true), doubleSided: flag },
  audio: { modalModels: objects("model"), acousticMaterials: objects("acousticMaterial"), acousticSurfaces: objects("surface") },
  model: { name: text, "frequencies!": accessor, "decayRates!": accessor, "positions!": accessor, "shapes!": accessor,
           indices: accessor, material: extended(kAudio, "acousticMaterials"), massProperties: object("mass") },
  mass: { "mass!": number(0, Infinity, true), centerOfMass: list(number(), 3), inertiaDiagonal: list(number(0), 3),
          inertiaOrientation: unit },
  acousticMaterial: { name: text, density: number(0, Infinity, true), youngsModulus: number(0, Infinity, true),
                      poissonRatio: number(-1, 0.5, true), alpha: number(0), beta: number(0) },
  surface: { name: text, roughness: number(0), correlationLength: number(0, Infinity, true), spectralSlope: number(),
             shortWavelength: number(0, Infinity, true), waviness: number(0), wavinessLength: number(0, Infinity, true),
             profile: accessor, sampleSpacing: number(0, Infinity, true), normalTexture: (v) => typeof v === "object",
             material: extended(kAudio, "acousticMaterials") },
  audioNode: { modalModel: extended(kAudio, "modalModels"), acousticSurface: extended(kAudio, "acousticSurfaces"),
               gain: number(0) },
};

let faults = 0;
function fault(where, what) {
  console.log(`${where}: ${what}`);
  ++faults;
}

function check(file, value, kind, where) {
  if (typeof value !== "object" || value === null || Array.isArray(value)) return fault(where, "is no object");
  const rules = kKinds[kind];
  for (const key of Object.keys(rules)) {
    if (key.endsWith("!") && value[key.slice(0, -1)] === undefined) fault(where, `lacks ${key.slice(0, -1)}`);
  }
  for (const [key, member] of Object.entries(value)) {
    const at = `${where}.${key}`, rule = rules[key] ?? rules[key + "!"];
    if (key === "extensions" || key === "extras") continue;
    if (!rule) fault(at, "is not in the draft");
    else if (typeof rule === "function") rule(member) || fault(at, `is ${JSON.stringify(member)}`);
    else if (rule.where) {
      const all = rule.where(file);
      if (!Number.isInteger(member) || member < 0 || !(member < (all?.length ?? 0))) fault(at, `is ${member}, which names nothing`);
    } else if (rule.kind) check(file, member, rule.kind, at);
    else if (!Array.isArray(member) || member.length === 0) fault(at, "is no list with elements");
    else member.forEach((element, k) => check(file, element, rule.kinds, `${at}[${k}]`));
  }
  if (kind === "geometry" && (value.shape === undefined) === (value.node === undefined)) fault(where, "must name a shape or a node");
  if (kind === "limit" && (value.linearAxes === undefined) === (value.angularAxes === undefined)) fault(where, "must hold linear or angular axes");
  if (kind === "shape" && !value[value.type]) fault(where, `lacks ${value.type}`);
  if (kind === "surface" && value.profile !== undefined && value.sampleSpacing === undefined) fault(where, "lacks sampleSpacing");
  if (kind === "model") checkModel(file, value, where);
}

// Types and counts of the arrays of a model.
function checkModel(file, model, where) {
  const of = (key) => file.accessors?.[model[key]];
  const expect = (key, type, components, count) => {
    const found = of(key);
    if (!found) return;
    if (found.type !== type || !components.includes(found.componentType)) fault(`${where}.${key}`, "is of another type");
    if (count !== undefined && found.count !== count) fault(`${where}.${key}`, `has ${found.count} elements, not ${count}`);
  };
  const modes = of("frequencies")?.count, points = of("positions")?.count;
  expect("frequencies", "SCALAR", [5126]);
  expect("decayRates", "SCALAR", [5126], modes);
  expect("positions", "VEC3", [5126]);
  expect("shapes", "VEC3", [5126], modes * points);
  expect("indices", "SCALAR", [5123, 5125]);
}

for (const name of process.argv.slice(2)) {
  const bytes = fs.readFileSync(name);
  const file = JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)).toString());
  const kinds = { [kPhysics]: ["physics", "physicsNode"], [kShapes]: ["shapes"], [kAudio]: ["audio", "audioNode"] };
  for (const [extension, [ofFile, ofNode]] of Object.entries(kinds)) {
    const own = file.extensions?.[extension], nodes = file.nodes ?? [];
    const used = own || nodes.some((node) => node.extensions?.[extension]);
    if (used && !file.extensionsUsed?.includes(extension)) fault(name, `does not say that it uses ${extension}`);
    if (own) check(file, own, ofFile, extension);
    nodes.forEach((node, k) => {
      const part = node.extensions?.[extension];
      if (part !== undefined && ofNode) check(file, part, ofNode, `nodes[${k}].${extension}`);
    });
  }
  console.log(`${name}: checked`);
}
process.exit(faults > 0 ? 1 : 0);
