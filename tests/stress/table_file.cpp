#include "tests/stress/table_file.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <vector>

namespace ringdown::test {
namespace {

class Table : public testing::Environment {
 public:
  void add(const std::string& head, const std::string& line) {
    head_ = head;
    lines_.push_back(line);
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
  }

  void TearDown() override {
    const char* path = std::getenv("RINGDOWN_STRESS_TABLE");
    if (path == nullptr) return;
    std::ofstream file(path);
    file << head_ << "\n";
    for (const std::string& line : lines_) file << line << "\n";
    EXPECT_TRUE(file.good()) << "cannot write " << path;
  }

 private:
  std::string head_;
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

void enter_line(const std::string& head, const std::string& line) { table().add(head, line); }

}  // namespace ringdown::test
