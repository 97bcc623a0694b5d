// The two sides of mesh files: what their reading process could send back, and files that it is given.
#include "engine/base/folders.h"
#include "engine/mesh/body_reader.h"
#include "engine/mesh/files/geo_language.h"
#include "tests/fuzz/targets.h"

#include <fstream>
#include <string_view>

namespace ringdown::fuzz {
namespace {

namespace fs = std::filesystem;

std::string_view text_of(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

void expect_body(const ringdown::mesh::Body& body) {
  const auto& [nodes, elements] = body.mesh.mesh;
  expect(nodes.rows() > 0 && elements.rows() > 0 && nodes.allFinite(), "a body has nodes and elements");
  expect(elements.minCoeff() >= 0 && elements.maxCoeff() < nodes.rows(), "an element's nodes exist");
}

void expect_skin(const ringdown::mesh::TriangleMesh& skin) {
  expect(skin.nodes.allFinite() && skin.triangles.minCoeff() >= 0 && skin.triangles.maxCoeff() < skin.nodes.rows(),
         "a triangle's corners exist");
}

constexpr const char* kEndings[] = {".geo", ".ply", ".stl", ".obj", ".msh", ".inp", ".off", ".glb", ".unv", ".vtk"};

}  // namespace

void answer(Bytes bytes) {
  ringdown::mesh::Body body;
  ringdown::mesh::Sketch sketch;
  ringdown::mesh::PreparedSurface surface;
  Error error{};
  if (unpack(text_of(bytes), body)) expect_body(body);
  if (unpack(text_of(bytes), sketch)) expect_skin(sketch.skin);
  if (unpack(text_of(bytes), surface)) {
    expect_skin(surface.mesh);
    for (const auto& finding : surface.found.findings) expect(!describe(finding).empty(), "a fault has words");
  }
  if (ringdown::mesh::unpack(text_of(bytes), error)) expect(!error.message.empty(), "a refusal has a sentence");
}

void geo(Bytes file) {
  const auto words = ringdown::mesh::words_of_geo(text_of(file));
  expect(words.size() <= file.size(), "a word has a letter");
  static_cast<void>(ringdown::mesh::files_named_by_geo(text_of(file)));
  static_cast<void>(ringdown::mesh::assigns(text_of(file), "mesh_size"));
}

// The first byte chooses the ending of the file's name.
void reader(Bytes file) {
  if (file.empty()) return;
  static const PrivateFolder folder("ringdown-fuzz");
  const auto ending = kEndings[static_cast<unsigned char>(file.front()) % std::size(kEndings)];
  const fs::path path = folder.path() / (std::string("body") + ending);
  std::ofstream(path, std::ios::binary) << text_of(file.subspan(1));
  ::setenv("RINGDOWN_MESH_SECONDS", "0.5", 0);
  ::setenv("RINGDOWN_MESH_MIB", "1000", 0);
  const auto body = ringdown::mesh::BodyReader(path).read({.order = 1, .parameters = {}});
  if (body) expect_body(*body);
  if (!body) expect(body.error().message.find("body") != std::string::npos, "a refusal names the file");
  expect(std::distance(fs::directory_iterator(folder.path()), {}) <= static_cast<long>(std::size(kEndings)),
         "the reader makes no file");
}

}  // namespace ringdown::fuzz
