// The rules that VST3's validators (the SDK's own and pluginval) hold plug-ins to, as far as they can be asked without
// a window: parameters, their texts, units, buses, tail and note expressions of the built plug-in.
#include "tests/plugin/host.h"

#include <gtest/gtest.h>

#include "src/travesty/audio_processor.h"
#include "src/travesty/component.h"
#include "src/travesty/edit_controller.h"
#include "src/travesty/factory.h"
#include "src/travesty/unit.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

namespace ringdown::test {
namespace {

const std::string kPath = RINGDOWN_LIB_DIR "/vst3/ringdown.vst3/Contents/" RINGDOWN_VST3_FOLDER "/ringdown.so";
constexpr v3_param_id kFirst = 16 * 130;  // sessions and automation store these numbers; before them are MIDI's
constexpr v3_param_id kObject = kFirst + 1, kRootKey = kFirst + 3, kGain = kFirst + 11, kEven = kFirst + 10;

std::string ascii(const std::int16_t* text) {
  std::string bytes;
  for (; *text; ++text) bytes += static_cast<char>(*text);
  return bytes;
}

class Vst3Rules : public testing::Test {
 protected:
  Vst3Rules() {
    const Module module(kPath);
    EXPECT_TRUE(reinterpret_cast<bool (*)(void*)>(module.symbol("ModuleEntry"))(nullptr));
    auto* const factory = reinterpret_cast<v3_plugin_factory** (*)()>(module.symbol("GetPluginFactory"))();
    v3_class_info about{};
    v3_cpp_obj(factory)->get_class_info(factory, 0, &about);
    void* made = nullptr;
    EXPECT_EQ(v3_cpp_obj(factory)->create_instance(factory, about.class_id, v3_component_iid, &made), V3_OK);
    component = static_cast<v3_component**>(made);
    v3_cpp_obj_initialize(component, nullptr);
    v3_cpp_obj_query_interface(component, v3_audio_processor_iid, &processor);
    v3_cpp_obj_query_interface(component, v3_edit_controller_iid, &controller);
    v3_cpp_obj_initialize(controller, nullptr);
  }
  ~Vst3Rules() override {
    v3_cpp_obj_unref(processor);
    v3_cpp_obj_terminate(controller);
    v3_cpp_obj_unref(controller);
    v3_cpp_obj_terminate(component);
    v3_cpp_obj_unref(component);
  }
  [[nodiscard]] v3_param_info info(v3_param_id id) const {
    v3_param_info found{};
    EXPECT_EQ(v3_cpp_obj(controller)->get_parameter_info(controller, static_cast<std::int32_t>(id), &found), V3_OK);
    return found;
  }
  [[nodiscard]] std::string text(v3_param_id id, double normal) const {
    v3_str_128 found{};
    EXPECT_EQ(v3_cpp_obj(controller)->get_parameter_string_for_value(controller, id, normal, found), V3_OK);
    return ascii(found);
  }
  [[nodiscard]] std::string text_of_plain(v3_param_id id, double plain) const {
    return text(id, v3_cpp_obj(controller)->plain_parameter_to_normalised(controller, id, plain));
  }
  [[nodiscard]] v3_result value(v3_param_id id, const std::string& from, double& normal) const {
    v3_str_128 given{};
    std::copy(from.begin(), from.end(), given);
    return v3_cpp_obj(controller)->get_parameter_value_for_string(controller, id, given, &normal);
  }
  [[nodiscard]] v3_param_id end() const {
    return static_cast<v3_param_id>(v3_cpp_obj(controller)->get_parameter_count(controller));
  }

  v3_component** component = nullptr;
  v3_audio_processor** processor = nullptr;
  v3_edit_controller** controller = nullptr;
};

TEST_F(Vst3Rules, ParametersKeepTheirNumbersAndHaveNamesUnitsAndGroups) {
  ASSERT_EQ(end(), kFirst + 21);
  v3_unit_information** units = nullptr;
  ASSERT_EQ(v3_cpp_obj_query_interface(controller, v3_unit_information_iid, &units), V3_OK);
  std::set<std::int32_t> known;
  std::set<std::string> names;
  for (std::int32_t i = 0; i < v3_cpp_obj(units)->get_unit_count(units); ++i) {
    v3_unit_info unit{};
    ASSERT_EQ(v3_cpp_obj(units)->get_unit_info(units, i, &unit), V3_OK);
    EXPECT_TRUE(known.insert(unit.id).second && names.insert(ascii(unit.name)).second);
    EXPECT_EQ(unit.parent_unit_id, unit.id == 0 ? -1 : 0);
  }
  EXPECT_EQ(names, (std::set<std::string>{"Root", "Object", "Body", "Strike", "Playing", "Output", "Session"}));
  std::set<std::string> titles;
  for (v3_param_id id = kFirst; id < end(); ++id) {
    const v3_param_info one = info(id);
    EXPECT_EQ(one.param_id, id);
    EXPECT_TRUE(titles.insert(ascii(one.title)).second);
    EXPECT_TRUE(one.unit_id > 0 && known.contains(one.unit_id)) << ascii(one.title);
    EXPECT_TRUE(one.default_normalised_value >= 0 && one.default_normalised_value <= 1);
  }
  EXPECT_EQ(ascii(info(kGain).units), "dB");
  EXPECT_EQ(info(0).unit_id, 0) << "of the MIDI controllers";
}

TEST_F(Vst3Rules, EveryStepOfAParameterIsAWholeValue) {
  for (v3_param_id id = kFirst; id < end(); ++id) {
    const v3_param_info one = info(id);
    for (std::int32_t step = 0; step <= one.step_count && one.step_count > 0; ++step) {
      const double plain =
          v3_cpp_obj(controller)
              ->normalised_parameter_to_plain(controller, id, step / static_cast<double>(one.step_count));
      EXPECT_NEAR(plain, std::round(plain), 1e-4) << ascii(one.title);
    }
  }
  EXPECT_EQ(info(kObject).step_count, 127);
}

TEST_F(Vst3Rules, TextsOfParametersMeanTheirValues) {
  EXPECT_EQ(text_of_plain(kRootKey, 60), "C4");
  EXPECT_EQ(text_of_plain(kObject, 31), "mug");
  EXPECT_EQ(text_of_plain(kGain, -6), "-6.00");
  EXPECT_EQ(text(kEven, 1), "on");
  for (v3_param_id id = kFirst; id < end(); ++id) {
    for (int i = 0; i <= 16; ++i) {
      const std::string shown = text(id, i / 16.0);
      double meant = -1;
      ASSERT_EQ(value(id, shown, meant), V3_OK) << id << shown;
      EXPECT_TRUE(meant >= 0 && meant <= 1);
      EXPECT_EQ(text(id, meant), shown) << id;
    }
    double kept = 0.25;
    EXPECT_NE(value(id, "no such text", kept), V3_OK) << id;
    EXPECT_EQ(kept, 0.25);
  }
  v3_str_128 ignored{};
  EXPECT_NE(v3_cpp_obj(controller)->get_parameter_string_for_value(controller, kGain, 1.5, ignored), V3_OK);
}

TEST_F(Vst3Rules, WhatRingsHasATail) {
  EXPECT_GT(v3_cpp_obj(processor)->get_tail_samples(processor), 48000U);
  EXPECT_EQ(v3_cpp_obj(processor)->get_latency_samples(processor), 0U);
}

TEST_F(Vst3Rules, NoteExpressionsAreAnnounced) {
  constexpr v3_tuid id = V3_ID(0xB7F8F859, 0x41234872, 0x91169581, 0x4F3721A3);
  struct Table : v3_funknown {
    std::int32_t (*count)(void*, std::int32_t, std::int16_t);
  };
  Table** expressions = nullptr;
  ASSERT_EQ(v3_cpp_obj_query_interface(controller, id, &expressions), V3_OK);
  EXPECT_EQ((*expressions)->count(expressions, 0, 0), 2);
  EXPECT_EQ((*expressions)->count(expressions, 1, 0), 0);
}

}  // namespace
}  // namespace ringdown::test
