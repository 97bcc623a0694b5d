// A libFuzzer program: RINGDOWN_FUZZ_TARGET names the function that it feeds.
#include "tests/fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  ringdown::fuzz::RINGDOWN_FUZZ_TARGET(std::as_bytes(std::span(data, size)));
  return 0;
}
