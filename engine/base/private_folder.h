// A new folder below the system's temporary one (TMPDIR) that only we can read; it is gone, with all that is in it,
// when this object is.
//
//   const PrivateFolder folder("ringdown-modes");
//   if (folder.path().empty()) return fail(ErrorKind::input_output, "cannot make a folder for temporary files");
#pragma once

#include <filesystem>
#include <string>

namespace ringdown {

class PrivateFolder {
 public:
  // Its name begins with `name`. Where it cannot be made, path() is empty.
  explicit PrivateFolder(const std::string& name);
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  // Leaves it where it is.
  void keep() { kept_ = true; }

 private:
  std::filesystem::path path_;
  bool kept_ = false;
};

}  // namespace ringdown
