// Encodes bytes as text that is safe in JSON, HTML and every plug-in format's state: base64 with padding (RFC 4648,
// section 4). [any thread]
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace ringdown {

std::string to_base64(std::string_view bytes);

// Returns the bytes, or nothing for a text that to_base64() cannot have written.
std::optional<std::string> from_base64(std::string_view text);

}  // namespace ringdown
