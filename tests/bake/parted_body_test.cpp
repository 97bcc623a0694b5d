// Bodies parted by a closed surface inside them, from an object file to a bank: a ball with a core of another material,
// whose breathing mode is known exactly.
#include "engine/bake/bake_object.h"
#include "engine/bake/input_hash.h"
#include "engine/mesh/triangle_mesh.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/damping.h"
#include "tests/mesh/sample_surfaces.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

namespace ringdown {
namespace {

constexpr double kCore_m = 0.03, kBall_m = 0.05;

struct Layer {
  double young_pa, poisson, density_kg_m3;
  [[nodiscard]] double lambda() const { return young_pa * poisson / ((1 + poisson) * (1 - 2 * poisson)); }
  [[nodiscard]] double shear() const { return young_pa / (2 * (1 + poisson)); }
};

// Breathing of a ball of two layers: in each the radial displacement is A j1(kr) + B y1(kr) with k = omega / c of
// pressure waves, and the radial stress (lambda + 2 mu) u' + 2 lambda u / r. Both are continuous, and the skin is free.
double skin_stress(const Layer& core, const Layer& shell, double omega) {
  const auto fields = [omega](const Layer& layer, double r, bool second) {
    const double k = omega / std::sqrt((layer.lambda() + 2 * layer.shear()) / layer.density_kg_m3), x = k * r;
    const double s = std::sin(x), c = std::cos(x);
    const double u = second ? -c / (x * x) - s / x : s / (x * x) - c / x;
    const double zeroth = second ? -c / x : s / x;
    const double slope = k * (zeroth - 2 * u / x);  // f1' = f0 - 2 f1 / x
    return std::array{u, (layer.lambda() + 2 * layer.shear()) * slope + 2 * layer.lambda() * u / r};
  };
  const auto inner = fields(core, kCore_m, false);
  const auto j = fields(shell, kCore_m, false), y = fields(shell, kCore_m, true);
  const double det = j[0] * y[1] - y[0] * j[1];
  const double a = (inner[0] * y[1] - y[0] * inner[1]) / det, b = (j[0] * inner[1] - inner[0] * j[1]) / det;
  return a * fields(shell, kBall_m, false)[1] + b * fields(shell, kBall_m, true)[1];
}

double breathing_hz(const Layer& core, const Layer& shell) {
  double low = 2 * std::numbers::pi * 10e3, step = 2 * std::numbers::pi * 100;
  while (skin_stress(core, shell, low) * skin_stress(core, shell, low + step) > 0) low += step;
  double high = low + step;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (skin_stress(core, shell, low) * skin_stress(core, shell, middle) > 0 ? low : high) = middle;
  }
  return low / (2 * std::numbers::pi);
}

void write_material(const test::TemporaryFolder& folder, const std::string& name, const Layer& layer, double beta_s) {
  std::string text = "name = \"" + name + "\"\ndescription = \"test\"\n";
  const std::pair<const char*, double> figures[] = {{"youngs_modulus_pa", layer.young_pa},
                                                    {"poisson_ratio", layer.poisson},
                                                    {"density_kg_m3", layer.density_kg_m3},
                                                    {"alpha_per_s", 0},
                                                    {"beta_s", beta_s}};
  for (const auto& [key, value] : figures) {
    char line[160];
    std::snprintf(line, sizeof line, "[%s]\nvalue = %.12g\nsource = \"test\"\n", key, value);
    text += line;
  }
  (void)folder.write(name + ".toml", text);
}

// The mode whose points all move along the radius by the same amount.
std::size_t breathing_mode(const modal::Bank& bank) {
  std::size_t best = 0;
  double max = 0;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    double along = 0, all = 0;
    for (std::size_t p = 0; p < bank.point_count(); ++p) {
      const auto &at = bank.positions[p], &shape = bank.shape(m, p);
      along += (shape[0] * at[0] + shape[1] * at[1] + shape[2] * at[2]) / kBall_m;
      all += shape[0] * shape[0] + shape[1] * shape[1] + shape[2] * shape[2];
    }
    const double share = along * along / (all * static_cast<double>(bank.point_count()));
    if (share > max) max = share, best = m;
  }
  EXPECT_GT(max, 0.99);
  return best;
}

TEST(PartedBody, ABallWithACoreBreathesWeighsAndLosesAsItsLayersSay) {
  const Layer steel{200e9, 0.3, 7850}, glaze{70e9, 0.2, 2400};
  const test::TemporaryFolder folder;
  const double beta_s = 1e-9;
  write_material(folder, "steel", steel, beta_s);
  write_material(folder, "glaze", glaze, 0);
  ASSERT_TRUE(mesh::write_ply(test::sphere(kBall_m, 64), folder.path() / "ball.ply"));
  ASSERT_TRUE(mesh::write_ply(test::sphere(kCore_m, 64), folder.path() / "core.ply"));
  const double exact_hz = breathing_hz(steel, glaze);
  char text[300];
  std::snprintf(text, sizeof text,
                "material = \"glaze\"\ngeometry = \"ball.ply\"\nmesh_size_m = 0.016\nshape_error = 0.3\n"
                "band_hz = [%.0f, %.0f]\n[[part]]\nsurface = \"core.ply\"\nmaterial = \"steel\"\n",
                0.9 * exact_hz, 1.1 * exact_hz);
  const auto recipe = bake::read_object(folder.write("ball.toml", text));
  ASSERT_TRUE(recipe) << recipe.error().message;
  EXPECT_EQ(recipe->options.makeup.parts[0].group, "core.ply");
  const auto made = bake::bake_object(*recipe, folder.path());
  ASSERT_TRUE(made) << made.error().message;
  const modal::Bank& bank = made->baked.bank;
  const std::size_t m = breathing_mode(bank);
  EXPECT_NEAR(bank.frequency_hz[m] / exact_hz, 1, 3e-3);

  const auto ball = [](double r) { return 4 * std::numbers::pi / 3 * r * r * r; };
  const double mass = 7850 * ball(kCore_m) + 2400 * (ball(kBall_m) - ball(kCore_m));
  EXPECT_NEAR(bank.mass->mass_kg / mass, 1, 5e-3);  // the surfaces' facets lack 0.2 %

  // Only the core loses: by the share of the mode's energy that is in it, which is how the frequency follows its
  // modulus.
  const double step = 1e-4;
  Layer softer = steel, stiffer = steel;
  softer.young_pa *= 1 - step, stiffer.young_pa *= 1 + step;
  const double share = std::log(breathing_hz(stiffer, glaze) / breathing_hz(softer, glaze)) / step;
  const double lambda = modal::undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]});
  std::printf("%.1f Hz, exactly %.1f; %.4f kg, exactly %.4f; share of the core %.4f, exactly %.4f\n",
              bank.frequency_hz[m], exact_hz, bank.mass->mass_kg, mass, 2 * bank.decay_per_s[m] / (beta_s * lambda),
              share);
  EXPECT_NEAR(bank.decay_per_s[m] / (0.5 * beta_s * lambda * share), 1, 0.01);

  const std::filesystem::path file = folder.path() / "ball.glb";
  ASSERT_TRUE(modal::write_bank(bank, file));
  EXPECT_EQ(modal::read_bank(file)->provenance.parts, std::vector<std::string>{"steel"});
}

TEST(PartedBody, ObjectFilesAndHashesKnowItsSurfaces) {
  const test::TemporaryFolder folder;
  const auto complaint = [&](const std::string& part) {
    return bake::parse_object("material = \"a\"\ngeometry = \"cup.stl\"\n[[part]]\nmaterial = \"b\"\n" + part,
                              folder.path() / "cup.toml")
        .error()
        .message;
  };
  EXPECT_NE(complaint("").find("give one of group and surface"), std::string::npos);
  EXPECT_NE(complaint("surface = \"a.stl\"\ngroup = \"a\"\n").find("give one of group and surface"), std::string::npos);
  EXPECT_NE(complaint("surface = \"../a.stl\"\n").find("must lie in the folder of the geometry"), std::string::npos);

  (void)folder.write("cup.stl", "1");
  (void)folder.write("m.toml", "2");
  const auto hash = [&](const char* surface) {
    return bake::input_hash({.object = folder.path() / "cup.stl",
                             .geometry = folder.path() / "cup.stl",
                             .material = folder.path() / "m.toml",
                             .options = {},
                             .part_surfaces = {folder.write("clay.stl", surface)}})
        .value();
  };
  const std::string one = hash("a"), other = hash("b");
  EXPECT_NE(one, other);
  EXPECT_EQ(one, hash("a"));

  bake::ObjectRecipe recipe{.material = "m", .geometry = folder.write("box.geo", "Box(1) = {0, 0, 0, 1, 1, 1};")};
  recipe.meshing.parts = {"clay.stl"};
  const auto body = bake::forecast(recipe, {.name = "m", .youngs_modulus_pa = 1e9, .density_kg_m3 = 1e3});
  ASSERT_FALSE(body);
  EXPECT_NE(body.error().message.find("is not a surface"), std::string::npos) << body.error().message;
}

}  // namespace
}  // namespace ringdown
