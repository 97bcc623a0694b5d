// What the reading process sends back is taken apart as if it were hostile.
#include "engine/mesh/body.h"
#include "tests/mesh/sample_surfaces.h"

#include <gtest/gtest.h>

#include <limits>

namespace ringdown {
namespace {

mesh::Body body() {
  mesh::TetMesh mesh;
  mesh.nodes.resize(4, 3);
  mesh.nodes << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  mesh.elements.resize(1, 4);
  mesh.elements << 0, 1, 2, 3;
  return {.mesh = mesh::check_mesh(mesh, "x").value(), .making = mesh::Making::kFilled, .notes = {"a note"}};
}

mesh::PreparedSurface surface() {
  mesh::PreparedSurface surface{.mesh = test::box({0, 0, 0}, {1, 1, 1}), .found = {}, .left = {}, .actions = {"did"}};
  surface.found.findings.push_back({.fault = mesh::Fault::kHole,
                                    .count = 2,
                                    .places = {Eigen::RowVector3d(1, 2, 3)},
                                    .triangles = {},
                                    .length_m = 0.5});
  surface.found.shells = 1;
  return surface;
}

template <class Answer>
bool accepts(const std::string& bytes) {
  Answer answer{};
  return mesh::unpack(bytes, answer);
}

TEST(Answer, WhatWasPackedComesBack) {
  mesh::Body read;
  ASSERT_TRUE(mesh::unpack(packed(body()), read));
  EXPECT_TRUE(read.mesh.mesh.nodes == body().mesh.mesh.nodes);
  EXPECT_EQ(read.notes, body().notes);
  mesh::PreparedSurface prepared;
  ASSERT_TRUE(mesh::unpack(packed(surface()), prepared));
  EXPECT_EQ(describe(prepared.found.findings.at(0)), describe(surface().found.findings.at(0)));
  EXPECT_EQ(prepared.actions, surface().actions);
  mesh::Sketch sketch;
  ASSERT_TRUE(mesh::unpack(packed(mesh::Sketch{surface().mesh, 0.25}), sketch));
  EXPECT_EQ(sketch.wall_m, 0.25);
  Error error{};
  ASSERT_TRUE(mesh::unpack(mesh::packed(Error{ErrorKind::too_large, "it \x1b[2J is"}), error));
  EXPECT_EQ(error.message, "it ?[2J is");
  EXPECT_EQ(error.kind, ErrorKind::too_large);
  mesh::Question question{};
  mesh::GmshOptions options;
  ASSERT_TRUE(unpack_question(packed(mesh::Question::kBody, {.unit_m = 0.001, .order = 2, .parameters = {{"a", 3}}}),
                              question, options));
  EXPECT_EQ(question, mesh::Question::kBody);
  EXPECT_EQ(options.parameters.at("a"), 3);
}

TEST(Answer, CutOffOrLongerOnesAreRefused) {
  const auto try_all = [](const std::string& good, bool (*accept)(const std::string&)) {
    EXPECT_TRUE(accept(good));
    for (std::size_t size = 0; size < good.size(); ++size) EXPECT_FALSE(accept(good.substr(0, size))) << size;
    EXPECT_FALSE(accept(good + '\0'));
  };
  try_all(packed(body()), accepts<mesh::Body>);
  try_all(packed(surface()), accepts<mesh::PreparedSurface>);
  try_all(packed(mesh::Sketch{surface().mesh, 0.25}), accepts<mesh::Sketch>);
}

TEST(Answer, NumbersOutOfRangeAreRefused) {
  constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
  const auto bad_body = [](const auto& change) {
    mesh::Body bad = body();
    change(bad);
    return !accepts<mesh::Body>(packed(bad));
  };
  EXPECT_TRUE(bad_body([](auto& b) { b.mesh.mesh.elements(0, 2) = 4; }));
  EXPECT_TRUE(bad_body([](auto& b) { b.mesh.mesh.elements(0, 2) = -1; }));
  EXPECT_TRUE(bad_body([](auto& b) { b.mesh.mesh.nodes(0, 2) = kNothing; }));
  EXPECT_TRUE(bad_body([](auto& b) { b.making = static_cast<mesh::Making>(9); }));
  EXPECT_TRUE(bad_body([](auto& b) { b.mesh.pieces = 2; }));
  EXPECT_TRUE(bad_body([](auto& b) { b.mesh.mesh.elements.conservativeResize(0, 4); }));
  const auto bad_surface = [](const auto& change) {
    mesh::PreparedSurface bad = surface();
    change(bad);
    return !accepts<mesh::PreparedSurface>(packed(bad));
  };
  EXPECT_TRUE(bad_surface([](auto& s) { s.mesh.triangles(3, 1) = 8; }));
  EXPECT_TRUE(bad_surface([](auto& s) { s.mesh.nodes(3, 1) = kNothing; }));
  EXPECT_TRUE(bad_surface([](auto& s) { s.found.findings[0].fault = static_cast<mesh::Fault>(99); }));
  EXPECT_TRUE(bad_surface([](auto& s) { s.found.findings[0].places.resize(4, Eigen::RowVector3d(0, 0, 0)); }));
  EXPECT_TRUE(bad_surface([](auto& s) { s.left.volume_m3 = kNothing; }));
  EXPECT_FALSE(accepts<mesh::Sketch>(packed(mesh::Sketch{surface().mesh, -1})));
  EXPECT_FALSE(accepts<Error>(mesh::packed(Error{static_cast<ErrorKind>(77), "x"})));
  EXPECT_FALSE(accepts<Error>(mesh::packed(Error{ErrorKind::cancelled, "x"})));
}

}  // namespace
}  // namespace ringdown
