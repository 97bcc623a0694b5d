// Meshes for drawing and picking: made once for each bank or silent body, then immutable. [any]
#pragma once

#include "engine/modal/bank.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace ringdown::viewer {

// The bank's points that a corner of the mesh follows: it moves by their weighted mean.
struct Origin {
  std::array<std::uint32_t, 3> points{};
  std::array<float, 3> weights{1, 0, 0};
};

// V corners and T triangles in the object's frame. A point on a sharp edge has one corner for each of the smooth
// surfaces that meet there, each with its own normal.
struct DrawnMesh {
  std::vector<glm::vec3> positions;                     // V [m]
  std::vector<glm::vec3> normals;                       // V, unit, outwards
  std::vector<Origin> origins;                          // V; in boxes and spheres each corner has its own point
  std::vector<std::array<std::uint32_t, 3>> triangles;  // T, corner numbers, counter-clockwise from outside
  glm::vec3 low_m{0}, high_m{0};                        // the bounding box
};

// Triangles whose normals differ by less than this angle form one smooth surface. [rad]
inline constexpr float kCreaseAngle = 0.87F;

// A bank's surface has few triangles. Each is drawn as a curved one, cut into n^2 flat pieces: n is 4, or less if that
// would make more than kMaxPieces.
inline constexpr std::size_t kMaxPieces = 4096;

// Returns the mesh of a bank. A bank without triangles is drawn as small octahedra at its points, at most kMaxMarks of
// them at evenly spaced point numbers.
inline constexpr std::size_t kMaxMarks = 4096;
DrawnMesh shaded_mesh(const modal::Bank& bank);

DrawnMesh box_mesh(glm::vec3 size_m);   // edges; centred at the origin
DrawnMesh sphere_mesh(float radius_m);  // centred at the origin

// The displacement of each of the bank's P points in a mode: the mode shape, scaled to a maximum displacement of 1; all
// zero for a mode in which nothing moves. The renderer recognises a displacement it has uploaded by this pointer.
using Displacement = std::shared_ptr<const std::vector<glm::vec3>>;
// `mode` counts by ascending frequency from 0, as in the protocol, and is less than bank.mode_count().
Displacement mode_displacement(const modal::Bank& bank, std::size_t mode);

// Returns the displacement of each of a mesh's V corners. Points beyond the end of `displacement` do not move.
std::vector<glm::vec3> corner_moves(const DrawnMesh& mesh, const std::vector<glm::vec3>& displacement);

// Returns the first-order change of each corner's unit normal under a displacement of 1, V vectors: the derivative of
// the sum of the area vectors of the triangles at the corner, divided by the length of that sum. `moves` are the V
// corners' displacements.
std::vector<glm::vec3> normal_changes(const DrawnMesh& mesh, const std::vector<glm::vec3>& moves);

}  // namespace ringdown::viewer
