// A .glb file taken apart, to be changed and put together again: how the tests make broken and foreign banks. Knows the
// container's layout from the glTF 2.0 specification (section 4.4), not from the engine.
#pragma once

#include "engine/modal/bank_file.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <vector>

namespace ringdown::modal::test {

using Json = nlohmann::json;

inline std::string file_content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline std::string written(const Bank& bank, Compression compression = Compression::none) {
  const ringdown::test::TemporaryFolder folder;
  const auto outcome = write_bank(bank, folder / "bank.glb", {}, compression);
  EXPECT_TRUE(outcome) << outcome.error().message;
  return file_content(folder / "bank.glb");
}

inline Result<Bank> parse(const std::string& bytes) { return parse_bank(std::as_bytes(std::span(bytes)), "x.glb"); }

inline std::uint32_t word(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}
inline void set_word(std::string& bytes, std::size_t at, std::uint32_t value) {
  std::memcpy(bytes.data() + at, &value, 4);
}

struct GlbParts {
  Json json;
  std::string binary;

  explicit GlbParts(const std::string& file) {
    const std::size_t size = word(file, 12);
    json = Json::parse(file.substr(20, size));
    binary = file.substr(20 + size + 8, word(file, 20 + size));
  }

  // `extra` comes after the binary chunk.
  [[nodiscard]] std::string join(const std::string& extra = "") const {
    std::string text = json.dump(), data = binary;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    data.resize((data.size() + 3) / 4 * 4, '\0');
    std::string file = "glTF" + std::string(16, '\0') + text + std::string(8, '\0') + data + extra;
    set_word(file, 4, 2);
    set_word(file, 8, static_cast<std::uint32_t>(file.size()));
    set_word(file, 12, static_cast<std::uint32_t>(text.size()));
    std::memcpy(file.data() + 16, "JSON", 4);
    set_word(file, 20 + text.size(), static_cast<std::uint32_t>(data.size()));
    std::memcpy(file.data() + 24 + text.size(), "BIN\0", 4);
    return file;
  }

  [[nodiscard]] Json& extension() { return json["extensions"]["KHR_audio_rigid_bodies"]; }
  [[nodiscard]] Json& model() { return extension()["modalModels"][0]; }
  [[nodiscard]] Json& accessor(const char* key) { return json["accessors"][model()[key].get<std::size_t>()]; }
  [[nodiscard]] Json& view(const char* key) {
    return json["bufferViews"][accessor(key)["bufferView"].get<std::size_t>()];
  }
  // Where element bytes of the model's array `key` begin in `binary`.
  [[nodiscard]] std::size_t offset(const char* key) { return view(key)["byteOffset"].get<std::size_t>(); }
  template <class T>
  void set(const char* key, std::size_t element, T value) {
    std::memcpy(binary.data() + offset(key) + element * sizeof(T), &value, sizeof(T));
  }
  // Gives the model's array `key` new bytes, in a view of its own at the end.
  void replace_data(const char* key, const std::string& bytes) {
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    accessor(key)["bufferView"] = json["bufferViews"].size();
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes.size()}});
    binary += bytes;
    json["buffers"][0]["byteLength"] = binary.size();
  }
};

}  // namespace ringdown::modal::test
