// The same client under PipeWire's JACK, another implementation of the same interface.
#include "engine/modal/bank_file.h"
#include "tests/integration/jack_fixture.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <filesystem>
#include <sstream>

namespace ringdown::test {
namespace {

class PipeWire : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* needed : {"pipewire", "pw-jack", "jack_lsp"}) {
      if (!installed(needed)) GTEST_SKIP() << "needs " << needed << " (packages pipewire, pipewire-jack, jack-tools)";
    }
    // pw-jack only says where PipeWire's libjack is.
    std::istringstream variables(run({"pw-jack", "env"}).output);
    for (std::string line; std::getline(variables, line);) {
      if (line.starts_with("LD_LIBRARY_PATH=")) environment_["LD_LIBRARY_PATH"] = line.substr(line.find('=') + 1);
    }
    ASSERT_TRUE(environment_.contains("LD_LIBRARY_PATH"));
    environment_["XDG_RUNTIME_DIR"] = folder_.path().string();
    std::filesystem::permissions(folder_.path(), std::filesystem::perms::owner_all);
    start();
  }

  void start() {
    server_ = std::make_unique<Process>(std::vector<std::string>{"pipewire"}, environment_);
    ASSERT_TRUE(becomes_true([&] { return run({"jack_lsp"}, environment_).exit_code == 0; })) << server_->output();
  }

  [[nodiscard]] bool has_ports() const {
    const std::string ports = run({"jack_lsp"}, environment_).output;
    return ports.find("ringdown:out_left") != std::string::npos && ports.find("ringdown:tone") != std::string::npos &&
           ports.find("ringdown:midi_in") != std::string::npos;
  }

  TemporaryFolder folder_;
  Process::Environment environment_;
  std::unique_ptr<Process> server_;
};

TEST_F(PipeWire, TheDaemonPlaysUnderPipeWireAndOutlivesIt) {
  ASSERT_TRUE(modal::write_bank(single_mode_bank(440, 8), folder_ / "tone.glb"));
  Daemon daemon({"--ports", "objects", "--object", "tone=" + (folder_ / "tone.glb").string()}, environment_);
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  EXPECT_TRUE(becomes_true([&] { return has_ports(); })) << daemon.process().output();
  EXPECT_TRUE(becomes_true([&] {
    return daemon.send(JackTest::strike("tone")), JackTest::status(daemon)->sounding_objects == 1;
  })) << "its callback runs";
  EXPECT_TRUE(becomes_true([&] { return JackTest::status(daemon)->sounding_objects == 0; }));

  server_->send_signal(SIGKILL);
  server_->wait();
  ASSERT_TRUE(becomes_true([&] { return daemon.process().output().find("server has stopped") != std::string::npos; }));
  start();
  EXPECT_TRUE(becomes_true([&] { return has_ports(); })) << daemon.process().output();
  daemon.process().send_signal(SIGTERM);
  EXPECT_EQ(daemon.process().wait(), 0) << daemon.process().output();
}

}  // namespace
}  // namespace ringdown::test
