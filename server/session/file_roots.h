// The folders in which files may be opened. Paths in messages may come from strangers, so every file that the daemon
// opens because of a message is opened through FileRoots.
//
// A path is accepted only if its words and every link on its way lead to a regular file of bounded size below one of
// the folders. `..` that leaves a folder, links that lead out of it, fifos, devices, sockets and folders are refused
// before anything is read. [any thread but audio]
#pragma once

#include "engine/base/result.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::session {

// A kind of file that messages may have written: its name ends in `ending`, and its content has `mark` at byte
// `mark_at`. A kind without a mark replaces no file.
struct WrittenKind {
  std::string_view ending, mark;
  std::size_t mark_at = 0;
};
inline constexpr WrittenKind kScoreKind{".osc", "#bundle", 4};
inline constexpr WrittenKind kSceneKind{".toml", "# A scene that ringdownd saved"};
inline constexpr WrittenKind kSoundKind{".wav", ""};
inline constexpr WrittenKind kStateKind{".toml", "# What ringdownd holds"};

class FileRoots {
 public:
  // Allows every file, for programs whose user names each file.
  FileRoots() = default;

  enum class Guard {
    kernel,  // openat2 with RESOLVE_BENEATH, which excludes races; `path` if the kernel lacks it
    path,    // the canonical path is checked, then opened without following a last link
  };

  // Allows only files below `folders`, which must exist.
  static Result<FileRoots> only(const std::vector<std::filesystem::path>& folders, Guard guard = Guard::kernel);

  // Reads the whole file. A relative path starts in the current folder.
  [[nodiscard]] Result<std::string> read(const std::filesystem::path& path, std::size_t limit_bytes) const;

  // Reads a file that `document` names, relative to the document's folder. The file must lie in that folder or below,
  // even if every file may be opened.
  [[nodiscard]] Result<std::string> read_beside(const std::filesystem::path& document,
                                                const std::filesystem::path& relative, std::size_t limit_bytes) const;

  // Reads up to `max_bytes` bytes from `offset` on, and the size of the whole file.
  struct Piece {
    std::vector<std::byte> bytes;
    std::size_t total = 0;
  };
  [[nodiscard]] Result<Piece> read_piece(const std::filesystem::path& path, std::size_t offset,
                                         std::size_t max_bytes) const;

  // The folders, as given; none if every file may be opened.
  [[nodiscard]] std::vector<std::filesystem::path> folders() const;

  // Returns the path, without links, at which a file of this kind may be written: in one of the folders or below. A
  // file that exists there must be a regular file of the same kind or empty, so that a stranger's message replaces
  // nothing else.
  [[nodiscard]] Result<std::filesystem::path> writable(const std::filesystem::path& path,
                                                       const WrittenKind& kind) const;

 private:
  struct Root {
    std::filesystem::path given, real;  // absolute; without links
    std::shared_ptr<const int> folder;  // an open descriptor
  };
  [[nodiscard]] Result<int> open(const std::filesystem::path& path) const;
  [[nodiscard]] Result<int> open_in(const Root& root, const std::filesystem::path& below) const;
  [[nodiscard]] tl::unexpected<Error> outside(const std::filesystem::path& path) const;

  bool open_everywhere_ = true;
  Guard guard_ = Guard::kernel;
  std::vector<Root> roots_;
};

}  // namespace ringdown::session
