#include "clients/plugin/window/mode_glow.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ringdown::plugin {
namespace {

constexpr double kRise_db = 2;  // more than beats and a moved gain add between two pictures

}  // namespace

void ModeGlow::follow(double level_db, double elapsed_s, double loss) {
  for (std::size_t mode = 0; mode < present_.size(); ++mode) {
    present_[mode] *= std::exp(-decays_per_s_[mode] * loss * elapsed_s);
  }
  if (level_db > std::max(level_db_ + kRise_db, kDark_db)) {
    present_ = struck_;
    leading_ = static_cast<std::size_t>(std::max_element(struck_.begin(), struck_.end()) - struck_.begin());
  }
  level_db_ = level_db;
  const double power = std::inner_product(present_.begin(), present_.end(), present_.begin(), 0.0);
  if (!(power > 0)) return;
  const double scale = std::pow(10, level_db / 20) / std::sqrt(power);
  for (double& amplitude : present_) amplitude *= scale;
}

float ModeGlow::brightness(std::size_t mode) const {
  if (mode >= present_.size() || !(present_[mode] > 0)) return 0;
  return static_cast<float>(std::clamp(1 - 20 * std::log10(present_[mode]) / kDark_db, 0.0, 1.0));
}

}  // namespace ringdown::plugin
