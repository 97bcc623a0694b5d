// A folder of a test's own, gone afterwards; when the test has failed it stays, and where it is is said.
#pragma once

#include "engine/base/folders.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace ringdown::test {

class TemporaryFolder {
 public:
  ~TemporaryFolder() {
    if (!testing::Test::HasFailure()) return;
    folder_.keep();
    std::fprintf(stderr, "kept for a look: %s\n", path().c_str());
  }

  [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }
  [[nodiscard]] std::filesystem::path operator/(std::string_view name) const { return path() / name; }
  [[nodiscard]] std::filesystem::path write(std::string_view name, std::string_view text) const {
    std::ofstream(path() / name) << text;
    return path() / name;
  }

 private:
  PrivateFolder folder_{"ringdown-test"};
};

}  // namespace ringdown::test
