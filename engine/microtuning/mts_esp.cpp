#include "engine/microtuning/mts_esp.h"

#include "engine/base/note.h"

#include <cmath>
#include <cstdlib>
#include <dlfcn.h>

namespace ringdown::microtuning {
namespace {

constexpr const char* kInstalled = "/usr/local/lib/libMTS.so";
constexpr char kAnyChannel = -1;

struct Unload {
  void operator()(void* library) const { dlclose(library); }
};

}  // namespace

struct MtsEsp::Library {
  std::unique_ptr<void, Unload> handle;
  void (*register_client)();
  void (*deregister_client)();
  bool (*has_master)();
  const double* (*tuning_table)();                // [Hz] of 128 keys; null: there is none
  bool (*should_filter)(char key, char channel);  // whether a key is unmapped
};

std::filesystem::path MtsEsp::library() {
  const char* const other = std::getenv("RINGDOWN_MTS_ESP");
  return other ? other : kInstalled;
}

MtsEsp::MtsEsp(const std::filesystem::path& library) {
  std::unique_ptr<void, Unload> handle(dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL));
  if (!handle) return;
  auto found = std::make_unique<Library>();
  const auto find = [&handle](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(handle.get(), name));
    return function != nullptr;
  };
  if (!find(found->register_client, "MTS_RegisterClient") || !find(found->deregister_client, "MTS_DeregisterClient") ||
      !find(found->has_master, "MTS_HasMaster") || !find(found->tuning_table, "MTS_GetTuningTable") ||
      !find(found->should_filter, "MTS_ShouldFilterNote")) {
    return;
  }
  found->handle = std::move(handle);
  found->register_client();
  library_ = std::move(found);
}

MtsEsp::~MtsEsp() {
  if (library_) library_->deregister_client();
}

std::optional<KeyTuning> MtsEsp::tuning() const {
  if (!library_ || !library_->has_master()) return std::nullopt;
  const double* const table_hz = library_->tuning_table();
  if (!table_hz) return std::nullopt;
  KeyTuning tuning;
  for (std::size_t key = 0; key < kKeys; ++key) {
    const double semitones = note_of(table_hz[key]) - static_cast<double>(key);
    if (std::isfinite(semitones)) tuning.semitones[key] = semitones;
    tuning.unmapped[key] = library_->should_filter(static_cast<char>(key), kAnyChannel);
  }
  return tuning;
}

}  // namespace ringdown::microtuning
