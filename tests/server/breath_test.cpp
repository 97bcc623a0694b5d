// The air in an object, by requests.
#include "engine/modal/bank_file.h"
#include "protocol/schema.h"
#include "server/session/session.h"
#include "tests/support/signal.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <span>
#include <string>
#include <vector>

namespace ringdown::session {
namespace {

using Slap = protocol::OnObject<synth::verb::Slap>;
using Blow = protocol::OnObject<synth::verb::Blow>;

class BreathTest : public testing::Test {
 protected:
  BreathTest() {
    EXPECT_TRUE(modal::write_bank(test::vessel_bank(), folder_ / "bottle.glb"));
    EXPECT_TRUE(modal::write_bank(test::single_mode_bank(440, 2), folder_ / "plain.glb"));
    for (const std::string name : {"bottle", "plain"})
      EXPECT_TRUE(session_.perform(protocol::LoadObject{name, (folder_ / (name + ".glb")).string()}, 0));
  }
  test::Samples render(std::size_t frames) {
    std::vector<float> left(frames), right(frames);
    session_.rack().mixer().render(left, right);
    session_.rack().collect();
    return test::to_doubles(left);
  }
  [[nodiscard]] synth::Frame now() { return session_.rack().mixer().counters().frames; }

  test::TemporaryFolder folder_;
  Session session_{48000};
};

TEST_F(BreathTest, SlapRingsTheAirOfALoadedBank) {
  ASSERT_TRUE(session_.play(Slap{{.name = "bottle"}, {1e-3, 0}}, now()));
  const test::DampedSinusoid ring = test::fit_damped_sinusoid(render(24000), 48000);
  EXPECT_NEAR(ring.frequency_hz, test::kAir_hz, 1e-3);
  EXPECT_NEAR(ring.decay_per_s, test::kAirDecay_per_s, 1e-3);
}

TEST_F(BreathTest, BlowLastsUntilAPressureOfZero) {
  ASSERT_TRUE(session_.play(Blow{{.name = "bottle"}, {100}}, now()));
  render(96000);
  EXPECT_GT(test::peak(render(4800)), 0);
  ASSERT_TRUE(session_.play(Blow{{.name = "bottle"}, {0}}, now()));
  const double before = test::peak(render(4800));
  render(48000);
  EXPECT_LT(test::peak(render(4800)), 1e-3 * before);
}

TEST_F(BreathTest, BankWithoutAirIsRefusedBySentence) {
  for (const auto& answer :
       {session_.play(Slap{{.name = "plain"}, {1}}, 0), session_.play(Blow{{.name = "plain"}, {1}}, 0)}) {
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().message, "\"plain\" has no air that sounds; bake it with [cavity]");
  }
}

}  // namespace
}  // namespace ringdown::session
