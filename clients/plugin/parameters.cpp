#include "clients/plugin/parameters.h"

#include <algorithm>
#include <cmath>

namespace ringdown::plugin {

const std::array<ParameterInfo, kParameters> kParameterInfo = {{
    {"level", "Level", "dB", -120, 24, -120, Scale::output, "Peak of the output."},
    {"object", "Object", "", 0, 127, 0, Scale::choice,
     "The object: the file chosen in the host, a file of your own folder, or a preset."},
    {"tuning", "Tuning", "", 0, 1, 0, Scale::choice,
     "Concert pitch: each key plays the object in the size that has the key's pitch; own pitch: the root key plays the "
     "object in its own size."},
    {"root_key", "Root key", "", 0, 127, 60, Scale::whole,
     "With own pitch: the key that plays the object in its own size."},
    {"size", "Size", "", 0.25F, 4, 1, Scale::logarithmic, "Factor on all lengths: twice as large is an octave lower."},
    {"stiffness", "Stiffness", "", 0.1F, 10, 1, Scale::logarithmic, "Factor on the material's Young's modulus."},
    {"density", "Density", "", 0.1F, 10, 1, Scale::logarithmic, "Factor on the material's density."},
    {"loss", "Loss", "", 0.05F, 20, 1, Scale::logarithmic, "Factor on the material's damping: 2 rings half as long."},
    {"strike_point", "Strike point", "%", 0, 100, 0, Scale::linear,
     "The struck point: 0 where the main modes move most, 100 near the object's middle."},
    {"contact_time", "Contact time", "ms", 0.02F, 20, 0.2F, Scale::logarithmic,
     "Duration of a blow of full velocity: 0.1 for hard wood, 1 for rubber."},
    {"even_loudness", "Even loudness", "", 0, 1, 1, Scale::toggle,
     "All objects and keys are about equally loud; off: blows give the object 0.1 m/s, or have the note map's "
     "impulse."},
    {"gain", "Gain", "dB", -60, 24, 0, Scale::linear, "Level of the output."},
    {"pan", "Pan", "%", -100, 100, 0, Scale::linear, "Place between left and right."},
    {"width", "Width", "%", 0, 100, 50, Scale::linear, "Spread of low keys to the left and high keys to the right."},
    {"release", "Release", "s", 0.02F, 30, 0.4F, Scale::logarithmic,
     "Time in which a released key is damped; 30: it rings on."},
    {"hand", "Hand damping", "N s/m", 0.01F, 100, 3, Scale::logarithmic,
     "Damping of the hand that full aftertouch lays on the object."},
    {"bend_range", "Bend range", "semitones", 0, 48, 2, Scale::whole, "Interval of a full pitch bend."},
    {"mpe", "MPE", "", 0, 1, 0, Scale::toggle,
     "Channel 1 bends and presses all keys, each other channel the keys that it plays."},
    {"embed", "Save bank in session", "", 0, 1, 0, Scale::toggle,
     "Sessions hold the object's bank itself, not only its name."},
}};

ParameterValues::ParameterValues() {
  for (std::size_t i = 0; i < kParameters; ++i) values_[i] = kParameterInfo[i].standard;
}

void ParameterValues::set(std::size_t parameter, float value) REALTIME {
  if (parameter >= kParameters) return;
  const ParameterInfo& info = kParameterInfo[parameter];
  const float sound = std::isfinite(value) ? std::clamp(value, info.min, info.max) : info.standard;
  const bool stepped = info.scale == Scale::whole || info.scale == Scale::choice || info.scale == Scale::toggle;
  values_[parameter].store(stepped ? std::round(sound) : sound, std::memory_order_relaxed);
}

}  // namespace ringdown::plugin
