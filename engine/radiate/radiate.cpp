#include "engine/radiate/radiate.h"

#include "engine/base/in_parallel.h"
#include "engine/radiate/far_field.h"
#include "engine/radiate/skin.h"
#include "engine/radiate/wave_solver.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>

namespace ringdown::radiate {
namespace {

constexpr double kSameWave = 0.004;   // modes whose wavenumbers differ by less are solved at their mean
constexpr int kFewestUnknowns = 500;  // a skin of fewer does not show the body's form
constexpr int kMostForShapes = 3000;  // unknowns of a skin that a pattern asks for and no wave in the air
constexpr double kCoarser = std::numbers::sqrt2;
constexpr double kChunkWidth = 0.7;  // of wavenumbers times the body's radius
constexpr int kMostSteps = 60;       // of an iteration with the elimination of a wavenumber close by
constexpr int kMostLoneSteps = 200;
constexpr Eigen::Index kMostLoneColumns = 24;
constexpr int kFewestLone = 4000;  // unknowns of a lone job that is iterated without elimination

// One wavenumber on one skin, and what it is solved for.
//
// Jobs of one skin whose wavenumbers lie close form a chunk: one matrix is eliminated, and the others are solved by
// iterating with it.
struct Job {
  enum class Purpose { fields, coarser, levels } purpose = Purpose::fields;
  double wavenumber = 0;
  int skin = 0;
  std::vector<int> modes;
};

using Chunk = std::vector<Job>;

// What jobs find, each for modes or wavenumbers of its own.
struct Findings {
  std::vector<modal::FarField> fields;              // M
  std::vector<double> rms, coarser_rms, source_db;  // M
  std::vector<std::vector<modal::FarField::Level>> levels;
};

class Solver {
 public:
  Solver(const Original& original, const modal::Air& air, const Options& options)
      : original_(original),
        air_(air),
        options_(options),
        modes_(static_cast<int>(original.body->frequency_hz.size())) {
    origin_ =
        (original.panels->nodes.colwise().maxCoeff() + original.panels->nodes.colwise().minCoeff()).transpose() / 2;
    radius_ = (original.panels->nodes.rowwise() - origin_.transpose()).rowwise().norm().maxCoeff();
    found_.fields.resize(modes_);
    found_.levels.resize(modes_);
    found_.rms.resize(modes_, 0);
    found_.coarser_rms.resize(modes_, 0);
    found_.source_db.resize(modes_, 0);
    places_ = inner_places(original);
  }

  Result<Radiation> solve() {
    choose_sizes();
    if (const auto made = choose_skins(); !made) return fail(made.error());
    plan_jobs();
    if (const auto done = run_jobs(); !done) return fail(done.error());
    return report();
  }

 private:
  [[nodiscard]] double wavenumber(int mode) const {
    return 2 * std::numbers::pi * original_.body->frequency_hz[mode] / air_.sound_speed_m_s;
  }
  [[nodiscard]] double side_for_wave(double k) const { return 2 * std::numbers::pi / (k * options_.panels_per_wave); }

  // Skins have sides of finest_side_ times powers of the square root of 2.
  void choose_sizes() {
    const auto side_for = [&](double nodes) {
      return std::sqrt(original_.panels->area() / nodes * 2 / std::sqrt(3.0));
    };
    coarsest_side_ = side_for(kFewestUnknowns);
    const double highest = wavenumber(
        static_cast<int>(std::max_element(original_.body->frequency_hz.begin(), original_.body->frequency_hz.end()) -
                         original_.body->frequency_hz.begin()));
    finest_side_ = std::max(side_for(options_.most_unknowns), std::min(side_for_wave(highest), coarsest_side_));
    const double finest_for_shapes = side_for(std::min(options_.most_unknowns, kMostForShapes));
    while (finest_side_ / kCoarser > finest_for_shapes) finest_side_ /= kCoarser;  // for patterns shorter than the wave
    const int count =
        1 + static_cast<int>(std::ceil(std::log(coarsest_side_ / finest_side_) / std::log(kCoarser) - 1e-9));
    skins_.resize(count + 1);  // one more to compare the coarsest with
  }
  [[nodiscard]] int skin_for(double side) const {
    const double steps = std::log(std::max(side, finest_side_) / finest_side_) / std::log(kCoarser);
    return std::min(static_cast<int>(steps + 1e-9), static_cast<int>(skins_.size()) - 2);
  }
  Result<void> make_skin(int number) {
    if (skins_[number]) return {};
    auto skin = skin_of(original_, finest_side_ * std::pow(kCoarser, number));
    if (!skin) return fail(skin.error());
    skins_[number].emplace(std::move(*skin));
    return {};
  }

  // Each mode's skin: by the wave in the air, then finer while its own pattern asks for it.
  Result<void> choose_skins() {
    skin_of_mode_.resize(modes_);
    shape_wavenumber_.resize(modes_, 0);
    for (int m = 0; m < modes_; ++m) skin_of_mode_[m] = skin_for(side_for_wave(wavenumber(m)));
    for (bool changed = true; changed;) {
      changed = false;
      for (int number = 0; number + 1 < static_cast<int>(skins_.size()); ++number) {
        if (std::find(skin_of_mode_.begin(), skin_of_mode_.end(), number) == skin_of_mode_.end() || skins_[number])
          continue;
        if (!go_on("radiation: surfaces", static_cast<double>(number) / skins_.size())) return fail_cancelled();
        if (const auto made = make_skin(number); !made) return fail(made.error());
        const std::vector<double> shape = shape_wavenumbers(*skins_[number]);
        for (int m = 0; m < modes_; ++m) {
          if (skin_of_mode_[m] != number || shape[m] <= 0) continue;
          shape_wavenumber_[m] = shape[m];
          const int finer = skin_for(2 * std::numbers::pi / (options_.panels_per_shape * shape[m]));
          if (finer >= number) continue;
          skin_of_mode_[m] = finer;
          changed = true;
        }
      }
    }
    std::vector<int> wanted(skin_of_mode_);
    for (const int number : skin_of_mode_) wanted.push_back(number + 1);
    std::sort(wanted.begin(), wanted.end());
    for (const int number : wanted) {
      if (const auto made = make_skin(number); !made) return fail(made.error());
    }
    return {};
  }

  void plan_jobs() {
    std::vector<int> order(modes_);
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) {
      return std::pair(skin_of_mode_[a], wavenumber(a)) < std::pair(skin_of_mode_[b], wavenumber(b));
    });
    for (std::size_t first = 0; first < order.size();) {
      std::size_t last = first;
      while (last < order.size() && skin_of_mode_[order[last]] == skin_of_mode_[order[first]] &&
             wavenumber(order[last]) <= wavenumber(order[first]) * (1 + kSameWave)) {
        ++last;
      }
      Job job;
      job.modes.assign(order.begin() + static_cast<std::ptrdiff_t>(first),
                       order.begin() + static_cast<std::ptrdiff_t>(last));
      for (const int m : job.modes) job.wavenumber += wavenumber(m) / static_cast<double>(job.modes.size());
      job.skin = skin_of_mode_[order[first]];
      jobs_.push_back(job);
      job.purpose = Job::Purpose::coarser;
      ++job.skin;
      jobs_.push_back(job);
      first = last;
    }
    plan_levels();
    gather_chunks();
  }

  // The finest skins first, so that no thread begins the longest chunk when the others end.
  void gather_chunks() {
    std::sort(jobs_.begin(), jobs_.end(), [](const Job& a, const Job& b) {
      return std::tuple(a.skin, -a.wavenumber, a.purpose) < std::tuple(b.skin, -b.wavenumber, b.purpose);
    });
    for (const Job& job : jobs_) {
      const bool fits = !chunks_.empty() && chunks_.back().front().skin == job.skin &&
                        (chunks_.back().front().wavenumber - job.wavenumber) * radius_ < kChunkWidth;
      if (!fits) chunks_.emplace_back();
      chunks_.back().push_back(job);
    }
    for (Chunk& chunk : chunks_) {  // what is eliminated stands first: the job in the middle
      std::swap(chunk.front(), chunk[chunk.size() / 2]);
    }
  }

  // Wavenumbers half an octave apart, at each the modes within range.
  void plan_levels() {
    if (options_.range_octaves <= 0) return;
    double lowest = wavenumber(0), highest = lowest;
    for (int m = 0; m < modes_; ++m) {
      lowest = std::min(lowest, wavenumber(m));
      highest = std::max(highest, wavenumber(m));
    }
    for (double k = highest; k > lowest * std::exp2(-options_.range_octaves - 0.5); k /= std::numbers::sqrt2) {
      Job job{Job::Purpose::levels, k, 0, {}};
      job.skin = static_cast<int>(skins_.size());
      for (int m = 0; m < modes_; ++m) {
        const double away = std::log2(wavenumber(m) / k);
        if (std::abs(away) > options_.range_octaves + 0.5) continue;
        job.modes.push_back(m);
      }
      if (job.modes.empty()) continue;
      // A level needs no direction: the skin for two thirds of the nodes per wave, if there is one.
      job.skin = skin_for(1.5 * side_for_wave(k));
      while (job.skin > 0 && !skins_[job.skin]) --job.skin;
      if (!skins_[job.skin]) continue;
      jobs_.push_back(job);
    }
  }

  Result<void> run_jobs() {
    const int threads = std::min(thread_count(options_.threads), std::max(1, static_cast<int>(chunks_.size())));
    std::atomic<std::size_t> next{0};
    std::atomic<bool> stop{false};
    std::mutex mutex;
    double done = 0, all = 0;
    const auto cost = [&](const Chunk& chunk) {
      const double nodes = skins_[chunk.front().skin]->panels.node_count();
      return nodes * nodes * (nodes + 1500 * static_cast<double>(chunk.size()));
    };
    for (const Chunk& chunk : chunks_) all += cost(chunk);
    in_parallel(threads, [&](int) {
      for (std::size_t c = next++; c < chunks_.size() && !stop; c = next++) {
        run(chunks_[c], [&] { return !stop; });
        const std::lock_guard lock(mutex);
        done += cost(chunks_[c]);
        if (!go_on("radiation", done / all)) stop = true;
      }
    });
    if (stop) return fail_cancelled();
    return {};
  }

  void run(const Chunk& chunk, const std::function<bool()>& go_on) {
    std::optional<Elimination> near;
    for (const Job& job : chunk) {
      if (!go_on()) return;
      const Skin& skin = *skins_[job.skin];
      const std::vector<double> coupling = coupling_of(skin, job.wavenumber);
      const Eigen::MatrixXcf flow = flow_for(job, skin);
      ComplexMatrix matrix = wave_matrix(skin.panels, skin.near, job.wavenumber, coupling);
      Eigen::MatrixXcf layers;
      if (near) layers = iterate(matrix, flow, &*near, kMostSteps, go_on);
      if (chunk.size() == 1 && matrix.rows() >= kFewestLone && flow.cols() <= kMostLoneColumns) {
        layers = iterate(matrix, flow, nullptr, kMostLoneSteps, go_on);
      }
      if (layers.size() == 0 && go_on()) {
        near.emplace(std::move(matrix));
        layers = near->solve(flow);
        ++factorizations_;
      }
      if (layers.size() == 0) return;
      keep(job, skin, coupling, layers.cast<std::complex<double>>());
    }
  }

  // What a job is solved for: its modes, and after them sources inside of the body.
  [[nodiscard]] Eigen::MatrixXcf flow_for(const Job& job, const Skin& skin) const {
    const auto modes = static_cast<Eigen::Index>(job.modes.size());
    const auto sources = job.purpose == Job::Purpose::fields ? static_cast<Eigen::Index>(places_.size()) : 0;
    Eigen::MatrixXcf flow(skin.panels.node_count(), modes + sources);
    for (Eigen::Index m = 0; m < modes; ++m) flow.col(m) = skin.flow.col(job.modes[m]).cast<std::complex<float>>();
    for (Eigen::Index s = 0; s < sources; ++s) {
      flow.col(modes + s) = source_flow(skin.panels, places_[s], job.wavenumber);
    }
    return flow;
  }

  // Writes what one job found; each writes for modes of its own, or under the lock.
  void keep(const Job& job, const Skin& skin, const std::vector<double>& coupling, const Eigen::MatrixXcd& layers) {
    const Directions directions = directions_for(degree_for(job.wavenumber, radius_));
    const Eigen::MatrixXcd fields = far_fields(skin.panels, origin_, job.wavenumber, coupling, directions, layers);
    const auto modes = static_cast<Eigen::Index>(job.modes.size());
    double source_db = 0;
    for (Eigen::Index s = modes; s < fields.cols(); ++s) {
      const double power = directions.weights.dot(fields.col(s).cwiseAbs2());
      source_db = std::max(source_db, std::abs(10 * std::log10(power * 4 * std::numbers::pi)));  // |F| = 1 / (4 pi)
    }
    const Eigen::MatrixXcd harmonics = harmonics_of(directions, fields.leftCols(modes));
    for (std::size_t i = 0; i < job.modes.size(); ++i) {
      const int m = job.modes[i];
      const auto values = harmonics.col(static_cast<Eigen::Index>(i));
      const double rms = values.norm() / std::sqrt(4 * std::numbers::pi);
      if (job.purpose == Job::Purpose::levels) {
        const std::lock_guard lock(levels_mutex_);
        found_.levels[m].push_back({static_cast<float>(job.wavenumber), static_cast<float>(rms)});
      } else if (job.purpose == Job::Purpose::coarser) {
        found_.coarser_rms[m] = rms;
      } else {
        found_.rms[m] = rms;
        found_.source_db[m] = source_db;
        found_.fields[m].wavenumber_rad_m = wavenumber(m);
        found_.fields[m].terms = modal::terms_of(std::span(values.data(), values.size()), kSmallestTerm);
      }
    }
  }

  [[nodiscard]] double relative_db(int mode, double power) const {
    const auto flow = original_.body->flow.flow.col(mode).cast<double>();
    const double squares = (flow.array().square() / original_.body->flow.areas.array()).sum();
    const double ka = wavenumber(mode) * std::sqrt(original_.panels->area() / (4 * std::numbers::pi));
    const double sphere = ka * ka / (1 + ka * ka) * air_.density_kg_m3 * air_.sound_speed_m_s * squares / 2;
    return power > 0 && sphere > 0 ? 10 * std::log10(power / sphere) : -300;
  }

  Radiation report() {
    Radiation radiation;
    radiation.maps.origin_m = {origin_[0], origin_[1], origin_[2]};
    for (int m = 0; m < modes_; ++m) {
      RadiatedMode mode;
      const double omega = 2 * std::numbers::pi * original_.body->frequency_hz[m];
      mode.power_w = modal::radiated_power(found_.rms[m], omega, air_);
      mode.decay_per_s = modal::radiation_decay_per_s(found_.rms[m], omega, air_);
      mode.relative_db = relative_db(m, mode.power_w);
      mode.source_db = found_.source_db[m];
      mode.coarser_db =
          std::abs(20 * std::log10(std::max(found_.rms[m], 1e-30) / std::max(found_.coarser_rms[m], 1e-30)));
      // The error falls with the square of the side, so the finer skin has about as much as the step between the two.
      mode.error_db = std::max(mode.source_db, mode.coarser_db);
      if (mode.error_db > wanted_error_db(mode.relative_db)) {
        mode.reason = mode.source_db >= mode.coarser_db ? "a source inside of the body is off"
                                                        : "a coarser surface gives another power";
      }
      add_levels(m);
      radiation.modes.push_back(mode);
    }
    radiation.maps.modes = std::move(found_.fields);
    for (const auto& skin : skins_) {
      if (skin) radiation.largest_unknowns = std::max(radiation.largest_unknowns, skin->panels.node_count());
    }
    radiation.factorizations = factorizations_;
    return radiation;
  }

  // Levels in ascending order, and the mode's own among them, unless one lies beside it.
  void add_levels(int mode) {
    modal::FarField& field = found_.fields[mode];
    auto& levels = found_.levels[mode];
    if (levels.empty() || !(found_.rms[mode] > 0)) return;
    std::erase_if(levels, [&](const auto& level) {
      return std::abs(std::log2(level.wavenumber_rad_m / field.wavenumber_rad_m)) < 0.05 || !(level.rms > 0);
    });
    levels.push_back({static_cast<float>(field.wavenumber_rad_m), static_cast<float>(found_.rms[mode])});
    std::sort(levels.begin(), levels.end(),
              [](const auto& a, const auto& b) { return a.wavenumber_rad_m < b.wavenumber_rad_m; });
    field.levels = levels;
  }

  bool go_on(std::string_view stage, double fraction) const {
    return !options_.progress || options_.progress(stage, fraction);
  }

  static constexpr double kSmallestTerm = 1e-4;

  const Original& original_;
  const modal::Air air_;
  const Options& options_;
  const int modes_;
  Eigen::Vector3d origin_;
  double radius_ = 0, finest_side_ = 0, coarsest_side_ = 0;
  std::vector<std::optional<Skin>> skins_;
  std::vector<int> skin_of_mode_;
  std::vector<double> shape_wavenumber_;
  std::vector<Eigen::Vector3d> places_;
  std::vector<Job> jobs_;
  std::vector<Chunk> chunks_;
  Findings found_;
  std::mutex levels_mutex_;
  std::atomic<int> factorizations_{0};
};

Result<void> check(const Body& body) {
  const auto modes = static_cast<Eigen::Index>(body.frequency_hz.size());
  const Eigen::Index samples = body.flow.positions.rows();
  if (modes == 0) return fail(ErrorKind::bad_input, "there are no modes to radiate");
  if (body.flow.normals.rows() != samples || body.flow.areas.size() != samples || body.flow.flow.rows() != samples ||
      body.flow.flow.cols() != modes) {
    return fail(ErrorKind::bad_input, "the flow has not the sizes of its samples and of the modes");
  }
  if (!std::all_of(body.frequency_hz.begin(), body.frequency_hz.end(),
                   [](double f) { return f > 0 && std::isfinite(f); })) {
    return fail(ErrorKind::bad_input, "a mode has no frequency above 0 Hz");
  }
  return {};
}

}  // namespace

Result<Radiation> solve(const Body& body, const modal::Air& air, const Options& options) {
  if (const auto sound = check(body); !sound) return fail(sound.error());
  const auto original = Original::of(body);
  if (!original) return fail(original.error());
  return Solver(*original, air, options).solve();
}

}  // namespace ringdown::radiate
