// The VST3 plug-in's entry: a layer in front of DPF's factory that adds what DPF 1.6 lacks.
//
// - Texts of parameters are those of parameter_text.h, and parameters belong to units.
// - The parameter Object has as many steps as it has values; DPF counts only the named ones.
// - Note expressions reach the instrument (vst3_notes.h), and are announced to hosts.
// - Velocities are rounded to the nearest of MIDI's; DPF rounds them down.
// - A window that closes lets go of the key that the mouse holds in it.
// - The tail is unlimited: DPF says that there is none, and hosts would cut off what rings.
//
// DPF's function is compiled under the name dpf_GetPluginFactory. Objects of VST3 are pointers to a table of functions,
// and DPF gives every object a table of its own. We replace functions in these tables and call the ones that were
// there.
#include "clients/plugin/parameter_text.h"
#include "clients/plugin/vst3_notes.h"
#include "engine/base/formatted.h"

#include "src/travesty/audio_processor.h"
#include "src/travesty/component.h"
#include "src/travesty/edit_controller.h"
#include "src/travesty/events.h"
#include "src/travesty/factory.h"
#include "src/travesty/unit.h"
#include "src/travesty/view.h"

#include <algorithm>
#include <limits>
#include <string>
#include <string_view>

extern "C" __attribute__((visibility("default"))) const void* GetPluginFactory();
extern "C" const void* dpf_GetPluginFactory();

namespace {

using namespace ringdown::plugin;

constexpr std::uint32_t kUnlimitedTail = std::numeric_limits<std::uint32_t>::max();
constexpr float kHalfVelocity = 0.5F / 127;

// DPF's functions, which are the same for every object.
v3_plugin_factory dpf_factory{};
v3_funknown dpf_component{}, dpf_controller_object{};
v3_edit_controller dpf_controller{};
v3_audio_processor dpf_processor{};
v3_plugin_view dpf_view{};

void write_text(std::string_view text, v3_str_128 target) {
  const std::size_t count = std::min<std::size_t>(text.size(), 127);
  std::copy_n(text.begin(), count, target);
  target[count] = 0;
}

std::string read_text(const std::int16_t* text) {
  std::string bytes;
  for (std::size_t i = 0; i < 127 && text[i] > 0 && text[i] < 128; ++i) bytes += static_cast<char>(text[i]);
  return bytes;
}

// Units: the groups of parameters

std::uint32_t one(void*) { return 1; }
v3_result no(void*, const v3_tuid, void** object) {
  *object = nullptr;
  return V3_NO_INTERFACE;
}
const v3_funknown kStatic{no, one, one};

constexpr std::int32_t unit_of(Group group) { return static_cast<std::int32_t>(group) + 1; }

struct Units : v3_funknown {
  v3_unit_information unit;
};
const Units kUnits{
    kStatic,
    {[](void*) { return static_cast<std::int32_t>(kGroups) + 1; },
     [](void*, std::int32_t index, v3_unit_info* about) -> v3_result {
       if (index < 0 || index > static_cast<std::int32_t>(kGroups)) return V3_INVALID_ARG;
       *about = {index, index == 0 ? -1 : 0, {}, -1};
       write_text(index == 0 ? "Root" : kGroupInfo[static_cast<std::size_t>(index) - 1].name, about->name);
       return V3_OK;
     },
     [](void*) { return std::int32_t{0}; },
     [](void*, std::int32_t, v3_program_list_info*) -> v3_result { return V3_INVALID_ARG; },
     [](void*, std::int32_t, std::int32_t, v3_str_128) -> v3_result { return V3_INVALID_ARG; },
     [](void*, std::int32_t, std::int32_t, const char*, v3_str_128) -> v3_result { return V3_INVALID_ARG; },
     [](void*, std::int32_t, std::int32_t) -> v3_result { return V3_FALSE; },
     [](void*, std::int32_t, std::int32_t, std::int16_t, v3_str_128) -> v3_result { return V3_FALSE; },
     [](void*) { return std::int32_t{0}; }, [](void*, std::int32_t) -> v3_result { return V3_OK; },
     [](void*, std::int32_t, std::int32_t, std::int32_t, std::int32_t, std::int32_t*) -> v3_result { return V3_FALSE; },
     [](void*, std::int32_t, std::int32_t, v3_bstream**) -> v3_result { return V3_FALSE; }}};

// Note expressions: INoteExpressionController, for which DPF has no header

constexpr v3_tuid kNoteExpressionController = V3_ID(0xB7F8F859, 0x41234872, 0x91169581, 0x4F3721A3);
constexpr std::uint32_t kTuning = 2, kBrightness = 5;  // the format's numbers
constexpr std::uint32_t kExclusive = 0;                // of the format's data: a system exclusive message

struct ExpressionInfo {
  std::uint32_t id;
  v3_str_128 title, short_title, units;
  std::int32_t unit;
  double standard, min, max;
  std::int32_t steps;
  v3_param_id parameter;
  std::int32_t flags;
};
constexpr std::int32_t kBipolar = 1, kAbsolute = 4;

struct ExpressionTable : v3_funknown {
  std::int32_t (*count)(void*, std::int32_t bus, std::int16_t channel);
  v3_result (*info)(void*, std::int32_t bus, std::int16_t channel, std::int32_t index, ExpressionInfo*);
  v3_result (*text)(void*, std::int32_t bus, std::int16_t channel, std::uint32_t id, double value, v3_str_128);
  v3_result (*value)(void*, std::int32_t bus, std::int16_t channel, std::uint32_t id, const std::int16_t*, double*);
};
const ExpressionTable kExpressions{
    kStatic, [](void*, std::int32_t bus, std::int16_t) { return bus == 0 ? std::int32_t{2} : std::int32_t{0}; },
    [](void*, std::int32_t bus, std::int16_t, std::int32_t index, ExpressionInfo* about) -> v3_result {
      if (bus != 0 || index < 0 || index > 1) return V3_INVALID_ARG;
      *about = {};
      about->id = index == 0 ? kTuning : kBrightness;
      write_text(index == 0 ? "Tuning" : "Brightness", about->title);
      write_text(index == 0 ? "Tune" : "Bright", about->short_title);
      if (index == 0) write_text("semitones", about->units);
      about->standard = 0.5;
      about->max = 1;
      about->parameter = std::numeric_limits<v3_param_id>::max();
      about->flags = kBipolar | (index == 0 ? 0 : kAbsolute);
      return V3_OK;
    },
    [](void*, std::int32_t, std::int16_t, std::uint32_t id, double value, v3_str_128 text) -> v3_result {
      const double shown = id == kTuning ? kTuning_semitones * (2 * value - 1) : 100 * value;
      write_text(ringdown::formatted("{:.2f}", shown), text);
      return V3_OK;
    },
    [](void*, std::int32_t, std::int16_t, std::uint32_t, const std::int16_t*, double*) -> v3_result {
      return V3_NOT_IMPLEMENTED;
    }};

// The host's events for DPF, with exact velocities. What DPF would drop goes to `sayings`.
struct EventTable : v3_funknown {
  v3_event_list list;
};
struct Events {
  const EventTable* table;
  v3_event_list** host;
  NoteSayings* sayings;
};

v3_result get_event(void* self, std::int32_t index, v3_event* event) {
  const Events& events = *static_cast<Events*>(self);
  const v3_result result = v3_cpp_obj(events.host)->get_event(static_cast<void*>(events.host), index, event);
  if (result != V3_OK) return result;
  const auto frame = static_cast<std::uint32_t>(std::max(0, event->sample_offset));
  if (event->type == V3_EVENT_NOTE_ON) {
    v3_event_note_on& note = event->note_on;
    if (note.velocity > 0) note.velocity = std::clamp(note.velocity + kHalfVelocity, 1.01F / 127, 1.0F);
    events.sayings->add({NoteSaying::Kind::begins, static_cast<std::uint8_t>(note.channel & 15),
                         static_cast<std::uint8_t>(note.pitch & 127), frame, note.note_id, 0});
  } else if (event->type == V3_EVENT_NOTE_EXP_VALUE) {
    const v3_event_note_expression_value& said = event->note_exp_value;
    const bool is_tuning = said.type_id == kTuning;
    if (!is_tuning && said.type_id != kBrightness) return result;
    const auto kind = is_tuning ? NoteSaying::Kind::tuning : NoteSaying::Kind::brightness;
    events.sayings->add({kind, 0, 0, frame, said.note_id, said.value});
  } else if (event->type == V3_EVENT_DATA) {
    if (event->data.type == kExclusive) {
      events.sayings->add({NoteSaying::Kind::exclusive, 0, 0, frame, -1, 0, {event->data.bytes, event->data.size}});
    }
    event->type = V3_EVENT_NOTE_EXP_VALUE;  // which DPF drops; of data it would make a message of undefined bytes
  }
  return result;
}

const EventTable kEventTable{kStatic,
                             {[](void* self) {
                                v3_event_list** const host = static_cast<Events*>(self)->host;
                                return v3_cpp_obj(host)->get_event_count(static_cast<void*>(host));
                              },
                              get_event, [](void*, v3_event*) -> v3_result { return V3_NOT_IMPLEMENTED; }}};

v3_result process(void* self, v3_process_data* block) {
  if (!block || !block->input_events) return dpf_processor.process(self, block);
  NoteSayings sayings;
  Events events{&kEventTable, block->input_events, &sayings};
  v3_process_data filtered = *block;
  filtered.input_events = reinterpret_cast<v3_event_list**>(&events);
  sayings_of_block() = &sayings;
  const v3_result result = dpf_processor.process(self, &filtered);
  sayings_of_block() = nullptr;
  return result;
}

// Parameters

// DPF counts the MIDI controllers as parameters, before ours. Returns a number that is not a parameter's for those.
std::size_t parameter_of(void* controller, std::uint32_t id) {
  const auto controllers = static_cast<std::uint32_t>(dpf_controller.get_parameter_count(controller)) - kParameters;
  return id < controllers ? kParameters : id - controllers;
}

v3_result get_parameter_info(void* self, std::int32_t index, v3_param_info* about) {
  const v3_result result = dpf_controller.get_parameter_info(self, index, about);
  const std::size_t parameter = parameter_of(self, static_cast<std::uint32_t>(index));
  if (result != V3_OK || parameter >= kParameters) return result;
  const ParameterInfo& info = kParameterInfo[parameter];
  about->unit_id = unit_of(info.group);
  if (info.scale == Scale::choice) about->step_count = static_cast<std::int32_t>(info.max - info.min);
  return result;
}

v3_result get_text(void* self, v3_param_id id, double normalised, v3_str_128 text) {
  const std::size_t parameter = parameter_of(self, id);
  if (parameter >= kParameters) return dpf_controller.get_parameter_string_for_value(self, id, normalised, text);
  if (!(normalised >= 0 && normalised <= 1)) return V3_INVALID_ARG;
  write_text(number_of(parameter, dpf_controller.normalised_parameter_to_plain(self, id, normalised)), text);
  return V3_OK;
}

v3_result get_value(void* self, v3_param_id id, std::int16_t* text, double* normalised) {
  const std::size_t parameter = parameter_of(self, id);
  if (parameter >= kParameters) return dpf_controller.get_parameter_value_for_string(self, id, text, normalised);
  const auto value = value_of(parameter, read_text(text));
  if (!value) return V3_INVALID_ARG;
  *normalised = dpf_controller.plain_parameter_to_normalised(self, id, *value);
  return V3_OK;
}

// Windows

// DPF disconnects a window before it closes it, so a key that the mouse holds there must be released before.
v3_result close_view(void* self) {
  if (let_go_of_keys()) let_go_of_keys()();
  return dpf_view.removed(self);
}

v3_plugin_view** create_view(void* self, const char* name) {
  v3_plugin_view** const made = dpf_controller.create_view(self, name);
  if (!made) return made;
  v3_plugin_view& view = (*reinterpret_cast<v3_plugin_view_cpp**>(made))->view;
  if (view.removed != close_view) dpf_view = view;
  view.removed = close_view;
  return made;
}

// Objects

// Finds the interfaces that DPF does not have.
bool find_ours(const v3_tuid id, void** object) {
  static const Units* const units = &kUnits;
  static const ExpressionTable* const expressions = &kExpressions;
  if (v3_tuid_match(id, v3_unit_information_iid)) {
    *object = static_cast<void*>(const_cast<const Units**>(&units));
  } else if (v3_tuid_match(id, kNoteExpressionController)) {
    *object = static_cast<void*>(const_cast<const ExpressionTable**>(&expressions));
  } else {
    return false;
  }
  return true;
}

v3_result query_controller(void* self, const v3_tuid id, void** object) {
  return find_ours(id, object) ? V3_OK : dpf_controller_object.query_interface(self, id, object);
}

v3_result query_component(void* self, const v3_tuid id, void** object) {
  const v3_result result = dpf_component.query_interface(self, id, object);
  if (result != V3_OK) return result;
  if (v3_tuid_match(id, v3_edit_controller_iid)) {
    v3_edit_controller_cpp& controller = **static_cast<v3_edit_controller_cpp**>(*object);
    if (controller.query_interface == query_controller) return result;
    dpf_controller_object = controller;
    dpf_controller = controller.ctrl;
    controller.query_interface = query_controller;
    controller.ctrl.create_view = create_view;
    controller.ctrl.get_parameter_info = get_parameter_info;
    controller.ctrl.get_parameter_string_for_value = get_text;
    controller.ctrl.get_parameter_value_for_string = get_value;
  } else if (v3_tuid_match(id, v3_audio_processor_iid)) {
    v3_audio_processor_cpp& processor = **static_cast<v3_audio_processor_cpp**>(*object);
    if (processor.proc.process == process) return result;
    dpf_processor = processor.proc;
    processor.proc.process = process;
    processor.proc.get_tail_samples = [](void*) { return kUnlimitedTail; };
  }
  return result;
}

v3_result create(void* self, const v3_tuid type, const v3_tuid id, void** object) {
  const v3_result result = dpf_factory.create_instance(self, type, id, object);
  if (result != V3_OK || !v3_tuid_match(id, v3_component_iid)) return result;
  v3_funknown& component = **static_cast<v3_component_cpp**>(*object);
  if (component.query_interface != query_component) dpf_component = component;
  component.query_interface = query_component;
  return result;
}

}  // namespace

const void* GetPluginFactory() {
  const void* const factory = dpf_GetPluginFactory();
  v3_plugin_factory_cpp& functions = **static_cast<v3_plugin_factory_cpp* const*>(factory);
  dpf_factory = functions.v1;
  functions.v1.create_instance = create;
  return factory;
}
