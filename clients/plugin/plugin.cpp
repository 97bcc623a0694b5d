// The instrument as DPF wants it: this file and DistrhoPluginInfo.h are compiled once for every plug-in format.
#include "clients/plugin/instrument.h"
#include "clients/plugin/parameter_text.h"
#include "clients/plugin/vst3_notes.h"
#include "engine/base/formatted.h"
#include "engine/base/version.h"

#include <DistrhoPlugin.hpp>
#include <DistrhoPluginUtils.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

START_NAMESPACE_DISTRHO

namespace {

using ringdown::plugin::Instrument;
using ringdown::plugin::kChoices;
using ringdown::plugin::kParameterInfo;
using ringdown::plugin::kParameters;
using ringdown::plugin::MidiMessage;
using ringdown::plugin::ParameterInfo;
using ringdown::plugin::Tunings;
using ringdown::plugin::Which;
using Kind = ringdown::plugin::Scale;

using Written = std::array<ringdown::plugin::NoteExpressions::Message, 2>;  // messages of one expression

constexpr std::uint32_t kMaxMessages = 512;  // DPF hands over no more in a block
constexpr const char* kFileKey = "file";
constexpr const char* kEmbeddedKey = "embedded";
constexpr const char* kScaleKey = "scale_file";
constexpr const char* kMappingKey = "mapping_file";
constexpr const char* kWindowScaleKey = "window_scale";

struct StateInfo {
  const char *key, *label, *description;
  std::uint32_t hints;
};
constexpr std::array kStates = {
    StateInfo{kFileKey, "Bank or note map", "A bank (.glb) or a note map (.toml), played while Object is \"file\".",
              kStateIsFilenamePath},
    StateInfo{kEmbeddedKey, "Bank of the session", "", kStateIsOnlyForDSP},
    StateInfo{kScaleKey, "Scale", "A scale of Scala (.scl), played while Scale is \"file\".", kStateIsFilenamePath},
    StateInfo{kMappingKey, "Keyboard mapping", "A keyboard mapping of Scala (.kbm), played while Scale is \"file\".",
              kStateIsFilenamePath},
    // The window's:
    StateInfo{ringdown::plugin::kPointStates[0], "Exact strike point", "", 0},
    StateInfo{ringdown::plugin::kPointStates[1], "Second strike point", "", 0},
    StateInfo{kWindowScaleKey, "Scale of the window", "", kStateIsOnlyForUI},
};

class RingdownPlugin : public Plugin {
 public:
  RingdownPlugin()
      : Plugin(kParameters, 0, kStates.size()),
        instrument_(std::make_unique<Instrument>(getSampleRate(), getBinaryFilename())) {}

 protected:
  const char* getLabel() const override { return "ringdown"; }
  const char* getDescription() const override {
    return "Solid objects as playable, physically exact sound: one object across the keyboard, or a map of many.";
  }
  const char* getMaker() const override { return "Ringdown"; }
  const char* getLicense() const override { return "MIT"; }
  std::uint32_t getVersion() const override {
    std::array<std::uint32_t, 3> numbers{};
    const char* rest = ringdown::kVersion;
    for (std::uint32_t& number : numbers) {
      char* end = nullptr;
      number = static_cast<std::uint32_t>(std::strtoul(rest, &end, 10));
      rest = *end ? end + 1 : end;
    }
    return d_version(numbers[0], numbers[1], numbers[2]);
  }
  std::int64_t getUniqueId() const override { return d_cconst('R', 'n', 'g', 'd'); }

  void initAudioPort(bool input, std::uint32_t index, AudioPort& port) override {
    Plugin::initAudioPort(input, index, port);
    port.groupId = kPortGroupStereo;
    port.name = index == 0 ? "Left" : "Right";
    port.symbol = index == 0 ? "left" : "right";
  }

  void initParameter(std::uint32_t index, Parameter& parameter) override {
    const ParameterInfo& info = kParameterInfo[index];
    parameter.hints = info.scale == Kind::output ? kParameterIsOutput : kParameterIsAutomatable;
    if (info.scale == Kind::logarithmic) parameter.hints |= kParameterIsLogarithmic;
    if (info.scale == Kind::whole || info.scale == Kind::choice) parameter.hints |= kParameterIsInteger;
    if (info.scale == Kind::toggle) parameter.hints |= kParameterIsInteger | kParameterIsBoolean;
    parameter.name = info.name;
    parameter.symbol = info.symbol;
    parameter.unit = info.unit;
    parameter.description = info.meaning;
    parameter.groupId = static_cast<std::uint32_t>(info.group);
    parameter.ranges = ParameterRanges(info.standard, info.min, info.max);
    if (info.scale == Kind::choice) name_choices(index, parameter.enumValues);
  }

  void initPortGroup(std::uint32_t group, PortGroup& shown) override {
    if (group >= ringdown::plugin::kGroups) return Plugin::initPortGroup(group, shown);
    shown.name = ringdown::plugin::kGroupInfo[group].name;
    shown.symbol = ringdown::plugin::kGroupInfo[group].symbol;
  }

  void initState(std::uint32_t index, State& state) override {
    const StateInfo& info = kStates[index];
    state.key = info.key;
    state.hints = info.hints;
    state.label = info.label;
    state.description = info.description;
  }

  float getParameterValue(std::uint32_t index) const override { return instrument_->parameters().get(index); }
  void setParameterValue(std::uint32_t index, float value) override { instrument_->parameters().set(index, value); }

  String getState(const char* key) const override {
    if (std::string(key) == kFileKey) return String(instrument_->file().c_str());
    if (const auto file = tuning_file(key)) return String(instrument_->tunings().file(*file).c_str());
    if (const auto which = point_of(key)) return String(instrument_->point(*which).c_str());
    if (std::string(key) == kWindowScaleKey) {
      return String(window_scale_ > 0 ? ringdown::formatted("{}", window_scale_.load()).c_str() : "");
    }
    return String(instrument_->embedded().c_str());
  }

  void setState(const char* key, const char* value) override {
    if (std::string(key) == kFileKey) instrument_->set_file(ringdown::plugin::file_of_state(value));
    if (std::string(key) == kEmbeddedKey) instrument_->set_embedded(value);
    if (const auto file = tuning_file(key))
      instrument_->tunings().set_file(*file, ringdown::plugin::file_of_state(value));
    if (const auto which = point_of(key)) instrument_->set_point(value, *which);
    if (std::string(key) == kWindowScaleKey) window_scale_ = std::strtod(value, nullptr);
  }

  void sampleRateChanged(double sample_rate_hz) override { instrument_->set_sample_rate(sample_rate_hz); }
  void activate() override { instrument_->start(); }
  void deactivate() override { instrument_->stop(); }

  void run(const float**, float** outputs, std::uint32_t frames, const MidiEvent* events,
           std::uint32_t count) override {
    used_ = 0;
    const ringdown::plugin::NoteSayings* const sayings = ringdown::plugin::sayings_of_block();
    std::size_t said = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const MidiEvent& event = events[i];
      for (; sayings && said < sayings->count && sayings->list[said].frame <= event.frame; ++said) {
        express(sayings->list[said], written_[said]);
      }
      const bool is_long = event.size > MidiEvent::kDataSize;  // system exclusive
      add({event.frame, {is_long ? event.dataExt : event.data, event.size}});
    }
    for (; sayings && said < sayings->count; ++said) express(sayings->list[said], written_[said]);
    instrument_->render({messages_.data(), used_}, outputs[0], outputs[1], frames);
  }

 private:
  static void name_choices(std::uint32_t index, ParameterEnumerationValues& values) {
    const bool is_object = index == static_cast<std::uint32_t>(ringdown::plugin::Parameter::object);
    values.count = static_cast<std::uint8_t>(is_object ? kChoices : kParameterInfo[index].max + 1);
    values.restrictedMode = true;
    values.values = new ParameterEnumerationValue[values.count];
    for (std::uint8_t i = 0; i < values.count; ++i) {
      values.values[i].value = i;
      values.values[i].label = ringdown::plugin::text_of(index, i).c_str();
    }
  }

  static std::optional<Which> point_of(std::string_view key) {
    const auto found = std::ranges::find(ringdown::plugin::kPointStates, key);
    if (found == ringdown::plugin::kPointStates.end()) return std::nullopt;
    return static_cast<Which>(found - ringdown::plugin::kPointStates.begin());
  }

  static std::optional<Tunings::File> tuning_file(const std::string& key) {
    if (key == kScaleKey) return Tunings::File::scale;
    if (key == kMappingKey) return Tunings::File::mapping;
    return std::nullopt;
  }

  void add(const MidiMessage& message) {
    if (used_ < kMaxMessages) messages_[used_++] = message;
  }
  // An expression precedes the messages of its frame: a note that begins with a tuning begins in tune.
  void express(const ringdown::plugin::NoteSaying& saying, Written& written) {
    if (saying.kind == ringdown::plugin::NoteSaying::Kind::exclusive) return add({saying.frame, saying.message});
    const std::size_t count = expressions_.write(saying, written);
    for (std::size_t i = 0; i < count; ++i) add({saying.frame, written[i]});
  }

  std::unique_ptr<Instrument> instrument_;
  std::atomic<double> window_scale_ = 0;  // as chosen in the window; 0: not chosen
  std::array<MidiMessage, kMaxMessages> messages_{};
  std::size_t used_ = 0;
  ringdown::plugin::NoteExpressions expressions_;
  std::array<Written, ringdown::plugin::NoteSayings::kMax> written_{};  // what messages_ of expressions point to

  DISTRHO_DECLARE_NON_COPYABLE_WITH_LEAK_DETECTOR(RingdownPlugin)
};

}  // namespace

Plugin* createPlugin() { return new RingdownPlugin; }

END_NAMESPACE_DISTRHO
