#include "engine/gltf/glb.h"

#include "engine/base/within_memory.h"
#include "engine/gltf/glb_format.h"

#include <bit>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

namespace ringdown::modal {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF is little-endian; a big-endian port swaps here");

std::uint32_t word_at(std::span<const std::byte> bytes, std::size_t offset) {
  std::uint32_t word;
  std::memcpy(&word, bytes.data() + offset, sizeof word);
  return word;
}

// Counts the values of a JSON text without keeping them, and stops the parser at the first value beyond the limit. The
// parser prescribes the names of the functions.
class JsonCounter {
 public:
  [[nodiscard]] bool too_many() const { return values_ > kMaxJsonValues; }

  bool null() { return count(); }
  bool boolean(bool) { return count(); }
  bool number_integer(Json::number_integer_t) { return count(); }
  bool number_unsigned(Json::number_unsigned_t) { return count(); }
  bool number_float(Json::number_float_t, const Json::string_t&) { return count(); }
  bool string(Json::string_t&) { return count(); }
  bool binary(Json::binary_t&) { return count(); }
  bool start_object(std::size_t) { return count(); }
  bool start_array(std::size_t) { return count(); }
  bool key(Json::string_t&) { return true; }
  bool end_object() { return true; }
  bool end_array() { return true; }
  bool parse_error(std::size_t, const std::string&, const Json::exception&) { return false; }

 private:
  bool count() { return ++values_ <= kMaxJsonValues; }

  std::size_t values_ = 0;
};

Json accessor_json(std::size_t component_type, std::size_t count, std::size_t width) {
  return {{"componentType", component_type},
          {"count", count},
          {"type", width == 1   ? "SCALAR"
                   : width == 4 ? "VEC4"
                                : "VEC3"}};
}

Json float_accessor(std::span<const float> values, std::size_t width, bool with_bounds) {
  Json accessor = accessor_json(kFloat, values.size() / width, width);
  if (!with_bounds) return accessor;
  std::vector<float> low(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(width)), high = low;
  for (std::size_t i = 0; i < values.size(); ++i) {
    low[i % width] = std::min(low[i % width], values[i]);
    high[i % width] = std::max(high[i % width], values[i]);
  }
  accessor["min"] = low;
  accessor["max"] = high;
  return accessor;
}

}  // namespace

JsonPlace JsonPlace::operator[](const std::string& key) const {
  const std::string path = path_ + (path_.ends_with(": ") ? "" : ".") + key;
  if (!value_ || !value_->is_object()) return {nullptr, path};
  const auto found = value_->find(key);
  return {found == value_->end() ? nullptr : &*found, path};
}

JsonPlace JsonPlace::operator[](std::size_t index) const {
  return {index < size() ? &(*value_)[index] : nullptr, formatted("{}[{}]", path_, index)};
}

Result<void> JsonPlace::numbers(std::span<double> values) const {
  if (!present()) return {};
  if (size() != values.size()) return wrong(formatted("{} numbers", values.size()));
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto number = (*this)[k].number();
    if (!number) return fail(number);
    values[k] = *number;
  }
  return {};
}

tl::unexpected<Error> JsonPlace::wrong(const std::string& expectation) const {
  std::string found = "is missing";
  if (value_ && value_->is_structured()) {  // not printed: dump() would recurse as deep as a hostile file nests
    found = value_->is_array() ? "is an array" : "is an object";
  } else if (value_) {
    found = "is " + value_->dump(-1, ' ', true, Json::error_handler_t::replace);
    if (found.size() > 60) found = found.substr(0, 57) + "...";
  }
  return fail(ErrorKind::bad_input, "{} {}, expected {}", path_, found, expectation);
}

Result<double> JsonPlace::number() const {
  if (!value_ || !value_->is_number() || !std::isfinite(value_->get<double>())) return wrong("a finite number");
  return value_->get<double>();
}

Result<double> JsonPlace::number_or(double fallback) const { return present() ? number() : Result<double>(fallback); }

Result<std::size_t> JsonPlace::index() const {
  constexpr double kMaxWhole = 1e15;  // whole numbers are exact in a double up to 2^53
  if (!value_ || !value_->is_number()) return wrong("a whole number from 0");
  const double number = value_->get<double>();
  if (!(number >= 0 && number <= kMaxWhole) || number != std::floor(number)) return wrong("a whole number from 0");
  return static_cast<std::size_t>(number);
}

Result<std::size_t> JsonPlace::index_or(std::size_t fallback) const {
  return present() ? index() : Result<std::size_t>(fallback);
}

std::string JsonPlace::text_or(std::string fallback) const {
  return value_ && value_->is_string() ? value_->get<std::string>() : std::move(fallback);
}

// A value takes about 20 times its text in memory, so all values are counted before the first is kept.
Result<Json> parse_gltf_json(std::string_view text, const std::string& name, std::size_t max_bytes) {
  const auto too_large = [&name](std::size_t limit, const std::string& of_what) {
    return fail(ErrorKind::too_large,
                "{}: its JSON text has more than {} {}; long lists of numbers belong in the binary chunk", name, limit,
                of_what);
  };
  if (text.size() > max_bytes) return too_large(max_bytes, "bytes");
  return within_memory("read " + name, [&]() -> Result<Json> {
    JsonCounter counter;
    const bool sound = Json::sax_parse(text, &counter);
    if (counter.too_many()) return too_large(kMaxJsonValues, "values");
    Json json = sound ? Json::parse(text, nullptr, /*allow_exceptions=*/false) : Json();
    if (!json.is_object()) return fail(ErrorKind::bad_input, name + ": its JSON text is malformed");
    return json;
  });
}

Result<Glb> parse_glb(std::span<const std::byte> bytes, const std::string& name, std::size_t max_json_bytes) {
  if (bytes.size() < 20 || word_at(bytes, 0) != kGlbMagic) {
    return fail(ErrorKind::bad_input, name + " is not a binary glTF file (.glb); make one with `ringdown bake`");
  }
  if (word_at(bytes, 4) != 2)
    return fail(ErrorKind::bad_input, "{}: glTF version {}, expected 2", name, word_at(bytes, 4));
  if (word_at(bytes, 8) != bytes.size()) {
    return fail(ErrorKind::bad_input, "{}: its header says {} bytes but the file has {}; it was cut off or altered",
                name, word_at(bytes, 8), bytes.size());
  }
  const std::size_t json_size = word_at(bytes, 12);
  if (word_at(bytes, 16) != kJsonChunk || json_size > bytes.size() - 20) {
    return fail(ErrorKind::bad_input, name + ": the first chunk must be the JSON text and end inside the file");
  }
  auto json = parse_gltf_json({reinterpret_cast<const char*>(bytes.data()) + 20, json_size}, name, max_json_bytes);
  if (!json) return fail(json);
  Glb glb{.json = *std::move(json), .name = name};
  const auto rest = bytes.subspan(20 + json_size);
  if (rest.size() >= 8) {
    if (word_at(rest, 4) != kBinaryChunk || word_at(rest, 0) > rest.size() - 8) {
      return fail(ErrorKind::bad_input, name + ": the second chunk must be binary data and end inside the file");
    }
    glb.binary = rest.subspan(8, word_at(rest, 0));
  }
  return glb;
}

// Appends `bytes` to the binary, and returns the slice of the binary that holds them.
Json GlbWriter::append(std::span<const std::byte> bytes) {
  binary_.resize((binary_.size() + 3) / 4 * 4, std::byte{0});
  Json slice = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes.size()}};
  binary_.insert(binary_.end(), bytes.begin(), bytes.end());
  return slice;
}

std::size_t GlbWriter::add(Json view, Json accessor, Use use) {
  if (use == Use::vertices) view["target"] = 34962;
  if (use == Use::indices) view["target"] = 34963;
  accessor["bufferView"] = views_.size();
  views_.push_back(std::move(view));
  accessors_.push_back(std::move(accessor));
  return accessors_.size() - 1;
}

// The view lies in buffer 1, which has no bytes: the extension's placeholder for readers that unpack.
std::size_t GlbWriter::add_packed(const MeshoptLayout& layout, std::span<const std::byte> stream, Json accessor,
                                  Use use) {
  Json packing = append(stream);
  packing["mode"] = kMeshoptModes[static_cast<std::size_t>(layout.mode)];
  if (layout.filter != MeshoptFilter::none)
    packing["filter"] = kMeshoptFilters[static_cast<std::size_t>(layout.filter)];
  packing["count"] = layout.count;
  packing["byteStride"] = layout.stride;
  Json view = {{"buffer", 1},
               {"byteOffset", unpacked_bytes_},
               {"byteLength", layout.bytes()},
               {"extensions", {{kMeshopt, std::move(packing)}}}};
  unpacked_bytes_ += layout.bytes();
  return add(std::move(view), std::move(accessor), use);
}

std::size_t GlbWriter::add_floats(std::span<const float> values, std::size_t width, Use use) {
  const bool bounds = use == Use::vertices || use == Use::times;
  return add(append(std::as_bytes(values)), float_accessor(values, width, bounds), use);
}

std::size_t GlbWriter::add_packed_floats(std::span<const float> values, std::size_t width, Use use) {
  const MeshoptLayout layout{.count = values.size() / width, .stride = width * sizeof(float)};
  return add_packed(layout, pack_attributes(std::as_bytes(values), layout.stride),
                    float_accessor(values, width, use == Use::vertices), use);
}

std::size_t GlbWriter::add_exponentials(std::span<const std::uint32_t> words, std::size_t width) {
  const MeshoptLayout layout{
      .filter = MeshoptFilter::exponential, .count = words.size() / width, .stride = width * sizeof(float)};
  return add_packed(layout, pack_attributes(std::as_bytes(words), layout.stride),
                    accessor_json(kFloat, layout.count, width), Use::data);
}

std::size_t GlbWriter::add_indices(std::span<const std::uint32_t> values) {
  return add(append(std::as_bytes(values)), accessor_json(kUnsignedInt, values.size(), 1), Use::indices);
}

std::size_t GlbWriter::add_bytes(std::span<const std::byte> bytes) {
  return add(append(bytes), accessor_json(kUnsignedByte, bytes.size(), 1), Use::data);
}

std::size_t GlbWriter::add_packed_indices(std::span<const std::uint32_t> values) {
  const MeshoptLayout layout{.mode = MeshoptMode::indices, .count = values.size(), .stride = sizeof(std::uint32_t)};
  return add_packed(layout, pack_indices(values), accessor_json(kUnsignedInt, values.size(), 1), Use::indices);
}

std::vector<std::byte> GlbWriter::finish(Json document) && {
  document["accessors"] = std::move(accessors_);
  document["bufferViews"] = std::move(views_);
  document["buffers"] = Json::array({{{"byteLength", binary_.size()}}});
  if (unpacked_bytes_ > 0) {
    document["buffers"].push_back(
        {{"byteLength", unpacked_bytes_}, {"extensions", {{kMeshopt, {{"fallback", true}}}}}});
    document["extensionsUsed"].push_back(kMeshopt);
    document["extensionsRequired"].push_back(kMeshopt);
  }
  std::string text = document.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  binary_.resize((binary_.size() + 3) / 4 * 4, std::byte{0});

  std::vector<std::byte> file;
  const auto put = [&file](std::span<const std::byte> bytes) { file.insert(file.end(), bytes.begin(), bytes.end()); };
  const auto put_word = [&put](std::size_t value) {
    const auto word = static_cast<std::uint32_t>(value);
    put(std::as_bytes(std::span(&word, 1)));
  };
  for (const std::size_t word : {std::size_t{kGlbMagic}, std::size_t{2}, 28 + text.size() + binary_.size(), text.size(),
                                 std::size_t{kJsonChunk}}) {
    put_word(word);
  }
  put(std::as_bytes(std::span(text)));
  put_word(binary_.size());
  put_word(kBinaryChunk);
  put(binary_);
  return file;
}

}  // namespace ringdown::modal
