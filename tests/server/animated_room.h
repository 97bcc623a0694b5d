// A glTF file as programs for pictures export it, with banks: keyframes only, no physics. A cube falls on a table and
// bounces, a sled slides over it and stops. Two cameras: one that stands, and one that comes nearer.
#pragma once

#include "engine/modal/gltf_models.h"
#include "tests/scene/box_bank.h"
#include "tests/scene/gltf_room.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

namespace ringdown::test {

class AnimatedRoom {
 public:
  static constexpr double kFps = 30, kLength_s = 1.5, kGravity = 9.81, kHeight_m = 0.3, kBounce = 0.5;

  // The moments at which the cube strikes the table. After the third it rests.
  static std::vector<double> landings_s() {
    double speed = std::sqrt(2 * kGravity * kHeight_m), time = speed / kGravity;
    std::vector<double> times;
    for (int k = 0; k < 3; ++k) {
      times.push_back(time);
      speed *= kBounce;
      time += 2 * speed / kGravity;
    }
    return times;
  }

  struct Parts {
    bool moves = true, meets = true, banks = true;
  };

  static std::filesystem::path write(const std::filesystem::path& path, const Parts& parts = {true, true, true}) {
    GltfRoom room;
    const Vec3 cube_m{0.1, 0.08, 0.06}, sled_m{0.1, 0.02, 0.06}, table_m{2, 0.05, 1};
    const auto add = [&room](const char* name, Vec3 size_m, Vec3 at) {
      return room.add_node({{"name", name}, {"mesh", room.add_box(name, size_m)}, {"translation", {at.x, at.y, at.z}}});
    };
    const double aside = parts.meets ? 0 : 3;
    const std::size_t table = add("Table", table_m, {0, -0.025, 0});
    const std::size_t cube = add("Cube", cube_m, {0.4, 0.04 + kHeight_m, aside});
    const std::size_t sled = add("Sled", sled_m, {-0.8, 0.01, aside});
    room.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.01}}}}};
    room.add_node({{"name", "Wide"}, {"camera", 0}, {"translation", {0, 0.5, 2}}});
    const std::size_t ride = room.add_node({{"name", "Ride"}, {"camera", 0}, {"translation", {0, 0.5, 8}}});
    if (parts.moves) {
      room.json["animations"] = {{{"channels", modal::Json::array()}, {"samplers", modal::Json::array()}}};
      animate(room, cube, [&](double t) { return Vec3{0.4, 0.04 + height_at(t), aside}; });
      animate(room, sled, [&](double t) { return Vec3{-0.8 + way_at(t), 0.01, aside}; });
      animate(room, ride, [](double t) { return Vec3{0, 0.5, 8 - 4 * t}; });
    }
    std::string bytes = room.glb();
    if (parts.banks) {
      const modal::Bank banks[] = {bank(table_m, 30, 180), bank(cube_m, 1, 950), bank(sled_m, 0.3, 1700)};
      const std::vector<modal::AddedModel> models = {
          {&banks[0], {table}, {}}, {&banks[1], {cube}, {}}, {&banks[2], {sled}, {}}};
      auto extended = modal::add_models(bytes, path.string(), "room", models);
      EXPECT_TRUE(extended) << extended.error().message;
      bytes = extended->file;
    }
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }

 private:
  static modal::Bank bank(Vec3 size_m, double mass_kg, double frequency_hz) {
    modal::Bank made = box_bank(size_m, mass_kg);
    made.frequency_hz = {frequency_hz};
    made.decay_per_s = {20};
    for (auto& shape : made.shapes) shape = {0, static_cast<float>(0.4 / std::sqrt(mass_kg)), 0};
    return made;
  }
  static double height_at(double t) {
    double from = 0, speed = 0, height = kHeight_m;
    const std::vector<double> landings = landings_s();
    double landing_m_s = std::sqrt(2 * kGravity * kHeight_m);
    for (std::size_t k = 0; k < landings.size() && t >= landings[k]; ++k) {
      landing_m_s *= kBounce;
      from = landings[k], speed = landing_m_s, height = 0;
      if (k + 1 == landings.size()) return 0;
    }
    return height + speed * (t - from) - 0.5 * kGravity * (t - from) * (t - from);
  }
  // It brakes by 0.3 g from 1.5 m/s.
  static double way_at(double t) {
    constexpr double kSpeed_m_s = 1.5, kBrake_m_s2 = 0.3 * kGravity;
    t = std::min(t, kSpeed_m_s / kBrake_m_s2);
    return kSpeed_m_s * t - 0.5 * kBrake_m_s2 * t * t;
  }
  static void animate(GltfRoom& room, std::size_t node, const std::function<Vec3(double)>& place) {
    std::vector<float> times, values;
    for (int k = 0; k <= static_cast<int>(kLength_s * kFps); ++k) {
      times.push_back(static_cast<float>(k / kFps));
      const Vec3 at = place(k / kFps);
      for (const double x : {at.x, at.y, at.z}) values.push_back(static_cast<float>(x));
    }
    modal::Json& animation = room.json["animations"][0];
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", "translation"}}}});
    const std::size_t input = room.add_array(times, 5126, "SCALAR", 1),
                      output = room.add_array(values, 5126, "VEC3", 3);
    room.json["accessors"][input]["min"] = {times.front()};
    room.json["accessors"][input]["max"] = {times.back()};
    animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", "LINEAR"}});
  }
};

}  // namespace ringdown::test
