#include "engine/mesh/mesh_cache.h"

#include "engine/base/atomic_file.h"
#include "engine/base/byte_stream.h"

#include <gmsh.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <vector>

namespace ringdown::mesh {
namespace {

constexpr std::string_view kKind = "mesh";
constexpr int kFormat = 3;                                     // of an entry, and of how bodies are made
constexpr std::size_t kMaxFileBytes = std::size_t{256} << 20;  // bytes; a larger file is read each time

// Words of gmsh's language and of mesh formats by which a result depends on more than the file and its parameters. One
// in a comment costs no more than meshing anew.
constexpr std::array kElsewhere = {"include", "merge",     "shapefromfile", "systemcall",  "onelab",
                                   "getenv",  "getstring", "getnumber",     "exists",      "rand",
                                   "cpu",     "memory",    "currentdir",    "absolutepath"};

bool looks_elsewhere(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::any_of(kElsewhere.begin(), kElsewhere.end(),
                     [&text](const char* word) { return text.find(word) != std::string::npos; });
}

// Read as text by gmsh's parser, or as a keyword format with includes; other formats stand alone.
bool is_program(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  return extension.starts_with(".geo") || extension == ".bdf" || extension == ".nas";
}

// The body is in several files.
bool has_companions(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".gltf" || extension == ".node" || extension == ".ele";
}

// Every option by name: a new one that is not in the key does not compile.
ContentHash key_of(const std::filesystem::path& path, const std::string& text, const GmshOptions& options) {
  const auto& [unit_m, mesh_size_m, edge_size_m, order, parameters] = options;
  ContentHasher hasher;
  hasher.value(kFormat).text(GMSH_API_VERSION).text(path.extension().string()).text(text);
  hasher.value(unit_m.value_or(0)).value(mesh_size_m).value(edge_size_m).value(order);
  for (const auto& [name, value] : parameters) hasher.text(name).value(value);
  return hasher.hash();
}

std::string packed(const Body& body) {
  const CheckedMesh& checked = body.mesh;
  const auto& [nodes, elements] = checked.mesh;
  ByteWriter out;
  out.put(body.making).put(body.notes.size());
  for (const std::string& note : body.notes) out.put_list(std::span(note.data(), note.size()));
  out.put(std::array{checked.pieces, checked.flipped, checked.straightened, checked.unused_nodes, checked.duplicates});
  out.put(elements.cols());
  out.put_list(std::span(nodes.data(), static_cast<std::size_t>(nodes.size())));
  out.put_list(std::span(elements.data(), static_cast<std::size_t>(elements.size())));
  return out.bytes();
}

// Checked again, as if it came from anywhere.
std::optional<Body> unpacked(std::string_view bytes) {
  ByteReader in(bytes);
  Body body;
  std::size_t notes = 0;
  if (!in.get(body.making) || text_of(body.making).empty() || !in.get(notes)) return std::nullopt;
  std::vector<char> note;
  for (; notes > 0; --notes) {
    if (!in.get_list(note)) return std::nullopt;
    body.notes.emplace_back(note.begin(), note.end());
  }
  std::array<int, 5> counts{};
  Eigen::Index per_element = 0;
  std::vector<double> nodes;
  std::vector<std::int32_t> elements;
  if (!in.get(counts) || !in.get(per_element) || !in.get_list(nodes) || !in.get_list(elements) || !in.finished()) {
    return std::nullopt;
  }
  const auto node_numbers = static_cast<Eigen::Index>(nodes.size()),
             corners = static_cast<Eigen::Index>(elements.size());
  if (node_numbers % 3 != 0 || per_element < 4 || per_element > corners || corners % per_element != 0) {
    return std::nullopt;
  }
  Result<CheckedMesh> checked =
      check_mesh({.nodes = Eigen::Map<const Points>(nodes.data(), node_numbers / 3, 3),
                  .elements = Eigen::Map<const Indices>(elements.data(), corners / per_element, per_element)},
                 "the cache");
  if (!checked || checked->pieces != counts[0]) return std::nullopt;
  checked->flipped = counts[1];
  checked->straightened = counts[2];
  checked->unused_nodes = counts[3];
  checked->duplicates = counts[4];
  body.mesh = std::move(*checked);
  return body;
}

}  // namespace

Result<Body> make_through_cache(const std::filesystem::path& path, const GmshOptions& options,
                                const ContentCache& cache, const std::function<Result<Body>()>& make) {
  const Result<std::string> text = read_whole_file(path, kMaxFileBytes);
  if (!text || has_companions(path) || (is_program(path) && looks_elsewhere(*text))) return make();
  const ContentHash key = key_of(path, *text, options);
  if (const auto kept = cache.find(kKind, key)) {
    if (auto body = unpacked(*kept)) return std::move(*body);
  }
  Result<Body> body = make();
  if (body) (void)cache.store(kKind, key, packed(*body));  // a cache that cannot be written costs time only
  return body;
}

}  // namespace ringdown::mesh
