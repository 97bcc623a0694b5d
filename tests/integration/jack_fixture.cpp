#include "tests/integration/jack_fixture.h"

#include "engine/modal/bank_file.h"
#include "tests/support/synthetic_bank.h"

namespace ringdown::test {

void JackTest::SetUp() {
  for (const char* needed : {"jackd", "jack_lsp", "oscsend"}) {
    if (!installed(needed)) GTEST_SKIP() << "needs jackd2, jack-tools and liblo-tools (./run packages)";
  }
  bank("tone.glb", kPitch_hz, kDecay_per_s);
  ASSERT_TRUE(server_.runs());
}

std::filesystem::path JackTest::bank(const std::string& name, double frequency_hz, double decay_per_s) {
  EXPECT_TRUE(modal::write_bank(single_mode_bank(frequency_hz, decay_per_s), folder_ / name));
  return folder_ / name;
}

std::optional<protocol::StatusReply> JackTest::status(Daemon& daemon) {
  return ask_for<protocol::StatusReply>(daemon, {"/status", {}});
}

testing::AssertionResult JackTest::driver_looks(Daemon& daemon) const {
  for (const std::uint32_t input : {3u, 4u}) {
    const std::string port = "ringdown:in_" + std::to_string(input);
    if (!done(daemon, protocol::format(protocol::Excite{{.name = "tone"}, input, {1, 0, 0}, {0, 0, 1}}))) {
      return testing::AssertionFailure() << "no input " << input;
    }
    if (!becomes_true([&] { return server_.connections().contains(port); })) {
      return testing::AssertionFailure() << "no port " << port;
    }
  }
  return testing::AssertionSuccess();
}

wire::Message JackTest::strike(const std::string& object, double impulse_ns) {
  return protocol::format(protocol::Strike{{.name = object}, {{1, 0, 0}, {0, 0, impulse_ns}, 0}});
}

}  // namespace ringdown::test
