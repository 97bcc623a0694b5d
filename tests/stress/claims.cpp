#include "tests/stress/claims.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include <sys/resource.h>

namespace ringdown::test {
namespace {

// Where a band may end: above the least modes, in the first gap that errors up to the limit do not close.
std::size_t modes_below_a_gap(const std::vector<double>& truth, double limit, std::size_t min) {
  std::size_t count = min;
  while (count < truth.size() && truth[count] < truth[count - 1] * (1 + 1.2 * limit)) ++count;
  return count;
}

double worst_error(const std::vector<double>& found, const std::vector<double>& truth) {
  double worst = 0;
  for (std::size_t m = 0; m < std::min(found.size(), truth.size()); ++m) {
    worst = std::max(worst, std::abs(found[m] / truth[m] - 1));
  }
  return worst;
}

std::vector<double> sorted_frequencies(const modal::Bank& bank) {
  std::vector<double> sorted = bank.frequency_hz;
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

std::string memory_so_far() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  char text[32];
  std::snprintf(text, sizeof text, "%.1f GiB at most", static_cast<double>(usage.ru_maxrss) / (1 << 20));
  return text;
}

}  // namespace

fem::Elastic elastic(const modal::Material& material) {
  return {material.youngs_modulus_pa, material.poisson_ratio, material.density_kg_m3};
}

void expect_baked(const Body& body) {
  const std::size_t there = modes_below_a_gap(body.truth_hz, body.limit, body.min_modes);
  ASSERT_LT(there, body.truth_hz.size()) << "no gap: compute more of the truth";
  const double top = body.truth_hz[there] * (1 - 0.1 * body.limit);
  const auto checked = mesh::check_mesh(body.mesh, body.name);
  ASSERT_TRUE(checked) << checked.error().message;
  const auto start = std::chrono::steady_clock::now();
  const auto baked =
      bake::bake(*checked, body.material, {.element = body.element, .band_low_hz = 0, .band_high_hz = top}, body.name);
  ASSERT_TRUE(baked) << baked.error().message;
  const std::vector<double> found = sorted_frequencies(baked->bank);
  const double worst = worst_error(found, body.truth_hz);
  enter({.name = body.name,
         .hard = body.hard,
         .unknowns = baked->report.unknowns,
         .found = static_cast<int>(found.size()),
         .there = static_cast<int>(there),
         .error = worst,
         .limit = body.limit,
         .estimate = baked->report.largest_error,
         .seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
         .outcome = "against " + body.oracle + (baked->report.unknowns > 100000 ? "; " + memory_so_far() : "")});
  EXPECT_EQ(baked->report.rigid, body.rigid);
  EXPECT_EQ(found.size(), there);
  EXPECT_LE(worst, body.limit);
  EXPECT_LE(worst, body.shortfall * baked->report.largest_error);
}

void expect_like(Body body, const mesh::TetMesh& sound, double top_hz, double factor) {
  body.truth_hz = baked_frequencies(sound, kSteel, {.element = body.element, .band_low_hz = 0, .band_high_hz = top_hz});
  for (double& frequency : body.truth_hz) frequency *= factor;
  expect_baked(body);
}

std::vector<double> baked_frequencies(const mesh::TetMesh& mesh, const modal::Material& material,
                                      const bake::BakeOptions& options) {
  const auto checked = mesh::check_mesh(mesh, "body");
  EXPECT_TRUE(checked) << checked.error().message;
  if (!checked) return {};
  const auto baked = bake::bake(*checked, material, options, "body");
  EXPECT_TRUE(baked) << baked.error().message;
  return baked ? sorted_frequencies(baked->bank) : std::vector<double>();
}

void expect_refused(const std::string& name, const std::string& hard, const mesh::TetMesh& mesh,
                    const modal::Material& material, const std::vector<std::string>& words) {
  const auto checked = mesh::check_mesh(mesh, "body");
  std::string sentence = "accepted";
  if (!checked) sentence = checked.error().message;
  if (checked) {
    const auto baked = bake::bake(*checked, material, {}, "body");
    if (!baked) sentence = baked.error().message;
  }
  enter({.name = name, .hard = hard, .outcome = (sentence == "accepted" ? "" : "refused: ") + sentence});
  for (const std::string& word : words) EXPECT_NE(sentence.find(word), std::string::npos) << sentence;
}

}  // namespace ringdown::test
