#include "engine/bake/laboratory/numpy_archive.h"

#include <array>
#include <cstring>
#include <limits>
#include <string_view>

namespace ringdown::bake {
namespace {

// CRC-32 of zip files: polynomial 0xEDB88320, bits reversed.
std::uint32_t checksum(std::string_view bytes) {
  static const std::array<std::uint32_t, 256> kTable = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t value = i;
      for (int bit = 0; bit < 8; ++bit) value = (value & 1) != 0 ? 0xEDB88320U ^ (value >> 1) : value >> 1;
      table[i] = value;
    }
    return table;
  }();
  std::uint32_t sum = 0xFFFFFFFFU;
  for (const char byte : bytes) sum = kTable[(sum ^ static_cast<unsigned char>(byte)) & 0xFFU] ^ (sum >> 8);
  return ~sum;
}

template <class Number>
void put(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

// The header of a .npy of format 1.0, padded so that the numbers begin at a multiple of 64.
std::string npy_header(const std::vector<std::size_t>& shape, const char* type) {
  constexpr std::string_view kMagic{"\x93NUMPY\x01\x00", 8};
  std::string extents;
  for (const std::size_t extent : shape) extents += std::to_string(extent) + ", ";
  std::string text = std::string("{'descr': '") + type + "', 'fortran_order': False, 'shape': (" + extents + "), }";
  text.resize((kMagic.size() + 2 + text.size() + 64) / 64 * 64 - kMagic.size() - 3, ' ');
  text += '\n';
  std::string header(kMagic);
  put(header, static_cast<std::uint16_t>(text.size()));
  return header + text;
}

}  // namespace

void NumpyArchive::add_bytes(const std::string& name, const std::vector<std::size_t>& shape, const char* type,
                             const void* numbers, std::size_t bytes) {
  constexpr std::uint32_t kLocal = 0x04034b50, kCentral = 0x02014b50;
  constexpr std::uint16_t kVersion = 20, kFirstOfJanuary1980 = 0x21;
  std::string content = npy_header(shape, type);
  content.append(static_cast<const char*>(numbers), bytes);
  const std::string file = name + ".npy";
  const auto begin = static_cast<std::uint32_t>(files_.size());
  std::string common;  // the part that both headers have
  put(common, std::uint16_t{0});
  put(common, std::uint16_t{0});  // stored
  put(common, std::uint16_t{0});
  put(common, kFirstOfJanuary1980);
  put(common, checksum(content));
  put(common, static_cast<std::uint32_t>(content.size()));
  put(common, static_cast<std::uint32_t>(content.size()));
  put(common, static_cast<std::uint16_t>(file.size()));
  put(common, std::uint16_t{0});
  put(files_, kLocal);
  put(files_, kVersion);
  files_ += common + file + content;
  put(directory_, kCentral);
  put(directory_, kVersion);
  put(directory_, kVersion);
  directory_ += common;
  directory_.append(2 + 2 + 2 + 4, '\0');  // comment, disk, attributes
  put(directory_, begin);
  directory_ += file;
  ++count_;
}

Result<std::string> NumpyArchive::finish() && {
  constexpr std::uint32_t kEnd = 0x06054b50;
  if (files_.size() + directory_.size() >= std::numeric_limits<std::uint32_t>::max())
    return fail(ErrorKind::too_large,
                "a .npz of 4 GB or more cannot be written; write a .vtu, or fewer modes (--keep)");
  std::string bytes = std::move(files_);
  const auto begin = static_cast<std::uint32_t>(bytes.size());
  bytes += directory_;
  put(bytes, kEnd);
  put(bytes, std::uint32_t{0});
  put(bytes, count_);
  put(bytes, count_);
  put(bytes, static_cast<std::uint32_t>(directory_.size()));
  put(bytes, begin);
  put(bytes, std::uint16_t{0});
  return bytes;
}

}  // namespace ringdown::bake
