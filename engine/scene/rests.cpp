#include "engine/scene/rests.h"

#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace ringdown::scene {
namespace {

constexpr double kNoticed = 1.0 / 3;  // a smaller change of force, or of place over size, is not worth telling

Vec3 middle(const Rest& rest) {
  Vec3 sum;
  for (const Rest::Point& point : rest.points) sum = sum + point.point_m;
  return (1 / static_cast<double>(rest.points.size())) * sum;
}

// From the body's centre, in its own axes.
Vec3 seen_by(const Motion& motion, Vec3 world_m) {
  return transpose(to_matrix(motion.rotation)) * (world_m - motion.position_m);
}

bool differs(const Rest& a, const Rest& b) {
  if (std::abs(a.force_n - b.force_n) > kNoticed * std::max(a.force_n, b.force_n)) return true;
  const auto has_moved = [&](BodyId id, const Motion& of_a, const Motion& of_b) {
    if (id >= kFirstStatic) return false;
    const Vec3 in_a = seen_by(of_a, middle(a)), in_b = seen_by(of_b, middle(b));
    return length(in_a - in_b) > kNoticed * std::max(length(in_a), length(in_b));
  };
  return has_moved(a.pair.first, a.first, b.first) || has_moved(a.pair.second, a.second, b.second);
}

}  // namespace

Rests::Rests(double step_s)
    : step_s_(step_s), window_(std::max(2, static_cast<int>(std::lround(kRestWindow_s / step_s)))) {}

void Rests::touch(const Touching& all, std::span<const Touch* const> touches) {
  Life& life = lives_[all.pair];
  life.touches = true;
  life.moves = life.moves || all.slip_m_s > kMinContactSpeed_m_s || all.most_roll_m_s > kMinContactSpeed_m_s;
  life.latest.pair = all.pair;
  life.latest.first = all.first, life.latest.second = all.second;
  life.latest.points.clear();
  for (const Touch* touch : touches) {
    const double along_ns = dot(touch->impulse_ns, touch->normal);
    if (!(along_ns > 0)) continue;
    life.impulse_ns += along_ns;
    life.latest.points.push_back({touch->point_m, touch->normal});
  }
}

void Rests::note(BodyPair pair) {
  changed_.push_back(pair.first);
  changed_.push_back(pair.second);
}

void Rests::look(BodyPair pair, Life& life) {
  life.latest.force_n = life.impulse_ns / (life.steps * step_s_);
  const bool rests =
      !life.moves && 2 * life.touched >= life.steps && life.latest.force_n > 0 && !life.latest.points.empty();
  if (rests && (!life.told || differs(life.latest, *life.told))) {
    life.told = life.latest;
    note(pair);
  } else if (!rests && life.told) {
    life.told.reset();
    note(pair);
  }
}

std::span<const BodyId> Rests::advance(std::span<const Moved> moved) {
  moved_.clear();
  for (const Moved& one : moved) moved_.push_back(one.id);
  std::ranges::sort(moved_);
  const auto has_moved = [this](BodyId id) { return std::ranges::binary_search(moved_, id); };
  for (auto entry = lives_.begin(); entry != lives_.end();) {
    auto& [pair, life] = *entry;
    const bool sleeps = !life.touches && !has_moved(pair.first) && !has_moved(pair.second);
    if (!sleeps) {
      ++life.steps;
      life.touched += life.touches ? 1 : 0;
      life.touches = false;
    }
    if (sleeps || life.steps < window_) {
      ++entry;
      continue;
    }
    look(pair, life);
    const bool over = life.touched == 0;
    life.steps = life.touched = 0;
    life.impulse_ns = 0;
    life.moves = false;
    entry = over ? lives_.erase(entry) : std::next(entry);
  }
  std::ranges::sort(changed_);
  changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
  reported_.swap(changed_);
  changed_.clear();
  return reported_;
}

void Rests::remove(BodyId id) {
  std::erase_if(lives_, [&](const auto& entry) {
    const auto& [pair, life] = entry;
    const bool goes = pair.first == id || pair.second == id;
    if (goes && life.told) note(pair);
    return goes;
  });
}

}  // namespace ringdown::scene
