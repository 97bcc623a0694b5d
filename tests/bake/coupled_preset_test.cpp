// The sound of presets whose modes exchange energy, against their own equations integrated step by step at 192 kHz.
#include "engine/modal/bank_file.h"
#include "engine/synth/meters.h"
#include "tests/bake/sound_centroid.h"
#include "tests/bake/struck_plate.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>

namespace ringdown::synth::test {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kWholeSecond_s = 1;

// A preset without what it radiates, struck near (x, y): each mode is heard by its acceleration, whichever it is.
modal::Bank struck_bank(const std::string& preset, double x_m, double y_m) {
  const auto path = std::filesystem::path(RINGDOWN_SOURCE_DIR) / "presets" / "banks" / (preset + ".glb");
  const modal::Bank whole = modal::read_bank(path).value();
  std::size_t point = 0;
  const auto distance = [&](std::size_t p) {
    return std::hypot(whole.positions[p][0] - x_m, whole.positions[p][1] - y_m);
  };
  for (std::size_t p = 1; p < whole.point_count(); ++p) point = distance(p) < distance(point) ? p : point;
  modal::Bank bank;
  bank.name = whole.name;
  bank.positions = {{0, 0, 0}};
  bank.frequency_hz = whole.frequency_hz;
  bank.decay_per_s = whole.decay_per_s;
  for (std::size_t m = 0; m < whole.mode_count(); ++m) bank.shapes.push_back({0, 0, whole.shape(m, point)[2]});
  bank.nonlinear = whole.nonlinear;
  return bank;
}

// q'' + 2 d q' + omega^2 q + dV/dq = 0 with V of the coupled modes alone.
class Equations {
 public:
  explicit Equations(const modal::Bank& bank) {
    const modal::NonlinearTerms& terms = *bank.nonlinear;
    const auto modes = static_cast<Index>(bank.mode_count());
    omega2_.resize(modes), decay_.resize(modes), shape_.resize(modes);
    for (Index m = 0; m < modes; ++m) {
      const double turn = 2 * std::numbers::pi * bank.frequency_hz[m];
      decay_[m] = bank.decay_per_s[m];
      omega2_[m] = turn * turn + decay_[m] * decay_[m];
      shape_[m] = bank.shapes[m][2];
    }
    std::vector<std::size_t> lowest(terms.mode_count());
    for (std::size_t i = 0; i < lowest.size(); ++i) lowest[i] = i;
    std::sort(lowest.begin(), lowest.end(),
              [&](std::size_t a, std::size_t b) { return omega2_[terms.modes[a]] < omega2_[terms.modes[b]]; });
    lowest.resize(terms.coupled);
    const auto count = static_cast<Index>(lowest.size()), functions = static_cast<Index>(terms.function_count());
    h_.resize(functions * count, count), g_.resize(functions, count);
    for (Index i = 0; i < count; ++i) {
      coupled_.push_back(static_cast<Index>(terms.modes[lowest[i]]));
      for (Index k = 0; k < functions; ++k) {
        g_(k, i) = terms.g(k, lowest[i]);
        for (Index j = 0; j < count; ++j) h_(k * count + i, j) = terms.h(k, lowest[i], lowest[j]);
      }
    }
  }

  // The sum of the modes' accelerations at the mixer's rate after a blow; the deflection of the struck point goes to
  // `peak_m`.
  [[nodiscard]] Samples heard(double impulse_ns, double& peak_m) const {
    constexpr int kSteps = 4;
    const double dt = 1 / (kRate_hz * kSteps);
    const VectorXd keep = (-2 * dt * decay_).array().exp();
    VectorXd q = VectorXd::Zero(shape_.size()), v = impulse_ns * shape_, f = force(q);
    Samples samples;
    peak_m = 0;
    for (int n = 0; n < static_cast<int>(kWholeSecond_s * kRate_hz) * kSteps; ++n) {
      if (n % kSteps == 0) samples.push_back(-f.sum());
      v += 0.5 * dt * f;  // velocity Verlet
      q += dt * v;
      f = force(q);
      v = keep.cwiseProduct(v + 0.5 * dt * f);
      peak_m = std::max(peak_m, std::abs(q.dot(shape_)));
    }
    return samples;
  }

 private:
  [[nodiscard]] VectorXd force(const VectorXd& q) const {
    VectorXd f = -omega2_.cwiseProduct(q);
    const VectorXd x = q(coupled_), hx = h_ * x;
    const Eigen::Map<const Eigen::MatrixXd> columns(hx.data(), g_.cols(), g_.rows());  // H^k x
    const VectorXd t = columns.transpose() * x;
    f(coupled_) -= g_.transpose() * t + 2 * columns * (g_ * x + t);
    return f;
  }

  VectorXd omega2_, decay_, shape_;
  std::vector<Index> coupled_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> h_;
  Eigen::MatrixXd g_;
};

// Struck so that the point moves by about one thickness.
void expect_the_centroid(const std::string& preset, double x_m, double y_m, double impulse_ns) {
  const modal::Bank bank = struck_bank(preset, x_m, y_m);
  double peak_m = 0;
  const Samples wanted = Equations(bank).heard(impulse_ns, peak_m);
  EXPECT_NEAR(peak_m / bank.nonlinear->thickness_m, 1, 0.2) << preset;
  Voice voice(std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(bank)),
              modal::MaterialScale{}, kRate_hz);
  MixerCounters counters;
  const verb::StrikeVertex blow{.impulse_ns = {0, 0, impulse_ns}, .contact_time_s = 0};
  ASSERT_TRUE(voice.strike(blow, &counters));
  EXPECT_EQ(counters.limited.load(), 0u);
  const std::vector<double> equations = centroids(wanted), coupled = centroids(by_tables(voice, wanted.size()));
  double worst = 0;
  for (std::size_t i = 0; i < equations.size(); ++i) worst = std::max(worst, std::abs(coupled[i] / equations[i] - 1));
  std::printf("%s: %.2f thicknesses, centroid %.0f Hz at first, %.0f Hz after a second, %.1f %% off at most\n",
              preset.c_str(), peak_m / bank.nonlinear->thickness_m, equations.front(), equations.back(), 100 * worst);
  EXPECT_LT(worst, 0.03) << preset;  // 4 to 23 % where the modes glide only
}

TEST(CoupledPresets, TheThunderSheetsCentroidIsThatOfItsEquationsForASecond) {
  expect_the_centroid("thunder-sheet", 0.15, 0.08, 0.015);
}

TEST(CoupledPresets, TheOperaGongsCentroidIsThatOfItsEquationsForASecond) {
  expect_the_centroid("opera-gong", 0.02, 0.01, 0.042);
}

TEST(CoupledPresets, TheTamTamsCentroidIsThatOfItsEquationsForASecond) {
  expect_the_centroid("tam-tam", 0.12, 0.05, 0.27);
}

}  // namespace
}  // namespace ringdown::synth::test
