#include "tests/plugin/host.h"
#include "travesty/audio_processor.h"
#include "travesty/component.h"
#include "travesty/edit_controller.h"
#include "travesty/factory.h"
#include "travesty/host.h"
#include "travesty/view.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string_view>

namespace ringdown::test {
namespace {

const std::string kPath = RINGDOWN_LIB_DIR "/vst3/ringdown.vst3/Contents/" RINGDOWN_VST3_FOLDER "/ringdown.so";
constexpr int kBend = 129, kChannelPressure = 128;  // as controllers
constexpr std::int32_t kFirstNote = 1000;           // number of the note of key 0

v3_result no_interface(void*, const v3_tuid, void**) { return V3_NO_INTERFACE; }
std::uint32_t one(void*) { return 1; }
const v3_funknown kUnknown{no_interface, one, one};

// Interfaces of VST3 are pointers to a table of functions; each gets a pointer to that pointer. These are what a
// plug-in asks its host: the events, parameter changes and stream of a call.
template <class Table, class Content>
struct Object {
  const Table* table;
  Content content;
  static Content& of(void* self) { return static_cast<Object*>(self)->content; }
  template <class Interface>
  Interface** as() {
    return reinterpret_cast<Interface**>(this);
  }
};

struct EventTable : v3_funknown {
  v3_event_list list;
};
using Events = Object<EventTable, std::vector<v3_event>>;
const EventTable kEventTable{kUnknown,
                             {[](void* self) { return static_cast<std::uint32_t>(Events::of(self).size()); },
                              [](void* self, std::int32_t index, v3_event* event) -> v3_result {
                                *event = Events::of(self)[static_cast<std::size_t>(index)];
                                return V3_OK;
                              },
                              [](void*, v3_event*) -> v3_result { return V3_OK; }}};

struct Change {
  v3_param_id id;
  std::int32_t frame;
  double value;
};
struct QueueTable : v3_funknown {
  v3_param_value_queue queue;
};
using Queue = Object<QueueTable, Change>;
const QueueTable kQueueTable{kUnknown,
                             {[](void* self) { return Queue::of(self).id; }, [](void*) { return std::int32_t{1}; },
                              [](void* self, std::int32_t, std::int32_t* frame, double* value) -> v3_result {
                                *frame = Queue::of(self).frame;
                                *value = Queue::of(self).value;
                                return V3_OK;
                              },
                              [](void*, std::int32_t, double, std::int32_t*) -> v3_result { return V3_OK; }}};

struct ChangesTable : v3_funknown {
  v3_param_changes changes;
};
using Changes = Object<ChangesTable, std::vector<Queue>>;
const ChangesTable kChangesTable{
    kUnknown,
    {[](void* self) { return static_cast<std::int32_t>(Changes::of(self).size()); },
     [](void* self, std::int32_t index) {
       return Changes::of(self)[static_cast<std::size_t>(index)].as<v3_param_value_queue>();
     },
     [](void*, v3_param_id*, std::int32_t*) {  // what the plug-in reports is not looked at
       static Queue ignored{&kQueueTable, {}};
       return ignored.as<v3_param_value_queue>();
     }}};

struct StreamTable : v3_funknown {
  v3_bstream stream;
};
struct Bytes {
  std::string text;
  std::size_t at = 0;
};
using Stream = Object<StreamTable, Bytes>;
const StreamTable kStreamTable{
    kUnknown,
    {[](void* self, void* bytes, std::int32_t size, std::int32_t* done) -> v3_result {
       Bytes& from = Stream::of(self);
       const std::size_t count = std::min(static_cast<std::size_t>(size), from.text.size() - from.at);
       std::memcpy(bytes, from.text.data() + from.at, count);
       from.at += count;
       *done = static_cast<std::int32_t>(count);
       return V3_OK;
     },
     [](void* self, void* bytes, std::int32_t size, std::int32_t* done) -> v3_result {
       Stream::of(self).text.append(static_cast<const char*>(bytes), static_cast<std::size_t>(size));
       if (done) *done = size;
       return V3_OK;
     },
     [](void*, std::int64_t, std::int32_t, std::int64_t*) -> v3_result { return V3_NOT_IMPLEMENTED; },
     [](void*, std::int64_t*) -> v3_result { return V3_NOT_IMPLEMENTED; }}};

// A message between a plug-in and its window: a name, and values by name.
struct Letter {
  std::string name;
  std::map<std::string, std::int64_t> integers;
  std::map<std::string, double> numbers;
  std::map<std::string, std::string> bytes;
};
struct AttributesTable : v3_funknown {
  v3_attribute_list list;
};
struct LetterTable : v3_funknown {
  v3_message message;
};
struct Message {
  const LetterTable* table;
  Object<AttributesTable, Letter> attributes;
  std::uint32_t uses = 1;
  static Message& of(void* self) { return *static_cast<Message*>(self); }
};
using Attributes = Object<AttributesTable, Letter>;
template <class Map, class Value>
v3_result find(const Map& map, const char* id, Value* value) {
  const auto found = map.find(id);
  if (found == map.end()) return V3_INVALID_ARG;
  *value = found->second;
  return V3_OK;
}
std::size_t bytes_of(const std::int16_t* text) {
  std::size_t length = 0;
  while (text[length] != 0) ++length;
  return 2 * (length + 1);
}
const AttributesTable kAttributesTable{
    kUnknown,
    {[](void* self, const char* id, std::int64_t value) -> v3_result {
       Attributes::of(self).integers[id] = value;
       return V3_OK;
     },
     [](void* self, const char* id, std::int64_t* value) { return find(Attributes::of(self).integers, id, value); },
     [](void* self, const char* id, double value) -> v3_result {
       Attributes::of(self).numbers[id] = value;
       return V3_OK;
     },
     [](void* self, const char* id, double* value) { return find(Attributes::of(self).numbers, id, value); },
     [](void* self, const char* id, const std::int16_t* text) -> v3_result {
       Attributes::of(self).bytes[id] = {reinterpret_cast<const char*>(text), bytes_of(text)};
       return V3_OK;
     },
     [](void* self, const char* id, std::int16_t* text, std::uint32_t size) -> v3_result {
       const std::string& bytes = Attributes::of(self).bytes[id];
       std::memcpy(text, bytes.data(), std::min<std::size_t>(size, bytes.size()));
       return V3_OK;
     },
     [](void* self, const char* id, const void* data, std::uint32_t size) -> v3_result {
       Attributes::of(self).bytes[id] = {static_cast<const char*>(data), size};
       return V3_OK;
     },
     [](void* self, const char* id, const void** data, std::uint32_t* size) -> v3_result {
       const std::string& bytes = Attributes::of(self).bytes[id];
       *data = bytes.data();
       *size = static_cast<std::uint32_t>(bytes.size());
       return V3_OK;
     }}};
const LetterTable kLetterTable{{no_interface, [](void* self) { return ++Message::of(self).uses; },
                                [](void* self) -> std::uint32_t {
                                  const std::uint32_t left = --Message::of(self).uses;
                                  if (left == 0) delete static_cast<Message*>(self);
                                  return left;
                                }},
                               {[](void* self) { return Message::of(self).attributes.content.name.c_str(); },
                                [](void* self, const char* name) { Message::of(self).attributes.content.name = name; },
                                [](void* self) { return Message::of(self).attributes.as<v3_attribute_list>(); }}};

// The host itself, which makes messages.
struct HostTable : v3_funknown {
  v3_host_application application;
};
using Host = Object<HostTable, int>;
const HostTable kHostTable{{[](void* self, const v3_tuid id, void** object) -> v3_result {
                              if (!v3_tuid_match(id, v3_host_application_iid)) return V3_NO_INTERFACE;
                              *object = self;
                              return V3_OK;
                            },
                            one, one},
                           {[](void*, v3_str_128) -> v3_result { return V3_NOT_IMPLEMENTED; },
                            [](void*, v3_tuid, v3_tuid, void** object) -> v3_result {
                              *object = new Message{&kLetterTable, {&kAttributesTable, {}}};
                              return V3_OK;
                            }}};
Host host{&kHostTable, 0};

// What a host does with edits of a window; the plug-in has them itself.
struct HandlerTable : v3_funknown {
  v3_component_handler handler;
};
const HandlerTable kHandlerTable{
    kUnknown,
    {[](void*, v3_param_id) -> v3_result { return V3_OK; },
     [](void*, v3_param_id, double) -> v3_result { return V3_OK; },
     [](void*, v3_param_id) -> v3_result { return V3_OK; }, [](void*, std::int32_t) -> v3_result { return V3_OK; }}};
Object<HandlerTable, int> handler{&kHandlerTable, 0};

// The frame of a window, whose run loop holds one timer.
struct LoopTable : v3_funknown {
  v3_run_loop loop;
};
using Loop = Object<LoopTable, v3_timer_handler**>;
const LoopTable kLoopTable{kUnknown,
                           {[](void*, v3_event_handler**, int) -> v3_result { return V3_OK; },
                            [](void*, v3_event_handler**) -> v3_result { return V3_OK; },
                            [](void* self, v3_timer_handler** timer, std::uint64_t) -> v3_result {
                              Loop::of(self) = timer;
                              return V3_OK;
                            },
                            [](void* self, v3_timer_handler**) -> v3_result {
                              Loop::of(self) = nullptr;
                              return V3_OK;
                            }}};
struct FrameTable : v3_funknown {
  v3_plugin_frame frame;
};
using Frame = Object<FrameTable, Loop>;
const FrameTable kFrameTable{{[](void* self, const v3_tuid id, void** object) -> v3_result {
                                if (!v3_tuid_match(id, v3_run_loop_iid)) return V3_NO_INTERFACE;
                                *object = &Frame::of(self);
                                return V3_OK;
                              },
                              one, one},
                             {[](void*, v3_plugin_view**, v3_view_rect*) -> v3_result { return V3_NOT_IMPLEMENTED; }}};

v3_plugin_factory** factory() {
  static v3_plugin_factory** const opened = [] {
    const Module module(kPath);
    if (!reinterpret_cast<bool (*)(void*)>(module.symbol("ModuleEntry"))(nullptr)) {
      throw std::runtime_error("ModuleEntry failed");
    }
    return reinterpret_cast<v3_plugin_factory** (*)()>(module.symbol("GetPluginFactory"))();
  }();
  return opened;
}

class Vst3Host : public PluginHost {
 public:
  Vst3Host() {
    v3_class_info info{};
    v3_cpp_obj(factory())->get_class_info(factory(), 0, &info);
    void* made = nullptr;
    if (v3_cpp_obj(factory())->create_instance(factory(), info.class_id, v3_component_iid, &made) != V3_OK) {
      throw std::runtime_error("the VST3 plug-in does not start");
    }
    component_ = static_cast<v3_component**>(made);
    v3_cpp_obj_initialize(component_, host.as<v3_funknown>());
    v3_cpp_obj_query_interface(component_, v3_audio_processor_iid, &processor_);
    v3_cpp_obj_query_interface(component_, v3_edit_controller_iid, &controller_);
    v3_cpp_obj_query_interface(component_, v3_midi_mapping_iid, &mapping_);
    if (!processor_ || !controller_ || !mapping_) throw std::runtime_error("the VST3 plug-in lacks an interface");
    v3_cpp_obj_initialize(controller_, host.as<v3_funknown>());
    v3_cpp_obj(controller_)->set_component_handler(controller_, handler.as<v3_component_handler>());
    find_parameters();
  }
  ~Vst3Host() override {
    deactivate();
    v3_cpp_obj_unref(processor_);
    v3_cpp_obj_terminate(controller_);
    v3_cpp_obj_unref(controller_);
    v3_cpp_obj_terminate(component_);
    v3_cpp_obj_unref(component_);
  }
  void activate(double sample_rate_hz) override {
    deactivate();
    start(sample_rate_hz);
    if (changes_.content.empty()) return;
    // A plug-in gets parameters with a block only. It starts anew with them, so that it has loaded what they ask for.
    std::array<float, 16> left{}, right{};
    render({}, left.data(), right.data(), 16);
    deactivate();
    start(sample_rate_hz);
  }
  void deactivate() override {
    if (!active_) return;
    v3_cpp_obj(processor_)->set_processing(processor_, false);
    v3_cpp_obj(component_)->set_active(component_, false);
    active_ = false;
  }
  void set_parameter(std::size_t number, double value) override {
    const v3_param_id id = ids_.at(number);
    const double normal = v3_cpp_obj(controller_)->plain_parameter_to_normalised(controller_, id, value);
    v3_cpp_obj(controller_)->set_parameter_normalised(controller_, id, normal);
    changes_.content.push_back({&kQueueTable, {id, 0, normal}});
  }
  double parameter(std::size_t number) override {
    const v3_param_id id = ids_.at(number);
    const double normal = v3_cpp_obj(controller_)->get_parameter_normalised(controller_, id);
    return v3_cpp_obj(controller_)->normalised_parameter_to_plain(controller_, id, normal);
  }
  void express(int expression, int key, double value) {
    v3_event event{};
    event.type = V3_EVENT_NOTE_EXP_VALUE;
    event.note_exp_value = {static_cast<std::uint32_t>(expression), kFirstNote + key, value};
    events_.content.push_back(event);
  }
  std::size_t parameters() override { return ids_.size(); }
  void render(const std::vector<MidiEvent>& events, float* left, float* right, std::uint32_t frames) override {
    for (const MidiEvent& midi : events) add(midi);
    float* channels[2] = {left, right};
    v3_audio_bus_buffers output{2, 0, {channels}};
    v3_process_data block{};
    block.nframes = static_cast<std::int32_t>(frames);
    block.num_output_buses = 1;
    block.outputs = &output;
    block.input_events = events_.as<v3_event_list>();
    block.input_params = changes_.as<v3_param_changes>();
    block.output_params = reported_.as<v3_param_changes>();
    if (v3_cpp_obj(processor_)->process(processor_, &block) != V3_OK) throw std::runtime_error("process failed");
    events_.content.clear();
    changes_.content.clear();
  }
  std::string save() override {
    Stream stream{&kStreamTable, {}};
    if (v3_cpp_obj(component_)->get_state(component_, stream.as<v3_bstream>()) != V3_OK) {
      throw std::runtime_error("get_state failed");
    }
    return stream.content.text;
  }
  bool load(const std::string& state) override {
    Stream stream{&kStreamTable, {state, 0}};
    return v3_cpp_obj(component_)->set_state(component_, stream.as<v3_bstream>()) == V3_OK;
  }
  bool open_window(unsigned long parent) override {
    view_ = v3_cpp_obj(controller_)->create_view(controller_, "editor");
    if (!view_) return false;
    v3_cpp_obj(view_)->set_frame(view_, frame_.as<v3_plugin_frame>());
    return v3_cpp_obj(view_)->attached(view_, reinterpret_cast<void*>(parent), V3_VIEW_PLATFORM_TYPE_X11) == V3_OK;
  }
  void idle_window() override {
    v3_timer_handler** const timer = frame_.content.content;
    v3_cpp_obj(timer)->on_timer(timer);
  }
  void close_window() override {
    v3_cpp_obj(view_)->removed(view_);
    v3_cpp_obj(view_)->set_frame(view_, nullptr);
    v3_cpp_obj_unref(view_);
    view_ = nullptr;
  }

 private:
  void start(double sample_rate_hz) {
    v3_process_setup setup{V3_REALTIME, V3_SAMPLE_32, static_cast<std::int32_t>(kMaxBlock), sample_rate_hz};
    v3_cpp_obj(processor_)->setup_processing(processor_, &setup);
    v3_cpp_obj(component_)->activate_bus(component_, V3_AUDIO, V3_OUTPUT, 0, true);
    v3_cpp_obj(component_)->activate_bus(component_, V3_EVENT, V3_INPUT, 0, true);
    v3_cpp_obj(component_)->set_active(component_, true);
    v3_cpp_obj(processor_)->set_processing(processor_, true);
    active_ = true;
  }
  // The parameters that are not controllers of MIDI, in their order.
  void find_parameters() {
    const std::int32_t count = v3_cpp_obj(controller_)->get_parameter_count(controller_);
    for (std::int32_t i = 0; i < count; ++i) {
      v3_param_info info{};
      if (v3_cpp_obj(controller_)->get_parameter_info(controller_, i, &info) != V3_OK) continue;
      const std::u16string_view title(reinterpret_cast<const char16_t*>(info.title));
      if (!title.starts_with(u"MIDI")) ids_.push_back(info.param_id);
    }
  }
  // Notes are events; controllers reach a plug-in as parameters, which it names itself.
  void add(const MidiEvent& midi) {
    const int kind = midi.bytes[0] & 0xf0;
    const auto channel = static_cast<std::int16_t>(midi.bytes[0] & 0x0f);
    const auto frame = static_cast<std::int32_t>(midi.frame);
    v3_event event{};
    event.sample_offset = frame;
    if (!midi.exclusive.empty()) {
      event.type = V3_EVENT_DATA;
      event.data = {static_cast<std::uint32_t>(midi.exclusive.size()), 0, midi.exclusive.data()};
    } else if (kind == 0x90) {
      event.type = V3_EVENT_NOTE_ON;
      event.note_on = {
          channel, midi.bytes[1], 0, static_cast<float>(midi.bytes[2]) / 127, 0, kFirstNote + midi.bytes[1]};
    } else if (kind == 0x80) {
      event.type = V3_EVENT_NOTE_OFF;
      event.note_off = {channel, midi.bytes[1], 0, -1, 0};
    } else {
      const int value =
          kind == 0xe0 ? midi.bytes[1] + 128 * midi.bytes[2] : (kind == 0xd0 ? midi.bytes[1] : midi.bytes[2]);
      const int controller = kind == 0xe0 ? kBend : (kind == 0xd0 ? kChannelPressure : midi.bytes[1]);
      v3_param_id id = 0;
      v3_cpp_obj(mapping_)->get_midi_controller_assignment(mapping_, 0, channel, static_cast<std::int16_t>(controller),
                                                           &id);
      changes_.content.push_back({&kQueueTable, {id, frame, value / (kind == 0xe0 ? 16384.0 : 126.9)}});
      return;
    }
    events_.content.push_back(event);
  }

  v3_component** component_ = nullptr;
  v3_audio_processor** processor_ = nullptr;
  v3_edit_controller** controller_ = nullptr;
  v3_midi_mapping** mapping_ = nullptr;
  v3_plugin_view** view_ = nullptr;
  Frame frame_{&kFrameTable, {&kLoopTable, nullptr}};
  std::vector<v3_param_id> ids_;
  Events events_{&kEventTable, {}};
  Changes changes_{&kChangesTable, {}}, reported_{&kChangesTable, {}};
  bool active_ = false;
};

}  // namespace

void express_vst3(PluginHost& host, int expression, int key, double value) {
  dynamic_cast<Vst3Host&>(host).express(expression, key, value);
}

std::unique_ptr<PluginHost> open_vst3() { return std::make_unique<Vst3Host>(); }

}  // namespace ringdown::test
