// glTF 2.0 in any of its forms: a .glb file, or a .gltf text with its buffers inside (data: URIs) or in files beside
// it. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/gltf/glb.h"
#include "engine/gltf/read_beside.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace ringdown::modal {

// The most buffers that a file may have, and the most bytes of all of them together.
inline constexpr std::size_t kMaxBuffers = 256;
inline constexpr std::size_t kMaxBufferBytes = std::size_t{1} << 30;

// Reads a document and all of its buffers, which stand in the result as one binary; the document's buffer views are
// changed to match. `bytes` must outlive the result. Fails on what parse_glb() (glb.h) refuses, on buffers that are
// missing, too short, too large or of a scheme other than data:, and on `read_beside` failing.
Result<Glb> parse_gltf(std::span<const std::byte> bytes, const std::string& name, const ReadBeside& read_beside,
                       std::size_t max_json_bytes = kMaxJsonBytes);

// Reads files in the document's folder and below it, where links are followed no further either.
ReadBeside files_beside(const std::filesystem::path& document);

// The content of a URI, which `path` names in messages: inside it (data:, base64), or in a file beside the document.
// Fails on other schemes, on paths that are not relative or lead out of the document's folder, and on `read_beside`
// failing.
Result<std::string> read_uri(const std::string& uri, const std::string& path, std::size_t limit,
                             const ReadBeside& read_beside);

}  // namespace ringdown::modal
