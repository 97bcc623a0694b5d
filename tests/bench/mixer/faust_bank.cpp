// What Faust made of faust_bank.dsp, behind C functions. Not part of the build: the benchmark compiles it when it runs,
// RINGDOWN_FAUST_BANK being Faust's output, and loads it.
#include <faust/dsp/dsp.h>
#include <faust/gui/UI.h>
#include <faust/gui/meta.h>
#include RINGDOWN_FAUST_BANK

#include <cstddef>

#define RINGDOWN_VISIBLE extern "C" __attribute__((visibility("default")))

RINGDOWN_VISIBLE void* bank_new(int rate) {
  auto* bank = new mydsp;
  bank->init(rate);
  return bank;
}
RINGDOWN_VISIBLE void bank_delete(void* bank) { delete static_cast<mydsp*>(bank); }
RINGDOWN_VISIBLE void bank_compute(void* bank, int frames, float* in, float* out) {
  static_cast<mydsp*>(bank)->compute(frames, &in, &out);
}
RINGDOWN_VISIBLE std::size_t bank_bytes() { return sizeof(mydsp); }
