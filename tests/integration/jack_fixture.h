// A private JACK server and a bank of one mode: what the JACK tests begin with.
#pragma once

#include "tests/integration/daemon_fixture.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>

namespace ringdown::test {

class JackTest : public testing::Test {
 public:
  static constexpr double kPitch_hz = 987.5, kDecay_per_s = 8;

  // What /status says.
  static std::optional<protocol::StatusReply> status(Daemon& daemon);

  // The message that strikes an object of one mode.
  static wire::Message strike(const std::string& object, double impulse_ns = 0.5);

 protected:
  void SetUp() override;

  // A bank of one mode, in the scratch folder.
  std::filesystem::path bank(const std::string& name, double frequency_hz, double decay_per_s);

  // Returns when the daemon's driver has looked at its connections since the call: it does so after it has made the
  // ports that are wanted, and the second of two comes after the round of the first. Needs an object `tone`.
  [[nodiscard]] testing::AssertionResult driver_looks(Daemon& daemon) const;

  TemporaryFolder folder_;
  std::filesystem::path bank_ = folder_ / "tone.glb";
  JackServer server_;
};

}  // namespace ringdown::test
