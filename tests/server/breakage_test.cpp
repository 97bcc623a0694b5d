// Objects that break: a body whose first piece has all of its modes, and takes all of its motion, must sound on.
#include "engine/modal/bank_file.h"
#include "server/session/session.h"
#include "tests/support/breaking_bar.h"
#include "tests/support/signal.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace ringdown::session {
namespace {

using protocol::BreakObject;
using ringdown::test::Samples;
using ringdown::test::TemporaryFolder;

constexpr double kSampleRate = 48000;
constexpr synth::Frame kBreak = 4003;
const Vec3 kPoint{0.02, 0, 0};

class Breaking : public testing::Test {
 protected:
  explicit Breaking() : session(kSampleRate) { load(session, 6); }

  void load(Session& into, std::size_t shared) {
    const auto path = folder / ("bar" + std::to_string(shared) + ".glb");
    ASSERT_TRUE(modal::write_bank(test::breaking_bar(shared), path));
    const auto loaded = into.perform(protocol::LoadObject{"bar", path.string()}, 0);
    ASSERT_TRUE(loaded) << loaded.error().message;
  }
  static Samples render(Session& played, std::size_t frames) {
    std::vector<float> left(frames), right(frames);
    constexpr std::size_t kBlock = 500;
    for (std::size_t at = 0; at < frames; at += kBlock) {
      const std::size_t now = std::min(kBlock, frames - at);
      played.rack().mixer().render(std::span(left).subspan(at, now), std::span(right).subspan(at, now));
      played.rack().collect();
    }
    return {left.begin(), left.end()};
  }
  static void strike(Session& struck, synth::Frame frame, Vec3 impulse_ns, double contact_time_s) {
    const auto played = struck.play(protocol::Strike{{.name = "bar"}, {kPoint, impulse_ns, contact_time_s}}, frame);
    ASSERT_TRUE(played) << played.error().message;
  }

  TemporaryFolder folder;
  Session session;
};

// With and without a blow that breaks it, against the same bar that is only struck.
TEST_F(Breaking, APieceWithAllOfTheMotionSoundsOnAsTheBodyWould) {
  for (const Vec3 impulse_ns : {Vec3{0, 0, 0}, Vec3{0, 0, 0.02}, Vec3{0, 0, -1}}) {
    constexpr double kContact_s = 0.4e-3;
    Session broken(kSampleRate), whole(kSampleRate);
    load(broken, 6);
    load(whole, 6);
    for (Session* one : {&broken, &whole}) strike(*one, 100, {0, 0, 0.05}, 0.2e-3);
    // Armed before the first strike is played, so that the state follows it.
    ASSERT_EQ(broken.perform(protocol::ArmObject{{.name = "bar"}}, 0).value(), 2);
    strike(whole, kBreak, impulse_ns, kContact_s);
    const auto done = broken.perform(BreakObject{{.name = "bar"}, kPoint, impulse_ns, kContact_s}, kBreak);
    ASSERT_TRUE(done) << done.error().message;
    const Samples heard = render(broken, 12000), expected = render(whole, 12000);
    constexpr std::size_t kOver = kBreak + 50;
    EXPECT_LT(test::relative_error_db(std::span(heard).subspan(kOver), std::span(expected).subspan(kOver)), -100)
        << impulse_ns.z;
    EXPECT_GT(test::peak(std::span(expected).subspan(kOver)), 0);
  }
}

// Modes that no piece has end within a millisecond.
TEST_F(Breaking, WhatNoPieceTakesFallsSilent) {
  Session one(kSampleRate);
  load(one, 1);
  ASSERT_TRUE(one.perform(protocol::ArmObject{{.name = "bar"}}, 0));
  strike(one, 100, {0, 0, 0.05}, 0);
  ASSERT_TRUE(one.perform(BreakObject{{.name = "bar"}, kPoint, {}, 0}, kBreak));
  const Samples heard = render(one, 24000);
  const double first_hz = test::bar_bank(6).frequency_hz[0];
  const auto left = test::fit_damped_sinusoid(std::span(heard).subspan(kBreak + 60, 8000), kSampleRate);
  EXPECT_NEAR(left.frequency_hz, first_hz, 0.01);
}

// Producers' events come in any order of their frames. The bar's highest mode dies within microseconds.
TEST_F(Breaking, BlowsThatOvertakeEachOtherCountAsTheyAreHeard) {
  const auto path = folder / "damped.glb";
  modal::Bank damped = test::breaking_bar(6);
  damped.losses.clear();
  damped.decay_per_s.back() = 9000;
  modal::Fracture fracture = *damped.fracture;
  fracture.patterns[0].pieces[0].bank.losses.clear();
  fracture.patterns[0].pieces[0].bank.decay_per_s.back() = 9000;
  damped.fracture = std::make_shared<const modal::Fracture>(fracture);
  ASSERT_TRUE(modal::write_bank(damped, path));
  Session broken(kSampleRate), whole(kSampleRate);
  for (Session* one : {&broken, &whole}) {
    ASSERT_TRUE(one->perform(protocol::LoadObject{"bar", path.string()}, 0));
    if (one == &broken) {
      ASSERT_TRUE(one->perform(protocol::ArmObject{{.name = "bar"}}, 0));
    }
    strike(*one, kBreak - 3, {0, 0, 0.05}, 0.2e-3);
    for (const synth::Frame frame : {100, 3000, 50}) strike(*one, frame, {0, 0, 0.02}, 0.2e-3);
  }
  ASSERT_TRUE(broken.perform(BreakObject{{.name = "bar"}, kPoint, {}, 0}, kBreak));
  const Samples heard = render(broken, 12000), expected = render(whole, 12000);
  constexpr std::size_t kOver = kBreak + 50;
  EXPECT_LT(test::relative_error_db(std::span(heard).subspan(kOver), std::span(expected).subspan(kOver)), -100);
  EXPECT_EQ(broken.rack().mixer().counters().refused, 0u);
}

TEST_F(Breaking, ABodyBreaksOnceAndIsMended) {
  const auto refused = [](const auto& outcome, const char* word) {
    ASSERT_FALSE(outcome);
    EXPECT_NE(outcome.error().message.find(word), std::string::npos) << outcome.error().message;
  };
  const BreakObject blow{{.name = "bar"}, kPoint, {0, 0, 0.02}, 0.2e-3};
  refused(session.perform(protocol::MendObject{{.name = "bar"}}, 0), "whole");
  ASSERT_EQ(session.perform(blow, 0).value(), 2);
  EXPECT_TRUE(session.rack().find({.name = "bar.0"}));
  EXPECT_FALSE(session.rack().find({.name = "bar.1"})) << "it has no mode";
  refused(session.perform(blow, 0), "broken");
  refused(session.play(protocol::Strike{{.name = "bar"}, {kPoint, {0, 0, 1}, 0}}, 0), "bar.0");
  ASSERT_TRUE(session.play(protocol::Strike{{.name = "bar.0"}, {kPoint, {0, 0, 1}, 0}}, 0));
  const auto report = session.breakage().report({.name = "bar"});
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->broken);
  ASSERT_EQ(report->pieces.size(), 2u);
  Vec3 momentum;
  for (const auto& piece : report->pieces) momentum = momentum + piece.mass.mass_kg * piece.velocity_m_s;
  EXPECT_NEAR(momentum.z, 0.01, 1e-9) << "half of the blow; a scene's striker gives the rest";
  ASSERT_TRUE(session.perform(protocol::MendObject{{.name = "bar"}}, 0));
  EXPECT_FALSE(session.rack().find({.name = "bar.0"}));
  EXPECT_TRUE(session.play(protocol::Strike{{.name = "bar"}, {kPoint, {0, 0, 1}, 0}}, 0));
}

// A piece that has pieces is an object that breaks, and goes with the body's pieces when the body is mended.
TEST_F(Breaking, APieceBreaksAgain) {
  const auto map =
      std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(test::bar_in_two_and_four()));
  Session one(kSampleRate);
  ASSERT_TRUE(one.rack().add("b", "b.glb", {.map = map}));
  const auto blow_on = [](const std::string& name, int pattern) {
    return BreakObject{{.name = name}, kPoint, {0, 0, 0.02}, 2e-4, pattern};
  };
  ASSERT_EQ(one.perform(blow_on("b", 0), 0).value(), 2);
  ASSERT_EQ(one.perform(blow_on("b.1", -1), 1000).value(), 2);
  EXPECT_TRUE(one.rack().find({.name = "b.1.0"}));
  EXPECT_FALSE(one.perform(blow_on("b.1.0", -1), 2000)) << "it consists of no pieces";
  const auto again = one.perform(blow_on("b.1", -1), 2000);
  ASSERT_FALSE(again);
  EXPECT_NE(again.error().message.find("broken"), std::string::npos);
  const auto report = one.breakage().report({.name = "b.1"});
  ASSERT_TRUE(report);
  Vec3 momentum;
  for (const auto& piece : report->pieces) momentum = momentum + piece.mass.mass_kg * piece.velocity_m_s;
  EXPECT_NEAR(momentum.z, 0.01, 1e-9) << "half of the blow on the piece";
  EXPECT_GT(test::peak(render(one, 4000)), 0);
  ASSERT_TRUE(one.perform(protocol::MendObject{{.name = "b"}}, 4000));
  for (const char* name : {"b.0", "b.1", "b.1.0", "b.1.1"}) EXPECT_FALSE(one.rack().find({.name = name})) << name;
  ASSERT_EQ(one.perform(blow_on("b", 1), 5000).value(), 4) << "whole again, and into the fine pieces at once";
}

// The harder blow pays for the finer pattern.
TEST_F(Breaking, AWeakBlowMakesFewPieces) {
  modal::Bank bar = test::quiet_bar_bank(6);
  bar.fracture = std::make_shared<const modal::Fracture>(
      modal::Fracture{.patterns = {test::even_pieces(2, 3), test::even_pieces(12, 3)}, .crack_energy_j_m2 = 8});
  const auto map = std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(bar));
  for (const auto& [impulse_ns, pieces] : std::map<double, std::size_t>{{1e-4, 2}, {1, 12}}) {
    Session one(kSampleRate);
    ASSERT_TRUE(one.rack().add("b", "b.glb", {.map = map}));
    const BreakObject blow{{.name = "b"}, kPoint, {0, 0, impulse_ns}, 1e-4};
    EXPECT_EQ(one.perform(blow, 0).value(), pieces) << impulse_ns;
  }
}

// The bar's lowest mode alone has stress, so the blow that reaches a strength is known.
TEST_F(Breaking, AnArmedObjectBreaksByTheBlowThatExceedsItsStrength) {
  modal::Bank bar = test::breaking_bar(6);
  modal::Fracture fracture = *bar.fracture;
  const std::size_t modes = bar.mode_count();
  constexpr float kStress = 3e9f;
  fracture.stress = {.positions = {{1, 1, 1}}, .stress = std::vector<float>(3 * modes), .largest = {}};
  fracture.stress.stress[0] = kStress;
  fracture.stress.largest.assign(modes, 0);
  fracture.stress.largest[0] = kStress;
  bar.fracture = std::make_shared<const modal::Fracture>(fracture);
  const auto map = std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(bar));
  std::vector<double> velocities(modes);
  map->excite(kPoint, {0, 0, 1}, velocities);
  const double pa_per_ns = std::abs(velocities[0]) / modal::hz_to_rad_per_s(bar.frequency_hz[0]) * kStress;

  Session one(kSampleRate);
  ASSERT_TRUE(one.rack().add("bar", "bar.glb", {.map = map}));
  ASSERT_TRUE(one.perform(protocol::SetStrength{{.name = "bar"}, 4e7}, 0));
  strike(one, 100, {0, 0, 0.9 * 4e7 / pa_per_ns}, 0);
  EXPECT_FALSE(one.breakage().report({.name = "bar"})->broken);
  render(one, 96000);  // it has died away
  strike(one, 100000, {0, 0, 1.1 * 4e7 / pa_per_ns}, 0);
  const auto report = one.breakage().report({.name = "bar"});
  EXPECT_TRUE(report->broken);
  EXPECT_EQ(report->pieces.size(), 2u);
  const auto refused = one.play(protocol::Strike{{.name = "bar"}, {kPoint, {0, 0, 1}, 0}}, 0);
  EXPECT_FALSE(refused);
  ASSERT_TRUE(one.perform(protocol::MendObject{{.name = "bar"}}, 0));
  strike(one, 200000, {0, 0, 10 * 4e7 / pa_per_ns}, 0);
  EXPECT_FALSE(one.breakage().report({.name = "bar"})->broken) << "it is no longer armed";
  const auto unknown = session.perform(protocol::SetStrength{{.name = "bar"}, 4e7}, 0);
  ASSERT_FALSE(unknown) << "its bank has no stress";
  EXPECT_NE(unknown.error().message.find("bake it"), std::string::npos);
}

// Every piece is there and sounds, and nothing is late or dropped, whether the bodies break one after the other or at
// once.
TEST_F(Breaking, TenBodiesOfSixtyPiecesBreakWithinATenthOfASecond) {
  constexpr std::size_t kBodies = 10, kPieces = 60, kModes = 6, kBlock = 64;
  modal::Bank bar = test::quiet_bar_bank(6);
  bar.fracture =
      std::make_shared<const modal::Fracture>(modal::Fracture{.patterns = {test::even_pieces(kPieces, kModes)}});
  const auto map = std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(bar));
  for (const synth::Frame apart : {480, 0}) {
    Session one(kSampleRate);
    synth::Mixer& mixer = one.rack().mixer();
    mixer.meters().watch_objects(true);
    std::vector<float> left(kBlock), right(kBlock);
    const auto render_to = [&](synth::Frame end) {
      while (mixer.counters().frames < end) {
        mixer.render(left, right);
        one.rack().collect();
      }
    };
    std::vector<std::string> names;
    for (std::size_t b = 0; b < kBodies; ++b) {
      names.push_back("bar" + std::to_string(b));
      ASSERT_TRUE(one.rack().add(names.back(), "bar.glb", {.map = map}));
      ASSERT_TRUE(one.perform(protocol::ArmObject{{.name = names.back()}}, 0));
    }
    render_to(4 * kBlock);
    synth::Frame next = mixer.counters().frames;
    for (const std::string& name : names) {
      const BreakObject blow{{.name = name}, kPoint, {0, 0, 0.05}, 1e-4};
      ASSERT_EQ(one.perform(blow, next + kBlock).value(), kPieces);
      next += apart;
      render_to(next);
    }
    render_to(next + 40 * kBlock);  // levels are measured in turn
    EXPECT_EQ(mixer.counters().ringing_voices, kBodies * kPieces) << apart;
    for (const std::string& name : names) {
      for (const PieceReport& piece : one.breakage().report({.name = name})->pieces) {
        ASSERT_TRUE(piece.number) << piece.name;
        EXPECT_GT(mixer.meters().take_peak_level(*piece.number), 1e-6) << piece.name;
      }
    }
    EXPECT_EQ(mixer.counters().late, 0u);
    EXPECT_EQ(mixer.counters().refused, 0u);
    EXPECT_EQ(one.dropped(), 0u);
  }
}

TEST_F(Breaking, RefusalsNameWhatIsMissing) {
  ASSERT_TRUE(modal::write_bank(test::bar_bank(2), folder / "plain.glb"));
  ASSERT_TRUE(session.perform(protocol::LoadObject{"plain", (folder / "plain.glb").string()}, 0));
  const auto plain = session.perform(protocol::ArmObject{{.name = "plain"}}, 0);
  ASSERT_FALSE(plain);
  EXPECT_NE(plain.error().message.find("[shatter]"), std::string::npos);
  const auto pattern = session.perform(protocol::ArmObject{{.name = "bar"}, 7}, 0);
  ASSERT_FALSE(pattern);
  EXPECT_NE(pattern.error().message.find("pattern 7"), std::string::npos);
  ASSERT_TRUE(session.perform(protocol::LoadObject{"bar.0", (folder / "plain.glb").string()}, 0));
  const auto taken = session.perform(protocol::ArmObject{{.name = "bar"}}, 0);
  ASSERT_FALSE(taken);
  EXPECT_NE(taken.error().message.find("exists already"), std::string::npos);
}

// A new material or bank makes pieces ready anew; a freed body takes its pieces along.
TEST_F(Breaking, PiecesFollowTheirBody) {
  ASSERT_TRUE(session.perform(protocol::ArmObject{{.name = "bar"}}, 0));
  ASSERT_TRUE(session.perform(protocol::SetMaterial{{.name = "bar"}, {.stiffness = 4}}, 0));
  EXPECT_FALSE(session.rack().find({.name = "bar.0"}));
  ASSERT_TRUE(session.perform(BreakObject{{.name = "bar"}, kPoint, {0, 0, 0.02}, 0}, 0));
  ASSERT_TRUE(session.rack().find({.name = "bar.0"}));
  EXPECT_EQ((*session.rack().find({.name = "bar.0"}))->material.stiffness, 4);
  ASSERT_TRUE(session.perform(protocol::FreeObject{{.name = "bar"}}, 0));
  EXPECT_FALSE(session.rack().find({.name = "bar.0"}));
}

}  // namespace
}  // namespace ringdown::session
