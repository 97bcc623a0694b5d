// The plug-in's parameters, which a host shows, automates and saves. Their numbers and symbols are stored in people's
// sessions, so new ones are added at the end and none is removed. [any]
#pragma once

#include "engine/base/realtime.h"

#include <array>
#include <atomic>
#include <cstddef>

namespace ringdown::plugin {

enum class Parameter : std::size_t {
  level,  // an output; put first because DPF 1.6 cannot read the first parameter of a VST3, and nobody reads this one
  object,
  tuning,
  root_key,
  size,
  stiffness,
  density,
  loss,
  strike_point,
  contact_time,
  even_loudness,
  gain,
  pan,
  width,
  release,
  hand,
  bend_range,
  mpe,
  embed,
  scale,
  mallet,
};
inline constexpr std::size_t kParameters = 21;
inline constexpr double kRingsOn_s = 29.9;  // a release from here on damps nothing

enum class Scale { linear, logarithmic, whole, choice, toggle, output };

// Parameters that hosts show together.
enum class Group : std::size_t { object, body, strike, playing, output, session };
inline constexpr std::size_t kGroups = 6;
struct GroupInfo {
  const char* symbol;  // name in files
  const char* name;    // name for users
};
extern const std::array<GroupInfo, kGroups> kGroupInfo;

struct ParameterInfo {
  const char* symbol;  // name in files
  const char* name;    // name for users
  const char* unit;    // "x" for a factor, "" for a choice
  float min, max, standard;
  Scale scale;
  Group group;
  const char* meaning;  // one sentence
};
extern const std::array<ParameterInfo, kParameters> kParameterInfo;

// Returns whether a host may add something to the value for a while: that makes sense for continuous values.
inline bool is_modulatable(const ParameterInfo& info) REALTIME {
  return info.scale == Scale::linear || info.scale == Scale::logarithmic;
}

// Returns whether a preset has a value for the parameter. An output is nobody's, and a scale belongs to the music.
inline bool is_of_preset(std::size_t parameter) {
  return kParameterInfo[parameter].scale != Scale::output && parameter != static_cast<std::size_t>(Parameter::scale);
}

// The present values, which any thread may read and set. What is played follows operator[], which includes modulation;
// sessions and sliders follow get(), which does not.
class ParameterValues {
 public:
  ParameterValues();
  // Sets a value. Values out of range become the nearest value in range, and NaN becomes the default.
  void set(std::size_t parameter, float value) REALTIME;
  void set(Parameter parameter, double value) REALTIME {
    set(static_cast<std::size_t>(parameter), static_cast<float>(value));
  }
  [[nodiscard]] float get(std::size_t parameter) const REALTIME {
    return parameter < kParameters ? values_[parameter].load(std::memory_order_relaxed) : 0;
  }
  // Adds an amount to the parameter's value until the next call. Parameters that cannot be modulated ignore it.
  void modulate(std::size_t parameter, double amount) REALTIME;
  void end_modulation() REALTIME;
  [[nodiscard]] double operator[](Parameter parameter) const REALTIME;
  [[nodiscard]] bool on(Parameter parameter) const REALTIME { return (*this)[parameter] > 0.5; }

 private:
  std::array<std::atomic<float>, kParameters> values_;
  std::array<std::atomic<float>, kParameters> modulation_{};
};

}  // namespace ringdown::plugin
