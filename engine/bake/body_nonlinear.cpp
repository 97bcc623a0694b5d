#include "engine/bake/body_nonlinear.h"

#include "engine/base/byte_stream.h"
#include "engine/base/range.h"

#include <algorithm>
#include <cmath>

namespace ringdown::bake {
namespace {

constexpr std::string_view kNonlinearKind = "nonlinear";
constexpr int kNonlinearFormat = 3;  // raise it also when find_nonlinear() gives other results
constexpr double kMaxCarried = 0.25;

template <class Matrix>
std::span<const double> all_of(const Matrix& matrix) {
  return {matrix.data(), static_cast<std::size_t>(matrix.size())};
}

int available(const BodyModes& modes, int count) { return std::min(count, static_cast<int>(modes.lambda.size())); }

ContentHash terms_key(const BodyModes& modes, int count) {
  ContentHasher hasher;
  hasher.value(kNonlinearFormat).value(count);
  hasher.values(all_of(modes.lambda.head(count).eval()));
  hasher.values(all_of(modes.shapes.leftCols(count).eval()));
  return hasher.hash();
}

}  // namespace

std::optional<NonlinearModes> NonlinearCache::find(const BodyModes& modes, int wanted) const {
  const int count = available(modes, wanted);
  const auto kept = cache_.find(kNonlinearKind, terms_key(modes, count));
  if (!kept) return std::nullopt;
  ByteReader in(*kept);
  std::vector<double> bending, curving;
  NonlinearModes terms;
  if (!in.get_list(bending) || !in.get_list(curving) || !in.get(terms.residual) || !in.get(terms.membrane_share) ||
      !in.get(terms.carried_share) || !in.finished()) {
    return std::nullopt;
  }
  const std::size_t pairs = static_cast<std::size_t>(count) * (static_cast<std::size_t>(count) + 1) / 2;
  const std::size_t functions = curving.size() / static_cast<std::size_t>(count);
  if (functions == 0 || curving.size() != functions * static_cast<std::size_t>(count) ||
      bending.size() != functions * pairs) {
    return std::nullopt;
  }
  const auto rows = static_cast<Eigen::Index>(functions);
  terms.bending = Eigen::Map<const Eigen::MatrixXd>(bending.data(), rows, static_cast<Eigen::Index>(pairs));
  terms.curving = Eigen::Map<const Eigen::MatrixXd>(curving.data(), rows, count);
  return terms;
}

Result<void> NonlinearCache::store(const BodyModes& modes, const NonlinearModes& terms) const {
  ByteWriter out;
  out.put_list(all_of(terms.bending)).put_list(all_of(terms.curving));
  out.put(terms.residual).put(terms.membrane_share).put(terms.carried_share);
  return cache_.store(kNonlinearKind, terms_key(modes, static_cast<int>(terms.modes())), out.bytes());
}

Result<void> check_shallow(const NonlinearModes& terms, const std::string& name) {
  if (terms.carried_share <= kMaxCarried) return {};
  return fail(ErrorKind::bad_input,
              "{} is too deep a shell for nonlinear modes: the stress of its own bending changes the terms of its "
              "stretching by {}, and more than {} is not modelled; bake it without --nonlinear",
              name, as_percent(terms.carried_share), as_percent(kMaxCarried));
}

std::optional<modal::NonlinearTerms> bank_terms(const NonlinearModes& terms, const std::vector<HeardMode>& kept,
                                                const BodyModes& modes, const BodyUnits& units, double thickness_m) {
  struct KeptMode {
    Eigen::Index number;
    std::uint32_t mode;
    double sign;
  };
  std::vector<KeptMode> places;
  for (std::size_t m = 0; m < kept.size(); ++m) {
    const Eigen::Index number = kept[m].number;
    if (number >= terms.modes()) continue;
    places.push_back({number, static_cast<std::uint32_t>(m), sign_of(modes.shapes.col(number))});
  }
  if (places.empty()) return std::nullopt;
  std::sort(places.begin(), places.end(), [](const KeptMode& a, const KeptMode& b) { return a.number < b.number; });
  const double root = std::sqrt(units.modulus_pa), length = units.length_m, density = units.density_kg_m3;
  const double h_unit = root / (density * std::pow(length, 3.5)), g_unit = root / (std::sqrt(density) * length);

  modal::NonlinearTerms result{.thickness_m = thickness_m, .residual = terms.residual};
  for (const KeptMode& place : places) result.modes.push_back(place.mode);
  for (Eigen::Index k = 0; k < terms.functions(); ++k) {
    const Eigen::MatrixXd h = terms.matrix(k);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const KeptMode& a = places[i];
      result.curving.push_back(static_cast<float>(g_unit * a.sign * terms.curving(k, a.number)));
      for (std::size_t j = 0; j <= i; ++j) {
        const KeptMode& b = places[j];
        result.bending.push_back(static_cast<float>(h_unit * a.sign * b.sign * h(a.number, b.number)));
      }
    }
  }
  return result;
}

}  // namespace ringdown::bake
