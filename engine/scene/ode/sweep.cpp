#include "engine/scene/ode/sweep.h"

#include "engine/scene/rotation.h"

#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

// The body's motion is tried at moments so close to each other that no point moves by more than the sum of both half
// thicknesses in between, so no passage is missed. Only moments at which the ball about the body touches the box about
// the obstacle are tried. Bisection between the first two neighbouring moments without and with an overlap finds the
// first overlap.
namespace ringdown::scene {
namespace {

constexpr int kMaxMoments = 256, kMaxTouches = 16;
constexpr double kApproach = 0.05;  // a touch comes closer if it does so by this share of the body's speed

struct Span {
  double begin_s = 0, end_s = 0;
};

// One of the two bodies along its motion. What does not move stays in its own geometry.
class Flight {
 public:
  explicit Flight(Collider& collider)
      : collider_(collider),
        start_(collider.motion()),
        moves_(collider.awake()),
        geom_(moves_ ? ghost_of(collider.shape) : collider.shape.geom.get()) {
    if (moves_) std::copy_n(dGeomGetOffsetPosition(collider.shape.geom.get()), 3, offset_);
  }

  void go_to(double time_s) {
    if (!moves_) return;
    const Motion motion = collider_.after(start_, time_s);
    const Matrix3 turn = to_matrix(motion.rotation);
    const Vec3 place = motion.position_m + turn * Vec3{offset_[0], offset_[1], offset_[2]};
    const Rotation& r = motion.rotation;
    const dQuaternion q = {r.w, r.x, r.y, r.z};
    dGeomSetPosition(geom_, place.x, place.y, place.z);
    dGeomSetQuaternion(geom_, q);
  }

  [[nodiscard]] const Motion& start() const { return start_; }
  [[nodiscard]] bool moves() const { return moves_; }
  [[nodiscard]] dxGeom* geom() const { return geom_; }

 private:
  const Collider& collider_;
  Motion start_;
  bool moves_;
  dxGeom* geom_;
  dReal offset_[3] = {};
};

bool boxes_overlap(dxGeom* one, dxGeom* other) {
  dReal a[6], b[6];
  dGeomGetAABB(one, a);
  dGeomGetAABB(other, b);
  for (int axis = 0; axis < 6; axis += 2) {
    if (a[axis] > b[axis + 1] || b[axis] > a[axis + 1]) return false;
  }
  return true;
}

std::span<dContactGeom> touches(dxGeom* one, dxGeom* other, std::span<dContactGeom> room) {
  if (!boxes_overlap(one, other)) return {};
  const int count = dCollide(one, other, static_cast<int>(room.size()), room.data(), sizeof(dContactGeom));
  return room.first(static_cast<std::size_t>(count));
}

double deepest(std::span<const dContactGeom> touches) {
  double depth_m = 0;
  for (const dContactGeom& touch : touches) depth_m = std::max<double>(depth_m, touch.depth);
  return depth_m;
}

// Returns when a ball that moves by `velocity_m_s` touches an axis-aligned box; nothing if it does not by `rest_s`.
// ODE's box about a plane is infinite, except along the axis that the plane may be normal to.
std::optional<Span> ball_in_box(Vec3 place_m, Vec3 velocity_m_s, double radius_m, dxGeom* geom, double rest_s) {
  dReal box[6];
  dGeomGetAABB(geom, box);
  Span in{0, rest_s};
  for (int axis = 0; const auto& [place, velocity] :
                     {std::pair{place_m.x, velocity_m_s.x}, {place_m.y, velocity_m_s.y}, {place_m.z, velocity_m_s.z}}) {
    const double low_m = box[2 * axis] - radius_m - place, high_m = box[2 * axis + 1] + radius_m - place;
    ++axis;
    if (velocity == 0) {
      if (low_m > 0 || high_m < 0) return {};
      continue;
    }
    in.begin_s = std::max(in.begin_s, std::min(low_m / velocity, high_m / velocity));
    in.end_s = std::min(in.end_s, std::max(low_m / velocity, high_m / velocity));
  }
  if (!(in.begin_s <= in.end_s)) return {};
  return in;
}

bool comes_closer(std::span<const dContactGeom> touches, const Motion& body, const Motion& obstacle, double speed_m_s) {
  return std::ranges::any_of(touches, [&](const dContactGeom& touch) {
    const Vec3 point{touch.pos[0], touch.pos[1], touch.pos[2]};
    const Vec3 normal{touch.normal[0], touch.normal[1], touch.normal[2]};  // into the body
    return dot(body.velocity_at(point) - obstacle.velocity_at(point), normal) < -kApproach * speed_m_s;
  });
}

}  // namespace

double point_speed(const Collider& collider, const Motion& motion) {
  const double tips_m_s = collider.round ? 0 : length(motion.spin_rad_s) * collider.outer_radius_m;
  return length(motion.velocity_m_s) + tips_m_s;
}

double time_to_meet(Collider& body, Collider& obstacle, double rest_s) {
  Flight flight(body), other(obstacle);
  const double speed_m_s = point_speed(body, flight.start()) + point_speed(obstacle, other.start());
  const double own_m = std::max(body.half_thickness_m, 0.5 * range::kSize_m.low);
  const double thin_m = std::clamp(obstacle.half_thickness_m, 0.5 * range::kSize_m.low, own_m);
  const double reach_m = body.outer_radius_m + (other.moves() ? point_speed(obstacle, other.start()) * rest_s : 0);
  const auto near =
      ball_in_box(flight.start().position_m, flight.start().velocity_m_s, reach_m, obstacle.shape.geom.get(), rest_s);
  if (!near) return rest_s;

  std::array<dContactGeom, kMaxTouches> room;
  flight.go_to(0), other.go_to(0);
  const auto at_start = touches(flight.geom(), other.geom(), room);
  const bool touching = !at_start.empty();
  if (touching && comes_closer(at_start, flight.start(), other.start(), speed_m_s)) return own_m / speed_m_s;
  const double allowed_m = deepest(at_start) + 0.5 * thin_m;
  const auto hits = [&](double time_s) {
    flight.go_to(time_s), other.go_to(time_s);
    const auto found = touches(flight.geom(), other.geom(), std::span(room).first(touching ? kMaxTouches : 1));
    return touching ? deepest(found) > allowed_m : !found.empty();
  };

  const double way_m = speed_m_s * (near->end_s - near->begin_s);
  const int moments = std::clamp(static_cast<int>(std::ceil(way_m / (own_m + thin_m))), 1, kMaxMoments);
  Span between{near->begin_s, near->begin_s};
  for (int k = 1; k <= moments; ++k) {
    between = {between.end_s, near->begin_s + k * (near->end_s - near->begin_s) / moments};
    if (!hits(between.end_s)) continue;
    const double within_s = 0.25 * thin_m / speed_m_s;
    while (between.end_s - between.begin_s > within_s) {
      const double middle_s = 0.5 * (between.begin_s + between.end_s);
      (hits(middle_s) ? between.end_s : between.begin_s) = middle_s;
    }
    const double meet_s = std::max(between.end_s, within_s);
    return meet_s + within_s < rest_s ? meet_s : rest_s;
  }
  return rest_s;
}

}  // namespace ringdown::scene
