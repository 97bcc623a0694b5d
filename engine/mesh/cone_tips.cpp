#include "engine/mesh/cone_tips.h"

#include <gmsh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace ringdown::mesh {
namespace {

using Tags = gmsh::vectorpair;  // pairs of dimension and number

constexpr double kTip = 0.15;  // width of the small end as a share of the other's; gmsh 4.8 fails below 0.05

struct PhysicalGroup {
  int dimension = 0, number = 0;
  std::string name;
  std::vector<int> entities;
};

std::vector<PhysicalGroup> all_groups() {
  Tags known;
  gmsh::model::getPhysicalGroups(known);
  std::vector<PhysicalGroup> groups;
  for (const auto& [dimension, number] : known) {
    PhysicalGroup& group = groups.emplace_back();
    group.dimension = dimension;
    group.number = number;
    gmsh::model::getPhysicalName(dimension, number, group.name);
    gmsh::model::getEntitiesForPhysicalGroup(dimension, number, group.entities);
  }
  return groups;
}

void set_groups(const std::vector<PhysicalGroup>& groups) {
  gmsh::model::removePhysicalGroups();
  for (const PhysicalGroup& group : groups) {
    gmsh::model::addPhysicalGroup(group.dimension, group.entities, group.number);
    if (!group.name.empty()) gmsh::model::setPhysicalName(group.dimension, group.number, group.name);
  }
}

// Replaces the entity by its parts in every group that contains it.
void replace(std::vector<PhysicalGroup>& groups, const std::pair<int, int>& entity, const Tags& parts) {
  for (PhysicalGroup& group : groups) {
    if (group.dimension != entity.first || std::erase(group.entities, entity.second) == 0) continue;
    for (const auto& [dimension, number] : parts) {
      if (dimension == group.dimension) group.entities.push_back(number);
    }
  }
}

Tags entities(int dimension) {
  Tags found;
  gmsh::model::getEntities(found, dimension);
  return found;
}

struct Mantle {
  std::array<double, 2> around, along;  // ranges of the mantle's parameters

  [[nodiscard]] static Mantle of(int face) {
    std::vector<double> low, high;
    gmsh::model::getParametrizationBounds(2, face, low, high);
    return {{low.at(0), high.at(0)}, {low.at(1), high.at(1)}};
  }

  [[nodiscard]] static std::array<double, 3> point(int face, double u, double v) {
    std::vector<double> at;
    gmsh::model::getValue(2, face, {u, v}, at);
    return {at.at(0), at.at(1), at.at(2)};
  }

  [[nodiscard]] double width(int face, std::size_t end) const {
    const auto a = point(face, around[0], along[end]), b = point(face, 0.5 * (around[0] + around[1]), along[end]);
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  }

  [[nodiscard]] bool has_tip(int face) const {
    if (around[1] - around[0] < 1.999 * std::numbers::pi) return false;
    const auto [small, large] = std::minmax({width(face, 0), width(face, 1)});  // by value
    return small < kTip * large;
  }
};

// Straight lines on the mantle, at a third and at two thirds of the way around from its seam.
Tags lines_on(int face, const Mantle& mantle) {
  Tags lines;
  for (const double share : {1.0 / 3, 2.0 / 3}) {
    const double u = mantle.around[0] + share * (mantle.around[1] - mantle.around[0]);
    std::array<int, 2> ends{};
    for (std::size_t end = 0; end < 2; ++end) {
      const auto at = Mantle::point(face, u, mantle.along[end]);
      ends[end] = gmsh::model::occ::addPoint(at[0], at[1], at[2]);
    }
    lines.emplace_back(1, gmsh::model::occ::addLine(ends[0], ends[1]));
  }
  return lines;
}

}  // namespace

void cut_cone_tips() {
  std::vector<PhysicalGroup> groups = all_groups();
  bool cut = false;
  for (const auto& face : entities(2)) {
    std::string type;
    gmsh::model::getType(face.first, face.second, type);
    if (type != "Cone") continue;
    const Mantle mantle = Mantle::of(face.second);
    if (!mantle.has_tip(face.second)) continue;
    const Tags bodies = entities(3), faces = entities(2);
    Tags whole, parts;
    std::vector<Tags> becomes;
    gmsh::model::occ::fragment(bodies, lines_on(face.second, mantle), whole, becomes);
    gmsh::model::occ::synchronize();
    std::ranges::set_difference(entities(2), faces, std::back_inserter(parts));
    for (std::size_t k = 0; k < bodies.size(); ++k) replace(groups, bodies[k], becomes.at(k));
    replace(groups, face, parts);
    cut = true;
  }
  if (cut) set_groups(groups);
}

}  // namespace ringdown::mesh
