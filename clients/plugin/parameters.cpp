#include "clients/plugin/parameters.h"

#include <algorithm>
#include <cmath>

namespace ringdown::plugin {

const std::array<ParameterInfo, kParameters> kParameterInfo = {{
    {"level", "Level", "dB", -120, 24, -120, Scale::output, Group::output, "Peak of the output."},
    {"object", "Object", "", 0, 127, 0, Scale::choice, Group::object,
     "The object: the file chosen in the host, a file of your own folder, or a preset."},
    {"tuning", "Tuning", "", 0, 1, 0, Scale::choice, Group::object,
     "Concert pitch: each key plays the object in the size that has the key's pitch; own pitch: the root key plays the "
     "object in its own size."},
    {"root_key", "Root key", "", 0, 127, 60, Scale::whole, Group::object,
     "With own pitch: the key that plays the object in its own size."},
    {"size", "Size", "x", 0.25F, 4, 1, Scale::logarithmic, Group::body,
     "Factor on all lengths: twice as large is an octave lower."},
    {"stiffness", "Stiffness", "x", 0.1F, 10, 1, Scale::logarithmic, Group::body,
     "Factor on the material's Young's modulus."},
    {"density", "Density", "x", 0.1F, 10, 1, Scale::logarithmic, Group::body, "Factor on the material's density."},
    {"loss", "Loss", "x", 0.05F, 20, 1, Scale::logarithmic, Group::body,
     "Factor on the material's damping: 2 rings half as long."},
    {"strike_point", "Strike point", "%", 0, 100, 0, Scale::linear, Group::strike,
     "The struck point: 0 where the main modes move most, 100 near the object's middle."},
    {"contact_time", "Contact time", "ms", 0.02F, 20, 0.2F, Scale::logarithmic, Group::strike,
     "Duration of a blow of full velocity: 0.1 for hard wood, 1 for rubber."},
    {"even_loudness", "Even loudness", "", 0, 1, 1, Scale::toggle, Group::strike,
     "All objects and keys are about equally loud; off: blows give the object 0.1 m/s, or have the note map's "
     "impulse."},
    {"gain", "Gain", "dB", -60, 24, 0, Scale::linear, Group::output, "Level of the output."},
    {"pan", "Pan", "%", -100, 100, 0, Scale::linear, Group::output, "Place between left and right."},
    {"width", "Width", "%", 0, 100, 50, Scale::linear, Group::output,
     "Spread of low keys to the left and high keys to the right."},
    {"release", "Release", "s", 0.02F, 30, 0.4F, Scale::logarithmic, Group::playing,
     "Time in which a released key is damped; 30: it rings on."},
    {"hand", "Hand damping", "Ns/m", 0.01F, 100, 3, Scale::logarithmic, Group::playing,
     "Damping of the hand that full aftertouch lays on the object."},
    {"bend_range", "Bend range", "semitones", 0, 48, 2, Scale::whole, Group::playing, "Interval of a full pitch bend."},
    {"mpe", "MPE", "", 0, 1, 0, Scale::toggle, Group::playing,
     "Channel 1 bends and presses all keys, each other channel the keys that it plays."},
    {"embed", "Save bank in session", "", 0, 1, 0, Scale::toggle, Group::session,
     "Sessions hold the object's bank itself, not only its name."},
    {"scale", "Scale", "", 0, 9, 0, Scale::choice, Group::object,
     "The pitches of the keys: equal temperament, or a scale and a keyboard mapping of Scala, from the host or from "
     "your "
     "own folder."},
    {"mallet", "Mallet", "", 0, 6, 0, Scale::choice, Group::strike,
     "As struck: a blow of the contact time, or the note map's bow; otherwise a mallet that feels the surface, or a "
     "bow."},
}};

const std::array<GroupInfo, kGroups> kGroupInfo = {{
    {"object", "Object"},
    {"body", "Body"},
    {"strike", "Strike"},
    {"playing", "Playing"},
    {"output", "Output"},
    {"session", "Session"},
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

void ParameterValues::modulate(std::size_t parameter, double amount) REALTIME {
  if (parameter >= kParameters || !is_modulatable(kParameterInfo[parameter])) return;
  const double sound = std::isfinite(amount) ? amount : 0;
  modulation_[parameter].store(static_cast<float>(sound), std::memory_order_relaxed);
}

void ParameterValues::end_modulation() REALTIME {
  for (std::atomic<float>& amount : modulation_) amount.store(0, std::memory_order_relaxed);
}

double ParameterValues::operator[](Parameter parameter) const REALTIME {
  const auto number = static_cast<std::size_t>(parameter);
  const float value = get(number);
  const float amount = modulation_[number].load(std::memory_order_relaxed);
  if (amount == 0) return static_cast<double>(value);
  const ParameterInfo& info = kParameterInfo[number];
  return static_cast<double>(std::clamp(value + amount, info.min, info.max));
}

}  // namespace ringdown::plugin
