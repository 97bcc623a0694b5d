// The OSC namespace as described by OSCQuery (github.com/Vidvox/OSCQueryProposal): one JSON object for each address,
// with its types, ranges, units and meaning, so that hosts can list all controls. Made from the protocol's one table.
// [any thread but audio]
#pragma once

#include "engine/base/result.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ringdown::server {

using ObjectNames = std::shared_ptr<const std::vector<std::string>>;

// A text that is generated while it is read, because the text for 1024 objects has megabytes: all objects have equal
// addresses, so one object's text is kept, in which kAnyObject stands for the name.
class Description {
 public:
  static constexpr char kAnyObject = '\x7f';

  Description() = default;
  explicit Description(std::string text) : before_(std::move(text)) {}
  // The text is `before`, then `each` for every name with commas between them, then `after`. There must be a name.
  Description(std::string before, std::string each, std::string after, ObjectNames names);

  [[nodiscard]] std::size_t size() const;  // characters

  // Writes the text that follows the last read. Returns the number of characters, 0 at the end.
  std::size_t read(std::span<char> target);

 private:
  bool next_piece();

  std::string before_, each_, after_;
  ObjectNames names_;
  std::size_t next_ = 0;  // the piece after `piece_`: the text before the names, each of them, the text after them
  std::string piece_;
  std::size_t done_ = 0;  // characters of `piece_` that were read
};

// Describes the node at `path` and everything below it, if there are objects of these names; "/" is the whole
// namespace. With an attribute, such as "TYPE" or "DESCRIPTION", only that one as {"TYPE": ...}; empty if the node does
// not have it. Fails if there is no such node.
Result<Description> describe(std::string_view path, std::string_view attribute, const ObjectNames& names);

// Returns the answer to ?HOST_INFO.
std::string describe_host(const std::string& name, const std::string& osc_address, std::uint16_t osc_port);

}  // namespace ringdown::server
