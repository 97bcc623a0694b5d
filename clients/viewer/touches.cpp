#include "clients/viewer/touches.h"

#include <algorithm>
#include <cmath>

namespace ringdown::viewer {
namespace {

using protocol::Request;
using protocol::SetBow;
using protocol::SetCoupling;

protocol::ObjectRef by_name(const std::string& name) { return {name, std::nullopt}; }

bool ends(const SetBow& bow) { return bow.verb.force_n == 0; }
bool ends(const SetCoupling& coupling) { return coupling.verb.stiffness == 0; }
SetBow ended(const SetBow& bow) { return lifted(bow); }
SetCoupling ended(const SetCoupling& coupling) { return separated(coupling); }

template <class Kind>
auto find_like(const std::vector<Kind>& all, const Kind& one) {
  return std::ranges::find_if(
      all, [&](const Kind& other) { return other.object == one.object && other.verb.number == one.verb.number; });
}

template <class Kind>
void follow_in(std::vector<Kind>& all, const Kind& one) {
  const auto at = all.begin() + (find_like(all, one) - all.cbegin());
  if (ends(one)) {
    if (at != all.end()) all.erase(at);
  } else if (at != all.end()) {
    *at = one;
  } else {
    all.push_back(one);
  }
}

template <class Kind>
Request reverting_in(const std::vector<Kind>& all, const Kind& one) {
  const auto known = find_like(all, one);
  return known == all.end() ? ended(one) : *known;
}

// Returns the part of `way` that lies in the surface, as a unit vector; any direction of the surface if there is none.
Vec3 along_surface(Vec3 way, Vec3 normal) {
  const auto part = [&](Vec3 v) { return v - dot(v, normal) * normal; };
  const double least = std::min({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)});
  const Vec3 axis = least == std::abs(normal.x)   ? Vec3{1, 0, 0}
                    : least == std::abs(normal.y) ? Vec3{0, 1, 0}
                                                  : Vec3{0, 0, 1};
  const Vec3 tangent = length(part(way)) > 1e-3 * length(way) ? part(way) : part(axis);
  return (1 / length(tangent)) * tangent;
}

}  // namespace

protocol::HitMallet mallet_at(const SurfacePoint& at, double speed_m_s, synth::verb::Mallet mallet) {
  mallet.point_m = at.point_m;
  mallet.velocity_m_s = -speed_m_s * at.normal;
  return {by_name(at.object), mallet};
}

SetBow bow_at(const SurfacePoint& at, Vec3 way, synth::verb::Bow bow) {
  bow.point_m = at.point_m;
  bow.direction = along_surface(way, at.normal);
  bow.number = Touches::kFirstNumber;
  return {by_name(at.object), bow};
}

SetCoupling coupling_of(const SurfacePoint& at, const SurfacePoint& other, synth::verb::Couple coupling) {
  coupling.point_m = at.point_m;
  coupling.direction = -1.0 * at.normal;
  coupling.other_point_m = other.point_m;
  return {by_name(at.object), coupling, by_name(other.object)};
}

SetBow lifted(SetBow bow) {
  bow.verb.force_n = 0;
  return bow;
}

SetCoupling separated(SetCoupling coupling) {
  coupling.verb.stiffness = 0;
  return coupling;
}

void Touches::follow(const Request& request) {
  if (const auto* bow = request.get_if<SetBow>()) follow_in(bows_, *bow);
  if (const auto* coupling = request.get_if<SetCoupling>()) follow_in(couplings_, *coupling);
}

Request Touches::reverting(const Request& request) const {
  if (const auto* bow = request.get_if<SetBow>()) return reverting_in(bows_, *bow);
  if (const auto* coupling = request.get_if<SetCoupling>()) return reverting_in(couplings_, *coupling);
  return request;
}

void Touches::keep(const std::function<bool(const std::string& object)>& exists) {
  std::erase_if(bows_, [&](const SetBow& bow) { return !exists(bow.object.name); });
  std::erase_if(couplings_,
                [&](const SetCoupling& one) { return !exists(one.object.name) || !exists(one.other.name); });
}

const SetBow* Touches::bow_of(const std::string& object) const {
  const auto found = std::ranges::find_if(bows_, [&](const SetBow& bow) { return bow.object.name == object; });
  return found == bows_.end() ? nullptr : &*found;
}

const SetCoupling* Touches::coupling(std::uint32_t number) const {
  const auto found =
      std::ranges::find_if(couplings_, [&](const SetCoupling& one) { return one.verb.number == number; });
  return found == couplings_.end() ? nullptr : &*found;
}

std::uint32_t Touches::free_number() const {
  std::uint32_t number = kFirstNumber;
  while (coupling(number)) ++number;
  return number;
}

}  // namespace ringdown::viewer
