// Defines the handles of the C API, and turns results and exceptions into its codes and sentences.
// Private to clients/library.
#pragma once

#include "clients/library/ringdown.h"
#include "clients/library/terms.h"
#include "engine/base/result.h"
#include "engine/base/rotation.h"
#include "engine/base/vec3.h"
#include "engine/modal/response/residual.h"
#include "server/session/breakage.h"
#include "server/session/rack.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <vector>

struct ringdown_bank {
  ringdown::session::BankFile file;
  std::string path;  // or the name that was given
  std::optional<ringdown::modal::Residual> residual = {};
};

struct ringdown_mixer {
  explicit ringdown_mixer(double sample_rate_hz) : rack(sample_rate_hz, banks) { events.reserve(kEvents); }

  static constexpr std::size_t kEvents = 16;

  ringdown::session::FileRoots roots;  // every file may be read
  ringdown::session::BankReader banks{roots};
  ringdown::session::Rack rack;
  ringdown::session::Breakage breakage{rack};
  std::vector<ringdown::synth::Event> events;  // [control] of the call that is carried out
  std::atomic<std::uint64_t> dropped = 0;
  bool has_scene = false;  // [worker]
};

namespace ringdown::library {

inline ringdown_result code_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::bad_input:
    case ErrorKind::usage:
      return RINGDOWN_BAD_INPUT;
    case ErrorKind::too_large:
      return RINGDOWN_TOO_LARGE;
    case ErrorKind::no_memory:
      return RINGDOWN_NO_MEMORY;
    case ErrorKind::input_output:
      return RINGDOWN_INPUT_OUTPUT;
    case ErrorKind::refused:
    case ErrorKind::cancelled:
    case ErrorKind::no_sound_server:
    case ErrorKind::port_busy:
      break;
  }
  return RINGDOWN_REFUSED;
}

inline ringdown_result tell(ringdown_result result, std::string_view sentence, ringdown_error* error) {
  if (!error) return result;
  error->result = result;
  std::size_t length = std::min(sentence.size(), sizeof error->sentence - 1);
  const auto continues = [&](std::size_t at) { return (static_cast<unsigned char>(sentence[at]) & 0xc0) == 0x80; };
  while (length < sentence.size() && length > 0 && continues(length)) --length;  // UTF-8: cut between characters
  std::copy_n(sentence.data(), length, error->sentence);
  error->sentence[length] = '\0';
  return result;
}

// Carries out `work`, which returns a Result<void>. No exception leaves it.
template <class Work>
ringdown_result guarded(ringdown_error* error, Work work) {
  try {
    const Result<void> done = work();
    if (!done) return tell(code_of(done.error().kind), done.error().message, error);
    if (error) tell(RINGDOWN_OK, "", error);
    return RINGDOWN_OK;
  } catch (const std::bad_alloc&) {
    return tell(RINGDOWN_NO_MEMORY, "there is not enough memory for this", error);
  } catch (const std::exception& unforeseen) {
    return tell(RINGDOWN_REFUSED, unforeseen.what(), error);
  }
}

// Returns the caller's struct, of whatever version, over our defaults. Members that it is too short for keep their
// defaults; members that ours does not have must be 0, because they would be ignored.
template <class Struct>
Result<Struct> taken(const Struct* given, std::size_t size, Struct defaults) {
  if (!given) return missing("the struct");
  if (size < sizeof(std::size_t) || size > 4096) {
    return fail(
        ErrorKind::bad_input,
        "the first member of the struct is {}; set it to sizeof the struct, as the struct's _init function does", size);
  }
  const auto* bytes = reinterpret_cast<const unsigned char*>(given);
  const std::size_t known = std::min(size, sizeof(Struct));
  if (std::any_of(bytes + known, bytes + size, [](unsigned char byte) { return byte != 0; })) {
    return fail(ErrorKind::bad_input,
                "the struct has members that this version of the library does not know; leave "
                "them 0, or use a later library");
  }
  std::memcpy(&defaults, given, known);
  return defaults;
}

// Writes as much of `ours` as the caller's struct has room for. Its first member, the size, stays.
template <class Struct>
Result<void> give(Struct* given, const Struct& ours) {
  if (!given) return missing("the struct");
  if (given->size < sizeof given->size)
    return fail(ErrorKind::bad_input, "the struct's size is not set; set it to sizeof the struct");
  const std::size_t size = given->size;
  std::memcpy(given, &ours, std::min(size, sizeof(Struct)));
  given->size = size;
  return {};
}

inline protocol::ObjectRef numbered(std::uint32_t object) { return {.name = {}, .number = object}; }

inline Vec3 vector(const double* xyz) { return {xyz[0], xyz[1], xyz[2]}; }

// The header's quaternions have their real part first.
inline Rotation rotation(const double* wxyz) { return Rotation::from_wxyz(wxyz[0], wxyz[1], wxyz[2], wxyz[3]); }

}  // namespace ringdown::library
