#include "clients/viewer/link/bank_fetcher.h"

#include "engine/base/formatted.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/fracture/fracture.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace ringdown::viewer {
namespace {

constexpr double kRetry_s = 5;  // after the daemon refused a bank

KnownObject* next_to_fetch(KnownObjects& objects, const std::string& chosen, double now_s) {
  const auto lacks_bank = [now_s](const KnownObject& object) {
    return !object.bank && (object.bank_fault.empty() || (object.bank_retry_at_s && now_s > *object.bank_retry_at_s));
  };
  auto& all = objects.all();
  const auto first = all.find(chosen);
  if (first != all.end() && lacks_bank(first->second)) return &first->second;
  const auto found = std::ranges::find_if(all, [&](const auto& known) { return lacks_bank(known.second); });
  return found == all.end() ? nullptr : &found->second;
}

std::size_t bytes_held(const KnownObjects& objects) {
  std::map<const KnownBank*, std::size_t> bytes;
  for (const auto& [name, object] : objects.all()) {
    if (object.bank) bytes[object.bank.get()] = static_cast<std::size_t>(object.bank_bytes);
  }
  return std::accumulate(bytes.begin(), bytes.end(), std::size_t{0},
                         [](std::size_t sum, const auto& bank) { return sum + bank.second; });
}

}  // namespace

void BankFetcher::take(const protocol::BankReply& piece) {
  if (transfer_) transfer_->take(piece);
}

void BankFetcher::refuse(const std::string& object, const std::string& sentence) {
  if (transfer_ && transfer_->subject().object == object) transfer_->refuse(sentence);
}

void BankFetcher::add_requests(KnownObjects& objects, const std::string& chosen, double now_s, Requests& requests) {
  finish_transfer(objects, now_s);
  share_banks(objects);
  if (!transfer_) begin_transfer(objects, chosen, now_s);
  if (!transfer_) return;
  for (auto& request : transfer_->wants(now_s)) requests.push_back(std::move(request));
}

void BankFetcher::begin_transfer(KnownObjects& objects, const std::string& chosen, double now_s) {
  KnownObject* object = next_to_fetch(objects, chosen, now_s);
  if (!object) return;
  if (bytes_held(objects) + static_cast<std::size_t>(std::max(0, object->bank_bytes)) > max_bytes_) {
    object->bank_fault = formatted(
        "the bank of {} is not fetched, because the banks of all objects together would have more than {} bytes",
        object->name, max_bytes_);
    object->bank_retry_at_s = now_s + kRetry_s;
    return;
  }
  const auto [content, model, scale] = key_of(*object);
  BankTransfer::Subject subject{object->name, object->version, object->bank_bytes, content, model, scale};
  const auto file = files_.find(object->bank_content);
  if (file != files_.end()) {
    transfer_.emplace(std::move(subject), file->second);
  } else {
    transfer_.emplace(std::move(subject));
  }
}

BankFetcher::Key BankFetcher::key_of(const KnownObject& object) {
  const modal::ModelChoice model = modal::split_bank_path(object.bank_path).model;
  // A piece without modes is sent as a file of its own.
  return {object.bank_content, model.piece ? std::nullopt : model.number, model.scale};
}

// Ends the transfer when its bank is complete or at fault, or when the object no longer needs it.
void BankFetcher::finish_transfer(KnownObjects& objects, double now_s) {
  if (!transfer_) return;
  const auto found = objects.all().find(transfer_->subject().object);
  const bool wanted = found != objects.all().end() && !found->second.bank &&
                      found->second.version == transfer_->subject().version &&
                      found->second.bank_bytes == transfer_->subject().bytes;
  if (!wanted) return transfer_.reset();
  KnownObject& object = found->second;
  object.bank_progress = transfer_->progress();
  auto outcome = transfer_->outcome();
  if (!outcome) return;
  if (*outcome) {
    object.bank = std::move(**outcome);
    object.bank_fault.clear();
    banks_.insert_or_assign(key_of(object), object.bank);
    files_.insert_or_assign(object.bank_content, transfer_->file());
  } else {
    object.bank_fault = outcome->error().message;
    if (transfer_->refused()) object.bank_retry_at_s = now_s + kRetry_s;
  }
  transfer_.reset();
}

// Returns a bank that an object has, or that of a piece whose body an object has; null if there is none.
std::shared_ptr<const KnownBank> BankFetcher::find(const Key& key) {
  const auto& [content, model, scale] = key;
  if (const auto found = banks_.find(key); found != banks_.end()) return found->second.lock();
  const auto whole = banks_.find({content, std::nullopt, 1});
  if (!model || scale != 1 || whole == banks_.end()) return nullptr;
  const std::shared_ptr<const KnownBank> body = whole->second.lock();
  if (!body || !body->bank.fracture) return nullptr;
  for (const modal::BreakPattern& pattern : body->bank.fracture->patterns) {
    for (const modal::PieceBank& piece : pattern.pieces) {
      if (piece.model != *model || piece.bank.mode_count() == 0) continue;
      auto bank = known(piece.bank);
      banks_.insert_or_assign(key, bank);
      return bank;
    }
  }
  return nullptr;
}

// Shares a bank of one object with the others that play the same model of its file.
void BankFetcher::share_banks(KnownObjects& objects) {
  std::erase_if(banks_, [](const auto& bank) { return bank.second.expired(); });
  for (auto& [name, object] : objects.all()) {
    if (object.bank) continue;
    auto bank = find(key_of(object));
    if (!bank) continue;
    object.bank = std::move(bank);
    object.bank_fault.clear();
  }
  std::erase_if(files_, [&](const auto& file) {
    return std::ranges::none_of(objects.all(), [&](const auto& known) {
      return !known.second.bank && known.second.bank_fault.empty() && known.second.bank_content == file.first;
    });
  });
}

}  // namespace ringdown::viewer
