#include "tests/hostile/banks.h"

#include "engine/modal/bank_file.h"
#include "tests/support/synthetic_bank.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

namespace ringdown::hostile {
namespace {

double omega_of(const modal::Bank& bank, std::size_t mode) { return 2 * std::numbers::pi * bank.frequency_hz[mode]; }

double largest_shape(const modal::Bank& bank, std::size_t mode) {
  double largest = 0;
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    for (const float x : bank.shape(mode, p)) largest = std::max(largest, std::abs(double{x}));
  }
  return std::max(largest, 1e-9);
}

modal::NonlinearTerms terms_of(const modal::Bank& bank, Random& random, double stretching) {
  constexpr std::size_t kFunctions = 3;
  modal::NonlinearTerms terms{.thickness_m = 1e-3};
  for (std::size_t m = 0; m < bank.mode_count(); ++m) terms.modes.push_back(static_cast<std::uint32_t>(m));
  terms.coupled = static_cast<std::uint32_t>(bank.mode_count());
  for (std::size_t k = 0; k < kFunctions; ++k) {
    for (std::size_t i = 0; i < bank.mode_count(); ++i) {
      terms.curving.push_back(static_cast<float>(0.3 * random.uniform(-1, 1) * omega_of(bank, i)));
      for (std::size_t j = 0; j <= i; ++j) {
        const double scale = std::sqrt(omega_of(bank, i) * largest_shape(bank, i)) *
                             std::sqrt(omega_of(bank, j) * largest_shape(bank, j)) / terms.thickness_m;
        terms.bending.push_back(static_cast<float>(stretching * random.uniform(-0.5, 0.5) * scale));
      }
    }
  }
  return terms;
}

// One of a list's numbers becomes extreme, or all are multiplied.
template <class Number>
void spoil(std::vector<Number>& numbers, Random& random) {
  if (numbers.empty()) return;
  if (random.one_in(2)) {
    numbers[random.below(numbers.size())] = static_cast<Number>(std::clamp(random.extreme(), -3e38, 3e38));
  } else {
    const double factor = random.power(-40, 40);
    for (Number& number : numbers)
      number = static_cast<Number>(std::clamp(factor * static_cast<double>(number), -3e38, 3e38));
  }
}

void spoil(std::vector<modal::Vec3f>& vectors, Random& random) {
  std::vector<float> numbers(3 * vectors.size());
  std::memcpy(numbers.data(), vectors.data(), numbers.size() * sizeof(float));
  spoil(numbers, random);
  std::memcpy(vectors.data(), numbers.data(), numbers.size() * sizeof(float));
}

double any_size(Random& random) { return random.one_in(3) ? std::abs(random.extreme()) : random.power(-30, 30); }

void spoil_a_part(modal::Bank& bank, Random& random) {
  switch (random.below(13)) {
    case 0:
      return spoil(bank.frequency_hz, random);
    case 1:
      return spoil(bank.decay_per_s, random);
    case 2:
      return spoil(bank.shapes, random);
    case 3:
      return spoil(bank.positions, random);
    case 4:
      bank.gain = any_size(random);
      return;
    case 5:
      bank.mass = modal::MassProperties{.mass_kg = any_size(random),
                                        .inertia_kg_m2 = {any_size(random), any_size(random), any_size(random)}};
      return;
    case 6:
      bank.material = modal::Material{.name = "m",
                                      .youngs_modulus_pa = any_size(random),
                                      .poisson_ratio = random.uniform(-1, 0.5),
                                      .density_kg_m3 = any_size(random),
                                      .damping = {any_size(random), any_size(random)}};
      return;
    case 7:
    case 8:
      if (bank.nonlinear) spoil(bank.nonlinear->bending, random);
      return;
    case 9:
      if (bank.nonlinear) spoil(bank.nonlinear->curving, random);
      return;
    case 10:
      if (bank.nonlinear) bank.nonlinear->thickness_m = any_size(random);
      return;
    case 11:
      if (bank.radiation) bank.radiation->air = {any_size(random), any_size(random)};
      return;
    default:
      if (!bank.radiation) return;
      modal::FarField& field = bank.radiation->maps.modes[random.below(bank.radiation->maps.modes.size())];
      field.wavenumber_rad_m = any_size(random);
      for (modal::FarField::Level& level : field.levels)
        level.rms = static_cast<float>(std::min(any_size(random), 3e38));
  }
}

void append(std::string& to, std::uint32_t number) {
  const auto bytes = std::bit_cast<std::array<char, 4>>(number);
  to.append(bytes.data(), bytes.size());
}

std::uint32_t number_at(const std::string& bytes, std::size_t at) {
  std::uint32_t number = 0;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

// Gives the file's node a scale.
std::string with_node_scale(const std::string& glb, double scale) {
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  const std::size_t length = number_at(glb, kHeader);
  std::string json = glb.substr(kHeader + kChunkHeader, length);
  const std::string binary = glb.substr(kHeader + kChunkHeader + length), mesh = "\"mesh\":0,";
  const std::size_t at = json.find(mesh);
  if (at == std::string::npos) return glb;
  const std::string number = std::to_string(scale);
  json.insert(at, "\"scale\":[" + number + "," + number + "," + number + "],");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string changed = glb.substr(0, 8);
  append(changed, static_cast<std::uint32_t>(kHeader + kChunkHeader + json.size() + binary.size()));
  append(changed, static_cast<std::uint32_t>(json.size()));
  return changed + glb.substr(kHeader + 4, 4) + json + binary;
}

}  // namespace

modal::Bank bending_bank(Random& random, std::size_t modes, double stretching) {
  modal::Bank bank = test::random_bank(static_cast<std::uint32_t>(random.engine()()), modes, 12);
  bank.nonlinear = terms_of(bank, random, stretching);
  bank.mass = modal::MassProperties{.mass_kg = 1, .inertia_kg_m2 = {1e-3, 1e-3, 1e-3}};
  return bank;
}

std::string hostile_bank(Random& random) {
  const std::size_t modes = 1 + random.below(random.one_in(10) ? 80 : 16);
  modal::Bank bank = random.one_in(3) ? test::random_bank(static_cast<std::uint32_t>(random.engine()()), modes, 8)
                                      : bending_bank(random, modes, random.power(-3, 4));
  for (std::size_t changes = random.below(4); changes > 0; --changes) spoil_a_part(bank, random);
  const auto bytes = modal::to_glb(bank, {}, random.one_in(3) ? modal::Compression::meshopt : modal::Compression::none);
  std::string glb(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return random.one_in(4) ? with_node_scale(glb, random.power(-3.2, 3.2)) : glb;
}

}  // namespace ringdown::hostile
