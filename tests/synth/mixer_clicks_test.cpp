// The click of an object that is set in motion as a whole: what a sphere radiates, on its frame, as loud as modes are.
#include "engine/synth/modes/click.h"

#include "tests/support/realtime_guard.h"
#include "tests/support/synthetic_bank.h"
#include "tests/synth/player.h"

#include <complex>
#include <limits>

namespace ringdown::synth::test {
namespace {

Event click_at(Frame frame, ObjectNumber object, Vec3 impulse_ns, double contact_time_s = 0.0005) {
  return {.frame = frame,
          .object = object,
          .verb = verb::Click{.impulse_ns = impulse_ns, .contact_time_s = contact_time_s}};
}

// A mode that nothing strikes here, in a solid sphere.
modal::Bank sphere_bank(double radius_m, double mass_kg) {
  modal::Bank bank = single_mode_bank(440, 1);
  const double inertia = 0.4 * mass_kg * radius_m * radius_m;
  bank.mass = modal::MassProperties{.mass_kg = mass_kg, .inertia_kg_m2 = {inertia, inertia, inertia}};
  return bank;
}

std::complex<double> spectrum_at(const Samples& samples, double hz, double rate) {
  std::complex<double> sum;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    sum += samples[n] * std::polar(1.0, -2 * std::numbers::pi * hz * static_cast<double>(n) / rate);
  }
  return sum / rate;
}

// The field of a sphere that moves to and fro as u cos(theta) exp(iwt): p = A d/dr (exp(-ikr) / r) cos(theta), where A
// meets iw rho u = -dp/dr on its surface. Far away, by its acceleration and without distance and density.
std::complex<double> far_field(double hz, double radius_m) {
  const std::complex<double> ikr(0, 2 * std::numbers::pi * hz / 343.2 * radius_m);
  return 2.0 * ikr / (2.0 + 2.0 * ikr + ikr * ikr);
}

TEST(Click, AClickIsTheFarFieldOfASphere) {
  for (const double radius_m : {0.01, 0.05, 0.4}) {
    for (const double contact_time_s : {0.0002, 0.001, 0.01}) {
      const double rate = 384000;  // so that little folds back
      Click click({343.2 / radius_m, 2.5}, 0.3, contact_time_s, rate);
      Samples samples(60000);
      click.fill(samples.size(), samples.data());
      EXPECT_LT(click.length(), static_cast<Frame>(samples.size()));
      for (const double hz : {30.0, 200.0, 1000.0, 4000.0}) {
        // a half-sine from 0 to tau, as it stands in docs/how/physics.md, half a contact time later
        const auto force = 0.3 * static_cast<double>(pulse_factor(hz, contact_time_s)) *
                           std::polar(1.0, -std::numbers::pi * hz * contact_time_s);
        const auto want = 2.5 * force * far_field(hz, radius_m);
        const double loudest = 2.5 * 0.3 * std::abs(far_field(hz, radius_m));
        EXPECT_LT(std::abs(spectrum_at(samples, hz, rate) - want), 3e-4 * loudest)
            << radius_m << " m, " << contact_time_s << " s, " << hz << " Hz";
      }
    }
  }
}

TEST(Click, ABodyClicksAsTheSphereOfTheSameMassAndGyration) {
  EXPECT_NEAR(radius_of(*sphere_bank(0.07, 3).mass), 0.07, 1e-15);
  // a thin disc: 1/2 m r^2 about its axis, 1/4 about the others
  EXPECT_NEAR(radius_of({.mass_kg = 2, .inertia_kg_m2 = {0.5 * 0.01, 0.5 * 0.01, 0.01}}), 0.1 * std::sqrt(5.0 / 6),
              1e-12);
}

TEST(MixerClicks, ClicksBeginOnTheirFrameAtEveryBlockSize) {
  const Map map = map_of(sphere_bank(0.05, 0.5));
  Samples first;
  for (const std::size_t block : {1, 64, 257, 2000}) {
    Player player;
    player.install(0, map);
    player.push(click_at(777, 0, {0.1, 0.2, -0.2}));
    player.render(2000, block);
    const auto sounds = std::ranges::find_if(player.left, [](double x) { return x != 0; });
    EXPECT_EQ(sounds - player.left.begin(), 778);  // the force begins at 0
    if (first.empty()) first = player.left;
    EXPECT_EQ(player.left, first) << block;
  }
  EXPECT_EQ(first.back(), 0);
}

// A rigid sphere that oscillates with velocity U radiates rho omega U R^3 k cos(theta) / (r sqrt(4 + (kR)^4)) far away
// (Landau & Lifshitz, Fluid Mechanics, section 74); the mean of cos^2 over all directions is 1/3.
TEST(MixerClicks, ClicksAreThePressureOfARigidSphereAtOneMetreRmsOverDirections) {
  const double radius_m = 0.1, mass_kg = 4, impulse_ns = 2, rho = 1.2041;
  for (const double hz : {150.0, 800.0, 2500.0}) {
    Player player;
    player.install(0, map_of(sphere_bank(radius_m, mass_kg)));
    player.push(pan_at(0, 0, -1));
    player.push(click_at(1000, 0, {0, 0, impulse_ns}, 0.0003));
    player.render(4000);
    const double k = 2 * std::numbers::pi * hz / 343.2, acceleration = impulse_ns / mass_kg;  // for each hertz
    const double on_axis_pa = rho * acceleration * static_cast<double>(pulse_factor(hz, 0.0003)) *
                              std::pow(radius_m, 3) * k / std::sqrt(4 + std::pow(k * radius_m, 4));
    const double want = on_axis_pa / std::sqrt(3.0) / modal::kFullScale_pa;
    EXPECT_NEAR(std::abs(spectrum_at(player.left, hz, kRate)) / want, 1, 0.01) << hz;
  }
}

TEST(MixerClicks, ClicksFollowTheObjectsGainAndMaterial) {
  const auto loudness = [](double gain, const modal::MaterialScale& material) {
    Player player;
    player.install(0, map_of(sphere_bank(0.05, 1)), Mixer::Install::replace, material);
    player.push(gain_at(0, 0, gain));
    player.push(click_at(1000, 0, {1, 0, 0}));
    player.render(3000);
    return peak(player.left);
  };
  const double plain = loudness(1, {});
  EXPECT_GT(plain, 0);
  EXPECT_NEAR(loudness(0.25, {}) / plain, 0.25, 1e-6);
  EXPECT_NEAR(loudness(1, {.density = 4}) / plain, 0.25, 1e-6) << "four times the mass, a quarter of the acceleration";
}

TEST(MixerClicks, ClicksNeedAMassAndFiniteNumbers) {
  Player player;
  player.install(0, map_of(single_mode_bank(440, 1)));
  player.install(1, map_of(sphere_bank(0.05, 1)));
  player.install(2, map_of(sphere_bank(5, 100)));  // below what is heard
  player.push(click_at(0, 0, {1, 0, 0}));
  player.push(click_at(0, 1, {std::numeric_limits<double>::quiet_NaN(), 0, 0}));
  player.push(click_at(0, 1, {1e300, 0, 0}));
  player.push(click_at(0, 1, {1, 0, 0}, -1));
  player.push(click_at(0, 2, {1, 0, 0}));
  player.push(click_at(0, 3, {1, 0, 0}));
  player.render(1000);
  EXPECT_EQ(player.mixer.counters().refused, 6u);
  EXPECT_EQ(peak(player.left), 0);
}

TEST(MixerClicks, ClicksSoundTogetherUpToTheLimitAndNotOneMore) {
  for (const std::size_t more : {0, 1}) {
    Player player;
    player.install(0, map_of(sphere_bank(0.05, 1)));
    for (std::size_t i = 0; i < kMaxClicks + more; ++i) player.push(click_at(0, 0, {1, 0, 0}));
    player.render(64);
    EXPECT_EQ(player.mixer.counters().refused, more);
    player.render(10000);
    player.push(click_at(0, 0, {1, 0, 0}));
    player.render(1000);
    EXPECT_EQ(player.mixer.counters().refused, more);
  }
}

TEST(MixerClicks, ClicksEndWhenTheSampleRateChanges) {
  Player player;
  player.install(0, map_of(sphere_bank(0.05, 1)));
  player.push(click_at(0, 0, {1, 0, 0}, 0.05));
  player.render(100);
  EXPECT_GT(peak(player.left), 0);
  player.mixer.change_sample_rate(96000);
  const std::size_t from = player.left.size();
  player.render(1000);
  EXPECT_EQ(peak(player.left_from(from)), 0);
}

TEST(MixerClicks, ClicksAllocateNothing) {
  Player player;
  player.install(0, map_of(sphere_bank(0.05, 1)));
  player.render(256);
  for (Frame i = 0; i < 100; ++i) player.push(click_at(256 + 7 * i, 0, {1, 0, 0}));
  std::vector<float> left(1024), right(1024);
  const RealtimeScope scope;
  player.mixer.render(left, right);
  EXPECT_EQ(scope.seen().total(), 0u) << scope.seen().first;
}

}  // namespace
}  // namespace ringdown::synth::test
