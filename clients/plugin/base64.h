// Bytes as text that survives in every plug-in format's state (RFC 4648, with padding). [any]
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::plugin {

std::string to_base64(std::span<const std::uint8_t> bytes);

// Nothing for what to_base64() cannot have written.
std::optional<std::vector<std::uint8_t>> from_base64(std::string_view text);

}  // namespace ringdown::plugin
