#include "engine/mesh/surface/surface_check.h"

#include "tests/mesh/sample_surfaces.h"

#include <gtest/gtest.h>

#include <numbers>

namespace ringdown {
namespace {

using mesh::Fault;

std::size_t count(const mesh::TriangleMesh& mesh, Fault fault) {
  const mesh::SurfaceReport report = mesh::diagnose(mesh);
  const mesh::Finding* found = report.find(fault);
  return found ? found->count : 0;
}

const test::Vec kOrigin(0, 0, 0), kSize(0.3, 0.2, 0.1);
mesh::TriangleMesh block() { return test::box(kOrigin, kSize); }

TEST(Diagnosis, TheDiagnosisFindsNothingInSoundBodies) {
  const mesh::TriangleMesh bodies[] = {block(),
                                       test::cup(0.04, 0.09, 0.003, 24),
                                       test::bowl(0.05, 0.004, 24),
                                       test::sphere(0.05, 24),
                                       test::torus(0.05, 0.01, 12),
                                       test::l_shape(0.2, 0.05, 0.02)};
  for (const auto& body : bodies) {
    const mesh::SurfaceReport report = mesh::diagnose(body);
    for (const auto& finding : report.findings) ADD_FAILURE() << mesh::describe(finding);
    EXPECT_TRUE(report.sound());
    EXPECT_GT(report.volume_m3, 0);
    EXPECT_EQ(report.shells, 1);
  }
  const double a = 2 * 0.05 * 0.05 * 24 * std::sin(2 * std::numbers::pi / 24) / 4;  // of a 24-gon
  EXPECT_NEAR(mesh::diagnose(test::cylinder(0.05, 0.1, 24)).volume_m3, a * 0.1, 1e-12);
  EXPECT_NEAR(mesh::diagnose(block()).area_m2, 2 * (0.06 + 0.02 + 0.03), 1e-15);
}

TEST(Diagnosis, TheDiagnosisCountsEachKindOfFault) {
  EXPECT_EQ(count(test::without(block(), {0, 5}), Fault::kHole), 2u);
  EXPECT_EQ(count(test::with_flipped(test::sphere(0.05, 24), 10), Fault::kFlipped), 53u);
  EXPECT_EQ(count(test::with_copies(block(), 3), Fault::kDuplicate), 4u);
  EXPECT_EQ(count(test::with_fin(block(), {0, 0, -1}), Fault::kCrowdedEdge), 1u);
  EXPECT_EQ(count(test::with_split_side(block(), 3), Fault::kDegenerate), 1u);
  EXPECT_EQ(count(test::with_stray_points(block(), 7), Fault::kUnusedPoints), 7u);
  EXPECT_EQ(count(test::inside_out(block()), Fault::kInsideOut), 1u);
  EXPECT_EQ(count(test::box(kOrigin, {1, 1e-3, 1}), Fault::kSliver), 8u);
}

TEST(Diagnosis, TheDiagnosisTellsShellsApart) {
  const auto inner = test::inside_out(test::moved(test::box(kOrigin, {0.1, 0.1, 0.05}), {0.1, 0.05, 0.02}));
  EXPECT_EQ(count(test::united(block(), inner), Fault::kCavity), 1u);
  EXPECT_TRUE(mesh::diagnose(test::united(block(), inner)).sound());
  EXPECT_NEAR(mesh::diagnose(test::united(block(), inner)).volume_m3, 0.006 - 0.0005, 1e-12);
  EXPECT_EQ(count(test::united(block(), test::inside_out(inner)), Fault::kBuried), 1u);
  const mesh::SurfaceReport told =
      mesh::diagnose(test::united(block(), test::inside_out(inner)), mesh::CavityRule::kInside);
  EXPECT_TRUE(told.find(Fault::kInsideOut) && told.find(Fault::kCavity));
  EXPECT_EQ(count(test::united(block(), test::moved(block(), {1, 0, 0})), Fault::kSeveralShells), 1u);
  EXPECT_GT(count(test::united(block(), test::moved(block(), {0.1, 0.07, 0.03})), Fault::kOverlap), 0u);
  EXPECT_FALSE(mesh::diagnose(test::united(block(), test::moved(block(), {0.1, 0.07, 0.03}))).sound());
}

TEST(Diagnosis, TheDiagnosisFindsWhereASurfaceCutsItself) {
  auto body = test::sphere(0.05, 24);
  body.nodes.row(0) = test::Vec(0, 0, 0.08);  // the lowest point, pulled out of the top
  EXPECT_GT(count(body, Fault::kSelfIntersection), 0u);
  EXPECT_FALSE(mesh::diagnose(body).sound());
}

TEST(Diagnosis, TheDiagnosisKnowsSheetsAndFlatThings) {
  mesh::TriangleMesh square = block();
  square.triangles.conservativeResize(2, 3);
  EXPECT_EQ(count(square, Fault::kSheet), 1u);
  auto flat = block();
  flat.nodes.col(2) *= 1e-8;
  EXPECT_EQ(count(flat, Fault::kNoVolume), 1u);
}

TEST(Diagnosis, TheDiagnosisSaysWhereAndHowLong) {
  const mesh::SurfaceReport report = mesh::diagnose(test::without(block(), {1}));
  const mesh::Finding* hole = report.find(Fault::kHole);
  ASSERT_TRUE(hole);
  EXPECT_NEAR(hole->length_m, 0.3 + 0.2 + std::hypot(0.3, 0.2), 1e-12);
  EXPECT_NE(mesh::describe(*hole).find("1 hole, 0.861 m around, at ("), std::string::npos) << mesh::describe(*hole);
}

}  // namespace
}  // namespace ringdown
