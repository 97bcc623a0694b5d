// Banks on disk: binary glTF 2.0 with the extension KHR_audio_rigid_bodies (docs/reference/bank-format.md). [worker]
#pragma once

#include "engine/base/range.h"
#include "engine/base/result.h"
#include "engine/gltf/read_beside.h"
#include "engine/modal/bank.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::modal {

// Limits that are checked before anything is allocated. A compressed array counts by its unpacked size, which may be
// at most kMaxBankFileBytes and at most kMaxMeshoptRatio times the bytes in the file (meshopt_codec.h).
inline constexpr std::size_t kMaxBankFileBytes = std::size_t{1} << 30;  // bytes
inline constexpr std::size_t kMaxModes = 16384;
inline constexpr std::size_t kMaxPoints = std::size_t{1} << 20;

// Reads a bank that Ringdown or another tool wrote. Every size, index and number is checked first; an error names the
// file, the field and the expected value.
Result<Bank> read_bank(const std::filesystem::path& path);

// Which of a file's models is read. `scale` moves its points alone: it is the scale of a node of a scene, for which the
// model was made, so pitch, shapes and mass are those in the file. Without a number the file's first node with a model
// decides, with the node's gain and with its scale as a change of the object's size. With a `piece`, the number is that
// of a pattern of that body, and the bank is that piece of it, at the body's gain; it may have no mode.
struct ModelChoice {
  std::optional<std::size_t> number;
  double scale = 1;  // from kBankPathScale
  std::optional<std::size_t> piece = {};
};
inline constexpr Range kBankPathScale{1e-6, 1e6};

// A path that may choose a model: "room.glb#2" is model 2 of room.glb, "room.glb#2@0.5" that model with its points half
// as far from the frame's origin, and "glass.glb#0.5" piece 5 of the first pattern of the body in glass.glb.
struct BankPath {
  std::filesystem::path file;
  ModelChoice model;
};
BankPath split_bank_path(const std::filesystem::path& path);
std::filesystem::path bank_path(const BankPath& path);

// Reads a bank from memory. `name` only stands in error messages where the path would. `read_beside` reads a .gltf's
// other files; without it there must be none.
Result<Bank> parse_bank(std::span<const std::byte> gltf, const std::string& name, const ModelChoice& model = {},
                        const ReadBeside& read_beside = {});

// The coding of arrays in the file. `meshopt` (EXT_meshopt_compression) takes about a third of the bytes, and a reader
// must know the extension. Compression rounds shapes: each mode's numbers become whole multiples of a power of two
// between 1/128 and 1/64 of their rms, an rms error of 0.2 to 0.5 %. All other numbers are exact, and compressing a
// bank again changes nothing.
enum class Compression { none, meshopt };

// Writes atomically: a reader sees the old file or the new one. `input_hash`, which names everything that the bank was
// made from, is stored in the file unless it is empty.
Result<void> write_bank(const Bank& bank, const std::filesystem::path& path, std::string_view input_hash = {},
                        Compression compression = Compression::none);

// Returns the bytes that write_bank() would write.
std::vector<std::byte> to_glb(const Bank& bank, std::string_view input_hash = {},
                              Compression compression = Compression::none);

// Returns the input_hash stored in the file; nothing if the file is missing, truncated or not glTF, or has no hash.
// Takes milliseconds.
std::optional<std::string> read_input_hash(const std::filesystem::path& path);

}  // namespace ringdown::modal
