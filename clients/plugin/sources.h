// Finds the bank or note map that the plug-in plays: the choices of its parameter "Object", and the places of their
// files. [worker]
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
// Their order is stored in people's sessions: new ones are added at the end.
inline constexpr std::array<std::string_view, 47> kPresets = {"vibraphone-key",
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
                                                              "tam-tam",
                                                              "window-pane",
                                                              "marimba-key",
                                                              "glass-harp"};
inline constexpr std::array<std::string_view, 4> kNoteMapPresets = {"vibraphone", "music-box-comb", "kalimba",
                                                                    "glass-harp"};
inline constexpr std::size_t kChoices = kFirstPreset + kPresets.size();

// Returns the family of a preset, by which hosts sort: "Bars", "Bells"; "Things" for those of no other family.
std::string_view family_of(std::string_view preset);

// Returns a choice as shown to people: "file", "own 3", "mug".
std::string choice_name(std::size_t choice);

struct Source {
  std::string name;  // equal on every computer; for a file its path
  std::filesystem::path path;
  friend bool operator==(const Source&, const Source&) = default;
};

// Finds the source of a choice. `file` is used for choice 0; if it is empty, or if the choice does not exist, the first
// preset is used. `binary` is the plug-in's own file, near which presets may lie.
Source find_source(std::size_t choice, const std::string& file, const std::filesystem::path& binary);

// Returns the file that a host's state names. LV2 hosts save an empty path as a reference to the state's own document,
// and that is what they bring back.
std::string file_of_state(const char* value);

// Returns whether the source is a note map: its name ends in .toml; everything else is a bank.
bool is_note_map(const Source& source);

// Returns the folder of the user's files 1.glb, 2.toml ...: $XDG_DATA_HOME/ringdown/plugin or
// ~/.local/share/ringdown/plugin.
std::filesystem::path own_folder();

// Returns RINGDOWN_PRESETS of the environment; otherwise the first of presets/ and share/ringdown/presets in the folder
// of `binary` or one of those above it; otherwise the result of preset_folder(). Empty if there is none.
std::filesystem::path presets_near(const std::filesystem::path& binary);

}  // namespace ringdown::plugin
