// node unpack.js MESHOPTIMIZER FOLDER FILE...: writes each binary glTF file to FOLDER, with the views that are compressed
// (EXT_meshopt_compression) as plain ones, decoded by npm's meshoptimizer. Prints how many views those were.
const fs = require("fs");
const path = require("path");

const kExtension = "EXT_meshopt_compression";
const [library, folder, ...files] = process.argv.slice(2);
const decoder = require(path.resolve(library, "meshopt_decoder.js"));

function padded(bytes, filler) {
  return Buffer.concat([bytes, Buffer.alloc(-bytes.length & 3, filler)]);
}

function chunk(kind, bytes) {
  const head = Buffer.alloc(8);
  head.writeUInt32LE(bytes.length, 0);
  head.write(kind, 4, "latin1");
  return Buffer.concat([head, bytes]);
}

function unpack(file) {
  const size = file.readUInt32LE(12);
  const json = JSON.parse(file.subarray(20, 20 + size).toString());
  const binary = file.subarray(28 + size);
  const parts = [];
  let offset = 0, count = 0;
  for (const view of json.bufferViews) {
    const packing = view.extensions?.[kExtension];
    const { byteOffset = 0, byteLength } = packing ?? view;
    let bytes = binary.subarray(byteOffset, byteOffset + byteLength);
    if (packing) {
      const target = new Uint8Array(view.byteLength);
      decoder.decodeGltfBuffer(target, packing.count, packing.byteStride, bytes, packing.mode, packing.filter ?? "NONE");
      bytes = Buffer.from(target);
      delete view.extensions;
      ++count;
    }
    view.buffer = 0;
    view.byteOffset = offset;
    parts.push(padded(bytes));
    offset += parts.at(-1).length;
  }
  json.buffers = [{ byteLength: offset }];
  for (const list of ["extensionsUsed", "extensionsRequired"]) {
    json[list] = json[list]?.filter((name) => name !== kExtension);
    if (!json[list]?.length) delete json[list];
  }
  const chunks = Buffer.concat([chunk("JSON", padded(Buffer.from(JSON.stringify(json)), " ")), chunk("BIN\0", Buffer.concat(parts))]);
  const head = Buffer.from("glTF\x02\0\0\0\0\0\0\0", "latin1");
  head.writeUInt32LE(head.length + chunks.length, 8);
  return [Buffer.concat([head, chunks]), count];
}

decoder.ready.then(() => {
  for (const name of files) {
    const [plain, count] = unpack(fs.readFileSync(name));
    fs.writeFileSync(path.join(folder, path.basename(name)), plain);
    console.log(`${path.basename(name)}: ${count} compressed views`);
  }
});
