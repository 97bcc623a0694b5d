// Packs and unpacks buffer views with the codecs of glTF's extension EXT_meshopt_compression (meshoptimizer, version
// 0.18 or later). The extension's text is the reference:
// github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Vendor/EXT_meshopt_compression
//
// A packed array has `count` elements of `stride` bytes. Private to the reader and writer of banks and their tests.
// [any thread]
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ringdown::modal {

enum class MeshoptMode { attributes, triangles, indices };
enum class MeshoptFilter { none, octahedral, quaternion, exponential };

struct MeshoptLayout {
  MeshoptMode mode = MeshoptMode::attributes;
  MeshoptFilter filter = MeshoptFilter::none;
  std::size_t count = 0;
  std::size_t stride = 0;  // bytes

  [[nodiscard]] std::size_t bytes() const { return count * stride; }
};

// Returns true if the extension allows the stride in this mode and with this filter, and the filter in this mode.
bool is_allowed(const MeshoptLayout& layout);

// The most bytes that one byte of a valid stream can unpack to. A reader that checks this ratio allocates in proportion
// to its file. The attribute codec's version 1 reaches the ratio with a constant array, at 2 bits for 256 bytes.
inline constexpr std::size_t kMaxMeshoptRatio = 1024;

// Unpacks the stream into `elements`, which has layout.bytes() bytes; the layout must be allowed. Returns false, with
// `elements` unspecified, if the stream is damaged or of a version that the library does not read. Unpacked indices are
// not checked: triangles may name any corner.
bool unpack(const MeshoptLayout& layout, std::span<const std::byte> stream, std::span<std::byte> elements);

// Pack without loss, in the versions of the codecs that the extension prescribes. pack_attributes() requires a stride
// that is a multiple of 4, up to 256. The array must not be empty.
std::vector<std::byte> pack_attributes(std::span<const std::byte> elements, std::size_t stride);
std::vector<std::byte> pack_indices(std::span<const std::uint32_t> indices);

inline constexpr int kMaxExponent = 76;

// Encodes the numbers whole[i] * 2^exponent as words of the filter EXPONENTIAL. Common factors of two move to the
// exponent, and the numbers move to the upper bytes of the word's 24 bits, where they pack best; so the words depend
// only on the numbers' values. |whole[i]| < 2^23, and |exponent| <= kMaxExponent.
std::vector<std::uint32_t> exponential_words(std::span<const std::int32_t> whole, int exponent);

}  // namespace ringdown::modal
