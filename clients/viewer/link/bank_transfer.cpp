#include "clients/viewer/link/bank_transfer.h"

#include "engine/base/content_hash.h"
#include "engine/modal/bank_file.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <numeric>
#include <span>
#include <thread>
#include <utility>

namespace ringdown::viewer {
namespace {

constexpr std::uint32_t kPiece = protocol::kMaxBankBytes;

std::string name_of(const BankTransfer::Subject& subject) { return "the bank of " + subject.object; }

BankTransfer::Outcome read(std::span<const std::byte> file, const BankTransfer::Subject& subject) {
  const std::string name = name_of(subject);
  if (ContentHasher().bytes(file).hash().text() != subject.content) {
    return fail(ErrorKind::refused,
                name + " is not the one that the daemon plays: its file was changed; load it again");
  }
  Result<modal::Bank> bank = modal::parse_bank(file, name, {.number = subject.model, .scale = subject.scale});
  if (!bank) return fail(bank);
  return known(std::move(*bank));
}

// Unlike the future of std::async, this one does not wait for its thread when it is dropped.
std::future<BankTransfer::Outcome> read_apart(BankTransfer::File file, BankTransfer::Subject subject) {
  std::packaged_task<BankTransfer::Outcome()> task(
      [file = std::move(file), subject = std::move(subject)] { return read(*file, subject); });
  auto outcome = task.get_future();
  std::thread(std::move(task)).detach();
  return outcome;
}

}  // namespace

std::shared_ptr<const KnownBank> known(modal::Bank bank) {
  KnownBank made{std::move(bank), {}};
  made.by_frequency.resize(made.bank.mode_count());
  std::iota(made.by_frequency.begin(), made.by_frequency.end(), 0u);
  std::ranges::stable_sort(made.by_frequency, {}, [&](std::uint32_t mode) { return made.bank.frequency_hz[mode]; });
  return std::make_shared<const KnownBank>(std::move(made));
}

BankTransfer::BankTransfer(Subject subject) : subject_(std::move(subject)) {
  if (subject_.bytes <= 0) {
    fault_ = Error{ErrorKind::bad_input, name_of(subject_) + " is empty"};
  } else if (static_cast<std::size_t>(subject_.bytes) > kMaxBytes) {
    fault_ = Error{ErrorKind::too_large, formatted("{} has {} bytes; no more than {} are fetched to be shown",
                                                   name_of(subject_), subject_.bytes, kMaxBytes)};
  } else {
    file_.resize(static_cast<std::size_t>(subject_.bytes));
  }
}

BankTransfer::BankTransfer(Subject subject, File file)
    : subject_(std::move(subject)), whole_(std::move(file)), received_bytes_(whole_->size()) {
  reading_ = read_apart(whole_, subject_);
}

std::vector<protocol::Request> BankTransfer::wants(double now_s) {
  std::vector<protocol::Request> requests;
  const auto ask = [&](std::uint32_t offset) {
    asked_at_s_[offset] = now_s;
    requests.emplace_back(protocol::ReadBank{{subject_.object, std::nullopt}, offset, kPiece});
  };
  for (const auto& [offset, asked_at_s] : asked_at_s_) {
    if (now_s - asked_at_s > kPatience_s) ask(offset);
  }
  while (asked_at_s_.size() < kMaxOutstanding && next_offset_ < file_.size()) {
    ask(next_offset_);
    next_offset_ += kPiece;
  }
  return requests;
}

void BankTransfer::take(const protocol::BankReply& piece) {
  if (piece.name != subject_.object || piece.version != subject_.version || piece.total != subject_.bytes) return;
  if (piece.offset < 0) return;
  const auto offset = static_cast<std::uint32_t>(piece.offset);
  const auto asked = asked_at_s_.find(offset);
  if (asked == asked_at_s_.end()) return;
  if (piece.bytes.size() != std::min<std::size_t>(kPiece, file_.size() - offset)) return;
  std::ranges::copy(piece.bytes, file_.begin() + offset);
  asked_at_s_.erase(asked);
  received_bytes_ += piece.bytes.size();
  if (received_bytes_ < file_.size()) return;
  whole_ = std::make_shared<const std::vector<std::byte>>(std::exchange(file_, {}));
  reading_ = read_apart(whole_, subject_);
}

void BankTransfer::refuse(std::string sentence) {
  fault_ = Error{ErrorKind::refused, std::move(sentence)};
  refused_ = true;
}

double BankTransfer::progress() const {
  return subject_.bytes > 0 ? static_cast<double>(received_bytes_) / subject_.bytes : 0;
}

std::optional<BankTransfer::Outcome> BankTransfer::outcome() {
  if (fault_) return fail(*fault_);
  if (!reading_.valid() || reading_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  return reading_.get();
}

}  // namespace ringdown::viewer
