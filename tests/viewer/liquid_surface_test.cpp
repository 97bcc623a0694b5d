// The drawn surface of a liquid.
#include "clients/viewer/render/liquid_surface.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace ringdown::viewer {
namespace {

constexpr std::uint32_t kSides = 24;
constexpr float kHeight = 0.1F, kFloor = 0.02F, kOuter = 0.05F, kInner = 0.04F;

// A round pot about `middle`, whose liquid lies along z.
modal::Bank pot(float middle) {
  modal::Bank bank;
  bank.provenance.liquids = {{.liquid = "water"}};
  const auto ring = [&](float radius, float z) {
    const auto first = static_cast<std::uint32_t>(bank.positions.size());
    for (std::uint32_t k = 0; k < kSides; ++k) {
      const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(k) / kSides;
      bank.positions.push_back({middle + radius * std::cos(angle), radius * std::sin(angle), z});
    }
    return first;
  };
  const auto band = [&](std::uint32_t low, std::uint32_t high) {  // seen from the side on which high is to the left
    for (std::uint32_t k = 0; k < kSides; ++k) {
      const std::uint32_t n = (k + 1) % kSides;
      bank.triangles.push_back({low + k, low + n, high + n});
      bank.triangles.push_back({low + k, high + n, high + k});
    }
  };
  const std::uint32_t below = ring(kOuter, 0), outer = ring(kOuter, kHeight), inner = ring(kInner, kHeight),
                      bottom = ring(kInner, kFloor), under = ring(0, 0), over = ring(0, kFloor);
  band(under, below), band(below, outer), band(outer, inner), band(inner, bottom), band(bottom, over),
      band(over, under);
  return bank;
}

float area(const DrawnMesh& mesh) {
  float sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += 0.5F * glm::cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]).z;
  return sum;
}

TEST(LiquidSurface, ItFillsTheVesselToItsWallAndFacesUp) {
  const float polygon = 0.5F * kSides * kInner * kInner * std::sin(2 * std::numbers::pi_v<float> / kSides);
  for (const float middle : {0.0F, 0.3F}) {
    const auto surface = liquid_surface(pot(middle), 0.063);
    ASSERT_TRUE(surface);
    EXPECT_NEAR(area(*surface) / polygon, 1, 1e-4);
    EXPECT_NEAR(surface->low_m.z, 0.063, 1e-6);
    EXPECT_NEAR(surface->high_m.z, 0.063, 1e-6);
    EXPECT_NEAR(surface->high_m.x, middle + kInner, 1e-6);
  }
}

TEST(LiquidSurface, AnEmptyVesselAndALevelAboveTheRimHaveNone) {
  EXPECT_FALSE(liquid_surface(pot(0), kFloor - 0.005));
  EXPECT_FALSE(liquid_surface(pot(0), kHeight + 0.01));
  EXPECT_FALSE(liquid_surface({}, 0));
}

}  // namespace
}  // namespace ringdown::viewer
