#include "engine/scene/contact_rules.h"

#include <algorithm>
#include <cmath>

namespace ringdown::scene {
namespace {

// Step times are sums of steps: without this, a repeat time of exactly n steps would sometimes wait for n + 1.
constexpr double kRounding_s = 1e-9;

}  // namespace

SoftConstraint soft_constraint(double spring_n_m, double damper_ns_m, double step_s) {
  const double both = step_s * spring_n_m + damper_ns_m;
  return {step_s * spring_n_m / both, 1 / both};
}

Surface combine(const Surface& a, const Surface& b) {
  return {std::sqrt(a.restitution * b.restitution), std::sqrt(a.friction * b.friction),
          std::max(a.contact_time_s, b.contact_time_s)};
}

bool RepeatFilter::admit(std::uint32_t a, std::uint32_t b, double time_s) {
  const auto [entry, is_new] = last_s_.try_emplace(std::minmax(a, b), time_s);
  if (is_new || entry->second == time_s) return true;
  if (time_s - entry->second < minimum_repeat_s_ - kRounding_s) return false;
  entry->second = time_s;
  return true;
}

void RepeatFilter::forget_old(double time_s) {
  std::erase_if(last_s_, [&](const auto& entry) { return time_s - entry.second > minimum_repeat_s_; });
}

}  // namespace ringdown::scene
