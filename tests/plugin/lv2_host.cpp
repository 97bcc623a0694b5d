#include "lv2/atom/util.h"
#include "lv2/buf-size/buf-size.h"
#include "lv2/core/lv2.h"
#include "lv2/midi/midi.h"
#include "lv2/options/options.h"
#include "lv2/state/state.h"
#include "lv2/urid/urid.h"
#include "lv2/worker/worker.h"
#include "tests/plugin/host.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <span>
#include <sstream>
#include <stdexcept>

namespace ringdown::test {
namespace {

const std::string kBundle = RINGDOWN_LIB_DIR "/lv2/ringdown.lv2/";
constexpr std::size_t kParameters = 20, kFirstControl = 4;  // ports: left, right, events in, events out, parameters

// URIs as numbers, for the whole program.
LV2_URID number_of(const std::string& uri) {
  static std::map<std::string, LV2_URID> numbers;
  return numbers.try_emplace(uri, static_cast<LV2_URID>(numbers.size() + 1)).first->second;
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

 private:
  void make(double sample_rate_hz) {
    static const Module module(kBundle + "ringdown.so");
    descriptor_ = reinterpret_cast<LV2_Descriptor_Function>(module.symbol("lv2_descriptor"))(0);
    sample_rate_hz_ = sample_rate_hz;
    map_ = {nullptr, [](LV2_URID_Map_Handle, const char* uri) { return number_of(uri); }};
    worker_ = {nullptr, [](LV2_Worker_Schedule_Handle, std::uint32_t, const void*) { return LV2_WORKER_SUCCESS; }};
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
    descriptor_->connect_port(plugin_, 2, events_.data());
    descriptor_->connect_port(plugin_, 3, out_.data());
    controls_ = {-120, 0, 0, 60, 1, 1, 1, 1, 0, 0.2F, 1, 0, 0, 50, 0.4F, 3, 2, 0, 0, 0};
    for (std::size_t i = 0; i < kParameters; ++i) {
      descriptor_->connect_port(plugin_, static_cast<std::uint32_t>(kFirstControl + i), &controls_[i]);
    }
  }
  void fill(const std::vector<MidiEvent>& events) {
    auto* const in = reinterpret_cast<LV2_Atom_Sequence*>(events_.data());
    in->atom = {sizeof(LV2_Atom_Sequence_Body), number_of(LV2_ATOM__Sequence)};
    in->body = {0, 0};
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
      lv2_atom_sequence_append_event(in, static_cast<std::uint32_t>(8 * events_.size() - sizeof(LV2_Atom)),
                                     &whole.event);
    }
    auto* const out = reinterpret_cast<LV2_Atom_Sequence*>(out_.data());
    out->atom = {static_cast<std::uint32_t>(8 * out_.size() - sizeof(LV2_Atom)), 0};
  }

  const LV2_Descriptor* descriptor_ = nullptr;
  LV2_Handle plugin_ = nullptr;
  const LV2_State_Interface* state_ = nullptr;
  LV2_URID_Map map_{};
  LV2_Worker_Schedule worker_{};
  double sample_rate_hz_ = 0;
  std::array<float, kParameters> controls_{};
  std::vector<std::uint64_t> events_ = std::vector<std::uint64_t>(4096), out_ = std::vector<std::uint64_t>(1024);
  bool active_ = false;
};

}  // namespace

std::unique_ptr<PluginHost> open_lv2() { return std::make_unique<Lv2Host>(); }

}  // namespace ringdown::test
