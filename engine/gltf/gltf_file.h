// Reads glTF 2.0 in any form: a .glb file, or a .gltf text with its buffers inside (data: URIs) or in files beside it.
// [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/gltf/glb.h"
#include "engine/gltf/read_beside.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace ringdown::modal {

// The maximum number of buffers in a file, and their maximum total size in bytes.
inline constexpr std::size_t kMaxBuffers = 256;
inline constexpr std::size_t kMaxBufferBytes = std::size_t{1} << 30;

// Reads a document and all of its buffers. The result has the buffers as one binary, and the document's buffer views
// are changed to match. `bytes` must outlive the result. Fails on everything that parse_glb() (glb.h) refuses; on
// buffers that are missing, too short, too large or of a scheme other than data:; and if `read_beside` fails.
Result<Glb> parse_gltf(std::span<const std::byte> bytes, const std::string& name, const ReadBeside& read_beside,
                       std::size_t max_json_bytes = kMaxJsonBytes);

// Returns a function that reads files in the document's folder and below. Links that lead out of the folder are
// refused.
ReadBeside files_beside(const std::filesystem::path& document);

// Returns the content of a URI: inside the URI (data:, base64), or in a file beside the document. `path` names the URI
// in messages. Fails on other schemes, on paths that are not relative or lead out of the document's folder, and if
// `read_beside` fails.
Result<std::string> read_uri(const std::string& uri, const std::string& path, std::size_t limit,
                             const ReadBeside& read_beside);

}  // namespace ringdown::modal
