#include "engine/bake/bake.h"

#include "engine/materials/importance.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/hearing/loudness.h"
#include "tests/fem/sample_meshes.h"
#include "tests/support/temporary_folder.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace ringdown::bake_test {
namespace {

const Eigen::Vector3d kSize(0.2, 0.02, 0.01);

modal::Material steel(double alpha = 5, double beta = 3e-8) { return {"steel", 200e9, 0.3, 7850, {alpha, beta}}; }

mesh::CheckedMesh bar() { return test::checked(test::box_mesh({12, 2, 2}, kSize)); }

bake::Baked baked(const bake::BakeOptions& options = {}, const modal::Material& material = steel()) {
  return bake::bake(bar(), material, options, "bar").value();
}

std::string refusal(const mesh::CheckedMesh& mesh, const modal::Material& material, const bake::BakeOptions& options) {
  const auto result = bake::bake(mesh, material, options, "thing");
  return result ? "accepted" : result.error().message;
}

TEST(Bake, ABakeFillsEverythingABankHolds) {
  const auto [bank, body, report] = baked();
  EXPECT_FALSE(body) << "it was not asked for";
  EXPECT_EQ(bank.name, "bar");
  EXPECT_GE(bank.mode_count(), 10u);
  EXPECT_EQ(bank.decay_per_s.size(), bank.mode_count());
  EXPECT_EQ(bank.shapes.size(), bank.mode_count() * bank.point_count());
  EXPECT_LE(bank.point_count(), 200u);
  EXPECT_FALSE(bank.triangles.empty());
  EXPECT_EQ(bank.material->name, "steel");
  EXPECT_EQ(report.rigid, 6);
  EXPECT_EQ(bank.provenance.rigid_modes, 6);
  EXPECT_EQ(bank.provenance.counted_modes,
            static_cast<std::int64_t>(bank.mode_count()) + report.rigid + report.below_band + report.over_damped);
  EXPECT_EQ(bank.provenance.unknowns, report.unknowns);
  EXPECT_EQ(bank.provenance.element, "tet20 consistent");
  EXPECT_GT(bank.provenance.largest_residual, 0);
  EXPECT_LT(bank.provenance.largest_residual, 1e-6);
  for (const double frequency : bank.frequency_hz) {
    EXPECT_GE(frequency, 20);
    EXPECT_LE(frequency, 20000);
  }
}

TEST(Bake, DecayFollowsRayleigh) {
  const modal::Material material = steel(40, 2e-7);
  const auto bank = baked({}, material).bank;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double decay = bank.decay_per_s[m], omega = 2 * M_PI * bank.frequency_hz[m];
    EXPECT_NEAR(decay, 0.5 * (40 + 2e-7 * (omega * omega + decay * decay)), 1e-9 * decay);
  }
}

TEST(Bake, TheMassPropertiesOfABoxAreTheClosedForm) {
  const modal::MassProperties mass = *baked().bank.mass;
  const double m = 7850 * kSize.prod();
  EXPECT_NEAR(mass.mass_kg, m, 1e-12);
  EXPECT_NEAR(mass.center_of_mass_m.x, 0.1, 1e-12);
  EXPECT_NEAR(mass.center_of_mass_m.y, 0.01, 1e-12);
  EXPECT_NEAR(mass.center_of_mass_m.z, 0.005, 1e-12);
  const double xx = kSize[0] * kSize[0], yy = kSize[1] * kSize[1], zz = kSize[2] * kSize[2];
  EXPECT_NEAR(mass.inertia_kg_m2.x, m / 12 * (yy + zz), 1e-13);
  EXPECT_NEAR(mass.inertia_kg_m2.y, m / 12 * (xx + zz), 1e-13);
  EXPECT_NEAR(mass.inertia_kg_m2.z, m / 12 * (xx + yy), 1e-13);
  EXPECT_NEAR(std::abs(mass.orientation[3]), 1, 1e-9) << "a box's principal axes are its edges";
}

TEST(Bake, TurnedBodiesHaveTurnedPrincipalAxes) {
  mesh::CheckedMesh mesh = bar();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  mesh.mesh.nodes = (mesh.mesh.nodes * turn.transpose()).eval();
  const auto mass = *bake::bake(mesh, steel(), {}, "turned")->bank.mass;
  const Eigen::Quaterniond q(mass.orientation[3], mass.orientation[0], mass.orientation[1], mass.orientation[2]);
  EXPECT_NEAR(q.norm(), 1, 1e-12);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(std::abs((q * Eigen::Vector3d::Unit(axis)).dot(turn.col(axis))), 1, 1e-9) << axis;
  }
}

// Fewer points hold the same modes, less well: the bank says by how much.
TEST(Bake, FewerPointsCostWhatTheBankSays) {
  const auto all = baked({.points = 10000}).bank, chosen = baked().bank, few = baked({.points = 30}).bank;
  ASSERT_LE(few.point_count(), 30u);
  EXPECT_GT(chosen.point_count(), few.point_count());
  EXPECT_LT(chosen.point_count(), all.point_count());
  EXPECT_EQ(few.frequency_hz, all.frequency_hz);
  EXPECT_LE(modal::error_spread(chosen.shape_error)->median, 0.03);
  EXPECT_GT(modal::error_spread(few.shape_error)->median, modal::error_spread(chosen.shape_error)->median);
  EXPECT_LT(modal::error_spread(all.shape_error)->median, modal::error_spread(chosen.shape_error)->median);
  EXPECT_LT(baked({.shape_error = 0.1}).bank.point_count(), chosen.point_count());
}

// For a mass-normalised shape the mass-weighted mean square over the body is 1; over the surface of a slender bar's
// first bending mode it is 1/m too, and at the ends a free beam moves twice the rms.
TEST(Bake, ShapesAreMassNormalised) {
  const auto bank = baked({.points = 10000}).bank;
  const auto lowest = static_cast<std::size_t>(std::min_element(bank.frequency_hz.begin(), bank.frequency_hz.end()) -
                                               bank.frequency_hz.begin());
  double largest = 0;
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    largest = std::max(largest, std::abs(static_cast<double>(bank.shape(lowest, p)[2])));
  }
  EXPECT_NEAR(largest * std::sqrt(bank.mass->mass_kg), 2, 0.03);
}

TEST(Bake, ABakeOrdersModesByImportance) {
  const auto bank = baked({.points = 10000}).bank;
  std::vector<double> value(bank.mode_count());
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double pressure_pa = modal::Loudness(bank).pressure_pa(bank, m, {}, bank.frequency_hz[m]);
    value[m] = bake::importance({bank.frequency_hz[m], bank.decay_per_s[m]}, pressure_pa, 1);
  }
  // All modes of one body have about the same surface rms, so the order is that of the spectral part within a factor.
  for (std::size_t m = 1; m < value.size(); ++m) EXPECT_LT(value[m], 12 * value[m - 1]);
  EXPECT_GT(value.front(), value.back());
}

TEST(Bake, ABakeKeepsTheMostImportantModes) {
  const auto all = baked(), few = baked({.keep_modes = 5});
  ASSERT_EQ(few.bank.mode_count(), 5u);
  EXPECT_EQ(few.report.unimportant, static_cast<int>(all.bank.mode_count()) - 5);
  EXPECT_TRUE(std::equal(few.bank.frequency_hz.begin(), few.bank.frequency_hz.end(), all.bank.frequency_hz.begin()));
}

TEST(Bake, ModesWithNonlinearTermsStayHoweverFewAreKept) {
  const mesh::CheckedMesh plate = test::checked(test::box_mesh({8, 6, 1}, {0.2, 0.15, 0.002}));
  const auto bank_of = [&](bake::BakeOptions options) {
    options.nonlinear = 6;
    return bake::bake(plate, steel(), options, "plate").value().bank;
  };
  for (const modal::Bank& bank : {bank_of({.keep_modes = 3}), bank_of({.floor_db = 1})}) {
    ASSERT_TRUE(bank.nonlinear);
    EXPECT_EQ(bank.nonlinear->mode_count(), 6u);
  }
}

TEST(Bake, ABakeDropsWhatLiesBelowTheBandOrIsOverDamped) {
  const auto whole = baked();
  const double first = *std::min_element(whole.bank.frequency_hz.begin(), whole.bank.frequency_hz.end());
  const auto above = baked({.band_low_hz = first * 1.01});
  EXPECT_EQ(above.report.below_band, 1);
  EXPECT_EQ(above.bank.mode_count(), whole.bank.mode_count() - 1);
  // alpha = 2 omega of a mode makes it critical: below there is no pitch.
  const auto tar = baked({}, steel(2 * 2 * M_PI * 5000, 0));
  EXPECT_GT(tar.report.over_damped, 0);
  EXPECT_EQ(tar.report.over_damped + tar.report.below_band + tar.bank.mode_count(), whole.bank.mode_count());
}

TEST(Bake, BandTopIsWhereTheDampedFrequencyMeetsIt) {
  for (const modal::RayleighDamping damping : {modal::RayleighDamping{0, 0}, {100, 0}, {5, 3e-8}, {60, 2e-6}}) {
    const double lambda = modal::highest_lambda_in_band(20000, damping);
    EXPECT_NEAR(modal::damp(lambda, damping).frequency_hz, 20000, 1e-6);
  }
  const modal::RayleighDamping strong{0, 1e-4};  // no mode reaches 20 kHz; the highest pitch is at lambda = 2 / beta^2
  EXPECT_NEAR(modal::highest_lambda_in_band(20000, strong), 2e8, 1);
}

TEST(Bake, ABakeIsTheSameFileEveryTime) {
  const test::TemporaryFolder folder;
  for (const char* name : {"a.glb", "b.glb"}) ASSERT_TRUE(modal::write_bank(baked().bank, folder.path() / name));
  const auto bytes = [&](const char* name) {
    std::ifstream file(folder.path() / name, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  ASSERT_GT(bytes("a.glb").size(), 1000u);
  EXPECT_TRUE(bytes("a.glb") == bytes("b.glb"));
}

TEST(Bake, ABakeTakesTheOtherElementsToo) {
  const auto lowest = [](const modal::Bank& bank) {
    return *std::min_element(bank.frequency_hz.begin(), bank.frequency_hz.end());
  };
  const bake::Baked quadratic = baked({.element = fem::Element::kTet10});
  for (const auto element : {fem::Element::kTet4, fem::Element::kTet4Lumped}) {
    const bake::Baked other = baked({.element = element});
    EXPECT_LT(other.report.unknowns, quadratic.report.unknowns);
    EXPECT_GT(lowest(other.bank), 1.1 * lowest(quadratic.bank)) << "linear tetrahedra are too stiff";
  }
  const bake::Baked cubic = baked();
  EXPECT_EQ(cubic.bank.provenance.element, "tet20 consistent");
  EXPECT_LT(lowest(cubic.bank), lowest(quadratic.bank));
  EXPECT_NEAR(lowest(cubic.bank) / lowest(quadratic.bank), 1, 0.01);
}

TEST(Bake, TwoPiecesHaveTwelveRigidMotions) {
  mesh::TetMesh far = bar().mesh;
  far.nodes.array() += 1;
  const auto pair = bake::bake(test::checked(test::both(bar().mesh, far)), steel(), {}, "pair");
  ASSERT_TRUE(pair) << pair.error().message;
  EXPECT_EQ(pair->report.rigid, 12);
}

TEST(Bake, ABakeRefusesWithOneSentence) {
  EXPECT_NE(refusal(bar(), {"jelly", 1e9, 0.5, 1000, {}}, {}).find("jelly: Poisson's ratio"), std::string::npos);
  EXPECT_NE(refusal(bar(), steel(), {.band_low_hz = 30, .band_high_hz = 40}).find("no mode between 30 and 40 Hz"),
            std::string::npos);
  EXPECT_NE(refusal(bar(), steel(), {.band_low_hz = 40, .band_high_hz = 30}).find("the band must"), std::string::npos);
  EXPECT_NE(refusal(bar(), steel(), {.points = 3}).find("at least 4 surface points"), std::string::npos);
  EXPECT_NE(refusal(bar(), steel(), {.max_modes = 3}).find("more than 3 modes"), std::string::npos);
  EXPECT_NE(refusal(bar(), steel(3, 1), {}).find("damped so strongly"), std::string::npos);
  mesh::CheckedMesh in_millimetres = bar();  // 200 m long, when its numbers are taken for metres
  in_millimetres.mesh.nodes *= 1000;
  EXPECT_NE(refusal(in_millimetres, steel(), {}).find("check the unit"), std::string::npos);
}

TEST(Bake, ABakeCanBeCancelledInEveryStage) {
  for (const std::string_view stage : {"assemble", "factors", "modes", "finish"}) {
    const auto result = bake::bake(bar(), steel(), {}, "bar", [&](std::string_view at, double) { return at != stage; });
    ASSERT_FALSE(result) << stage;
    EXPECT_EQ(result.error().kind, ErrorKind::cancelled);
  }
}

TEST(AWeighting, TheWeightingIsThatOfTheStandardsTable) {
  const auto decibels = [](double f) { return 20 * std::log10(bake::a_weighting(f)); };
  EXPECT_NEAR(decibels(1000), 0, 0.05);
  EXPECT_NEAR(decibels(100), -19.1, 0.1);
  EXPECT_NEAR(decibels(31.62), -39.4, 0.15);
  EXPECT_NEAR(decibels(10000), -2.5, 0.1);
}

}  // namespace
}  // namespace ringdown::bake_test
