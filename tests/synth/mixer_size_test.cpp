// An object in another size: what a bank of that size would sound like, and live.
#include "tests/synth/player.h"

namespace ringdown::synth::test {
namespace {

constexpr double kSize = 1.7;

// By the laws of similar bodies, in one place and by hand: lambda / s^2, shapes s^-3/2, far fields s^1/2,
// mass s^3, inertia s^5.
modal::Bank of_size(const modal::Bank& bank, double s) {
  modal::Bank scaled = bank;
  const double beta = bank.material ? bank.material->damping.beta_s : 0;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double omega = 2 * std::numbers::pi * bank.frequency_hz[m], d = bank.decay_per_s[m];
    const double lambda = omega * omega + d * d;
    const double decay = d - beta * lambda / 2 + beta * lambda / (2 * s * s);
    scaled.decay_per_s[m] = decay;
    scaled.frequency_hz[m] = std::sqrt(lambda / (s * s) - decay * decay) / (2 * std::numbers::pi);
  }
  for (auto& shape : scaled.shapes) {
    for (float& x : shape) x = static_cast<float>(x * std::pow(s, -1.5));
  }
  for (auto& point : scaled.positions) {
    for (float& x : point) x = static_cast<float>(x * s);
  }
  for (modal::FarField& field : scaled.radiation->maps.modes) {
    field.wavenumber_rad_m /= s;
    for (auto& term : field.terms) term.value *= static_cast<float>(std::sqrt(s));
  }
  if (scaled.mass) {
    scaled.mass->mass_kg *= s * s * s;
    scaled.mass->inertia_kg_m2 = std::pow(s, 5) * scaled.mass->inertia_kg_m2;
    scaled.mass->center_of_mass_m = s * scaled.mass->center_of_mass_m;
  }
  return scaled;
}

struct Heard {
  Samples sound;
  float reach;
};

// A blow that clicks too, one at a sample point, and a push that lasts.
Heard play(const modal::Bank& bank, const modal::MaterialScale& material, const modal::Dampers& dampers) {
  Player player;
  const Map map = map_of(bank);
  EXPECT_TRUE(player.mixer.install(
      0, std::make_unique<Voice>(std::make_shared<ModeTable>(map, material, kRate, dampers)), Mixer::Install::replace));
  player.mixer.meters().watch_objects(true);
  const Vec3 at = {0.04 * kSize, 0, 0};
  player.push({.frame = 0, .object = 0, .verb = verb::Click{.impulse_ns = {0, 0, 0.1}, .contact_time_s = 2e-4}});
  player.push(strike_at(100, 0, {0, 0, 0.1}, 3e-4, at));
  player.push(vertex_strike_at(2000, 0, 3, {0, 0, -0.05}));
  player.push({.frame = 3000, .object = 0, .verb = verb::Contact{at, {.force_n = {0, 0, -5}, .slip_m_s = 0.3}}});
  player.render(4800);
  return {player.left, player.mixer.meters().take_peak_level(0)};
}

TEST(Size, AnObjectOfAnotherSizeSoundsLikeABankOfThatSize) {
  modal::Bank bank = bar_bank(12);
  const modal::Dampers dampers = {{0, {{0.1 * kSize, 0, 0}, {}, 0.5}}};
  const Heard scaled = play(bank, {.size = kSize}, dampers), baked = play(of_size(bank, kSize), {}, dampers);
  EXPECT_GT(peak(scaled.sound), 1e-4);
  EXPECT_LT(relative_error_db(scaled.sound, baked.sound), -110);
  EXPECT_NEAR(scaled.reach / baked.reach, 1, 1e-3);
  EXPECT_GT(relative_error_db(play(bank, {}, dampers).sound, baked.sound), -20) << "the size is heard";
}

TEST(Size, AStrikeOnALargerObjectIsAPointOfTheLargerSurface) {
  const modal::Bank bank = bar_bank(8);
  const auto struck = [&](double x) {
    Player player;
    player.install(0, map_of(bank), Mixer::Install::replace, {.size = kSize});
    player.push(strike_at(0, 0, {0, 0, 0.1}, 0, {x, 0, 0}));
    player.render(2400);
    return player.left;
  };
  Player by_number;
  by_number.install(0, map_of(bank), Mixer::Install::replace, {.size = kSize});
  by_number.push(vertex_strike_at(0, 0, 5, {0, 0, 0.1}));
  by_number.render(2400);
  EXPECT_LT(relative_error_db(struck(kSize * static_cast<double>(bank.positions[5][0])), by_number.left), -110);
  EXPECT_GT(relative_error_db(struck(static_cast<double>(bank.positions[5][0])), by_number.left), -40);
}

// Without a material all damping is mass-proportional: the decay stays, the pitch goes with 1 / size.
TEST(Size, AnObjectWhoseSizeChangesRingsOnFromWhereItIs) {
  constexpr double kF = 1000, kD = 5;
  constexpr std::size_t kChange = 5000;
  const Map map = map_of(single_mode_bank(kF, kD));
  Player player;
  player.install(0, map);
  player.push(strike_at(0, 0, {0, 0, 1}));
  player.render(kChange);
  player.install(0, map, Mixer::Install::retune, {.size = 1.25});
  player.render(15000);
  const auto after = fit_damped_sinusoid(player.left_from(kChange), kRate);
  const double lambda = (std::pow(2 * std::numbers::pi * kF, 2) + kD * kD) / (1.25 * 1.25);
  EXPECT_NEAR(after.frequency_hz, std::sqrt(lambda - kD * kD) / (2 * std::numbers::pi), 1e-4);
  EXPECT_NEAR(after.decay_per_s, kD, 1e-3);
  EXPECT_LE(largest_step(player.left, kChange - 5, kChange + 5), 1.1 * largest_step(player.left, 4500, kChange));
}

}  // namespace
}  // namespace ringdown::synth::test
