// What is made of banks, boxes and spheres; and their colours.
#include "clients/viewer/render/drawn_mesh.h"
#include "clients/viewer/render/look.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/vec2.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace ringdown::viewer {
namespace {

// A closed tube along z with `sides` sides: points 2 k below and 2 k + 1 above, then the middles of the caps.
modal::Bank drum(std::uint32_t sides) {
  modal::Bank bank;
  for (std::uint32_t k = 0; k < sides; ++k) {
    const float around = 2 * glm::pi<float>() * static_cast<float>(k) / static_cast<float>(sides);
    for (const float z : {0.0F, 0.5F}) bank.positions.push_back({std::cos(around), std::sin(around), z});
  }
  bank.positions.push_back({0, 0, 0});
  bank.positions.push_back({0, 0, 0.5F});
  for (std::uint32_t k = 0; k < sides; ++k) {
    const std::uint32_t a = 2 * k, b = 2 * ((k + 1) % sides);
    bank.triangles.push_back({a, b, a + 1});
    bank.triangles.push_back({b, b + 1, a + 1});
    bank.triangles.push_back({2 * sides, b, a});
    bank.triangles.push_back({2 * sides + 1, a + 1, b + 1});
  }
  return bank;
}

void expect_unit_and_outwards(const DrawnMesh& mesh, float min_cosine = 0.9F) {
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  ASSERT_EQ(mesh.origins.size(), mesh.positions.size());
  for (const auto& t : mesh.triangles) {
    const glm::vec3 a = mesh.positions.at(t[0]), b = mesh.positions.at(t[1]), c = mesh.positions.at(t[2]);
    const glm::vec3 area = glm::cross(b - a, c - a);
    if (glm::length(area) < 1e-9F) continue;
    for (const std::uint32_t corner : t) {
      EXPECT_NEAR(glm::length(mesh.normals[corner]), 1, 1e-5);
      EXPECT_GT(glm::dot(glm::normalize(area), mesh.normals[corner]), min_cosine);
    }
  }
}

TEST(DrawnMesh, ACylindersSideIsSmoothAndItsEdgeSharp) {
  constexpr std::uint32_t kSides = 16;
  const DrawnMesh mesh = shaded_mesh(drum(kSides));
  expect_unit_and_outwards(mesh);
  const float half_side = glm::pi<float>() / kSides;
  int at_the_rim = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 p = mesh.positions[i], n = mesh.normals[i];
    if (std::abs(n.z) > 0.5F) {
      EXPECT_NEAR(n.z, p.z > 0.25F ? 1 : -1, 1e-5);
      EXPECT_NEAR(p.z, p.z > 0.25F ? 0.5 : 0, 1e-5) << "caps stay flat";
    } else {
      const float radius = glm::length(glm::vec2(p));
      EXPECT_NEAR(radius, 1, 0.2 * (1 - std::cos(half_side))) << "five times rounder than flat sides";
      EXPECT_GT(glm::dot(n, glm::vec3(p.x, p.y, 0) / radius), std::cos(half_side / 2));
      if (p.z == 0) ++at_the_rim;
    }
  }
  EXPECT_GE(at_the_rim, static_cast<int>(4 * kSides));
  EXPECT_LT(glm::distance(mesh.high_m, glm::vec3(1, 1, 0.5F)), 1e-4F);
}

// Each edge, by the places of its ends, is that of two triangles that run along it in opposite directions.
void expect_closed(const DrawnMesh& mesh) {
  std::vector<std::size_t> place;  // of each corner: the first that is there too
  for (const glm::vec3& p : mesh.positions) {
    const auto there = std::find_if(mesh.positions.begin(), mesh.positions.end(),
                                    [&p](const glm::vec3& q) { return glm::distance(p, q) < 1e-5F; });
    place.push_back(static_cast<std::size_t>(there - mesh.positions.begin()));
  }
  std::map<std::pair<std::size_t, std::size_t>, int> runs;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      ++runs[{place[t[k]], place[t[(k + 1) % 3]]}];
      --runs[{place[t[(k + 1) % 3]], place[t[k]]}];
    }
  }
  for (const auto& [edge, balance] : runs) {
    const glm::vec3 p = mesh.positions[edge.first], q = mesh.positions[edge.second];
    ASSERT_EQ(balance, 0) << "open from " << p.x << " " << p.y << " " << p.z << " to " << q.x << " " << q.y << " "
                          << q.z;
  }
}

TEST(DrawnMesh, CurvingATriangleOpensNoGapAndKeepsFlatFacesFlat) {
  expect_closed(shaded_mesh(drum(16)));
  modal::Bank block;
  const DrawnMesh box = box_mesh({0.2F, 0.4F, 0.6F});
  for (std::size_t corner = 0; corner < 8; ++corner)
    block.positions.push_back({corner & 1 ? 0.1F : -0.1F, corner & 2 ? 0.2F : -0.2F, corner & 4 ? 0.3F : -0.3F});
  block.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  const DrawnMesh mesh = shaded_mesh(block);
  expect_closed(mesh);
  EXPECT_EQ(mesh.triangles.size(), 12u * 16);
  EXPECT_LT(glm::distance(mesh.high_m, box.high_m), 1e-6F);
  EXPECT_LT(glm::distance(mesh.low_m, box.low_m), 1e-6F);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 n = mesh.normals[i], outermost = glm::abs(mesh.positions[i] * n);
    EXPECT_NEAR(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1, 1e-5);
    EXPECT_NEAR(glm::length(outermost), glm::length(box.high_m * n), 1e-5);
  }
}

TEST(DrawnMesh, ASurfaceOfManyTrianglesIsNotCurved) {
  const modal::Bank bank = drum(kMaxPieces / 4);
  EXPECT_EQ(shaded_mesh(bank).triangles.size(), bank.triangles.size());
  EXPECT_LE(shaded_mesh(drum(300)).triangles.size(), kMaxPieces);
  EXPECT_EQ(shaded_mesh(drum(16)).triangles.size(), 64u * 16);
}

TEST(DrawnMesh, ABoxHasSixFlatFacesAndASphereIsRound) {
  const DrawnMesh box = box_mesh({2, 4, 6}), sphere = sphere_mesh(0.5F);
  expect_unit_and_outwards(box);
  expect_unit_and_outwards(sphere);
  EXPECT_EQ(box.positions.size(), 24u);
  for (const glm::vec3& n : box.normals) EXPECT_FLOAT_EQ(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1);
  EXPECT_EQ(box.high_m, glm::vec3(1, 2, 3));
  for (std::size_t i = 0; i < sphere.positions.size(); ++i)
    EXPECT_LT(glm::distance(sphere.positions[i], 0.5F * sphere.normals[i]), 1e-6F);
}

TEST(DrawnMesh, ABankWithoutTrianglesIsDrawnAsMarksAtItsPoints) {
  modal::Bank bank = drum(24);
  bank.triangles.clear();
  const DrawnMesh mesh = shaded_mesh(bank);
  expect_unit_and_outwards(mesh, 0.577F);  // an octahedron's corners and faces: 1 / sqrt(3)
  EXPECT_EQ(mesh.triangles.size(), 8 * bank.positions.size());
  bank.positions.resize(kMaxMarks, {0, 0, 1});
  EXPECT_EQ(shaded_mesh(bank).triangles.size(), 8 * kMaxMarks);
  bank.positions.resize(kMaxMarks + 1, {0, 0, 1});
  EXPECT_LE(shaded_mesh(bank).triangles.size(), 8 * kMaxMarks);
  EXPECT_TRUE(shaded_mesh({}).positions.empty());
}

TEST(ModeDisplacement, ModeDisplacementsAreRankedByFrequencyAndMoveByOneAtMost) {
  modal::Bank bank;
  bank.frequency_hz = {300, 100, 200};
  bank.positions = {{0, 0, 0}, {1, 0, 0}};
  bank.shapes = {{0, 0, 3}, {0, 0, 0}, {0, 0, 0}, {3, 0, 4}, {0, 0, 0}, {0, 0, 0}};
  const Displacement lowest = mode_displacement(bank, 0), highest = mode_displacement(bank, 2);
  EXPECT_EQ((*lowest)[0], glm::vec3(0));
  EXPECT_LT(glm::distance((*lowest)[1], glm::vec3(0.6F, 0, 0.8F)), 1e-6F);
  EXPECT_EQ((*highest)[0], glm::vec3(0, 0, 1));
  EXPECT_EQ((*mode_displacement(bank, 1))[1], glm::vec3(0)) << "a mode in which nothing moves";
}

std::vector<glm::vec3> area_normals(const DrawnMesh& mesh) {
  std::vector<glm::vec3> normals(mesh.positions.size(), glm::vec3(0));
  for (const auto& t : mesh.triangles) {
    const glm::vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    for (const std::uint32_t corner : t) normals[corner] += glm::cross(b - a, c - a);
  }
  for (glm::vec3& n : normals) n = glm::normalize(n);
  return normals;
}

TEST(ModeDisplacement, NormalChangesAreThoseOfTheDisplacedMesh) {
  const modal::Bank bank = drum(12);
  std::vector<glm::vec3> displacement;
  for (const auto& [x, y, z] : bank.positions) displacement.emplace_back(z * y, -z * x, x * x);
  DrawnMesh mesh = shaded_mesh(bank);
  const std::vector<glm::vec3> moves = corner_moves(mesh, displacement), changes = normal_changes(mesh, moves);
  const std::vector<glm::vec3> rest = area_normals(mesh);
  constexpr float kSmall = 5e-3F;
  for (std::size_t i = 0; i < moves.size(); ++i) mesh.positions[i] += kSmall * moves[i];
  const std::vector<glm::vec3> moved = area_normals(mesh);
  float max = 0;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    EXPECT_LT(glm::distance(glm::normalize(rest[i] + kSmall * changes[i]), moved[i]), 2e-4F);
    max = std::max(max, glm::distance(rest[i], moved[i]));
  }
  EXPECT_GT(max, 5e-3F) << "the normals do turn";
}

TEST(ModeDisplacement, PiecesMoveWithTheTriangleTheyBelongTo) {
  const modal::Bank bank = drum(12);
  std::vector<glm::vec3> displacement;
  for (const auto& [x, y, z] : bank.positions) displacement.emplace_back(x, 2 * y, -z);
  const DrawnMesh mesh = shaded_mesh(bank);
  const std::vector<glm::vec3> moves = corner_moves(mesh, displacement);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const glm::vec3 p = mesh.positions[i];
    EXPECT_LT(glm::distance(moves[i], glm::vec3(p.x, 2 * p.y, -p.z)), 0.08F) << "linear, but for the bulge";
  }
  for (const glm::vec3& none : corner_moves(mesh, {})) EXPECT_EQ(none, glm::vec3(0));
}

TEST(Palette, AMaterialKeepsItsColourAndFamiliesDiffer) {
  EXPECT_EQ(material_colour("bronze"), material_colour("Bronze"));
  EXPECT_EQ(material_colour("steel"), material_colour("stainless-steel"));
  EXPECT_EQ(material_colour("unheard-of"), material_colour("unheard-of"));
  EXPECT_NE(material_colour("porcelain"), material_colour("tin"));
  EXPECT_NE(material_colour("alumina"), material_colour("aluminium"));
  std::set<float> reds;
  for (const char* name : {"bronze", "brass", "steel", "glass", "wood", "granite", "porcelain", "plastic"})
    reds.insert(material_colour(name).r + 3 * material_colour(name).g);
  EXPECT_EQ(reds.size(), 8u);
}

}  // namespace
}  // namespace ringdown::viewer
