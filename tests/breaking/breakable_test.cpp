// A body that is followed and broken: what its pieces are told is the body's own motion, whatever came in which order.
#include "engine/breaking/breakable.h"
#include "tests/support/breaking_bar.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace ringdown::breaking {
namespace {

using synth::verb::Impart;
using synth::verb::Strike;

constexpr double kRate_hz = 48000;
const Strike kBlow{{0.02, 0, 0}, {0, 0, 0.03}, 2e-4};

std::shared_ptr<const modal::StrikeMap> map_of(const modal::Bank& bank) {
  return std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(bank));
}

std::shared_ptr<const modal::StrikeMap> bar_of(std::vector<modal::BreakPattern> patterns,
                                               double crack_energy_j_m2 = 0) {
  modal::Bank bar = test::quiet_bar_bank(6);
  bar.fracture = std::make_shared<const modal::Fracture>(
      modal::Fracture{.patterns = std::move(patterns), .crack_energy_j_m2 = crack_energy_j_m2});
  return map_of(bar);
}

// Motions that the events impart, by object and mode, as velocity exp(i phase).
using Motions = std::map<std::pair<synth::ObjectNumber, std::uint32_t>, std::complex<double>>;

Motions motions_of(const Shattered& shattered) {
  Motions motions;
  for (const synth::Event& event : shattered.events) {
    if (const auto* one = event.verb.get_if<Impart>())
      motions[{event.object, one->mode}] += std::polar(one->velocity, one->phase_rad);
  }
  return motions;
}

double distance(const Motions& a, const Motions& b) {
  double max = a.size() == b.size() ? 0 : HUGE_VAL;
  for (const auto& [key, motion] : a) max = std::max(max, std::abs(motion - b.at(key)));
  return max;
}

Shattered broken_by(Breakable& body, const PieceSet& set, const Strike& blow, synth::Frame frame, RestOfBlow rest) {
  std::vector<std::optional<synth::ObjectNumber>> numbers;
  for (std::size_t i = 0; i < set.pieces().size(); ++i) numbers.emplace_back(static_cast<synth::ObjectNumber>(i + 1));
  return body.shatter(set, {.blow = blow, .frame = frame, .rest = rest, .body = 0, .pieces = numbers});
}

// A piece's share of the body's motion and the rest of the blow add up, so that only the piece under the blow differs.
TEST(Breakable, TheRestOfABlowIsForOnePieceOrForTheStriker) {
  const auto map = bar_of({test::even_pieces(3, 4)});
  const PieceSet set(*map, {}, 0);
  const auto motions = [&](const Strike& blow, RestOfBlow rest) {
    Breakable body = *Breakable::make(map, {}, kRate_hz, 0);
    const Shattered shattered = broken_by(body, set, blow, 1000, rest);
    EXPECT_EQ(shattered.under, 0u) << "all are equally near";
    EXPECT_TRUE(shattered.events.back().verb.holds<synth::verb::Choke>());
    return motions_of(shattered);
  };
  const Motions whole = motions(kBlow, RestOfBlow::to_piece), left = motions(kBlow, RestOfBlow::to_striker);
  ASSERT_EQ(whole.size(), 12u);
  double under = 0;
  for (const auto& [key, motion] : whole) {
    if (key.first == 1) {
      under = std::max(under, std::abs(motion - left.at(key)));
    } else {
      EXPECT_EQ(motion, left.at(key));
    }
  }
  EXPECT_GT(under, 1e-6);
  const Strike ideal{kBlow.point_m, kBlow.impulse_ns, 0};
  EXPECT_EQ(distance(motions(ideal, RestOfBlow::to_piece), motions(ideal, RestOfBlow::to_striker)), 0)
      << "an ideal impulse has no second half";
}

TEST(Breakable, EventsCountAlikeInAnyOrder) {
  const auto map = bar_of({test::even_pieces(2, 6)});
  const PieceSet set(*map, {}, 0);
  const std::vector<synth::Event> events = {
      {100, 0, kBlow}, {350, 0, Strike{{-0.01, 0, 0}, {0, 0, -0.02}, 1e-4}}, {700, 0, Impart{2, 0.01, 0.3}}};
  Breakable in_order = *Breakable::make(map, {}, kRate_hz, 0), reversed = in_order;
  for (const synth::Event& event : events) in_order.follow(event);
  for (std::size_t i = events.size(); i-- > 0;) reversed.follow(events[i]);
  const Strike nothing{kBlow.point_m, {}, 0};
  const Motions a = motions_of(broken_by(in_order, set, nothing, 1000, RestOfBlow::to_piece));
  const Motions b = motions_of(broken_by(reversed, set, nothing, 1000, RestOfBlow::to_piece));
  EXPECT_LT(distance(a, b), 1e-12);
  EXPECT_GT(std::abs(a.at({1, 0})), 1e-6);
  Breakable choked = *Breakable::make(map, {}, kRate_hz, 0);
  for (const synth::Event& event : events) choked.follow(event);
  choked.follow({900, 0, synth::verb::Choke{}});
  for (const auto& [key, motion] : motions_of(broken_by(choked, set, nothing, 1000, RestOfBlow::to_piece)))
    EXPECT_EQ(std::abs(motion), 0);
}

TEST(Breakable, TheNearestPlaceAndTheEnergyChooseThePattern) {
  std::vector<modal::BreakPattern> patterns{test::even_pieces(2, 1), test::even_pieces(8, 1), test::even_pieces(4, 1)};
  patterns[2].at_m = {0.1, 0, 0};
  const auto map = bar_of(std::move(patterns), 8);
  const Breakable body = *Breakable::make(map, {}, kRate_hz, 0);
  const Breakable twice = *Breakable::make(map, {.size = 2}, kRate_hz, 0);
  EXPECT_EQ(body.levels_at({0.04, 0, 0}), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(body.levels_at({0.06, 0, 0}), (std::vector<std::size_t>{2}));
  EXPECT_EQ(twice.levels_at({0.06, 0, 0}), (std::vector<std::size_t>{0, 1})) << "its places are twice as far apart";
  EXPECT_NEAR(body.crack_cost_j(1), 3 * 8e-5 * 8, 1e-15);
  EXPECT_NEAR(twice.crack_cost_j(1), 4 * 3 * 8e-5 * 8, 1e-15);
  const auto levels = body.levels_at({});
  EXPECT_EQ(body.affordable(levels, 1.01 * body.crack_cost_j(1)), 1u);
  EXPECT_EQ(body.affordable(levels, 0.99 * body.crack_cost_j(1)), 0u);
  EXPECT_EQ(body.affordable(levels, 0), 0u) << "who breaks it all the same has the coarsest";
}

TEST(Breakable, CracksTakeAtMostHalfOfTheVibration) {
  const auto map = bar_of({test::even_pieces(3, 4)});
  const PieceSet set(*map, {}, 0);
  const std::vector<std::optional<synth::ObjectNumber>> numbers = {1, 2, 3};
  const auto ringing_j = [&](double crack_energy_j) {
    Breakable body = *Breakable::make(map, {}, kRate_hz, 0);
    return body.shatter(set, {.blow = kBlow, .frame = 100, .crack_energy_j = crack_energy_j, .pieces = numbers})
        .broken.ringing_j;
  };
  const double all_j = ringing_j(0);
  EXPECT_GT(all_j, 0);
  EXPECT_NEAR(ringing_j(1e6) / all_j, 0.5, 1e-9);
  EXPECT_NEAR(ringing_j(1e9) / all_j, 0.5, 1e-9);
}

TEST(Breakable, ABankWithoutPiecesOrMassIsRefused) {
  const auto plain = Breakable::make(map_of(test::bar_bank(3)), {}, kRate_hz, 0);
  ASSERT_FALSE(plain);
  EXPECT_NE(plain.error().message.find("[shatter]"), std::string::npos);
  modal::Bank bar = test::breaking_bar(3);
  bar.mass.reset();
  EXPECT_FALSE(Breakable::make(map_of(bar), {}, kRate_hz, 0));
  modal::Bank thick = test::breaking_bar(3);
  EXPECT_FALSE(Breakable::make(map_of(thick), {.beta = 1e6}, kRate_hz, 0)) << "its modes no longer ring";
}

}  // namespace
}  // namespace ringdown::breaking
