#include "server/session/bank_reader.h"

#include "engine/base/file_format.h"
#include "engine/base/within_memory.h"

#include <span>
#include <utility>

namespace ringdown::session {
namespace {

// Returns a key that changes whenever the file is written again.
std::string key_of(const std::filesystem::path& path) {
  std::error_code error;
  const auto canonical = std::filesystem::weakly_canonical(path, error);
  const auto file = modal::split_bank_path(path).file;
  const auto time = std::filesystem::last_write_time(file, error).time_since_epoch().count();
  return formatted("{}@{}", canonical.string(), time);
}

}  // namespace

Result<BankFile> parse_bank_file(std::string_view bytes, const std::string& name, const modal::ModelChoice& model,
                                 const modal::ReadBeside& read_beside) {
  auto bank = modal::parse_bank(std::as_bytes(std::span(bytes)), name, model, read_beside);
  if (!bank) return fail(bank);
  return within_memory("play " + name, [&]() -> Result<BankFile> {
    return BankFile{std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(std::move(*bank))),
                    bytes.size(), hash_of(bytes)};
  });
}

std::vector<std::byte> drawn_file(const modal::Bank& bank) {
  if (bank.mode_count() > 0) return modal::to_glb(bank);
  modal::Bank drawn = bank;
  drawn.frequency_hz = {20000};
  drawn.decay_per_s = {1};
  drawn.shapes.assign(bank.positions.size(), {});
  return modal::to_glb(drawn);
}

Result<BankFile> BankReader::read(const std::filesystem::path& path) {
  const std::string key = key_of(path);
  if (const auto known = known_.find(key); known != known_.end()) {
    if (auto map = known->second.map.lock())
      return BankFile{std::move(map), known->second.bytes, known->second.content, known->second.alone};
  }
  const auto [at, model] = modal::split_bank_path(path);
  const auto bytes = roots_.read(at, modal::kMaxBankFileBytes);
  if (!bytes) return fail(bytes);
  const modal::ReadBeside beside = [this, &document = at](const std::string& relative, std::size_t limit) {
    return roots_.read_beside(document, relative, limit);
  };
  const bool in_scene = model.number || has_ending(at, ".gltf");  // whose buffers may be in other files
  auto file = parse_bank_file(*bytes, path.string(), model, in_scene ? beside : modal::ReadBeside());
  if (file && in_scene) {
    file->alone = std::make_shared<const std::vector<std::byte>>(drawn_file(file->map->bank()));
    file->bytes = file->alone->size();
    file->content = ContentHasher().bytes(*file->alone).hash();
  }
  if (file) known_[key] = {file->map, file->bytes, file->content, file->alone};
  return file;
}

void BankReader::forget_unused() {
  std::erase_if(known_, [](const auto& entry) { return entry.second.map.expired(); });
}

}  // namespace ringdown::session
