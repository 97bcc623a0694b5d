#include "engine/mesh/gmsh_groups.h"

#include "engine/mesh/boundary.h"

#include <gmsh.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace ringdown::mesh {
namespace {

using GroupTriangle = std::array<std::int32_t, 3>;
using TagNumbers = std::unordered_map<std::size_t, std::int32_t>;  // by gmsh's tags

std::string group_name(int dimension, int tag) {
  std::string name;
  gmsh::model::getPhysicalName(dimension, tag, name);
  return name.empty() ? std::to_string(tag) : name;
}

// check_mesh() keeps the nodes that elements name, in gmsh's order.
TagNumbers numbers_of_tags(const std::vector<std::size_t>& element_nodes) {
  std::vector<std::size_t> tags;
  std::vector<double> coordinates, parametric;
  gmsh::model::mesh::getNodes(tags, coordinates, parametric);
  const std::set<std::size_t> used(element_nodes.begin(), element_nodes.end());
  TagNumbers numbers;
  for (const std::size_t tag : tags) {
    if (used.contains(tag)) numbers.emplace(tag, static_cast<std::int32_t>(numbers.size()));
  }
  return numbers;
}

std::set<GroupTriangle> triangles_of_group(int tag, const TagNumbers& nodes) {
  std::set<GroupTriangle> triangles;
  std::vector<int> entities;
  gmsh::model::getEntitiesForPhysicalGroup(2, tag, entities);
  for (const int entity : entities) {
    std::vector<int> types;
    std::vector<std::vector<std::size_t>> tags, own;
    gmsh::model::mesh::getElements(types, tags, own, 2, entity);
    for (std::size_t t = 0; t < types.size(); ++t) {
      const std::size_t width = tags[t].empty() ? 1 : own[t].size() / tags[t].size();
      for (std::size_t first = 0; first + 2 < own[t].size(); first += width) {
        GroupTriangle triangle{};
        bool known = true;
        for (std::size_t i = 0; i < 3; ++i) {
          const auto found = nodes.find(own[t][first + i]);
          known = known && found != nodes.end();
          triangle[i] = known ? found->second : -1;
        }
        std::sort(triangle.begin(), triangle.end());
        if (known) triangles.insert(triangle);
      }
    }
  }
  return triangles;
}

}  // namespace

MeshGroups groups_of_open_model(int element_type, const CheckedMesh& checked) {
  gmsh::vectorpair groups;
  gmsh::model::getPhysicalGroups(groups);
  std::vector<std::size_t> element_tags, element_nodes;
  gmsh::model::mesh::getElementsByType(element_type, element_tags, element_nodes);
  MeshGroups found;
  if (groups.empty() || static_cast<Eigen::Index>(element_tags.size()) != checked.mesh.elements.rows()) return found;
  TagNumbers number_of;
  for (std::size_t e = 0; e < element_tags.size(); ++e)
    number_of.emplace(element_tags[e], static_cast<std::int32_t>(e));
  const TagNumbers nodes = numbers_of_tags(element_nodes);
  const std::vector<OuterFace> outer = outer_faces(checked.mesh.elements);
  for (const auto& [dimension, tag] : groups) {
    if (dimension == 2) {
      FaceGroup group{.name = group_name(2, tag), .faces = {}};
      const std::set<GroupTriangle> triangles = triangles_of_group(tag, nodes);
      for (const OuterFace& face : outer) {
        if (triangles.contains(face.corners)) group.faces.push_back(4 * face.element + face.opposite);
      }
      std::sort(group.faces.begin(), group.faces.end());
      found.surfaces.push_back(std::move(group));
    }
    if (dimension != 3) continue;
    found.volume_of.resize(element_tags.size(), -1);
    std::vector<int> entities;
    gmsh::model::getEntitiesForPhysicalGroup(3, tag, entities);
    for (const int entity : entities) {
      std::vector<std::size_t> tags, own;
      gmsh::model::mesh::getElementsByType(element_type, tags, own, entity);
      for (const std::size_t element : tags)
        found.volume_of[number_of.at(element)] = static_cast<std::int32_t>(found.volumes.size());
    }
    found.volumes.push_back(group_name(3, tag));
  }
  return found;
}

}  // namespace ringdown::mesh
