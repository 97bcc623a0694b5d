// The master of MTS-ESP, played by a test: the library that clients load stands in for the real one.
#pragma once

#include <dlfcn.h>

#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace ringdown::test {

class MtsEspMaster {
 public:
  static constexpr const char* kLibrary = RINGDOWN_BIN_DIR "/tests/mts_esp_stand_in.so";

  // Lets clients that are made from now on find the stand-in.
  MtsEspMaster() : library_(dlopen(kLibrary, RTLD_NOW)) {
    if (!library_) throw std::runtime_error(dlerror());
    setenv("RINGDOWN_MTS_ESP", kLibrary, 1);
    for (int key = 0; key < 128; ++key) tune(key, 440 * std::exp2((key - 69) / 12.0));
  }
  ~MtsEspMaster() {
    set_present(false);
    unsetenv("RINGDOWN_MTS_ESP");
    dlclose(library_);
  }
  MtsEspMaster(const MtsEspMaster&) = delete;
  MtsEspMaster& operator=(const MtsEspMaster&) = delete;

  void set_present(bool on) { function<void (*)(bool)>("stand_in_set_master")(on); }
  void tune(int key, double frequency_hz, bool is_unmapped = false) {
    function<void (*)(int, double, bool)>("stand_in_tune")(key, frequency_hz, is_unmapped);
  }
  [[nodiscard]] int clients() { return function<int (*)()>("stand_in_clients")(); }

 private:
  template <class Function>
  Function function(const char* name) {
    return reinterpret_cast<Function>(dlsym(library_, name));
  }
  void* library_;
};

}  // namespace ringdown::test
