// The requests that actions send, and those that undo sends. The tests feed the model with a daemon's replies.
#include "clients/viewer/commands.h"

#include "clients/viewer/mode_list.h"
#include "engine/modal/bank_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace ringdown::viewer {
namespace {

using protocol::ObjectReply;
using protocol::Request;

struct Desk {
  Model model{60};
  std::vector<Request> sent;
  Commands commands{model, [this](Request request) { sent.push_back(std::move(request)); }};
  double now_s = 10;

  explicit Desk(const std::vector<std::string>& names = {"bell"}, std::int32_t modes = 100) {
    std::int32_t number = 0;
    for (const std::string& name : names) {
      model.apply(protocol::NotifyObject{number, name, true}, now_s);
      ObjectReply reply;
      reply.number = number++;
      reply.name = name;
      reply.modes = reply.selected_modes = modes;
      model.apply(reply, now_s);
    }
    commands.update(now_s);
  }
  template <class Kind>
  [[nodiscard]] std::vector<Kind> of() const {
    std::vector<Kind> found;
    for (const Request& request : sent) {
      if (const auto* kind = request.get_if<Kind>()) found.push_back(*kind);
    }
    return found;
  }
  void wait(double seconds) { commands.update(now_s += seconds); }
};

TEST(Commands, KeysStepThroughAllObjectsFromTheFirst) {
  Desk desk({"bell", "plate", "glass"});
  EXPECT_EQ(desk.commands.choice().object, "bell");
  desk.commands.perform(Action::next_object);
  EXPECT_EQ(desk.commands.choice().object, "glass");
  desk.commands.perform(Action::next_object);
  desk.commands.perform(Action::next_object);
  EXPECT_EQ(desk.commands.choice().object, "bell");
  desk.commands.perform(Action::previous_object);
  EXPECT_EQ(desk.commands.choice().object, "plate");
}

TEST(Commands, MuteAndSoloAreSentAndAskedAboutAndNotUndone) {
  Desk desk;
  desk.commands.set_mute(*desk.model.object("bell"), true);
  desk.commands.set_solo(*desk.model.object("bell"), false);
  ASSERT_EQ(desk.of<protocol::SetMute>().size(), 1u);
  EXPECT_TRUE(desk.of<protocol::SetMute>()[0].on);
  ASSERT_EQ(desk.of<protocol::SetSolo>().size(), 1u);
  EXPECT_FALSE(desk.of<protocol::SetSolo>()[0].on);
  EXPECT_EQ(desk.of<protocol::DescribeObject>().size(), 2u);
  EXPECT_EQ(desk.commands.edits().history().undoes(), "");
}

TEST(Commands, WithoutAChoiceTheObjectWithTheMostModesIsChosen) {
  Desk desk({"bell", "plate"});
  ObjectReply richer;
  richer.number = 1;
  richer.name = "plate";
  richer.modes = richer.selected_modes = 101;
  desk.model.apply(richer, desk.now_s);
  desk.wait(0.1);
  EXPECT_EQ(desk.commands.choice().object, "plate");
  desk.commands.choose_object("bell");
  desk.wait(0.1);
  EXPECT_EQ(desk.commands.choice().object, "bell") << "the user's choice stays";
}

TEST(Commands, EveryMaterialKeyScalesItsFactorAndAPairCancels) {
  using modal::MaterialScale;
  const std::vector<std::tuple<Action, Action, double MaterialScale::*>> pairs = {
      {Action::alpha_up, Action::alpha_down, &MaterialScale::alpha},
      {Action::beta_up, Action::beta_down, &MaterialScale::beta},
      {Action::density_up, Action::density_down, &MaterialScale::density},
      {Action::stiffness_up, Action::stiffness_down, &MaterialScale::stiffness}};
  for (const auto& [up, down, factor] : pairs) {
    Desk desk;
    desk.commands.perform(up);
    ASSERT_EQ(desk.of<protocol::SetMaterial>().size(), 1u);
    EXPECT_GT(desk.of<protocol::SetMaterial>()[0].scale.*factor, 1);
    desk.commands.perform(down);
    EXPECT_NEAR(desk.of<protocol::SetMaterial>()[1].scale.*factor, 1, 1e-12);
  }
}

TEST(Commands, StiffnessGoesBySemitones) {
  Desk desk;
  for (int i = 0; i < 12; ++i) desk.commands.perform(Action::stiffness_up);
  const auto scale = desk.of<protocol::SetMaterial>().back().scale;
  EXPECT_NEAR(std::sqrt(modal::lambda_factor(scale)), 2, 1e-9) << "twelve semitones are an octave";
}

TEST(Commands, StepsStartFromTheLastRequestUntilTheDaemonReports) {
  Desk desk;
  desk.commands.perform(Action::alpha_up);
  desk.commands.perform(Action::alpha_up);
  EXPECT_NEAR(desk.of<protocol::SetMaterial>()[1].scale.alpha, 2, 1e-12);
  EXPECT_EQ(desk.of<protocol::DescribeObject>().size(), 2u) << "the daemon's word is asked for";
  desk.wait(5);
  desk.commands.perform(Action::alpha_up);
  EXPECT_NEAR(desk.of<protocol::SetMaterial>()[2].scale.alpha, std::sqrt(2), 1e-12) << "it had refused both";
}

TEST(Commands, UndoAndRedoSendTheSettingsBeforeAndAfter) {
  Desk desk;
  desk.commands.perform(Action::stiffness_up);
  desk.wait(0.8);
  desk.commands.perform(Action::density_up);
  desk.sent.clear();
  desk.commands.perform(Action::undo);
  desk.commands.perform(Action::undo);
  auto material = desk.of<protocol::SetMaterial>();
  ASSERT_EQ(material.size(), 2u);
  EXPECT_GT(material[0].scale.stiffness, 1);
  EXPECT_EQ(material[1].scale, modal::MaterialScale{});
  desk.commands.perform(Action::undo);
  EXPECT_EQ(desk.of<protocol::SetMaterial>().size(), 2u) << "there is nothing left";
  desk.commands.perform(Action::redo);
  EXPECT_GT(desk.of<protocol::SetMaterial>().back().scale.stiffness, 1);
}

TEST(Commands, AfterAChangeOfDaemonNothingCanBeUndoneAndNoToneSounds) {
  Desk desk;
  desk.commands.perform(Action::stiffness_up);
  desk.commands.perform(Action::test_tone);
  desk.commands.restart();
  desk.sent.clear();
  desk.commands.perform(Action::undo);
  EXPECT_TRUE(desk.sent.empty());
  desk.commands.perform(Action::test_tone);
  ASSERT_EQ(desk.of<protocol::TestTone>().size(), 1u);
  EXPECT_GT(desk.of<protocol::TestTone>()[0].amplitude, 0) << "the first press switches it on";
}

TEST(Commands, DraggingASliderIsOneChange) {
  Desk desk;
  const KnownObject& bell = *desk.model.object("bell");
  for (int i = 1; i <= 20; ++i) {
    desk.commands.edits().change(bell, protocol::SetGain{{"bell", std::nullopt}, {0.05 * i}}, "gain");
    desk.wait(0.016);
  }
  desk.sent.clear();
  desk.commands.perform(Action::undo);
  ASSERT_EQ(desk.of<protocol::SetGain>().size(), 1u);
  EXPECT_EQ(desk.of<protocol::SetGain>()[0].verb.gain, 1);
}

TEST(Commands, ALevelIsUndoneToTheOneTheDaemonTold) {
  Desk desk;
  ObjectReply reply{.name = "bell", .modes = 100, .selected_modes = 100, .level_m = 0.03};
  desk.model.apply(reply, desk.now_s);
  const KnownObject& bell = *desk.model.object("bell");
  EXPECT_EQ(desk.commands.edits().adjustment_of(bell).level_m, 0.03);
  desk.commands.edits().change(bell, protocol::SetFill{{"bell", std::nullopt}, 0.07}, "liquid");
  EXPECT_EQ(desk.commands.edits().adjustment_of(bell).level_m, 0.07);
  desk.commands.perform(Action::undo);
  ASSERT_EQ(desk.of<protocol::SetFill>().size(), 2u);
  EXPECT_EQ(desk.of<protocol::SetFill>()[1].level_m, 0.03);
}

TEST(Commands, AllModesAndTheTwentyHighestArePlayed) {
  Desk desk;
  desk.commands.perform(Action::highest_modes);
  ASSERT_EQ(desk.of<protocol::SelectModes>().size(), 1u);
  EXPECT_EQ(desk.of<protocol::SelectModes>()[0].range, (modal::ModeRange{80, 20}));
  ASSERT_EQ(desk.of<protocol::RingModes>().size(), 1u);
  EXPECT_EQ(desk.of<protocol::RingModes>()[0].verb.first, 80u);
  desk.commands.perform(Action::all_modes);
  EXPECT_EQ(desk.of<protocol::SelectModes>()[1].range, modal::ModeRange{});
  EXPECT_EQ(desk.of<protocol::RingModes>()[1].verb.first, 0u);
}

TEST(Commands, WithFewerThanTwentyModesTheHighestAreAll) {
  Desk desk({"bar"}, 7);
  desk.commands.perform(Action::highest_modes);
  EXPECT_EQ(desk.of<protocol::SelectModes>()[0].range, (modal::ModeRange{0, 20}));
}

TEST(Commands, TheNumberOfModesGoesDownToOneAndBackToAll) {
  Desk desk;
  for (int i = 0; i < 100; ++i) desk.commands.perform(Action::fewer_modes);
  EXPECT_EQ(desk.of<protocol::SelectModes>().back().range, (modal::ModeRange{0, 1}));
  for (int i = 0; i < 100; ++i) desk.commands.perform(Action::more_modes);
  EXPECT_EQ(desk.of<protocol::SelectModes>().back().range, modal::ModeRange{});
}

TEST(Commands, AModeIsSelectedAloneAndTheSecondTimeAllAre) {
  Desk desk;
  desk.commands.hear_alone(*desk.model.object("bell"), 12);
  EXPECT_EQ(desk.of<protocol::SelectModes>().back().range, (modal::ModeRange{12, 1}));
  ASSERT_EQ(desk.of<protocol::RingModes>().size(), 1u);
  EXPECT_EQ(desk.of<protocol::RingModes>()[0].verb.first, 12u);
  desk.commands.hear_alone(*desk.model.object("bell"), 12);
  EXPECT_EQ(desk.of<protocol::SelectModes>().back().range, modal::ModeRange{});
  EXPECT_EQ(desk.of<protocol::RingModes>().size(), 1u);
}

TEST(Commands, TheTestToneIsToggled) {
  Desk desk;
  desk.commands.perform(Action::test_tone);
  desk.commands.perform(Action::test_tone);
  const auto tones = desk.of<protocol::TestTone>();
  ASSERT_EQ(tones.size(), 2u);
  EXPECT_EQ(tones[0].frequency_hz, 440);
  EXPECT_GT(tones[0].amplitude, 0);
  EXPECT_EQ(tones[1].amplitude, 0);
}

TEST(Commands, WithoutAnObjectNewBodiesAreSilentAndHaveASize) {
  Desk desk(std::vector<std::string>{});
  desk.commands.perform(Action::new_box);
  desk.commands.perform(Action::new_sphere);
  ASSERT_EQ(desk.of<protocol::SpawnBox>().size(), 1u);
  EXPECT_FALSE(desk.of<protocol::SpawnBox>()[0].object);
  EXPECT_GT(desk.of<protocol::SpawnBox>()[0].size_m.x, 0);
  EXPECT_GT(desk.of<protocol::SpawnBox>()[0].density_kg_m3, 0);
  EXPECT_GT(desk.of<protocol::SpawnSphere>()[0].radius_m, 0);
}

TEST(Commands, NewAndRemovedBodiesAreUndoneAndRedone) {
  Desk desk;
  desk.commands.perform(Action::new_box);
  desk.model.apply(protocol::Done{"/scene/spawn/box", 7}, desk.now_s);
  desk.wait(1);
  desk.commands.edits().remove_body(3);
  desk.wait(1);
  const auto removed = [&] {
    std::vector<int> bodies;
    for (const auto& request : desk.of<protocol::SceneRemove>()) bodies.push_back(request.body);
    return bodies;
  };
  const auto restored = [&] {
    std::vector<int> bodies;
    for (const auto& request : desk.of<protocol::SceneRestore>()) bodies.push_back(request.body);
    return bodies;
  };
  EXPECT_EQ(removed(), std::vector<int>{3});
  desk.commands.perform(Action::undo);
  EXPECT_EQ(restored(), std::vector<int>{3});
  desk.commands.perform(Action::undo);
  EXPECT_EQ(removed(), (std::vector<int>{3, 7})) << "the new box goes";
  desk.commands.perform(Action::redo);
  EXPECT_EQ(restored(), (std::vector<int>{3, 7})) << "and comes back, no second one";
  desk.commands.perform(Action::redo);
  EXPECT_EQ(removed(), (std::vector<int>{3, 7, 3}));
}

// The scene of one body, "ball", in the words of the daemon.
void describe_ball(Desk& desk, Vec3 at_m) {
  desk.model.apply(protocol::NotifyScene{1, 5, true}, desk.now_s);
  protocol::NotifyBody pose{3, "ball", "-", at_m};
  desk.model.apply(pose, desk.now_s);
  protocol::SceneReply scene;
  scene.version = scene.bodies = 1;
  desk.model.apply(scene, desk.now_s);
  protocol::SceneBody body;
  body.version = 1;
  body.id = 3;
  body.name = "ball";
  body.object = "-";
  body.shape = "sphere";
  desk.model.apply(body, desk.now_s);
}

TEST(Commands, APlacedBodyGoesBackByOneUndoForEachGesture) {
  Desk desk;
  Edits& edits = desk.commands.edits();
  EXPECT_FALSE(edits.pose_of(3));
  edits.place_body(3, {});
  EXPECT_TRUE(desk.of<protocol::ScenePlace>().empty()) << "there is no body 3";
  describe_ball(desk, {1, 2, 3});
  ASSERT_TRUE(edits.pose_of(3));
  EXPECT_EQ(edits.pose_of(3)->position_m, (Vec3{1, 2, 3}));
  for (const double x : {1.1, 1.2, 1.3}) {
    edits.place_body(3, {{x, 2, 3}, {}});
    EXPECT_EQ(edits.pose_of(3)->position_m.x, x) << "before the daemon has confirmed";
    desk.wait(0.05);
  }
  desk.wait(1);
  EXPECT_EQ(edits.pose_of(3)->position_m.x, 1) << "the daemon has refused or lost it";
  EXPECT_EQ(edits.history().undoes(), "place body 3 ball");
  desk.commands.perform(Action::undo);
  ASSERT_EQ(desk.of<protocol::ScenePlace>().size(), 4u);
  EXPECT_EQ(desk.of<protocol::ScenePlace>().back().pose.position_m, (Vec3{1, 2, 3}));
  EXPECT_EQ(edits.history().undoes(), "");
  desk.commands.perform(Action::redo);
  EXPECT_EQ(desk.of<protocol::ScenePlace>().back().pose.position_m, (Vec3{1.3, 2, 3}));
  desk.commands.load_scene("other.toml");
  EXPECT_EQ(edits.history().undoes(), "") << "the body is gone";
}

TEST(Commands, TheListenerIsPutAndGoesBack) {
  Desk desk;
  Edits& edits = desk.commands.edits();
  edits.set_listener(ringdown::Pose{{1, 0, 0}, {}});
  desk.wait(1);
  edits.set_listener(ringdown::Pose{{2, 0, 0}, {}});
  desk.wait(1);
  desk.commands.perform(Action::undo);
  EXPECT_EQ(desk.of<protocol::SetListener>().back().verb.pose.position_m.x, 1);
  EXPECT_EQ(edits.listener()->position_m.x, 1);
  desk.commands.perform(Action::undo);
  EXPECT_EQ(desk.of<protocol::ListenerOff>().size(), 1u) << "at first there is none";
  EXPECT_FALSE(edits.listener());
}

TEST(Commands, ABowIsLiftedByUndoAndChangedWithinOneGesture) {
  Desk desk;
  Edits& edits = desk.commands.edits();
  const SurfacePoint at{"bell", {0.1, 0, 0}, {0, 0, 1}};
  synth::verb::Bow bow{.speed_m_s = 0.2, .force_n = 2};
  edits.touch(bow_at(at, {0, 3, 4}, bow));
  desk.wait(1);
  ASSERT_EQ(edits.touches().bows().size(), 1u);
  EXPECT_NEAR(edits.touches().bows()[0].verb.direction.y, 1, 1e-12) << "the hair lies in the surface";
  EXPECT_NEAR(edits.touches().bows()[0].verb.direction.z, 0, 1e-12);
  for (const double force_n : {3.0, 4.0, 5.0}) {
    bow.force_n = force_n;
    edits.touch(bow_at(at, {0, 1, 0}, bow));
    desk.wait(0.1);
  }
  EXPECT_EQ(edits.history().undoes(), "bell: bow");
  desk.commands.perform(Action::undo);
  EXPECT_EQ(desk.of<protocol::SetBow>().back().verb.force_n, 2) << "the drag of a slider is one change";
  desk.commands.perform(Action::undo);
  EXPECT_EQ(desk.of<protocol::SetBow>().back().verb.force_n, 0);
  EXPECT_TRUE(edits.touches().bows().empty());
  desk.commands.perform(Action::redo);
  EXPECT_EQ(desk.of<protocol::SetBow>().back().verb.force_n, 2);
  EXPECT_EQ(edits.touches().bows().size(), 1u);
  desk.commands.perform(Action::clear_sound);
  EXPECT_TRUE(edits.touches().bows().empty()) << "clearing ends all contacts";
}

TEST(Commands, CouplingsHaveNumbersOfTheirOwnAndGoWithTheirObjects) {
  Desk desk({"bell", "plate"});
  Edits& edits = desk.commands.edits();
  const SurfacePoint bell{"bell", {0.1, 0, 0}, {0, 0, 1}}, plate{"plate", {0, 0.2, 0}, {0, 0, -1}};
  for (int i = 0; i < 2; ++i) {
    edits.touch(coupling_of(bell, plate, {.number = edits.touches().free_number()}));
    desk.wait(1);
  }
  ASSERT_EQ(edits.touches().couplings().size(), 2u);
  const auto& [first, second] = std::pair(edits.touches().couplings()[0], edits.touches().couplings()[1]);
  EXPECT_NE(first.verb.number, second.verb.number);
  EXPECT_EQ(first.verb.direction, (Vec3{0, 0, -1})) << "against the outward normal";
  desk.commands.perform(Action::undo);
  EXPECT_EQ(desk.of<protocol::SetCoupling>().back().verb.number, second.verb.number);
  EXPECT_EQ(desk.of<protocol::SetCoupling>().back().verb.stiffness, 0);
  EXPECT_EQ(edits.touches().couplings().size(), 1u);
  desk.model.apply(protocol::NotifyObject{1, "plate", false}, desk.now_s);
  desk.wait(0.1);
  EXPECT_TRUE(edits.touches().couplings().empty()) << "its object was freed";
}

TEST(Commands, BodiesOfAnotherSceneAreNotUndone) {
  Desk desk;
  const auto& history = desk.commands.edits().history();
  const KnownObject& bell = *desk.model.object("bell");
  desk.commands.edits().change(bell, protocol::SetPan{{"bell", {}}, {0.5}}, "pan");
  desk.commands.edits().remove_body(3);
  desk.commands.edits().remove_body(4);
  desk.commands.perform(Action::undo);
  desk.commands.load_scene("other.toml");
  EXPECT_EQ(history.undoes(), "bell: pan");
  EXPECT_EQ(history.redoes(), "");
  desk.commands.perform(Action::undo);
  EXPECT_EQ(history.undoes(), "");
}

// The daemon's answers to a scene that is loaded paused, in the order in which they come.
TEST(Commands, ASceneBeginsWhenTheGeometryOfItsBodiesHasArrived) {
  Desk desk;
  desk.model.apply(protocol::NotifyScene{1, 5, false}, desk.now_s);
  desk.wait(0.1);
  desk.commands.load_scene("demo.toml");
  ASSERT_EQ(desk.of<protocol::SceneLoad>().size(), 1u);
  EXPECT_TRUE(desk.of<protocol::SceneLoad>()[0].paused);
  const auto begins = [&] {
    desk.wait(0.1);
    return desk.of<protocol::ScenePause>().size();
  };
  desk.model.apply(protocol::Done{"/scene/load", 1}, desk.now_s);
  desk.model.apply(protocol::NotifyScene{2, 0, true}, desk.now_s);
  EXPECT_EQ(begins(), 0u) << "nothing is known of it";
  protocol::SceneReply scene;
  scene.version = 2;
  scene.bodies = 1;
  scene.file = "demo.toml";
  desk.model.apply(scene, desk.now_s);
  protocol::SceneBody body;
  body.version = 2;
  body.name = body.object = "bell";
  body.shape = "convex";
  desk.model.apply(body, desk.now_s);
  ASSERT_TRUE(desk.model.scene().up_to_date());
  EXPECT_EQ(begins(), 0u) << "the bell has no geometry yet";
  body.object = "-";
  ++body.version, ++scene.version;
  desk.model.apply(protocol::NotifyScene{3, 0, true}, desk.now_s);
  desk.model.apply(scene, desk.now_s);
  desk.model.apply(body, desk.now_s);
  EXPECT_EQ(begins(), 1u);
  EXPECT_FALSE(desk.of<protocol::ScenePause>()[0].paused);
  EXPECT_EQ(begins(), 1u) << "the daemon has time to answer";
  desk.wait(0.5);
  EXPECT_EQ(begins(), 2u) << "the message was lost";
  desk.model.apply(protocol::NotifyScene{3, 0.1, false}, desk.now_s);
  EXPECT_EQ(begins(), 2u);
  desk.model.apply(protocol::NotifyScene{3, 0.1, true}, desk.now_s);
  EXPECT_EQ(begins(), 2u) << "it was paused on purpose";
}

TEST(Commands, ASceneThatIsRefusedLeavesTheOldOnePaused) {
  Desk desk;
  desk.model.apply(protocol::NotifyScene{1, 5, true}, desk.now_s);
  desk.commands.load_scene("none.toml");
  desk.model.apply(protocol::Fail{"/scene/load", "there is no file none.toml"}, desk.now_s);
  desk.model.apply(protocol::NotifyScene{2, 5, true}, desk.now_s);
  desk.wait(1);
  EXPECT_TRUE(desk.of<protocol::ScenePause>().empty());
}

TEST(Files, OfTheSameNameAreToldApart) {
  EXPECT_EQ(names_of({"a/scenes/demo.toml", "b/scenes/demo.toml", "b/scenes/bells.toml", "c/other/demo.toml"}),
            (std::vector<std::string>{"demo (a/scenes)", "demo (b/scenes)", "bells", "demo (other)"}));
}

TEST(Commands, WithoutAnObjectNoRequestNamesOne) {
  Desk desk(std::vector<std::string>{});
  for (const Action action :
       {Action::all_modes, Action::highest_modes, Action::alpha_up, Action::more_modes, Action::project_test_force,
        Action::hear_mode, Action::undo, Action::redo, Action::next_object, Action::next_node, Action::next_mode}) {
    EXPECT_TRUE(desk.commands.perform(action));
  }
  EXPECT_TRUE(desk.sent.empty());
}

TEST(Commands, AStrikePushesIntoTheSurface) {
  Desk desk;
  desk.commands.choice().contact_time_s = 0.001;
  desk.commands.strike("bell", {0.1, 0, 0}, {1, 0, 0}, 0.2);
  const auto strikes = desk.of<protocol::Strike>();
  ASSERT_EQ(strikes.size(), 1u);
  EXPECT_EQ(strikes[0].verb.impulse_ns, (Vec3{-0.2, 0, 0}));
  EXPECT_EQ(strikes[0].verb.contact_time_s, 0.001);
}

TEST(ModeList, ListedModesAreThoseOfTheScaledMaterial) {
  auto bank = modal::read_bank(RINGDOWN_SOURCE_DIR "/presets/banks/bronze-bell.glb");
  ASSERT_TRUE(bank) << bank.error().message;
  KnownBank known{std::move(*bank), {}};
  known.by_frequency.resize(known.bank.mode_count());
  for (std::uint32_t i = 0; i < known.by_frequency.size(); ++i) known.by_frequency[i] = i;
  std::ranges::sort(known.by_frequency, {}, [&](std::uint32_t m) { return known.bank.frequency_hz[m]; });
  const auto plain = list_modes(known, {}, 0);
  Adjustment twice;
  twice.scale.size = 0.5;
  twice.range = {2, 3};
  const auto small = list_modes(known, twice, 0);
  ASSERT_EQ(plain.size(), known.bank.mode_count());
  for (std::size_t rank = 0; rank < plain.size(); ++rank) {
    EXPECT_TRUE(rank == 0 || plain[rank].frequency_hz >= plain[rank - 1].frequency_hz);
    EXPECT_NEAR(small[rank].frequency_hz / plain[rank].frequency_hz, 2, 0.01) << "half the size is an octave up";
    EXPECT_EQ(small[rank].selected, rank >= 2 && rank < 5);
    EXPECT_NEAR(plain[rank].t60_s, std::log(1000) / known.bank.decay_per_s[known.by_frequency[rank]], 1e-9);
  }
}

}  // namespace
}  // namespace ringdown::viewer
