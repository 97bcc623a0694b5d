#include "engine/gltf/meshopt_codec.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstdlib>

namespace ringdown::modal {
namespace {

// Selects the codec versions that the extension prescribes. Later versions of the library write newer ones by default.
void choose_versions() {
  static const bool chosen = [] {
    meshopt_encodeVertexVersion(0);
    meshopt_encodeIndexVersion(1);
    return true;
  }();
  static_cast<void>(chosen);
}

bool decode(const MeshoptLayout& layout, std::span<const std::byte> stream, void* elements) {
  const auto* from = reinterpret_cast<const unsigned char*>(stream.data());
  switch (layout.mode) {
    case MeshoptMode::attributes:
      return meshopt_decodeVertexBuffer(elements, layout.count, layout.stride, from, stream.size()) == 0;
    case MeshoptMode::triangles:
      return meshopt_decodeIndexBuffer(elements, layout.count, layout.stride, from, stream.size()) == 0;
    case MeshoptMode::indices:
      return meshopt_decodeIndexSequence(elements, layout.count, layout.stride, from, stream.size()) == 0;
  }
  return false;
}

}  // namespace

bool is_allowed(const MeshoptLayout& layout) {
  const std::size_t stride = layout.stride;
  if (layout.mode != MeshoptMode::attributes) {
    const bool whole = layout.mode == MeshoptMode::indices || layout.count % 3 == 0;
    return whole && (stride == 2 || stride == 4) && layout.filter == MeshoptFilter::none;
  }
  switch (layout.filter) {
    case MeshoptFilter::octahedral:
      return stride == 4 || stride == 8;
    case MeshoptFilter::quaternion:
      return stride == 8;
    case MeshoptFilter::none:
    case MeshoptFilter::exponential:
      break;
  }
  return stride > 0 && stride <= 256 && stride % 4 == 0;
}

bool unpack(const MeshoptLayout& layout, std::span<const std::byte> stream, std::span<std::byte> elements) {
  assert(is_allowed(layout) && elements.size() == layout.bytes());
  if (!decode(layout, stream, elements.data())) return false;
  switch (layout.filter) {
    case MeshoptFilter::none:
      break;
    case MeshoptFilter::octahedral:
      meshopt_decodeFilterOct(elements.data(), layout.count, layout.stride);
      break;
    case MeshoptFilter::quaternion:
      meshopt_decodeFilterQuat(elements.data(), layout.count, layout.stride);
      break;
    case MeshoptFilter::exponential:
      meshopt_decodeFilterExp(elements.data(), layout.count, layout.stride);
      break;
  }
  return true;
}

std::vector<std::byte> pack_attributes(std::span<const std::byte> elements, std::size_t stride) {
  choose_versions();
  const std::size_t count = elements.size() / stride;
  std::vector<std::byte> stream(meshopt_encodeVertexBufferBound(count, stride));
  auto* to = reinterpret_cast<unsigned char*>(stream.data());
  stream.resize(meshopt_encodeVertexBuffer(to, stream.size(), elements.data(), count, stride));
  return stream;
}

std::vector<std::byte> pack_indices(std::span<const std::uint32_t> indices) {
  choose_versions();
  const std::uint32_t largest = *std::max_element(indices.begin(), indices.end());
  std::vector<std::byte> stream(meshopt_encodeIndexSequenceBound(indices.size(), std::size_t{largest} + 1));
  auto* to = reinterpret_cast<unsigned char*>(stream.data());
  stream.resize(meshopt_encodeIndexSequence(to, stream.size(), indices.data(), indices.size()));
  return stream;
}

std::vector<std::uint32_t> exponential_words(std::span<const std::int32_t> whole, int exponent) {
  std::uint32_t bits = 0;
  std::int32_t largest = 0;
  for (const std::int32_t number : whole) {
    const std::int32_t size = std::abs(number);
    bits |= static_cast<std::uint32_t>(size);
    largest = std::max(largest, size);
  }
  std::vector<std::uint32_t> words(whole.size(), 0);
  if (bits == 0) return words;
  // The codec packs each byte of an element separately: a byte of zeros costs nothing, a byte that only repeats the
  // sign does.
  const int factors = std::countr_zero(bits);
  largest >>= factors;
  const int shift = largest < 1 << 7 ? 16 : largest < 1 << 15 ? 8 : 0;
  const auto top = static_cast<std::uint32_t>(exponent + factors - shift) << 24;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const auto mantissa = static_cast<std::uint32_t>((whole[i] >> factors) * (1 << shift));
    words[i] = top | (mantissa & 0xffffff);
  }
  return words;
}

}  // namespace ringdown::modal
