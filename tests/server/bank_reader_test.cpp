// Banks from files: read once as long as somebody holds them, again when the file has changed, below the roots only.
#include "server/session/bank_reader.h"

#include "engine/modal/bank_file.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

namespace ringdown::session {
namespace {

class BankReaderTest : public testing::Test {
 protected:
  BankReaderTest() { write(440); }

  void write(double frequency_hz) const {
    EXPECT_TRUE(modal::write_bank(test::single_mode_bank(frequency_hz, 2), bell_));
  }

  test::TemporaryFolder folder_;
  std::filesystem::path bell_ = folder_ / "bell.glb";
  FileRoots roots_;
  BankReader banks_{roots_};
};

TEST_F(BankReaderTest, ABankThatSomebodyHoldsIsNotReadAgain) {
  const auto first = banks_.read(bell_);
  ASSERT_TRUE(first);
  banks_.forget_unused();
  const auto by_another_path = banks_.read(bell_.parent_path() / "." / bell_.filename());
  ASSERT_TRUE(by_another_path);
  EXPECT_EQ(by_another_path->map, first->map);
  EXPECT_EQ(by_another_path->bytes, std::filesystem::file_size(bell_));
  EXPECT_EQ(by_another_path->content, first->content);
}

TEST_F(BankReaderTest, AChangedFileIsAnotherBank) {
  const auto before = banks_.read(bell_);
  write(660);
  std::filesystem::last_write_time(bell_, std::filesystem::last_write_time(bell_) + std::chrono::seconds(2));
  const auto after = banks_.read(bell_);
  ASSERT_TRUE(before && after);
  EXPECT_NE(after->map, before->map);
  EXPECT_NE(after->content, before->content);
}

TEST_F(BankReaderTest, ABankThatNobodyHoldsIsFreed) {
  auto file = banks_.read(bell_);
  ASSERT_TRUE(file);
  const std::weak_ptr<const modal::StrikeMap> map = file->map;
  file = fail(ErrorKind::cancelled, "");
  EXPECT_TRUE(map.expired()) << "the reader itself holds no bank";
  banks_.forget_unused();
  EXPECT_TRUE(banks_.read(bell_));
}

TEST_F(BankReaderTest, AFileOutsideOfTheRootsOrWithoutABankIsRefused) {
  std::filesystem::create_directory(folder_ / "inside");
  const auto only_inside = FileRoots::only({folder_ / "inside"});
  ASSERT_TRUE(only_inside);
  EXPECT_FALSE(BankReader(*only_inside).read(bell_));
  std::filesystem::resize_file(bell_, 40);
  EXPECT_FALSE(banks_.read(bell_));
}

}  // namespace
}  // namespace ringdown::session
