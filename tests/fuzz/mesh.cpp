#include "engine/mesh/files/inp_file.h"
#include "engine/mesh/files/tet_file.h"
#include "engine/mesh/mesh_check.h"
#include "tests/fuzz/targets.h"

#include <string_view>

namespace ringdown::fuzz {

// TetGen's two files stand one after the other, parted by a zero byte.
void mesh(Bytes file) {
  if (file.empty()) return;
  const auto kind = static_cast<char>(file.front());
  const Bytes rest = file.subspan(1);
  const std::string_view text(reinterpret_cast<const char*>(rest.data()), rest.size());
  Result<ringdown::mesh::TetMesh> read = fail(ErrorKind::bad_input, "");
  if (kind == 't') {
    const std::size_t end = std::min(text.find('\0'), text.size());
    read = ringdown::mesh::read_tetgen(text.substr(0, end), text.substr(std::min(end + 1, text.size())), "x");
  } else if (kind == 'v') {
    read = ringdown::mesh::read_vega(text, "x.veg");
  } else if (kind == 'a') {
    read = ringdown::mesh::read_inp(text, "x.inp");
  } else {
    read = ringdown::mesh::read_isostuffer(rest, "x.tet");
  }
  if (!read) return expect(!read.error().message.empty(), "a refusal has a sentence");
  expect(read->nodes.rows() > 0 && read->elements.rows() > 0 && read->nodes.allFinite(),
         "a mesh has nodes and elements");
  expect(read->order() == 1 || read->order() == 2, "elements have 4 or 10 nodes");
  expect(read->elements.minCoeff() >= 0 && read->elements.maxCoeff() < read->nodes.rows(), "an element's nodes exist");
  expect(static_cast<std::size_t>(read->nodes.rows() + read->elements.rows()) < file.size(),
         "memory is as large as the file");
  const auto checked = ringdown::mesh::check_mesh(*read, "x");
  expect(checked || !checked.error().message.empty(), "a mesh is checked or refused");
}

}  // namespace ringdown::fuzz
