#include "engine/scene/ode/flight_probe.h"

#include "engine/scene/ode/sweep.h"
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

// A line along the flight of a ball: its distance from the centre line, and how far the ball's surface is ahead of its
// centre on that line.
struct Line {
  Vec3 aside_m;
  double front_m = 0;
};

// A search along the flight of one body for the first obstacle on its way.
struct Search {
  Collider* from;
  dxGeom *ray, *box;
  Vec3 start_m, direction;
  const FreshPairs& fresh;
  double way_m, radius_m, rest_s;  // the way of the body's fastest point, and half of the body's thickness
  std::span<const Line> lines = {};
  double free_m = dInfinity;  // result: the way until the ball is half inside an obstacle, on the line that is worst
  double free_s = dInfinity;  // result of a body that is no ball
};

// The obstacle that one of ODE's two geometries belongs to; null where the body cannot pass it in its way.
Collider* obstacle_of(const Search& search, dxGeom* one, dxGeom* two) {
  Collider* met = &collider_of(one == search.box ? two : one);
  const bool passes = search.way_m >= search.radius_m + std::min(met->half_thickness_m, search.radius_m);
  const bool is_met = met != search.from && passes && !search.fresh.are_siblings(search.from->id, met->id);
  return is_met ? met : nullptr;
}

// Tests one geometry near the flight of a ball: ODE's callback.
void look(void* data, dxGeom* one, dxGeom* two) {
  Search& search = *static_cast<Search*>(data);
  const Collider* met = obstacle_of(search, one, two);
  if (!met) return;
  for (const Line& line : search.lines) {
    const Vec3 from = search.start_m + line.aside_m;
    dGeomRaySet(search.ray, from.x, from.y, from.z, search.direction.x, search.direction.y, search.direction.z);
    dContactGeom contact;
    if (dCollide(search.ray, met->shape.geom.get(), 1, &contact, sizeof contact) == 0) continue;
    search.free_m = std::min(search.free_m, contact.depth - line.front_m + 0.5 * line.front_m);
  }
}

// Tests one geometry near the flight of any other body: ODE's callback.
void sweep(void* data, dxGeom* one, dxGeom* two) {
  Search& search = *static_cast<Search*>(data);
  Collider* met = obstacle_of(search, one, two);
  if (met) search.free_s = std::min(search.free_s, time_to_meet(*search.from, *met, search.rest_s));
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

FlightProbe::FlightProbe() : ray_(dCreateRay(nullptr, 1)), box_(dCreateBox(nullptr, 1, 1, 1)) {}

// Puts the box about a ball on its way.
void FlightProbe::set_box(Vec3 from_m, Vec3 way_m, double radius_m) const {
  const Vec3 middle = from_m + 0.5 * way_m;
  const auto width = [&](double along_m) { return std::abs(along_m) + 2 * radius_m; };
  dGeomBoxSetLengths(box_.get(), width(way_m.x), width(way_m.y), width(way_m.z));
  dGeomSetPosition(box_.get(), middle.x, middle.y, middle.z);
}

// If no point of a body moves by more than half of the body's thickness in the time left, the body cannot get lost in a
// plane nor pass through anything, and the whole time is free. The time is also free if the body would enter an
// obstacle by less than half of both thicknesses: the contacts at the end of the flight find it.
//
// For a ball, rays are cast along the flight, from the centre and from two rings about it. The ball may fly until, on
// one of the lines, its surface is inside an obstacle by half of its extent on that line. A ball that already touches
// an obstacle may be turned back by it, so it is checked again after one radius. Any other body is swept (ode/sweep.h),
// because its tips may hit something that its middle misses.
double FlightProbe::free_flight(Collider& collider, double rest_s, dxSpace* space, const FreshPairs& fresh) const {
  const Motion motion = collider.motion();
  const double fastest = point_speed(collider, motion);
  const double radius = std::max(collider.half_thickness_m, 0.5 * range::kSize_m.low);
  if (!(fastest * rest_s > radius) || !std::isfinite(fastest)) return rest_s;
  const Vec3 from = motion.position_m, velocity = motion.velocity_m_s;
  Search search{&collider, ray_.get(), box_.get(), from, {}, fresh, fastest * rest_s, radius, rest_s};
  if (!collider.round) {
    set_box(from, rest_s * velocity, collider.outer_radius_m);
    dSpaceCollide2(search.box, reinterpret_cast<dxGeom*>(space), &search, sweep);
    return std::min(rest_s, search.free_s);
  }
  search.direction = (1 / fastest) * velocity;
  const std::array<Line, kLines> lines = lines_about(search.direction, radius);
  search.lines = lines;
  dGeomRaySetLength(search.ray, search.way_m + radius);
  set_box(from, (search.way_m + radius) * search.direction, radius);
  dSpaceCollide2(search.box, reinterpret_cast<dxGeom*>(space), &search, look);
  if (search.free_m <= 0.5 * radius) return radius / fastest;
  return std::min(rest_s, search.free_m / fastest);
}

}  // namespace ringdown::scene
