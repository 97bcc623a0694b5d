// ringdown-bake FOLDER that is cancelled, killed, or whose children are: what is left, and how it goes on.
#include "tests/batch/box_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <thread>

namespace ringdown::test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Words = std::vector<std::string>;

std::string command_line_of(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/cmdline");
  std::string text{std::istreambuf_iterator<char>(file), {}};
  std::replace(text.begin(), text.end(), '\0', ' ');
  return text;
}

// The child that bakes the object of that name, once it does.
pid_t child_baking(const Process& parent, const std::string& name) {
  pid_t found = 0;
  comes_true([&] {
    for (const pid_t child : children_of(parent.id())) {
      if (command_line_of(child).find("/" + name + ".toml ") != std::string::npos) found = child;
    }
    return found != 0 || !is_running(parent.id());
  });
  return found;
}

// Two objects are done, "slow" is at work.
class Interrupted : public testing::Test {
 protected:
  void SetUp() override {
    boxes_.box("a", 100);
    boxes_.box("b", 110);
    boxes_.slow("slow");
    parent_.emplace(boxes_.command({"--jobs", "2"}));
    slow_ = child_baking(*parent_, "slow");
    ASSERT_NE(slow_, 0) << parent_->output();
    ASSERT_TRUE(parent_->wait_for_output("a: baked", 4min)) << parent_->output();
    ASSERT_TRUE(parent_->wait_for_output("b: baked", 4min)) << parent_->output();
  }

  // What is left is whole, and the next run bakes only what is missing.
  void expect_to_go_on() {
    EXPECT_EQ(boxes_.files_in_banks(), (Words{"a.glb", "b.glb"}));
    EXPECT_EQ(boxes_.whole_banks(), (Words{"a.glb", "b.glb"}));
    boxes_.box("slow", 120);  // or it would take a minute
    const Outcome next = boxes_.bake();
    EXPECT_EQ(next.exit_code, 0);
    EXPECT_NE(next.output.find("3 objects: 1 baked, 2 unchanged, 0 failed; "), std::string::npos) << next.output;
    EXPECT_EQ(boxes_.whole_banks(), (Words{"a.glb", "b.glb", "slow.glb"}));
  }

  BoxFolder boxes_;
  std::optional<Process> parent_;
  pid_t slow_ = 0;
};

TEST_F(Interrupted, ControlCEndsABatchAndItsChildren) {
  parent_->send_signal(SIGINT);
  EXPECT_EQ(parent_->wait(4min), 130) << parent_->output();
  EXPECT_TRUE(comes_true([&] { return !is_running(slow_); }));
  const std::string said = parent_->output();
  EXPECT_NE(said.find("2 baked, 0 unchanged, 0 failed, 1 not done; "), std::string::npos) << said;
  EXPECT_NE(said.find("\nringdown-bake: cancelled; the same command continues from here\n"), std::string::npos) << said;
  expect_to_go_on();
}

TEST_F(Interrupted, ChildrenOfABatchDoNotOutliveAKilledParent) {
  parent_->send_signal(SIGKILL);
  EXPECT_EQ(parent_->wait(4min), 128 + SIGKILL);
  EXPECT_TRUE(comes_true([&] { return !is_running(slow_); }));
  expect_to_go_on();
}

TEST_F(Interrupted, ABakeThatCrashesIsOneFailureOfTheBatch) {
  ::kill(slow_, SIGSEGV);
  EXPECT_EQ(parent_->wait(4min), 3);
  const std::string said = parent_->output();
  EXPECT_NE(said.find("2 baked, 0 unchanged, 1 failed; "), std::string::npos) << said;
  EXPECT_NE(said.find("\nringdown-bake: slow: its process was ended by signal 11 (Segmentation fault) at "),
            std::string::npos)
      << said;
  expect_to_go_on();
}

TEST_F(Interrupted, ABakeThatTheKernelKillsIsReportedAsALackOfMemory) {
  ::kill(slow_, SIGKILL);
  EXPECT_EQ(parent_->wait(4min), 3);
  EXPECT_NE(parent_->output().find("ended by signal 9 (Killed) at "), std::string::npos);
  EXPECT_NE(parent_->output().find("as the kernel does when memory runs out"), std::string::npos);
}

TEST(FolderBake, ABakeWithoutEnoughMemoryIsOneFailureOfTheBatch) {
  const BoxFolder boxes;
  boxes.box("a", 100);
  boxes.write("objects/large.toml",
              "material = \"stuff\"\nunit_m = 0.001\nmesh_size_m = 0.003\ngeometry = \"box.geo\"\n");
  const auto run_with_little_memory = [](const Words& words) {
    std::string command = "ulimit -v 1200000; exec";  // kB
    for (const std::string& word : words) command += " '" + word + "'";
    return run({"bash", "-c", command}, {}, 4min);
  };
  const Outcome ran = run_with_little_memory(boxes.command({"--jobs", "1"}));
  EXPECT_EQ(ran.exit_code, 3);
  EXPECT_NE(ran.output.find("1 baked, 0 unchanged, 1 failed; "), std::string::npos) << ran.output;
  const std::size_t line = ran.output.find("\nringdown-bake: large: ");
  ASSERT_NE(line, std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find("not enough memory", line), std::string::npos) << ran.output;
  EXPECT_EQ(boxes.files_in_banks(), Words{"a.glb"});

  const Outcome alone = run_with_little_memory({RINGDOWN_BIN_DIR "/ringdown-bake", boxes.objects() / "large.toml", "-o",
                                                boxes.bank("large"), "--materials", boxes.materials(), "--no-cache"});
  EXPECT_EQ(alone.exit_code, 1) << "a failure, not bad input: " << alone.output;
  EXPECT_NE(alone.output.find("not enough memory"), std::string::npos) << alone.output;
}

TEST(FolderBake, BakesOfABatchShareTheProcessors) {
  const BoxFolder boxes;
  for (const char* name : {"one", "two", "three"}) boxes.slow(name);
  Process parent(boxes.command({"--jobs", "2"}));
  ASSERT_TRUE(comes_true([&] { return children_of(parent.id()).size() == 2; }));
  const int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / 2);
  for (const pid_t child : children_of(parent.id())) {
    ASSERT_TRUE(comes_true([&] { return command_line_of(child).find(".toml") != std::string::npos; }));
    std::ifstream file("/proc/" + std::to_string(child) + "/environ");
    const std::string environment{std::istreambuf_iterator<char>(file), {}};
    for (const char* name : {"RINGDOWN_THREADS=", "OPENBLAS_NUM_THREADS="}) {
      EXPECT_NE(environment.find(name + std::to_string(threads) + '\0'), std::string::npos) << name;
    }
  }
  EXPECT_EQ(children_of(parent.id()).size(), 2u) << "never more than were asked for";
}

TEST(FolderBake, HalfWrittenBanksOfAKilledProcessAreRemoved) {
  const BoxFolder boxes;
  boxes.box("a", 100);
  const fs::path old = boxes.write("banks/a.glb.x7Qp2Z", "half"), young = boxes.write("banks/a.glb.AbCdEf", "half"),
                 stranger = boxes.write("banks/b.glb.x7Qp2Z", "of another");
  for (const fs::path& file : {old, stranger}) {
    fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(1));
  }
  EXPECT_EQ(boxes.bake().exit_code, 0);
  EXPECT_EQ(boxes.files_in_banks(), (Words{"a.glb", "a.glb.AbCdEf", "b.glb.x7Qp2Z"})) << "another may be writing";
}

}  // namespace
}  // namespace ringdown::test
