#include "engine/scene/ode/overlap.h"

#include "engine/scene/ode/islands.h"
#include "engine/scene/rotation.h"

#include <algorithm>
#include <array>
#include <map>
#include <vector>

// The shifts of bodies follow from pushes at their contact points, as velocities follow from impulses: a push p along
// the normal n shifts a body of mass m by p n/m and turns it by I^-1 (r x p n). Each point asks for a separation; its
// push produces that separation, and never pulls. Points are visited in turn, kSweeps times at most, each time taking
// into account the pushes at other points (projected Gauss-Seidel). Points without overlap take part too, because a
// push elsewhere must not press their bodies into each other.
namespace ringdown::scene {
namespace {

constexpr int kSweeps = 10;

// Smaller ways are rounding errors of the solver.
constexpr double kMin_m = 1e-9;

struct Shift {
  Vec3 way_m, turn_rad;
};

// One body's side of a contact point.
struct Side {
  Shift* shift = nullptr;  // null: the body cannot move
  double inverse_mass = 0;
  Vec3 across, turns;  // r x n, and I^-1 (r x n)

  [[nodiscard]] double way_m(Vec3 normal) const {
    return shift ? dot(normal, shift->way_m) + dot(across, shift->turn_rad) : 0;
  }
  [[nodiscard]] double give() const { return shift ? inverse_mass + dot(across, turns) : 0; }
  void push(Vec3 normal, double push) const {
    if (!shift) return;
    shift->way_m = shift->way_m + (push * inverse_mass) * normal;
    shift->turn_rad = shift->turn_rad + push * turns;
  }
};

struct Row {
  Vec3 normal;
  Side body, other;
  double wanted_m = 0, push = 0;
};

// The motion of a body in the part of the step. The points of a body follow each other.
class Carried {
 public:
  void set(const Collider& collider, const Motion& before) {
    if (&collider == collider_) return;
    collider_ = &collider;
    moves_ = collider.movable();
    if (!moves_) return;
    before_m_ = before.position_m;
    now_ = collider.motion();
    back_ = transpose(to_matrix(before.rotation));
    frame_ = to_matrix(now_.rotation);
  }
  [[nodiscard]] Vec3 point_m(Vec3 before_m) const {
    return moves_ ? now_.position_m + frame_ * (back_ * (before_m - before_m_)) : before_m;
  }
  [[nodiscard]] const Motion& now() const { return now_; }

 private:
  const Collider* collider_ = nullptr;
  bool moves_ = false;
  Vec3 before_m_;
  Motion now_;
  Matrix3 back_{}, frame_{};
};

double wanted_m(const Overlap& overlap, Vec3 apart_m, const Correction& correction) {
  const ContactPoint& point = *overlap.point;
  const double too_deep_m = point.depth_m - correction.allowed_m;
  const double way_m = too_deep_m > 0 ? std::min(correction.share * too_deep_m, overlap.max_m) : too_deep_m;
  return way_m - dot(apart_m, point.normal);
}

Side side_of(const Collider& collider, Shift& shift, const Motion& motion, Vec3 point_m, Vec3 normal) {
  if (!collider.movable()) return {};
  const Matrix3 frame = to_matrix(motion.rotation);
  const Vec3 across = cross(point_m - motion.position_m, normal);
  return {&shift, 1 / collider.mass_kg, across, frame * (collider.inverse_inertia * (transpose(frame) * across))};
}

}  // namespace

void move_apart(std::span<const Overlap> overlaps, const Correction& correction, const Islands& islands,
                Vec3 gravity_m_s2) {
  Carried of_body, of_other;
  std::vector<const Collider*> asking;  // islands in which some point asks for a way
  const auto wanted_at = [&](const Overlap& overlap) {
    const ContactPoint& point = *overlap.point;
    of_body.set(*overlap.body, point.motions->of_body);
    of_other.set(*overlap.other, point.motions->of_other);
    return wanted_m(overlap, of_body.point_m(point.point_m) - of_other.point_m(point.point_m), correction);
  };
  const auto islands_of = [&](const Overlap& overlap) {
    return std::array{overlap.body->movable() ? islands.island_of(*overlap.body) : nullptr,
                      overlap.other->movable() ? islands.island_of(*overlap.other) : nullptr};
  };
  for (const Overlap& overlap : overlaps) {
    if (wanted_at(overlap) <= kMin_m) continue;
    for (const Collider* island : islands_of(overlap)) asking.push_back(island);
  }
  if (asking.empty()) return;
  std::ranges::sort(asking);
  const auto asks = [&](const Collider* island) { return island && std::ranges::binary_search(asking, island); };
  std::map<Collider*, Shift> shifts;
  std::vector<Row> rows;
  for (const Overlap& overlap : overlaps) {
    if (std::ranges::none_of(islands_of(overlap), asks)) continue;
    const ContactPoint& point = *overlap.point;
    Row row{point.normal, {}, {}, wanted_at(overlap)};
    row.body = side_of(*overlap.body, shifts[overlap.body], of_body.now(), of_body.point_m(point.point_m), row.normal);
    row.other = side_of(*overlap.other, shifts[overlap.other], of_other.now(), of_other.point_m(point.point_m),
                        -1 * row.normal);
    rows.push_back(row);
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (Row& row : rows) {
      const Vec3 back = -1 * row.normal;
      const double way_m = row.body.way_m(row.normal) + row.other.way_m(back);
      const double push = std::max(row.push + (row.wanted_m - way_m) / (row.body.give() + row.other.give()), 0.0);
      row.body.push(row.normal, push - row.push);
      row.other.push(back, push - row.push);
      row.push = push;
    }
  }
  for (auto& [collider, shift] : shifts) {
    if (collider->movable()) collider->lift(shift.way_m, shift.turn_rad, gravity_m_s2);
  }
}

}  // namespace ringdown::scene
