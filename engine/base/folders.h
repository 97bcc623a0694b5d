// Folders that programs of Ringdown use: the presets, and a temporary folder that nobody else can read. [any thread]
#pragma once

#include "engine/base/result.h"

#include <filesystem>
#include <string>

namespace ringdown {

// Returns $RINGDOWN_PRESETS if set; else share/ringdown/presets beside the bin/ that the program runs from; else
// presets/ of the source tree that the program was built from. Fails if none of these is a folder.
Result<std::filesystem::path> preset_folder();

// Returns `given`, or the presets' folder of materials if `given` is empty.
Result<std::filesystem::path> material_folder(const std::filesystem::path& given);

// Returns the folder of the user's own banks, which ringdown-viewer bakes from dropped files:
// $XDG_DATA_HOME/ringdown/banks or ~/.local/share/ringdown/banks. Makes it if it is not there. Fails without a home
// folder, or if it cannot be made.
Result<std::filesystem::path> own_bank_folder();

enum class PresetKind { bank, notes, scene };

// Returns the file that a user means: `given` if it is a file, or has a folder or an ending; else the preset of that
// name. Fails if there is no such preset; the error lists the existing ones.
//
//   preset_or_file("demo", PresetKind::scene);      // .../presets/scenes/demo.toml
//   preset_or_file("my/demo", PresetKind::scene);   // my/demo
Result<std::filesystem::path> preset_or_file(const std::filesystem::path& given, PresetKind kind);

// A new folder in the system's temporary folder (TMPDIR) that only this user can read. The destructor removes the
// folder with everything in it.
//
//   const PrivateFolder folder("ringdown-modes");
//   if (folder.path().empty()) return fail(ErrorKind::input_output, "cannot make a folder for temporary files");
class PrivateFolder {
 public:
  // The folder's name begins with `name`. If no folder can be made, path() is empty.
  explicit PrivateFolder(const std::string& name);
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  // Stops the destructor from removing the folder.
  void keep() { kept_ = true; }

 private:
  std::filesystem::path path_;
  bool kept_ = false;
};

}  // namespace ringdown
