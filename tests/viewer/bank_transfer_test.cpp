// A bank fetched over a line that loses, repeats and reorders.
#include "clients/viewer/link/bank_transfer.h"
#include "engine/modal/bank_file.h"
#include "tests/viewer/preset_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <thread>

namespace ringdown::viewer {
namespace {

using namespace ringdown::test;
using Subject = BankTransfer::Subject;

std::vector<protocol::ReadBank> asked(BankTransfer& transfer, double now_s) {
  std::vector<protocol::ReadBank> questions;
  for (const auto& request : transfer.wants(now_s)) questions.push_back(request.get<protocol::ReadBank>());
  return questions;
}

BankTransfer::Outcome outcome_of(BankTransfer& transfer) {
  std::optional<BankTransfer::Outcome> outcome;
  for (int i = 0; i < 6000 && !(outcome = transfer.outcome()); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return outcome.value_or(fail(ErrorKind::bad_input, "no outcome"));
}

class Transfer : public testing::Test {
 protected:
  Transfer() : file(bytes_of(preset_bank("bronze-bell"))) {}
  Subject subject(std::int32_t version = 3) const {
    return {"bell", version, static_cast<std::int32_t>(file.size()), content_of(file)};
  }
  protocol::BankReply answer(const protocol::ReadBank& question, std::int32_t version = 3) const {
    return piece_of(file, "bell", version, question.offset, question.bytes);
  }
  wire::Blob file;
};

TEST_F(Transfer, TransferredBankIsTheOneInTheFile) {
  BankTransfer transfer(subject());
  for (double now = 0; transfer.progress() < 1; now += 0.016) {
    for (const auto& question : asked(transfer, now)) transfer.take(answer(question));
  }
  const auto outcome = outcome_of(transfer);
  ASSERT_TRUE(outcome) << outcome.error().message;
  const auto direct = modal::read_bank(preset_bank("bronze-bell"));
  EXPECT_EQ((*outcome)->bank.frequency_hz, direct->frequency_hz);
  EXPECT_EQ((*outcome)->bank.shapes, direct->shapes);
  EXPECT_EQ((*outcome)->bank.triangles, direct->triangles);
}

TEST_F(Transfer, TransferredModesAreRankedByFrequency) {
  BankTransfer transfer(subject());
  for (double now = 0; transfer.progress() < 1; now += 0.016) {
    for (const auto& question : asked(transfer, now)) transfer.take(answer(question));
  }
  const auto outcome = outcome_of(transfer);
  ASSERT_TRUE(outcome);
  const KnownBank& known = **outcome;
  ASSERT_EQ(known.by_frequency.size(), known.bank.mode_count());
  std::vector<bool> seen(known.bank.mode_count());
  for (std::size_t rank = 0; rank < known.by_frequency.size(); ++rank) {
    seen.at(known.by_frequency[rank]) = true;
    if (rank == 0) continue;
    EXPECT_GE(known.bank.frequency_hz[known.by_frequency[rank]], known.bank.frequency_hz[known.by_frequency[rank - 1]]);
  }
  EXPECT_EQ(std::ranges::count(seen, true), static_cast<std::ptrdiff_t>(seen.size()));
}

TEST_F(Transfer, BankArrivesThoughPiecesAreLostRepeatedAndReordered) {
  BankTransfer transfer(subject());
  std::mt19937 random(7);
  std::vector<protocol::BankReply> under_way;
  double now = 0;
  for (; transfer.progress() < 1 && now < 60; now += 0.1) {
    for (const auto& question : asked(transfer, now)) {
      if (random() % 3 == 0) continue;
      under_way.push_back(answer(question));
      if (random() % 4 == 0) under_way.push_back(answer(question));
    }
    std::ranges::shuffle(under_way, random);
    const std::size_t arrive = under_way.size() / 2 + under_way.size() % 2;
    for (std::size_t i = 0; i < arrive; ++i) transfer.take(under_way[i]);
    under_way.erase(under_way.begin(), under_way.begin() + static_cast<std::ptrdiff_t>(arrive));
  }
  EXPECT_EQ(transfer.progress(), 1) << "after " << now << " s";
  const auto outcome = outcome_of(transfer);
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ((*outcome)->bank.shapes, modal::read_bank(preset_bank("bronze-bell"))->shapes);
}

TEST_F(Transfer, PiecesAreRequestedAFewAtATimeAndAgainOnlyAfterAWhile) {
  BankTransfer transfer(subject());
  EXPECT_EQ(asked(transfer, 0).size(), BankTransfer::kMaxOutstanding);
  EXPECT_TRUE(asked(transfer, 0.4).empty());
  EXPECT_EQ(asked(transfer, 0.51).size(), BankTransfer::kMaxOutstanding);
  transfer.take(answer({{}, 0, protocol::kMaxBankBytes}));
  EXPECT_EQ(asked(transfer, 0.6).size(), 1u);
}

TEST_F(Transfer, PiecesOfOtherBanksAreIgnored) {
  BankTransfer transfer(subject());
  const auto questions = asked(transfer, 0);
  transfer.take(answer(questions[0], 2));
  auto reply = answer(questions[0]);
  reply.name = "gong";
  transfer.take(reply);
  reply = answer(questions[0]);
  reply.total += 1;
  transfer.take(reply);
  reply = answer(questions[0]);
  reply.bytes.pop_back();
  transfer.take(reply);
  reply = answer(questions[0]);
  reply.offset = -8192;
  transfer.take(reply);
  reply.offset = std::numeric_limits<std::int32_t>::max();
  transfer.take(reply);
  reply.offset = 17;
  transfer.take(reply);
  EXPECT_EQ(transfer.progress(), 0);
  transfer.take(answer(questions[0]));
  EXPECT_GT(transfer.progress(), 0);
}

TEST_F(Transfer, AFileThatIsNoBankEndsInASentence) {
  for (std::size_t i = 200; i < 300; ++i) file[i] = std::byte{0xff};
  BankTransfer transfer(subject());
  for (double now = 0; transfer.progress() < 1; now += 0.016) {
    for (const auto& question : asked(transfer, now)) transfer.take(answer(question));
  }
  const auto outcome = outcome_of(transfer);
  ASSERT_FALSE(outcome);
  EXPECT_NE(outcome.error().message.find("bell"), std::string::npos) << outcome.error().message;
}

TEST_F(Transfer, AFileThatChangedDuringTheTransferIsRefused) {
  const Subject wanted = subject();
  BankTransfer transfer(wanted);
  std::size_t changed = file.size();
  do {
    if (changed < file.size()) file[changed] ^= std::byte{1};
    file[--changed] ^= std::byte{1};
  } while (!modal::parse_bank(file, "one that still is a bank"));
  for (double now = 0; transfer.progress() < 1; now += 0.016) {
    for (const auto& question : asked(transfer, now)) transfer.take(answer(question));
  }
  const auto outcome = outcome_of(transfer);
  ASSERT_FALSE(outcome);
  EXPECT_NE(outcome.error().message.find("was changed"), std::string::npos) << outcome.error().message;
}

TEST_F(Transfer, BanksThatAreTooLargeOrEmptyAreNotFetched) {
  const auto max = static_cast<std::int32_t>(BankTransfer::kMaxBytes);
  for (const std::int32_t bytes : {max + 1, std::numeric_limits<std::int32_t>::max(), 0, -1}) {
    BankTransfer transfer({"bell", 1, bytes, "00"});
    EXPECT_TRUE(transfer.wants(0).empty());
    const auto outcome = transfer.outcome();
    ASSERT_TRUE(outcome && !*outcome) << bytes;
    EXPECT_NE(outcome->error().message.find("bell"), std::string::npos) << outcome->error().message;
  }
  BankTransfer largest({"bell", 1, max, "00"});
  EXPECT_FALSE(largest.outcome());
  EXPECT_EQ(largest.wants(0).size(), BankTransfer::kMaxOutstanding);
}

}  // namespace
}  // namespace ringdown::viewer
