// Fetches the banks of all objects, one at a time: the chosen object's first, then the others in the order of their
// names. Objects that play the same model of a file share one bank. A file is fetched once for all of its models. A
// bank that the daemon refuses, or that would exceed the bound on all banks together, is requested again after five
// seconds. [one thread: the window's]
#pragma once

#include "clients/viewer/link/bank_transfer.h"
#include "clients/viewer/link/known_objects.h"

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>

namespace ringdown::viewer {

class BankFetcher {
 public:
  static constexpr std::size_t kMaxBytesTotal = std::size_t{1} << 30;  // total size of all banks, as files

  explicit BankFetcher(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  void take(const protocol::BankReply& piece);
  void refuse(const std::string& object, const std::string& sentence);

  // Stores banks that have arrived in `objects`, and adds the requests for pieces that are due.
  void add_requests(KnownObjects& objects, const std::string& chosen, double now_s, Requests& requests);

 private:
  using Key = std::tuple<std::string, std::optional<std::size_t>, double>;  // content of a file, model in it, scale
  static Key key_of(const KnownObject& object);
  void finish_transfer(KnownObjects& objects, double now_s);
  void share_banks(KnownObjects& objects);
  [[nodiscard]] std::shared_ptr<const KnownBank> find(const Key& key);
  void begin_transfer(KnownObjects& objects, const std::string& chosen, double now_s);

  std::size_t max_bytes_;
  std::optional<BankTransfer> transfer_;
  std::map<Key, std::weak_ptr<const KnownBank>> banks_;
  std::map<std::string, BankTransfer::File> files_;  // by content, while an object needs another model of the file
};

}  // namespace ringdown::viewer
