// What of a glTF file is not played is named once; what takes part without a response, and on both sides, does so.
#include "engine/scene/world.h"
#include "tests/scene/gltf_text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::scene::gltf_left_out_test {
namespace {

using test::document;
using test::good;
using test::kBall;
using test::kBox;
using test::kCollider0;
using test::kCollider1;
using test::node;
using test::run_until;
using test::silent_world;

TEST(GltfLeftOut, WhatIsNotPlayedIsNamedOnce) {
  const GltfScene read = good(document(
      node(R"("trigger": {"geometry": {"shape": 0}})") + "," + node(R"("trigger": {"geometry": {"shape": 0}})"), kBall,
      "", R"(, "extensionsRequired": ["EXT_unheard_of"])"));
  ASSERT_EQ(read.notes.size(), 2);
  EXPECT_NE(read.notes[0].find("EXT_unheard_of"), std::string::npos);
  EXPECT_EQ(read.notes[1],
            "triggers have no effect: nothing collides with them, and bodies that enter them are not reported");
}

// Each property in which two colliders of a body differ is named, because the body has those of the first.
TEST(GltfLeftOut, AMaterialThatABodyCannotHaveIsNamed) {
  const std::string first = R"({"staticFriction": 0.5, "dynamicFriction": 0.4, "restitution": 0.3, )"
                            R"("frictionCombine": "average", "restitutionCombine": "average", )"
                            R"("extras": {"ringdown": {"rolling_m": 0.001}}})";
  const auto notes = [&](const std::string& second) {
    const auto collider = [](int number) {
      return R"("collider": {"geometry": {"shape": 0}, "physicsMaterial": )" + std::to_string(number) + "}";
    };
    return good(document(node(R"("motion": {"mass": 1}, )" + collider(0), R"(, "children": [1])") + "," +
                             node(collider(1), R"(, "translation": [0, 1, 0])"),
                         kBox, R"("physicsMaterials": [)" + first + "," + second + "]"))
        .notes;
  };
  EXPECT_TRUE(notes(first).empty());
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"0.5", "0.6"},
           {"0.4", "0.2"},
           {"0.3", "0.9"},
           {"0.001", "0.002"},
           {R"(nCombine": "average", "r)", R"(nCombine": "minimum", "r)"},
           {R"(restitutionCombine": "average")", R"(restitutionCombine": "maximum")"}}) {
    std::string second = first;
    second.replace(second.find(from), from.size(), to);
    const std::vector<std::string> said = notes(second);
    ASSERT_EQ(said.size(), 1) << second;
    EXPECT_NE(said[0].find("those of the first"), std::string::npos) << second;
  }
}

TEST(GltfLeftOut, ARollingResistanceOutsideItsRangeIsNamed) {
  const auto notes = [](const std::string& rolling_m) {
    return good(document(node(R"("motion": {"mass": 1}, "collider": {"geometry": {"shape": 0}, "physicsMaterial": 0})"),
                         kBox, R"("physicsMaterials": [{"extras": {"ringdown": {"rolling_m": )" + rolling_m + "}}}]"))
        .notes;
  };
  EXPECT_TRUE(notes("0.1").empty());
  for (const std::string rolling_m : {"-0.001", "0.2"}) {
    ASSERT_EQ(notes(rolling_m).size(), 1) << rolling_m;
    EXPECT_NE(notes(rolling_m)[0].find("rolling_m outside 0 to 0.1 m"), std::string::npos) << rolling_m;
  }
}

TEST(GltfLeftOut, WhatOtherExtensionsAddIsNamed) {
  std::string text =
      document(node(R"("motion": {"mass": 2}, )" + kCollider0), kBall, "",
               R"(, "animations": [{"channels": [{"sampler": 0, "target": {"path": "pointer", "extensions":
                              {"KHR_animation_pointer": {"pointer": "/nodes/0/x"}}}}], "samplers": [{"input": 0, "output": 0}]}])");
  const std::string mark = "\"extensions\": {";
  const std::size_t at = text.rfind(mark);
  ASSERT_NE(at, std::string::npos);
  text.insert(at + mark.size(), R"("KHR_interactivity": {"graphs": []}, "KHR_audio_emitter": {"emitters": []}, )");
  const std::vector<std::string> notes = good(text).notes;
  for (const char* name : {"KHR_animation_pointer", "KHR_interactivity", "audio emitters"}) {
    EXPECT_EQ(std::ranges::count_if(notes, [&](const auto& n) { return n.find(name) != std::string::npos; }), 1)
        << name;
  }
}

TEST(GltfLeftOut, BodiesFallThroughTriggers) {
  const GltfScene read =
      good(document(node(R"("motion": {"mass": 2}, )" + kCollider0, R"(, "translation": [0, 3, 0])") + "," +
                        node(R"("trigger": {"geometry": {"shape": 0}})", R"(, "translation": [0, 1, 0])"),
                    kBall));
  ASSERT_EQ(read.scene.bodies.size(), 1);
  World world = silent_world(read.scene);
  run_until(world, 1);
  EXPECT_LT(length(world.bodies()[0].position_m - Vec3{0, 0, 3 - 0.5 * 9.81}), 1e-9);
}

// One ball falls on a double-sided plane, and one that is drawn upwards meets it from below, at 6 m/s.
TEST(GltfLeftOut, DoubleSidedPlanesHoldBodiesOnBothSides) {
  for (const std::string ends : {"", R"("sizeX": 4, "sizeZ": 3, )"}) {
    for (const std::string scale : {"", R"(, "scale": [3, 50, 3])"}) {
      const std::string ball = R"("motion": {"mass": 2, "linearVelocity": [0, )", rest = R"(}, )" + kCollider0;
      const GltfScene read =
          good(document(node(ball + R"(-6, 0])" + rest, R"(, "translation": [0, 2, 0])") + "," +
                            node(ball + R"(6, 0], "gravityFactor": -1)" + rest, R"(, "translation": [0.5, -2, 0])") +
                            "," + node(kCollider1, scale),
                        kBall + R"(, {"type": "plane", "plane": {)" + ends + R"("doubleSided": true}})"));
      EXPECT_EQ(read.notes.size(), ends.empty() ? 1 : 0);
      World world = silent_world(read.scene);
      run_until(world, 4);
      const std::vector<BodyState> ended = world.bodies();
      EXPECT_NEAR(ended[0].position_m.z, 0.101, 1e-3) << ends << scale;  // the sheet is 2 mm thick
      EXPECT_NEAR(ended[1].position_m.z, -0.101, 1e-3) << ends << scale;
    }
  }
}

}  // namespace
}  // namespace ringdown::scene::gltf_left_out_test
