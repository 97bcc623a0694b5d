// The table of directions (directions.txt) through every door to Ringdown: OSC, one message and in bulk, the C library,
// Python, C#, a glTF scene and a TOML scene. The plug-in has neither a listener nor poses.
//
// A door gets each case a slot of time, in which its listener and its object are placed and the object is struck. It
// gives eight channels: the stereo mix, ambisonics of the first order, and the mix of a mixer with a head. What is
// heard in a slot is compared with the table, which was written by hand.
#include "clients/library/ringdown.h"
#include "engine/gltf/glb.h"
#include "engine/modal/bank_file.h"
#include "server/session/head.h"
#include "server/session/offline.h"
#include "tests/integration/process.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace ringdown::test {
namespace {

constexpr double kRate_hz = 48000;
constexpr std::size_t kSlot = 12288, kStrike = 4096;  // frames of a case, and when its object is struck
constexpr std::array<double, 3> kPoint{0.5, 0.5, 0.5}, kBlow{0, 0, 0.02};

struct Place {
  std::array<double, 3> position_m{};
  std::array<double, 4> wxyz{};
};

struct Case {
  std::string name;
  Place listener, object;
  std::string ears;           // left, right, both
  std::array<char, 3> xyz{};  // + - 0
  std::string level;          // loud, quiet, middle
};

const std::string kFolder = RINGDOWN_SOURCE_DIR "/tests/sides/";

std::vector<Case> read_table(const std::string& name) {
  std::ifstream file(kFolder + name);
  std::vector<Case> cases;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.starts_with('#')) continue;
    std::istringstream words(line);
    Case one;
    words >> one.name;
    for (Place* place : {&one.listener, &one.object}) {
      for (double& x : place->position_m) words >> x;
      for (double& q : place->wxyz) words >> q;
    }
    words >> one.ears >> one.xyz[0] >> one.xyz[1] >> one.xyz[2] >> one.level;
    EXPECT_TRUE(words) << line;
    cases.push_back(one);
  }
  return cases;
}

// Sends 1 + 0.95 y towards the direction x y z of its frame.
modal::Bank lopsided_bank() {
  modal::Bank bank = single_mode_bank(2000, 300);
  constexpr double kOverSphere =
      4 * M_PI;  // real harmonics are orthonormal: Y_0 = 1/sqrt(4 pi), Y_1 = sqrt(3/(4 pi)) y
  modal::FarField& field = bank.radiation->maps.modes[0];
  const double one = 0.01 * std::sqrt(kOverSphere), y = 0.95 * 0.01 * std::sqrt(kOverSphere / 3);
  field.terms = {{0, {static_cast<float>(one), 0}}, {1, {static_cast<float>(y), 0}}};
  field.unit = 0;
  return bank;
}

using Channels = std::vector<std::vector<float>>;  // left, right, ACN 0 ... 3, the head's left and right ear

struct Sound {
  const Channels& channels;

  [[nodiscard]] double product(std::size_t slot, std::size_t a, std::size_t b) const {
    double sum = 0;
    for (std::size_t n = slot * kSlot + kStrike; n < (slot + 1) * kSlot; ++n) {
      sum += static_cast<double>(channels[a].at(n)) * channels[b].at(n);
    }
    return sum;
  }
  // By how much `a` is louder than `b`.
  [[nodiscard]] double ratio_db(std::size_t slot, std::size_t a, std::size_t b) const {
    return 10 * std::log10(product(slot, a, a) / product(slot, b, b));
  }
};

// The head that libmysofa brings, prepared once.
const Result<synth::HeadLoader>& head() {
  static const auto loader = session::read_head("");
  return loader;
}

class Sides : public testing::Test {
 protected:
  Sides() { EXPECT_TRUE(modal::write_bank(lopsided_bank(), bank())); }

  [[nodiscard]] std::filesystem::path bank() const { return folder_ / "lopsided.glb"; }
  [[nodiscard]] std::size_t frames() const { return cases_.size() * kSlot; }

  void expect_table(const Channels& channels) {
    std::vector<std::size_t> all(cases_.size());
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = k;
    expect_table(channels, all);
  }

  // Compares what is heard in the slots of these cases, the first of which is the level's measure.
  void expect_table(const Channels& channels, const std::vector<std::size_t>& which) {
    ASSERT_GE(cases_.size(), 15u);
    ASSERT_EQ(channels.size(), 8u);
    for (const auto& channel : channels) ASSERT_EQ(channel.size(), frames());
    const Sound sound{channels};
    for (const std::size_t k : which) {
      const Case& wanted = cases_[k];
      SCOPED_TRACE(wanted.name);
      ASSERT_GT(sound.product(k, 2, 2), 0);
      expect_ears(wanted.ears, sound.ratio_db(k, 0, 1), 0.1);
      if (wanted.ears == "both") {
        EXPECT_NEAR(sound.ratio_db(k, 0, 2), -3.01, 0.1) << "the middle of the mix shares its power";
      }
      if (head()) expect_ears(wanted.ears, sound.ratio_db(k, 6, 7), 2);
      const std::array<std::size_t, 3> acn{5, 3, 4};  // ACN 3, 1, 2 are x, y, z
      for (std::size_t c = 0; c < 3; ++c) {
        const double share = sound.product(k, 2, acn[c]) / sound.product(k, 2, 2);
        EXPECT_NEAR(share, wanted.xyz[c] == '+' ? 1 : wanted.xyz[c] == '-' ? -1 : 0, 0.02) << "xyz"[c];
      }
      const double level = std::sqrt(sound.product(k, 2, 2)) / middle(sound, which);
      if (wanted.level == "loud") {
        EXPECT_NEAR(level, 1.95, 0.1);
      } else if (wanted.level == "quiet") {
        EXPECT_LT(level, 0.1);  // 0.05, and what a map loses in a bank's file
      } else {
        EXPECT_NEAR(level, 1, 0.05);
      }
    }
  }

  std::vector<Case> cases_ = read_table("directions.txt");
  TemporaryFolder folder_;

 private:
  static void expect_ears(const std::string& ears, double left_over_right_db, double tolerance_db) {
    if (ears == "left") {
      EXPECT_GT(left_over_right_db, 3);
    } else if (ears == "right") {
      EXPECT_LT(left_over_right_db, -3);
    } else {
      EXPECT_NEAR(left_over_right_db, 0, tolerance_db);
    }
  }

  // The level of the first of these cases that is neither loud nor quiet.
  double middle(const Sound& sound, const std::vector<std::size_t>& which) {
    const auto first = std::ranges::find_if(which, [&](std::size_t k) { return cases_[k].level == "middle"; });
    EXPECT_NE(first, which.end());
    return std::sqrt(sound.product(*first, 2, 2));
  }
};

// ---- The C library
// ---------------------------------------------------------------------------------------------------

std::vector<std::vector<float>> by_c(const std::vector<Case>& cases, const std::string& bank_file, const char* head) {
  ringdown_error error{};
  ringdown_bank* bank = nullptr;
  EXPECT_EQ(ringdown_bank_open(bank_file.c_str(), &bank, &error), RINGDOWN_OK) << error.sentence;
  ringdown_settings settings;
  ringdown_settings_init(&settings, sizeof settings);
  settings.limiter_db = 1;
  settings.ambisonic_order = head ? 0 : 1;
  settings.head = head;
  ringdown_mixer* mixer = nullptr;
  EXPECT_EQ(ringdown_mixer_create(&settings, &mixer, &error), RINGDOWN_OK) << error.sentence;
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const auto frame = static_cast<std::int64_t>(k * kSlot);
    std::uint32_t object = 0;
    EXPECT_EQ(ringdown_add(mixer, cases[k].name.c_str(), bank, &object, &error), RINGDOWN_OK) << error.sentence;
    const auto& [listener, pose] = std::pair(cases[k].listener, cases[k].object);
    EXPECT_EQ(ringdown_listener(mixer, frame, listener.position_m.data(), listener.wxyz.data(), &error), RINGDOWN_OK);
    EXPECT_EQ(ringdown_pose(mixer, frame, object, pose.position_m.data(), pose.wxyz.data(), &error), RINGDOWN_OK);
    EXPECT_EQ(ringdown_strike(mixer, frame + kStrike, object, kPoint.data(), kBlow.data(), 0, &error), RINGDOWN_OK)
        << error.sentence;
  }
  std::vector<std::vector<float>> channels(head ? 2 : 6, std::vector<float>(cases.size() * kSlot));
  ringdown_block block{};
  block.size = sizeof block;
  block.frames = channels[0].size();
  for (std::size_t c = 0; c < channels.size(); ++c)
    (c < 2 ? block.mix[c] : block.ambisonics[c - 2]) = channels[c].data();
  ringdown_render_all(mixer, &block);
  ringdown_mixer_destroy(mixer);
  ringdown_bank_release(bank);
  return channels;
}

TEST_F(Sides, OfTheBankAreLopsidedTowardsY) {
  ringdown_bank* opened = nullptr;
  ringdown_error error{};
  ASSERT_EQ(ringdown_bank_open(bank().c_str(), &opened, &error), RINGDOWN_OK) << error.sentence;
  const std::array<double, 18> six{1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
  std::array<float, 12> field{};
  ASSERT_EQ(ringdown_bank_far_field(opened, 0, six.data(), 6, field.data(), &error), RINGDOWN_OK) << error.sentence;
  for (std::size_t k : {0, 1, 4, 5}) EXPECT_NEAR(field[2 * k], 0.01, 2e-4) << k;
  EXPECT_NEAR(field[4], 0.0195, 2e-4);
  EXPECT_NEAR(field[6], 0.0005, 2e-4);
  ringdown_bank_release(opened);
}

TEST_F(Sides, AreHeardThroughC) {
  Channels channels = by_c(cases_, bank(), nullptr);
  const Channels ears = head() ? by_c(cases_, bank(), "") : Channels(2, std::vector<float>(frames()));
  channels.insert(channels.end(), ears.begin(), ears.end());
  expect_table(channels);
}

// ---- OSC, and scenes with a score
// -------------------------------------------------------------------------------------

void append(std::vector<wire::Argument>& arguments, const auto& numbers) {
  arguments.insert(arguments.end(), numbers.begin(), numbers.end());
}

double time_of(std::size_t slot, std::size_t frame) { return static_cast<double>(slot * kSlot + frame) / kRate_hz; }

wire::ScoreEvent blow(std::size_t slot, const std::string& object) {
  wire::Message strike{"/object/" + object + "/strike", {}};
  append(strike.arguments, kPoint);
  append(strike.arguments, kBlow);
  strike.arguments.emplace_back(0.0);
  return {time_of(slot, kStrike), strike};
}

wire::ScoreEvent placed(std::size_t slot, const std::string& address, const Place& place) {
  wire::Message message{address, {}};
  append(message.arguments, place.position_m);
  append(message.arguments, place.wxyz);
  return {time_of(slot, 0), message};
}

// Renders once for the mix and the field, and once by the head.
Channels rendered(session::OfflineOptions options, std::size_t frames) {
  options.seconds = static_cast<double>(frames) / kRate_hz;
  options.mixer.ambisonic_order = 1;
  Channels channels;
  const auto take = [&] {
    const auto sound = session::render_offline(options, [](double) { return true; });
    ASSERT_TRUE(sound) << sound.error().message;
    for (const std::string& warning : sound->warnings) {
      if (warning.find("sounds by itself") == warning.npos) ADD_FAILURE() << warning;  // the score strikes what stands
    }
    channels.push_back(sound->left);
    channels.push_back(sound->right);
    channels.insert(channels.end(), sound->ambisonics.begin(), sound->ambisonics.end());
  };
  take();
  options.mixer.ambisonic_order.reset();
  if (head()) {
    options.mixer.head = *head();
    take();
  } else {
    channels.resize(8, std::vector<float>(frames));
  }
  return channels;
}

TEST_F(Sides, AreHeardThroughOsc) {
  session::OfflineOptions options;
  for (std::size_t k = 0; k < cases_.size(); ++k) {
    options.objects.emplace_back(cases_[k].name, bank());
    options.score.push_back(placed(k, "/listener", cases_[k].listener));
    options.score.push_back(placed(k, "/object/" + cases_[k].name + "/pose", cases_[k].object));
    options.score.push_back(blow(k, cases_[k].name));
  }
  expect_table(rendered(options, frames()));
}

TEST_F(Sides, AreHeardThroughOscInBulk) {
  session::OfflineOptions options;
  std::vector<float> records;  // object number, x y z, w x y z, delay; objects are numbered in the order of loading
  for (std::size_t k = 0; k < cases_.size(); ++k) {
    const Place& place = cases_[k].object;
    records.push_back(std::bit_cast<float>(static_cast<std::int32_t>(k)));
    for (const double x : place.position_m) records.push_back(static_cast<float>(x));
    for (const double q : place.wxyz) records.push_back(static_cast<float>(q));
    records.push_back(0);
    options.objects.emplace_back(cases_[k].name, bank());
  }
  options.score.push_back({0, {"/poses", {wire::encode_floats(records)}}});
  for (std::size_t k = 0; k < cases_.size(); ++k) {
    options.score.push_back(placed(k, "/listener", cases_[k].listener));
    options.score.push_back(blow(k, cases_[k].name));
  }
  expect_table(rendered(options, frames()));
}

// A scene has one listener, so there is one for each place of the listener.
class SidesOfScenes : public Sides {
 protected:
  using Group = std::vector<std::size_t>;  // cases with one listener

  std::vector<Group> groups() {
    std::map<std::array<double, 4>, Group> by_turn;
    for (std::size_t k = 0; k < cases_.size(); ++k) by_turn[cases_[k].listener.wxyz].push_back(k);
    std::vector<Group> all;
    for (const auto& [turn, group] : by_turn) all.push_back(group);
    return all;
  }

  void expect_scene(const std::filesystem::path& scene, const Group& group) {
    session::OfflineOptions options;
    options.scene = scene;
    for (const std::size_t k : group) options.score.push_back(blow(k, cases_[k].name));
    expect_table(rendered(options, frames()), group);
  }
};

modal::Json xyzw(const std::array<double, 4>& wxyz) { return {wxyz[1], wxyz[2], wxyz[3], wxyz[0]}; }

TEST_F(SidesOfScenes, AreHeardThroughGltf) {
  // The bank's own file, with other nodes. Its y points up: the root turns our z there.
  std::ifstream file(bank(), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  std::uint32_t size = 0;
  std::memcpy(&size, bytes.data() + 12, 4);
  modal::Json json = modal::Json::parse(bytes.substr(20, size));
  std::ofstream(folder_ / "room.bin", std::ios::binary) << bytes.substr(28 + size);
  json["buffers"][0]["uri"] = "room.bin";
  json["extensions"]["KHR_implicit_shapes"]["shapes"] =
      modal::Json::parse(R"([{"type": "sphere", "sphere": {"radius": 0.05}}])");
  json["cameras"] = modal::Json::parse(R"([{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}])");
  const double h = std::sqrt(0.5);
  for (const Group& group : groups()) {
    const Place& listener = cases_[group[0]].listener;
    modal::Json nodes = modal::Json::array();
    nodes.push_back({{"rotation", {-h, 0, 0, h}}, {"children", {1}}});
    nodes.push_back({{"translation", listener.position_m}, {"rotation", xyzw(listener.wxyz)}, {"children", {2}}});
    // By columns: the camera's right, its x, is our -y; its y is our z; it looks along its -z, our x.
    nodes.push_back({{"camera", 0}, {"matrix", {0, -1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 0, 0, 0, 0, 1}}});
    for (const std::size_t k : group) {
      nodes[0]["children"].push_back(nodes.size());
      modal::Json node = {{"name", cases_[k].name},
                          {"translation", cases_[k].object.position_m},
                          {"rotation", xyzw(cases_[k].object.wxyz)}};
      node["extensions"]["KHR_audio_rigid_bodies"]["modalModel"] = 0;
      node["extensions"]["KHR_physics_rigid_bodies"]["collider"]["geometry"]["shape"] = 0;
      nodes.push_back(node);
    }
    json["nodes"] = nodes;
    json["scenes"] = modal::Json::parse(R"([{"nodes": [0]}])");
    json["scene"] = 0;
    std::ofstream(folder_ / "room.gltf") << json.dump();
    expect_scene(folder_ / "room.gltf", group);
  }
}

TEST_F(SidesOfScenes, AreHeardThroughToml) {
  const auto list = [](const std::array<double, 3>& v) {
    std::ostringstream text;
    text.precision(17);
    text << "[" << v[0] << ", " << v[1] << ", " << v[2] << "]\n";
    return text.str();
  };
  const auto turn = [](const std::array<double, 4>& q) {
    std::ostringstream text;
    text.precision(17);
    text << "{ w = " << q[0] << ", x = " << q[1] << ", y = " << q[2] << ", z = " << q[3] << " }\n";
    return text.str();
  };
  for (const Group& group : groups()) {
    const Place& listener = cases_[group[0]].listener;
    std::string text = "[listener]\nposition_m = " + list(listener.position_m) + "rotation = " + turn(listener.wxyz);
    for (const std::size_t k : group) {
      const std::string name = "name = \"" + cases_[k].name + "\"\n";
      text += "[[object]]\n" + name + "bank = \"lopsided.glb\"\n";
      text += "[[body]]\n" + name + "object = \"" + cases_[k].name + "\"\nfixed = true\nshape = \"sphere\"\n";
      text += "radius_m = 0.05\ndensity_kg_m3 = 1000\nposition_m = " + list(cases_[k].object.position_m);
      text += "rotation = " + turn(cases_[k].object.wxyz);
    }
    std::ofstream(folder_ / "room.toml") << text;
    expect_scene(folder_ / "room.toml", group);
  }
}

// ---- Other languages
// ---------------------------------------------------------------------------------------------------

class SidesOfPrograms : public Sides {
 protected:
  // Runs `command` with a table, the bank and a file, and reads the channels from that.
  void expect_program(std::vector<std::string> command, const Process::Environment& environment,
                      const std::string& table = "directions.txt") {
    cases_ = read_table(table);
    const auto out = folder_ / "sound.f32";
    command.insert(command.end(), {kFolder + table, bank().string(), out.string()});
    const Outcome outcome = run(command, environment);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    std::ifstream file(out, std::ios::binary);
    Channels channels(8, std::vector<float>(frames()));
    for (auto& channel : channels)
      file.read(reinterpret_cast<char*>(channel.data()), static_cast<std::streamsize>(4 * channel.size()));
    ASSERT_TRUE(file);
    expect_table(channels);
  }
};

TEST_F(SidesOfPrograms, AreHeardThroughPython) {
  if (std::string(RINGDOWN_PYTHON).empty()) GTEST_SKIP() << "the Python module is not built";
  if (!head()) GTEST_SKIP() << "libmysofa's head is not installed";
  expect_program({RINGDOWN_PYTHON, "-B", kFolder + "sides.py"},
                 {{"PYTHONPATH", RINGDOWN_BIN_DIR "/../python"}, {"OMP_NUM_THREADS", "1"}});
}

TEST_F(SidesOfPrograms, AreHeardThroughCSharp) {
  if (!installed("mcs") || !installed("mono")) GTEST_SKIP() << "mono-mcs and mono-runtime are not installed";
  if (std::string(RINGDOWN_SANITIZERS) != "") GTEST_SKIP() << "mono does not load a library with sanitizers";
  if (!head()) GTEST_SKIP() << "libmysofa's head is not installed";
  const auto program = folder_ / "Sides.exe";
  const Outcome made =
      run({"mcs", "-out:" + program.string(), kFolder + "Sides.cs", RINGDOWN_SOURCE_DIR "/clients/csharp/Ringdown.cs"});
  ASSERT_EQ(made.exit_code, 0) << made.output;
  const Process::Environment environment = {{"LD_LIBRARY_PATH", RINGDOWN_BIN_DIR "/../lib"}};
  expect_program({"mono", program}, environment);
  expect_program({"mono", program}, environment, "engines.txt");
}

}  // namespace
}  // namespace ringdown::test
