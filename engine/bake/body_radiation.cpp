#include "engine/bake/body_radiation.h"

#include "engine/base/byte_stream.h"
#include "engine/base/content_cache.h"
#include "engine/base/range.h"
#include "engine/radiate/radiate.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

namespace ringdown::bake {
namespace {

constexpr std::string_view kKind = "radiation";
constexpr int kRadiationFormat = 4;  // of an entry; raise it also when the solver gives other results

// The radiation of one mode, free of units.
struct Answer {
  modal::FarField field;
  double error_db = 0;
  std::string doubt;
};

struct Answers {
  Vec3 origin;
  std::vector<Answer> modes;
  int largest_unknowns = 0;
};

// Nine digits: bodies of another size differ in the last ones, and must ask the same question.
std::vector<double> wavenumbers(const RadiatingBody& body, const modal::Air& air, const std::vector<HeardMode>& modes) {
  std::vector<double> found;
  for (const HeardMode& mode : modes) {
    found.push_back(to_digits(std::sqrt(mode.lambda) * body.units.length_m / air.sound_speed_m_s, 9));
  }
  return found;
}

ContentHash key_of(const RadiatingBody& body, const std::vector<double>& wavenumbers,
                   const std::vector<HeardMode>& modes) {
  constexpr double kNodeGrid = 1 << 24, kNodeOffset = 0.3819660113;  // as in ModeCache
  ContentHasher hasher;
  const mesh::TetMesh& mesh = body.unit_mesh;
  hasher.value(kRadiationFormat).value(mesh.nodes.rows()).value(mesh.elements.cols());
  hasher.values(std::span(mesh.elements.data(), static_cast<std::size_t>(mesh.elements.size())));
  std::vector<std::int64_t> grid;
  for (const double x : mesh.nodes.reshaped<Eigen::RowMajor>())
    grid.push_back(std::llround(kNodeGrid * x + kNodeOffset));
  hasher.values(std::span<const std::int64_t>(grid)).values(std::span<const double>(wavenumbers));
  if (body.modes.wet) {
    const WetEffects& wet = *body.modes.wet;
    const auto& triangles = wet.air.surface.triangles;
    hasher.values(std::span(triangles.data(), static_cast<std::size_t>(triangles.size())));
    for (const HeardMode& mode : modes) {
      const auto flow = wet.free_flow.col(mode.number);
      hasher.values(std::span(flow.data(), static_cast<std::size_t>(flow.size())));
    }
  }
  for (const HeardMode& mode : modes) {
    const auto shape = body.modes.shapes.col(mode.number);
    hasher.values(std::span(shape.data(), static_cast<std::size_t>(shape.size())));
  }
  return hasher.hash();
}

std::string packed(const Answers& answers) {
  ByteWriter out;
  out.put(answers.origin).put(answers.largest_unknowns);
  out.put(static_cast<std::uint64_t>(answers.modes.size()));
  for (const Answer& mode : answers.modes) {
    out.put(mode.field.wavenumber_rad_m).put(mode.error_db);
    out.put_list(std::span<const modal::FarField::Term>(mode.field.terms));
    out.put_list(std::span<const modal::FarField::Level>(mode.field.levels));
    out.put_list(std::span<const char>(mode.doubt));
  }
  return out.bytes();
}

bool is_sound(const Answer& mode) {
  const auto finite = [](const modal::FarField::Term& term) {
    return std::isfinite(term.value.real()) && std::isfinite(term.value.imag());
  };
  return mode.field.wavenumber_rad_m > 0 && mode.error_db >= 0 && std::ranges::all_of(mode.field.terms, finite);
}

std::optional<Answers> unpacked(std::string_view bytes, std::size_t modes) {
  ByteReader in(bytes);
  Answers answers;
  std::uint64_t count = 0;
  if (!in.get(answers.origin) || !in.get(answers.largest_unknowns) || !in.get(count) || count != modes)
    return std::nullopt;
  for (std::size_t m = 0; m < modes; ++m) {
    Answer mode;
    std::vector<char> doubt;
    if (!in.get(mode.field.wavenumber_rad_m) || !in.get(mode.error_db) || !in.get_list(mode.field.terms) ||
        !in.get_list(mode.field.levels) || !in.get_list(doubt) || !is_sound(mode)) {
      return std::nullopt;
    }
    mode.doubt.assign(doubt.begin(), doubt.end());
    answers.modes.push_back(std::move(mode));
  }
  if (!in.finished()) return std::nullopt;
  return answers;
}

mesh::Points surface_nodes(const RadiatingBody& body) {
  mesh::Points nodes(static_cast<Eigen::Index>(body.surface.nodes.size()), 3);
  for (Eigen::Index p = 0; p < nodes.rows(); ++p) nodes.row(p) = body.unit_mesh.nodes.row(body.surface.nodes[p]);
  return nodes;
}

// The surface that the air touches: the dry skin, and the free surfaces of liquids.
radiate::Body above_liquid(radiate::Body body, const WetEffects& wet, const std::vector<HeardMode>& modes) {
  body.surface = wet.air.surface;
  const auto dry = static_cast<Eigen::Index>(wet.air.dry.size()), free = wet.free_areas.size();
  radiate::FlowSamples above;
  above.positions.resize(dry + free, 3);
  above.normals.resize(dry + free, 3);
  above.areas.resize(dry + free);
  above.flow.resize(dry + free, static_cast<Eigen::Index>(modes.size()));
  for (Eigen::Index i = 0; i < dry; ++i) {
    const Eigen::Index s = wet.air.dry[i];
    above.positions.row(i) = body.flow.positions.row(s);
    above.normals.row(i) = body.flow.normals.row(s);
    above.areas[i] = body.flow.areas[s];
    above.flow.row(i) = body.flow.flow.row(s);
  }
  if (free > 0) {
    above.positions.bottomRows(free) = wet.free_at;
    above.normals.bottomRows(free) = wet.free_normals;
    above.areas.tail(free) = wet.free_areas;
    for (std::size_t m = 0; m < modes.size(); ++m)
      above.flow.col(static_cast<Eigen::Index>(m)).tail(free) = wet.free_flow.col(modes[m].number).cast<float>();
  }
  body.flow = std::move(above);
  return body;
}

}  // namespace

// Flat triangles, and what each mode pushes through its curved faces.
radiate::Body radiating_surface(const RadiatingBody& body, const std::vector<double>& wavenumbers,
                                const std::vector<HeardMode>& modes) {
  radiate::Body vibrating;
  const mesh::Points nodes = surface_nodes(body);
  vibrating.surface.nodes = nodes;
  vibrating.surface.triangles.resize(static_cast<Eigen::Index>(body.surface.triangles.size()), 3);
  for (std::size_t t = 0; t < body.surface.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      vibrating.surface.triangles(static_cast<Eigen::Index>(t), i) =
          static_cast<std::int32_t>(body.surface.triangles[t][static_cast<std::size_t>(i)]);
    }
  }
  const mesh::SurfaceQuadrature samples = mesh::flow_quadrature_of(body.surface, body.unit_mesh);
  radiate::FlowSamples& flow = vibrating.flow;
  flow.positions = samples.interpolation * nodes;
  flow.normals = samples.normals;
  flow.areas = samples.areas;
  flow.flow.resize(samples.areas.size(), static_cast<Eigen::Index>(modes.size()));
  using Components = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>;
  for (std::size_t m = 0; m < modes.size(); ++m) {
    const Components shape(body.modes.shapes.col(modes[m].number).data(), nodes.rows(), 3);
    const Eigen::VectorXd along = (samples.interpolation * shape).cwiseProduct(samples.normals).rowwise().sum();
    flow.flow.col(static_cast<Eigen::Index>(m)) = along.cwiseProduct(samples.areas).cast<float>();
  }
  if (body.modes.wet) vibrating = above_liquid(std::move(vibrating), *body.modes.wet, modes);
  const modal::Air air;
  for (const double k : wavenumbers) {
    vibrating.frequency_hz.push_back(modal::rad_per_s_to_hz(k * air.sound_speed_m_s));
  }
  return vibrating;
}

namespace {

Result<Answers> solve_radiation(const RadiatingBody& body, const std::vector<double>& wavenumbers,
                                const std::vector<HeardMode>& modes, const Progress& progress) {
  const radiate::Options options{
      .progress = [&](std::string_view, double fraction) { return !progress || progress("radiation", fraction); }};
  Result<radiate::Radiation> radiation = radiate::solve(radiating_surface(body, wavenumbers, modes), {}, options);
  if (!radiation) return fail(radiation);
  Answers answers{.origin = radiation->maps.origin_m, .largest_unknowns = radiation->largest_unknowns};
  for (std::size_t m = 0; m < modes.size(); ++m) {
    answers.modes.push_back({.field = std::move(radiation->maps.modes[m]),
                             .error_db = radiation->modes[m].error_db,
                             .doubt = std::move(radiation->modes[m].reason)});
  }
  return answers;
}

// The mode's own far field, with the sign that its shape has in a bank.
modal::FarField own_field(const modal::FarField& field, const BodyUnits& units, double sign) {
  modal::FarField own = field;
  own.wavenumber_rad_m /= units.length_m;
  const double scale = std::sqrt(units.length_m / units.density_kg_m3);
  for (modal::FarField::Term& term : own.terms) term.value *= static_cast<float>(sign * scale);
  for (modal::FarField::Level& level : own.levels) {
    level.wavenumber_rad_m = static_cast<float>(level.wavenumber_rad_m / units.length_m);
    level.rms = static_cast<float>(level.rms * scale);
  }
  return own;
}

}  // namespace

Result<Vec3> find_radiation(const RadiatingBody& body, const modal::Air& air, const std::filesystem::path& cache,
                            std::vector<HeardMode>& modes, RadiationReport& report, const Progress& progress) {
  if (progress && !progress("radiation", 0)) return fail_cancelled();
  const std::vector<double> asked = wavenumbers(body, air, modes);
  std::optional<Answers> answers;
  std::optional<ContentHash> key;
  const ContentCache kept(cache);
  if (!cache.empty()) {
    key = key_of(body, asked, modes);
    if (const auto bytes = kept.find(kKind, *key)) answers = unpacked(*bytes, modes.size());
    report.from_cache = answers.has_value();
  }
  if (!answers) {
    Result<Answers> solved = solve_radiation(body, asked, modes, progress);
    if (!solved) return fail(solved);
    answers = std::move(*solved);
    if (key) {
      if (const auto stored = kept.store(kKind, *key, packed(*answers)); !stored)
        report.cache_trouble = stored.error().message;
    }
  }
  report.largest_unknowns = answers->largest_unknowns;
  for (std::size_t m = 0; m < modes.size(); ++m) {
    Answer& answer = answers->modes[m];
    modes[m].field = own_field(answer.field, body.units, sign_of(body.modes.shapes.col(modes[m].number)));
    modes[m].radiation_error_db = answer.error_db;
    modes[m].radiation_doubt = std::move(answer.doubt);
  }
  return body.units.length_m * answers->origin;
}

}  // namespace ringdown::bake
