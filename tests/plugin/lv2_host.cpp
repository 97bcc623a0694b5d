#include "lv2/atom/util.h"
#include "lv2/buf-size/buf-size.h"
#include "lv2/core/lv2.h"
#include "lv2/midi/midi.h"
#include "lv2/options/options.h"
#include "lv2/parameters/parameters.h"
#include "lv2/state/state.h"
#include "lv2/ui/ui.h"
#include "lv2/urid/urid.h"
#include "lv2/worker/worker.h"
#include "tests/plugin/host.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <span>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace ringdown::test {
namespace {

const std::string kBundle = RINGDOWN_LIB_DIR "/lv2/ringdown.lv2/";
constexpr std::uint32_t kEventsIn = 2, kEventsOut = 3;
constexpr std::size_t kParameters = 21, kFirstControl = 4;  // ports: left, right, events in, events out, parameters

constexpr const char* kPlugin = "urn:ringdown:instrument";

// URIs as numbers, for the whole program.
std::map<std::string, LV2_URID>& numbers() {
  static std::map<std::string, LV2_URID> all;
  return all;
}
LV2_URID number_of(const std::string& uri) {
  return numbers().try_emplace(uri, static_cast<LV2_URID>(numbers().size() + 1)).first->second;
}
const char* uri_of(LV2_URID number) {
  for (const auto& [uri, its_number] : numbers()) {
    if (its_number == number) return uri.c_str();
  }
  return nullptr;
}

class Lv2Host : public PluginHost {
 public:
  Lv2Host() { make(48000); }
  ~Lv2Host() override {
    deactivate();
    descriptor_->cleanup(plugin_);
  }
  // In LV2 the sample rate is the instance's, so a host makes a new one and gives it the old one's state.
  void activate(double sample_rate_hz) override {
    deactivate();
    if (sample_rate_hz != sample_rate_hz_) {
      const std::string state = save();
      descriptor_->cleanup(plugin_);
      make(sample_rate_hz);
      load(state);
    }
    // What changed before a plug-in runs has reached its ports by now, but plug-ins read ports in run() only.
    descriptor_->run(plugin_, 0);
    descriptor_->activate(plugin_);
    active_ = true;
  }
  void deactivate() override {
    if (active_) descriptor_->deactivate(plugin_);
    active_ = false;
  }
  void set_parameter(std::size_t number, double value) override { controls_[number] = static_cast<float>(value); }
  double parameter(std::size_t number) override { return static_cast<double>(controls_[number]); }
  std::size_t parameters() override { return kParameters; }
  void render(const std::vector<MidiEvent>& events, float* left, float* right, std::uint32_t frames) override {
    fill(events);
    descriptor_->connect_port(plugin_, 0, left);
    descriptor_->connect_port(plugin_, 1, right);
    descriptor_->run(plugin_, frames);
    for (const std::string& message : std::exchange(work_, {})) {
      const auto* interface =
          static_cast<const LV2_Worker_Interface*>(descriptor_->extension_data(LV2_WORKER__interface));
      const auto respond = [](LV2_Worker_Respond_Handle, std::uint32_t, const void*) { return LV2_WORKER_SUCCESS; };
      interface->work(plugin_, respond, nullptr, static_cast<std::uint32_t>(message.size()), message.data());
    }
    if (!window_) return;
    const auto* const out = reinterpret_cast<const LV2_Atom_Sequence*>(out_.data());
    LV2_ATOM_SEQUENCE_FOREACH(out, event) {
      const auto* const atom = reinterpret_cast<const char*>(&event->body);
      to_window_.emplace_back(atom, sizeof(LV2_Atom) + event->body.size);
    }
  }
  // Ports are saved by the host, the rest by the plug-in.
  std::string save() override {
    std::ostringstream state;
    for (const float control : std::span(controls_).subspan(1)) state << control << '\n';
    const auto store = [](LV2_State_Handle out, std::uint32_t key, const void* value, std::size_t size, std::uint32_t,
                          std::uint32_t) {
      *static_cast<std::ostringstream*>(out)
          << key << ' ' << std::string(static_cast<const char*>(value), size - 1) << '\n';
      return LV2_STATE_SUCCESS;
    };
    state_->save(plugin_, store, &state, 0, nullptr);
    return state.str();
  }
  bool load(const std::string& text) override {
    std::istringstream state(text);
    for (float& control : std::span(controls_).subspan(1)) state >> control;
    struct Saved {
      std::map<LV2_URID, std::string> values;
      std::uint32_t path, string;
    } saved{{}, number_of(LV2_ATOM__Path), number_of(LV2_ATOM__String)};
    for (LV2_URID key = 0; state >> key;) {
      std::string value;
      state.get();
      std::getline(state, value);
      saved.values[key] = value;
    }
    const auto retrieve = [](LV2_State_Handle in, std::uint32_t key, std::size_t* size, std::uint32_t* type,
                             std::uint32_t* flags) -> const void* {
      auto& all = *static_cast<Saved*>(in);
      const auto found = all.values.find(key);
      if (found == all.values.end()) return nullptr;
      const std::string plugin = "urn:ringdown:instrument#";
      const bool is_path = key == number_of(plugin + "file") || key == number_of(plugin + "scale_file") ||
                           key == number_of(plugin + "mapping_file");
      if (is_path && found->second.empty()) {
        found->second = "/session/state.ttl";  // as lilv does, which writes an empty path as <>
      }
      *size = found->second.size() + 1;
      *type = is_path ? all.path : all.string;
      *flags = LV2_STATE_IS_POD | LV2_STATE_IS_PORTABLE;
      return found->second.c_str();
    };
    return state_->restore(plugin_, retrieve, &saved, 0, nullptr) == LV2_STATE_SUCCESS;
  }
  bool open_window(unsigned long parent) override {
    if (!std::filesystem::exists(kBundle + "ringdown_ui.so")) return false;
    static const Module module(kBundle + "ringdown_ui.so");
    ui_ = reinterpret_cast<LV2UI_DescriptorFunction>(module.symbol("lv2ui_descriptor"))(0);
    const auto rate_hz = static_cast<float>(sample_rate_hz_);
    const LV2_Options_Option options[] = {{LV2_OPTIONS_INSTANCE, 0, number_of(LV2_PARAMETERS__sampleRate),
                                           sizeof rate_hz, number_of(LV2_ATOM__Float), &rate_hz},
                                          {LV2_OPTIONS_INSTANCE, 0, 0, 0, 0, nullptr}};
    const LV2_Feature map{LV2_URID__map, &map_}, unmap{LV2_URID__unmap, &unmap_},
        option{LV2_OPTIONS__options, const_cast<LV2_Options_Option*>(options)},
        inside{LV2_UI__parent, reinterpret_cast<void*>(parent)};
    const LV2_Feature* features[] = {&map, &unmap, &option, &inside, nullptr};
    const auto write = [](LV2UI_Controller self, std::uint32_t port, std::uint32_t size, std::uint32_t,
                          const void* value) { static_cast<Lv2Host*>(self)->take(port, size, value); };
    LV2UI_Widget widget = nullptr;
    window_ = ui_->instantiate(ui_, kPlugin, kBundle.c_str(), write, this, &widget, features);
    told_.fill(NAN);
    return window_ != nullptr;
  }
  void idle_window() override {
    for (std::uint32_t i = 0; i < kParameters; ++i) {
      if (told_[i] == controls_[i]) continue;
      told_[i] = controls_[i];
      ui_->port_event(window_, static_cast<std::uint32_t>(kFirstControl + i), sizeof(float), 0, &controls_[i]);
    }
    for (const std::string& atom : std::exchange(to_window_, {})) {
      ui_->port_event(window_, kEventsOut, static_cast<std::uint32_t>(atom.size()), number_of(LV2_ATOM__eventTransfer),
                      atom.data());
    }
    static_cast<const LV2UI_Idle_Interface*>(ui_->extension_data(LV2_UI__idleInterface))->idle(window_);
  }
  void close_window() override {
    ui_->cleanup(window_);
    window_ = nullptr;
  }

 private:
  void make(double sample_rate_hz) {
    static const Module module(kBundle + "ringdown.so");
    descriptor_ = reinterpret_cast<LV2_Descriptor_Function>(module.symbol("lv2_descriptor"))(0);
    sample_rate_hz_ = sample_rate_hz;
    map_ = {nullptr, [](LV2_URID_Map_Handle, const char* uri) { return number_of(uri); }};
    unmap_ = {nullptr, [](LV2_URID_Unmap_Handle, LV2_URID number) { return uri_of(number); }};
    worker_ = {this, [](LV2_Worker_Schedule_Handle self, std::uint32_t size, const void* data) {
                 static_cast<Lv2Host*>(self)->work_.emplace_back(static_cast<const char*>(data), size);
                 return LV2_WORKER_SUCCESS;
               }};
    const LV2_Options_Option options[] = {
        {LV2_OPTIONS_INSTANCE, 0, number_of(LV2_BUF_SIZE__maxBlockLength), sizeof kMaxBlock,
         number_of("http://lv2plug.in/ns/ext/atom#Int"), &kMaxBlock},
        {LV2_OPTIONS_INSTANCE, 0, 0, 0, 0, nullptr}};
    const LV2_Feature map{LV2_URID__map, &map_}, worker{LV2_WORKER__schedule, &worker_},
        option{LV2_OPTIONS__options, const_cast<LV2_Options_Option*>(options)};
    const LV2_Feature* features[] = {&map, &worker, &option, nullptr};
    plugin_ = descriptor_->instantiate(descriptor_, sample_rate_hz, kBundle.c_str(), features);
    if (!plugin_) throw std::runtime_error("the LV2 plug-in does not start");
    state_ = static_cast<const LV2_State_Interface*>(descriptor_->extension_data(LV2_STATE__interface));
    fill({});
    descriptor_->connect_port(plugin_, kEventsIn, events_.data());
    descriptor_->connect_port(plugin_, kEventsOut, out_.data());
    controls_ = {-120, 0, 0, 60, 1, 1, 1, 1, 0, 0.2F, 1, 0, 0, 50, 0.4F, 3, 2, 0, 0, 0};
    for (std::size_t i = 0; i < kParameters; ++i) {
      descriptor_->connect_port(plugin_, static_cast<std::uint32_t>(kFirstControl + i), &controls_[i]);
    }
  }
  // What the window writes to a port: a parameter, or an event for the next block.
  void take(std::uint32_t port, std::uint32_t size, const void* value) {
    if (port == kEventsIn) return void(from_window_.emplace_back(static_cast<const char*>(value), size));
    std::memcpy(&controls_[port - kFirstControl], value, size);
  }
  void fill(const std::vector<MidiEvent>& events) {
    auto* const in = reinterpret_cast<LV2_Atom_Sequence*>(events_.data());
    in->atom = {sizeof(LV2_Atom_Sequence_Body), number_of(LV2_ATOM__Sequence)};
    in->body = {0, 0};
    const auto capacity = static_cast<std::uint32_t>(8 * events_.size() - sizeof(LV2_Atom));
    for (const std::string& atom : std::exchange(from_window_, {})) {
      std::vector<std::uint64_t> event(2 + atom.size() / 8 + 1);  // its frame, 0, and the atom
      std::memcpy(event.data() + 1, atom.data(), atom.size());
      lv2_atom_sequence_append_event(in, capacity, reinterpret_cast<const LV2_Atom_Event*>(event.data()));
    }
    for (const MidiEvent& midi : events) {
      struct {
        LV2_Atom_Event event;
        std::array<std::uint8_t, 512> bytes;
      } whole{};
      const std::vector<std::uint8_t> bytes =
          midi.exclusive.empty() ? std::vector<std::uint8_t>(midi.bytes.begin(), midi.bytes.end()) : midi.exclusive;
      whole.event.time.frames = midi.frame;
      whole.event.body = {static_cast<std::uint32_t>(bytes.size()), number_of(LV2_MIDI__MidiEvent)};
      std::copy(bytes.begin(), bytes.end(), whole.bytes.begin());
      lv2_atom_sequence_append_event(in, capacity, &whole.event);
    }
    auto* const out = reinterpret_cast<LV2_Atom_Sequence*>(out_.data());
    out->atom = {static_cast<std::uint32_t>(8 * out_.size() - sizeof(LV2_Atom)), 0};
  }

  const LV2_Descriptor* descriptor_ = nullptr;
  LV2_Handle plugin_ = nullptr;
  const LV2_State_Interface* state_ = nullptr;
  LV2_URID_Map map_{};
  LV2_URID_Unmap unmap_{};
  LV2_Worker_Schedule worker_{};
  double sample_rate_hz_ = 0;
  std::array<float, kParameters> controls_{};
  std::vector<std::uint64_t> events_ = std::vector<std::uint64_t>(4096), out_ = std::vector<std::uint64_t>(1024);
  std::vector<std::string> work_, from_window_, to_window_;  // messages that wait, as atoms
  const LV2UI_Descriptor* ui_ = nullptr;
  LV2UI_Handle window_ = nullptr;
  std::array<float, kParameters> told_{};
  bool active_ = false;
};

}  // namespace

std::unique_ptr<PluginHost> open_lv2() { return std::make_unique<Lv2Host>(); }

}  // namespace ringdown::test
