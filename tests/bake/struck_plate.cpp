#include "tests/bake/struck_plate.h"

#include "engine/dense/decompositions.h"
#include "tests/bake/von_karman.h"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace ringdown::synth::test {

Plate steel_plate(int modes, int functions) {
  const fem::Elastic steel{200e9, 0.3, 7850};
  const ringdown::test::PlateTerms terms = ringdown::test::von_karman_square(kSide_m, kThickness_m, steel, modes);
  // The fields' leading singular vectors, weighed by their singular values.
  const dense::Spectrum gram = dense::spectrum(terms.pairs.transpose() * terms.pairs);
  const Eigen::MatrixXd products =
      gram.values.tail(functions).cwiseSqrt().asDiagonal() * gram.vectors.rightCols(functions).transpose();
  Plate plate{.omega = terms.lambda.cwiseSqrt(), .h = {}, .shape = Eigen::VectorXd(modes)};
  for (int k = 0; k < functions; ++k) {
    Eigen::MatrixXd h(modes, modes);
    for (int i = 0, at = 0; i < modes; ++i) {
      for (int j = 0; j <= i; ++j, ++at) h(i, j) = h(j, i) = products(functions - 1 - k, at);
    }
    plate.h.push_back(h);
  }
  // A point is as good as another: numbers near those of the corner of such a plate, of both signs.
  for (int m = 0; m < modes; ++m) plate.shape[m] = 4.0 * std::cos(1.0 + 2.3 * m) / (1 + 0.1 * m);
  return plate;
}

std::shared_ptr<const modal::StrikeMap> map_of(const Plate& plate, bool nonlinear, int coupled, double decay_per_s) {
  modal::Bank bank;
  bank.name = "plate";
  bank.positions = {{0, 0, 0}};
  const auto modes = static_cast<int>(plate.omega.size());
  for (int m = 0; m < modes; ++m) {
    const double damped = std::sqrt(plate.omega[m] * plate.omega[m] - decay_per_s * decay_per_s);
    bank.frequency_hz.push_back(damped / (2 * std::numbers::pi));
    bank.decay_per_s.push_back(decay_per_s);
    bank.shapes.push_back({0, 0, static_cast<float>(plate.shape[m])});
  }
  if (nonlinear) {
    modal::NonlinearTerms terms{.thickness_m = kThickness_m, .coupled = static_cast<std::uint32_t>(coupled)};
    for (int m = 0; m < modes; ++m) terms.modes.push_back(static_cast<std::uint32_t>(m));
    for (const Eigen::MatrixXd& h : plate.h) {
      for (int i = 0; i < modes; ++i) {
        terms.curving.push_back(
            static_cast<float>(plate.curving * plate.omega[i] * std::sin(1 + i + terms.curving.size())));
        for (int j = 0; j <= i; ++j) terms.bending.push_back(static_cast<float>(h(i, j)));
      }
    }
    bank.nonlinear = terms;
  }
  return std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(std::move(bank)));
}

std::vector<Samples> integrated(const Plate& plate, double impulse_ns, double& peak_m, int steps, Samples* heard) {
  const double dt = 1 / (kRate_hz * steps), keep = std::exp(-2 * kDecay_per_s * dt);
  const Eigen::Index modes = plate.omega.size();
  Eigen::VectorXd q = Eigen::VectorXd::Zero(modes), v = impulse_ns * plate.shape;
  const auto force = [&] {
    Eigen::VectorXd f = -plate.omega.cwiseAbs2().cwiseProduct(q);
    for (const Eigen::MatrixXd& h : plate.h) {
      const Eigen::VectorXd hq = h * q;
      f -= 2 * q.dot(hq) * hq;
    }
    return f;
  };
  std::vector<Samples> velocities(static_cast<std::size_t>(modes));
  peak_m = 0;
  Eigen::VectorXd f = force();
  for (int n = 0; n < static_cast<int>(kSeconds * kRate_hz) * steps; ++n) {
    if (n % steps == 0) {
      for (Eigen::Index m = 0; m < modes; ++m) velocities[static_cast<std::size_t>(m)].push_back(v[m]);
      if (heard) heard->push_back(-f.sum());
    }
    v += 0.5 * dt * f;  // velocity Verlet
    q += dt * v;
    f = force();
    v = keep * (v + 0.5 * dt * f);
    peak_m = std::max(peak_m, std::abs(q.dot(plate.shape)));
  }
  return velocities;
}

std::unique_ptr<Voice> struck(const Plate& plate, bool nonlinear, double impulse_ns, int coupled) {
  auto voice = std::make_unique<Voice>(map_of(plate, nonlinear, coupled), modal::MaterialScale{}, kRate_hz);
  EXPECT_TRUE(voice->strike(verb::StrikeVertex{.vertex = 0, .impulse_ns = {0, 0, impulse_ns}, .contact_time_s = 0}));
  return voice;
}

Samples by_tables(Voice& voice, std::size_t frames) {
  Samples sound;
  while (sound.size() < frames) {
    std::array<double, kChunkFrames> out{};
    EXPECT_TRUE(voice.render(out.data(), kChunkFrames, 1e-12));
    sound.insert(sound.end(), out.begin(), out.end());
  }
  return sound;
}

}  // namespace ringdown::synth::test
