#include "engine/scene/overlap.h"

#include "engine/scene/rotation.h"

#include <algorithm>
#include <map>
#include <vector>

// The shifts of bodies follow from pushes at their contact points, as velocities follow from impulses: a push p along
// the normal n shifts a body of mass m by p n/m and turns it by I^-1 (r x p n). Each point asks for a way apart; its
// push is what gives that way, and never pulls. Points are visited in turn, some kSweeps times, each time with what the
// other points' pushes have already done (projected Gauss-Seidel). Points without overlap take part too, because a push
// elsewhere must not press their bodies into each other.
namespace ringdown::scene {
namespace {

constexpr int kSweeps = 10;

// Smaller ways are rounding errors of the solver.
constexpr double kLeast_m = 1e-9;

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

// Where a point of a body has come to.
Vec3 carried(Vec3 point_m, const Motion& before, const Motion& after) {
  return after.position_m +
         to_matrix(after.rotation) * (transpose(to_matrix(before.rotation)) * (point_m - before.position_m));
}

double wanted_m(const Overlap& overlap, Vec3 on_body_m, Vec3 on_other_m) {
  const double too_deep_m = overlap.point.depth_m - overlap.allowed_m;
  const double way_m = too_deep_m > 0 ? std::min(overlap.share * too_deep_m, overlap.most_m) : too_deep_m;
  return way_m - dot(on_body_m - on_other_m, overlap.point.normal);
}

Side side_of(const Collider& collider, Shift& shift, const Motion& motion, Vec3 point_m, Vec3 normal) {
  if (!collider.movable()) return {};
  const Matrix3 frame = to_matrix(motion.rotation);
  const Vec3 across = cross(point_m - motion.position_m, normal);
  return {&shift, 1 / collider.mass_kg, across, frame * (collider.inverse_inertia * (transpose(frame) * across))};
}

}  // namespace

void move_apart(std::span<const Overlap> overlaps, Vec3 gravity_m_s2) {
  std::map<Collider*, Shift> shifts;
  std::vector<Row> rows;
  bool any = false;
  for (const Overlap& overlap : overlaps) {
    const ContactPoint& point = overlap.point;
    const Motion body = overlap.body->motion(), other = overlap.other->motion();
    const Vec3 on_body_m = carried(point.point_m, point.of_body, body);
    const Vec3 on_other_m = overlap.other->body ? carried(point.point_m, point.of_other, other) : point.point_m;
    Row row{point.normal, {}, {}, wanted_m(overlap, on_body_m, on_other_m)};
    row.body = side_of(*overlap.body, shifts[overlap.body], body, on_body_m, point.normal);
    row.other = side_of(*overlap.other, shifts[overlap.other], other, on_other_m, -1 * point.normal);
    any = any || row.wanted_m > kLeast_m;
    rows.push_back(row);
  }
  if (!any) return;
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
    if (!collider->movable()) continue;
    collider->shift(shift.way_m, shift.turn_rad);
    const double gained_j = -collider->mass_kg * dot(gravity_m_s2, shift.way_m);
    if (gained_j > 0) collider->slow_down(gained_j);
  }
}

}  // namespace ringdown::scene
