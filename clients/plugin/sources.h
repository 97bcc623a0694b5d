// Which bank or note map the plug-in plays: the choices of its parameter "Object", and where their files lie. [worker]
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace ringdown::plugin {

// Choice 0 is the file that the host chose; choices 1 to kOwnFiles are files of the user's folder; then come presets.
inline constexpr std::size_t kOwnFiles = 8;
inline constexpr std::size_t kFirstPreset = kOwnFiles + 1;
// Their order stands in people's sessions: new ones are added at the end.
inline constexpr std::array<std::string_view, 44> kPresets = {"vibraphone-key",
                                                              "anvil",
                                                              "block",
                                                              "bottle",
                                                              "brick",
                                                              "bronze-bell",
                                                              "ceramic-tile",
                                                              "chime-tube",
                                                              "coin",
                                                              "cow-bell",
                                                              "crotale",
                                                              "dinner-plate",
                                                              "flower-pot",
                                                              "fork",
                                                              "frying-pan",
                                                              "glass-slat",
                                                              "glockenspiel-bar",
                                                              "gong",
                                                              "granite-slab",
                                                              "hand-bell",
                                                              "horseshoe",
                                                              "knife",
                                                              "mug",
                                                              "porcelain-bowl",
                                                              "singing-bowl",
                                                              "spoon",
                                                              "steel-plate",
                                                              "steel-rod",
                                                              "table-top",
                                                              "triangle",
                                                              "tumbler",
                                                              "tuning-fork",
                                                              "wine-glass",
                                                              "wood-block",
                                                              "wooden-bar",
                                                              "wrench",
                                                              "xylophone-key",
                                                              "vibraphone",
                                                              "music-box-comb",
                                                              "kalimba",
                                                              "thunder-sheet",
                                                              "opera-gong",
                                                              "crash-cymbal",
                                                              "tam-tam"};
inline constexpr std::array<std::string_view, 3> kNoteMapPresets = {"vibraphone", "music-box-comb", "kalimba"};
inline constexpr std::size_t kChoices = kFirstPreset + kPresets.size();

// A choice as people see it: "file", "own 3", "mug".
std::string choice_name(std::size_t choice);

struct Source {
  std::string name;  // the same in every computer; for a file its path
  std::filesystem::path path;
  friend bool operator==(const Source&, const Source&) = default;
};

// Finds what to play: `file` counts for choice 0, and is the first preset when it is empty; so is any choice that there
// is not. `binary` is the plug-in's own file, near which presets may lie.
Source find_source(std::size_t choice, const std::string& file, const std::filesystem::path& binary);

// A note map ends in .toml; everything else is a bank.
bool is_note_map(const Source& source);

// Returns the folder of the user's files 1.glb, 2.toml ...: $XDG_DATA_HOME/ringdown/plugin or
// ~/.local/share/ringdown/plugin.
std::filesystem::path own_folder();

// The environment's RINGDOWN_PRESETS; else the first of presets/ and share/ringdown/presets in the folder of `binary`
// or one of those above it; else what preset_folder() finds. Empty when there is none.
std::filesystem::path presets_near(const std::filesystem::path& binary);

}  // namespace ringdown::plugin
