// Plays verbs for the C functions: the numbers of a verb become the request that a message to the daemon would be, are
// checked as such a message is, and become an event of the mixer. Private to clients/library.
#pragma once

#include "clients/library/handles.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace ringdown::library {

// Plays the verb whose request is `blank`. `numbers` are its arguments in the order of the protocol's table. Neither
// allocates nor locks, unless it fails. [control]
ringdown_result play(ringdown_mixer* mixer, std::int64_t frame, protocol::MixerRequest blank,
                     std::span<const double> numbers, ringdown_error* error);

template <class Verb>
ringdown_result play(ringdown_mixer* mixer, std::int64_t frame, std::span<const double> numbers,
                     ringdown_error* error) {
  return play(mixer, frame, protocol::RequestOf<Verb>(), numbers, error);
}

inline ringdown_result refuse(const Error& why, ringdown_error* error) {
  return tell(code_of(why.kind), why.message, error);
}

// Fills `size` bytes of a caller's struct, which may be older or newer than ours, with defaults.
template <class Struct>
void fill_in(Struct* given, std::size_t size, const Struct& ours) {
  if (!given || size < sizeof given->size) return;
  std::memset(given, 0, size);
  std::memcpy(given, &ours, std::min(size, sizeof ours));
  given->size = size;
}

template <class Struct>
Result<Struct> taken(const Struct* given, const Struct& defaults) {
  if (!given) return missing("args");
  return taken(given, given->size, defaults);
}

}  // namespace ringdown::library
