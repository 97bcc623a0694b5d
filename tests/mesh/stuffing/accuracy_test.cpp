#include "engine/mesh/gmsh_reader.h"
#include "engine/mesh/stuffing/stuffing.h"
#include "tests/fem/reference_frequencies.h"
#include "tests/mesh/stuffing/accuracy.h"
#include "tests/mesh/stuffing/dihedral.h"
#include "tests/mesh/stuffing/sample_surfaces.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <map>

namespace ringdown {
namespace {

using namespace test;

// A body that both ways of meshing are given: as a surface of fine triangles, and as a geometry.
struct Shape {
  const char* name;
  Soup surface;
  std::string geometry;       // .geo, without sizes
  std::vector<double> exact;  // [Hz]; empty: a fine mesh of curved elements by gmsh stands for it
  std::array<double, 2> sizes_m;
  double highest_hz;
};

template <class Array>
std::vector<double> ten(const Array& all) {
  return {all.begin(), all.begin() + 10};
}

std::string box_geometry(const char* size) {
  return std::string("SetFactory(\"OpenCASCADE\"); Box(1) = {0, 0, 0, ") + size + "};";
}

// Boxes stand askew in the lattice: straight in it they would come out better than bodies do.
std::vector<Shape> shapes() {
  const auto askew = [](const Vector3& size) { return moved(box_surface(size, 4), {0, 0, 0}, some_turn()); };
  return {
      {"block",
       askew({0.1, 0.08, 0.06}),
       box_geometry("0.1, 0.08, 0.06"),
       ten(reference::kBlock),
       {0.016, 0.008},
       30e3},
      {"sphere",
       sphere_surface(0.1, 256),
       "SetFactory(\"OpenCASCADE\"); Sphere(1) = {0, 0, 0, 0.1};",
       ten(reference::kSphere),
       {0.033, 0.0165},
       20e3},
      {"bar", askew({0.2, 0.01, 0.01}), box_geometry("0.2, 0.01, 0.01"), ten(reference::kBar), {0.005, 0.0025}, 14e3},
      {"plate",
       askew({0.2, 0.2, 0.004}),
       box_geometry("0.2, 0.2, 0.004"),
       ten(reference::kPlate),
       {0.004, 0.002},
       2500},
      {"ring",
       moved(torus_surface(0.1, 0.015, 512, 96), {0, 0, 0}, some_turn()),
       "SetFactory(\"OpenCASCADE\"); Torus(1) = {0, 0, 0, 0.1, 0.015};",
       {},
       {0.008, 0.004},
       12e3}};
}

mesh::TetMesh by_gmsh(const std::string& geometry, double size_m, int order) {
  const TemporaryFolder folder;
  const auto read = mesh::read_with_gmsh(folder.write("shape.geo", geometry),
                                         {.mesh_size_m = size_m, .order = order, .parameters = {}});
  EXPECT_TRUE(read) << read.error().message;
  return read ? read->mesh : mesh::TetMesh{};
}

struct Row {
  Errors errors;
  Eigen::Index elements = 0, unknowns = 0;
  Dihedral angles;
};

Row measure(const mesh::TetMesh& mesh, int order, const std::vector<double>& truth, double highest_hz) {
  Row row;
  row.elements = mesh.elements.rows();
  row.unknowns = 3 * mesh::to_order(mesh, order).nodes.rows();
  row.angles = dihedral(mesh);
  row.errors = errors(frequencies(mesh, order, highest_hz), truth);
  return row;
}

void print(const char* shape, const char* how, int order, const Row& row) {
  std::printf("%s\t%s\t%d\t%ld\t%ld\t%+.3g %%\t%+.3g %%\t%.0f, %.0f\n", shape, how, order, row.elements, row.unknowns,
              100 * row.errors.mean, 100 * row.errors.max, row.angles.min, row.angles.max);
  std::fflush(stdout);
}

// The table of docs/how/logs/stuffing.tsv: RINGDOWN_STUFFING_TABLE=1 stuffing_accuracy_test --gtest_filter=*Table.
// Minutes.
TEST(StuffingAccuracy, StuffedBodiesSoundWithinTheTable) {
  if (!std::getenv("RINGDOWN_STUFFING_TABLE")) GTEST_SKIP() << "only where RINGDOWN_STUFFING_TABLE is set";
  const char* only = std::getenv("RINGDOWN_STUFFING_SHAPE");
  for (const Shape& shape : shapes()) {
    if (only && std::string(only) != shape.name) continue;
    std::vector<double> truth = shape.exact;
    if (truth.empty()) {
      const Eigen::VectorXd fine = frequencies(by_gmsh(shape.geometry, shape.sizes_m[1] * 2, 4), 4, shape.highest_hz);
      ASSERT_GE(fine.size(), 10);
      truth = {fine.begin(), fine.begin() + 10};
    }
    for (const double size : shape.sizes_m) {
      const auto stuffed = mesh::stuff(shape.surface, {.size_m = size});
      ASSERT_TRUE(stuffed) << stuffed.error().message;
      for (const int order : {1, 2, 3}) {
        if (stuffed->mesh.elements.rows() * order * order * order > 300000) continue;
        print(shape.name, "stuffed", order, measure(stuffed->mesh, order, truth, shape.highest_hz));
      }
    }
    for (const int order : {2, 3}) {
      const mesh::TetMesh mesh = by_gmsh(shape.geometry, shape.sizes_m[0] * (order - 1), order);
      print(shape.name, "gmsh", order, measure(mesh, order, truth, shape.highest_hz));
    }
  }
}

// Drawing its edges out again is worth more than any order of elements.
TEST(StuffingAccuracy, DrawingOutSharpEdgesNearlyHalvesTheErrorOfABlockAskew) {
  const Shape block = shapes()[0];
  const auto max = [&](bool sharpen) {
    const auto stuffed = mesh::stuff(block.surface, {.size_m = 0.016, .sharpen = sharpen});
    EXPECT_TRUE(stuffed) << stuffed.error().message;
    return std::abs(errors(frequencies(stuffed->mesh, 2, block.highest_hz), block.exact).max);
  };
  const double sharp = max(true), cut = max(false);
  EXPECT_LT(sharp, 0.55 * cut);
  EXPECT_LT(sharp, 0.06);
}

// A sphere, and what is left of it after damage, in the same lattice.
TEST(StuffingAccuracy, DamageMovesFrequenciesLittle) {
  const Soup sphere = sphere_surface(0.1, 128);
  const auto hz = [](const Soup& soup) {
    const auto stuffed = mesh::stuff(soup, {.size_m = 0.03});
    EXPECT_TRUE(stuffed) << stuffed.error().message;
    return frequencies(stuffed->mesh, 2, 20e3);
  };
  const Eigen::VectorXd sound = hz(sphere);
  const std::vector<double> truth(sound.begin(), sound.begin() + 10);
  const std::pair<const char*, Soup> damaged[] = {{"5 % of its triangles missing", with_holes(sphere, 0.05)},
                                                  {"30 % doubled", with_doubled(sphere, 0.3)},
                                                  {"2 % turned", with_turned(sphere, 0.02)},
                                                  {"inside out", inside_out(sphere)}};
  for (const auto& [name, soup] : damaged) {
    const Errors off = errors(hz(soup), truth);
    std::printf("%s: mean %+.4f %%, most %+.4f %%\n", name, 100 * off.mean, 100 * off.max);
    EXPECT_LT(std::abs(off.max), 0.01) << name;
  }
}

// Two boxes that run through each other along their length are one longer box.
TEST(StuffingAccuracy, BoxesThroughEachOtherAreTheirUnion) {
  const Soup one = box_surface({0.1, 0.08, 0.06}, 4);
  const Soup two = joined(box_surface({0.07, 0.08, 0.06}, 3), moved(box_surface({0.06, 0.08, 0.06}, 2), {0.04, 0, 0}));
  const auto a = mesh::stuff(moved(one, {0, 0, 0}, some_turn()), {.size_m = 0.016});
  const auto b = mesh::stuff(moved(two, {0, 0, 0}, some_turn()), {.size_m = 0.016});
  ASSERT_TRUE(a && b);
  const Eigen::VectorXd sound = frequencies(a->mesh, 2, 30e3);
  const Errors off = errors(frequencies(b->mesh, 2, 30e3), std::vector<double>(sound.begin(), sound.begin() + 10));
  std::printf("union: most %+.5f %%\n", 100 * off.max);
  EXPECT_LT(std::abs(off.max), 1e-3);
}

}  // namespace
}  // namespace ringdown
