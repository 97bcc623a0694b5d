#include "engine/modal/bank_file.h"
#include "engine/modal/fracture/fracture.h"
#include "engine/modal/fracture/peak_stress.h"
#include "engine/modal/material_scale.h"
#include "engine/synth/mixer.h"
#include "tests/fuzz/targets.h"

#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <cstring>
#include <vector>

namespace ringdown::fuzz {
namespace {

void append(std::vector<std::byte>& to, std::uint32_t number) {
  const auto bytes = std::bit_cast<std::array<std::byte, 4>>(number);
  to.insert(to.end(), bytes.begin(), bytes.end());
}

void append_chunk(std::vector<std::byte>& to, std::uint32_t kind, Bytes content, std::byte filler) {
  append(to, static_cast<std::uint32_t>((content.size() + 3) / 4 * 4));
  append(to, kind);
  to.insert(to.end(), content.begin(), content.end());
  while (to.size() % 4 != 0) to.push_back(filler);
}

// Most mutations break the lengths of a container, and go no further. So an input that begins with '{' is taken as the
// JSON up to the first zero byte and the binary chunk after it, and gets a container that fits.
std::vector<std::byte> as_glb(Bytes file) {
  if (file.empty() || file.front() != std::byte{'{'}) return {file.begin(), file.end()};
  std::size_t json = 0;
  while (json < file.size() && file[json] != std::byte{0}) ++json;
  std::vector<std::byte> chunks;
  append_chunk(chunks, 0x4E4F534A, file.first(json), std::byte{' '});
  append_chunk(chunks, 0x004E4942, file.subspan(std::min(json + 1, file.size())), std::byte{0});
  std::vector<std::byte> glb;
  append(glb, 0x46546C67);
  append(glb, 2);
  append(glb, static_cast<std::uint32_t>(12 + chunks.size()));
  glb.insert(glb.end(), chunks.begin(), chunks.end());
  return glb;
}

bool ring(const modal::Bank& bank) {
  const auto map = std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(bank));
  synth::Mixer mixer(48000);
  expect(mixer.install(0, std::make_unique<synth::Voice>(map, modal::MaterialScale{}, 48000),
                       synth::Mixer::Install::replace),
         "a voice is installed");
  const synth::Event strike{.object = 0,
                            .verb = synth::verb::Strike{.impulse_ns = {0.1, 0.2, 0.3}, .contact_time_s = 0}};
  expect(mixer.push(synth::Producer::control, strike), "a strike is taken");
  std::array<float, 256> left{}, right{};
  mixer.render(left, right);
  for (std::size_t n = 0; n < left.size(); ++n) {
    if (!std::isfinite(left[n]) || !std::isfinite(right[n])) return false;
  }
  return true;
}

std::vector<modal::DampedMode> modes_of(const modal::Bank& bank) {
  std::vector<modal::DampedMode> modes;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) modes.push_back(modal::rescale(bank, m, {}));
  return modes;
}

// Breaks a body that was accepted: its numbers fit, or an assertion fails.
void break_up(const modal::Bank& bank, const modal::BreakPattern& pattern) {
  std::vector<modal::Piece> pieces;
  std::size_t numbers = 0;
  for (const modal::PieceBank& piece : pattern.pieces) {
    const std::size_t rows = modal::kRigidMotions + piece.bank.mode_count(), columns = piece.handover.size() / rows;
    pieces.push_back({.mass = *piece.bank.mass,
                      .modes = modes_of(piece.bank),
                      .handover = {.rows = rows, .columns = columns, .values = piece.handover},
                      .delay_s = piece.near_m / 1500});
    numbers += piece.handover.size();
  }
  if (numbers > 100'000) return;
  modal::ModalState state = modal::at_rest(modes_of(bank), *bank.mass);
  for (std::complex<double>& amplitude : state.amplitudes) amplitude = 1e-6;
  const modal::Broken broken = modal::Breaking(state.modes, state.mass, pieces, 5e-5)(state, 0);
  expect(broken.pieces.size() == pattern.pieces.size(), "every piece has a motion");
}

// Searches the stress of a body that was accepted: no point exceeds the bound.
void stress(const modal::Bank& bank) {
  const modal::StressTable& table = bank.fracture->stress;
  if (table.positions.empty() || table.stress.size() > 10'000) return;
  modal::ModalState state = modal::at_rest(modes_of(bank), *bank.mass);
  for (std::complex<double>& amplitude : state.amplitudes) amplitude = 1e-6;
  const double bound_pa = modal::stress_bound_pa(table, state, nullptr);
  const double peak_pa = modal::peak_stress(table, state, nullptr, {.instants_after = 3}).stress_pa;
  expect(std::isfinite(bound_pa) && peak_pa <= 1.02 * bound_pa, "stress is within its bound");
}

}  // namespace

void bank(Bytes file) {
  const auto bank = modal::parse_bank(as_glb(file), "bank");
  if (!bank) return expect(!bank.error().message.empty(), "a refusal has a sentence");
  expect(bank->mode_count() <= modal::kMaxModes && bank->point_count() <= modal::kMaxPoints, "a bank within limits");
  if (bank->mode_count() * bank->point_count() < 100'000)
    expect(ring(*bank), "a bank that was accepted rings in numbers");
  if (!bank->fracture) return;
  for (const modal::BreakPattern& pattern : bank->fracture->patterns) break_up(*bank, pattern);
  stress(*bank);
}

}  // namespace ringdown::fuzz
