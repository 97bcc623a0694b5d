// Programs that run out of something: memory, threads, descriptors, room in a file. Each says so in one sentence, ends
// with an exit code of its own, and leaves no half-written file.
#include "engine/modal/bank_file.h"
#include "protocol/wire/score.h"
#include "tests/integration/daemon_fixture.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

namespace ringdown::test {
namespace {

namespace fs = std::filesystem;

constexpr int kNotLoaded = 127;  // the exit code of the shell and of the loader, where a program cannot even be started

class Scarcity : public testing::Test {
 protected:
  void SetUp() override {
#ifdef RINGDOWN_SANITIZE
    GTEST_SKIP() << "sanitizers map more memory than a limit allows";
#endif
    ASSERT_TRUE(modal::write_bank(single_mode_bank(300, 5), folder_ / "bell.glb"));
    ASSERT_TRUE(wire::write_score(std::vector<wire::ScoreEvent>{{0, {"/c_set", {0, 0}}}}, folder_ / "empty.osc"));
  }

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

  // A program of ours under a limit of the shell's `ulimit`.
  [[nodiscard]] static std::vector<std::string> limited(const std::string& limit, const std::string& name,
                                                        const std::string& arguments) {
    return {"sh", "-c", "ulimit " + limit + "; exec " + program(name) + " " + arguments};
  }

  // The program did its work, or its last line, after what a daemon logs, is a sentence that says why not. Where not
  // even the program can be loaded, the loader says so.
  static void expect_one_sentence(const Outcome& outcome, const std::string& name, const std::string& limit) {
    if (outcome.exit_code == 0 || outcome.exit_code == kNotLoaded) return;
    EXPECT_LT(outcome.exit_code, 126) << limit << ": " << outcome.output;
    const std::size_t sentence = outcome.output.rfind(name + ": ");
    ASSERT_NE(sentence, std::string::npos) << limit << ": " << outcome.output;
    EXPECT_EQ(outcome.output.find('\n', sentence), outcome.output.size() - 1) << limit << ": " << outcome.output;
    EXPECT_EQ(outcome.output.find(name + ": "), sentence) << limit << ": " << outcome.output;
  }

  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_.path()), {}));
  }

  TemporaryFolder folder_;
};

TEST_F(Scarcity, WithLittleMemoryTheDaemonRunsOrSaysWhyNot) {
  for (int kib = 60'000; kib <= 140'000; kib += 8'000) {
    const std::string limit = "-v " + std::to_string(kib);
    const Outcome outcome = run(limited(limit, "ringdownd", "--driver null --port 0 --seconds 0.02"));
    expect_one_sentence(outcome, "ringdownd", limit);
  }
}

TEST_F(Scarcity, WithFewDescriptorsTheDaemonRunsOrSaysWhyNot) {
  for (int max = 4; max <= 16; max += 2) {
    const std::string limit = "-n " + std::to_string(max);
    const Outcome outcome = run(limited(limit, "ringdownd", "--driver null --port 0 --query 0 --tcp 0 --seconds 0.02"));
    EXPECT_EQ(outcome.output.find("taken"), std::string::npos) << limit << ": " << outcome.output;
    expect_one_sentence(outcome, "ringdownd", limit);
  }
}

// OpenBLAS asks again and again for memory that it does not get, and fork() and exit() wait for it.
TEST_F(Scarcity, ProgramsThatBakeSayThatTheirMemoryDoesNotSuffice) {
  for (const char* name : {"ringdown-bake", "ringdown-check", "ringdown-fill", "ringdown-tune", "ringdown-compare"}) {
    if (!fs::exists(program(name))) GTEST_SKIP() << name << " is not built";
    const Outcome outcome = run(limited("-v 150000", name, "--version"));
    EXPECT_EQ(outcome.exit_code, 1) << name << outcome.output;
    expect_one_sentence(outcome, name, "-v 150000");
    EXPECT_NE(outcome.output.find("OpenBLAS"), std::string::npos) << outcome.output;
  }
}

TEST_F(Scarcity, AFileThatGrowsTooLargeIsComplainedOfAndRemoved) {
  const std::string bank = path("bell.glb");
  for (const auto& [arguments, output] : {
           std::pair("render --object bell=" + bank + " --seconds 1 -o ", "sound.wav"),
           std::pair("scale " + bank + " --size 2 -o ", "large.glb"),
       }) {
    const std::size_t before = files();
    const Outcome outcome = run(limited("-f 1", "ringdown", arguments + path(output)));
    EXPECT_EQ(outcome.exit_code, 1) << arguments << outcome.output;
    EXPECT_NE(outcome.output.find("cannot write " + path(output)), std::string::npos) << outcome.output;
    EXPECT_EQ(files(), before) << arguments;
    const Outcome full = run({"sh", "-c", program("ringdown") + " " + arguments + "/dev/full"});
    EXPECT_EQ(full.exit_code, 1) << arguments << full.output;
    EXPECT_NE(full.output.find("cannot write /dev/full: No space left"), std::string::npos) << full.output;
  }
}

// Streamed to the file: 33 GB would not fit in the memory of most computers, and no signal would be heard before.
TEST_F(Scarcity, ALongRenderNeedsLittleMemoryAndHearsASignal) {
  for (const int signal : {SIGTERM, SIGHUP, SIGQUIT}) {
    const std::size_t before = files();
    Process render(limited("-v 500000", "ringdown",
                           "render --events " + path("empty.osc") + " --seconds 86400 -o " + path("day.wav")));
    const bool grows = becomes_true([&] {
      return render.wait(std::chrono::milliseconds(0)) ||
             std::ranges::any_of(fs::directory_iterator(folder_.path()), [](const fs::directory_entry& entry) {
               std::error_code gone;
               const auto size = fs::file_size(entry.path(), gone);
               return !gone && size > 1'000'000;
             });
    });
    EXPECT_TRUE(grows);
    render.send_signal(signal);
    EXPECT_EQ(render.wait(), 130) << render.output();
    EXPECT_EQ(files(), before);
  }
}

}  // namespace
}  // namespace ringdown::test
