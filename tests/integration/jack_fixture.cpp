#include "tests/integration/jack_fixture.h"

#include "engine/modal/bank_file.h"
#include "tests/integration/sound_file.h"
#include "tests/support/synthetic_bank.h"

#include <thread>

namespace ringdown::test {

using namespace std::chrono_literals;

void JackTest::SetUp() {
  if (!installed("jackd") || !installed("jack_rec") || !installed("oscsend")) {
    GTEST_SKIP() << "needs jackd2, jack-tools and liblo-tools (./run packages)";
  }
  bank("tone.glb", kPitch_hz, kDecay_per_s);
  ASSERT_TRUE(server_.runs());
}

std::filesystem::path JackTest::bank(const std::string& name, double frequency_hz, double decay_per_s) {
  EXPECT_TRUE(modal::write_bank(single_mode_bank(frequency_hz, decay_per_s), folder_ / name));
  return folder_ / name;
}

Samples JackTest::record(double seconds, const std::function<void()>& play) {
  const auto file = folder_ / "recording.wav";
  Process recorder({"jack_rec", "-f", file.string(), "-d", std::to_string(seconds), "-b", "32", "ringdown:out_left",
                    "ringdown:out_right"},
                   server_.environment());
  std::this_thread::sleep_for(500ms);
  play();
  EXPECT_EQ(recorder.wait(30s).value_or(-1), 0) << recorder.output();
  return read_left(file);
}

std::optional<protocol::StatusReply> JackTest::status(Daemon& daemon) {
  const auto reply = daemon.ask({"/status", {}});
  const auto* status = reply ? std::get_if<protocol::StatusReply>(&*reply) : nullptr;
  return status ? std::optional(*status) : std::nullopt;
}

wire::Message JackTest::strike(const std::string& object, double impulse_ns) {
  return protocol::format(protocol::Strike{{.name = object}, {1, 0, 0}, {0, 0, impulse_ns}, 0});
}

}  // namespace ringdown::test
