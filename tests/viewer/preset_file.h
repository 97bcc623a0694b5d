// The bytes of a preset bank, as the daemon reads them, and pieces of them.
#pragma once

#include "engine/base/content_hash.h"
#include "protocol/reply.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace ringdown::test {

inline std::filesystem::path preset_bank(const std::string& name) {
  return std::filesystem::path(RINGDOWN_SOURCE_DIR) / "presets/banks" / (name + ".glb");
}

inline wire::Blob bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  wire::Blob bytes(text.size());
  std::ranges::transform(text, bytes.begin(), [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}

// What /object.reply calls the content of a file with these bytes.
inline std::string content_of(const wire::Blob& file) { return ContentHasher().bytes(file).hash().text(); }

inline protocol::BankReply piece_of(const wire::Blob& file, const std::string& object, std::int32_t version,
                                    std::uint32_t offset, std::uint32_t count) {
  const std::size_t end = std::min<std::size_t>(file.size(), std::size_t{offset} + count);
  return {object, version, static_cast<std::int32_t>(offset), static_cast<std::int32_t>(file.size()),
          wire::Blob(file.begin() + offset, file.begin() + static_cast<std::ptrdiff_t>(end))};
}

}  // namespace ringdown::test
