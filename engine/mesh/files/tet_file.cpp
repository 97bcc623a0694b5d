#include "engine/mesh/files/tet_file.h"

#include "engine/base/file_format.h"
#include "engine/mesh/files/inp_file.h"
#include "engine/mesh/files/text_lines.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <utility>
#include <vector>

namespace ringdown::mesh {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uintmax_t kMaxFileBytes = 4'000'000'000;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

struct Counts {
  std::int64_t rows = 0, second = 0;
};

// "count second ..." where each number of a row that is announced takes at least two characters of what is left.
Result<Counts> read_counts(TextLines& lines, const char* what) {
  Counts counts;
  lines.next();
  if (!lines.read(0, counts.rows) || !lines.read(1, counts.second)) {
    return lines.wrong(formatted("the number of {} is missing here, and how many numbers each has", what));
  }
  if (counts.rows < 1) return lines.wrong(std::string("there are no ") + what);
  const auto width = static_cast<std::uint64_t>(std::clamp<std::int64_t>(counts.second, 1, 10)) + 1;
  if (static_cast<std::uint64_t>(counts.rows) > (lines.characters_left() + 1) / (2 * width)) {
    return lines.wrong(formatted("it announces {} {}, more than the rest of the file can hold", counts.rows, what));
  }
  return counts;
}

// Rows "number x y z ...", numbered one by one from 0 or 1. Returns that first number.
Result<std::int64_t> read_nodes(TextLines& lines, std::int64_t count, Points& nodes) {
  nodes.resize(count, 3);
  std::int64_t first = 0;
  for (std::int64_t n = 0; n < count; ++n) {
    if (lines.next().empty()) return lines.wrong("the file ends before its last node");
    std::int64_t number = 0;
    if (!lines.read(0, number)) return lines.wrong("a node should begin with its number");
    if (n == 0) first = number;
    if (first != 0 && first != 1) return lines.wrong("nodes should be numbered from 0 or 1");
    if (number != first + n) return lines.wrong(formatted("this should be node {}", first + n));
    for (int k = 0; k < 3; ++k) {
      if (!lines.read(1 + k, nodes(n, k))) return lines.wrong("a node should have three finite coordinates");
    }
  }
  return first;
}

// Rows "number a b c d ...", their numbers one by one from any first one. `first`: the number of the first node.
Result<void> read_elements(TextLines& lines, std::int64_t count, std::int64_t first, std::int64_t nodes,
                           Indices& elements) {
  std::int64_t first_element = 0;
  for (std::int64_t e = 0; e < count; ++e) {
    if (lines.next().empty()) return lines.wrong("the file ends before its last element");
    std::int64_t number = 0;
    if (!lines.read(0, number)) return lines.wrong("an element should begin with its number");
    if (e == 0) first_element = number;
    if (number - e != first_element) return lines.wrong("elements should be numbered one by one");
    for (Eigen::Index c = 0; c < elements.cols(); ++c) {
      std::int64_t node = 0;
      if (!lines.read(1 + c, node)) return lines.wrong(formatted("an element should have {} nodes", elements.cols()));
      if (node < first || node >= first + nodes) return lines.wrong(formatted("there is no node {}", node));
      elements(e, c) = static_cast<std::int32_t>(node - first);
    }
  }
  return {};
}

// Programs disagree on the order of the nodes on edges; where they lie settles it.
bool sort_edge_nodes(TetMesh& mesh, Eigen::Index element) {
  const Eigen::Matrix<std::int32_t, 1, 10> given = mesh.elements.row(element);
  std::array<bool, 6> taken{};
  for (int k = 4; k < 10; ++k) {
    int best = 0;
    double min = std::numeric_limits<double>::infinity();
    for (int edge = 0; edge < 6; ++edge) {
      const auto& [a, b] = kTetEdges[edge];
      const double far =
          (mesh.nodes.row(given[a]) / 2 + mesh.nodes.row(given[b]) / 2 - mesh.nodes.row(given[k])).norm();
      if (far < min) {
        min = far;
        best = edge;
      }
    }
    if (taken[best]) return false;
    taken[best] = true;
    mesh.elements(element, 4 + best) = given[k];
  }
  return true;
}

Result<std::string> contents(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return fail(ErrorKind::bad_input, "{}: cannot be read ({})", path.string(), error.message());
  if (size > kMaxFileBytes)
    return fail(ErrorKind::too_large, path.string() + ": is larger than 4 GB; mesh the object with fewer elements");
  std::ifstream file(path, std::ios::binary);
  std::string text(size, '\0');
  file.read(text.data(), static_cast<std::streamsize>(size));
  if (!file || file.gcount() != static_cast<std::streamsize>(size))
    return fail(ErrorKind::input_output, path.string() + ": cannot be read to its end");
  return text;
}

// The path with another ending, in capitals if the old ending was, otherwise in small letters.
std::filesystem::path sibling(std::filesystem::path path, std::string_view ending) {
  const std::string old = path.extension().string();
  std::string other(ending);
  if (old.size() > 1 && std::isupper(static_cast<unsigned char>(old[1]))) {
    std::transform(other.begin(), other.end(), other.begin(), [](unsigned char c) { return std::toupper(c); });
  }
  path.replace_extension(other);
  if (!std::filesystem::exists(path)) path.replace_extension(ending);
  return path;
}

// Reads numbers off bytes.
class Bytes {
 public:
  Bytes(std::span<const std::byte> bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

  template <class Number>
  bool read(Number& number) {
    if (left() < sizeof number) return false;
    std::memcpy(&number, bytes_.data() + at_, sizeof number);
    at_ += sizeof number;
    return true;
  }

  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] tl::unexpected<Error> wrong(const std::string& what) const {
    return fail(ErrorKind::bad_input, "{}, byte {}: {}", name_, at_, what);
  }

 private:
  std::span<const std::byte> bytes_;
  std::string name_;
  std::size_t at_ = 0;
};

// The number of nodes if the header and the length of the file agree on it, otherwise -1.
std::int64_t nodes_by_length(std::span<const std::byte> file, std::size_t header) {
  const auto number = [&](std::size_t at) {
    std::int32_t value = 0;
    std::memcpy(&value, file.data() + at, 4);
    return value;
  };
  if (file.size() < header + 4) return -1;
  std::int64_t nodes = 0;
  for (std::size_t at = 0; at < header; at += 4) {
    if (number(at) < 0) return -1;
    nodes += number(at);
  }
  if (static_cast<std::size_t>(nodes) > (file.size() - header - 4) / 24) return -1;
  const std::size_t at = header + 24 * static_cast<std::size_t>(nodes);
  if (number(at) < 0) return -1;
  return file.size() - at - 4 == 16 * static_cast<std::size_t>(number(at)) ? nodes : -1;
}

}  // namespace

Result<TetMesh> read_tetgen(std::string_view node_text, std::string_view ele_text, const std::string& name) {
  TetMesh mesh;
  TextLines node_lines(node_text, name + ".node");
  const auto node_counts = read_counts(node_lines, "nodes");
  if (!node_counts) return fail(node_counts);
  if (node_counts->second != 3) return node_lines.wrong("nodes should have 3 coordinates");
  const auto first = read_nodes(node_lines, node_counts->rows, mesh.nodes);
  if (!first) return fail(first);
  TextLines lines(ele_text, name + ".ele");
  const auto counts = read_counts(lines, "elements");
  if (!counts) return fail(counts);
  if (counts->second != 4 && counts->second != 10) return lines.wrong("elements should have 4 or 10 nodes");
  mesh.elements.resize(counts->rows, counts->second);
  const auto read = read_elements(lines, counts->rows, *first, node_counts->rows, mesh.elements);
  if (!read) return fail(read);
  if (counts->second == 10) {
    for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
      if (!sort_edge_nodes(mesh, e)) {
        return fail(ErrorKind::bad_input,
                    "{}.ele: the nodes 5 to 10 of its element {} do not lie in the middles of its six edges", name,
                    e + 1);
      }
    }
  }
  return mesh;
}

Result<TetMesh> read_vega(std::string_view text, const std::string& name) {
  TetMesh mesh;
  TextLines lines(text, name);
  std::int64_t first = 0;
  while (!lines.next().empty()) {
    const std::string word = lower(std::string(lines.word()));
    if (word == "*include") return lines.wrong("*INCLUDE is not followed; put the mesh into one file");
    if (word == "*vertices") {
      if (mesh.nodes.rows() > 0) return lines.wrong("*VERTICES appears a second time");
      const auto counts = read_counts(lines, "nodes");
      if (!counts) return fail(counts);
      if (counts->second != 3) return lines.wrong("nodes should have 3 coordinates");
      const auto read = read_nodes(lines, counts->rows, mesh.nodes);
      if (!read) return fail(read);
      first = *read;
    } else if (word == "*elements") {
      if (mesh.nodes.rows() == 0) return lines.wrong("*ELEMENTS should come after *VERTICES");
      if (mesh.elements.rows() > 0) return lines.wrong("*ELEMENTS appears a second time");
      const auto& kind = lines.next();
      if (kind.empty() || !lower(std::string(kind[0])).starts_with("tet"))
        return lines.wrong("elements should be of type TET");
      const auto counts = read_counts(lines, "elements");
      if (!counts) return fail(counts);
      if (counts->second != 4) return lines.wrong("elements should have 4 nodes");
      mesh.elements.resize(counts->rows, 4);
      const auto read = read_elements(lines, counts->rows, first, mesh.nodes.rows(), mesh.elements);
      if (!read) return fail(read);
    }
  }
  if (mesh.nodes.rows() == 0) return fail(ErrorKind::bad_input, name + ": has no *VERTICES");
  if (mesh.elements.rows() == 0) return fail(ErrorKind::bad_input, name + ": has no *ELEMENTS");
  return mesh;
}

Result<TetMesh> read_isostuffer(std::span<const std::byte> file, const std::string& name) {
  Bytes bytes(file, name);
  const std::size_t header = nodes_by_length(file, 8) >= 0 ? 8 : 4;
  const std::int64_t nodes = nodes_by_length(file, header);
  if (nodes < 0) {
    return fail(ErrorKind::bad_input,
                "{}: its length of {} bytes does not fit the numbers of nodes and elements in it; it is damaged, or "
                "not a .tet of IsoStuffer",
                name, file.size());
  }
  std::int32_t elements = 0;
  for (std::size_t at = 0; at < header; at += 4) bytes.read(elements);
  if (nodes < 1) return bytes.wrong("there are no nodes");
  TetMesh mesh;
  mesh.nodes.resize(nodes, 3);
  for (double& coordinate : std::span(mesh.nodes.data(), mesh.nodes.size())) {
    if (!bytes.read(coordinate) || !std::isfinite(coordinate))
      return bytes.wrong("the coordinate before is not finite");
  }
  bytes.read(elements);
  if (elements < 1) return bytes.wrong("there are no elements");
  mesh.elements.resize(elements, 4);
  for (std::int32_t& node : std::span(mesh.elements.data(), mesh.elements.size())) {
    if (!bytes.read(node) || node < 0 || node >= nodes) return bytes.wrong(formatted("there is no node {}", node));
  }
  return mesh;
}

namespace {

Result<TetMesh> read_binary_tet(std::string_view content, const std::string& name) {
  return read_isostuffer(std::as_bytes(std::span(content)), name);
}

// The readers by their files' endings; TetGen's pairs of files come before. Together they read each format of
// FileKind::tetrahedra (engine/base/file_format.h).
struct TetReader {
  std::string_view ending;
  Result<TetMesh> (*read)(std::string_view content, const std::string& name);
};
constexpr TetReader kTetReaders[] = {{".veg", read_vega}, {".inp", read_inp}, {".tet", read_binary_tet}};

}  // namespace

Result<TetMesh> read_tet_file(const std::filesystem::path& path) {
  const std::string ending = ending_of(path);
  if (ending == ".node" || ending == ".ele") {
    const auto nodes = contents(ending == ".node" ? path : sibling(path, ".node"));
    if (!nodes) return fail(nodes);
    const auto elements = contents(ending == ".ele" ? path : sibling(path, ".ele"));
    if (!elements) return fail(elements);
    return read_tetgen(*nodes, *elements, (path.parent_path() / path.stem()).string());
  }
  const auto file = contents(path);
  if (!file) return fail(file);
  const auto* const reader = std::ranges::find(kTetReaders, std::string_view(ending), &TetReader::ending);
  if (reader == std::end(kTetReaders))
    return fail(ErrorKind::bad_input, path.string() + " is not a file of tetrahedra");
  return reader->read(*file, path.string());
}

}  // namespace ringdown::mesh
