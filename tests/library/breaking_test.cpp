// Bodies that break, through the C library: what the pieces do and how they sound is what a session says.
#include "tests/support/realtime_guard.h"

#include "engine/base/realtime.h"
#include "server/session/session.h"
#include "tests/library/mixer_of_banks.h"
#include "tests/support/signal.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

namespace ringdown::test::breaking_test {
namespace {

const std::string kPane = RINGDOWN_SOURCE_DIR "/presets/banks/window-pane.glb";
constexpr std::array<double, 3> kPoint{0.03, 0.02, 0.0015}, kBlow{0.01, 0, -0.05}, kTap{0, 0, -0.002};
constexpr double kContact_s = 1e-4;
constexpr std::int64_t kFrame = 1000;
constexpr std::size_t kBlock = 64;

bool says(const ringdown_error& error, const std::string& part) {
  return std::string(error.sentence).find(part) != std::string::npos;
}

class LibraryBreaking : public testing::Test {
 protected:
  LibraryBreaking() {
    ringdown_settings settings;
    ringdown_settings_init(&settings, sizeof settings);
    settings.limiter_db = 1;
    EXPECT_EQ(ringdown_bank_open(kPane.c_str(), &bank_, &error_), RINGDOWN_OK) << error_.sentence;
    EXPECT_EQ(ringdown_mixer_create(&settings, &mixer_, &error_), RINGDOWN_OK) << error_.sentence;
    EXPECT_EQ(ringdown_add(mixer_, "pane", bank_, &pane_, &error_), RINGDOWN_OK) << error_.sentence;
  }
  ~LibraryBreaking() override {
    ringdown_mixer_destroy(mixer_);
    ringdown_bank_release(bank_);
  }
  ringdown_result shatter(std::uint32_t* pieces) {
    return ringdown_break(mixer_, kFrame, pane_, kPoint.data(), kBlow.data(), kContact_s, pieces, &error_);
  }
  ringdown_piece_info piece(std::uint32_t number) {
    ringdown_piece_info info{};
    info.size = sizeof info;
    EXPECT_EQ(ringdown_piece(mixer_, pane_, number, &info, &error_), RINGDOWN_OK) << error_.sentence;
    return info;
  }
  Samples render(std::size_t frames) {
    Samples samples;
    std::array<float, kBlock> left, right;
    for (std::size_t done = 0; done < frames; done += kBlock) {
      {
        const RealtimeScope watch;
        ringdown_render(mixer_, left.data(), right.data(), kBlock);
        EXPECT_EQ(watch.seen().total(), 0u) << watch.seen().first;
      }
      samples.insert(samples.end(), left.begin(), left.end());
      ringdown_collect(mixer_);
    }
    return samples;
  }

  ringdown_error error_{};
  ringdown_bank* bank_ = nullptr;
  ringdown_mixer* mixer_ = nullptr;
  std::uint32_t pane_ = 0;
};

TEST_F(LibraryBreaking, PiecesOfABankAddUpToIt) {
  ringdown_pattern_info pattern{};
  pattern.size = sizeof pattern;
  ASSERT_EQ(ringdown_breakable(bank_, 0, &pattern, &error_), RINGDOWN_OK) << error_.sentence;
  EXPECT_GE(pattern.patterns, 1u);
  ASSERT_GT(pattern.pieces, 20u);
  ringdown_bank_info whole{};
  whole.size = sizeof whole;
  ASSERT_EQ(ringdown_bank_describe(bank_, &whole), RINGDOWN_OK);
  double mass_kg = 0;
  for (std::uint32_t i = 0; i < pattern.pieces; ++i) {
    ringdown_piece_info info{};
    info.size = sizeof info;
    ASSERT_EQ(ringdown_breakable_piece(bank_, 0, i, &info, &error_), RINGDOWN_OK) << error_.sentence;
    EXPECT_EQ(info.object, RINGDOWN_NO_OBJECT);
    EXPECT_EQ(info.pieces, pattern.pieces);
    mass_kg += info.mass_kg;
    ASSERT_GE(info.points, 4u);
    for (std::size_t t = 0; t < 3 * info.triangles; ++t) ASSERT_LT(info.triangle_points[t], info.points);
    for (std::size_t c = 0; c < 3 * info.points; ++c) ASSERT_LT(std::abs(info.points_m[c]), 0.2f);
  }
  EXPECT_NEAR(mass_kg / whole.mass_kg, 1, 1e-6);
}

// Half of the impulse is in the pieces; a game's striker has the other half.
TEST_F(LibraryBreaking, PiecesHaveTheMomentumOfHalfTheBlow) {
  std::uint32_t armed = 0, broken = 0;
  ASSERT_EQ(ringdown_arm(mixer_, pane_, -1, &armed, &error_), RINGDOWN_OK) << error_.sentence;
  ASSERT_EQ(shatter(&broken), RINGDOWN_OK) << error_.sentence;
  EXPECT_EQ(armed, broken);
  std::array<double, 3> momentum{}, moment{};
  for (std::uint32_t i = 0; i < broken; ++i) {
    const ringdown_piece_info one = piece(i);
    const Rotation axes = Rotation::from_wxyz(one.axes_wxyz[0], one.axes_wxyz[1], one.axes_wxyz[2], one.axes_wxyz[3]);
    const auto vector = [](const double* v) { return Vec3{v[0], v[1], v[2]}; };
    const Vec3 spin = rotated(inverse(axes), vector(one.spin_rad_s)), inertia = vector(one.inertia_kg_m2);
    const Vec3 own = rotated(axes, Vec3{inertia.x * spin.x, inertia.y * spin.y, inertia.z * spin.z});
    const Vec3 path = one.mass_kg * vector(one.velocity_m_s);
    const Vec3 whole = own + cross(vector(one.center_of_mass_m), path);
    momentum = {momentum[0] + path.x, momentum[1] + path.y, momentum[2] + path.z};
    moment = {moment[0] + whole.x, moment[1] + whole.y, moment[2] + whole.z};
  }
  const Vec3 turned = cross(Vec3{kPoint[0], kPoint[1], kPoint[2]}, 0.5 * Vec3{kBlow[0], kBlow[1], kBlow[2]});
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(momentum[c], 0.5 * kBlow[c], 1e-6 * 0.05);
  EXPECT_NEAR(moment[0], turned.x, 1e-6 * 0.05 * 0.1);
  EXPECT_NEAR(moment[1], turned.y, 1e-6 * 0.05 * 0.1);
  EXPECT_NEAR(moment[2], turned.z, 1e-6 * 0.05 * 0.1);
}

TEST_F(LibraryBreaking, SoundsAsInASession) {
  ASSERT_EQ(ringdown_arm(mixer_, pane_, -1, nullptr, &error_), RINGDOWN_OK) << error_.sentence;
  ASSERT_EQ(ringdown_strike(mixer_, 100, pane_, kPoint.data(), kTap.data(), kContact_s, &error_), RINGDOWN_OK);
  ASSERT_EQ(shatter(nullptr), RINGDOWN_OK) << error_.sentence;
  const Samples heard = render(9600);

  session::Session session(48000);
  const auto vector = [](const std::array<double, 3>& v) { return Vec3{v[0], v[1], v[2]}; };
  ASSERT_TRUE(session.perform(protocol::LoadObject{"pane", kPane}, 0));
  ASSERT_TRUE(session.perform(protocol::ArmObject{{.name = "pane"}}, 0));
  ASSERT_TRUE(session.play(protocol::Strike{{.name = "pane"}, {vector(kPoint), vector(kTap), kContact_s}}, 100));
  ASSERT_TRUE(
      session.perform(protocol::BreakObject{{.name = "pane"}, vector(kPoint), vector(kBlow), kContact_s}, kFrame));
  std::vector<float> left(9600), right(9600);
  session.rack().mixer().render(left, right);
  const Samples expected(left.begin(), left.end());
  EXPECT_LT(relative_error_db(heard, expected), -100);
  EXPECT_LT(relative_error_db(std::span(heard).subspan(kFrame + 480), std::span(expected).subspan(kFrame + 480)), -100)
      << "the pieces alone";
  EXPECT_GT(peak(std::span(heard).subspan(kFrame + 480)), 1e-5);
  const auto report = session.breakage().report({.name = "pane"});
  for (std::uint32_t i = 0; i < report->pieces.size(); ++i) {
    EXPECT_DOUBLE_EQ(piece(i).velocity_m_s[2], report->pieces[i].velocity_m_s.z);
  }
}

TEST_F(LibraryBreaking, PiecesAreObjectsUntilTheBodyIsMended) {
  std::uint32_t pieces = 0;
  EXPECT_EQ(shatter(&pieces), RINGDOWN_REFUSED);
  EXPECT_TRUE(says(error_, "not armed")) << error_.sentence;
  EXPECT_EQ(ringdown_mend(mixer_, pane_, &error_), RINGDOWN_BAD_INPUT);
  ASSERT_EQ(ringdown_arm(mixer_, pane_, 0, &pieces, &error_), RINGDOWN_OK) << error_.sentence;
  ASSERT_EQ(shatter(&pieces), RINGDOWN_OK) << error_.sentence;
  EXPECT_EQ(shatter(&pieces), RINGDOWN_REFUSED) << "twice";
  EXPECT_EQ(ringdown_strike(mixer_, 0, pane_, kPoint.data(), kTap.data(), 0, &error_), RINGDOWN_REFUSED);
  EXPECT_TRUE(says(error_, "broken")) << error_.sentence;
  std::uint32_t rings = RINGDOWN_NO_OBJECT;
  for (std::uint32_t i = 0; i < pieces && rings == RINGDOWN_NO_OBJECT; ++i) rings = piece(i).object;
  ASSERT_NE(rings, RINGDOWN_NO_OBJECT);
  const std::array<double, 4> unturned{1, 0, 0, 0};
  EXPECT_EQ(ringdown_pose(mixer_, 0, rings, kPoint.data(), unturned.data(), &error_), RINGDOWN_OK);
  EXPECT_EQ(ringdown_strike(mixer_, 0, rings, kPoint.data(), kTap.data(), 0, &error_), RINGDOWN_OK) << error_.sentence;
  ASSERT_EQ(ringdown_mend(mixer_, pane_, &error_), RINGDOWN_OK) << error_.sentence;
  EXPECT_EQ(ringdown_strike(mixer_, 0, rings, kPoint.data(), kTap.data(), 0, &error_), RINGDOWN_BAD_INPUT);
  EXPECT_EQ(ringdown_strike(mixer_, 0, pane_, kPoint.data(), kTap.data(), 0, &error_), RINGDOWN_OK) << error_.sentence;
}

TEST_F(LibraryBreaking, RefusesWhatIsWrong) {
  ringdown_pattern_info pattern{};
  ringdown_piece_info info{};
  EXPECT_EQ(ringdown_breakable(bank_, 0, &pattern, &error_), RINGDOWN_BAD_INPUT) << "its size is not set";
  pattern.size = sizeof pattern;
  info.size = sizeof info;
  EXPECT_EQ(ringdown_breakable(nullptr, 0, &pattern, &error_), RINGDOWN_BAD_INPUT);
  EXPECT_EQ(ringdown_breakable(bank_, 999, &pattern, &error_), RINGDOWN_BAD_INPUT);
  EXPECT_TRUE(says(error_, "pattern is 999")) << error_.sentence;
  EXPECT_EQ(ringdown_breakable_piece(bank_, 0, 9999, &info, &error_), RINGDOWN_BAD_INPUT);
  EXPECT_EQ(ringdown_piece(mixer_, pane_, 0, &info, &error_), RINGDOWN_REFUSED);
  EXPECT_EQ(ringdown_arm(mixer_, pane_, 99, nullptr, &error_), RINGDOWN_BAD_INPUT);
  EXPECT_EQ(ringdown_arm(mixer_, 77, 0, nullptr, &error_), RINGDOWN_BAD_INPUT);
  EXPECT_EQ(ringdown_arm(nullptr, 0, 0, nullptr, &error_), RINGDOWN_BAD_INPUT);
  ASSERT_EQ(ringdown_arm(mixer_, pane_, 0, nullptr, &error_), RINGDOWN_OK) << error_.sentence;
  const std::array<double, 3> far{10, 0, 0}, none{std::nan(""), 0, 0};
  EXPECT_EQ(ringdown_break(mixer_, 0, pane_, far.data(), kBlow.data(), 0, nullptr, &error_), RINGDOWN_BAD_INPUT);
  EXPECT_EQ(ringdown_break(mixer_, 0, pane_, kPoint.data(), none.data(), 0, nullptr, &error_), RINGDOWN_BAD_INPUT);
  EXPECT_TRUE(says(error_, "impulse_ns[0]")) << error_.sentence;
  EXPECT_EQ(ringdown_break(mixer_, 0, pane_, kPoint.data(), nullptr, 0, nullptr, &error_), RINGDOWN_BAD_INPUT);
  EXPECT_EQ(ringdown_break(mixer_, 48000LL * 3700, pane_, kPoint.data(), kBlow.data(), 0, nullptr, &error_),
            RINGDOWN_BAD_INPUT);
  double stress_pa = 0;
  EXPECT_EQ(ringdown_stress(mixer_, 0, pane_, kPoint.data(), kTap.data(), kContact_s, &stress_pa, &error_),
            RINGDOWN_OK);
  EXPECT_GE(stress_pa, 0);
  EXPECT_EQ(shatter(nullptr), RINGDOWN_OK) << error_.sentence;

  MixerOfBanks plain(1);
  EXPECT_EQ(ringdown_arm(plain.get(), 0, 0, nullptr, &error_), RINGDOWN_BAD_INPUT);
  EXPECT_TRUE(says(error_, "[shatter]")) << error_.sentence;
}

// A mode that a blow of no duration sets going, and the same motion imparted.
TEST(LibraryEvents, AnImpartedMotionSoundsAsTheBlowThatMakesIt) {
  constexpr float kShape = 0.7f;
  const TemporaryFolder folder;
  ASSERT_TRUE(modal::write_bank(single_mode_bank(700, 5, {0, 0, kShape}), folder / "one.glb"));
  std::array<std::vector<float>, 2> heard;
  for (const bool imparted : {false, true}) {
    ringdown_error error;
    ringdown_bank* bank = nullptr;
    ringdown_mixer* mixer = nullptr;
    std::uint32_t object = 0;
    ASSERT_EQ(ringdown_bank_open((folder / "one.glb").c_str(), &bank, &error), RINGDOWN_OK);
    ASSERT_EQ(ringdown_mixer_create(nullptr, &mixer, &error), RINGDOWN_OK);
    ASSERT_EQ(ringdown_add(mixer, "one", bank, &object, &error), RINGDOWN_OK);
    const std::array<double, 3> origin{}, blow{0, 0, 0.01};
    ASSERT_EQ(imparted ? ringdown_impart(mixer, 10, object, 0, static_cast<double>(kShape) * 0.01, 0, &error)
                       : ringdown_strike(mixer, 10, object, origin.data(), blow.data(), 0, &error),
              RINGDOWN_OK)
        << error.sentence;
    heard[imparted].resize(4800);
    std::vector<float> right(4800);
    ringdown_render(mixer, heard[imparted].data(), right.data(), 4800);
    ringdown_mixer_destroy(mixer);
    ringdown_bank_release(bank);
  }
  const Samples struck(heard[0].begin(), heard[0].end()), imparted(heard[1].begin(), heard[1].end());
  EXPECT_GT(peak(struck), 1e-4);
  EXPECT_LT(relative_error_db(imparted, struck), -100);
}

}  // namespace
}  // namespace ringdown::test::breaking_test
