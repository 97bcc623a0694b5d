// Binary glTF 2.0 as a container: one JSON text and one block of bytes, and typed arrays (accessors) into it. An array
// may be compressed (EXT_meshopt_compression).
//
// Reading trusts nothing: a document is refused before memory is allocated for what it claims to hold. For the
// readers and writers of banks and of scenes, and their tests. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/gltf/meshopt_codec.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::modal {

using Json = nlohmann::json;

// A place in the JSON text that knows its own name, so that an error can say which field is wrong.
class JsonPlace {
 public:
  JsonPlace(const Json* value, std::string path) : value_(value), path_(std::move(path)) {}

  [[nodiscard]] bool present() const { return value_ != nullptr; }
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const Json& json() const { return *value_; }

  [[nodiscard]] JsonPlace operator[](const std::string& key) const;  // absent when this is no object or lacks the key
  [[nodiscard]] JsonPlace operator[](std::size_t index) const;       // absent when this is no array or is shorter
  [[nodiscard]] std::size_t size() const { return value_ && value_->is_array() ? value_->size() : 0; }

  [[nodiscard]] Result<double> number() const;                    // finite
  [[nodiscard]] Result<double> number_or(double fallback) const;  // `fallback` when absent
  [[nodiscard]] Result<std::size_t> index() const;                // a whole number >= 0
  [[nodiscard]] Result<std::size_t> index_or(std::size_t fallback) const;
  [[nodiscard]] std::string text_or(std::string fallback) const;
  [[nodiscard]] tl::unexpected<Error> wrong(const std::string& expectation) const;

 private:
  const Json* value_;
  std::string path_;
};

struct Glb {
  Json json;
  std::span<const std::byte> binary;  // into the bytes given to parse_glb, or into `assembled`
  std::vector<std::byte> assembled;   // of several buffers (gltf_file.h)
  std::string name;                   // for error messages

  [[nodiscard]] JsonPlace root() const { return {&json, name + ": "}; }
};

// Limits of a JSON text. Our own has at most some 85,000 values: five for each of 16,384 modes.
inline constexpr std::size_t kMaxJsonBytes = std::size_t{1} << 24;
inline constexpr std::size_t kMaxJsonValues = std::size_t{1} << 18;

// A document's JSON text.
Result<Json> parse_gltf_json(std::string_view text, const std::string& name, std::size_t max_bytes = kMaxJsonBytes);

// `name` stands in error messages where the path would.
Result<Glb> parse_glb(std::span<const std::byte> bytes, const std::string& name,
                      std::size_t max_json_bytes = kMaxJsonBytes);

inline constexpr std::size_t kMaxUnpackedBytes = std::size_t{1} << 30;  // of one compressed array

// The accessor that `reference` (a field holding its number) names, as count x width numbers. `width` 1 is SCALAR,
// 2 to 4 are VEC2 to VEC4. At most `limit` elements.
Result<std::vector<float>> read_floats(const Glb& glb, const JsonPlace& reference, std::size_t width,
                                       std::size_t limit);
Result<std::vector<std::uint32_t>> read_indices(const Glb& glb, const JsonPlace& reference, std::size_t limit);
Result<std::vector<std::byte>> read_bytes(const Glb& glb, const JsonPlace& reference, std::size_t limit);

// Reads numbers of any component type, also normalized and sparse, where read_floats() reads plain floats. `width` 16
// is MAT4, by columns. Elements of an accessor without a buffer view are 0.
Result<std::vector<double>> read_numbers(const Glb& glb, const JsonPlace& reference, std::size_t width,
                                         std::size_t limit);

// The bytes of the buffer view that `reference` names, which must not be compressed; into the document's binary.
Result<std::span<const std::byte>> read_view(const Glb& glb, const JsonPlace& reference);

// Collects arrays into one buffer, then writes the container.
class GlbWriter {
 public:
  enum class Use { data, vertices, indices };

  // Returns the accessor's number. Vertex arrays get the bounds that glTF wants.
  std::size_t add_floats(std::span<const float> values, std::size_t width, Use use = Use::data);
  std::size_t add_indices(std::span<const std::uint32_t> values);
  std::size_t add_bytes(std::span<const std::byte> bytes);

  // The same, compressed without loss. A reader must know EXT_meshopt_compression then.
  std::size_t add_packed_floats(std::span<const float> values, std::size_t width, Use use = Use::data);
  std::size_t add_packed_indices(std::span<const std::uint32_t> values);

  // Compressed numbers, as exponential_words() has made them (meshopt_codec.h).
  std::size_t add_exponentials(std::span<const std::uint32_t> words, std::size_t width);

  // Completes `document` with accessors, views and the buffer, and returns the file's bytes.
  [[nodiscard]] std::vector<std::byte> finish(Json document) &&;

 private:
  Json append(std::span<const std::byte> bytes);
  std::size_t add(Json view, Json accessor, Use use);
  std::size_t add_packed(const MeshoptLayout& layout, std::span<const std::byte> stream, Json accessor, Use use);

  std::vector<std::byte> binary_;
  std::size_t unpacked_bytes_ = 0;  // of all compressed arrays
  Json accessors_ = Json::array();
  Json views_ = Json::array();
};

}  // namespace ringdown::modal
