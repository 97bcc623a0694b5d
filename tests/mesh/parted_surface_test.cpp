// Closed surfaces inside a body's part it: exact volumes, shared nodes, and what is refused.
#include "engine/mesh/surface/parted_surface.h"

#include "engine/mesh/boundary.h"
#include "engine/mesh/fill.h"
#include "engine/mesh/surface/surface_check.h"
#include "engine/mesh/surface/surface_distance.h"
#include "tests/mesh/sample_surfaces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace ringdown {
namespace {

mesh::TriangleMesh block(double half) { return test::box({-half, -half, -half}, {half, half, half}); }

// The volume of each group, and last that of what is in none.
std::vector<double> volumes_of(const mesh::CheckedMesh& mesh) {
  std::vector<double> volumes(mesh.groups.volumes.size() + 1, 0);
  for (Eigen::Index e = 0; e < mesh.mesh.elements.rows(); ++e) {
    const std::int32_t group = mesh.groups.volume_of[static_cast<std::size_t>(e)];
    const mesh::TetMesh one{mesh.mesh.nodes, mesh.mesh.elements.row(e)};
    volumes[group < 0 ? volumes.size() - 1 : static_cast<std::size_t>(group)] += mesh::volume_of(one);
  }
  return volumes;
}

Result<mesh::Filled> filled(const mesh::TriangleMesh& body, const std::vector<mesh::NamedSurface>& inner, double size_m,
                            int order) {
  const Result<mesh::PartedSurface> parted = mesh::part(body, inner, "body");
  if (!parted) return fail(parted.error());
  return mesh::fill_parts(*parted, {size_m, order, mesh::wall_thickness(parted->mesh)}, "body");
}

void expect_volumes(const Result<mesh::Filled>& made, const std::vector<double>& exact, double within) {
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(made->mesh.pieces, 1);
  const std::vector<double> found = volumes_of(made->mesh);
  ASSERT_EQ(found.size(), exact.size());
  for (std::size_t p = 0; p < exact.size(); ++p) EXPECT_NEAR(found[p] / exact[p], 1, within) << p;
}

TEST(PartedSurface, ABoxInABoxHasExactVolumesAndSharesItsNodes) {
  for (const double size_m : {0.0, 0.03}) {
    for (const int order : {1, 3}) {
      const auto made = filled(block(0.05), {{"core", block(0.03)}}, size_m, order);
      expect_volumes(made, {0.06 * 0.06 * 0.06, 0.001 - 0.06 * 0.06 * 0.06}, 1e-9);
      // Nothing but the body's own skin is free.
      for (const mesh::OuterFace& face : mesh::outer_faces(made->mesh.mesh.elements)) {
        for (const std::int32_t n : face.corners)
          EXPECT_NEAR(made->mesh.mesh.nodes.row(n).cwiseAbs().maxCoeff(), 0.05, 1e-9);
      }
    }
  }
}

// Curved elements follow the surface between parts as they follow the skin.
TEST(PartedSurface, CurvedElementsFollowTheSurfaceBetweenParts) {
  const mesh::TriangleMesh outer = test::sphere(0.05, 64), core = test::sphere(0.03, 64);
  const double whole = mesh::diagnose(outer).volume_m3, inside = mesh::diagnose(core).volume_m3;
  expect_volumes(filled(outer, {{"core", core}}, 0.02, 3), {inside, whole - inside}, 2e-3);
}

TEST(PartedSurface, PartsLieInPartsBesideEachOtherAndAroundCavities) {
  const mesh::TriangleMesh left = test::moved(block(0.01), {-0.025, 0, 0}),
                           right = test::moved(block(0.01), {0.025, 0, 0});
  const double body = 0.1 * 0.1 * 0.1, small = 8e-6;
  expect_volumes(filled(block(0.05), {{"a", left}, {"b", right}}, 0.03, 2), {small, small, body - 2 * small}, 1e-9);
  const double shell = 8 * (0.04 * 0.04 * 0.04 - 0.02 * 0.02 * 0.02), core = 8 * 0.02 * 0.02 * 0.02;
  expect_volumes(filled(block(0.05), {{"shell", block(0.04)}, {"core", block(0.02)}}, 0.03, 1),
                 {shell, core, body - shell - core}, 1e-9);
  // A hollow body: the part is what lies between its surface and the cavity.
  const mesh::TriangleMesh hollow = test::united(block(0.05), test::inside_out(block(0.02)));
  expect_volumes(filled(hollow, {{"lining", block(0.03)}}, 0.03, 1),
                 {8 * (0.03 * 0.03 * 0.03 - 0.02 * 0.02 * 0.02), body - 8 * 0.03 * 0.03 * 0.03}, 1e-9);
  // A part with a hollow of its own, which is of the body's material.
  const mesh::TriangleMesh ring = test::united(block(0.04), test::inside_out(block(0.02)));
  expect_volumes(filled(block(0.05), {{"shell", ring}}, 0.03, 1), {shell, body - shell}, 1e-9);
}

// Turned about z: a cup of clay with glaze all around.
TEST(PartedSurface, AGlazedCupHasItsVolumes) {
  const double r = 0.04, h = 0.08, wall = 0.006, glaze = 0.0015;
  const auto profile = [&](double in) {
    return std::vector<std::array<double, 2>>{
        {0, in}, {r - in, in}, {r - in, h - in}, {r - wall + in, h - in}, {r - wall + in, wall - in}, {0, wall - in}};
  };
  const mesh::TriangleMesh cup = test::lathe(profile(0), 64), clay = test::lathe(profile(glaze), 64);
  const double whole = mesh::diagnose(cup).volume_m3, inside = mesh::diagnose(clay).volume_m3;
  const auto made = filled(cup, {{"clay", clay}}, 0.012, 2);
  expect_volumes(made, {inside, whole - inside}, 0.01);
}

TEST(PartedSurface, SurfacesThatCrossTouchOrLieOutsideAreRefused) {
  const auto why = [](const mesh::TriangleMesh& body, const std::vector<mesh::NamedSurface>& inner) {
    const auto parted = mesh::part(body, inner, "body.stl");
    return parted ? std::string("accepted") : parted.error().message;
  };
  EXPECT_NE(why(block(0.05), {{"core.stl", test::moved(block(0.02), {0.04, 0, 0})}})
                .find("the surfaces body.stl and core.stl cross or touch near"),
            std::string::npos);
  EXPECT_NE(why(block(0.05), {{"core.stl", test::moved(block(0.02), {0.03, 0, 0})}}).find("cross or touch"),
            std::string::npos);
  EXPECT_NE(why(block(0.05), {{"a.stl", block(0.02)}, {"b.stl", test::moved(block(0.02), {0.01, 0, 0})}})
                .find("a.stl and b.stl cross or touch"),
            std::string::npos);
  EXPECT_NE(why(block(0.05), {{"core.stl", test::moved(block(0.02), {1, 0, 0})}}).find("lies outside of body.stl"),
            std::string::npos);
  const mesh::TriangleMesh hollow = test::united(block(0.05), test::inside_out(block(0.03)));
  EXPECT_NE(why(hollow, {{"core.stl", block(0.02)}}).find("one of its cavities"), std::string::npos);
  EXPECT_NE(why(block(0.05), {{"a.stl", block(0.02)}, {"a.stl", block(0.01)}}).find("two parts have the surface a.stl"),
            std::string::npos);
}

}  // namespace
}  // namespace ringdown
