// Fetches the bank of one object from the daemon, piece by piece, and parses it without making the window wait.
//
//   BankTransfer transfer({"bell", 1, 299292, "5417..."});
//   for (auto& request : transfer.wants(now_s)) send(request);     // at every frame
//   transfer.take(piece);                                          // for every /bank.reply of that object
//   if (auto outcome = transfer.outcome()) ...                     // the bank, or why there is none
//
// A few pieces are requested at a time, and again if they do not arrive. The transfer's own thread parses the finished
// file. [one thread: the window's]
#pragma once

#include "engine/base/result.h"
#include "engine/modal/bank.h"
#include "protocol/reply.h"
#include "protocol/request.h"

#include <cstddef>
#include <cstdint>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::viewer {

// A bank as the window needs it: immutable, and shared by all objects that play it.
struct KnownBank {
  modal::Bank bank;
  std::vector<std::uint32_t> by_frequency;  // the bank's mode of each rank; rank 0 has the lowest frequency
};

std::shared_ptr<const KnownBank> known(modal::Bank bank);

class BankTransfer {
 public:
  static constexpr std::size_t kMaxBytes = std::size_t{64} << 20;  // a larger bank file is not fetched
  static constexpr std::size_t kMaxOutstanding = 8;                // pieces requested at a time
  static constexpr double kPatience_s = 0.5;                       // time after which a piece is requested again

  struct Subject {
    std::string object;
    std::int32_t version = 0;  // version of its bank
    std::int32_t bytes = 0;
    std::string content;                    // hash of the file (ContentHash)
    std::optional<std::size_t> model = {};  // the model of the file that is the bank; nothing: the first
    double scale = 1;                       // of the model's points (modal::BankPath)
    friend bool operator==(const Subject&, const Subject&) = default;
  };

  // A subject that is empty or too large allocates nothing; the outcome is then an error.
  explicit BankTransfer(Subject subject);

  using File = std::shared_ptr<const std::vector<std::byte>>;
  // A bank of a file that has been fetched before.
  BankTransfer(Subject subject, File file);

  // The whole file; null until it has arrived.
  [[nodiscard]] const File& file() const { return whole_; }

  [[nodiscard]] const Subject& subject() const { return subject_; }
  [[nodiscard]] std::vector<protocol::Request> wants(double now_s);

  // Takes one piece. Pieces of another object, version or size, and pieces that were not requested, are ignored. If the
  // pieces do not have the subject's hash, because the file changed meanwhile, the outcome is an error.
  void take(const protocol::BankReply& piece);

  // Ends the transfer with the sentence that the daemon sent instead of a piece.
  void refuse(std::string sentence);
  [[nodiscard]] bool refused() const { return refused_; }

  [[nodiscard]] double progress() const;  // share of bytes received, 0 to 1

  using Outcome = Result<std::shared_ptr<const KnownBank>>;
  // Returns nothing while pieces are missing or the bank is being parsed.
  [[nodiscard]] std::optional<Outcome> outcome();

 private:
  Subject subject_;
  File whole_;
  std::vector<std::byte> file_;
  std::map<std::uint32_t, double> asked_at_s_;  // time of the last request, by offset
  std::uint32_t next_offset_ = 0;               // offset of the first piece that has not been requested yet
  std::size_t received_bytes_ = 0;
  std::optional<Error> fault_;
  bool refused_ = false;
  std::future<Outcome> reading_;
};

}  // namespace ringdown::viewer
