// Bodies as people bring them, damaged in the ways that surfaces from the world are, against the same bodies made by a
// CAD kernel and meshed by gmsh: every one bakes to frequencies near those, or is refused with the right sentence.
#include "engine/bake/bake_object.h"
#include "tests/mesh/sample_surfaces.h"
#include "tests/mesh/surface_files.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace ringdown {
namespace {

using test::TemporaryFolder;

const modal::Material kCeramic{"ceramic", 70e9, 0.22, 2400, {5, 1e-8}};

bake::ObjectRecipe recipe_of(const std::filesystem::path& path, double size_m, double unit_m) {
  bake::ObjectRecipe recipe{.name = path.stem().string(), .geometry = path};
  recipe.meshing = {.unit_m = unit_m, .mesh_size_m = size_m, .order = 3, .parameters = {}};
  recipe.options.element = fem::Element::kTet20;
  recipe.options.band_high_hz = 100e3;
  recipe.options.points = 40;
  return recipe;
}

// The first frequencies, ascending.
using Notes = std::vector<double>;
constexpr std::size_t kNotes = 6;

Notes notes_of(const bake::BakedObject& object) {
  Notes notes = object.baked.bank.frequency_hz;
  std::sort(notes.begin(), notes.end());
  notes.resize(std::min(notes.size(), kNotes));
  return notes;
}

struct Shape {
  std::string geo;  // for gmsh's OpenCASCADE, in metres
  mesh::TriangleMesh surface;
  double size_m;
  double top_hz;  // so that some ten modes are looked for
};

const std::map<std::string, Shape>& shapes() {
  static const std::map<std::string, Shape> all = {
      {"block", {"Box(1) = {0, 0, 0, 0.1, 0.08, 0.06};", test::box({0, 0, 0}, {0.1, 0.08, 0.06}), 0.025, 45e3}},
      {"bar", {"Box(1) = {0, 0, 0, 0.2, 0.02, 0.01};", test::box({0, 0, 0}, {0.2, 0.02, 0.01}), 0.012, 12e3}},
      {"ball", {"Sphere(1) = {0, 0, 0, 0.05};", test::sphere(0.05, 48), 0.025, 50e3}},
      {"rod", {"Cylinder(1) = {0, 0, 0, 0, 0, 0.15, 0.02};", test::cylinder(0.02, 0.15, 48), 0.015, 20e3}},
      {"ring", {"Torus(1) = {0, 0, 0, 0.05, 0.012};", test::torus(0.05, 0.012, 32), 0.02, 16e3}},
      {"tube",
       {"Cylinder(1) = {0, 0, 0, 0, 0, 0.1, 0.03}; Cylinder(2) = {0, 0, 0, 0, 0, 0.1, 0.024}; "
        "BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };",
        test::tube(0.024, 0.03, 0.1, 64), 0.012, 20e3}},
      {"cup",
       {"Cylinder(1) = {0, 0, 0, 0, 0, 0.08, 0.04}; Cylinder(2) = {0, 0, 0.006, 0, 0, 0.08, 0.034}; "
        "BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };",
        test::cup(0.04, 0.08, 0.006, 64), 0.02, 14e3}},
      {"bowl",
       {"Sphere(1) = {0, 0, 0, 0.05, -Pi/2, 0}; Sphere(2) = {0, 0, 0, 0.044}; "
        "BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };",
        test::bowl(0.05, 0.006, 64), 0.02, 14e3}},
      {"L",
       {"Box(1) = {0, 0, 0, 0.12, 0.04, 0.02}; Box(2) = {0, 0.04, 0, 0.06, 0.04, 0.02}; "
        "BooleanUnion(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };",
        test::l_shape(0.12, 0.04, 0.02), 0.02, 22e3}},
      {"hollow",
       {"Box(1) = {0, 0, 0, 0.1, 0.08, 0.06}; Box(2) = {0.02, 0.02, 0.02, 0.06, 0.04, 0.02}; "
        "BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };",
        test::united(test::box({0, 0, 0}, {0.1, 0.08, 0.06}),
                     test::inside_out(test::box({0.02, 0.02, 0.02}, {0.08, 0.06, 0.04}))),
        0.025, 42e3}},
  };
  return all;
}

Result<bake::BakedObject> bake_file(const std::filesystem::path& path, const Shape& shape, double unit_m = 1,
                                    bool cavities = false) {
  bake::ObjectRecipe recipe = recipe_of(path, shape.size_m, unit_m);
  recipe.meshing.cavities = cavities;
  recipe.options.band_high_hz = shape.top_hz;
  return bake::bake_recipe(recipe, kCeramic);
}

const Notes& sound_notes(const std::string& name) {
  static std::map<std::string, Notes> known;
  const auto found = known.find(name);
  if (found != known.end()) return found->second;
  const TemporaryFolder folder;
  const Shape& shape = shapes().at(name);
  const auto path = folder.write(name + ".geo", "SetFactory(\"OpenCASCADE\");\n" + shape.geo + "\n");
  const auto baked = bake_file(path, shape);
  if (!baked) ADD_FAILURE() << baked.error().message;
  return known[name] = baked ? notes_of(*baked) : Notes();
}

struct Brought {
  const char *what, *shape, *ending;
  mesh::TriangleMesh surface;
  double tolerance;  // of the first six frequencies
  mesh::Making making;
  const char* note;  // that the bake must give
  bool cavities = false;
};

// Those filled keep the facets of a circle of 48 or 64 sides, and the L has a corner that coarse elements do not
// follow.
std::vector<Brought> all_brought() {
  using mesh::Making;
  const auto of = [](const char* name) -> const mesh::TriangleMesh& { return shapes().at(name).surface; };
  std::vector<int> patch;
  for (int t = 300; t < 312; ++t) patch.push_back(t);
  std::vector<int> wide;
  for (int t = 0; t < 48 * 8; ++t) wide.push_back(t);
  return {
      {"as it should be", "block", ".stl", of("block"), 0.002, Making::kFilled, nullptr},
      {"long triangles", "rod", ".obj", of("rod"), 0.01, Making::kFilled, nullptr},
      {"scanned densely", "bar", "ascii.ply", test::subdivided(test::subdivided(test::subdivided(of("bar")))), 0.005,
       Making::kFilled, nullptr},
      {"flat holes", "block", "ascii.stl", test::without(of("block"), {0, 5}), 0.002, Making::kFilled,
       "closed 2 holes"},
      {"holes in a curve", "ball", ".ply", test::without(of("ball"), {100, 101, 400, 700}), 0.01, Making::kFilled,
       "closed 3 holes"},
      {"flipped triangles", "ring", ".glb", test::with_flipped(of("ring"), 9), 0.02, Making::kFilled, "flipped"},
      {"inside out", "cup", ".obj", test::inside_out(of("cup")), 0.02, Making::kFilled, "right way out"},
      {"duplicated triangles", "tube", ".off", test::with_copies(of("tube"), 5), 0.02, Making::kFilled, "duplicated"},
      {"fins", "L", ".ply", test::with_fin(of("L"), {0.02, 0.02, -0.05}), 0.01, Making::kFilled, "fin"},
      {"T-joints", "L", "ascii.ply", test::with_split_side(test::with_split_side(of("L"), 2), 9), 0.01, Making::kFilled,
       "without area"},
      {"points a micrometre apart", "bowl", ".stl", test::exploded(of("bowl"), 5e-8), 0.02, Making::kFilled, nullptr},
      {"stray points", "rod", ".obj", test::with_stray_points(of("rod"), 5), 0.01, Making::kFilled, nullptr},
      {"a cavity", "hollow", ".stl", of("hollow"), 0.005, Making::kFilled, "1 cavity"},
      {"a cavity turned outward", "hollow", ".ply",
       test::united(of("block"), test::box({0.02, 0.02, 0.02}, {0.08, 0.06, 0.04})), 0.005, Making::kFilled,
       "right way out", true},
      {"slivers", "bar", ".obj", test::with_split_side(of("bar"), 1), 0.005, Making::kFilled, nullptr},
      {"several of these", "bowl", ".ply",
       test::with_copies(test::with_flipped(test::without(of("bowl"), {300, 700}), 13), 11), 0.02, Making::kFilled,
       "closed 2 holes"},
      {"intersects itself", "bar", ".stl",
       test::united(test::box({0, 0, 0}, {0.12, 0.02, 0.01}), test::box({0.08, 0, 0}, {0.2, 0.02, 0.01})), 0.005,
       Making::kFilled, "intersections between shells"},
      {"two boxes that are an L", "L", ".obj",
       test::united(test::box({0, 0, 0}, {0.12, 0.04, 0.02}), test::box({0, 0.01, 0}, {0.06, 0.08, 0.02})), 0.01,
       Making::kFilled, "intersections between shells"},
      {"a wall inside", "block", ".stl",
       test::united(test::box({0, 0, 0}, {0.05, 0.08, 0.06}), test::box({0.05, 0, 0}, {0.1, 0.08, 0.06})), 0.005,
       Making::kFilled, "internal walls"},
      {"a wide hole in a curve", "ball", ".glb", test::without(of("ball"), patch), 0.05, Making::kFilled,
       "closed 1 hole"},
  };
}

void expect_notes_of_sound_body(const Brought& brought) {
  SCOPED_TRACE(std::string(brought.shape) + ", " + brought.what);
  const TemporaryFolder folder;
  const std::string ending = brought.ending;
  const double unit_m = ending == ".glb" ? 1 : 0.001;
  const auto path = folder.write("body" + ending, test::file_of(brought.surface, ending, unit_m));
  const auto baked = bake_file(path, shapes().at(brought.shape), unit_m, brought.cavities);
  ASSERT_TRUE(baked) << baked.error().message;
  std::string notes;
  for (const std::string& note : baked->notes) notes += note + "\n";
  EXPECT_EQ(baked->question, "");
  EXPECT_EQ(baked->making, brought.making) << notes;
  if (brought.note) {
    EXPECT_NE(notes.find(brought.note), std::string::npos) << notes;
  }
  EXPECT_EQ(baked->baked.bank.provenance.body, mesh::text_of(brought.making));
  const Notes found = notes_of(*baked), &right = sound_notes(brought.shape);
  ASSERT_EQ(found.size(), kNotes);
  ASSERT_EQ(right.size(), kNotes);
  double worst = 0;
  for (std::size_t i = 0; i < kNotes; ++i) worst = std::max(worst, std::abs(found[i] / right[i] - 1));
  EXPECT_LT(worst, brought.tolerance);
  std::printf("%-10s %-28s %-10s %6td elements, %.3f %% off\n", brought.shape, brought.what, brought.ending,
              baked->mesh.mesh.elements.rows(), 100 * worst);
}

// Bodies of one shape share the bake of the sound body.
class AnyBody : public testing::TestWithParam<const char*> {};

TEST_P(AnyBody, AnyBodyBakesToTheFrequenciesOfTheSoundBody) {
  for (const Brought& brought : all_brought()) {
    if (brought.shape == std::string(GetParam())) expect_notes_of_sound_body(brought);
  }
}

INSTANTIATE_TEST_SUITE_P(Twenty, AnyBody,
                         testing::Values("block", "bar", "ball", "rod", "ring", "tube", "cup", "bowl", "L", "hollow"),
                         [](const auto& shape) { return std::string(shape.param); });

std::string refusal(const std::filesystem::path& path) {
  const auto baked = bake::bake_recipe(recipe_of(path, 0.02, 1), kCeramic);
  return baked ? "accepted" : baked.error().message;
}

TEST(AnyBodyIsRefused, ABodyThatEnclosesNothingIsRefused) {
  const TemporaryFolder folder;
  mesh::TriangleMesh square = test::box({0, 0, 0}, {0.1, 0.1, 0.1});
  square.triangles.conservativeResize(2, 3);
  EXPECT_NE(refusal(folder.write("square.stl", test::file_of(square, ".stl"))).find("encloses nothing"),
            std::string::npos);
  mesh::TriangleMesh skin = test::sphere(0.05, 24);
  skin.triangles.conservativeResize(skin.triangles.rows() / 2, 3);
  EXPECT_NE(refusal(folder.write("skin.ply", test::file_of(skin, ".ply"))).find("encloses nothing"), std::string::npos);
  mesh::TriangleMesh flat = test::box({0, 0, 0}, {0.1, 0.1, 0.1});
  flat.nodes.col(2).setZero();
  EXPECT_NE(refusal(folder.write("flat.obj", test::file_of(flat, ".obj"))).find("encloses nothing"), std::string::npos);
  EXPECT_NE(refusal(folder.write("none.stl", "nothing")).find("none.stl"), std::string::npos);
}

TEST(AnyBodyIsQuestioned, ABodyWhoseSizeCannotBeMeantIsQuestioned) {
  const TemporaryFolder folder;
  const Shape& cup = shapes().at("cup");
  const auto path = folder.write("cup.stl", test::file_of(cup.surface, ".stl", 0.001));
  bake::ObjectRecipe recipe = recipe_of(path, 15, 1);
  recipe.options.band_high_hz = 14e3;
  const auto baked = bake::bake_recipe(recipe, kCeramic);
  ASSERT_FALSE(baked);
  EXPECT_NE(baked.error().message.find("cup.stl is 139 m long"), std::string::npos) << baked.error().message;
  EXPECT_NE(baked.error().message.find("millimetre (--unit mm)"), std::string::npos) << baked.error().message;
}

TEST(AnyBody, AnyBodyIsMeshedAsFinelyAsItsWallsAskWhenNoSizeIsNamed) {
  const TemporaryFolder folder;
  const Shape& cup = shapes().at("cup");
  bake::ObjectRecipe recipe = recipe_of(folder.write("cup.glb", test::file_of(cup.surface, ".glb")), 0, 1);
  recipe.options.band_high_hz = 8e3;
  const auto baked = bake::bake_recipe(recipe, kCeramic);
  ASSERT_TRUE(baked) << baked.error().message;
  ASSERT_TRUE(baked->choice);
  EXPECT_NEAR(baked->choice->wall_m, 0.006, 2e-4);
  EXPECT_LE(baked->choice->size_m, 4 * 0.0062);
}

}  // namespace
}  // namespace ringdown
