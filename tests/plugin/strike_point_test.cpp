// The exact strike point: its text, and what the instrument does with it.
#include "clients/plugin/strike_point.h"

#include "tests/plugin/instrument_fixture.h"
#include "tests/support/signal.h"

#include <gtest/gtest.h>

#include <string>

namespace ringdown::plugin {
namespace {

const StrikePoint kSomewhere{{0.1, -0.02, 1.0 / 3}, {0, 0, -1}, 37.5, "my own/bell.glb"};

TEST(StrikePointText, IsReadAsItWasWritten) {
  const auto read = strike_point_of(to_text(kSomewhere));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->point_m, kSomewhere.point_m);
  EXPECT_EQ(read->direction, kSomewhere.direction);
  EXPECT_EQ(read->percent, kSomewhere.percent);
  EXPECT_EQ(read->source, kSomewhere.source);
}

TEST(StrikePointText, ThatIsNotWholeMeansNoPoint) {
  for (const char* text : {"", " ", "0.1", "0 0 0 0 0 1 50", "0 0 0 0 0 1 50 ", "0 0 0 0 0 0 50 bell",
                           "0 0 nan 0 0 1 50 bell", "0 0 inf 0 0 1 50 bell", "0 0 0 0 0 1e300 1e999 bell",
                           "0,1 0 0 0 0 1 50 bell", "x 0 0 0 0 1 50 bell", "0 0 0 1e200 0 1e200 50 bell"}) {
    EXPECT_FALSE(strike_point_of(text)) << '"' << text << '"';
  }
}

TEST(StrikePointText, HoldsADirectionOfLengthOne) {
  const auto read = strike_point_of("0 0 0 0 3 -4 50 bell");
  ASSERT_TRUE(read);
  EXPECT_NEAR(length(read->direction - Vec3{0, 0.6, -0.8}), 0, 1e-12);
}

// A bar of two modes: the first moves along z everywhere, the second along x only at the far end.
class ExactPoint : public InstrumentTest {
 protected:
  ExactPoint() {
    modal::Bank bank = test::single_mode_bank(1000, 0.5);
    bank.radiation.reset();
    bank.losses.clear();
    bank.positions = {{0, 0, 0}, {0.5F, 0, 0}, {1, 0, 0}};
    bank.triangles = {{0, 1, 2}};
    bank.frequency_hz = {1000, 3000};
    bank.decay_per_s = {bank.decay_per_s[0], bank.decay_per_s[0]};
    bank.shapes = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}};
    two_modes_ = folder_ / "two.glb";
    EXPECT_TRUE(modal::write_bank(bank, two_modes_));
    instrument_.set_file(two_modes_);
    set(Parameter::tuning, 1);
    settle();
    play(kControl, 120, 0);
    hear(2048);
  }
  std::string text(Vec3 point_m, Vec3 direction, double percent = 0) const {
    return to_text({point_m, direction, percent, two_modes_});
  }
  // What a blow on the root key sounds like.
  double pitch_of_blow() {
    play(kControl, 120, 0);
    hear(2048);
    play(kOn, 60, 100);
    return pitch_hz(4800);
  }
  std::filesystem::path two_modes_;
};

TEST_F(ExactPoint, IsStruckInItsDirection) {
  EXPECT_NEAR(pitch_of_blow(), 1000, 1);
  instrument_.set_point(text({1, 0, 0}, {-1, 0, 0}));
  EXPECT_NEAR(pitch_of_blow(), 3000, 3);
  instrument_.set_point("");
  EXPECT_NEAR(pitch_of_blow(), 1000, 1);
}

TEST_F(ExactPoint, GivesWayWhenTheParameterMoves) {
  instrument_.set_point(text({1, 0, 0}, {-1, 0, 0}, 20));
  EXPECT_NEAR(pitch_of_blow(), 1000, 1) << "the parameter is 0";
  set(Parameter::strike_point, 20);
  EXPECT_NEAR(pitch_of_blow(), 3000, 3);
  set(Parameter::strike_point, 21);
  EXPECT_NEAR(pitch_of_blow(), 1000, 1);
}

TEST_F(ExactPoint, IsNotUsedOnAnotherObjectNorFarFromItsOwn) {
  instrument_.set_point(to_text({{1, 0, 0}, {-1, 0, 0}, 0, "another"}));
  EXPECT_NEAR(pitch_of_blow(), 1000, 1);
  instrument_.set_point(text({30, 0, 0}, {-1, 0, 0}));
  EXPECT_NEAR(pitch_of_blow(), 1000, 1) << "libringdown refuses such a blow, so nothing would sound";
}

TEST_F(ExactPoint, TheSecondIsStruckByVelocitiesFromAHundredOn) {
  const auto pitch_of = [&](std::uint8_t velocity) {
    play(kControl, 120, 0);
    hear(2048);
    play(kOn, 60, velocity);
    return pitch_hz(4800);
  };
  instrument_.set_point(text({1, 0, 0}, {-1, 0, 0}), Which::second);
  EXPECT_NEAR(pitch_of(99), 1000, 1);
  EXPECT_NEAR(pitch_of(100), 3000, 3);
  instrument_.set_point(text({1, 0, 0}, {0, 0, 1}));
  EXPECT_NEAR(pitch_of(127), 3000, 3) << "beside a first point";
  instrument_.set_point(text({1, 0, 0}, {-1, 0, 0}));
  instrument_.set_point("", Which::second);
  EXPECT_NEAR(pitch_of(127), 3000, 3) << "the first is for all velocities if it is alone";
}

TEST_F(ExactPoint, IsNotPartOfAPreset) {
  instrument_.set_point(text({1, 0, 0}, {-1, 0, 0}));
  instrument_.set_point(text({1, 0, 0}, {-1, 0, 0}), Which::second);
  instrument_.load_preset(0);
  EXPECT_EQ(instrument_.point(), "");
  EXPECT_EQ(instrument_.point(Which::second), "");
}

TEST_F(ExactPoint, OutlivesARestartAndAnotherObjectBetween) {
  instrument_.set_point(text({1, 0, 0}, {-1, 0, 0}));
  EXPECT_EQ(instrument_.point(), text({1, 0, 0}, {-1, 0, 0}));
  instrument_.set_file(bank_);
  EXPECT_NEAR(pitch_of_blow(), 1000, 1);
  instrument_.set_file(two_modes_);
  EXPECT_NEAR(pitch_of_blow(), 3000, 3);
  instrument_.stop();
  instrument_.start();
  EXPECT_NEAR(pitch_of_blow(), 3000, 3);
}

}  // namespace
}  // namespace ringdown::plugin
