// A scene whose body breaks, as sessions play it: its pieces are objects from the beginning, and what is heard neither
// depends on blocks nor differs from one rendering to the next.
#include "engine/modal/bank_file.h"
#include "protocol/schema.h"
#include "server/session/offline.h"
#include "server/session/scene_save.h"
#include "server/session/session.h"
#include "server/session/state.h"
#include "tests/scene/breaking_plate.h"
#include "tests/support/signal.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace ringdown::session {
namespace {

using synth::Frame;
using test::Samples;

constexpr double kPlateRate_hz = 48000;

class BreakingScene : public testing::Test {
 protected:
  BreakingScene() {
    modal::Bank plate = test::breaking_plate();
    plate.decay_per_s = {3};
    EXPECT_TRUE(modal::write_bank(plate, folder_ / "plate.glb"));
    write("breaks = { impulse_ns = 0.01 }");
  }

  void write(const std::string& breaks) {
    std::ofstream(scene_) << R"([scene]
duration_s = 1
[[static]]
name = "floor"
shape = "plane"
[[object]]
name = "plate"
bank = "plate.glb"
gain = 0.5
pan = -0.3
group = "shelf"
material = { size = 1.1 }
[[body]]
name = "plate"
object = "plate"
shape = "convex"
position_m = [0, 0, 0.3]
rotation = { axis = [1, 0, 0], degrees = 30 }
)" << breaks << "\n";
  }

  test::TemporaryFolder folder_;
  std::filesystem::path scene_ = folder_ / "scene.toml";
};

TEST_F(BreakingScene, PiecesAreObjectsOfTheSceneUntilItIsCleared) {
  Session session(kPlateRate_hz);
  std::vector<std::string> warnings;
  session.rack().warn = [&](const std::string& sentence) { warnings.push_back(sentence); };
  ASSERT_TRUE(session.scene().load(scene_, 0));
  for (int k = 0; k < 12; ++k) {
    const auto piece = session.rack().find({.name = "plate." + std::to_string(k)});
    ASSERT_TRUE(piece) << k;
    EXPECT_TRUE(session.scene().pieces().contains((*piece)->number));
    EXPECT_EQ((*piece)->gain, 0.5);
    EXPECT_EQ((*piece)->pan, -0.3);
    EXPECT_EQ((*piece)->group, "shelf");
    EXPECT_EQ((*piece)->material.size, 1.1);
  }
  EXPECT_EQ(state_of(session).objects.size(), 1u) << "the pieces come with the scene";
  EXPECT_EQ(scene_of(session).objects.size(), 1u);
  EXPECT_TRUE(scene_of(session).bodies.at(0).breaks);
  const std::int32_t version = session.scene().describe().version;
  session.scene().advance_to(24000, {});
  ASSERT_EQ(session.scene().poses().bodies.size(), 12u);
  EXPECT_EQ(session.scene().body_count(), 12u);
  EXPECT_GT(session.scene().describe().version, version);
  EXPECT_EQ(session.scene().describe().bodies.at(3).object, "plate.3");
  EXPECT_EQ(scene_of(session).bodies.size(), 1u) << "saved, it is whole again";
  EXPECT_EQ(warnings, std::vector<std::string>{"scene: body 'plate' broke into 12 pieces"});

  const synth::verb::Strike blow{{}, {0, 0, 0.1}, 1e-4};
  const protocol::Strike whole{{.name = "plate"}, blow}, piece{{.name = "plate.3"}, blow};
  const auto refused = session.play(whole, 0);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("broken in the scene"), std::string::npos) << refused.error().message;
  EXPECT_TRUE(session.play(piece, 0));

  ASSERT_TRUE(session.scene().load(scene_, 24000)) << "again from the beginning";
  EXPECT_TRUE(session.play(whole, 0));
  EXPECT_EQ(session.scene().poses().bodies.size(), 1u);
  EXPECT_TRUE(session.rack().find({.name = "plate.11"}));
  ASSERT_TRUE(session.scene().clear());
  EXPECT_FALSE(session.rack().find({.name = "plate.0"}));
  EXPECT_TRUE(session.rack().find({.name = "plate"}));
  ASSERT_TRUE(session.scene().load(scene_, 24000));
  write("");
  ASSERT_TRUE(session.scene().load(scene_, 24000));
  EXPECT_FALSE(session.rack().find({.name = "plate.0"})) << "this scene has no pieces";
}

// What another daemon needs for the scene's events (--scene-to), and what a score loads: a path to each piece.
TEST_F(BreakingScene, APieceWithoutModesIsLoadedByItsPathAndClicks) {
  modal::Bank plate = test::breaking_plate();
  modal::Fracture fracture = *plate.fracture;
  modal::PieceBank& silent = fracture.patterns[0].pieces[5];
  silent.bank.frequency_hz.clear();
  silent.bank.decay_per_s.clear();
  silent.bank.shapes.clear();
  silent.handover.resize(modal::kRigidMotions * (modal::kRigidMotions + 1));
  plate.fracture = std::make_shared<const modal::Fracture>(std::move(fracture));
  ASSERT_TRUE(modal::write_bank(plate, folder_ / "plate.glb"));
  Session scene(kPlateRate_hz), other(kPlateRate_hz);
  ASSERT_TRUE(scene.scene().load(scene_, 0));
  for (const ObjectSnapshot& object : scene.rack().objects()) {
    const auto loaded = other.perform(protocol::LoadObject{object->name, object->bank.string()}, 0);
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_EQ((*other.rack().find({.name = object->name}))->map->bank().mode_count(), object->map->bank().mode_count());
  }
  const ObjectSnapshot piece = *other.rack().find({.name = "plate.5"});
  EXPECT_EQ(piece->map->bank().mode_count(), 0u);
  ASSERT_TRUE(other.rack().push(synth::Producer::worker, {0, piece->number, synth::verb::Click{{0, 0, 0.1}, 1e-4}}));
  std::vector<float> left(4800), right(4800);
  other.rack().mixer().render(left, right);
  EXPECT_GT(*std::ranges::max_element(left), 0);
  const auto none = other.perform(protocol::LoadObject{"more", (folder_ / "plate.glb#0.12").string()}, 0);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("no piece 12"), std::string::npos) << none.error().message;
}

TEST_F(BreakingScene, ANameThatIsTakenIsRefusedAndNothingIsLeft) {
  Session session(kPlateRate_hz);
  ASSERT_TRUE(session.rack().load("plate.7", folder_ / "plate.glb"));
  const auto loaded = session.scene().load(scene_, 0);
  ASSERT_FALSE(loaded);
  EXPECT_NE(loaded.error().message.find("\"plate.7\" exists already"), std::string::npos) << loaded.error().message;
  EXPECT_FALSE(session.rack().find({.name = "plate.0"}));
}

TEST_F(BreakingScene, AFreedPieceStaysSilent) {
  Session session(kPlateRate_hz);
  ASSERT_TRUE(session.scene().load(scene_, 0));
  const synth::ObjectNumber freed = (*session.rack().find({.name = "plate.2"}))->number;
  ASSERT_TRUE(session.perform(protocol::FreeObject{{.name = "plate.2"}}, 0));
  std::size_t of_freed = 0, all = 0;
  session.scene().send_to([&](const scene::StepReport& report) {
    for (const synth::Event& event : report.events) {
      ++all;
      of_freed += event.object == freed;
    }
    return std::size_t{0};
  });
  session.scene().advance_to(48000, {});
  EXPECT_GT(all, 20u);
  EXPECT_EQ(of_freed, 0u);
}

TEST_F(BreakingScene, EventsAndSoundDoNotDependOnTheBlockSize) {
  const auto alike = [](const synth::Event& a, const synth::Event& b) {
    return a.frame == b.frame && a.object == b.object &&
           protocol::format(protocol::request_for(a, {})) == protocol::format(protocol::request_for(b, {}));
  };
  std::vector<synth::Event> reference;
  Samples heard;
  for (const Frame block : {256, 1, 64, 255, 1024, 8192}) {
    std::vector<synth::Event> events;
    Session session(kPlateRate_hz);
    session.scene().send_to([&events](const scene::StepReport& report) {
      events.insert(events.end(), report.events.begin(), report.events.end());
      return std::size_t{0};
    });
    ASSERT_TRUE(session.scene().load(scene_, 0));
    for (Frame at = 0; at < 48000; at += block)
      session.scene().advance_to(std::min<Frame>(at + block, 48000), std::nullopt);
    if (reference.empty()) reference = events;
    EXPECT_GT(events.size(), 50u);
    EXPECT_TRUE(std::ranges::equal(events, reference, alike)) << "blocks of " << block;

    const auto recording =
        render_offline({.scene = scene_, .block_frames = static_cast<std::size_t>(block)}, [](double) { return true; });
    ASSERT_TRUE(recording) << recording.error().message;
    const Samples samples(recording->left.begin(), recording->left.end());
    if (heard.empty()) heard = samples;
    EXPECT_LT(test::relative_error_db(samples, heard), -100) << "blocks of " << block;
  }
  EXPECT_GT(test::peak(heard), 1e-4);
  const auto again = render_offline({.scene = scene_}, [](double) { return true; });
  EXPECT_EQ(Samples(again->left.begin(), again->left.end()), heard) << "bit for bit";
}

// Ten plates of 60 pieces land within 0.1 s, in blocks of 64 frames: each piece is a body, is heard, and no event and
// no contact is left out.
TEST_F(BreakingScene, TenBodiesOfSixtyPiecesBreakWithinATenthOfASecond) {
  constexpr std::size_t kPlates = 10, kPieces = 60, kBlock = 64;
  modal::Bank plate = test::breaking_plate({.size_m = {0.2, 0.12, 0.01}, .mass_kg = 0.6, .along = 10, .across = 6});
  ASSERT_TRUE(modal::write_bank(plate, folder_ / "plate.glb"));
  std::string text = "[scene]\nduration_s = 1\n[[static]]\nname = \"floor\"\nshape = \"plane\"\n";
  for (std::size_t k = 0; k < kPlates; ++k) {
    const std::string name = formatted("plate{}", k);
    const double fall_s = 0.2 + 0.009 * static_cast<double>(k);
    text += formatted("[[object]]\nname = \"{}\"\nbank = \"plate.glb\"\n[[body]]\nname = \"{}\"\nobject = \"{}\"\n",
                      name, name, name) +
            formatted(
                "shape = \"convex\"\nposition_m = [{:f}, 0, {:f}]\nbreaks = {{ impulse_ns = 0.01, min_mass_kg = 0 }}\n",
                0.5 * static_cast<double>(k), 0.5 * 9.81 * fall_s * fall_s);
  }
  std::ofstream(scene_) << text;
  Session session(kPlateRate_hz);
  std::vector<std::string> warnings;
  session.rack().warn = [&](const std::string& sentence) { warnings.push_back(sentence); };
  // Contacts that last are left out: the mixer has room for a limited number of them.
  std::size_t blows = 0;
  session.scene().send_to([&](const scene::StepReport& report) {
    std::size_t lost = report.dropped_events + report.dropped_contacts;
    for (const synth::Event& event : report.events) {
      if (event.verb.holds<synth::verb::Contact>()) continue;
      if (synth::excites(event)) ++blows;
      if (!session.rack().push(synth::Producer::scene, event)) ++lost;
    }
    return lost;
  });
  ASSERT_TRUE(session.scene().load(scene_, 0));
  synth::Mixer& mixer = session.rack().mixer();
  mixer.meters().watch_objects(true);
  std::vector<float> left(kBlock), right(kBlock);
  std::set<std::string> silent;
  for (std::size_t k = 0; k < kPlates; ++k) {
    for (std::size_t i = 0; i < kPieces; ++i) silent.insert(formatted("plate{}.{}", k, i));
  }
  while (mixer.counters().frames < 0.4 * kPlateRate_hz) {
    session.scene().advance_to(mixer.counters().frames + static_cast<Frame>(kBlock), {});
    mixer.render(left, right);
    session.rack().collect();
    std::erase_if(silent, [&](const std::string& name) {
      return mixer.meters().take_peak_level((*session.rack().find({.name = name}))->number) > 1e-7;
    });
  }
  EXPECT_EQ(session.scene().poses().bodies.size(), kPlates * kPieces);
  EXPECT_TRUE(silent.empty()) << silent.size() << " pieces, first " << *silent.begin();
  EXPECT_EQ(warnings.size(), kPlates) << warnings.back();
  EXPECT_GT(blows, kPlates * kPieces);
  EXPECT_EQ(mixer.counters().strikes, blows);
  EXPECT_EQ(mixer.counters().late, 0u);
  EXPECT_EQ(mixer.counters().refused, 0u);
  EXPECT_EQ(session.scene().lost().dropped, 0u);
}

// After the break nothing is left of the plate's only mode; each piece has one of 4 kHz and more.
TEST_F(BreakingScene, TheBodyFallsSilentAndItsPiecesRing) {
  const auto recording = render_offline({.scene = scene_, .seconds = 1}, [](double) { return true; });
  ASSERT_TRUE(recording);
  const auto energy = [&](double hz) {  // of one line, from 20 ms after the break on
    double re = 0, im = 0;
    for (std::size_t n = 13000; n < 20000; ++n) {
      const double turn = 2 * std::numbers::pi * hz * static_cast<double>(n) / kPlateRate_hz;
      re += static_cast<double>(recording->left[n]) * std::cos(turn);
      im += static_cast<double>(recording->left[n]) * std::sin(turn);
    }
    return re * re + im * im;
  };
  const double scale = 1 / 1.1;  // of frequencies, for the size
  double pieces = 0;
  for (int k = 0; k < 12; ++k) pieces += energy(scale * (4000 + 10 * k));
  EXPECT_GT(pieces, 1e4 * energy(scale * 440));
}

// A plate that breaks to the left of a listener is heard from the left from the first sample of its pieces on.
TEST_F(BreakingScene, PiecesAreHeardFromWhereTheyAre) {
  for (const double side : {-1.0, 1.0}) {
    write("breaks = { impulse_ns = 0.01 }\n[listener]\nposition_m = [0, " + std::to_string(side) +
          ", 0.1]\nrotation = { axis = [0, 0, 1], degrees = 0 }");
    const auto recording = render_offline({.scene = scene_, .seconds = 0.6}, [](double) { return true; });
    ASSERT_TRUE(recording) << recording.error().message;
    const auto frames = static_cast<std::size_t>(0.6 * kPlateRate_hz);
    std::size_t first = 0;  // the plate hits the floor
    while (first < frames && std::abs(recording->left[first]) + std::abs(recording->right[first]) < 1e-5F) ++first;
    ASSERT_LT(first + 2400, frames);
    double left = 0, right = 0;
    for (std::size_t n = first + 200; n < first + 2400; ++n) {
      left += std::pow(static_cast<double>(recording->left[n]), 2);
      right += std::pow(static_cast<double>(recording->right[n]), 2);
    }
    EXPECT_GT(side * (right - left), 0) << left << " " << right;
  }
}

}  // namespace
}  // namespace ringdown::session
