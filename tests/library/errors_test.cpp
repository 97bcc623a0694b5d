// Refusals of the C library: each number outside the range that the header states is named as the header names it, in a
// sentence in the header's words, and like mistakes are one kind of failure.
#include "clients/library/ringdown_scene.h"
#include "tests/library/mixer_of_banks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <regex>
#include <string>
#include <vector>

namespace ringdown::test::errors_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
using Vector = std::array<double, 3>;
constexpr Vector kTop{0, 0, 0.1}, kBlow{0, 0, -0.02}, kNowhere{0, 0, 100}, kNone{};
constexpr std::array<double, 4> kUnturned{1, 0, 0, 0};

bool says(const ringdown_error& error, const std::string& part) {
  return std::string(error.sentence).find(part) != std::string::npos;
}

TEST(LibraryErrors, SayWhatIsWrongAndChangeNothing) {
  MixerOfBanks mixer(1);
  ringdown_error error;
  const auto strike = [&](const std::array<double, 3>& point, const std::array<double, 3>& impulse, double time_s) {
    return ringdown_strike(mixer.get(), 0, 0, point.data(), impulse.data(), time_s, &error);
  };
  EXPECT_EQ(strike({kNan, 0, 0}, kBlow, 0), RINGDOWN_BAD_INPUT);
  EXPECT_TRUE(says(error, "point_m[0] is not a number")) << error.sentence;
  EXPECT_EQ(strike(kTop, {0, 0, std::numeric_limits<double>::infinity()}, 0), RINGDOWN_BAD_INPUT);
  EXPECT_TRUE(says(error, "impulse_ns[2] is infinite")) << error.sentence;
  EXPECT_EQ(strike(kTop, kBlow, 1), RINGDOWN_BAD_INPUT);
  EXPECT_TRUE(says(error, "contact_time_s is 1; it must be a number from 0 to 0.1 s")) << error.sentence;
  EXPECT_EQ(strike({0, 0, 100}, kBlow, 0), RINGDOWN_BAD_INPUT);
  EXPECT_TRUE(says(error, "metres")) << error.sentence;
  EXPECT_EQ(ringdown_strike(mixer.get(), 0, 7, kTop.data(), kBlow.data(), 0, &error), RINGDOWN_BAD_INPUT);
  EXPECT_TRUE(says(error, "no object number 7")) << error.sentence;
  EXPECT_EQ(ringdown_strike_vertex(mixer.get(), 0, 0, 1000, kBlow.data(), 0, &error), RINGDOWN_BAD_INPUT);
  EXPECT_EQ(ringdown_strike_vertex(mixer.get(), 0, 0, 0xffffffff, kBlow.data(), 0, &error), RINGDOWN_BAD_INPUT);
  EXPECT_EQ(ringdown_strike(mixer.get(), 48000LL * 3700, 0, kTop.data(), kBlow.data(), 0, &error), RINGDOWN_BAD_INPUT);
  EXPECT_EQ(ringdown_strike(mixer.get(), 0, 0, nullptr, kBlow.data(), 0, &error), RINGDOWN_BAD_INPUT);
  EXPECT_EQ(ringdown_strike(nullptr, 0, 0, kTop.data(), kBlow.data(), 0, nullptr), RINGDOWN_BAD_INPUT);
  EXPECT_EQ(ringdown_hold(mixer.get(), 0, 0, 8, kTop.data(), kTop.data(), 1, &error), RINGDOWN_BAD_INPUT);
  ringdown_bank* bank = nullptr;
  EXPECT_EQ(ringdown_bank_open("/nonexistent/bell.glb", &bank, &error), RINGDOWN_BAD_INPUT);
  EXPECT_TRUE(says(error, "/nonexistent/bell.glb")) << error.sentence;
  EXPECT_EQ(bank, nullptr);

  std::array<float, 256> left, right;
  ringdown_render(mixer.get(), left.data(), right.data(), left.size());
  EXPECT_TRUE(std::ranges::all_of(left, [](float sample) { return sample == 0; }));
}

// A program that keeps 0.1 s as a 32-bit float hands over 0.1000000015 s.
TEST(LibraryErrors, ALimitThatWasAFloatIsTheLimit) {
  MixerOfBanks mixer(1);
  const auto strike = [&](float time_s) {
    return ringdown_strike(mixer.get(), 0, 0, kTop.data(), kBlow.data(), static_cast<double>(time_s), nullptr);
  };
  EXPECT_EQ(strike(0.1F), RINGDOWN_OK);
  EXPECT_EQ(strike(std::nextafter(0.1F, 1.0F)), RINGDOWN_BAD_INPUT);
  ringdown_material material;
  ringdown_material_init(&material, sizeof material);
  material.size = static_cast<double>(0.01F);  // below 0.01
  EXPECT_EQ(ringdown_set_material(mixer.get(), 0, &material, nullptr), RINGDOWN_OK);
}

TEST(LibraryErrors, AFullQueueRefusesAndCounts) {
  MixerOfBanks mixer(1);
  ringdown_error error;
  int taken = 0;
  while (ringdown_strike(mixer.get(), 0, 0, kTop.data(), kBlow.data(), 0, &error) == RINGDOWN_OK && taken < 10000)
    ++taken;
  EXPECT_EQ(taken, 4096);
  EXPECT_EQ(error.result, RINGDOWN_REFUSED);
  ringdown_status status{};
  status.size = sizeof status;
  ASSERT_EQ(ringdown_get_status(mixer.get(), &status), RINGDOWN_OK);
  EXPECT_EQ(status.dropped, 1u);
}

// Calls with one number of free choice.
class LibraryRanges : public testing::Test {
 protected:
  using Call = std::function<ringdown_result(double)>;
  struct Range {
    const char* name;
    const char* text;  // as the header has it
    Call call;
  };

  template <class Struct>
  Call with(void (*init)(Struct*, std::size_t), double Struct::*member,
            ringdown_result (*play)(ringdown_mixer*, std::int64_t, std::uint32_t, const Struct*, ringdown_error*)) {
    return [=, this](double value) {
      Struct made;
      init(&made, sizeof made);
      std::ranges::copy(kTop, made.point_m);
      if constexpr (requires { made.direction; }) std::ranges::copy(Vector{0, 0, 1}, made.direction);
      if constexpr (requires { made.velocity_m_s; }) std::ranges::copy(Vector{0, 0, 1}, made.velocity_m_s);
      if constexpr (requires { made.other; }) made.other = 1;
      made.*member = value;
      return play(mixer(), 0, 0, &made, &error_);
    };
  }
  Call material(double ringdown_material::*member) {
    return [=, this](double value) {
      ringdown_material made;
      ringdown_material_init(&made, sizeof made);
      made.*member = value;
      return ringdown_set_material(mixer(), 1, &made, &error_);
    };
  }
  template <class Member>
  Call setting(Member ringdown_settings::*member) {
    return [=, this](double value) {
      ringdown_settings made;
      ringdown_settings_init(&made, sizeof made);
      made.*member = static_cast<Member>(value);
      ringdown_mixer* unused = nullptr;
      const ringdown_result result = ringdown_mixer_create(&made, &unused, &error_);
      ringdown_mixer_destroy(unused);
      return result;
    };
  }

  std::vector<Range> ranges() {
    const auto strike = [this](double s) {
      return ringdown_strike(mixer(), 0, 0, kTop.data(), kBlow.data(), s, &error_);
    };
    const auto hold = [this](double s) {
      return ringdown_hold(mixer(), 0, 0, 0, kTop.data(), kNone.data(), s, &error_);
    };
    using C = ringdown_contact_args;
    using B = ringdown_bow_args;
    using M = ringdown_mallet_args;
    using O = ringdown_couple_args;
    return {
        {"contact_time_s", "0 ... 0.1", strike},
        {"slip_m_s", "0 ... 1000", with(ringdown_contact_args_init, &C::slip_m_s, ringdown_contact)},
        {"roll_m_s", "0 ... 1000", with(ringdown_contact_args_init, &C::roll_m_s, ringdown_contact)},
        {"roughness_m", "0 ... 0.1", with(ringdown_contact_args_init, &C::roughness_m, ringdown_contact)},
        {"correlation_m", "1e-7 ... 10", with(ringdown_contact_args_init, &C::correlation_m, ringdown_contact)},
        {"slope", "-10 ... 0", with(ringdown_contact_args_init, &C::slope, ringdown_contact)},
        {"speed_m_s", "-100 ... 100", with(ringdown_bow_args_init, &B::speed_m_s, ringdown_bow)},
        {"force_n", "0 ... 100000", with(ringdown_bow_args_init, &B::force_n, ringdown_bow)},
        {"width_m", "0 ... 1", with(ringdown_bow_args_init, &B::width_m, ringdown_bow)},
        {"rosin", "0 ... 5", with(ringdown_bow_args_init, &B::rosin, ringdown_bow)},
        {"mass_kg", "1e-5 ... 100", with(ringdown_mallet_args_init, &M::mass_kg, ringdown_mallet)},
        {"head", "1 ... 1e14", with(ringdown_mallet_args_init, &M::head, ringdown_mallet)},
        {"bounce", "0.01 ... 1", with(ringdown_mallet_args_init, &M::bounce, ringdown_mallet)},
        {"weight_n", "0 ... 100000", with(ringdown_couple_args_init, &O::weight_n, ringdown_couple)},
        {"gap_m", "-0.01 ... 0.1", with(ringdown_couple_args_init, &O::gap_m, ringdown_couple)},
        {"stiffness", "0 ... 1e14", with(ringdown_couple_args_init, &O::stiffness, ringdown_couple)},
        {"friction", "0 ... 5", with(ringdown_couple_args_init, &O::friction, ringdown_couple)},
        {"bounce", "0.01 ... 1", with(ringdown_couple_args_init, &O::bounce, ringdown_couple)},
        {"mass_kg", "0 ... 100000", with(ringdown_couple_args_init, &O::mass_kg, ringdown_couple)},
        {"amplitude", "0 ... 1", [this](double a) { return ringdown_ring(mixer(), 0, 0, 0, 1, a, &error_); }},
        {"gain", "0 ... 100", [this](double g) { return ringdown_gain(mixer(), 0, 0, g, 0, &error_); }},
        {"ramp_s", "0 ... 60", [this](double s) { return ringdown_gain(mixer(), 0, 0, 1, s, &error_); }},
        {"ramp_s", "0 ... 60", [this](double s) { return ringdown_clear(mixer(), 0, 0, s, &error_); }},
        {"within_s", "0 ... 60", [this](double s) { return ringdown_choke(mixer(), 0, 0, s, &error_); }},
        {"pan", "-1 ... 1", [this](double p) { return ringdown_pan(mixer(), 0, 0, p, &error_); }},
        {"temperature_c", "-50 ... 60", [this](double t) { return ringdown_listener_air(mixer(), 0, t, 50, &error_); }},
        {"humidity_percent", "0 ... 100",
         [this](double h) { return ringdown_listener_air(mixer(), 0, 20, h, &error_); }},
        {"damping_ns_m", "0 ... 1e6", hold},
        {"stiffness", "0.001 ... 1000", material(&ringdown_material::stiffness)},
        {"density", "0.001 ... 1000", material(&ringdown_material::density)},
        {"size", "0.01 ... 100", material(&ringdown_material::size)},
        {"alpha", "0 ... 1000", material(&ringdown_material::alpha)},
        {"beta", "0 ... 1000", material(&ringdown_material::beta)},
        {"sample_rate_hz", "8000 ... 384000", setting(&ringdown_settings::sample_rate_hz)},
        {"full_scale_pa", "1e-6 ... 1e6", setting(&ringdown_settings::full_scale_pa)},
        {"floor_db", "20 ... 300", setting(&ringdown_settings::floor_db)},
        {"limiter_db", "-60 ... 0", setting(&ringdown_settings::limiter_db)},
        {"threads", "1 ... 64", setting(&ringdown_settings::threads)},
    };
  }

  ringdown_mixer* mixer() { return banks_.get(); }

  MixerOfBanks banks_{2};
  ringdown_error error_{};
};

TEST_F(LibraryRanges, AreThoseOfTheHeader) {
  std::ifstream file(RINGDOWN_SOURCE_DIR "/clients/library/ringdown.h");
  const std::string header{std::istreambuf_iterator<char>(file), {}};
  for (const auto& [name, text, call] : ranges()) {
    SCOPED_TRACE(std::string(name) + " " + text);
    EXPECT_NE(header.find(text), header.npos);
    EXPECT_NE(header.find(name), header.npos);
    const double min = std::strtod(text, nullptr), max = std::strtod(std::strstr(text, "...") + 3, nullptr);
    ASSERT_LT(min, max);
    EXPECT_EQ(call(min), RINGDOWN_OK) << error_.sentence;
    EXPECT_EQ(call(max), RINGDOWN_OK) << error_.sentence;
    const bool is_whole = std::string(name) == "threads";
    for (const double outside : {min - (is_whole ? 1 : 1e-3 * std::max(1.0, std::abs(min))),
                                 max + (is_whole ? 1 : 1e-3 * std::max(1e-3, std::abs(max)) + 1e-4)}) {
      EXPECT_EQ(call(outside), RINGDOWN_BAD_INPUT) << outside;
      EXPECT_TRUE(std::string(error_.sentence).starts_with(std::string(name) + " is ")) << error_.sentence;
    }
    if (!is_whole) {
      EXPECT_EQ(call(kNan), RINGDOWN_BAD_INPUT);
    }
  }
}

// Every parameter that is an array or a number of something, by its own name.
TEST_F(LibraryRanges, OfArraysNameTheElement) {
  const Vector wrong{0, kNan, 0};
  const std::array<double, 4> wrong_turn{1, 0, 7, 0};
  ringdown_contact_args contact;
  ringdown_contact_args_init(&contact, sizeof contact);
  contact.force_n[2] = 1e9;
  ringdown_bow_args bow;
  ringdown_bow_args_init(&bow, sizeof bow);
  bow.direction[0] = 1e9;
  ringdown_mallet_args mallet;
  ringdown_mallet_args_init(&mallet, sizeof mallet);
  mallet.velocity_m_s[1] = 1e9;
  ringdown_couple_args coupling;
  ringdown_couple_args_init(&coupling, sizeof coupling);
  coupling.other = 1, coupling.other_point_m[0] = 1e9;
  auto* const m = mixer();
  auto* const e = &error_;
  const std::vector<std::pair<const char*, std::function<ringdown_result()>>> calls = {
      {"point_m[1]", [&] { return ringdown_strike(m, 0, 0, wrong.data(), kBlow.data(), 0, e); }},
      {"impulse_ns[1]", [&] { return ringdown_strike(m, 0, 0, kTop.data(), wrong.data(), 0, e); }},
      {"impulse_ns[1]", [&] { return ringdown_strike_vertex(m, 0, 0, 0, wrong.data(), 0, e); }},
      {"impulse_ns[1]", [&] { return ringdown_click(m, 0, 0, wrong.data(), 0, e); }},
      {"vertex ", [&] { return ringdown_strike_vertex(m, 0, 0, 1u << 30, kBlow.data(), 0, e); }},
      {"force_n[2]", [&] { return ringdown_contact(m, 0, 0, &contact, e); }},
      {"direction[0]", [&] { return ringdown_bow(m, 0, 0, &bow, e); }},
      {"velocity_m_s[1]", [&] { return ringdown_mallet(m, 0, 0, &mallet, e); }},
      {"other_point_m[0]", [&] { return ringdown_couple(m, 0, 0, &coupling, e); }},
      {"first ", [&] { return ringdown_ring(m, 0, 0, 1u << 30, 1, 0.1, e); }},
      {"position_m[1]", [&] { return ringdown_pose(m, 0, 0, wrong.data(), kUnturned.data(), e); }},
      {"rotation_wxyz[2]", [&] { return ringdown_pose(m, 0, 0, kTop.data(), wrong_turn.data(), e); }},
      {"position_m[1]", [&] { return ringdown_listener(m, 0, wrong.data(), kUnturned.data(), e); }},
      {"rotation_wxyz[2]", [&] { return ringdown_listener(m, 0, kTop.data(), wrong_turn.data(), e); }},
      {"point_m[1]", [&] { return ringdown_hold(m, 0, 0, 0, wrong.data(), kNone.data(), 1, e); }},
      {"direction[1]", [&] { return ringdown_hold(m, 0, 0, 0, kTop.data(), wrong.data(), 1, e); }},
      {"number is 8; it must be a whole number from 0 to 7",
       [&] { return ringdown_hold(m, 0, 0, 8, kTop.data(), kNone.data(), 1, e); }},
      {"point_m[1]", [&] { return ringdown_excite(m, 0, 0, wrong.data(), kBlow.data(), e); }},
      {"force_n[1]", [&] { return ringdown_excite(m, 0, 0, kTop.data(), wrong.data(), e); }},
      {"input is 4; it must be a whole number from 0 to 3",
       [&] { return ringdown_excite(m, 4, 0, kTop.data(), kBlow.data(), e); }},
      {"point_m must not be NULL", [&] { return ringdown_strike(m, 0, 0, nullptr, kBlow.data(), 0, e); }},
      {"impulse_ns must not be NULL", [&] { return ringdown_strike(m, 0, 0, kTop.data(), nullptr, 0, e); }},
      {"rotation_wxyz must not be NULL", [&] { return ringdown_pose(m, 0, 0, kTop.data(), nullptr, e); }},
      {"force_n must not be NULL", [&] { return ringdown_excite(m, 0, 0, kTop.data(), nullptr, e); }},
      {"direction must not be NULL", [&] { return ringdown_hold(m, 0, 0, 0, kTop.data(), nullptr, 1, e); }},
  };
  for (const auto& [name, call] : calls) {
    EXPECT_EQ(call(), RINGDOWN_BAD_INPUT) << name;
    EXPECT_TRUE(std::string(error_.sentence).starts_with(name)) << name << ": " << error_.sentence;
  }
}

// Whatever acts at a point of an object refuses one that is 100 m away; what ends or is at no point is not asked.
TEST_F(LibraryRanges, PointsFarFromTheObjectAreRefusedEverywhere) {
  ringdown_contact_args contact;
  ringdown_contact_args_init(&contact, sizeof contact);
  std::ranges::copy(kNowhere, contact.point_m);
  ringdown_bow_args bow;
  ringdown_bow_args_init(&bow, sizeof bow);
  std::ranges::copy(kNowhere, bow.point_m), bow.direction[0] = 1;
  ringdown_mallet_args mallet;
  ringdown_mallet_args_init(&mallet, sizeof mallet);
  std::ranges::copy(kNowhere, mallet.point_m), mallet.velocity_m_s[2] = -1;
  ringdown_couple_args coupling;
  ringdown_couple_args_init(&coupling, sizeof coupling);
  coupling.other = 1, coupling.direction[2] = 1;
  std::ranges::copy(kNowhere, coupling.other_point_m);
  auto* const m = mixer();
  auto* const e = &error_;
  const std::vector<std::function<ringdown_result()>> calls = {
      [&] { return ringdown_strike(m, 0, 0, kNowhere.data(), kBlow.data(), 0, e); },
      [&] { return ringdown_contact(m, 0, 0, &contact, e); },
      [&] { return ringdown_bow(m, 0, 0, &bow, e); },
      [&] { return ringdown_mallet(m, 0, 0, &mallet, e); },
      [&] { return ringdown_couple(m, 0, 0, &coupling, e); },
      [&] { return ringdown_hold(m, 0, 0, 0, kNowhere.data(), kNone.data(), 1, e); },
      [&] { return ringdown_excite(m, 0, 0, kNowhere.data(), kBlow.data(), e); },
  };
  for (std::size_t k = 0; k < calls.size(); ++k) {
    EXPECT_EQ(calls[k](), RINGDOWN_BAD_INPUT) << k;
    EXPECT_TRUE(says(error_, "m off the object")) << k << ": " << error_.sentence;
  }
  EXPECT_EQ(ringdown_hold(m, 0, 0, 0, kNowhere.data(), kNone.data(), 0, e), RINGDOWN_OK) << error_.sentence;
  ASSERT_EQ(ringdown_excite(m, 0, 0, kTop.data(), kBlow.data(), e), RINGDOWN_OK) << error_.sentence;
  EXPECT_EQ(ringdown_excite(m, 0, 0, kNowhere.data(), kNone.data(), e), RINGDOWN_OK) << error_.sentence;

  // An object of a hundred times the size is struck on its own surface, not on the bank's.
  ringdown_material material;
  ringdown_material_init(&material, sizeof material);
  material.size = 100;
  ASSERT_EQ(ringdown_set_material(m, 0, &material, e), RINGDOWN_OK) << error_.sentence;
  const Vector outside{0, 0, 10};
  EXPECT_EQ(ringdown_strike(m, 0, 0, outside.data(), kBlow.data(), 0, e), RINGDOWN_OK) << error_.sentence;
}

TEST(LibraryErrors, SpeakTheWordsOfTheHeader) {
  MixerOfBanks mixer(1);
  auto* const m = mixer.get();
  ringdown_error error{};
  ringdown_scene* scene = nullptr;
  ASSERT_EQ(ringdown_scene_load(m, RINGDOWN_SOURCE_DIR "/presets/scenes/dominoes.toml", 0, &scene, &error), RINGDOWN_OK)
      << error.sentence;
  std::uint32_t number = 0;
  const Vector far{0, 0, 1e9};
  const std::array<double, 4> long_turn{0.5, 0.5, 0, 0};
  ringdown_bow_args bow;
  ringdown_bow_args_init(&bow, sizeof bow);
  ringdown_couple_args coupling;
  ringdown_couple_args_init(&coupling, sizeof coupling);
  const std::vector<std::function<ringdown_result()>> calls = {
      [&] { return ringdown_strike(m, 0, 99, kTop.data(), kBlow.data(), 0, &error); },
      [&] { return ringdown_remove(m, 99, &error); },
      [&] { return ringdown_mute(m, 99, 1, &error); },
      [&] { return ringdown_strike_vertex(m, 0, 0, 5000, kBlow.data(), 0, &error); },
      [&] { return ringdown_ring(m, 0, 0, 5000, 1, 0.1, &error); },
      [&] { return ringdown_pose(m, 0, 0, kTop.data(), long_turn.data(), &error); },
      [&] { return ringdown_bow(m, 0, 0, &bow, &error); },
      [&] { return ringdown_couple(m, 0, 0, &coupling, &error); },
      [&] { return ringdown_excite(m, 0, 0, kTop.data(), kNone.data(), &error); },
      [&] { return ringdown_excite(m, 9, 0, kTop.data(), kBlow.data(), &error); },
      [&] { return ringdown_add(m, "1", nullptr, &number, &error); },
      [&] { return ringdown_strike(m, 1LL << 40, 0, kTop.data(), kBlow.data(), 0, &error); },
      [&] { return ringdown_scene_push(scene, 5000, kBlow.data(), &error); },
      [&] { return ringdown_scene_push(scene, 1, far.data(), &error); },
      [&] { return ringdown_scene_find_body(scene, "nobody", &number, &error); },
      [&] { return ringdown_scene_load(m, "x.toml", 0, &scene, &error); },
  };
  // An address, an argument of one, or an option of the daemon.
  const std::regex osc("(^|[ (])/[a-z]+|\\b[jqvnfdo][xyzw]\\b|vertex|argument [0-9]|--root|contact_time ");
  for (std::size_t k = 0; k < calls.size(); ++k) {
    EXPECT_NE(calls[k](), RINGDOWN_OK) << k;
    EXPECT_FALSE(std::regex_search(error.sentence, osc)) << k << ": " << error.sentence;
    EXPECT_GT(std::strlen(error.sentence), 10u) << k;
  }
  ringdown_scene_destroy(scene);
}

// A file that is missing, or is not of its kind, is bad input, whatever it is for.
TEST(LibraryErrors, OfFilesAreOfOneKind) {
  const TemporaryFolder folder;
  std::ofstream(folder / "text") << "This is no file of Ringdown.";
  MixerOfBanks mixer(1);
  for (const std::filesystem::path& path : {folder / "missing", folder / "text", folder.path()}) {
    ringdown_error error{};
    ringdown_bank* bank = nullptr;
    EXPECT_EQ(ringdown_bank_open(path.c_str(), &bank, &error), RINGDOWN_BAD_INPUT) << error.sentence;
    ringdown_scene* scene = nullptr;
    EXPECT_EQ(ringdown_scene_load(mixer.get(), path.c_str(), 0, &scene, &error), RINGDOWN_BAD_INPUT) << error.sentence;
    ringdown_settings settings;
    ringdown_settings_init(&settings, sizeof settings);
    settings.head = path.c_str();
    ringdown_mixer* other = nullptr;
    EXPECT_EQ(ringdown_mixer_create(&settings, &other, &error), RINGDOWN_BAD_INPUT) << error.sentence;
    EXPECT_TRUE(says(error, path.string())) << error.sentence;
  }
}

// The header's figure: 1024 events happen in 128 frames, and the others are not late.
TEST(LibraryEvents, BeyondThoseOf128FramesHappenInTheNext) {
  MixerOfBanks mixer(1);
  ringdown_error error{};
  for (int k = 0; k < 4096; ++k) {
    ASSERT_EQ(ringdown_strike(mixer.get(), 0, 0, kTop.data(), kBlow.data(), 0, &error), RINGDOWN_OK) << error.sentence;
  }
  std::array<float, 128> left, right;
  for (std::uint64_t block = 1; block <= 4; ++block) {
    ringdown_render(mixer.get(), left.data(), right.data(), left.size());
    ringdown_status status{};
    status.size = sizeof status;
    ASSERT_EQ(ringdown_get_status(mixer.get(), &status), RINGDOWN_OK);
    EXPECT_EQ(status.strikes, 1024 * block);
    EXPECT_EQ(status.late, 0u);
  }
}

}  // namespace
}  // namespace ringdown::test::errors_test
