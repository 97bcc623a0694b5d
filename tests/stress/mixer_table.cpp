#include "tests/stress/mixer_table.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <vector>

namespace ringdown::synth::test {
namespace {

class Table : public testing::Environment {
 public:
  void add(const MixerLine& line) {
    lines_.push_back("| " + line.name + " | " + line.hard + " | " + line.figure + " | " + line.allowed + " |");
    std::printf("%s\n", lines_.back().c_str());
    std::fflush(stdout);
  }

  void TearDown() override {
    const char* path = std::getenv("RINGDOWN_STRESS_TABLE");
    if (path == nullptr) return;
    std::ofstream file(path);
    file << "| case | what is hard | measured | allowed |\n|---|---|---|---|\n";
    for (const std::string& line : lines_) file << line << "\n";
    EXPECT_TRUE(file.good()) << "cannot write " << path;
  }

 private:
  std::vector<std::string> lines_;
};

Table& table() {
  static auto* const kTable = static_cast<Table*>(testing::AddGlobalTestEnvironment(new Table));
  return *kTable;
}

// GoogleTest takes environments before it runs.
[[maybe_unused]] const Table& kEarly = table();

}  // namespace

bool long_form() {
  const char* form = std::getenv("RINGDOWN_STRESS");
  return form != nullptr && std::strcmp(form, "long") == 0;
}

void enter(const MixerLine& line) { table().add(line); }

std::string text(const char* format, ...) {
  std::array<char, 400> line{};
  std::va_list values;
  va_start(values, format);
  std::vsnprintf(line.data(), line.size(), format, values);
  va_end(values);
  return line.data();
}

}  // namespace ringdown::synth::test
