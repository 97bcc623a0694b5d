// Bodies of surfaces that are not sound, whose walls are thin.
#include "engine/mesh/stuffing/stuffed_body.h"

#include "engine/mesh/boundary.h"
#include "engine/mesh/surface/surface_check.h"
#include "tests/mesh/sample_surfaces.h"
#include "tests/stress/table_file.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

namespace ringdown {
namespace {

constexpr double kWall = 0.0035;
mesh::TriangleMesh thin_cup() { return test::cup(0.04, 0.09, kWall, 48); }

// One triangle in `every` is missing.
mesh::TriangleMesh torn(const mesh::TriangleMesh& surface, int every) {
  std::vector<int> gone;
  for (int t = 3; t < surface.triangles.rows(); t += every) gone.push_back(t);
  return test::without(surface, gone);
}

// Points less edges plus triangles: 2 for what is closed and has no tunnel, 2 less for each slot through a wall.
std::ptrdiff_t euler_number(const mesh::TriangleMesh& surface) {
  std::set<std::pair<int, int>> edges;
  for (const auto& row : surface.triangles.rowwise()) {
    for (int i = 0; i < 3; ++i) edges.insert(std::minmax(row[i], row[(i + 1) % 3]));
  }
  return surface.nodes.rows() - static_cast<std::ptrdiff_t>(edges.size()) + surface.triangles.rows();
}

TEST(StuffedBody, CopiesAndFoldsAreNoWalls) {
  const mesh::TriangleMesh cup = thin_cup();
  EXPECT_NEAR(mesh::wall_of_soup(cup) / kWall, 1, 0.01);
  const mesh::TriangleMesh copied = test::united(cup, test::moved(cup, {1e-6, 2e-6, 1e-6}));
  EXPECT_NEAR(mesh::wall_of_soup(copied) / kWall, 1, 0.01);
  EXPECT_NEAR(mesh::wall_of_soup(test::united(cup, test::sphere(0.0008, 8))) / kWall, 1, 0.01);
  EXPECT_NEAR(mesh::wall_of_soup(torn(cup, 40)) / kWall, 1, 0.05);
}

// Takes half a minute, so that only the stress tests run it.
TEST(StuffedBody, ATornThinCupIsFilledWithoutASlotInItsWalls) {
  if (!test::long_form()) GTEST_SKIP() << "part of ./run stress";
  const mesh::TriangleMesh cup = test::subdivided(test::subdivided(thin_cup()));
  const Result<mesh::Body> body = mesh::make_stuffed(torn(cup, 90), {.size_m = 0.012, .order = 2}, false, "cup", {});
  ASSERT_TRUE(body) << body.error().message;
  EXPECT_EQ(body->making, mesh::Making::kRefilled);
  EXPECT_EQ(body->wall_elements, 0);
  EXPECT_EQ(body->mesh.pieces, 1);
  const mesh::TriangleMesh skin = mesh::skin_of(body->mesh.mesh);
  EXPECT_EQ(euler_number(skin), 2);
  EXPECT_NEAR(mesh::diagnose(skin).volume_m3 / mesh::diagnose(cup).volume_m3, 1, 0.02);
}

TEST(StuffedBody, WallsThatCannotBeMeshedAreRefusedWithTheSizeTheyTake) {
  const mesh::TriangleMesh sheet = test::without(test::box({0, 0, 0}, {1, 1, 0.0003}), {2});
  const Result<mesh::Body> body = mesh::make_stuffed(sheet, {.size_m = 0.05, .order = 2}, false, "sheet.stl", {});
  ASSERT_FALSE(body);
  EXPECT_EQ(body.error().kind, ErrorKind::too_large);
  for (const char* part : {"sheet.stl", "walls of 0.3 mm", "cells of 0.15 mm", "--force-coarse"}) {
    EXPECT_NE(body.error().message.find(part), std::string::npos) << body.error().message;
  }
}

TEST(StuffedBody, WallsOfWhichNothingWouldBeLeftAreRefusedEvenByForce) {
  const mesh::TriangleMesh sheet = test::without(test::box({0, 0, 0}, {1, 1, 0.0003}), {2});
  const Result<mesh::Body> body = mesh::make_stuffed(sheet, {.size_m = 0.05, .order = 2}, true, "sheet.stl", {});
  ASSERT_FALSE(body);
  EXPECT_EQ(body.error().kind, ErrorKind::too_large);
  EXPECT_NE(body.error().message.find("nothing would be left"), std::string::npos) << body.error().message;
}

}  // namespace
}  // namespace ringdown
