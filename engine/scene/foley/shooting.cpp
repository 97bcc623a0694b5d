#include "engine/scene/foley/shooting.h"

#include "engine/base/groups.h"
#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>
#include <map>

// Bodies that push each other form an island. The unknowns of an island are its bodies' corrections of velocity and
// spin; what it wants is that all bodies meet their targets, by corrections as small as possible. Both are ways, so
// that one sum of squares weighs them (cost_of). Between two events the end depends smoothly on the start, and
// Levenberg's and Marquardt's method finds the least sum: shots with one start moved a little tell the slopes, where
// bodies that have no neighbour in common are moved together (find_slopes, descend). Blows that come in another order
// make the end jump. If no step down helps, starts are scattered at random over several powers of ten (scatter). At the
// end, targets that are nearly met are met as exactly as the poses are given (sharpen).
//
// Bodies that rock on edges and lean on each other have contacts that begin and end in each step. Three dominoes end an
// interval of 1/24 s up to 1 um farther on if a start moves by 0.3 nm, and each later interval multiplies that. So a
// probe is as long as what is missed, which averages such jumps (probe_of), and islands of many bodies, which more
// rounds bring hardly nearer, get one.
namespace ringdown::scene {
namespace {

constexpr double kMet_m = 5e-6;     // an island is done that misses by less
constexpr double kNear_m = 5e-5;    // an island that misses by less is not scattered, but sharpened
constexpr double kMaxStep_m = 0.1;  // of a shift, so that no body becomes impossibly fast
constexpr double kMinProbe_m = 1e-7, kMaxProbe_m = 1e-3;                  // of a shift that tells a slope
constexpr double kSharpen_m = 1e-7, kExact_m = 1e-8, kSharpTrust = 1e-3;  // of sharpen()
constexpr int kRounds = 4, kSharpRounds = 2;                              // of slopes
constexpr int kSteps = 3, kMaxSteps = 8;                // with the same slopes; more than kSteps if all go well
constexpr double kBetter = 0.7;                         // share of the cost after a step that is worth another round
constexpr int kScattered = 8, kScatters = 2;            // shots of scatter(); how often it is called
constexpr double kScatter_from = -6, kScatter_to = -3;  // powers of ten of its shifts [m]
constexpr double kFirstDamping = 1e-3, kSharpDamping = 1e-6, kMinDamping = 1e-9, kMaxDamping = 1e6;

double size_of(const Shooting::Six& six) {
  double sum = 0;
  for (const double part : six) sum += part * part;
  return std::sqrt(sum);
}

// Solves A x = b for a symmetric positive matrix by Cholesky's decomposition, in place of b. Returns false if the
// matrix is not positive.
bool solve_in_place(std::vector<double>& a, std::vector<double>& b) {
  const std::size_t n = b.size();
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = j; i < n; ++i) {
      double rest = a[i * n + j];
      for (std::size_t k = 0; k < j; ++k) rest -= a[i * n + k] * a[j * n + k];
      if (i == j && !(rest > 0)) return false;
      a[i * n + j] = i == j ? std::sqrt(rest) : rest / a[j * n + j];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= a[i * n + k] * b[k];
    b[i] /= a[i * n + i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) b[i] -= a[k * n + i] * b[k];
    b[i] /= a[i * n + i];
  }
  return true;
}

}  // namespace

Vec3 turn_between(const Rotation& from, const Rotation& to) {
  return to_rotation_vector(normalized(to * inverse(from)));
}

Shooting::Shooting(std::vector<Shooter> bodies, double every_s, Fire fire)
    : bodies_(std::move(bodies)), every_s_(every_s), fire_(std::move(fire)), met_m_(kMet_m), max_probe_m_(kMaxProbe_m) {
  aim_.shifts.resize(bodies_.size(), Six{});
  for (const Shooter& body : bodies_) aim_.asleep.push_back(body.asleep);
}

std::vector<Shooter> Shooting::starts_of(const Aim& aim) const {
  std::vector<Shooter> starts = bodies_;
  for (std::size_t n = 0; n < starts.size(); ++n) {
    const Six& shift = aim.shifts[n];
    Motion& start = starts[n].start;
    starts[n].asleep = aim.asleep[n];
    start.velocity_m_s = start.velocity_m_s + (1 / every_s_) * Vec3{shift[0], shift[1], shift[2]};
    start.spin_rad_s = start.spin_rad_s + (1 / (every_s_ * starts[n].reach_m)) * Vec3{shift[3], shift[4], shift[5]};
  }
  return starts;
}

Shooting::Six Shooting::miss_of(std::size_t n, const Motion& end) const {
  const Vec3 way = end.position_m - bodies_[n].target.position_m;
  const Vec3 turn = bodies_[n].reach_m * turn_between(bodies_[n].target.rotation, end.rotation);
  return {way.x, way.y, way.z, turn.x, turn.y, turn.z};
}

double Shooting::cost_of(const Island& island, const std::vector<Six>& misses, const Aim& aim) const {
  double sum = 0;
  for (const std::size_t n : island.members) {
    const double miss = size_of(misses[n]), shift = trust_share_ * bodies_[n].trust * size_of(aim.shifts[n]);
    sum += miss * miss + shift * shift;
  }
  return sum;
}

bool Shooting::may_help(const Island& island, std::size_t i) const {
  return may_shift(island.members[i]) && std::ranges::any_of(island.near[i], [&](std::size_t j) {
           return size_of(misses_[island.members[j]]) > met_m_;
         });
}

void Shooting::measure(Island& island) const {
  island.cost = cost_of(island, misses_, aim_);
  const auto misses = [this](std::size_t n) { return size_of(misses_[n]) > met_m_; };
  const auto tracked = [this](std::size_t n) { return bodies_[n].tracked; };
  island.open = std::ranges::any_of(island.members, misses) && std::ranges::all_of(island.members, tracked);
}

bool Shooting::any_open() const { return std::ranges::any_of(islands_, &Island::open); }

double Shooting::worst_m(const Island& island) const {
  double worst = 0;
  for (const std::size_t n : island.members) worst = std::max(worst, size_of(misses_[n]));
  return worst;
}

double Shooting::probe_of(const Island& island) const { return std::clamp(worst_m(island), kMinProbe_m, max_probe_m_); }

// Makes islands of the pairs that pushed each other in any of the best shots so far.
void Shooting::group() {
  regroup_ = false;
  Groups<std::size_t> groups(bodies_.size());
  std::map<std::size_t, std::vector<std::size_t>> partners;
  for (const auto& [one, two] : pairs_) {
    groups.join(one, two);
    partners[one].push_back(two);
    partners[two].push_back(one);
  }
  std::map<std::size_t, Island> by_root;
  for (std::size_t n = 0; n < bodies_.size(); ++n) by_root[groups.root(n)].members.push_back(n);
  islands_.clear();
  for (auto& [root, island] : by_root) {
    const std::vector<std::size_t>& members = island.members;
    island.near.resize(members.size());
    for (std::size_t i = 0; i < members.size(); ++i) {
      for (std::size_t j = 0; j < members.size(); ++j) {
        const bool close = i == j || std::ranges::find(partners[members[i]], members[j]) != partners[members[i]].end();
        if (close || members.size() <= kSmall) island.near[i].push_back(j);
      }
    }
    island.color.assign(members.size(), 0);
    for (std::size_t i = 0; i < members.size(); ++i) {
      const auto clashes = [&](std::size_t color) {
        return std::ranges::any_of(island.near[i], [&](std::size_t j) {
          return std::ranges::any_of(island.near[j], [&](std::size_t k) { return k < i && island.color[k] == color; });
        });
      };
      while (clashes(island.color[i])) ++island.color[i];
    }
    island.damping = kFirstDamping;
    measure(island);
    for (const std::size_t n : members) bodies_[n].island = root;
    islands_.push_back(std::move(island));
  }
}

// Tries other starts for all open islands at once, and keeps those of the islands that become better. Returns whether
// one becomes much better.
bool Shooting::attempt(const Aim& tried) {
  const Shot shot = fire_(starts_of(tried));
  std::vector<Six> misses;
  for (std::size_t n = 0; n < bodies_.size(); ++n) misses.push_back(miss_of(n, shot.ends[n]));
  bool better = false, any = false;
  for (Island& island : islands_) {
    if (!island.open) continue;
    if (!(cost_of(island, misses, tried) < island.cost)) {
      island.damping = std::min(10 * island.damping, kMaxDamping);
      continue;
    }
    better = better || cost_of(island, misses, tried) < kBetter * island.cost;
    any = true;
    for (const std::size_t n : island.members) {
      aim_.shifts[n] = tried.shifts[n];
      aim_.asleep[n] = tried.asleep[n];
      misses_[n] = misses[n];
    }
    measure(island);
    island.damping = std::max(0.2 * island.damping, kMinDamping);
  }
  if (!any) return false;
  for (const auto& pair : shot.pairs) {
    if (std::ranges::find(pairs_, pair) != pairs_.end()) continue;
    pairs_.push_back(pair);
    regroup_ = true;
  }
  return better;
}

// A body that lies still may sleep, and then lies heavier when it is struck.
void Shooting::try_sleep() {
  Aim tried = aim_;
  bool any = false;
  for (const Island& island : islands_) {
    if (!island.open) continue;
    for (const std::size_t n : island.members) {
      if (!bodies_[n].rested) continue;
      tried.asleep[n] = !tried.asleep[n];
      any = true;
    }
  }
  if (any) attempt(tried);
}

void Shooting::find_slopes() {
  slopes_.assign(bodies_.size(), {});
  std::size_t colors = 0;
  const auto each_of = [this](std::size_t color, const auto& call) {
    for (const Island& island : islands_) {
      if (!island.open) continue;
      for (std::size_t i = 0; i < island.members.size(); ++i) {
        if (island.color[i] == color && may_help(island, i)) call(island, i);
      }
    }
  };
  for (const Island& island : islands_) {
    if (island.open) colors = std::max(colors, *std::ranges::max_element(island.color) + 1);
  }
  // The bodies of other islands cost less asleep. Without them a step may have other parts, so that the slopes need a
  // shot of their own to compare with.
  Aim base = aim_;
  for (const Island& island : islands_) {
    for (const std::size_t n : island.members) base.asleep[n] = base.asleep[n] || !island.open;
  }
  std::vector<Six> misses = misses_;
  if (base.asleep != aim_.asleep) {
    const Shot shot = fire_(starts_of(base));
    for (std::size_t n = 0; n < bodies_.size(); ++n) misses[n] = miss_of(n, shot.ends[n]);
  }
  for (std::size_t color = 0; color < colors; ++color) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      Aim tried = base;
      bool any = false;
      each_of(color, [&](const Island&, std::size_t) { any = true; });
      if (!any) continue;
      each_of(color,
              [&](const Island& island, std::size_t i) { tried.shifts[island.members[i]][axis] += probe_of(island); });
      const Shot shot = fire_(starts_of(tried));
      each_of(color, [&](const Island& island, std::size_t i) {
        for (const std::size_t j : island.near[i]) {
          const std::size_t other = island.members[j];
          Six slope = miss_of(other, shot.ends[other]);
          for (std::size_t k = 0; k < 6; ++k) slope[k] = (slope[k] - misses[other][k]) / probe_of(island);
          slopes_[island.members[i]][axis].emplace_back(j, slope);
        }
      });
    }
  }
}

// Adds the island's next step to the shifts.
void Shooting::step_down(const Island& island, Aim& tried) const {
  const std::size_t size = 6 * island.members.size();
  std::vector<double> slopes(size * size), normal(size * size), step(size);
  for (std::size_t column = 0; column < size; ++column) {
    for (const auto& [j, slope] : slopes_[island.members[column / 6]][column % 6]) {
      for (std::size_t k = 0; k < 6; ++k) slopes[(6 * j + k) * size + column] = slope[k];
    }
  }
  for (std::size_t row = 0; row < size; ++row) {
    const std::size_t n = island.members[row / 6];
    for (std::size_t k = 0; k < size; ++k) {
      const double slope = slopes[k * size + row];
      if (slope == 0) continue;
      for (std::size_t column = 0; column < size; ++column)
        normal[row * size + column] += slope * slopes[k * size + column];
      step[row] -= slope * misses_[island.members[k / 6]][k % 6];
    }
    const double trust = trust_share_ * bodies_[n].trust, weight = trust * trust;
    step[row] -= weight * aim_.shifts[n][row % 6];
    normal[row * size + row] += weight + island.damping;
  }
  if (!solve_in_place(normal, step)) return;
  for (std::size_t row = 0; row < size; ++row) {
    const std::size_t n = island.members[row / 6];
    if (!slopes_[n][0].empty()) tried.shifts[n][row % 6] += std::clamp(step[row], -kMaxStep_m, kMaxStep_m);
  }
}

bool Shooting::descend() {
  find_slopes();
  bool better = false, goes_well = true;
  for (int k = 0; k < kMaxSteps && (k < kSteps || goes_well) && any_open(); ++k) {
    Aim tried = aim_;
    for (const Island& island : islands_) {
      if (island.open) step_down(island, tried);
    }
    goes_well = attempt(tried);
    better = better || goes_well;
  }
  return better;
}

void Shooting::scatter() {
  for (int k = 0; k < kScattered && any_open(); ++k) {
    const double size_m = std::pow(10, kScatter_from + (kScatter_to - kScatter_from) * k / (kScattered - 1));
    Aim tried = aim_;
    for (const Island& island : islands_) {
      for (std::size_t i = 0; island.open && i < island.members.size(); ++i) {
        if (!may_help(island, i)) continue;
        for (double& shift : tried.shifts[island.members[i]]) shift += size_m * random_.next();
      }
    }
    attempt(tried);
  }
  for (Island& island : islands_) island.damping = kFirstDamping;
}

// Where a start that meets its targets is near, the frames tell it better than the interval before: corrections cost
// nearly nothing here, and what little is missed would grow with each blow to come.
void Shooting::sharpen() {
  met_m_ = kExact_m;
  max_probe_m_ = kMinProbe_m;
  trust_share_ = kSharpTrust;
  for (Island& island : islands_) {
    measure(island);
    island.open = island.open && worst_m(island) > kSharpen_m && worst_m(island) < kNear_m;
    island.damping = kSharpDamping;
  }
  for (int round = 0; round < kSharpRounds && any_open(); ++round) {
    if (!descend()) break;
  }
}

void Shooting::aim() {
  const Shot first = fire_(bodies_);
  for (std::size_t n = 0; n < bodies_.size(); ++n) misses_.push_back(miss_of(n, first.ends[n]));
  pairs_ = first.pairs;
  group();
  if (any_open()) try_sleep();
  int scattered = 0;
  for (int round = 0; round < kRounds && any_open(); ++round) {
    if (regroup_) group();
    const bool better = descend();
    if (regroup_) group();
    for (Island& island : islands_) island.open = island.open && island.members.size() <= kSmall;
    if (better || !any_open()) continue;
    if (scattered == kScatters) break;
    const auto guessed = [this](std::size_t n) { return bodies_[n].guessed; };
    for (Island& island : islands_)
      island.open = island.open && worst_m(island) > kNear_m && std::ranges::none_of(island.members, guessed);
    if (!any_open()) break;
    scatter();
    ++scattered;
  }
  if (regroup_) group();
  sharpen();
  if (regroup_) group();
  std::vector<Shooter> aimed = starts_of(aim_);
  for (std::size_t n = 0; n < aimed.size(); ++n) {
    aimed[n].miss_m = size_of(misses_[n]);
    aimed[n].shift_m = size_of(aim_.shifts[n]);
  }
  bodies_ = std::move(aimed);
}

}  // namespace ringdown::scene
