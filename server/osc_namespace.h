// The namespace as OSCQuery describes it (github.com/Vidvox/OSCQueryProposal): one JSON object for each address, with
// its types, ranges, units and meaning, so that hosts can list what there is to control. From the protocol's one table.
// [any thread but audio]
#pragma once

#include "engine/base/result.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace ringdown::server {

// The node at `path` and everything below it, if there are objects of these names; "/" is the whole namespace. Fails
// when there is no such node.
Result<std::string> describe_namespace(std::string_view path, std::span<const std::string> objects);

// One attribute of a node, such as "TYPE" or "DESCRIPTION", as {"TYPE": ...}; empty when the node does not have it.
Result<std::string> describe_attribute(std::string_view path, std::string_view attribute,
                                       std::span<const std::string> objects);

// The answer to ?HOST_INFO.
std::string describe_host(const std::string& name, const std::string& osc_address, std::uint16_t osc_port);

}  // namespace ringdown::server
