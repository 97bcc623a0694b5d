#include "clap/entry.h"
#include "clap/ext/gui.h"
#include "clap/ext/params.h"
#include "clap/ext/state.h"
#include "clap/ext/timer-support.h"
#include "clap/plugin-factory.h"
#include "tests/plugin/host.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace ringdown::test {
namespace {

constexpr const char* kPath = RINGDOWN_LIB_DIR "/clap/ringdown.clap";

constexpr clap_id kTimer = 1;

const void* host_extension(const clap_host_t*, const char* id) {
  static const clap_host_gui_t window{[](const clap_host_t*) {},
                                      [](const clap_host_t*, std::uint32_t, std::uint32_t) { return false; },
                                      [](const clap_host_t*) { return false; },
                                      [](const clap_host_t*) { return false; }, [](const clap_host_t*, bool) {}};
  static const clap_host_timer_support_t timer{[](const clap_host_t*, std::uint32_t, clap_id* id_of) {
                                                 *id_of = kTimer;
                                                 return true;
                                               },
                                               [](const clap_host_t*, clap_id) { return true; }};
  if (std::strcmp(id, CLAP_EXT_GUI) == 0) return &window;
  return std::strcmp(id, CLAP_EXT_TIMER_SUPPORT) == 0 ? &timer : nullptr;
}

const clap_host_t kHost = {CLAP_VERSION,
                           nullptr,
                           "test",
                           "Ringdown",
                           "",
                           "1",
                           host_extension,
                           [](const clap_host_t*) {},
                           [](const clap_host_t*) {},
                           [](const clap_host_t*) {}};

const clap_plugin_factory_t& factory() {
  static const clap_plugin_factory_t& opened = []() -> const clap_plugin_factory_t& {
    const Module module(kPath);
    const auto* entry = static_cast<const clap_plugin_entry_t*>(module.symbol("clap_entry"));
    if (!entry->init(kPath)) throw std::runtime_error("clap_entry.init failed");
    return *static_cast<const clap_plugin_factory_t*>(entry->get_factory(CLAP_PLUGIN_FACTORY_ID));
  }();
  return opened;
}

// Events of one block.
struct EventList {
  union Event {
    clap_event_header_t header;
    clap_event_param_value_t value;
    clap_event_midi_t midi;
    clap_event_midi_sysex_t exclusive;
    clap_event_note_expression_t expression;
    clap_event_param_mod_t modulation;
  };
  std::vector<Event> events;
  clap_input_events_t list{this,
                           [](const clap_input_events_t* self) {
                             return static_cast<std::uint32_t>(static_cast<EventList*>(self->ctx)->events.size());
                           },
                           [](const clap_input_events_t* self, std::uint32_t index) -> const clap_event_header_t* {
                             return &static_cast<EventList*>(self->ctx)->events[index].header;
                           }};
};

class ClapHost : public PluginHost {
 public:
  ClapHost() : plugin_(factory().create_plugin(&factory(), &kHost, "ringdown.instrument")) {
    if (!plugin_ || !plugin_->init(plugin_)) throw std::runtime_error("the CLAP plug-in does not start");
    params_ = static_cast<const clap_plugin_params_t*>(plugin_->get_extension(plugin_, CLAP_EXT_PARAMS));
    state_ = static_cast<const clap_plugin_state_t*>(plugin_->get_extension(plugin_, CLAP_EXT_STATE));
  }
  ~ClapHost() override {
    deactivate();
    plugin_->destroy(plugin_);
  }
  void activate(double sample_rate_hz) override {
    deactivate();
    active_ = plugin_->activate(plugin_, sample_rate_hz, 1, kMaxBlock) && plugin_->start_processing(plugin_);
  }
  void deactivate() override {
    if (!active_) return;
    plugin_->stop_processing(plugin_);
    plugin_->deactivate(plugin_);
    active_ = false;
  }
  void set_parameter(std::size_t number, double value) override {
    EventList::Event event{};
    event.value = {{sizeof event.value, 0, CLAP_CORE_EVENT_SPACE_ID, CLAP_EVENT_PARAM_VALUE, 0},
                   static_cast<clap_id>(number),
                   nullptr,
                   -1,
                   -1,
                   -1,
                   -1,
                   value};
    events_.events.push_back(event);
    if (active_) return;
    params_->flush(plugin_, &events_.list, &ignored_);
    events_.events.clear();
  }
  void express(int expression, int key, double value) {
    EventList::Event event{};
    event.expression = {{sizeof event.expression, 0, CLAP_CORE_EVENT_SPACE_ID, CLAP_EVENT_NOTE_EXPRESSION, 0},
                        expression,
                        -1,
                        0,
                        0,
                        static_cast<std::int16_t>(key),
                        value};
    events_.events.push_back(event);
  }
  void modulate(std::size_t number, double amount) {
    EventList::Event event{};
    event.modulation = {{sizeof event.modulation, 0, CLAP_CORE_EVENT_SPACE_ID, CLAP_EVENT_PARAM_MOD, 0},
                        static_cast<clap_id>(number),
                        nullptr,
                        -1,
                        -1,
                        -1,
                        -1,
                        amount};
    events_.events.push_back(event);
  }
  double parameter(std::size_t number) override {
    double value = 0;
    params_->get_value(plugin_, static_cast<clap_id>(number), &value);
    return value;
  }
  std::size_t parameters() override { return params_->count(plugin_); }
  void render(const std::vector<MidiEvent>& events, float* left, float* right, std::uint32_t frames) override {
    for (const MidiEvent& midi : events) {
      EventList::Event event{};
      if (midi.exclusive.empty()) {
        event.midi = {{sizeof event.midi, midi.frame, CLAP_CORE_EVENT_SPACE_ID, CLAP_EVENT_MIDI, 0}, 0, {}};
        std::copy(midi.bytes.begin(), midi.bytes.end(), event.midi.data);
      } else {
        event.exclusive = {{sizeof event.exclusive, midi.frame, CLAP_CORE_EVENT_SPACE_ID, CLAP_EVENT_MIDI_SYSEX, 0},
                           0,
                           midi.exclusive.data(),
                           static_cast<std::uint32_t>(midi.exclusive.size())};
      }
      events_.events.push_back(event);
    }
    float* channels[2] = {left, right};
    clap_audio_buffer_t output{channels, nullptr, 2, 0, 0};
    const clap_process_t block{-1, frames, nullptr, nullptr, &output, 0, 1, &events_.list, &ignored_};
    if (plugin_->process(plugin_, &block) == CLAP_PROCESS_ERROR) throw std::runtime_error("process failed");
    events_.events.clear();
  }
  std::string save() override {
    std::string state;
    const clap_ostream_t stream{&state, [](const clap_ostream_t* self, const void* bytes, std::uint64_t size) {
                                  static_cast<std::string*>(self->ctx)->append(static_cast<const char*>(bytes), size);
                                  return static_cast<std::int64_t>(size);
                                }};
    if (!state_->save(plugin_, &stream)) throw std::runtime_error("save failed");
    return state;
  }
  bool load(const std::string& state) override {
    std::string_view rest = state;
    const clap_istream_t stream{&rest, [](const clap_istream_t* self, void* bytes, std::uint64_t size) {
                                  auto& left = *static_cast<std::string_view*>(self->ctx);
                                  const std::size_t count = std::min<std::size_t>({size, left.size(), 333});
                                  std::memcpy(bytes, left.data(), count);
                                  left.remove_prefix(count);
                                  return static_cast<std::int64_t>(count);
                                }};
    return state_->load(plugin_, &stream);
  }
  bool open_window(unsigned long parent) override {
    gui_ = static_cast<const clap_plugin_gui_t*>(plugin_->get_extension(plugin_, CLAP_EXT_GUI));
    timer_ = static_cast<const clap_plugin_timer_support_t*>(plugin_->get_extension(plugin_, CLAP_EXT_TIMER_SUPPORT));
    clap_window_t window{CLAP_WINDOW_API_X11, {}};
    window.x11 = parent;
    return gui_ && timer_ && gui_->create(plugin_, CLAP_WINDOW_API_X11, false) && gui_->set_parent(plugin_, &window) &&
           gui_->show(plugin_);
  }
  void idle_window() override { timer_->on_timer(plugin_, kTimer); }
  void close_window() override { gui_->destroy(plugin_); }

 private:
  const clap_plugin_t* plugin_;
  const clap_plugin_params_t* params_ = nullptr;
  const clap_plugin_state_t* state_ = nullptr;
  const clap_plugin_gui_t* gui_ = nullptr;
  const clap_plugin_timer_support_t* timer_ = nullptr;
  clap_output_events_t ignored_{nullptr, [](const clap_output_events_t*, const clap_event_header_t*) { return true; }};
  EventList events_;
  bool active_ = false;
};

}  // namespace

Module::Module(const std::string& path) : handle_(dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) {
  if (!handle_) throw std::runtime_error(dlerror());
}

void* Module::symbol(const char* name) const {
  void* const found = dlsym(handle_, name);
  if (!found) throw std::runtime_error(std::string("there is no ") + name);
  return found;
}

void express(PluginHost& host, int expression, int key, double value) {
  dynamic_cast<ClapHost&>(host).express(expression, key, value);
}
void modulate(PluginHost& host, std::size_t number, double amount) {
  dynamic_cast<ClapHost&>(host).modulate(number, amount);
}

std::unique_ptr<PluginHost> open_clap() { return std::make_unique<ClapHost>(); }

}  // namespace ringdown::test
