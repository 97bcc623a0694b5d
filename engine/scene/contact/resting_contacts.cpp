#include "engine/scene/contact/resting_contacts.h"

#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>

namespace ringdown::scene {
namespace {

constexpr double kNoticed = 1.0 / 3;  // smaller relative changes of force or position are not reported

Vec3 mean_point(const RestingContact& rest) {
  Vec3 sum;
  for (const RestingContact::Point& point : rest.points) sum = sum + point.point_m;
  return (1 / static_cast<double>(rest.points.size())) * sum;
}

// A point relative to the body's centre of mass, in the body's axes.
Vec3 in_body(const Motion& motion, Vec3 world_m) {
  return transpose(to_matrix(motion.rotation)) * (world_m - motion.position_m);
}

bool differs(const RestingContact& a, const RestingContact& b) {
  if (std::abs(a.force_n - b.force_n) > kNoticed * std::max(a.force_n, b.force_n)) return true;
  const auto has_moved = [&](BodyId id, const Motion& of_a, const Motion& of_b) {
    if (id >= kFirstStatic) return false;
    const Vec3 in_a = in_body(of_a, mean_point(a)), in_b = in_body(of_b, mean_point(b));
    return length(in_a - in_b) > kNoticed * std::max(length(in_a), length(in_b));
  };
  return has_moved(a.pair.first, a.first, b.first) || has_moved(a.pair.second, a.second, b.second);
}

}  // namespace

RestingContacts::RestingContacts(double step_s)
    : step_s_(step_s), window_(std::max(2, static_cast<int>(std::lround(kRestWindow_s / step_s)))) {}

void RestingContacts::add(const PairContact& contact, std::span<const ContactPoint* const> points) {
  Life& life = lives_[contact.pair];
  life.touches = true;
  life.moves =
      life.moves || length(contact.slide_m_s) > kMinContactSpeed_m_s || contact.max_roll_m_s > kMinContactSpeed_m_s;
  life.latest.pair = contact.pair;
  life.latest.first = contact.first;
  life.latest.second = contact.second;
  life.latest.points.clear();
  for (const ContactPoint* point : points) {
    const double along_ns = dot(point->impulse_ns, point->normal);
    if (!(along_ns > 0)) continue;
    life.impulse_ns += along_ns;
    life.latest.points.push_back({point->point_m, point->normal});
  }
}

void RestingContacts::note_change(BodyPair pair) {
  changed_.push_back(pair.first);
  changed_.push_back(pair.second);
}

// Decides at the end of a window: a pair rests if in that window it did not slide or roll, touched in at least half of
// the steps, and its bodies pressed on each other. The last report is replaced only if the force or the position has
// changed noticeably.
void RestingContacts::judge(BodyPair pair, Life& life) {
  life.latest.force_n = life.impulse_ns / (life.steps * step_s_);
  const bool rests =
      !life.moves && 2 * life.touched >= life.steps && life.latest.force_n > 0 && !life.latest.points.empty();
  if (rests && (!life.reported || differs(life.latest, *life.reported))) {
    life.reported = life.latest;
    note_change(pair);
  } else if (!rests && life.reported) {
    life.reported.reset();
    note_change(pair);
  }
}

// Every pair has a window of its own, in which touches and impulses are added up. Steps in which a pair neither touches
// nor moves do not count, so a pair that has fallen asleep keeps its report. At the end of a window the pair is judged;
// a pair that has not touched in the whole window is forgotten.
std::span<const BodyId> RestingContacts::advance(std::span<const MovedBody> moved) {
  moved_.clear();
  for (const MovedBody& one : moved) moved_.push_back(one.id);
  std::ranges::sort(moved_);
  const auto has_moved = [this](BodyId id) { return std::ranges::binary_search(moved_, id); };
  lives_.erase_if([&](BodyPair pair, Life& life) {
    const bool sleeps = !life.touches && !has_moved(pair.first) && !has_moved(pair.second);
    if (!sleeps) {
      ++life.steps;
      life.touched += life.touches ? 1 : 0;
      life.touches = false;
    }
    if (sleeps || life.steps < window_) return false;
    judge(pair, life);
    const bool over = life.touched == 0;
    life.steps = life.touched = 0;
    life.impulse_ns = 0;
    life.moves = false;
    return over;
  });
  std::ranges::sort(changed_);
  changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
  reported_.swap(changed_);
  changed_.clear();
  return reported_;
}

void RestingContacts::remove(BodyId id) {
  lives_.erase_if([&](BodyPair pair, const Life& life) {
    const bool goes = pair.first == id || pair.second == id;
    if (goes && life.reported) note_change(pair);
    return goes;
  });
}

}  // namespace ringdown::scene
