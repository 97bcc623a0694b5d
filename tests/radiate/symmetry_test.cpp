// Mirror planes: where they are found, and that radiation by a part of the surface is that of the whole.
#include "engine/radiate/symmetry.h"
#include "tests/radiate/shapes.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>

namespace ringdown::symmetry_test {
namespace {

void turn_and_shift(mesh::TriangleMesh& surface) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  surface.nodes = (surface.nodes * turn.transpose()).rowwise() + Eigen::RowVector3d(0.3, -0.1, 0.05);
}

TEST(Symmetry, IsFoundWhereverABodyLies) {
  mesh::TriangleMesh block = box({0.12, 0.05, 0.02}, 0.006), ball = sphere(0.1, 8);
  EXPECT_EQ(radiate::symmetry_of(block).mirrors, 3);
  turn_and_shift(block);
  turn_and_shift(ball);
  EXPECT_EQ(radiate::symmetry_of(block).mirrors, 3);
  EXPECT_EQ(radiate::symmetry_of(ball).mirrors, 3);
}

TEST(Symmetry, IsNotFoundWhereABodyHasNone) {
  mesh::TriangleMesh sheared = box({0.12, 0.05, 0.02}, 0.006), twisted = sheared;
  for (auto node : sheared.nodes.rowwise()) node[0] += 0.1 * node[2];
  EXPECT_EQ(radiate::symmetry_of(sheared).mirrors, 1) << "that across y is left";
  for (auto node : twisted.nodes.rowwise()) node[0] += 0.1 * node[2] + 0.05 * node[1];
  EXPECT_EQ(radiate::symmetry_of(twisted).mirrors, 0);
}

// The power of the difference of two far fields beside that of the first.
double difference_of(const modal::FarField& a, const modal::FarField& b) {
  std::map<int, std::complex<double>> terms;
  double whole = 0, off = 0;
  for (const auto& term : a.terms) terms[term.harmonic] += term.value, whole += std::norm(term.value);
  for (const auto& term : b.terms) terms[term.harmonic] -= term.value;
  for (const auto& [harmonic, value] : terms) off += std::norm(value);
  return off / whole;
}

// Flows that are neither even nor odd in any plane, on a block that lies anyhow: all eight classes take part.
TEST(Symmetry, OfAPartRadiatesAsTheWholeSurface) {
  radiate::Body body{.surface = box({0.12, 0.05, 0.02}, 0.006), .flow = {}, .frequency_hz = {800, 3000, 6000, 9000}};
  turn_and_shift(body.surface);
  body.flow = sample(
      body.surface, 4,
      [](int m, const Eigen::Vector3d& at, const Eigen::Vector3d& normal) {
        return normal[2] * std::cos((20 + 10 * m) * at[0] + 0.7) + normal[0] * std::sin(30 * at[1] - 0.3) +
               normal[1] * at[2];
      },
      0.003);
  const auto part = radiate::solve(body, {}, {}), whole = radiate::solve(body, {}, {.symmetry = false});
  ASSERT_TRUE(part && whole);
  EXPECT_EQ(part->mirrors, 3);
  EXPECT_EQ(whole->mirrors, 0);
  for (std::size_t m = 0; m < 4; ++m) {
    const double off_db = 10 * std::log10(part->modes[m].power_w / whole->modes[m].power_w);
    EXPECT_LE(std::abs(off_db), part->modes[m].error_db + whole->modes[m].error_db) << m;
    const double pattern = difference_of(whole->maps.modes[m], part->maps.modes[m]);
    EXPECT_LT(std::sqrt(pattern), 0.03) << m;
    RecordProperty("db_" + std::to_string(m), std::to_string(off_db));
    RecordProperty("pattern_" + std::to_string(m), std::to_string(std::sqrt(pattern)));
  }
}

}  // namespace
}  // namespace ringdown::symmetry_test
