// The surface that the air touches when liquid stands in a body or around it. [worker]
//
// The surface consists of the body's skin, cut at the levels, and a flat lid over each cut: the free surface of the
// liquid in a basin, or, if the body stands in a bath, the section of the body.
#pragma once

#include "engine/base/result.h"
#include "engine/liquid/wetted.h"

#include <Eigen/Core>

#include <vector>

namespace ringdown::liquid {

// Points on the free surface of one liquid at which a sum is an integral; normals are -1 along the first axis of the
// liquid's frame.
struct FreeSurface {
  mesh::Points at;        // N x 3, in the frame of the liquid
  Eigen::VectorXd areas;  // N
};

struct AirSurface {
  mesh::TriangleMesh surface;     // closed, counter-clockwise from the air; empty when no part touches the air
  std::vector<Eigen::Index> dry;  // the skin's samples that the air touches
  std::vector<FreeSurface> free;  // for each liquid; empty of a bath and of a full cavity
};

// Fails when a level's line on the skin does not close or cannot be filled.
Result<AirSurface> air_surface_of(const Skin& skin, const std::vector<Wetted>& liquids);

// Triangles between the corners of flat loops; the outer ones run counter-clockwise, holes the other way. Empty when
// loops cross each other.
std::vector<std::array<int, 3>> fill_loops(const std::vector<Eigen::Vector2d>& corners,
                                           const std::vector<std::vector<int>>& loops);

}  // namespace ringdown::liquid
