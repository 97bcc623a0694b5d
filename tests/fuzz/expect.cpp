#include "tests/fuzz/targets.h"

#include <cstdio>
#include <cstdlib>

void ringdown::fuzz::expect(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "expected: %s\n", what);
  std::abort();
}
