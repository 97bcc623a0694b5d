#include "engine/scene/ode_item.h"

#include "engine/scene/rotation.h"

#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

namespace ringdown::scene {
namespace {

constexpr int kLinesInRing = 8, kLines = 1 + 2 * kLinesInRing;

// Along the way of a ball: how far off its middle, and how far ahead of that its surface is.
struct Line {
  Vec3 aside_m;
  double front_m = 0;
};

Vec3 to_vec3(const dReal* v) { return {v[0], v[1], v[2]}; }

// What a ball on its way meets first: along its middle, and along lines around it.
struct Ahead {
  const Item* from;
  dxGeom *ray, *sweep;
  Vec3 start_m, direction;
  std::span<const Line> lines;
  double way_m, radius_m;
  double free_m = dInfinity;  // until it is in there, by half its radius or less off its middle
};

void look(void* data, dxGeom* one, dxGeom* two) {
  Ahead& ahead = *static_cast<Ahead*>(data);
  dxGeom* geom = one == ahead.sweep ? two : one;
  const Item* met = static_cast<const Item*>(dGeomGetData(geom));
  const bool passes = ahead.way_m >= ahead.radius_m + std::min(met->inner_radius_m, ahead.radius_m);
  if (met == ahead.from || !passes) return;
  for (const Line& line : ahead.lines) {
    const Vec3 from = ahead.start_m + line.aside_m;
    dGeomRaySet(ahead.ray, from.x, from.y, from.z, ahead.direction.x, ahead.direction.y, ahead.direction.z);
    dContactGeom contact;
    if (dCollide(ahead.ray, geom, 1, &contact, sizeof contact) == 0) continue;
    ahead.free_m = std::min(ahead.free_m, contact.depth - line.front_m + 0.5 * line.front_m);
  }
}

// The middle, and two rings about it: at half the radius and near the rim.
std::array<Line, kLines> lines_about(Vec3 direction, double radius_m) {
  const Vec3 aside = std::abs(direction.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = (1 / length(cross(direction, aside))) * cross(direction, aside), v = cross(direction, u);
  std::array<Line, kLines> lines{};
  lines[0].front_m = radius_m;
  for (int k = 1; k < kLines; ++k) {
    const double share = k <= kLinesInRing ? 0.5 : 0.93, turn = 2 * std::numbers::pi * k / kLinesInRing;
    lines[k].aside_m = (share * radius_m) * (std::cos(turn) * u + std::sin(turn) * v);
    lines[k].front_m = radius_m * std::sqrt(1 - share * share);
  }
  return lines;
}

}  // namespace

void BodyDeleter::operator()(dxBody* body) const { dBodyDestroy(body); }

bool Item::movable() const { return body && !dBodyIsKinematic(body.get()); }

bool Item::awake() const { return movable() && dBodyIsEnabled(body.get()); }

Motion Item::motion() const {
  if (!body) return {};
  const dReal* q = dBodyGetQuaternion(body.get());
  return {to_vec3(dBodyGetPosition(body.get())),
          {q[1], q[2], q[3], q[0]},
          to_vec3(dBodyGetLinearVel(body.get())),
          to_vec3(dBodyGetAngularVel(body.get()))};
}

void Item::move(const Motion& motion) {
  const Rotation r = normalized(motion.rotation);
  const dQuaternion q = {r.w, r.x, r.y, r.z};
  dBodySetPosition(body.get(), motion.position_m.x, motion.position_m.y, motion.position_m.z);
  dBodySetQuaternion(body.get(), q);
  if (!movable()) return;
  dBodySetLinearVel(body.get(), motion.velocity_m_s.x, motion.velocity_m_s.y, motion.velocity_m_s.z);
  dBodySetAngularVel(body.get(), motion.spin_rad_s.x, motion.spin_rad_s.y, motion.spin_rad_s.z);
  dBodyEnable(body.get());
}

void Item::set_mass(const RigidMass& rigid) {
  const Matrix3& i = rigid.inertia_kg_m2;
  dMass mass;
  dMassSetParameters(&mass, rigid.mass_kg, 0, 0, 0, i[0][0], i[1][1], i[2][2], i[0][1], i[0][2], i[1][2]);
  dBodySetMass(body.get(), &mass);
  mass_kg = rigid.mass_kg;
  inertia = i;
  inverse_inertia = inverse(i);
}

void Item::add_torque(Vec3 torque_nm) { dBodyAddTorque(body.get(), torque_nm.x, torque_nm.y, torque_nm.z); }

Item::State Item::state() const {
  return {motion(), to_vec3(dBodyGetForce(body.get())), to_vec3(dBodyGetTorque(body.get())), awake()};
}

void Item::restore(const State& state) {
  move(state.motion);
  dBodySetForce(body.get(), state.force_n.x, state.force_n.y, state.force_n.z);
  dBodySetTorque(body.get(), state.torque_nm.x, state.torque_nm.y, state.torque_nm.z);
  if (!state.awake) dBodyDisable(body.get());
}

Feelers::Feelers() : ray(dCreateRay(nullptr, 1)), sweep(dCreateBox(nullptr, 1, 1, 1)) {}

double inner_radius(const CollisionShape& shape) {
  if (shape.type == ShapeType::sphere) return shape.radius_m;
  if (shape.type == ShapeType::box) return 0.5 * std::min({shape.size_m.x, shape.size_m.y, shape.size_m.z});
  double radius = dInfinity;
  for (const auto& [a, b, c] : shape.triangles) {
    const Vec3 area = cross(shape.points[b] - shape.points[a], shape.points[c] - shape.points[a]);
    if (length(area) > 0) radius = std::min(radius, std::abs(dot(area, shape.points[a])) / length(area));
  }
  return std::isfinite(radius) ? radius : 0;
}

double inner_radius(const StaticDescription& description) {
  const Vec3 size = description.size_m;
  return description.type == StaticType::plane ? dInfinity : 0.5 * std::min({size.x, size.y, size.z});
}

double free_flight(const Item& item, double rest_s, dxSpace* space, const Feelers& feelers) {
  const Motion motion = item.motion();
  const Vec3 from = motion.position_m, velocity = motion.velocity_m_s;
  const double speed = length(velocity), radius = std::max(item.inner_radius_m, 0.5 * range::kSize_m.low);
  if (!(speed * rest_s > radius) || !std::isfinite(speed)) return rest_s;
  const Vec3 direction = (1 / speed) * velocity;
  const std::array<Line, kLines> lines = lines_about(direction, radius);
  Ahead ahead{&item, feelers.ray.get(), feelers.sweep.get(), from, direction, lines, speed * rest_s, radius};
  const double reach_m = ahead.way_m + radius;
  dGeomRaySetLength(ahead.ray, reach_m);
  const Vec3 middle = from + (0.5 * reach_m) * direction;
  const auto width = [&](double along) { return std::abs(along) * reach_m + 2 * radius; };
  dGeomBoxSetLengths(ahead.sweep, width(direction.x), width(direction.y), width(direction.z));
  dGeomSetPosition(ahead.sweep, middle.x, middle.y, middle.z);
  dSpaceCollide2(ahead.sweep, reinterpret_cast<dxGeom*>(space), &ahead, look);
  if (ahead.free_m <= 0.5 * radius) return radius / speed;
  return std::min(rest_s, ahead.free_m / speed);
}

}  // namespace ringdown::scene
