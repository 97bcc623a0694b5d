#include "engine/modal/gltf_models.h"

#include "engine/base/content_hash.h"
#include "engine/base/within_memory.h"
#include "engine/gltf/glb.h"
#include "engine/modal/bank_model.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>

namespace ringdown::modal {
namespace {

constexpr const char* kAudioExtension = "KHR_audio_rigid_bodies";
constexpr std::size_t kHead = 12, kChunkHead = 8;  // bytes of a .glb's header and of a chunk's header
constexpr std::uint32_t kJsonKind = 0x4E4F534A, kBinaryKind = 0x004E4942;
constexpr std::size_t kMaxGlb = 0xffffffff;

std::uint32_t word_in(std::string_view text, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, text.data() + at, sizeof word);
  return word;
}

void put_word(std::string& text, std::size_t value) {
  const auto word = static_cast<std::uint32_t>(value);
  text.append(reinterpret_cast<const char*>(&word), sizeof word);
}

void pad(std::string& text, char filler) { text.resize((text.size() + 3) / 4 * 4, filler); }

// The pieces of a file. A .gltf has only a text.
struct Pieces {
  bool is_glb = false, has_binary = false;
  std::string_view binary;  // the binary chunk
  std::string_view others;  // the chunks after the binary one, with their headers
};

// `file` has passed parse_glb().
Pieces take_apart(std::string_view file) {
  Pieces pieces;
  pieces.is_glb = file.substr(0, 4) == "glTF";
  if (!pieces.is_glb) return pieces;
  std::size_t at = kHead + kChunkHead + word_in(file, kHead);
  if (at + kChunkHead <= file.size()) {
    const std::size_t size = word_in(file, at);
    pieces.has_binary = true;
    pieces.binary = file.substr(at + kChunkHead, size);
    at += kChunkHead + size;
  }
  if (at < file.size()) pieces.others = file.substr(at);
  return pieces;
}

std::string joined(const Json& json, const std::string& binary, std::string_view others) {
  std::string text = json.dump();
  pad(text, ' ');
  std::string file = "glTF";
  put_word(file, 2);
  put_word(file, kHead + 2 * kChunkHead + text.size() + binary.size() + others.size());
  put_word(file, text.size());
  put_word(file, kJsonKind);
  file += text;
  put_word(file, binary.size());
  put_word(file, kBinaryKind);
  file += binary;
  file += others;
  return file;
}

Json& list(Json& json, const char* key) {
  Json& value = json[key];
  if (!value.is_array()) value = Json::array();
  return value;
}

Json& object(Json& json, const char* key) {
  Json& value = json[key];
  if (!value.is_object()) value = Json::object();
  return value;
}

// Adds `by` to the number of every accessor that a model names.
void renumber(Json& model, std::size_t by) {
  for (const char* key : {"positions", "frequencies", "decayRates", "shapes", "indices"}) {
    if (model.contains(key)) model[key] = model[key].get<std::size_t>() + by;
  }
  Json& own = model["extras"]["ringdown"];
  const auto move = [&own, by](const char* part, const char* key) {
    if (own.contains(part)) own[part][key] = own[part][key].get<std::size_t>() + by;
  };
  move("radiation", "maps");
  move("nonlinear", "bending");
  move("nonlinear", "curving");
}

// The arrays of the models as a document of their own: accessors, views and one buffer.
struct Arrays {
  Json document;
  std::string bytes;
};

Arrays arrays_of(GlbWriter writer) {
  const std::vector<std::byte> file = std::move(writer).finish(Json::object());
  const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
  const std::size_t size = word_in(text, kHead);
  return {Json::parse(text.substr(kHead + kChunkHead, size)), std::string(take_apart(text).binary)};
}

}  // namespace

Result<ExtendedGltf> add_models(std::string_view file, const std::string& name, const std::string& stem,
                                std::span<const AddedModel> models) {
  return within_memory("extend " + name, [&]() -> Result<ExtendedGltf> {
    const bool is_glb = file.substr(0, 4) == "glTF";
    Json json;
    if (is_glb) {
      auto glb = parse_glb(std::as_bytes(std::span(file)), name);
      if (!glb) return fail(glb);
      json = std::move(glb->json);
    } else {
      auto text = parse_gltf_json(file, name);
      if (!text) return fail(text);
      json = *std::move(text);
    }
    const Pieces pieces = take_apart(file);
    const JsonPlace root(&json, name + ": ");
    const bool inside =
        pieces.is_glb && !root["buffers"][0]["uri"].present() && (root["buffers"].size() == 0 || pieces.has_binary);
    // The numbers of the first new accessor and view, and the place of the first new byte.
    const std::size_t accessors = root["accessors"].size(), views = root["bufferViews"].size();
    const std::size_t buffer = inside ? 0 : root["buffers"].size();
    std::string binary(pieces.binary);
    if (inside) pad(binary, '\0');
    const std::size_t begin = inside ? binary.size() : 0;

    GlbWriter writer;
    Json& extension = object(object(json, "extensions"), kAudioExtension);
    for (const AddedModel& added : models) {
      WrittenModel written = add_model(writer, *added.bank, /*packed=*/false);
      renumber(written.model, accessors);
      if (added.material) written.model["material"] = *added.material;
      const std::size_t number = list(extension, "modalModels").size();
      list(extension, "modalModels").push_back(std::move(written.model));
      for (const std::size_t node : added.nodes) {
        if (!root["nodes"][node].present() || !root["nodes"][node].json().is_object())
          return root["nodes"].wrong(formatted("a node {}", node));
        object(object(json["nodes"][node], "extensions"), kAudioExtension)["modalModel"] = number;
      }
    }
    Arrays arrays = arrays_of(std::move(writer));
    for (Json& accessor : arrays.document["accessors"]) {
      accessor["bufferView"] = accessor["bufferView"].get<std::size_t>() + views;
      list(json, "accessors").push_back(std::move(accessor));
    }
    for (Json& view : arrays.document["bufferViews"]) {
      view["buffer"] = buffer;
      view["byteOffset"] = view["byteOffset"].get<std::size_t>() + begin;
      list(json, "bufferViews").push_back(std::move(view));
    }
    Json& used = list(json, "extensionsUsed");
    if (std::find(used.begin(), used.end(), Json(kAudioExtension)) == used.end()) used.push_back(kAudioExtension);

    ExtendedGltf extended;
    if (inside) {
      binary += arrays.bytes;
      if (list(json, "buffers").empty()) json["buffers"].push_back(Json::object());
      json["buffers"][0]["byteLength"] = binary.size();
    } else {
      extended.buffer_name = stem + "-" + hash_of(arrays.bytes).text().substr(0, 8) + ".bin";
      list(json, "buffers").push_back({{"uri", extended.buffer_name}, {"byteLength", arrays.bytes.size()}});
      extended.buffer = std::move(arrays.bytes);
    }
    extended.file = pieces.is_glb ? joined(json, binary, pieces.others) : json.dump(2) + "\n";
    const std::size_t text_bytes = pieces.is_glb ? word_in(extended.file, kHead) : extended.file.size();
    if (text_bytes > kMaxJsonBytes || (pieces.is_glb && kMaxGlb < extended.file.size())) {
      return fail(ErrorKind::too_large,
                  name + " would become larger than a glTF file may be; bake fewer of its bodies");
    }
    return extended;
  });
}

}  // namespace ringdown::modal
