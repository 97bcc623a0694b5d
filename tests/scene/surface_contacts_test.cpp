// Where surfaces touch, against closed forms of boxes.
#include "engine/scene/surface_contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace ringdown::scene::surface_contacts_test {
namespace {

constexpr Vec3 kBar{0.4, 0.04, 0.02};
constexpr double kMargin_m = 1e-4;
const DepthLimit kLimit{0.004, 0.004, [](Vec3, Vec3) { return 0.0; }};

std::vector<SurfaceContact> contacts(const Surface& first, const Surface& second, Rotation turn, Vec3 position) {
  std::vector<SurfaceContact> found;
  find_surface_contacts(first, second, {to_matrix(turn), position}, kMargin_m, kLimit, found);
  return found;
}

bool any_at(const std::vector<SurfaceContact>& found, Vec3 point) {
  return std::ranges::any_of(found, [&](const SurfaceContact& c) { return length(c.point - point) < 1e-4; });
}

TEST(SurfaceContacts, ABoxOnABoxTouchesAtTheCornersOfTheSharedRectangle) {
  const Surface big = box_surface({0.4, 0.3, 0.1}), small = box_surface({0.1, 0.06, 0.02});
  for (const double depth_m : {0.001, 0.0, -5e-5}) {
    const auto found = contacts(small, big, {}, {0.05, 0.02, 0.06 - depth_m});
    ASSERT_GE(found.size(), 4u) << depth_m;
    for (const SurfaceContact& contact : found) {
      EXPECT_NEAR(contact.depth_m, depth_m, 1e-12);
      EXPECT_NEAR(contact.normal.z, 1, 1e-12);
    }
    for (const double x : {0.0, 0.1}) {
      for (const double y : {-0.01, 0.05}) EXPECT_TRUE(any_at(found, {x, y, 0.05})) << x << ' ' << y;
    }
  }
  EXPECT_TRUE(contacts(small, big, {}, {0.05, 0.02, 0.06 + 2 * kMargin_m}).empty());
}

TEST(SurfaceContacts, CrossedBarsTouchAtTheFourCrossingsOfTheirEdges) {
  const Surface bar = box_surface(kBar);
  const auto found = contacts(bar, bar, about({0, 0, 1}, 0.5 * M_PI), {0, 0, kBar.z - 0.0005});
  for (const double x : {-0.02, 0.02}) {
    for (const double y : {-0.02, 0.02}) EXPECT_TRUE(any_at(found, {x, y, 0.01})) << x << ' ' << y;
  }
  for (const SurfaceContact& contact : found) {
    EXPECT_NEAR(contact.depth_m, 0.0005, 1e-12);
    EXPECT_NEAR(contact.normal.z, 1, 1e-9);
  }
}

// Two bars stand on their long edges, one across the other.
TEST(SurfaceContacts, TwoEdgesAcrossEachOtherTouchAlongTheirCommonPerpendicular) {
  const Surface bar = box_surface({0.4, 0.04, 0.04});
  const Rotation on_edge = about({1, 0, 0}, 0.25 * M_PI);
  const double half = 0.02 * std::sqrt(2);
  const Rotation across = Rotation::from_xyzw(-on_edge.x, 0, 0, on_edge.w) * about({0, 0, 1}, 0.5 * M_PI) * on_edge;
  for (const double depth_m : {0.002, -5e-5}) {
    const Vec3 away = transpose(to_matrix(on_edge)) * Vec3{0, 0, 2 * half - depth_m};
    const auto found = contacts(bar, bar, across, away);
    ASSERT_EQ(found.size(), 1u) << depth_m;
    EXPECT_NEAR(found[0].depth_m, depth_m, 1e-12);
    EXPECT_NEAR(length(found[0].normal - (1 / length(away)) * away), 0, 1e-9);
  }
}

TEST(SurfaceContacts, ContactsOfTwoSurfacesAreTheSameTheOtherWayRound) {
  const Surface bar = box_surface(kBar), block = box_surface({0.1, 0.1, 0.1});
  const Rotation turn = about({0.02, 0.01, 1}, 0.7);
  const Vec3 position{0.01, 0.02, 0.0596};
  const Matrix3 back = transpose(to_matrix(turn));
  std::vector<SurfaceContact> other;
  find_surface_contacts(block, bar, {back, -1 * (back * position)}, kMargin_m, kLimit, other);
  const auto found = contacts(bar, block, turn, position);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.size(), other.size());
  const auto deepest = [](const auto& all) { return std::ranges::max(all, {}, &SurfaceContact::depth_m).depth_m; };
  EXPECT_NEAR(deepest(found), deepest(other), 1e-12);
}

TEST(SurfaceContacts, TheThicknessOfAPlateIsNearlyItsHeight) {
  EXPECT_NEAR(box_surface({0.3, 0.2, 0.002}).thickness_m, 0.002, 0.0001);
}

}  // namespace
}  // namespace ringdown::scene::surface_contacts_test
