#include "tests/stress/table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <vector>

namespace ringdown::test {
namespace {

std::string percent(double share) {
  if (std::isnan(share)) return "";
  char text[32];
  std::snprintf(text, sizeof text, share != 0 && share < 1e-5 ? "%.0e" : "%.3g", 100 * share);
  return text;
}

std::string markdown(const TableLine& line) {
  const bool solved = line.unknowns > 0;
  char seconds[32] = "";
  if (!std::isnan(line.seconds)) std::snprintf(seconds, sizeof seconds, "%.1f", line.seconds);
  std::string row = "| " + line.name + " | " + line.hard + " | ";
  row += solved ? std::to_string(line.unknowns) + " | " + std::to_string(line.found) + " / " +
                      std::to_string(line.there) + " | "
                : " | | ";
  return row + percent(line.error) + " | " + percent(line.limit) + " | " + percent(line.estimate) + " | " + seconds +
         " | " + line.outcome + " |";
}

class Table : public testing::Environment {
 public:
  void add(const TableLine& line) {
    lines_.push_back(markdown(line));
    std::printf("%s\n", lines_.back().c_str());
    std::fflush(stdout);
  }

  void TearDown() override {
    const char* path = std::getenv("RINGDOWN_STRESS_TABLE");
    if (path == nullptr) return;
    std::ofstream file(path);
    file << "| case | what is hard | unknowns | modes found / there | worst error % | allowed % | the bank's estimate "
            "% | "
            "seconds | outcome |\n|---|---|--:|--:|--:|--:|--:|--:|---|\n";
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

void enter(const TableLine& line) { table().add(line); }

}  // namespace ringdown::test
