// node load_babylon.mjs FOLDER FILE...: what Babylon.js makes of each binary glTF file, without a window: a line "NAME X Y Z
// TRIANGLES" for each node in the scene, its place in the world as the file counts it.
// FOLDER/node_modules holds @babylonjs/core and @babylonjs/loaders.
import { readFileSync } from "fs";
import path from "path";
import { pathToFileURL } from "url";

const [folder, ...files] = process.argv.slice(2);
const load = (file) => import(pathToFileURL(path.resolve(folder, "node_modules/@babylonjs", file)).href);
const { Logger } = await load("core/Misc/logger.js");
Logger.LogLevels = Logger.ErrorLogLevel;
const { NullEngine } = await load("core/Engines/nullEngine.js");
const { Scene } = await load("core/scene.js");
const { ImportMeshAsync } = await load("core/Loading/sceneLoader.js");
await load("loaders/glTF/2.0/index.js");

for (const file of files) {
  const engine = new NullEngine();
  const scene = new Scene(engine);
  scene.useRightHandedSystem = true;
  await ImportMeshAsync(new Uint8Array(readFileSync(file)), scene, { pluginExtension: ".glb" });
  for (const node of [...scene.transformNodes, ...scene.meshes]) {
    node.computeWorldMatrix(true);
    const { x, y, z } = node.getAbsolutePosition();
    const triangles = node.getTotalIndices ? node.getTotalIndices() / 3 : 0;
    console.log([node.name.replaceAll(" ", "_"), x, y, z, triangles].join(" "));
  }
  engine.dispose();
}
