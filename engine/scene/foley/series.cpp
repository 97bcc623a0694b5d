#include "engine/scene/foley/series.h"

#include <algorithm>

namespace ringdown::scene {
namespace {

constexpr double kStops = 0.5;  // share of the stopping impulse that makes a blow

Vec3 at(const PushSeries& series, std::size_t k) {
  const auto found = series.find(k);
  return found == series.end() ? Vec3{} : found->second;
}

// The load that lasts through two frames: the smaller of both pushes, and at most 1.5 times the weight unless they are
// alike.
Vec3 load_of(Vec3 a, Vec3 b, double weight_ns) {
  constexpr double kAlike = 1.3, kMaxWeights = 1.5;
  const Vec3 smaller = length(a) < length(b) ? a : b;
  const double low = length(smaller), high = std::max(length(a), length(b)), max = kMaxWeights * weight_ns;
  return low <= max || high < kAlike * low ? smaller : (max / low) * smaller;
}

struct Loads {
  Vec3 before, after;
};
Loads loads_around(const PushSeries& series, std::size_t k, double weight_ns) {
  return {k >= 1 ? load_of(at(series, k - 1), at(series, k >= 2 ? k - 2 : 0), weight_ns) : Vec3{},
          load_of(at(series, k + 2), at(series, k + 3), weight_ns)};
}

// A blow J at the share s, with the load b before and a after it (impulses per frame), gives the frames beside it
//
//   J (1 - s) + a (1 - s)^2 / 2 + b (1 - (1 - s)^2 / 2)   and   J s + a (1 - s^2 / 2) + b s^2 / 2
//
// which together are J + a (3/2 - s) + b (1/2 + s).
Blow blow_in(const PushSeries& series, std::size_t k, Vec3 normal, double weight_ns) {
  const Vec3 here = at(series, k), next = at(series, k + 1);
  const auto [before, after] = loads_around(series, k, weight_ns);
  Blow blow{k, 0.5, {}};
  for (int round = 0; round < 4; ++round) {
    const double s = blow.share;
    blow.impulse_ns = here + next - (1.5 - s) * after - (0.5 + s) * before;
    const double whole = dot(blow.impulse_ns, normal);
    const double late = dot(next - (1 - 0.5 * s * s) * after - (0.5 * s * s) * before, normal);
    if (!(whole > 0)) break;
    blow.share = std::clamp(late / whole, 0.0, 1.0);
  }
  return blow;
}

// Returns true if the frames beyond those of a blow show a load only, so that nothing else acted on the pair then.
bool is_alone(const PushSeries& series, const Blow& blow, double weight_ns) {
  constexpr double kSmall = 0.05;
  const std::size_t k = blow.interval;
  const auto [before, after] = loads_around(series, k, weight_ns);
  const Vec3 last = k >= 1 ? at(series, k - 1) - before : Vec3{};
  return std::max(length(last), length(at(series, k + 2) - after)) < kSmall * length(blow.impulse_ns);
}

}  // namespace

// The two frames beside an interval tell the impulse and the time of a blow that is alone. Of blows that follow each
// other closely, the first one alone acts on the frame before it; geometry tells its time, and both together its
// impulse. What it leaves in the frame after it is the next one's.
std::vector<Blow> take_blows(PushSeries& series, const std::map<std::size_t, Approach>& approaches, double weight_ns) {
  constexpr double kNothing =
      0.02;  // share of a blow in the frame before it, below which it may be the next interval's
  std::vector<Blow> blows;
  for (const auto& [k, approach] : approaches) {
    const Vec3 n = approach.normal;
    Blow blow = blow_in(series, k, n, weight_ns);
    const double whole = dot(blow.impulse_ns, n);
    if (!(whole > kStops * approach.stopping_ns)) continue;
    if (!is_alone(series, blow, weight_ns)) {
      if (approaches.contains(k + 1) && blow.share > 1 - kNothing && dot(at(series, k + 2), n) > kNothing * whole)
        continue;
      if (approach.share < blow.share) {
        const double ratio = (1 - blow.share) / (1 - approach.share);
        if (ratio * whole > kStops * approach.stopping_ns) {
          blow.impulse_ns = ratio * blow.impulse_ns;
          blow.share = approach.share;
        }
      }
    }
    series[k] = at(series, k) - (1 - blow.share) * blow.impulse_ns;
    series[k + 1] = at(series, k + 1) - blow.share * blow.impulse_ns;
    blows.push_back(blow);
  }
  return blows;
}

}  // namespace ringdown::scene
