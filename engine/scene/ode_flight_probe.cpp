#include "engine/scene/ode_flight_probe.h"

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

// A line along the flight of a ball: its distance from the centre line, and how far ahead of the centre the ball's
// surface is on that line.
struct Line {
  Vec3 aside_m;
  double front_m = 0;
};

// A search along the flight of one body for the first obstacle on any of its lines.
struct Search {
  const Collider* from;
  dxGeom *ray, *sweep;
  Vec3 start_m, direction;
  std::span<const Line> lines;
  double way_m, radius_m;
  double free_m = dInfinity;  // result: the way until the ball is half inside an obstacle, on the line that is worst
};

// Tests one geometry near the flight: ODE's callback.
void look(void* data, dxGeom* one, dxGeom* two) {
  Search& search = *static_cast<Search*>(data);
  dxGeom* geom = one == search.sweep ? two : one;
  const Collider* met = static_cast<const Collider*>(dGeomGetData(geom));
  const bool passes = search.way_m >= search.radius_m + std::min(met->inner_radius_m, search.radius_m);
  if (met == search.from || !passes) return;
  for (const Line& line : search.lines) {
    const Vec3 from = search.start_m + line.aside_m;
    dGeomRaySet(search.ray, from.x, from.y, from.z, search.direction.x, search.direction.y, search.direction.z);
    dContactGeom contact;
    if (dCollide(search.ray, geom, 1, &contact, sizeof contact) == 0) continue;
    search.free_m = std::min(search.free_m, contact.depth - line.front_m + 0.5 * line.front_m);
  }
}

// The centre line, and two rings of lines around it: at half the radius and near the rim.
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

FlightProbe::FlightProbe() : ray_(dCreateRay(nullptr, 1)), sweep_(dCreateBox(nullptr, 1, 1, 1)) {}

// A body is treated as the ball inside it. If the ball moves by less than its own radius in the time left, it cannot
// get lost in a plane nor pass through anything, and the whole time is free. Otherwise rays are cast along the flight,
// from the centre and from two rings about it. The body may fly until, on one of the lines, the ball's surface is
// inside an obstacle by half of its extent on that line. An obstacle into which the ball would not get with its centre
// is skipped, because the contacts at the end of the way find it. A body that already touches an obstacle may be turned
// back by it, so it is looked at again after one radius.
double FlightProbe::free_flight(const Collider& collider, double rest_s, dxSpace* space) const {
  const Motion motion = collider.motion();
  const Vec3 from = motion.position_m, velocity = motion.velocity_m_s;
  const double speed = length(velocity), radius = std::max(collider.inner_radius_m, 0.5 * range::kSize_m.low);
  if (!(speed * rest_s > radius) || !std::isfinite(speed)) return rest_s;
  const Vec3 direction = (1 / speed) * velocity;
  const std::array<Line, kLines> lines = lines_about(direction, radius);
  Search search{&collider, ray_.get(), sweep_.get(), from, direction, lines, speed * rest_s, radius};
  const double reach_m = search.way_m + radius;
  dGeomRaySetLength(search.ray, reach_m);
  const Vec3 middle = from + (0.5 * reach_m) * direction;
  const auto width = [&](double along) { return std::abs(along) * reach_m + 2 * radius; };
  dGeomBoxSetLengths(search.sweep, width(direction.x), width(direction.y), width(direction.z));
  dGeomSetPosition(search.sweep, middle.x, middle.y, middle.z);
  dSpaceCollide2(search.sweep, reinterpret_cast<dxGeom*>(space), &search, look);
  if (search.free_m <= 0.5 * radius) return radius / speed;
  return std::min(rest_s, search.free_m / speed);
}

}  // namespace ringdown::scene
