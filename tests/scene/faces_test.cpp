#include "engine/scene/faces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace ringdown::scene::faces_test {
namespace {

constexpr Matrix3 kStraight{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

TEST(Faces, FacesOfABoxAreSixWhetherMadeOfTrianglesOrNot) {
  std::vector<Vec3> points;
  for (int k = 0; k < 8; ++k) points.push_back({k & 1 ? 1.0 : -1.0, k & 2 ? 2.0 : -2.0, k & 4 ? 3.0 : -3.0});
  const std::vector<std::array<std::uint32_t, 3>> triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                                               {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                                               {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  for (const auto& faces : {flat_faces(points, triangles), box_faces({2, 4, 6})}) {
    ASSERT_EQ(faces.size(), 6u);
    for (const Face& face : faces) {
      ASSERT_EQ(face.corners.size(), 4u);
      for (std::size_t k = 0; k < 4; ++k) {
        const Vec3 a = face.corners[k], b = face.corners[(k + 1) % 4], c = face.corners[(k + 2) % 4];
        EXPECT_GT(dot(cross(b - a, c - b), face.normal), 0) << "counter-clockwise from outside";
        EXPECT_GT(dot(face.normal, a), 0) << "outwards";
      }
    }
  }
}

TEST(Faces, FacesOfTwoBoxesShareTheRectangleWhereOneLiesOnTheOther) {
  const auto faces = box_faces({2, 2, 2});
  const PosedFaces lower{faces, kStraight, {0, 0, 0}}, upper{faces, kStraight, {0.5, -0.25, 1.99}};
  const FaceContact contact = share_of_faces(upper, lower, {0, 0, 1});
  ASSERT_EQ(contact.points.size(), 4u);
  double min_x = 9, max_x = -9, min_y = 9, max_y = -9;
  for (const auto& [point, depth] : contact.points) {
    EXPECT_NEAR(depth, 0.01, 1e-12);
    EXPECT_NEAR(point.z, 0.995, 1e-12) << "half way";
    min_x = std::min(min_x, point.x), max_x = std::max(max_x, point.x);
    min_y = std::min(min_y, point.y), max_y = std::max(max_y, point.y);
  }
  EXPECT_NEAR(min_x, -0.5, 1e-12);
  EXPECT_NEAR(max_x, 1, 1e-12);
  EXPECT_NEAR(min_y, -1, 1e-12);
  EXPECT_NEAR(max_y, 0.75, 1e-12);
  EXPECT_NEAR(length(contact.normal - Vec3{0, 0, 1}), 0, 1e-12);
}

TEST(Faces, TheNormalOfSharedFacesPointsIntoTheFirstOfTheTwo) {
  const auto faces = box_faces({2, 2, 2});
  const PosedFaces lower{faces, kStraight, {0, 0, 0}}, upper{faces, kStraight, {0.5, -0.25, 1.99}};
  EXPECT_NEAR(share_of_faces(lower, upper, {0, 0, -1}).normal.z, -1, 1e-12);
}

TEST(Faces, FacesTurnedByAnEighthShareAnOctagon) {
  const auto faces = box_faces({2, 2, 2});
  const PosedFaces lower{faces, kStraight, {0, 0, 0}};
  const PosedFaces upper{faces, to_matrix(about({0, 0, 1}, std::acos(-1.0) / 4)), {0, 0, 1.999}};
  const FaceContact contact = share_of_faces(upper, lower, {0, 0, 1});
  EXPECT_EQ(contact.points.size(), 8u);
}

TEST(Faces, FacesOnACornerOrAnEdgeShareNothing) {
  const auto faces = box_faces({2, 2, 2});
  const PosedFaces lower{faces, kStraight, {0, 0, 0}};
  const PosedFaces upper{faces, to_matrix(about({0, 1, 0}, 0.6)), {1.9, 0, 1.9}};
  EXPECT_TRUE(share_of_faces(upper, lower, (1 / std::sqrt(2.0)) * Vec3{1, 0, 1}).points.empty());
}

}  // namespace
}  // namespace ringdown::scene::faces_test
