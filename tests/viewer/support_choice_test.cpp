// What is chosen in the window as a support is what a bake holds.
#include "clients/viewer/support_choice.h"

#include "engine/bake/bake.h"
#include "engine/bake/object_file.h"
#include "tests/fem/sample_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace ringdown::viewer {
namespace {

using Bank = SupportChoice::Bank;

modal::Material steel() {
  return {.name = "steel", .youngs_modulus_pa = 200e9, .poisson_ratio = 0.3, .density_kg_m3 = 7850};
}

bake::BakeOptions quick() {
  bake::BakeOptions options;
  options.band_low_hz = 1;
  options.band_high_hz = 3000;
  options.shape_error = 0.2;
  options.air.reset();
  return options;
}

// A bar of 20 x 2 x 1 cm with a corner at the origin, turned and moved.
mesh::CheckedMesh bar(const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity()) {
  mesh::TetMesh box = test::box_mesh({10, 2, 1}, {0.2, 0.02, 0.01});
  box.nodes = (box.nodes * turn.transpose()).eval();
  return test::checked(box);
}

Bank known(const mesh::CheckedMesh& mesh) {
  auto bank = std::make_shared<KnownBank>();
  bank->bank = bake::bake(mesh, steel(), quick(), "bar").value().bank;
  return bank;
}

bake::Makeup parsed(const std::string& text) {
  return bake::parse_object("material = \"steel\"\ngeometry = \"bar.msh\"\n" + text, "bar.toml").value().options.makeup;
}

std::vector<std::string> held(const mesh::CheckedMesh& mesh, const std::string& text) {
  bake::BakeOptions options = quick();
  options.makeup = parsed(text);
  return bake::bake(mesh, steel(), options, "bar").value().report.held;
}

TEST(SupportChoice, AFlatEndIsAPlaneThatABakeHolds) {
  Eigen::Matrix3d turn;
  turn << 2, -1, 2, 2, 2, -1, -1, 2, 2;
  for (const Eigen::Matrix3d& way : {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), Eigen::Matrix3d(turn / 3)}) {
    const mesh::CheckedMesh mesh = bar(way);
    const Bank bank = known(mesh);
    const Eigen::Vector3d end = way * Eigen::Vector3d(0, 0.01, 0.005);
    SupportChoice choice;
    EXPECT_EQ(choice.text(), "");
    choice.toggle_flat("bar", bank, {end[0], end[1], end[2]});
    EXPECT_NEAR(choice.area_m2(), 2e-4, 2e-9);
    EXPECT_NE(choice.text().find("\nplane = ["), std::string::npos) << choice.text();
    EXPECT_EQ(held(mesh, choice.text()), std::vector<std::string>{"clamped: 2 cm2"}) << choice.text();
    choice.toggle_flat("bar", bank, {end[0], end[1], end[2]});
    EXPECT_TRUE(choice.empty());
  }
}

TEST(SupportChoice, APartOfAFaceIsABoxAndSpringsHaveAStiffness) {
  const mesh::CheckedMesh mesh = bar();
  const Bank bank = known(mesh);
  SupportChoice choice;
  choice.add("bar", bank, [](const SupportChoice::Triangle& triangle) {
    return std::ranges::all_of(triangle, [](Vec3 p) { return p.z < 1e-6 && p.x < 0.0601; });
  });
  ASSERT_FALSE(choice.empty());
  choice.set_kind(2);
  EXPECT_NE(choice.text().find("\nbox = ["), std::string::npos);
  const bake::Makeup makeup = parsed(choice.text());
  ASSERT_EQ(makeup.supports.size(), 1u);
  EXPECT_EQ(makeup.supports[0].kind, bake::SupportKind::kSprings);
  EXPECT_GT(makeup.supports[0].stiffness_n_m3, 0);
  // The box holds the faces of the lower side as far as the chosen triangles reach, and none of the other sides.
  double reach_m = 0;
  for (const SupportChoice::Triangle& triangle : choice.triangles()) {
    for (const Vec3& p : triangle) reach_m = std::max(reach_m, p.x);
  }
  const double elements_m = std::floor(reach_m / 0.02 + 1e-6) * 0.02;
  char text[80];
  std::snprintf(text, sizeof text, "on springs: %.3g cm2", 1e4 * elements_m * 0.02);
  EXPECT_EQ(held(mesh, choice.text()), std::vector<std::string>{text}) << choice.text();
}

TEST(SupportChoice, AnotherObjectBeginsAnew) {
  const Bank bank = known(bar());
  SupportChoice choice;
  choice.toggle_flat("bar", bank, {0, 0.01, 0.005});
  choice.toggle_flat("other", bank, {0.2, 0.01, 0.005});
  EXPECT_EQ(choice.object(), "other");
  EXPECT_NEAR(choice.area_m2(), 2e-4, 2e-9);
  choice.toggle_flat("other", bank, {0, 0.01, 0.005});
  EXPECT_NEAR(choice.area_m2(), 4e-4, 4e-9);
  EXPECT_NE(choice.text().find("\nbox = ["), std::string::npos) << "two ends are on no plane";
  choice.toggle_flat("other", nullptr, {0, 0, 0});
  EXPECT_FALSE(choice.empty());
}

}  // namespace
}  // namespace ringdown::viewer
