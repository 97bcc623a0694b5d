// `ringdown-bake room.glb`: bodies with an acoustic material get their models, and nothing else in the file changes.
#include "engine/modal/bank_file.h"
#include "engine/scene/gltf/scene.h"
#include "tests/scene/gltf_room.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <sys/wait.h>

namespace ringdown {
namespace {

namespace fs = std::filesystem;
using modal::Json;
using test::GltfRoom;
using test::TemporaryFolder;

constexpr const char* kPhysics = "KHR_physics_rigid_bodies";
constexpr const char* kAudio = "KHR_audio_rigid_bodies";
constexpr double kYoung_pa = 7.2e10, kDensity_kg_m3 = 2700, kPoisson = 0.19;

struct Ran {
  int exit_code;
  std::string output;
};

Ran bake(const fs::path& file, const std::string& more = "--preview --band 20 12000", const std::string& front = "") {
  const std::string command = front + " RINGDOWN_CACHE=/dev/null/none " RINGDOWN_BIN_DIR "/ringdown-bake " +
                              file.string() + " " + more + " 2>&1";
  std::FILE* pipe = ::popen(command.c_str(), "r");
  std::string output;
  std::array<char, 512> part{};
  while (std::fgets(part.data(), part.size(), pipe)) output += part.data();
  return {WEXITSTATUS(::pclose(pipe)), output};
}

std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::size_t add_ceramic(GltfRoom& room) {
  const std::size_t material = room.add(kAudio, "acousticMaterials",
                                        {{"name", "Ceramic"},
                                         {"density", kDensity_kg_m3},
                                         {"youngsModulus", kYoung_pa},
                                         {"poissonRatio", kPoisson},
                                         {"alpha", 6},
                                         {"beta", 1e-7}});
  return room.add(kAudio, "acousticSurfaces", {{"name", "Glazed"}, {"roughness", 3e-7}, {"material", material}});
}

Json body(const std::string& name, std::size_t mesh, std::size_t surface, Json motion = Json::object()) {
  Json node = {{"name", name}, {"mesh", mesh}};
  node["extensions"][kPhysics] = {{"motion", std::move(motion)}, {"collider", {{"geometry", {{"shape", 0}}}}}};
  node["extensions"][kAudio] = {{"acousticSurface", surface}};
  return node;
}

struct Glb {
  Json json;
  std::string binary, rest;
};

Glb take_apart(const std::string& file) {
  const auto glb = modal::parse_glb(std::as_bytes(std::span(file)), "room.glb");
  if (!glb) throw std::runtime_error(glb.error().message);
  Glb parts{.json = glb->json, .binary = {reinterpret_cast<const char*>(glb->binary.data()), glb->binary.size()}};
  parts.rest = file.substr(static_cast<std::size_t>(reinterpret_cast<const char*>(glb->binary.data()) - file.data()) +
                           glb->binary.size());
  return parts;
}

// Takes what a bake adds out of a document again.
Json without_models(Json json, const Json& before) {
  json["extensions"][kAudio].erase("modalModels");
  for (Json& node : json["nodes"]) {
    if (node.contains("extensions") && node["extensions"].contains(kAudio))
      node["extensions"][kAudio].erase("modalModel");
  }
  for (const char* list : {"accessors", "bufferViews"}) {
    Json kept = Json::array();
    for (std::size_t k = 0; k < before[list].size(); ++k) kept.push_back(json[list][k]);
    json[list] = kept;
  }
  json["buffers"] = before["buffers"];
  return json;
}

modal::Bank bank_of(const fs::path& file, const Json& json, std::size_t node) {
  const auto model = json["nodes"][node]["extensions"][kAudio]["modalModel"].get<std::size_t>();
  auto bank = modal::read_bank(modal::bank_path({file, {model}}));
  EXPECT_TRUE(bank) << bank.error().message;
  return bank.value_or(modal::Bank());
}

double lowest(const modal::Bank& bank) { return std::ranges::min(bank.frequency_hz); }

double rms_shape(const modal::Bank& bank) {
  double sum = 0;
  for (const auto& v : bank.shapes)
    sum += double{v[0]} * double{v[0]} + double{v[1]} * double{v[1]} + double{v[2]} * double{v[2]};
  return std::sqrt(sum / static_cast<double>(bank.shapes.size()));
}

// The lowest mode of a free sphere is torsional: its wave number times the radius is 2.501, whatever Poisson's ratio
// (Lamb 1882). This ball rings at 167 kHz.
TEST(SceneBake, ABallThatRingsAboveHearingGetsItsLowestModes) {
  constexpr double kRadius_m = 0.008;
  const TemporaryFolder folder;
  GltfRoom room;
  room.add("KHR_implicit_shapes", "shapes", {{"type", "sphere"}, {"sphere", {{"radius", kRadius_m}}}});
  const std::size_t glazed = add_ceramic(room);
  Json node = body("Bead", 0, glazed);
  node.erase("mesh");
  const std::size_t bead = room.add_node(node);
  const fs::path file = folder.write("room.glb", room.glb());
  const Ran ran = bake(file, "--preview");
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_NE(ran.output.find("rings above hearing"), std::string::npos) << ran.output;
  const modal::Bank bank = bank_of(file, take_apart(content(file)).json, bead);
  const double shear_m_s = std::sqrt(kYoung_pa / (2 * (1 + kPoisson) * kDensity_kg_m3));
  const double expected_hz = 2.501 * shear_m_s / (2 * std::numbers::pi * kRadius_m);
  EXPECT_NEAR(lowest(bank) / expected_hz, 1, 0.02);
  ASSERT_TRUE(bank.mass);
  EXPECT_NEAR(bank.mass->mass_kg, kDensity_kg_m3 * 4.0 / 3 * std::numbers::pi * std::pow(kRadius_m, 3), 1e-4);
}

TEST(SceneBake, BodiesWithAMaterialGetTheirModelsInPlace) {
  constexpr double kLength_m = 0.3, kThick_m = 0.012;
  const TemporaryFolder folder;
  GltfRoom room;
  room.add("KHR_implicit_shapes", "shapes", {{"type", "box"}, {"box", {{"size", {kLength_m, kThick_m, 0.03}}}}});
  room.add("KHR_implicit_shapes", "shapes", {{"type", "plane"}, {"plane", Json::object()}});
  const std::size_t glazed = add_ceramic(room);
  const std::size_t bar = room.add_box("Bar", {kLength_m, kThick_m, 0.03});
  const std::size_t large = room.add_box("Large bar", 2 * Vec3{kLength_m, kThick_m, 0.03});
  const std::size_t first = room.add_node(body("Bar", bar, glazed));
  Json turned = body("Bar.001", bar, glazed);
  turned["translation"] = {0.7, -1.3, 0.11};
  turned["rotation"] = {0.3, -0.1, 0.2, 0.9273618495495704};
  const std::size_t twin = room.add_node(turned);
  const std::size_t heavy = room.add_node(body("Heavy", bar, glazed, {{"mass", 4 * 0.3 * 0.012 * 0.03 * 2700}}));
  Json small = body("Small", large, glazed);
  small["scale"] = {0.5, 0.5, 0.5};
  const std::size_t scaled = room.add_node(small);
  const std::size_t silent = room.add_node({{"name", "Silent"}, {"mesh", bar}});
  room.json["nodes"][silent]["extensions"][kPhysics] = {{"motion", Json::object()},
                                                        {"collider", {{"geometry", {{"shape", 0}}}}}};
  Json floor = {{"name", "Floor"}};
  floor["extensions"][kPhysics]["collider"]["geometry"]["shape"] = 1;
  floor["extensions"][kAudio]["acousticSurface"] = glazed;
  const std::size_t plane = room.add_node(floor);
  room.json["extras"] = {{"exact", 0.1}, {"large", 1e300}, {"whole", 12345678901234}};
  const std::string chunk("\4\0\0\0XTRAdata", 12), before = room.glb(chunk);
  const fs::path file = folder.write("room.glb", before);

  const Ran ran = bake(file);
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_NE(ran.output.find("4 of 4 bodies got a model, 3 models in all"), std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find("stays silent"), std::string::npos) << ran.output;
  const Glb was = take_apart(before), is = take_apart(content(file));
  EXPECT_EQ(without_models(is.json, was.json), was.json);
  EXPECT_EQ(is.binary.substr(0, was.binary.size()), was.binary);
  EXPECT_EQ(is.json["buffers"][0]["byteLength"], is.binary.size());
  EXPECT_EQ(is.rest, chunk);

  const auto model = [&](std::size_t node) { return is.json["nodes"][node]["extensions"][kAudio]["modalModel"]; };
  EXPECT_EQ(model(first), model(twin));
  EXPECT_NE(model(first), model(heavy));
  EXPECT_FALSE(is.json["nodes"][silent]["extensions"].contains(kAudio));
  EXPECT_FALSE(is.json["nodes"][plane]["extensions"][kAudio].contains("modalModel"));
  EXPECT_EQ(is.json["extensions"][kAudio]["modalModels"][0]["material"], 0);

  // A slender free bar by Euler and Bernoulli: 4.730^2 / (2 pi L^2) sqrt(E / rho) h / sqrt(12); shear and turning take
  // about 1 % of it.
  const modal::Bank bank = bank_of(file, is.json, first);
  const double expected_hz = 4.730 * 4.730 / (2 * std::numbers::pi * kLength_m * kLength_m) *
                             std::sqrt(kYoung_pa / kDensity_kg_m3) * kThick_m / std::sqrt(12.0);
  EXPECT_NEAR(lowest(bank) / expected_hz, 0.99, 0.015);
  ASSERT_TRUE(bank.mass);
  EXPECT_NEAR(bank.mass->mass_kg, kLength_m * kThick_m * 0.03 * kDensity_kg_m3, 1e-6);

  // Four times the mass of the material: the same pitch, half the shapes, and the mass of the file.
  const modal::Bank four = bank_of(file, is.json, heavy);
  EXPECT_NEAR(lowest(four) / lowest(bank), 1, 1e-6);
  EXPECT_NEAR(rms_shape(four) / rms_shape(bank), 0.5, 1e-3);
  EXPECT_NEAR(four.mass->mass_kg / bank.mass->mass_kg, 4, 1e-3);

  // The scaled node's points lie in its own frame, twice as far out, and the body that plays has the bar's size.
  const modal::Bank halved = bank_of(file, is.json, scaled);
  const auto reach = [](const modal::Bank& of) {
    float max = 0;
    for (const auto& p : of.positions) max = std::max(max, p[0]);
    return max;
  };
  EXPECT_NEAR(lowest(halved) / lowest(bank), 1, 0.01);
  EXPECT_NEAR(reach(halved), kLength_m, 1e-3);
  const std::string now = content(file);
  const auto read = scene::parse_gltf_scene(std::as_bytes(std::span(now)), file, {});
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->scene.objects.size(), 4);
  EXPECT_NEAR(reach(modal::read_bank(read->scene.objects[3].bank).value()), 0.5 * kLength_m, 1e-3);

  // Again: there is nothing left to do, and the file stays as it is.
  const std::string after = content(file);
  EXPECT_NE(bake(file).output.find("0 of 0 bodies"), std::string::npos);
  EXPECT_EQ(content(file), after);
}

TEST(SceneBake, AnImplicitShapeIsBakedExactly) {
  constexpr double kRadius_m = 0.1;
  const TemporaryFolder folder;
  GltfRoom room;
  room.add("KHR_implicit_shapes", "shapes", {{"type", "sphere"}, {"sphere", {{"radius", kRadius_m}}}});
  Json ball = body("Ball", 0, add_ceramic(room));
  ball.erase("mesh");
  room.add_node(ball);
  const fs::path file = folder.write("ball.glb", room.glb());
  const Ran ran = bake(file, "--band 20 18000");
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  const modal::Bank bank = bank_of(file, take_apart(content(file)).json, 0);
  // Lamb's torsional mode of the second degree: kR = 2.5011 with the speed of shear waves, whatever Poisson's ratio.
  const double shear_m_s = std::sqrt(kYoung_pa / (2 * (1 + kPoisson)) / kDensity_kg_m3);
  const double expected_hz = 2.5011 * shear_m_s / (2 * std::numbers::pi * kRadius_m);
  double nearest = 1;
  for (const double f : bank.frequency_hz) nearest = std::min(nearest, std::abs(f / expected_hz - 1));
  EXPECT_LT(nearest, 1e-3);
}

TEST(SceneBake, NonlinearTermsFollowTheArraysThatWereThere) {
  const TemporaryFolder folder;
  GltfRoom room;
  constexpr double kThickness_m = 0.003;
  room.add("KHR_implicit_shapes", "shapes", {{"type", "box"}, {"box", {{"size", {0.1, 0.08, kThickness_m}}}}});
  room.add_node(body("Sheet", room.add_box("Sheet", {0.1, 0.08, kThickness_m}), add_ceramic(room)));
  const fs::path file = folder.write("room.glb", room.glb());
  const Ran ran = bake(file, "--band 20 10000 --nonlinear 4");
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  const modal::Bank bank = bank_of(file, take_apart(content(file)).json, 0);
  ASSERT_TRUE(bank.nonlinear);
  EXPECT_EQ(bank.nonlinear->mode_count(), 4);
  EXPECT_NEAR(bank.nonlinear->thickness_m, kThickness_m, 0.1 * kThickness_m);
}

TEST(SceneBake, ATextKeepsItsBufferAndGetsAnother) {
  const TemporaryFolder folder;
  GltfRoom room;
  room.add("KHR_implicit_shapes", "shapes", {{"type", "box"}, {"box", {{"size", {0.2, 0.02, 0.03}}}}});
  room.add_node(body("Bar", room.add_box("Bar", {0.2, 0.02, 0.03}), add_ceramic(room)));
  std::ofstream(folder / "room data.bin", std::ios::binary) << room.binary;
  const fs::path file = folder.write("room.gltf", room.gltf("room%20data.bin"));
  const Ran ran = bake(file);
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_EQ(content(folder / "room data.bin"), room.binary);
  const Json after = Json::parse(content(file));
  EXPECT_EQ(without_models(after, Json::parse(room.gltf("room%20data.bin"))),
            Json::parse(room.gltf("room%20data.bin")));
  ASSERT_EQ(after["buffers"].size(), 2);
  EXPECT_EQ(content(folder / after["buffers"][1]["uri"].get<std::string>()).size(), after["buffers"][1]["byteLength"]);
  EXPECT_GT(bank_of(file, after, 0).mode_count(), 3);
}

TEST(SceneBake, ABodyThatCannotBeBakedDoesNotStopTheOthers) {
  const TemporaryFolder folder;
  GltfRoom room;
  room.add("KHR_implicit_shapes", "shapes", {{"type", "box"}, {"box", {{"size", {0.2, 0.02, 0.03}}}}});
  const std::size_t glazed = add_ceramic(room), box = room.add_box("Bar", {0.2, 0.02, 0.03});
  const std::size_t unknown = room.add(kAudio, "acousticMaterials", {{"name", "Moon rock"}, {"density", 3000}});
  const std::size_t rocky = room.add(kAudio, "acousticSurfaces", {{"material", unknown}});
  const std::size_t glass = room.add(kAudio, "acousticMaterials", {{"name", "Glass"}});
  const std::size_t clear = room.add(kAudio, "acousticSurfaces", {{"material", glass}});
  room.add_node(body("Good", box, glazed));
  room.add_node(body("Rock", box, rocky));
  Json flat = body("Flat", box, glazed);
  flat["scale"] = {1, 0.5, 1};
  room.add_node(flat);
  room.add_node(body("Named", box, clear));
  const fs::path file = folder.write("room.glb", room.glb()), other = folder / "other.glb";
  const Ran ran = bake(file, "--preview --band 20 12000 -o " + other.string());
  EXPECT_EQ(ran.exit_code, 3) << ran.output;
  EXPECT_EQ(content(file), room.glb());
  EXPECT_NE(ran.output.find("Moon rock"), std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find("youngsModulus, poissonRatio, alpha and beta"), std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find("scaled unevenly"), std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find("2 of 4 bodies"), std::string::npos) << ran.output;
  const Json json = take_apart(content(other)).json;
  EXPECT_GT(bank_of(other, json, 0).mode_count(), 3);
  EXPECT_NE(lowest(bank_of(other, json, 3)), lowest(bank_of(other, json, 0)));
}

TEST(SceneBake, ACancelledBakeLeavesTheFileAsItIs) {
  const TemporaryFolder folder;
  GltfRoom room;
  room.add("KHR_implicit_shapes", "shapes", {{"type", "box"}, {"box", {{"size", {1, 0.2, 1}}}}});
  room.add_node(body("Slab", room.add_box("Slab", {1, 0.2, 1}), add_ceramic(room)));
  const fs::path file = folder.write("room.glb", room.glb());
  const Ran ran = bake(file, "--mesh-size 0.03", "timeout -s TERM --preserve-status 1 env");
  EXPECT_EQ(ran.exit_code, 130) << ran.output;
  EXPECT_EQ(content(file), room.glb());
}

}  // namespace
}  // namespace ringdown
