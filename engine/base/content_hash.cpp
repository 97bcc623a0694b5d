#include "engine/base/content_hash.h"
#include "engine/base/formatted.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace ringdown {

struct ContentHasher::State {
  XXH3_state_t xxh3;
};

std::string ContentHash::text() const {
  return formatted("{:016x}{:016x}", static_cast<unsigned long long>(high), static_cast<unsigned long long>(low));
}

ContentHasher::ContentHasher() : state_(std::make_unique<State>()) { XXH3_128bits_reset(&state_->xxh3); }
ContentHasher::~ContentHasher() = default;

ContentHasher& ContentHasher::bytes(std::span<const std::byte> content) {
  const std::uint64_t size = content.size();
  XXH3_128bits_update(&state_->xxh3, &size, sizeof size);
  if (size > 0) XXH3_128bits_update(&state_->xxh3, content.data(), content.size());
  return *this;
}

ContentHash ContentHasher::hash() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(&state_->xxh3);
  return {hash.high64, hash.low64};
}

ContentHash hash_of(std::string_view content) { return ContentHasher().text(content).hash(); }

}  // namespace ringdown
