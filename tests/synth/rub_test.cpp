// What slides or rolls and feels the object: against a simulation of its own, a bow, and one-way contacts.
#include "tests/support/realtime_guard.h"
#include "tests/synth/leapfrog_bank.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace ringdown::synth::test {
namespace {

constexpr Vec3 kPlace{0.15, 0, 0};

Event rub_at(Frame frame, ObjectNumber object, const Touch& how, double slip_m_s, const Texture& texture = {}) {
  Touch rub = how;
  rub.contact = {
      .number = how.number, .force_n = how.force_n * how.direction, .slip_m_s = slip_m_s, .texture = texture};
  return touch_at(frame, object, kPlace, rub);
}

// The same as a one-way contact.
Event one_way(const Event& rub) { return {rub.frame, rub.object, rub.verb.get<verb::Rub>().as_public()}; }

// The event that ends it.
Event end_of(Frame frame, ObjectNumber object, std::uint32_t number) {
  return touch_at(frame, object, kPlace, {.kind = Touch::Kind::rub, .contact = {.number = number}});
}

Touch pressed_by(double load, double kg, double depth_m) {
  return {.kind = Touch::Kind::rub,
          .direction = {0, 0, -1},
          .force_n = load,
          .mass_kg = kg,
          .stiffness = load / std::pow(depth_m, 1.5)};
}

double rms(std::span<const double> samples) {
  double sum = 0;
  for (const double x : samples) sum += x * x;
  return std::sqrt(sum / static_cast<double>(samples.size()));
}

double off_by_db_of(std::span<const double> a, std::span<const double> b) {
  Samples difference(a.size());
  for (std::size_t n = 0; n < a.size(); ++n) difference[n] = a[n] - b[n];
  return 20 * std::log10(rms(difference) / rms(a));
}

// What a bank sounds like on which a mass lies under a load, over a surface of given heights. The load acts on both, so
// that nothing is bent while it rests.
Samples simulated_rub(const modal::StrikeMap& map, const Touch& rub, const std::vector<double>& heights_m) {
  constexpr double kStep_s = LeapfrogBank::kStep_s;
  LeapfrogBank bank(map, kPlace, rub.direction);
  const double depth_at_rest = std::pow(rub.force_n / rub.stiffness, 2.0 / 3);
  const double per_kg = 1 / rub.mass_kg + bank.per_kg();
  const double damping = 2 * 0.02 * std::sqrt(1.5 / (per_kg * rub.force_n * depth_at_rest));
  double x = 0, speed = 0, net = 0, raised = 0;
  Samples samples(heights_m.size());
  for (std::size_t n = 0; n < samples.size(); ++n) {
    samples[n] = bank.sample(net);
    const double load = rub.force_n * std::min(1.0, static_cast<double>(n) / 96);  // it comes in 2 ms
    const double rise = (heights_m[n] - raised) / LeapfrogBank::kSteps;
    for (int s = 0; s < LeapfrogBank::kSteps; ++s) {
      raised += rise;
      const double depth = x - bank.displacement_m() + raised, nearing = speed - bank.speed_m_s() + rise / kStep_s;
      const double force =
          depth > 0 ? std::max(0.0, rub.stiffness * std::pow(depth, 1.5) * (1 + damping * nearing)) : 0.0;
      net = force - load;
      speed -= kStep_s * net / rub.mass_kg;
      x += kStep_s * speed;
      bank.step(net);
    }
  }
  return samples;
}

// Also where the profile is so steep that the two part again and again.
TEST(Rubs, FeelTheBarAsAFineSimulationDoes) {
  const Map map = map_of(bar_bank(8));
  for (const double roughness : {2e-7, 4e-6}) {
    const Touch rub = pressed_by(1, 0.05, 1e-5);
    const Event event = rub_at(0, 0, rub, 0.02, {.roughness_m = roughness});
    Player player;
    player.install(0, map);
    player.push(event);
    player.render(2400);
    Rubbing relief(rub.number, kRate);
    relief.update(0, event.verb.get<verb::Rub>().contact);
    std::vector<double> heights(2400);
    relief.fill_slopes(0, heights.size(), heights.data());
    for (std::size_t n = 0; n < heights.size(); ++n) {
      heights[n] *= 2.0 / 3 * 1e-5 * std::pow(std::min(1.0, static_cast<double>(n) / 96), 2.0 / 3);
    }
    const Samples expected = simulated_rub(*map, rub, heights);
    const double off = off_by_db_of(std::span(expected).subspan(240), player.left_from(240).first(2160));
    EXPECT_LT(off, -30) << roughness;
    RecordProperty("db_" + std::to_string(roughness), std::to_string(off));
  }
}

// What is heavy moves little, and on a spring softer than the bar it hardly feels how that moves: it leaves the bar
// ringing about as loudly as the one-way contact does that the event also describes.
TEST(Rubs, AreNearlyAsLoudAsOneWayContactsWhereNothingGivesWay) {
  const Map map = map_of(bar_bank(8));
  const auto play = [&](bool felt) {
    Player player;
    player.install(0, map);
    double sum = 0;
    for (const std::uint32_t number : {0, 1, 2, 3, 4, 5, 6, 7}) {
      const auto begin = static_cast<Frame>(player.left.size());
      Touch rub = pressed_by(1, 1, 1e-5);
      rub.number = number;
      Event event = rub_at(begin, 0, rub, 0.05, {.roughness_m = 2e-7});
      if (!felt) event = one_way(event);
      for (; event.frame < begin + 4800; event.frame += 480) player.push(event);
      const Event end = end_of(event.frame, 0, number);
      player.push(felt ? end : one_way(end));
      player.render(9600);
      sum += rms(player.left_from(static_cast<std::size_t>(begin) + 7200).first(2400));
      player.push(clear_at(static_cast<Frame>(player.left.size()), 0));
      player.render(4800);
    }
    return sum;
  };
  const double ratio = play(true) / play(false);
  EXPECT_NEAR(20 * std::log10(ratio), 0, 2);
  RecordProperty("db", std::to_string(20 * std::log10(ratio)));
}

// Along the surface a rub is a bow without hair: a mode that moves along alone is bowed.
TEST(Rubs, BowWhatTheySlideOver) {
  const double kg = 0.05;
  const Map map = map_of(single_mode_bank(220, 3, {0, 0, static_cast<float>(1 / std::sqrt(kg))}));
  const auto play = [&](bool bowed) {
    Player player;
    player.install(0, map);
    Touch bow{.kind = Touch::Kind::bow, .direction = {0, 0, 1}, .speed_m_s = 0.2, .force_n = 1, .friction = 0.8};
    Touch rub = pressed_by(1, 0.02, 1e-6);
    rub.direction = {1, 0, 0}, rub.slide_m_s = {0, 0, 0.2}, rub.friction = 0.8;
    Event event = rub_at(0, 0, bowed ? bow : rub, 0, {.roughness_m = 1e-15});
    for (; event.frame < 96000; event.frame += 480) player.push(event);
    player.render(144000);
    return player.left;
  };
  const Samples bow = play(true), rub = play(false);
  EXPECT_NEAR(rms(std::span(rub).subspan(72000, 24000)) / rms(std::span(bow).subspan(72000, 24000)), 1, 0.03);
  // When nothing is heard of it for a tenth of a second, it ends: the mode decays as it would.
  EXPECT_NEAR(std::log(rms(std::span(rub).subspan(110000, 4800)) / rms(std::span(rub).subspan(134000, 4800))) / 0.5, 3,
              0.1);
}

// The landing rings the bar; where the load is carried to afterwards adds nothing.
TEST(Rubs, CarryTheirLoadAlongInSilence) {
  const Map map = map_of(bar_bank(8));
  const auto play = [&](double along_m) {
    Player player;
    player.install(0, map);
    Event event = rub_at(0, 0, pressed_by(5, 0.05, 1e-6), 0);
    for (; event.frame < 24000; event.frame += 192) {
      if (event.frame > 12000)
        event.verb.get<verb::Rub>().point_m.x = 0.15 - along_m * static_cast<double>(event.frame - 12000) / 12000;
      player.push(event);
    }
    player.render(24000);
    return Samples(player.left.begin() + 12000, player.left.end());
  };
  const Samples still = play(0), carried = play(0.1);
  EXPECT_LT(rms(carried), 1.5 * rms(still));
}

// Sixteen bows leave no place for a rub: to the bit, it is the one-way contact that it also describes, until its end.
TEST(Rubs, BeyondTheLastPlaceAreOneWay) {
  const Map map = map_of(bar_bank(8));
  const auto play = [&](bool felt) {
    Player player;
    for (ObjectNumber object = 0; object <= 16; ++object) player.install(object, map);
    const Touch bow{.kind = Touch::Kind::bow, .direction = {0, 0, 1}, .speed_m_s = 0.2, .force_n = 1, .friction = 0.8};
    for (ObjectNumber object = 0; object < 16; ++object) player.push(rub_at(0, object, bow, 0));
    Event event = rub_at(100, 16, pressed_by(1, 0.05, 1e-5), 0.1);
    if (!felt) event = one_way(event);
    for (; event.frame < 9600; event.frame += 480) player.push(event);
    for (ObjectNumber object = 0; object < 16; ++object) {  // a place in the middle of it does not change it
      Touch lifted = bow;
      lifted.force_n = 0;
      player.push(rub_at(4800, object, lifted, 0));
    }
    const Event end = end_of(event.frame, 16, 0);
    player.push(felt ? end : one_way(end));
    player.render(24000);
    EXPECT_EQ(player.mixer.counters().refused, 0u);
    return player.left;
  };
  EXPECT_EQ(play(true), play(false));
}

// Another object's surface rubs: it is heard, too, turned as it lies.
TEST(Rubs, AreHeardFromBothObjects) {
  const Map bar = map_of(bar_bank(8));
  const auto level = [&](Vec3 up_in_other) {
    Player player;
    player.install(0, bar);
    player.install(1, bar);
    EXPECT_TRUE(player.mixer.silence(0, true));
    Touch rub = pressed_by(1, 0.05, 1e-6);
    rub.other = 1, rub.other_point_m = kPlace;
    rub.to_other =
        up_in_other.z == 1 ? Rotation{} : Rotation::from_xyzw(0, std::numbers::sqrt2 / 2, 0, std::numbers::sqrt2 / 2);
    player.push(rub_at(0, 0, rub, 0.1));
    player.render(4800);
    return rms(player.left_from(2400).first(2400));
  };
  const double upright = level({0, 0, 1}), lying = level({1, 0, 0});
  EXPECT_GT(upright, 1e-4);
  EXPECT_LT(lying, 1e-3 * upright);  // bars of this bank swing along z alone
}

TEST(Rubs, TakeNoMemoryAndNoLocks) {
  const Map map = map_of(random_bank(3, 100, 60));
  Player player;
  for (ObjectNumber object = 0; object < 2; ++object) player.install(object, map);
  std::vector<float> left(256), right(256);
  Touch rub = pressed_by(1, 0.05, 1e-6);
  rub.other = 1, rub.friction = 0.4, rub.slide_m_s = {0.1, 0, 0};
  Event event = rub_at(0, 0, rub, 0.1);
  for (; event.frame < 6000; event.frame += 192, event.verb.get<verb::Rub>().point_m.x -= 0.001) player.push(event);
  const RealtimeScope scope;
  for (int block = 0; block < 60; ++block) player.mixer.render(left, right);
  EXPECT_EQ(scope.seen().total(), 0u) << scope.seen().first;
}

}  // namespace
}  // namespace ringdown::synth::test
