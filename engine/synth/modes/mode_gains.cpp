#include "engine/synth/modes/mode_gains.h"

#include "engine/synth/kernels/direction_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ringdown::synth {
namespace {

constexpr double kSameDistance = 1e-6;  // relative: absorption is not found anew

}  // namespace

ModeGains::ModeGains(const ModeTable& table)
    : table_(table),
      columns_(table.columns()),
      rows_(aligned_zeros<float>(kRows * table.columns())),
      ranks_(modal::DirectionMap::kGroup * table.directions().groups()) {
  by_rank_ = aligned_zeros<float>(2 * ranks_ + kModePadding);
}

void ModeGains::begin() REALTIME {
  if (!on_) {
    std::fill_n(row(gain_re), columns_, 1.0f);
    std::fill_n(row(gain_im), columns_, 0.0f);
  } else if (moving_) {
    const auto passed = static_cast<float>(passed_);
    float *re = row(gain_re), *im = row(gain_im);
    const float *by_re = row(step_re), *by_im = row(step_im);
    for (std::size_t c = 0; c < columns_; ++c) {
      re[c] += passed * by_re[c];
      im[c] += passed * by_im[c];
    }
  }
}

// Sets out for the goal.
void ModeGains::go(double frames) REALTIME {
  passed_ = 0;
  length_ = frames;
  moving_ = frames > 0;
  on_ = true;
  float *re = row(gain_re), *im = row(gain_im);
  const float *to_re = row(goal_re), *to_im = row(goal_im);
  if (!moving_) {
    std::copy_n(to_re, columns_, re);
    std::copy_n(to_im, columns_, im);
    return;
  }
  const auto per_frame = static_cast<float>(1 / frames);
  float *by_re = row(step_re), *by_im = row(step_im);
  for (std::size_t c = 0; c < columns_; ++c) {
    by_re[c] = per_frame * (to_re[c] - re[c]);  // takes the place of to_re[c]
    by_im[c] = per_frame * (to_im[c] - im[c]);
  }
}

void ModeGains::aim(const Vec3& toward, double distance_m, const modal::AirAbsorption& absorption,
                    double frames) REALTIME {
  begin();
  if (!(std::abs(distance_m - air_distance_m_) <= kSameDistance * distance_m) || !(absorption == air_)) {
    find_absorption(absorption, distance_m, table_.heard_columns().frequencies_hz, columns_, row(air));
    air_distance_m_ = distance_m;
    air_ = absorption;
  }
  const float* const left = row(air);
  float *to_re = row(goal_re), *to_im = row(goal_im);
  const modal::DirectionMap& map = table_.directions();
  if (map.empty()) {
    std::copy_n(left, columns_, to_re);
    std::fill_n(to_im, columns_, 0.0f);
  } else {
    std::array<float, modal::harmonic_count(modal::kMaxHarmonicDegree)> harmonics;
    modal::real_harmonics(toward, std::max(map.degree(), 0), harmonics);
    float *const re = by_rank_.get(), *const im = re + ranks_;
    look_up(map, harmonics.data(), re, im);
    const std::uint32_t* const rank = table_.heard_columns().ranks;
    for (std::size_t c = 0; c < columns_; ++c) {
      to_re[c] = left[c] * re[rank[c]];
      to_im[c] = left[c] * im[rank[c]];
    }
  }
  go(frames);
}

void ModeGains::aim_at_one(double frames) REALTIME {
  begin();
  std::fill_n(row(goal_re), columns_, 1.0f);
  std::fill_n(row(goal_im), columns_, 0.0f);
  go(frames);
}

const ModeFactors* ModeGains::freeze() REALTIME {
  if (!on_) return nullptr;
  begin();
  moving_ = false;
  factors_ = {row(gain_re), row(gain_im)};
  return &factors_;
}

void ModeGains::put(Hearing& hearing, std::size_t offset) const REALTIME {
  if (!on_) {
    hearing.gain_re = hearing.gain_im = hearing.step_re = hearing.step_im = nullptr;
    return;
  }
  hearing.gain_re = row(gain_re);
  hearing.gain_im = row(gain_im);
  hearing.step_re = moving_ ? row(step_re) : nullptr;
  hearing.step_im = moving_ ? row(step_im) : nullptr;
  hearing.offset = static_cast<float>(passed_ + static_cast<double>(offset));
}

}  // namespace ringdown::synth
