// clients/batch/Makefile, by a real make.
#include "tests/batch/box_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace ringdown::test {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

const std::string kMakefile = RINGDOWN_SOURCE_DIR "/clients/batch/Makefile";

class Make : public testing::Test {
 protected:
  void SetUp() override {
    if (!installed("make")) GTEST_SKIP() << "make is not installed";
    fs::create_directories(presets());
    fs::copy(boxes_.materials(), presets() / "materials", fs::copy_options::recursive);
  }
  [[nodiscard]] fs::path presets() const { return boxes_.banks().parent_path() / "presets"; }
  [[nodiscard]] Outcome make() const {
    return run({"make", "-k", "-j2", "-C", boxes_.banks().parent_path(), "-f", kMakefile},
               {{"PATH", RINGDOWN_BIN_DIR ":" + std::string(std::getenv("PATH"))}, {"RINGDOWN_PRESETS", presets()}},
               std::chrono::minutes(4));
  }
  BoxFolder boxes_;
};

TEST_F(Make, MakeBakesEveryObjectThatIsNewerThanItsBank) {
  for (int n = 1; n <= 3; ++n) boxes_.box("b" + std::to_string(n), 80 + 10 * n);
  const Outcome first = make();
  EXPECT_EQ(first.exit_code, 0) << first.output;
  EXPECT_EQ(boxes_.whole_banks(), (Words{"b1.glb", "b2.glb", "b3.glb"}));
  EXPECT_NE(make().output.find("Nothing to be done"), std::string::npos);
  fs::last_write_time(boxes_.objects() / "b2.toml", fs::file_time_type::clock::now() + std::chrono::hours(1));
  const std::string second = make().output;
  EXPECT_NE(second.find("objects/b2.toml"), std::string::npos) << second;
  EXPECT_EQ(second.find("objects/b1.toml"), std::string::npos) << second;
}

TEST_F(Make, MakeGoesOnAfterABadObject) {
  boxes_.box("good", 100);
  boxes_.write("objects/bad.toml", "material = 7\n");
  const Outcome ran = make();
  EXPECT_EQ(ran.exit_code, 2) << "as make does";
  EXPECT_NE(ran.output.find("ringdown-bake: objects/bad.toml:1: "), std::string::npos) << ran.output;
  EXPECT_EQ(boxes_.files_in_banks(), Words{"good.glb"});
}

}  // namespace
}  // namespace ringdown::test
