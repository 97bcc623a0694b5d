#include "engine/modal/surface_index.h"

#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <random>

namespace ringdown::modal {
namespace {

using namespace ringdown::test;  // NOLINT: the synthetic banks

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) { return low + (high - low) * static_cast<double>(engine_()) / 4294967296.0; }
  Vec3 point(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
  std::uint32_t below(std::size_t limit) { return static_cast<std::uint32_t>(engine_() % limit); }

 private:
  std::mt19937 engine_;
};

Vec3 at(const Bank& bank, std::uint32_t p) {
  return {bank.positions[p][0], bank.positions[p][1], bank.positions[p][2]};
}

// Nearest distance to a triangle by projection onto ever smaller pieces of it: no case distinctions to share.
double distance_by_search(Vec3 q, Vec3 a, Vec3 b, Vec3 c) {
  // f(s, t) = |a + s (b - a) + t (c - a) - q|^2 is convex on the triangle: alternate exact line searches would crawl,
  // so minimise over t in closed form for each s, and over s by golden section.
  const auto best_t = [&](double s) {
    const Vec3 start = a + s * (b - a), along = c - a;
    const double squared = dot(along, along);
    const double t = squared > 0 ? dot(q - start, along) / squared : 0;
    const double clamped = std::min(std::max(t, 0.0), 1 - s);
    const Vec3 offset = start + clamped * along - q;
    return dot(offset, offset);
  };
  constexpr double kGolden = 0.6180339887498949;
  double low = 0, high = 1;
  for (int i = 0; i < 90; ++i) {
    const double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
    (best_t(left) <= best_t(right) ? high : low) = best_t(left) <= best_t(right) ? right : left;
  }
  return std::sqrt(std::min({best_t(0), best_t(1), best_t((low + high) / 2)}));
}

double distance_by_force(const Bank& bank, Vec3 q) {
  double best = INFINITY;
  for (const auto& [a, b, c] : bank.triangles) {
    best = std::min(best, distance_by_search(q, at(bank, a), at(bank, b), at(bank, c)));
  }
  if (bank.triangles.empty()) {
    for (std::uint32_t p = 0; p < bank.point_count(); ++p) best = std::min(best, length(at(bank, p) - q));
  }
  return best;
}

void expect_nearest(const Bank& bank, const SurfaceIndex& index, Vec3 query) {
  const SurfacePoint hit = index.nearest(query);
  Vec3 point;
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_GE(hit.weights[i], 0);
    point = point + hit.weights[i] * at(bank, hit.points[i]);
    sum += hit.weights[i];
  }
  EXPECT_NEAR(sum, 1, 1e-9);
  EXPECT_NEAR(length(point - query), hit.distance_m, 1e-9);
  EXPECT_NEAR(hit.distance_m, distance_by_force(bank, query), 1e-7);
}

TEST(SurfaceIndex, TheIndexFindsWhatSearchingEveryTriangleFinds) {
  for (const std::size_t points : {4, 30, 200}) {
    const Bank bank = random_bank(static_cast<std::uint32_t>(points), 1, points);
    const SurfaceIndex index(bank);
    Random random(1);
    for (int i = 0; i < 100; ++i) {
      expect_nearest(bank, index, random.point(i % 2 == 0 ? 0.15 : 1.0));
      ASSERT_FALSE(testing::Test::HasFailure());
    }
  }
}

// Any heap of triangles at all: crossing, repeated, flat ones among them.
TEST(SurfaceIndex, TheIndexCopesWithTriangleSoup) {
  Random random(2);
  Bank bank = single_mode_bank(1, 1);
  bank.positions.clear();
  bank.triangles.clear();
  for (int i = 0; i < 60; ++i) {
    const Vec3 p = random.point(1);
    bank.positions.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  }
  for (int i = 0; i < 120; ++i) bank.triangles.push_back({random.below(60), random.below(60), random.below(60)});
  bank.triangles.push_back({5, 5, 5});
  bank.triangles.push_back({5, 6, 6});
  bank.triangles.insert(bank.triangles.end(), 30, bank.triangles[0]);
  const SurfaceIndex index(bank);
  for (int i = 0; i < 200; ++i) {
    expect_nearest(bank, index, random.point(1.5));
    ASSERT_FALSE(testing::Test::HasFailure());
  }
}

// Triangles ten thousand times longer than wide: weights must stay weights.
TEST(SurfaceIndex, TheIndexCopesWithSlivers) {
  Random random(3);
  Bank bank = single_mode_bank(1, 1);
  bank.positions.clear();
  bank.triangles.clear();
  for (std::uint32_t i = 0; i < 40; ++i) {
    const Vec3 a = random.point(1), b = random.point(1), c = a + (random.uniform(0, 1) * (b - a) + random.point(1e-4));
    for (const Vec3 p : {a, b, c}) {
      bank.positions.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    }
    bank.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const SurfaceIndex index(bank);
  for (int i = 0; i < 200; ++i) {
    expect_nearest(bank, index, random.point(1.5));
    ASSERT_FALSE(testing::Test::HasFailure());
  }
}

TEST(SurfaceIndex, AnIndexWithoutTrianglesFindsTheNearestPoint) {
  Bank bank = random_bank(5, 1, 500);
  bank.triangles.clear();
  const SurfaceIndex index(bank);
  Random random(4);
  for (int i = 0; i < 200; ++i) expect_nearest(bank, index, random.point(0.2));
}

// Boxes are compared in float: where float cannot tell them apart, none with the nearest point may be dropped.
TEST(SurfaceIndex, TheIndexFindsTheNearestOfPointsThatFloatsHardlyTellApart) {
  Random random(6);
  Bank bank = single_mode_bank(1, 1);
  bank.positions.clear();
  bank.triangles.clear();
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = Vec3{700, -900, 1000} + random.point(0.01);
    bank.positions.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  }
  const SurfaceIndex index(bank);
  for (int i = 0; i < 500; ++i) {
    const Vec3 query = Vec3{700, -900, 1000} + random.point(0.02);
    ASSERT_EQ(index.nearest(query).distance_m, distance_by_force(bank, query));
  }
}

TEST(SurfaceIndex, TheIndexTakesABankOfOnePoint) {
  Bank bank = single_mode_bank(1, 1);
  bank.positions.resize(1);
  bank.shapes.resize(1);
  bank.triangles.clear();
  const SurfacePoint hit = SurfaceIndex(bank).nearest({5, 5, 5});
  EXPECT_EQ(hit.points[0], 0u);
  EXPECT_NEAR(hit.weights[0] + hit.weights[1] + hit.weights[2], 1, 1e-15);
}

TEST(SurfaceIndex, TheIndexCopesWithThousandsOfPointsOnOneSpot) {
  Bank bank = single_mode_bank(1, 1);
  bank.positions.assign(5000, {1, 2, 3});
  bank.triangles.clear();
  EXPECT_NEAR(SurfaceIndex(bank).nearest({1, 2, 4}).distance_m, 1, 1e-12);
}

}  // namespace
}  // namespace ringdown::modal
