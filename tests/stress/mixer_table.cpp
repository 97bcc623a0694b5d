#include "tests/stress/mixer_table.h"

#include <array>
#include <cstdarg>
#include <cstdio>

namespace ringdown::synth::test {

void enter(const MixerLine& line) {
  ringdown::test::enter_line("| case | what is hard | measured | allowed |\n|---|---|---|---|",
                             "| " + line.name + " | " + line.hard + " | " + line.figure + " | " + line.allowed + " |");
}

std::string text(const char* format, ...) {
  std::array<char, 400> line{};
  std::va_list values;
  va_start(values, format);
  std::vsnprintf(line.data(), line.size(), format, values);
  va_end(values);
  return line.data();
}

}  // namespace ringdown::synth::test
