// Every input that is kept, fed to its reader: what was once found stays mended, whatever the compiler.
#include "tests/fuzz/targets.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace ringdown::fuzz {
namespace {

class FuzzCorpus : public testing::TestWithParam<Target> {};

TEST_P(FuzzCorpus, TheFuzzCorpusIsReadWithoutHarm) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(
           std::filesystem::path(RINGDOWN_SOURCE_DIR "/tests/fuzz/corpus") / GetParam().name)) {
    SCOPED_TRACE(entry.path().string());
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string content{std::istreambuf_iterator<char>(file), {}};
    for (const std::size_t size : {content.size(), content.size() / 2, content.size() - content.size() / 8}) {
      GetParam().feed(std::as_bytes(std::span(content).first(size)));
    }
    ++count;
  }
  EXPECT_GT(count, 3);
}

INSTANTIATE_TEST_SUITE_P(All, FuzzCorpus, testing::ValuesIn(kTargets),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace ringdown::fuzz
