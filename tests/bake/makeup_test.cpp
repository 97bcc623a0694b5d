// Grain, parts and supports from an object file to a bank.
#include "engine/bake/bake_object.h"
#include "engine/bake/fitted_makeup.h"
#include "engine/bake/makeup_file.h"
#include "engine/mesh/body.h"
#include "engine/mesh/boundary.h"
#include "engine/mesh/gmsh_reader.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/damping.h"
#include "engine/modal/material_scale.h"
#include "tests/fem/grain_frequencies.h"
#include "tests/fem/sample_meshes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <numbers>
#include <utility>
#include <vector>

namespace ringdown {
namespace {

constexpr double kPi = std::numbers::pi;

modal::Material steel() {
  return {.name = "steel",
          .youngs_modulus_pa = 200e9,
          .poisson_ratio = 0.3,
          .density_kg_m3 = 7850,
          .damping = {.alpha_per_s = 2, .beta_s = 1e-8}};
}

modal::Material spruce() {
  return {.name = "spruce",
          .youngs_modulus_pa = 11e9,
          .poisson_ratio = 0.3,
          .density_kg_m3 = 430,
          .damping = {.beta_s = 4e-6},
          .orthotropy = modal::Orthotropy{.youngs_modulus_pa = {11e9, 0.86e9, 0.47e9},
                                          .poisson_ratio = {0.37, 0.47, 0.44},
                                          .shear_modulus_pa = {0.70e9, 0.67e9, 0.033e9},
                                          .loss = {1, 2.5, 2.5, 2, 2, 2.5}}};
}

bake::BakeOptions quick(double top_hz) {
  bake::BakeOptions options;
  options.band_low_hz = 1;
  options.band_high_hz = top_hz;
  options.shape_error = 0.2;
  return options;
}

mesh::CheckedMesh bar() { return test::checked(test::box_mesh({10, 2, 1}, {0.2, 0.02, 0.01})); }

bake::Place box(Vec3 from, Vec3 to) { return {.box_m = std::array{from, to}, .plane = std::nullopt, .group = {}}; }

std::vector<double> sorted(std::vector<double> frequencies) {
  std::sort(frequencies.begin(), frequencies.end());
  return frequencies;
}

// The ends of a slender bar move twice as much as its rms in every mode of bending, phi^2 = 4 / m, so that a damper c
// at one end takes 2 c / m.
TEST(Makeup, ACordAtTheEndOfABarTakesWhatTheClosedFormSays) {
  constexpr double kDamping_ns_m = 3, kMass_kg = 0.2 * 0.02 * 0.004 * 7850;
  const mesh::CheckedMesh bar = test::checked(test::box_mesh({12, 2, 1}, {0.2, 0.02, 0.004}));
  bake::BakeOptions options = quick(1500);
  const auto free = bake::bake(bar, steel(), options, "bar");
  options.makeup.supports = {
      {.kind = bake::SupportKind::kPoints, .points_m = {{0, 0.01, 0.004}}, .point_damping_ns_m = kDamping_ns_m}};
  EXPECT_TRUE(options.makeup.moves_freely());
  const auto held = bake::bake(bar, steel(), options, "bar");
  ASSERT_TRUE(free && held);
  EXPECT_FALSE(held->bank.held);
  ASSERT_EQ(free->bank.mode_count(), held->bank.mode_count());
  const auto lowest =
      static_cast<std::size_t>(std::ranges::min_element(held->bank.frequency_hz) - held->bank.frequency_hz.begin());
  const double alone = 0.5 * steel().damping.alpha_per_s;
  EXPECT_NEAR((held->bank.losses[lowest].support_per_s - alone) / (2 * kDamping_ns_m / kMass_kg), 1, 0.02);
  options.makeup.supports[0].points_m = {{0, 0.01, 4}};  // millimetres
  const auto far = bake::bake(bar, steel(), options, "bar");
  ASSERT_FALSE(far);
  EXPECT_NE(far.error().message.find("away from the body"), std::string::npos) << far.error().message;
}

TEST(Makeup, AMassAtAPointLowersThePitchAsAGluedOneDoes) {
  const mesh::CheckedMesh bar = test::checked(test::box_mesh({12, 2, 1}, {0.2, 0.02, 0.004}));
  bake::BakeOptions options = quick(1500);
  options.makeup.supports = {
      {.kind = bake::SupportKind::kPoints, .points_m = {{0, 0.01, 0.004}}, .point_mass_kg = 0.01}};
  const auto point = bake::bake(bar, steel(), options, "bar");
  options.makeup.supports.clear();
  options.makeup.masses = {{.place = box({-1e-4, -1, -1}, {1e-4, 1, 1}), .mass_kg = 0.01}};
  const auto glued = bake::bake(bar, steel(), options, "bar");
  ASSERT_TRUE(point && glued);
  EXPECT_NEAR(sorted(point->bank.frequency_hz)[0] / sorted(glued->bank.frequency_hz)[0], 1, 0.005);
}

// The heat of a scaled bank is held against a bake of the larger body in the stiffer, lighter material.
TEST(Makeup, HeatOfAScaledBankIsThatOfAFreshBake) {
  modal::Material brass = steel();
  brass.damping = {};
  brass.loss_factors = {{1000, 3e-4}};
  brass.thermal = modal::Thermal{1.9e-5, 115, 380};
  bake::BakeOptions options = quick(4000);
  const auto bar = [](double size) {
    return test::checked(test::box_mesh({8, 2, 1}, {0.2 * size, 0.02 * size, 0.002 * size}));
  };
  const auto one = bake::bake(bar(1), brass, options, "bar");
  modal::Material other = brass;
  other.youngs_modulus_pa *= 3;
  other.density_kg_m3 *= 0.5;
  const auto two = bake::bake(bar(2), other, options, "bar");
  ASSERT_TRUE(one && two);
  std::vector<std::pair<double, double>> scaled, fresh;
  for (std::size_t m = 0; m < one->bank.mode_count(); ++m) {
    const modal::MaterialScale scale{.density = 0.5, .stiffness = 3, .size = 2};
    scaled.emplace_back(modal::rescale(one->bank, m, scale).frequency_hz,
                        modal::rescaled_loss(one->bank, m, scale).heat_per_s);
  }
  for (std::size_t m = 0; m < two->bank.mode_count(); ++m)
    fresh.emplace_back(two->bank.frequency_hz[m], two->bank.losses[m].heat_per_s);
  std::ranges::sort(scaled);
  std::ranges::sort(fresh);
  const std::size_t both = std::min(scaled.size(), fresh.size());
  ASSERT_GE(both, 4u);
  for (std::size_t m = 0; m < both; ++m) {
    EXPECT_NEAR(scaled[m].first / fresh[m].first, 1, 1e-4);
    EXPECT_NEAR(scaled[m].second / fresh[m].second, 1, 0.002) << fresh[m].first;
  }
}

TEST(Makeup, AnObjectFileSaysItAllAndIsReadStrictly) {
  const char* text = R"(material = "maple"
geometry = "knife.geo"
[grain]
axis = [0, 0, 1]
through = [0.1, 0, 0]
winds = true
[[part]]
group = "blade"
material = "steel"
[[part]]
group = "handle"
material = "spruce"
grain = { along = [1, 0, 0], radial = [0, 0, 1] }
[[support]]
kind = "springs"
plane = [0, 0, 0, 0, 0, 1]
stiffness = 1e8
damping = 100
[[support]]
kind = "clamped"
group = "foot"
[[mass]]
mass_kg = 0.01
box = [0, 0, 0, 1, 1, 1]
)";
  const bake::Makeup makeup = bake::parse_object(text, "knife.toml")->options.makeup;
  ASSERT_TRUE(makeup.grain && makeup.grain->axis && makeup.grain->winds);
  ASSERT_EQ(makeup.parts.size(), 2u);
  EXPECT_EQ(makeup.parts[1].material.name, "spruce");
  EXPECT_EQ(makeup.parts[1].grain->radial->z, 1);
  ASSERT_EQ(makeup.supports.size(), 2u);
  EXPECT_EQ(makeup.supports[0].stiffness_along_n_m3, 1e8);
  EXPECT_EQ(makeup.supports[1].place.group, "foot");
  EXPECT_EQ(makeup.masses[0].mass_kg, 0.01);

  const auto complaint = [](const std::string& tables) {
    return bake::parse_object("material = \"m\"\ngeometry = \"g.geo\"\n" + tables, "x.toml").error().message;
  };
  EXPECT_NE(complaint("[grain]\nalong = [0, 0, 0]\n").find("must have a length"), std::string::npos);
  EXPECT_NE(complaint("[grain]\nalong = [1, 0, 0]\naxis = [1, 0, 0]\n").find("either a direction"), std::string::npos);
  EXPECT_NE(complaint("[[support]]\nkind = \"clamped\"\n").find("give one of box, plane and group"), std::string::npos);
  EXPECT_NE(complaint("[[support]]\nkind = \"clamped\"\ngroup = \"a\"\nstiffness = 1\n").find("belongs to springs"),
            std::string::npos);
  EXPECT_NE(complaint("[[support]]\nkind = \"clamped\"\nbox = [1, 2]\n").find("six numbers"), std::string::npos);
}

TEST(Makeup, ACommandLineSaysASupportInOneLine) {
  const auto support = bake::parse_support("kind = \"springs\", plane = [0, 0, 0, 1, 0, 0], stiffness = 1e8");
  ASSERT_TRUE(support) << support.error().message;
  EXPECT_EQ(support->stiffness_along_n_m3, 1e8);
  EXPECT_EQ((*support->place.plane)[1].x, 1);
  for (const char* wrong : {"", "kind = \"clamped\"", "kind = \"glued\", group = \"a\"",
                            "kind = \"clamped\", group = \"a\", x = 1", "kind = \"clamped\" }"}) {
    const auto refused = bake::parse_support(wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error().message.find("--support"), 0u) << refused.error().message;
  }
}

TEST(Makeup, ACantileverIsHeldHasNoRigidMotionAndScalesWithItsPlace) {
  bake::BakeOptions options = quick(4500);
  options.makeup.supports = {{.place = box({0, 0, 0}, {0, 0.02, 0.01})}};
  options.element = fem::Element::kTet35;
  const mesh::TetMesh fine = test::finer_at_ends(test::box_mesh({16, 2, 2}, {0.2, 0.02, 0.01}), 0, false);
  const auto baked = bake::bake(test::checked(fine), steel(), options, "tine").value();
  EXPECT_EQ(baked.report.rigid, 0);
  EXPECT_TRUE(baked.bank.held);
  const std::vector<double> found = sorted(baked.bank.frequency_hz);
  ASSERT_GE(found.size(), 4u);
  for (std::size_t m = 0; m < 4; ++m) EXPECT_NEAR(found[m] / reference::kSteelCantilever[m], 1, 1e-3);

  // The same object file, twice as large: half the frequencies.
  options.makeup = bake::scaled(options.makeup, 2);
  options.band_high_hz /= 2;
  const auto large = bake::bake(test::checked({2 * fine.nodes, fine.elements}), steel(), options, "tine").value();
  const std::vector<double> halves = sorted(large.bank.frequency_hz);
  for (std::size_t m = 0; m < 4; ++m) EXPECT_NEAR(2 * halves[m] / found[m], 1, 1e-6);
}

// A stiff block on soft springs is a mass on a spring: omega^2 = k A / m, d = c A / (2 m) + eta omega / 2 + alpha / 2.
TEST(Makeup, ABlockOnSpringsBouncesAndItsDampersTakeWhatTheyShould) {
  const double area = 0.02 * 0.2, mass = 7850 * 0.2 * 0.02 * 0.01, k = 2e7, c = 500, eta = 0.01;
  bake::BakeOptions options = quick(100);
  options.air.reset();
  options.makeup.supports = {{.kind = bake::SupportKind::kSprings,
                              .place = box({0, 0, 0}, {0.2, 0.02, 0}),
                              .stiffness_n_m3 = k,
                              .stiffness_along_n_m3 = 1e-3 * k,
                              .damping_ns_m3 = c,
                              .loss_factor = eta}};
  const auto baked = bake::bake(bar(), steel(), options, "on springs");
  ASSERT_TRUE(baked) << baked.error().message;
  EXPECT_EQ(baked->report.rigid, 0);
  const double omega = std::sqrt(k * area / mass), decay = 0.5 * c * area / mass + 0.5 * eta * omega + 1;
  const double bounce_hz = std::sqrt(omega * omega - decay * decay) / (2 * kPi);
  const modal::Bank& bank = baked->bank;
  const auto nearest = std::min_element(bank.frequency_hz.begin(), bank.frequency_hz.end(), [&](double a, double b) {
    return std::abs(a - bounce_hz) < std::abs(b - bounce_hz);
  });
  const auto m = nearest - bank.frequency_hz.begin();
  EXPECT_NEAR(*nearest / bounce_hz, 1, 1e-3);
  EXPECT_NEAR(bank.decay_per_s[m] / decay, 1, 1e-3);
  EXPECT_NEAR(bank.losses[m].support_per_s / decay, 1, 1e-3);
}

TEST(Makeup, EachDirectionOfAGrainTakesItsLoss) {
  bake::BakeOptions options = quick(6000);
  options.air.reset();
  options.makeup.grain = bake::Grain{.radial = Vec3{0, 0, 1}};
  const auto losing = bake::bake(bar(), spruce(), options, "bar").value();
  modal::Material even = spruce();
  even.orthotropy->loss.fill(1);
  const auto plain = bake::bake(bar(), even, options, "bar").value();
  ASSERT_TRUE(losing.bank.material->orthotropy);
  for (std::size_t m = 0; m < plain.bank.mode_count(); ++m) {
    const double lambda = modal::undamped_lambda({plain.bank.frequency_hz[m], plain.bank.decay_per_s[m]});
    EXPECT_NEAR(plain.bank.decay_per_s[m] / (0.5 * 4e-6 * lambda), 1, 1e-5);
  }
  // Bending along the grain loses little more; twist as much as shear does.
  double min = 9, max = 0;
  for (std::size_t m = 0; m < losing.bank.mode_count(); ++m) {
    const double lambda = modal::undamped_lambda({losing.bank.frequency_hz[m], losing.bank.decay_per_s[m]});
    const double ratio = losing.bank.decay_per_s[m] / (0.5 * 4e-6 * lambda);
    min = std::min(min, ratio), max = std::max(max, ratio);
  }
  EXPECT_GT(min, 1);
  EXPECT_LT(min, 1.3);
  EXPECT_GT(max, 1.8);
  EXPECT_LT(max, 2.5);

  const test::TemporaryFolder folder;
  ASSERT_TRUE(modal::write_bank(losing.bank, folder.path() / "bar.glb"));
  const modal::Bank read = modal::read_bank(folder.path() / "bar.glb").value();
  EXPECT_EQ(read.material->orthotropy, losing.bank.material->orthotropy);
  EXPECT_FALSE(read.held);
}

TEST(Makeup, TheCacheKeepsApartWhatIsMadeOrHeldDifferently) {
  const test::TemporaryFolder folder;
  bake::BakeOptions options = quick(6000);
  options.air.reset();
  options.cache = folder.path();
  const auto found = [&](const bake::Makeup& makeup) {
    options.makeup = makeup;
    const auto baked = bake::bake(bar(), spruce(), options, "bar").value();
    return std::pair{baked.report.from_cache, baked.bank};
  };
  bake::Makeup along{.grain = bake::Grain{.radial = Vec3{0, 0, 1}}},
      across{.grain = bake::Grain{.along = {0, 1, 0}, .radial = Vec3{0, 0, 1}}}, held = along;
  held.supports = {{.place = box({0, 0, 0}, {0, 0.02, 0.01})}};
  for (const bake::Makeup& makeup : {bake::Makeup{}, along, across, held}) {
    const auto first = found(makeup), second = found(makeup);
    EXPECT_FALSE(first.first);
    EXPECT_TRUE(second.first);
    EXPECT_EQ(first.second.frequency_hz, second.second.frequency_hz);
    EXPECT_EQ(first.second.decay_per_s, second.second.decay_per_s);
  }
}

TEST(Makeup, PartsOfOneMaterialAreOneBodyAndPartsOfTwoLoseEachItsShare) {
  mesh::CheckedMesh mesh = bar();
  mesh.groups.volumes = {"left"};
  for (Eigen::Index e = 0; e < mesh.mesh.elements.rows(); ++e)
    mesh.groups.volume_of.push_back(mesh::corners_of(mesh.mesh, e).col(0).mean() < 0.1 ? 0 : -1);
  bake::BakeOptions options = quick(8000);
  options.air.reset();
  const auto whole = bake::bake(mesh, steel(), options, "bar").value().bank;
  options.makeup.parts = {{.group = "left", .material = steel(), .grain = std::nullopt}};
  const auto same = bake::bake(mesh, steel(), options, "bar").value().bank;
  ASSERT_EQ(same.mode_count(), whole.mode_count());
  for (std::size_t m = 0; m < whole.mode_count(); ++m) {
    EXPECT_NEAR(same.frequency_hz[m] / whole.frequency_hz[m], 1, 1e-7);
    EXPECT_NEAR(same.decay_per_s[m] / whole.decay_per_s[m], 1, 1e-5);
  }
  // Only one half loses: in a symmetric bar, half of what the whole loses.
  options.makeup.parts[0].material.damping = {};
  const auto half = bake::bake(mesh, steel(), options, "bar").value().bank;
  for (std::size_t m = 0; m < whole.mode_count(); ++m)
    EXPECT_NEAR(half.decay_per_s[m] / whole.decay_per_s[m], 0.5, 2e-3);
  options.makeup.parts[0].group = "right";
  EXPECT_NE(bake::bake(mesh, steel(), options, "bar").error().message.find("has no group 'right'"), std::string::npos);
}

// Alike in all directions across its axis: a tube with its grain around that axis is one with a straight grain.
TEST(Makeup, AGrainAlongAnAxisIsStraightWhereAllDirectionsAcrossAreAlike) {
  modal::Material bamboo = spruce();
  bamboo.orthotropy = modal::Orthotropy{.youngs_modulus_pa = {15e9, 1.1e9, 1.1e9},
                                        .poisson_ratio = {0.3, 0.3, 0.4},
                                        .shear_modulus_pa = {1e9, 1e9, 1.1e9 / 2.8}};
  const bake::Grain straight{.along = {0, 0, 1}}, around{.axis = Vec3{0, 0, 1}, .through_m = {0.3, 0.1, 0}},
      wound{.axis = Vec3{0, 0, 1}, .winds = true};
  const Eigen::Vector3d point(0.02, 0.01, 0.05);
  const fem::Matrix6 a = bake::stiffness_at(bamboo, straight, point).value(),
                     b = bake::stiffness_at(bamboo, around, point).value(),
                     c = bake::stiffness_at(bamboo, wound, {0.07, 0, 0.3}).value();
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-9 * a(2, 2));
  EXPECT_NEAR(c(1, 1) / a(2, 2), 1, 1e-9);  // on the x axis a winding runs along y
  EXPECT_NE(bake::stiffness_at(spruce(), straight, point).error().message.find("radial = [x, y, z]"),
            std::string::npos);
}

TEST(Makeup, GroupsOfAGeoFileHoldAndPartABody) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "two.geo") << R"(SetFactory("OpenCASCADE");
DefineConstant[ mesh_size = 10 ];
Box(1) = {0, 0, 0, 40, 20, 10};  Box(2) = {40, 0, 0, 40, 20, 10};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
Physical Volume("handle") = {1};  Physical Volume("blade") = {2};
foot() = Surface In BoundingBox {-1, -1, -1, 1, 21, 11};
Physical Surface("foot") = {foot()};
)";
  mesh::GmshOptions meshing;
  meshing.unit_m = 0.001;
  meshing.mesh_size_m = 0.01;
  const auto mesh = mesh::read_with_gmsh(folder.path() / "two.geo", meshing);
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->pieces, 1);  // shared nodes
  mesh::Body body{.mesh = *mesh}, back;
  ASSERT_TRUE(mesh::unpack(mesh::packed(body), back));
  for (const mesh::MeshGroups& groups : {mesh->groups, back.mesh.groups}) {
    ASSERT_EQ(groups.volumes, (std::vector<std::string>{"handle", "blade"}));
    ASSERT_EQ(groups.surfaces.size(), 1u);
    for (Eigen::Index e = 0; e < mesh->mesh.elements.rows(); ++e)
      ASSERT_EQ(groups.volume_of[e], mesh::corners_of(mesh->mesh, e).col(0).mean() < 0.04 ? 0 : 1);
    std::vector<mesh::OuterFace> faces;
    for (const mesh::OuterFace& face : mesh::outer_faces(mesh->mesh.elements)) {
      if (std::ranges::binary_search(groups.surfaces[0].faces, 4 * face.element + face.opposite)) faces.push_back(face);
    }
    EXPECT_NEAR(fem::extent_of(mesh->mesh, faces).area, 0.02 * 0.01, 1e-9);
  }
}

TEST(Makeup, WhatDoesNotFitTheBodyIsSaid) {
  bake::BakeOptions options = quick(6000);
  options.makeup.supports = {{.place = box({1, 1, 1}, {2, 2, 2})}};
  EXPECT_NE(bake::bake(bar(), steel(), options, "bar").error().message.find("no face of its surface lies on the box"),
            std::string::npos);
  options.makeup.supports = {{.kind = bake::SupportKind::kSlides, .place = box({-1, -1, -1}, {1, 1, 1})}};
  EXPECT_NE(bake::bake(bar(), steel(), options, "bar").error().message.find("is not flat"), std::string::npos);
  options.makeup.supports.clear();
  options.makeup.grain = bake::Grain{};
  EXPECT_NE(bake::bake(bar(), steel(), options, "bar").error().message.find("leave the grain out"), std::string::npos);
}

}  // namespace
}  // namespace ringdown
