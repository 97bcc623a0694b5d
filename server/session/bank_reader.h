// Reads banks from files, once each: objects that play the same unchanged file share its memory. [worker]
#pragma once

#include "engine/base/content_hash.h"
#include "engine/base/result.h"
#include "engine/gltf/read_beside.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/strike_map.h"
#include "server/session/file_roots.h"

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::session {

// A bank that is ready to be struck, and the file it was read from.
struct BankFile {
  std::shared_ptr<const modal::StrikeMap> map;
  std::size_t bytes = 0;  // the file's size
  ContentHash content;    // hash of the whole file
  std::shared_ptr<const std::vector<std::byte>>
      alone;  // for a bank in a scene, a file with this bank alone, used instead of the scene's file
};

// The bank in a file of these bytes (modal::parse_bank); `name` stands in sentences where the file's path would.
Result<BankFile> parse_bank_file(std::string_view bytes, const std::string& name, const modal::ModelChoice& model = {},
                                 const modal::ReadBeside& read_beside = {});

// A bank for whoever draws an object: files have at least one mode, so a piece without modes gets a silent one.
std::vector<std::byte> drawn_file(const modal::Bank& bank);

class BankReader {
 public:
  // Reads below `roots` only, which must outlive the reader.
  explicit BankReader(const FileRoots& roots) : roots_(roots) {}

  // Returns the bank in the file. If somebody still holds a bank that was read from this file, and the file has not
  // been written since, that bank is returned and nothing is read. Fails for files outside of the roots, larger than
  // modal::kMaxBankFileBytes, or without a valid bank; the error names the file.
  [[nodiscard]] Result<BankFile> read(const std::filesystem::path& path);

  // Forgets the banks that nobody holds any more. Call now and then, so that the list of known files stays short.
  void forget_unused();

 private:
  struct Known {
    std::weak_ptr<const modal::StrikeMap> map;
    std::size_t bytes = 0;
    ContentHash content;
    std::shared_ptr<const std::vector<std::byte>> alone;
  };

  const FileRoots& roots_;
  std::map<std::string, Known> known_;  // keys consist of canonical path and time of the last write
};

}  // namespace ringdown::session
