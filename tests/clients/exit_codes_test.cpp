// What went wrong reaches a script as an exit code: one for each kind of error, through a program that meets it.
// (A bake that runs out of memory is in tests/batch, which knows how large such a bake must be.)
#include "protocol/exit_codes.h"
#include "tests/integration/process.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

namespace ringdown::test {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

const std::string kRingdown = RINGDOWN_BIN_DIR "/ringdown";

void expect_failure(const std::vector<std::string>& words, int exit_code, const std::string& sentence) {
  std::vector<std::string> command = {kRingdown};
  command.insert(command.end(), words.begin(), words.end());
  const Outcome ran = run(command);
  EXPECT_EQ(ran.exit_code, exit_code) << ran.output;
  EXPECT_TRUE(ran.output.starts_with("ringdown: ")) << ran.output;
  EXPECT_NE(ran.output.find(sentence), std::string::npos) << ran.output;
}

// Whether the process handles SIGINT by now: the second bit of SigCgt in its status.
bool handles_sigint(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("SigCgt:")) return (std::stoull(line.substr(7), nullptr, 16) >> (SIGINT - 1)) & 1;
  }
  return false;
}

TEST(ExitCodes, EveryKindOfErrorHasAnExitCode) {
  using protocol::exit_code_of;
  using protocol::ExitCode;
  EXPECT_EQ(exit_code_of(ErrorKind::bad_input), ExitCode::bad_input);
  EXPECT_EQ(exit_code_of(ErrorKind::too_large), ExitCode::bad_input);
  EXPECT_EQ(exit_code_of(ErrorKind::refused), ExitCode::failure);
  EXPECT_EQ(exit_code_of(ErrorKind::cancelled), ExitCode::cancelled);
  EXPECT_EQ(exit_code_of(ErrorKind::no_memory), ExitCode::failure);
  EXPECT_EQ(exit_code_of(ErrorKind::input_output), ExitCode::failure);
  EXPECT_EQ(exit_code_of(ErrorKind::usage), ExitCode::usage);
  EXPECT_EQ(exit_code_of(ErrorKind::no_sound_server), ExitCode::no_jack);
  EXPECT_EQ(exit_code_of(ErrorKind::port_busy), ExitCode::port_busy);
}

TEST(ExitCodes, AMissingFileIsBadInput) { expect_failure({"info", "/nowhere/bell.glb"}, 3, "/nowhere/bell.glb"); }

TEST(ExitCodes, AFileBeyondTheLimitIsBadInput) {
  const TemporaryFolder folder;
  const fs::path scene = folder.write("scene.toml", "");
  fs::resize_file(scene, (std::size_t{4} << 20) + 1);
  expect_failure({"render", "--scene", scene, "-o", folder.path() / "a.wav"}, 3, "more than the limit");
}

TEST(ExitCodes, AnUnwritableOutputIsAFailure) {
  expect_failure({"render", "--seconds", "0.01", "-o", "/nowhere/a.wav"}, 1, "cannot write /nowhere/a.wav");
}

TEST(ExitCodes, AMissingProgramIsAFailure) {
  const TemporaryFolder folder;
  const fs::path alone = folder.path() / "ringdown";
  fs::copy_file(kRingdown, alone);
  const Outcome ran = run({alone, "bake", "cup.stl"});
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_NE(ran.output.find("ringdown-bake: No such file"), std::string::npos) << ran.output;
}

TEST(ExitCodes, ARenderThatIsInterruptedIsCancelled) {
  const TemporaryFolder folder;
  Process render({kRingdown, "render", "--seconds", "600", "--block", "1", "-o", folder.path() / "a.wav"});
  while (!handles_sigint(render.id())) std::this_thread::sleep_for(1ms);
  render.send_signal(SIGINT);
  EXPECT_EQ(render.wait(60s), 130);
  EXPECT_NE(render.output().find("cancelled; "), std::string::npos) << render.output();
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(ExitCodes, ALackOfMemoryIsAFailure) {
  const TemporaryFolder folder;
  const std::size_t bytes = 200'000'000;  // of a score that consists of zeros
  std::ofstream(folder.path() / "large.osc") << "";
  fs::resize_file(folder.path() / "large.osc", bytes);
  const Outcome ran = run({"bash", "-c", "ulimit -v 200000; exec \"$0\" render --events \"$1\" -o \"$2\"", kRingdown,
                           folder.path() / "large.osc", folder.path() / "a.wav"});
  EXPECT_EQ(ran.exit_code, 1) << ran.output;
  EXPECT_NE(ran.output.find("ringdown: there is not enough memory"), std::string::npos) << ran.output;
}

TEST(ExitCodes, AMistakeInTheCommandLineNamesTheHelpForIt) {
  expect_failure({"info", "--nonsense"}, 2, "ringdown info --help lists the options");
}

}  // namespace
}  // namespace ringdown::test
