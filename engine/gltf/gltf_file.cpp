#include "engine/gltf/gltf_file.h"

#include "engine/base/atomic_file.h"
#include "engine/base/base64.h"
#include "engine/base/within_memory.h"

#include <array>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace ringdown::modal {
namespace {

constexpr std::size_t kNoBuffer = std::size_t{1} << 40;  // larger than any buffer number

int hex_digit(char letter) {
  if (letter >= '0' && letter <= '9') return letter - '0';
  const char lower = static_cast<char>(letter | 0x20);
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

// Decodes percent-encoded characters such as %20.
std::string from_percent(std::string_view text) {
  std::string plain;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const int high = text[k] == '%' && k + 2 < text.size() ? hex_digit(text[k + 1]) : -1;
    const int low = high >= 0 ? hex_digit(text[k + 2]) : -1;
    plain.push_back(low >= 0 ? static_cast<char>(16 * high + low) : text[k]);
    if (low >= 0) k += 2;
  }
  return plain;
}

// Puts every buffer into one binary.
class Assembler {
 public:
  Assembler(Glb& glb, const ReadBeside& read_beside) : glb_(glb), read_beside_(read_beside) {}

  Result<void> assemble() {
    const JsonPlace buffers = glb_.root()["buffers"];
    if (buffers.size() > kMaxBuffers) return buffers.wrong(formatted("at most {} buffers", kMaxBuffers));
    for (std::size_t k = 0; k < buffers.size(); ++k) {
      if (const auto added = add(buffers[k], k); !added) return added;
    }
    if (Json* views = inside(glb_.json, "bufferViews"); views && views->is_array()) {
      for (Json& view : *views) move(view);
    }
    if (Json* all = inside(glb_.json, "buffers"); all && all->is_array()) {
      for (Json& buffer : *all) {
        if (buffer.is_object()) buffer.erase("uri");
      }
    }
    glb_.assembled = std::move(binary_);
    glb_.binary = glb_.assembled;
    return {};
  }

 private:
  static Json* inside(Json& json, const char* key) {
    if (!json.is_object()) return nullptr;
    const auto found = json.find(key);
    return found == json.end() ? nullptr : &*found;
  }

  Result<void> add(const JsonPlace& buffer, std::size_t number) {
    begins_.emplace_back();
    const auto length = buffer["byteLength"].index();
    if (!length) return fail(length);
    std::string content;
    if (buffer["uri"].present()) {
      auto read = read_uri(buffer["uri"].text_or(""), buffer["uri"].path(), kMaxBufferBytes, read_beside_);
      if (!read) return fail(read);
      content = *std::move(read);
    } else if (number == 0 && !glb_.binary.empty()) {
      content.assign(reinterpret_cast<const char*>(glb_.binary.data()), glb_.binary.size());
    } else {
      return {};  // a placeholder of EXT_meshopt_compression
    }
    if (content.size() < *length)
      return buffer["byteLength"].wrong(formatted("at most the {} bytes that are there", content.size()));
    binary_.resize((binary_.size() + 3) / 4 * 4);
    if (content.size() > kMaxBufferBytes - binary_.size()) {
      return fail(ErrorKind::too_large, "{}: its buffers have more than {} bytes together", glb_.name, kMaxBufferBytes);
    }
    begins_.back() = binary_.size();
    lengths_.resize(begins_.size());
    lengths_.back() = *length;
    const auto bytes = std::as_bytes(std::span(content)).first(*length);
    binary_.insert(binary_.end(), bytes.begin(), bytes.end());
    return {};
  }

  // Moves a buffer view, and its compressed content, into the one binary. A view that lies outside its buffer gets the
  // number of a buffer that does not exist, so that reading the view fails.
  void move(Json& view) {
    shift(view);
    Json* extensions = inside(view, "extensions");
    if (Json* packed = extensions ? inside(*extensions, "EXT_meshopt_compression") : nullptr) shift(*packed);
  }

  void shift(Json& slice) {
    if (!slice.is_object()) return;
    const JsonPlace field(&slice, "");
    const auto buffer = field["buffer"].index(), offset = field["byteOffset"].index_or(0);
    const auto length = field["byteLength"].index();
    if (!buffer || !offset || !length) return;  // reading the view reports the error
    const bool fits = *buffer < begins_.size() && begins_[*buffer] && *offset <= lengths_[*buffer] &&
                      *length <= lengths_[*buffer] - *offset;
    slice["buffer"] = fits ? 0 : kNoBuffer;
    if (fits) slice["byteOffset"] = *begins_[*buffer] + *offset;
  }

  Glb& glb_;
  const ReadBeside& read_beside_;
  std::vector<std::byte> binary_;
  std::vector<std::optional<std::size_t>> begins_;  // beginning of each buffer in binary_; nothing: a placeholder
  std::vector<std::size_t> lengths_;
};

bool is_glb(std::span<const std::byte> bytes) { return bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0; }

}  // namespace

Result<std::string> read_uri(const std::string& uri, const std::string& path, std::size_t limit,
                             const ReadBeside& read_beside) {
  if (uri.starts_with("data:")) {
    const std::size_t comma = uri.find(',');
    const bool base64 = comma != std::string::npos && std::string_view(uri).substr(0, comma).ends_with(";base64");
    std::string letters = base64 ? uri.substr(comma + 1) : "";
    letters.resize((letters.size() + 3) / 4 * 4, '=');  // some writers leave out the padding
    auto bytes = base64 ? from_base64(letters) : std::nullopt;
    if (!bytes) return fail(ErrorKind::bad_input, path + " is a data: URI with invalid base64");
    return *std::move(bytes);
  }
  const std::string relative = from_percent(uri);
  const bool has_scheme = uri.find(':') < uri.find('/');
  if (relative.empty() || relative.starts_with('/') || has_scheme || relative.find('\0') != std::string::npos) {
    return fail(ErrorKind::bad_input, path + ": expected a relative path or a data: URI");
  }
  if (const auto plain = std::filesystem::path(relative).lexically_normal(); *plain.begin() == "..")
    return fail(ErrorKind::bad_input,
                path + " leads out of the file's folder; put the file that it names beside this one");
  return read_beside(relative, limit);
}

ReadBeside files_beside(const std::filesystem::path& document) {
  return [folder = document.parent_path()](const std::string& relative, std::size_t limit) {
    return read_file_below(folder, relative, limit);
  };
}

Result<Glb> parse_gltf(std::span<const std::byte> bytes, const std::string& name, const ReadBeside& read_beside,
                       std::size_t max_json_bytes) {
  return within_memory("read " + name, [&]() -> Result<Glb> {
    Result<Glb> glb = fail(ErrorKind::bad_input, name);
    if (is_glb(bytes)) {
      glb = parse_glb(bytes, name, max_json_bytes);
    } else {
      auto json = parse_gltf_json({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name, max_json_bytes);
      if (!json) return fail(json);
      glb = Glb{.json = *std::move(json), .name = name};
    }
    if (!glb) return glb;
    if (const std::string version = glb->root()["asset"]["version"].text_or(""); !version.starts_with("2.")) {
      return glb->root()["asset"]["version"].wrong("\"2.0\"");
    }
    const JsonPlace buffers = glb->root()["buffers"];
    if (is_glb(bytes) && buffers.size() < 2 && !buffers[0]["uri"].present()) return glb;
    if (const auto assembled = Assembler(*glb, read_beside).assemble(); !assembled) return fail(assembled);
    return glb;
  });
}

}  // namespace ringdown::modal
