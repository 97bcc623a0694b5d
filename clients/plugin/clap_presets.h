// CLAP hosts list presets in their browsers before they open the plug-in. This tells them ours, with families and
// descriptions, and the banks and note maps of the user's folder. [any]
#pragma once

#include "clients/plugin/clap_abi.h"

#include <filesystem>

namespace ringdown::plugin::clap {

// `binary` is the plug-in's own file, near which presets lie.
const PresetFactory* preset_factory(const std::filesystem::path& binary);

inline constexpr const char* kPluginId = "ringdown.instrument";

}  // namespace ringdown::plugin::clap
