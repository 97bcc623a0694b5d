// Shapes as they are drawn and picked: made once for each bank or silent body, then immutable. [any]
#pragma once

#include "engine/modal/bank.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace ringdown::viewer {

// Where a corner comes from: it moves as the weighted mean of three points of the bank does.
struct Origin {
  std::array<std::uint32_t, 3> points{};
  std::array<float, 3> weights{1, 0, 0};
};

// V corners and T triangles in the object's frame. A point of the surface where an edge runs is several corners, one
// for each side, so that edges look sharp and all else smooth.
struct DrawnMesh {
  std::vector<glm::vec3> positions;                     // V [m]
  std::vector<glm::vec3> normals;                       // V, unit, outwards
  std::vector<Origin> origins;                          // V; for boxes and spheres each corner's own number
  std::vector<std::array<std::uint32_t, 3>> triangles;  // T, corner numbers, counter-clockwise from outside
  glm::vec3 low_m{0}, high_m{0};                        // the bounding box
};

// Faces that meet at less than this angle are one smooth surface. [rad]
inline constexpr float kCreaseAngle = 0.87F;

// A bank's surface has few triangles; they are drawn as curved ones, each in n^2 pieces with n <= 4, as long as no more
// than kMaxPieces come of it.
inline constexpr std::size_t kMaxPieces = 4096;

// A bank without triangles is drawn as small marks at its points, at most kMaxMarks of them, evenly taken.
inline constexpr std::size_t kMaxMarks = 4096;
DrawnMesh shaded_mesh(const modal::Bank& bank);

DrawnMesh box_mesh(glm::vec3 size_m);   // edges; centred at the origin
DrawnMesh sphere_mesh(float radius_m);  // centred at the origin

// How each of the bank's P points moves in a mode: the mode's shape, scaled so that the point that moves most moves
// by 1. All zero for a mode in which nothing moves. Shared, so that the renderer knows one that it has uploaded.
using Displacement = std::shared_ptr<const std::vector<glm::vec3>>;
// `mode` counts by ascending frequency from 0, as in the protocol, and is less than bank.mode_count().
Displacement mode_displacement(const modal::Bank& bank, std::size_t mode);

// The same for each of a mesh's V corners. Points that `displacement` does not have stand still.
std::vector<glm::vec3> corner_moves(const DrawnMesh& mesh, const std::vector<glm::vec3>& displacement);

// What a displacement of 1 adds to each unit normal, to first order: the derivative of the sum of the areas of the
// triangles at a corner, over the length of that sum. V, for displacements of the mesh's V corners.
std::vector<glm::vec3> normal_changes(const DrawnMesh& mesh, const std::vector<glm::vec3>& moves);

}  // namespace ringdown::viewer
