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
};
inline constexpr std::size_t kParameters = 19;

enum class Scale { linear, logarithmic, whole, choice, toggle, output };

struct ParameterInfo {
  const char* symbol;  // name in files
  const char* name;    // name for users
  const char* unit;    // "" for a factor or a choice
  float min, max, standard;
  Scale scale;
  const char* meaning;  // one sentence
};
extern const std::array<ParameterInfo, kParameters> kParameterInfo;

// The present values, which any thread may read and set.
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
  [[nodiscard]] double operator[](Parameter parameter) const REALTIME {
    return static_cast<double>(get(static_cast<std::size_t>(parameter)));
  }
  [[nodiscard]] bool on(Parameter parameter) const REALTIME { return (*this)[parameter] > 0.5; }

 private:
  std::array<std::atomic<float>, kParameters> values_;
};

}  // namespace ringdown::plugin
