// Banks that ask for more memory than they may have, or than there is: each is refused with a sentence that names it,
// and the program goes on.
#include "engine/modal/bank_file.h"
#include "tests/integration/daemon_fixture.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstring>
#include <sys/resource.h>

namespace ringdown::test {
namespace {

using protocol::Fail;
using protocol::VersionReply;

// A .glb whose JSON text is a list of zeros.
std::string bank_of_zeros(std::size_t bytes) {
  std::string file = "glTF" + std::string(bytes, '0');
  const auto set_word = [&file](std::size_t at, std::size_t value) {
    const auto word = static_cast<std::uint32_t>(value);
    std::memcpy(file.data() + at, &word, sizeof word);
  };
  set_word(4, 2);
  set_word(8, file.size());
  set_word(12, file.size() - 20);
  std::memcpy(file.data() + 16, "JSON{\"a\":[", 10);
  for (std::size_t i = 27; i + 2 < file.size(); i += 2) file[i] = ',';
  file.replace(file.size() - 3, 3, "]} ");
  return file;
}

// 4,000 points and 1,000 modes: 48 MB of shapes.
modal::Bank large_bank() {
  modal::Bank bank = single_mode_bank(300, 1);
  bank.frequency_hz.assign(1000, 300);
  bank.radiation.reset();
  bank.decay_per_s.assign(1000, 1);
  bank.positions.resize(4000, bank.positions.front());
  bank.shapes.assign(1000 * bank.positions.size(), {0, 0, 1});
  return bank;
}

std::string refusal_of_loading(Daemon& daemon, const std::filesystem::path& bank) {
  const auto reply = daemon.ask({"/load", {"bell", bank.string()}});
  const auto* refusal = reply ? reply->get_if<Fail>() : nullptr;
  return refusal ? refusal->sentence : "";
}

// For addresses, as `ulimit -v` sets it.
void limit_memory(pid_t process, rlim_t bytes) {
  const rlimit limit{bytes, RLIM_INFINITY};
  ASSERT_EQ(::prlimit(process, RLIMIT_AS, &limit, nullptr), 0);
}

class MemoryTest : public testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "the sanitizer takes terabytes of addresses for itself";
#endif
    ASSERT_TRUE(daemon_.ready()) << daemon_.process().output();
  }

  TemporaryFolder folder_;
  Daemon daemon_{{"--settings", "none", "--driver", "null", "--root", folder_.path().string()}};
};

TEST_F(MemoryTest, ABankOfJsonZerosIsRefusedBeforeTheyAreKept) {
  for (const std::size_t megabytes : {std::size_t{10}, std::size_t{100}}) {
    const auto bank = folder_.write("zeros.glb", bank_of_zeros(megabytes * 1'000'000));
    daemon_.process().forget_peak();
    const long before_kb = daemon_.process().memory_kb("VmRSS:");
    const std::string refusal = refusal_of_loading(daemon_, bank);
    EXPECT_NE(refusal.find("zeros.glb: its JSON text has more than"), std::string::npos) << refusal;
    const long growth_kb = daemon_.process().memory_kb("VmHWM:") - before_kb;
    EXPECT_LT(growth_kb, static_cast<long>(megabytes) * 1000 + 16 * 1024) << "the file's size and 16 MB";
  }
}

TEST_F(MemoryTest, AHugeBankUnderALimitOfMemoryDoesNotEndTheDaemon) {
  limit_memory(daemon_.process().id(), rlim_t{3} << 30);
  const auto bank = folder_.write("zeros.glb", bank_of_zeros(190'000'000));
  EXPECT_NE(refusal_of_loading(daemon_, bank).find("zeros.glb"), std::string::npos);
  EXPECT_TRUE(ask_for<VersionReply>(daemon_, {"/version", {}})) << daemon_.process().output();
}

TEST_F(MemoryTest, ABankIsRefusedWhereverMemoryEndsAndLoadsWhenThereIsMore) {
  const auto bank = folder_ / "large.glb";
  ASSERT_TRUE(modal::write_bank(large_bank(), bank));
  const auto now = static_cast<rlim_t>(daemon_.process().memory_kb("VmSize:")) * 1024;
  int refused = 0;
  for (rlim_t room = 8'000'000; room < 1'000'000'000; room += 24'000'000) {  // half of one of the bank's copies
    limit_memory(daemon_.process().id(), now + room);
    const std::string refusal = refusal_of_loading(daemon_, bank);
    ASSERT_TRUE(ask_for<VersionReply>(daemon_, {"/version", {}})) << room << daemon_.process().output();
    if (refusal.empty()) break;
    EXPECT_NE(refusal.find("there is not enough memory to"), std::string::npos) << room << ": " << refusal;
    EXPECT_NE(refusal.find("large.glb"), std::string::npos) << room << ": " << refusal;
    ++refused;
  }
  EXPECT_GT(refused, 3);
  EXPECT_EQ(ask_for<protocol::StatusReply>(daemon_, {"/status", {}}).value_or(protocol::StatusReply{}).objects, 1);
}

TEST_F(MemoryTest, ACommandThatHasTooLittleMemoryForABankSaysSo) {
  const auto large = folder_ / "large.glb";
  ASSERT_TRUE(modal::write_bank(large_bank(), large));
  const auto zeros = folder_.write("zeros.glb", bank_of_zeros(20'000'000));
  for (const auto& [bank, exit_code] : {std::pair(large, 1), std::pair(zeros, 3)}) {
    for (const char* verb : {"info", "scale", "picture"}) {
      // A program of its own, which clang does not build for the real-time sanitizer.
      if (verb == std::string("picture") && !std::filesystem::exists(program("ringdown-picture"))) continue;
      std::vector<std::string> command = {"prlimit", "--as=140000000", program("ringdown"), verb, bank.string()};
      if (std::string(verb) != "info") command.insert(command.end(), {"-o", (folder_ / "out.svg").string()});
      if (std::string(verb) == "scale") command.insert(command.end(), {"--size", "2"});
      const Outcome outcome = run(command);
      EXPECT_EQ(outcome.exit_code, exit_code) << verb << ": " << outcome.output;
      EXPECT_NE(outcome.output.find(bank.string()), std::string::npos) << verb << ": " << outcome.output;
    }
  }
}

}  // namespace
}  // namespace ringdown::test
