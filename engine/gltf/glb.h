// Reads and writes binary glTF 2.0 as a container: one JSON text, one block of bytes, and typed arrays (accessors) in
// that block. An array may be compressed (EXT_meshopt_compression).
//
// Reading trusts nothing: sizes are checked before memory is allocated. For the readers and writers of banks and of
// scenes, and their tests. [worker]
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

// A value in the JSON text together with its path, so that an error can say which field is wrong.
class JsonPlace {
 public:
  JsonPlace(const Json* value, std::string path) : value_(value), path_(std::move(path)) {}

  [[nodiscard]] bool present() const { return value_ != nullptr; }
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const Json& json() const { return *value_; }

  [[nodiscard]] JsonPlace operator[](const std::string& key) const;  // absent if this is not an object or lacks the key
  [[nodiscard]] JsonPlace operator[](std::size_t index) const;       // absent if this is not an array or is too short
  [[nodiscard]] std::size_t size() const { return value_ && value_->is_array() ? value_->size() : 0; }

  [[nodiscard]] Result<double> number() const;                    // finite
  [[nodiscard]] Result<double> number_or(double fallback) const;  // `fallback` when absent
  [[nodiscard]] Result<std::size_t> index() const;                // a whole number >= 0
  [[nodiscard]] Result<std::size_t> index_or(std::size_t fallback) const;
  [[nodiscard]] Result<void> numbers(std::span<double> values) const;  // fills `values`; leaves them when absent
  [[nodiscard]] std::string text_or(std::string fallback) const;
  [[nodiscard]] tl::unexpected<Error> wrong(const std::string& expectation) const;

 private:
  const Json* value_;
  std::string path_;
};

struct Glb {
  Json json;
  std::span<const std::byte> binary;  // points into the bytes given to parse_glb, or into `assembled`
  std::vector<std::byte> assembled;   // several buffers joined (gltf_file.h)
  std::string name;                   // for error messages

  [[nodiscard]] JsonPlace root() const { return {&json, name + ": "}; }
};

// Limits of a JSON text. A bank that we write has at most about 85,000 values: five for each of 16,384 modes.
inline constexpr std::size_t kMaxJsonBytes = std::size_t{1} << 24;
inline constexpr std::size_t kMaxJsonValues = std::size_t{1} << 18;

// Parses a document's JSON text.
Result<Json> parse_gltf_json(std::string_view text, const std::string& name, std::size_t max_bytes = kMaxJsonBytes);

// Parses a .glb from memory. `name` replaces the path in error messages.
Result<Glb> parse_glb(std::span<const std::byte> bytes, const std::string& name,
                      std::size_t max_json_bytes = kMaxJsonBytes);

inline constexpr std::size_t kMaxUnpackedBytes = std::size_t{1} << 30;  // for each compressed array

// Reads the accessor whose number is in the field `reference`, as count x width numbers. `width` 1 is SCALAR, 2 to 4
// are VEC2 to VEC4. Fails for more than `limit` elements.
Result<std::vector<float>> read_floats(const Glb& glb, const JsonPlace& reference, std::size_t width,
                                       std::size_t limit);
Result<std::vector<std::uint32_t>> read_indices(const Glb& glb, const JsonPlace& reference, std::size_t limit);
Result<std::vector<std::byte>> read_bytes(const Glb& glb, const JsonPlace& reference, std::size_t limit);

// Reads numbers of any component type, also normalized and sparse, whereas read_floats() reads plain floats only.
// `width` 16 is MAT4, by columns. Elements of an accessor without a buffer view are 0.
Result<std::vector<double>> read_numbers(const Glb& glb, const JsonPlace& reference, std::size_t width,
                                         std::size_t limit);

// Returns the bytes, within the document's binary, of the buffer view that `reference` names. The view must not be
// compressed.
Result<std::span<const std::byte>> read_view(const Glb& glb, const JsonPlace& reference);

// Collects arrays into one buffer, then writes the container.
class GlbWriter {
 public:
  enum class Use { data, vertices, indices, times };

  // Add an array and return its accessor's number. Vertices and times get the bounds that glTF requires.
  std::size_t add_floats(std::span<const float> values, std::size_t width, Use use = Use::data);
  std::size_t add_indices(std::span<const std::uint32_t> values);
  std::size_t add_bytes(std::span<const std::byte> bytes);

  // Add an array compressed without loss. The file's reader must then know EXT_meshopt_compression.
  std::size_t add_packed_floats(std::span<const float> values, std::size_t width, Use use = Use::data);
  std::size_t add_packed_indices(std::span<const std::uint32_t> values);

  // Adds and compresses words made by exponential_words() (meshopt_codec.h).
  std::size_t add_exponentials(std::span<const std::uint32_t> words, std::size_t width);

  // Completes `document` with accessors, views and the buffer, and returns the file's bytes.
  [[nodiscard]] std::vector<std::byte> finish(Json document) &&;

 private:
  Json append(std::span<const std::byte> bytes);
  std::size_t add(Json view, Json accessor, Use use);
  std::size_t add_packed(const MeshoptLayout& layout, std::span<const std::byte> stream, Json accessor, Use use);

  std::vector<std::byte> binary_;
  std::size_t unpacked_bytes_ = 0;  // unpacked size of all compressed arrays
  Json accessors_ = Json::array();
  Json views_ = Json::array();
};

}  // namespace ringdown::modal
