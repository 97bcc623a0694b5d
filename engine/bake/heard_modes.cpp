#include "engine/bake/heard_modes.h"

#include "engine/base/range.h"
#include "engine/materials/importance.h"
#include "engine/modal/hearing/loudness.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::bake {
namespace {

double surface_rms(const std::vector<double>& weights, const Eigen::Ref<const Eigen::VectorXd>& shape) {
  double sum = 0;
  for (std::size_t p = 0; p < weights.size(); ++p) {
    sum += weights[p] * shape.segment<3>(3 * static_cast<Eigen::Index>(p)).squaredNorm();
  }
  return std::sqrt(sum);
}

}  // namespace

std::vector<HeardMode> modes_in_band(const BodyModes& modes, const BodyUnits& units, const LossOf& loss_of,
                                     const Band& band, LeftOut& left_out) {
  std::vector<HeardMode> heard;
  for (Eigen::Index m = 0; m < modes.lambda.size(); ++m) {
    const double lambda = units.lambda() * modes.lambda[m];
    HeardMode mode{.number = m, .lambda = lambda, .loss = loss_of(m, lambda, 0), .frequency_error = modes.errors[m]};
    mode.mode = modal::with_decay(lambda, mode.loss.total_per_s());
    if (mode.mode.frequency_hz == 0) {
      ++left_out.over_damped;
    } else if (mode.mode.frequency_hz < band.low_hz) {
      ++left_out.below_band;
    } else if (mode.mode.frequency_hz > band.high_hz) {
      ++left_out.above_band;
    } else {
      heard.push_back(std::move(mode));
    }
  }
  return heard;
}

bool add_air_loss(HeardMode& mode, const LossOf& loss_of, double air_per_s) {
  mode.loss = loss_of(mode.number, mode.lambda, air_per_s);
  mode.mode = modal::with_decay(mode.lambda, mode.loss.total_per_s());
  return mode.mode.frequency_hz > 0;
}

void order_by_importance(std::vector<HeardMode>& heard, const modal::Bank& bank, const BodyModes& modes,
                         const BodyUnits& units, const std::vector<double>& weights) {
  const modal::Loudness loudness(bank);
  for (std::size_t m = 0; m < heard.size(); ++m) {
    HeardMode& mode = heard[m];
    const double rms = units.shape() * surface_rms(weights, modes.shapes.col(mode.number));
    mode.importance = importance(mode.mode, loudness.pressure_pa(bank, m, {}, mode.mode.frequency_hz), rms);
  }
  std::stable_sort(heard.begin(), heard.end(),
                   [](const HeardMode& a, const HeardMode& b) { return a.importance > b.importance; });
}

double sign_of(const Eigen::Ref<const Eigen::VectorXd>& shape) {
  const double large = 0.999 * shape.cwiseAbs().maxCoeff();
  return *std::find_if(shape.begin(), shape.end(), [large](double x) { return std::abs(x) >= large; }) < 0 ? -1 : 1;
}

Eigen::MatrixXd shapes_of(const std::vector<HeardMode>& heard, const BodyModes& modes) {
  Eigen::MatrixXd shapes(modes.shapes.rows(), static_cast<Eigen::Index>(heard.size()));
  for (std::size_t m = 0; m < heard.size(); ++m) {
    const auto shape = modes.shapes.col(heard[m].number);
    shapes.col(static_cast<Eigen::Index>(m)) = (heard[m].turned ? -1 : 1) * sign_of(shape) * shape;
  }
  return shapes;
}

void add_modes(modal::Bank& bank, const std::vector<HeardMode>& heard, const Eigen::MatrixXd& shapes,
               const modal::Air* air) {
  if (air) bank.radiation = modal::BankRadiation{.air = *air};
  const bool doubtful = std::ranges::any_of(heard, [](const HeardMode& mode) { return !mode.radiation_doubt.empty(); });
  const bool warms = std::ranges::any_of(heard, [](const HeardMode& mode) { return mode.loss.heat_per_s > 0; });
  for (std::size_t m = 0; m < heard.size(); ++m) {
    const HeardMode& mode = heard[m];
    bank.frequency_hz.push_back(mode.mode.frequency_hz);
    bank.decay_per_s.push_back(mode.mode.decay_per_s);
    bank.losses.push_back(mode.loss);
    if (warms) bank.heat.push_back(mode.heat);
    bank.frequency_error.push_back(to_digits(mode.frequency_error, 3));
    const Eigen::VectorXf shape = shapes.col(static_cast<Eigen::Index>(m)).cast<float>();
    for (Eigen::Index row = 0; row < shape.size(); row += 3) {
      bank.shapes.push_back({shape[row], shape[row + 1], shape[row + 2]});
    }
    if (!air) continue;
    bank.radiation->maps.modes.push_back(mode.field);
    bank.radiation->error_db.push_back(to_digits(mode.radiation_error_db, 3));
    if (doubtful) bank.radiation->reason.push_back(mode.radiation_doubt);
  }
}

}  // namespace ringdown::bake
