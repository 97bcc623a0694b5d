#include "engine/base/process/child_process.h"

#include <gtest/gtest.h>

#include <csignal>

namespace ringdown {
namespace {

using Words = std::vector<std::string>;

TEST(ChildProcess, LinesOfAChildArriveOneByOneAndItsErrorsAreKept) {
  Words lines;
  const auto done = run_child({.command = {"sh", "-c", "printf 'one\\ntwo\\npart'; echo wrong >&2; exit 3"},
                               .on_line = [&](std::string_view line) { lines.emplace_back(line); }});
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_EQ(done->exit_code, 3);
  EXPECT_EQ(lines, (Words{"one", "two"}));
  EXPECT_EQ(last_line(done->errors), "wrong");
  EXPECT_GT(done->peak_mib, 0);
}

TEST(ChildProcess, AChildRunsInTheEnvironmentAndFolderItWasGiven) {
  std::string said;
  const auto done = run_child({.command = {"sh", "-c", "echo $PWD $RINGDOWN_TEST $HOME"},
                               .environment = {{"RINGDOWN_TEST", "7"}, {"HOME", "/nowhere"}},
                               .folder = "/",
                               .on_line = [&](std::string_view line) { said = line; }});
  ASSERT_TRUE(done);
  EXPECT_EQ(said, "/ 7 /nowhere");
}

TEST(ChildProcess, RunningAMissingProgramFailsWithASentence) {
  const auto done = run_child({.command = {"ringdown-no-such-program"}});
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().message.find("cannot run ringdown-no-such-program: No such file"), std::string::npos);
}

TEST(ChildProcess, AChildEndsWhenStoppedOrOutOfTimeEvenIfItIgnoresSignals) {
  int asked = 0;
  const auto told = run_child({.command = {"sleep", "30"}, .keep_going = [&] { return ++asked < 3; }});
  ASSERT_TRUE(told);
  EXPECT_TRUE(told->stopped);
  EXPECT_EQ(told->exit_code, 128 + SIGTERM);
  const auto late =
      run_child({.command = {"sh", "-c", "trap '' TERM; while true; do sleep 0.05; done"}, .limit_s = 0.2});
  ASSERT_TRUE(late);
  EXPECT_TRUE(late->out_of_time);
  EXPECT_EQ(late->exit_code, 128 + SIGKILL);
}

TEST(ChildProcess, AChildDoesNotInheritBlockedSignals) {
  sigset_t term, before;
  sigemptyset(&term);
  sigaddset(&term, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &term, &before);
  const auto late = run_child({.command = {"sleep", "30"}, .limit_s = 0.1});
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  ASSERT_TRUE(late);
  EXPECT_EQ(late->exit_code, 128 + SIGTERM);
}

TEST(ChildProcess, LastLineOfATextIsTheLastOneThatIsNotBlank) {
  EXPECT_EQ(last_line("one\n  two \n\n"), "two");
  EXPECT_EQ(last_line(" \n"), "");
  EXPECT_EQ(last_line("one"), "one");
}

}  // namespace
}  // namespace ringdown
