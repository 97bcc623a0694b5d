// A strike anywhere on the surface, in any direction, gives every mode its amplitude within 3 %: of what bake() makes
// by default, for five unlike bodies, turned and shifted. And the surface that it makes of them is whole.
#include "engine/mesh/gmsh_reader.h"
#include "engine/mesh/stuffing/stuffing.h"
#include "engine/modal/bank_file.h"
#include "tests/bake/amplitude_error.h"
#include "tests/bake/bank_surface.h"
#include "tests/fem/sample_meshes.h"
#include "tests/mesh/stuffing/sample_surfaces.h"
#include "tests/support/temporary_folder.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cstdio>
#include <utility>

namespace ringdown::strike_anywhere_test {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

struct Body {
  mesh::CheckedMesh mesh;
  modal::Material material;
  fem::Element element = fem::Element::kTet20;
};

const fs::path kRoot = RINGDOWN_SOURCE_DIR;
const modal::Material kSteel = {"steel", 200e9, 0.3, 7850, {5, 3e-8}};
const modal::Material kGlass = {"glass", 65e9, 0.22, 2500, {10, 5e-8}};

mesh::CheckedMesh turned(mesh::CheckedMesh mesh) {
  mesh.mesh.nodes = (mesh.mesh.nodes * test::some_turn().transpose()).rowwise() + Eigen::RowVector3d(0.1, -0.2, 0.05);
  return mesh;
}

mesh::CheckedMesh from_geometry(const fs::path& file, double size_m, std::map<std::string, double> parameters = {}) {
  return mesh::read_with_gmsh(kRoot / file, {.unit_m = 0.001,
                                             .mesh_size_m = size_m,
                                             .edge_size_m = 0,
                                             .order = 3,
                                             .parameters = std::move(parameters)})
      .value();
}

// A bowl as a scanner sees it: with holes and doubled patches.
mesh::CheckedMesh scanned_bowl() {
  const test::Soup scan = test::with_doubled(test::with_holes(test::bowl_surface(0.08, 0.011), 0.02), 0.02);
  return test::checked(mesh::stuff(scan, {.size_m = 0.009}).value().mesh);
}

Body body_called(const std::string& name) {
  if (name == "plate") return {test::checked(test::box_mesh({8, 6, 1}, {0.16, 0.11, 0.003})), kSteel};
  if (name == "bar") return {test::checked(test::box_mesh({12, 2, 1}, {0.25, 0.03, 0.015})), kSteel};
  if (name == "tumbler") return {from_geometry("presets/objects/tumbler.geo", 0.012), kGlass};
  if (name == "sphere") return {from_geometry("tests/bench/modal/sphere.geo", 0.06, {{"radius", 150}}), kGlass};
  return {scanned_bowl(), kGlass, fem::Element::kTet10};  // as bake_recipe() takes it for stuffed bodies
}

class StrikeAnywhere : public testing::TestWithParam<const char*> {};

TEST_P(StrikeAnywhere, EveryModeHasItsAmplitude) {
  Body body = body_called(GetParam());
  body.mesh = turned(body.mesh);
  const TemporaryFolder folder;
  const bake::BakeOptions options{.element = body.element, .cache = folder.path()};
  const auto baked = bake::bake(body.mesh, body.material, options, GetParam());
  ASSERT_TRUE(baked) << baked.error().message;
  ASSERT_TRUE(modal::write_bank(baked->bank, folder / "bank.glb"));
  const auto bank = modal::read_bank(folder / "bank.glb");
  ASSERT_TRUE(bank) << bank.error().message;
  const auto solution = test::kept_solution(body.mesh.mesh, body.material, options);
  ASSERT_TRUE(solution) << solution.error().message;
  const auto errors = test::amplitude_errors(*bank, *solution);
  ASSERT_TRUE(errors) << errors.error().message;
  std::printf("%-8s %5zu points %4zu modes %8ju bytes: median %.2f %%, largest %.1f %%, region %.1f %%\n", GetParam(),
              bank->point_count(), bank->mode_count(), fs::file_size(folder / "bank.glb"), 100 * errors->median,
              100 * errors->largest, 100 * errors->worst_region);
  EXPECT_LE(errors->median, 0.03);
  EXPECT_LE(errors->largest, 0.10);
  EXPECT_LE(errors->worst_region, 0.10) << "about " << errors->worst_place.transpose();

  const test::BankSurface surface = test::look_at_surface(*bank);
  EXPECT_EQ(surface.open_edges, 0u);
  EXPECT_EQ(surface.flat, 0u);
  EXPECT_EQ(surface.needles, 0u) << "least angle " << surface.min_angle_deg << " degrees";
  EXPECT_NEAR(surface.volume_error, 0, 0.01);
}

INSTANTIATE_TEST_SUITE_P(FiveBodies, StrikeAnywhere, testing::Values("plate", "bar", "tumbler", "sphere", "scan"),
                         [](const auto& body) { return std::string(body.param); });

}  // namespace
}  // namespace ringdown::strike_anywhere_test
