// Mesh sizes that are chosen, errors that are asked for, and previews.
#include "engine/bake/bake_object.h"

#include "engine/mesh/gmsh_reader.h"
#include "engine/modal/bank_file.h"
#include "tests/fem/reference_frequencies.h"
#include "tests/fem/sample_meshes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <span>
#include <utility>

namespace ringdown::refine_test {
namespace {

using test::TemporaryFolder;

const modal::Material kSteel{
    .name = "steel", .youngs_modulus_pa = 200e9, .poisson_ratio = 0.3, .density_kg_m3 = 7850, .damping = {}};
const std::string kBlock = "SetFactory(\"OpenCASCADE\"); Box(1) = {0, 0, 0, 0.1, 0.08, 0.06};\n";
const std::string kSphere = "SetFactory(\"OpenCASCADE\"); Sphere(1) = {0, 0, 0, 0.1};\n";
const std::string kPlate = "SetFactory(\"OpenCASCADE\"); Box(1) = {0, 0, 0, 0.2, 0.2, 0.004};\n";

bake::ObjectRecipe recipe_of(const std::filesystem::path& geometry, fem::Element element, double top_hz) {
  bake::ObjectRecipe recipe{.name = "body", .geometry = geometry};
  recipe.options.element = element;
  recipe.options.band_high_hz = top_hz;
  recipe.meshing.order = fem::order_of(element);
  return recipe;
}

// A mesh file of straight elements, in gmsh's format.
std::filesystem::path write_mesh(const TemporaryFolder& folder, const mesh::TetMesh& mesh) {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + std::to_string(mesh.nodes.rows()) + "\n";
  for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n) {
    text += std::to_string(n + 1);
    for (int i = 0; i < 3; ++i) text += " " + std::to_string(mesh.nodes(n, i));
    text += "\n";
  }
  text += "$EndNodes\n$Elements\n" + std::to_string(mesh.elements.rows()) + "\n";
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    text += std::to_string(e + 1) + " 4 2 1 1";
    for (int i = 0; i < 4; ++i) text += " " + std::to_string(mesh.elements(e, i) + 1);
    text += "\n";
  }
  return folder.write("body.msh", text + "$EndElements\n");
}

TEST(BodyShape, TheShapeOfABoxIsItsOwn) {
  const auto shape = bake::measure_shape(test::box_mesh({3, 2, 2}, {0.3, 0.2, 0.1}));
  EXPECT_NEAR(shape.volume_m3, 6e-3, 1e-12);
  EXPECT_NEAR(shape.thickness_m, 2 * 6e-3 / 0.22, 1e-12);
  EXPECT_NEAR(shape.width_m, 0.2, 1e-12);
}

// A disc of 100 x 1 mm. What its file says of mesh_size counts as far as it uses it; set to a value from outside, it is
// the longest edge in either case.
TEST(MeshChoice, AMeshSizeThatAFileDoesNotUseIsChosenOrTaken) {
  const TemporaryFolder folder;
  const std::string disc = "Cylinder(1) = {0, 0, 0, 0, 0, 1, 50};\n", start = "SetFactory(\"OpenCASCADE\");\n";
  const auto elements = [&](const std::string& text, std::map<std::string, double> parameters = {}) -> double {
    bake::ObjectRecipe recipe = recipe_of(folder.write("disc.geo", text), fem::Element::kTet20, 10e3);
    recipe.meshing.unit_m = 0.001;
    recipe.meshing.parameters = std::move(parameters);
    const auto forecast = bake::forecast(recipe, kSteel);
    EXPECT_TRUE(forecast) << text;
    return forecast ? static_cast<double>(forecast->mesh.mesh.elements.rows()) : 0;
  };
  const std::string unused = start + "DefineConstant[ mesh_size = 30 ];\n" + disc;
  const std::string used = unused + "MeshSize{ PointsOf{ Volume{1}; } } = mesh_size; Mesh.MeshSizeMax = mesh_size;\n";
  const double chosen = elements(start + disc);
  EXPECT_EQ(elements(unused), chosen);
  EXPECT_LT(elements(used), 0.5 * chosen);
  // One layer of prisms between equilateral triangles, three tetrahedra each.
  for (const double edge : {4.0, 8.0}) {
    const double triangles = std::numbers::pi * 50 * 50 / (std::sqrt(3) / 4 * edge * edge);
    EXPECT_NEAR(elements(unused, {{"mesh_size", edge}}) / (3 * triangles), 1, 0.2) << edge;
  }
}

TEST(MeshChoice, TheChosenSizeFollowsTheShortestWave) {
  const bake::BodyShape plate{.volume_m3 = 1.6e-4, .thickness_m = 0.004, .width_m = 0.2};
  const bake::BodyShape block{.volume_m3 = 4.8e-4, .thickness_m = 0.0255, .width_m = 0.08};
  const auto thin = bake::choose_mesh(plate, kSteel, 8000, 3, 1e9),
             thick = bake::choose_mesh(block, kSteel, 50e3, 3, 1e9);
  const double stiffness = 200e9 * std::pow(0.004, 3) / 12 / 0.91, omega = 16e3 * std::numbers::pi;
  const double bending = 2 * std::numbers::pi / std::pow(7850 * 0.004 * omega * omega / stiffness, 0.25);
  EXPECT_NEAR(thin.shortest_wave_m / bending, 1, 1e-9);
  EXPECT_NEAR(thick.shortest_wave_m, std::sqrt(200e9 / 2.6 / 7850) / 50e3, 1e-9);
  // Bending waves shorten with the root of the frequency, shear waves with the frequency itself.
  EXPECT_NEAR(bake::choose_mesh(plate, kSteel, 32e3, 3, 1e9).size_m / thin.size_m, 0.5, 0.05);
  EXPECT_NEAR(bake::choose_mesh(block, kSteel, 100e3, 3, 1e9).size_m / thick.size_m, 0.5, 1e-9);
  EXPECT_LT(bake::choose_mesh(block, kSteel, 50e3, 2, 1e9).size_m, thick.size_m);
  EXPECT_NEAR(thin.edge_size_m, 0.004, 1e-9);
}

TEST(MeshChoice, TheChosenSizeNeverRunsAway) {
  const bake::BodyShape rock{.volume_m3 = 1000, .thickness_m = 3, .width_m = 10};
  const auto choice = bake::choose_mesh(rock, kSteel, 20e3, 3, 1e5);
  EXPECT_TRUE(choice.bounded);
  EXPECT_NEAR(bake::estimated_unknowns(rock, choice.size_m, 3), 1e5, 1);
}

void expect_close(const modal::Bank& bank, std::span<const double> exact) {
  std::vector<double> found = bank.frequency_hz;
  std::sort(found.begin(), found.end());
  ASSERT_GE(found.size(), exact.size());
  for (std::size_t m = 0; m < exact.size(); ++m) {
    EXPECT_NEAR(found[m] / exact[m], 1, m < 10 ? 2e-4 : 1e-3) << m;
  }
  const double truth = found[exact.size() - 1] / exact.back() - 1;
  EXPECT_GT(modal::error_spread(bank.frequency_error)->largest, truth);
}

// No size is named: the band's top, just above the fiftieth mode, is what chooses it.
TEST(ChosenMesh, AChosenMeshKeepsFiftyModesOfABlockWithinATenthOfAPercent) {
  const TemporaryFolder folder;
  const auto object = bake::bake_recipe(recipe_of(folder.write("b.geo", kBlock), fem::Element::kTet20, 50e3), kSteel);
  ASSERT_TRUE(object) << object.error().message;
  ASSERT_TRUE(object->choice);
  expect_close(object->baked.bank, reference::kBlock);
}

TEST(ChosenMesh, AChosenMeshKeepsFiftyModesOfASphereWithinATenthOfAPercent) {
  const TemporaryFolder folder;
  const auto object = bake::bake_recipe(recipe_of(folder.write("s.geo", kSphere), fem::Element::kTet20, 28720), kSteel);
  ASSERT_TRUE(object) << object.error().message;
  expect_close(object->baked.bank, reference::kSphere);
}

// Twist lets go within a thickness of a plate's edges; larger elements there leave 0.3 % in the first mode.
TEST(ChosenMesh, AChosenMeshIsFinerAlongTheSharpEdgesOfAPlate) {
  const TemporaryFolder folder;
  const auto path = folder.write("p.geo", kPlate);
  const auto object = bake::bake_recipe(recipe_of(path, fem::Element::kTet20, 1900), kSteel);
  ASSERT_TRUE(object) << object.error().message;
  EXPECT_LT(object->choice->edge_size_m, 0.3 * object->choice->size_m);
  const std::span first(reference::kPlate.data(), 10);
  std::vector<double> found = object->baked.bank.frequency_hz;
  std::sort(found.begin(), found.end());
  for (std::size_t m = 0; m < first.size(); ++m) EXPECT_NEAR(found[m] / first[m], 1, 1e-3) << m;
}

TEST(ChosenMesh, AChosenMeshLeavesAGeometryThatNamesItsSizeAlone) {
  const TemporaryFolder folder;
  const auto path = folder.write(
      "b.geo", "DefineConstant[ mesh_size = 0.03 ];\n" + kBlock + "MeshSize{ PointsOf{ Volume{1}; } } = mesh_size;\n");
  const auto object = bake::bake_recipe(recipe_of(path, fem::Element::kTet10, 20e3), kSteel);
  ASSERT_TRUE(object) << object.error().message;
  EXPECT_FALSE(object->choice);
}

TEST(AskedError, ABakeWithAnAskedErrorMeshesAGeometryAgainUntilItHolds) {
  const TemporaryFolder folder;
  auto recipe = recipe_of(folder.write("b.geo", kBlock), fem::Element::kTet10, 25e3);
  recipe.meshing.mesh_size_m = 0.05;
  recipe.error = 3e-3;
  std::vector<std::string> stages;
  const auto object = bake::bake_recipe(recipe, kSteel, [&](std::string_view stage, double) {
    stages.emplace_back(stage);
    return true;
  });
  ASSERT_TRUE(object) << object.error().message;
  EXPECT_GE(object->rounds.size(), 2u);
  EXPECT_LE(modal::error_spread(object->baked.bank.frequency_error)->largest, 3e-3);
  std::vector<double> found = object->baked.bank.frequency_hz;
  std::sort(found.begin(), found.end());
  for (std::size_t m = 0; m < found.size(); ++m) EXPECT_NEAR(found[m] / reference::kBlock[m], 1, 3e-3) << m;
  EXPECT_TRUE(std::any_of(stages.begin(), stages.end(), [](const std::string& stage) {
    return stage.starts_with("round 2, error ") && stage.ends_with("% so far: mesh");
  }));
}

TEST(AskedError, ABakeWithAnAskedErrorRaisesTheOrderOfAMeshThenSplitsIt) {
  const TemporaryFolder folder;
  const auto path = write_mesh(folder, test::box_mesh({1, 1, 1}, {0.1, 0.08, 0.06}));
  auto recipe = recipe_of(path, fem::Element::kTet10, 22e3);
  recipe.error = 1e-4;
  const auto object = bake::bake_recipe(recipe, kSteel);
  ASSERT_TRUE(object) << object.error().message;
  ASSERT_GE(object->rounds.size(), 4u);
  EXPECT_EQ(object->rounds[1].element, fem::Element::kTet20);
  EXPECT_EQ(object->rounds[2].element, fem::Element::kTet35);
  EXPECT_EQ(object->rounds[3].elements, 8 * object->rounds[2].elements);
  std::vector<double> found = object->baked.bank.frequency_hz;
  std::sort(found.begin(), found.end());
  for (std::size_t m = 0; m < found.size(); ++m) EXPECT_NEAR(found[m] / reference::kBlock[m], 1, 1e-4) << m;
}

TEST(AskedError, ABakeWithAnAskedErrorSaysHowFarItCameWhenItCannotBeReached) {
  const TemporaryFolder folder;
  auto recipe = recipe_of(write_mesh(folder, test::box_mesh({2, 2, 1}, {0.1, 0.08, 0.06})), fem::Element::kTet4, 40e3);
  recipe.error = 1e-7;
  recipe.max_unknowns = 2000;
  const auto object = bake::bake_recipe(recipe, kSteel);
  ASSERT_FALSE(object);
  EXPECT_NE(object.error().message.find("body: the error stays at "), std::string::npos) << object.error().message;
  EXPECT_NE(object.error().message.find(" instead of 1e-05 %"), std::string::npos) << object.error().message;
  EXPECT_NE(object.error().message.find("million unknowns, more than 0.002)"), std::string::npos)
      << object.error().message;
}

TEST(Preview, APreviewIsQuickCoarseAndSaysItsError) {
  const TemporaryFolder folder;
  auto recipe = recipe_of(folder.write("p.geo", kPlate), fem::Element::kTet20, 10e3);
  recipe.preview = true;
  recipe.meshing.mesh_size_m = 0.002;
  const auto object = bake::bake_recipe(recipe, kSteel);
  ASSERT_TRUE(object) << object.error().message;
  EXPECT_EQ(object->rounds.back().element, fem::Element::kTet10);
  EXPECT_LT(object->rounds.back().unknowns, 12'000);
  EXPECT_LE(modal::error_spread(object->baked.bank.shape_error)->median, 0.1);
  EXPECT_LT(object->baked.bank.point_count(), 400u);
  ASSERT_EQ(object->baked.bank.frequency_error.size(), object->baked.bank.mode_count());
  const auto& bank = object->baked.bank;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    if (bank.frequency_hz[m] > 1000) continue;  // the lowest keep their places
    const auto nearest = std::min_element(reference::kPlate.begin(), reference::kPlate.end(), [&](double a, double b) {
      return std::abs(a - bank.frequency_hz[m]) < std::abs(b - bank.frequency_hz[m]);
    });
    EXPECT_LT(bank.frequency_hz[m] / *nearest - 1, bank.frequency_error[m]) << bank.frequency_hz[m];
  }
}

}  // namespace
}  // namespace ringdown::refine_test
