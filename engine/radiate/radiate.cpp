#include "engine/radiate/radiate.h"

#include "engine/base/in_parallel.h"
#include "engine/radiate/skin.h"
#include "engine/radiate/symmetry.h"
#include "engine/radiate/wave_pair.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

namespace ringdown::radiate {
namespace {

constexpr double kSameWave = 0.004;     // modes whose wavenumbers differ by less are solved at their mean
constexpr int kMinUnknowns = 500;       // smaller skins do not show the body's form
constexpr double kMaxForShapes = 3000;  // unknowns of a skin that only a mode's pattern needs, not the wave in the air
constexpr double kCoarser = std::numbers::sqrt2;
constexpr int kMaxRounds = 5;                  // rounds of solving on finer skins the modes that missed their error
constexpr double kFarOff = 4;                  // times the wanted error; such a mode skips a skin
constexpr double kMaxBytes = 3.5 * (1 << 30);  // all threads' matrices together
constexpr double kSharedSpan = 0.5;  // range of k times the body's radius in which one elimination preconditions all

// The work of one thread: modes at wavenumbers close to each other, in descending order, on one skin and the next
// coarser one, or levels of modes at one wavenumber on one skin.
struct Task {
  std::vector<WaveQuestion> questions;
  int grade = 0;
  bool levels = false;
};

// The results so far for one mode.
struct Finding {
  int grade = 0;        // grade of the skin on which the mode is solved
  int shape_grade = 1;  // grade of the skin that the mode's pattern needs
  double rms = 0, finer_rms = 0, source_db = 0;
  modal::FarField field;
};

class Solver {
 public:
  Solver(const Original& original, const Symmetry& symmetry, const modal::Air& air, const Options& options)
      : original_(original),
        symmetry_(symmetry),
        air_(air),
        options_(options),
        modes_(static_cast<int>(original.body->frequency_hz.size())) {
    origin_ =
        (original.panels->nodes.colwise().maxCoeff() + original.panels->nodes.colwise().minCoeff()).transpose() / 2;
    origin_.head(symmetry.mirrors).setZero();
    radius_ = (original.panels->nodes.rowwise() - origin_.transpose()).rowwise().norm().maxCoeff();
    found_.resize(modes_);
    levels_.resize(modes_);
    places_ = inner_places(original);
  }

  Result<Radiation> solve() {
    if (const auto chosen = choose_skins(); !chosen) return fail(chosen);
    std::vector<int> wanted(modes_);
    std::iota(wanted.begin(), wanted.end(), 0);
    for (int round = 0; round < kMaxRounds && !wanted.empty(); ++round) {
      std::vector<Task> tasks = tasks_for(wanted);
      if (round == 0) add_levels_to(tasks);
      if (const auto done = run(tasks, round); !done) return fail(done);
      std::erase_if(wanted, [&](int m) { return !misses(report_of(m)) || !may_be_finer(found_[m].grade); });
      for (const int m : wanted) {
        const RadiatedMode mode = report_of(m);
        const bool far_off = mode.error_db > kFarOff * wanted_error_db(mode.relative_db);
        found_[m].grade = std::min(found_[m].grade + (far_off ? 2 : 1), finest_grade(max_nodes()));
      }
    }
    return report();
  }

 private:
  [[nodiscard]] double wavenumber(int mode) const {
    return 2 * std::numbers::pi * original_.body->frequency_hz[mode] / air_.sound_speed_m_s;
  }
  [[nodiscard]] double side_for_wave(double k) const { return 2 * std::numbers::pi / (k * options_.panels_per_wave); }

  // Skins of grade 1 have kMinUnknowns nodes, those of the next grade twice as many; grade 0 serves only for
  // comparison.
  [[nodiscard]] double side_of(int grade) const {
    const double coarsest = std::sqrt(original_.panels->area() / kMinUnknowns * 2 / std::sqrt(3.0));
    return coarsest * std::pow(kCoarser, 1 - grade);
  }
  [[nodiscard]] static int finest_grade(double max_nodes) {
    return 1 + std::max(0, static_cast<int>(std::log2(max_nodes / kMinUnknowns)));
  }
  [[nodiscard]] double max_nodes() const {
    return options_.max_unknowns * (symmetry_.mirrors == 0 ? 1 : std::exp2((symmetry_.mirrors + 1) / 2.0));
  }
  [[nodiscard]] bool may_be_finer(int grade) const { return grade < finest_grade(max_nodes()); }
  // With two or three mirror planes the coarsest skin has 1,000 nodes, because irregularities of the part recur in its
  // images and cancel less than those of a whole skin.
  [[nodiscard]] int coarsest_grade() const { return symmetry_.mirrors > 1 ? 2 : 1; }
  // The grade whose sides are nearest to the given one.
  [[nodiscard]] int grade_for(double side, int finest) const {
    const double steps = std::log(side_of(1) / side) / std::log(kCoarser);
    return std::clamp(1 + static_cast<int>(std::lround(steps)), coarsest_grade(), std::max(coarsest_grade(), finest));
  }
  Result<void> make_skin(int grade) {
    if (skins_.contains(grade)) return {};
    auto skin = skin_of(original_, side_of(grade));
    if (!skin) return fail(skin);
    skins_.emplace(grade, std::move(*skin));
    return {};
  }

  // Chooses each mode's skin by the wave in the air, then a finer one while the mode's own pattern needs it.
  Result<void> choose_skins() {
    const int finest = finest_grade(max_nodes()), for_shapes = finest_grade(std::min(max_nodes(), kMaxForShapes));
    for (int m = 0; m < modes_; ++m) found_[m].grade = grade_for(side_for_wave(wavenumber(m)), finest);
    for (int grade = 1; grade <= finest; ++grade) {
      if (std::none_of(found_.begin(), found_.end(), [&](const Finding& f) { return f.grade == grade; })) continue;
      if (!go_on("radiation: surfaces", static_cast<double>(grade) / (finest + 1))) return fail_cancelled();
      if (const auto made = make_skin(grade); !made) return fail(made);
      const std::vector<double> shape = shape_wavenumbers(skins_.at(grade));
      for (int m = 0; m < modes_; ++m) {
        if (found_[m].grade != grade || shape[m] <= 0) continue;
        const double side = 2 * std::numbers::pi / (options_.panels_per_shape * shape[m]);
        found_[m].shape_grade = grade_for(side, for_shapes);
        found_[m].grade = std::max(grade, grade_for(side, std::max(grade, for_shapes)));
      }
    }
    return {};
  }

  [[nodiscard]] WaveQuestion question(double k, std::vector<int> modes) const {
    return {.wavenumber_rad_m = k,
            .modes = std::move(modes),
            .sources = places_,
            .origin = origin_,
            .radius_m = radius_,
            .turn = symmetry_.turn};
  }

  // Groups the modes by skins and wavenumbers, the finest skins first, so that no thread begins the longest task when
  // the other threads finish.
  [[nodiscard]] std::vector<Task> tasks_for(std::vector<int> order) const {
    std::sort(order.begin(), order.end(), [&](int a, int b) {
      return std::pair(found_[a].grade, wavenumber(a)) > std::pair(found_[b].grade, wavenumber(b));
    });
    std::vector<Task> tasks;
    for (std::size_t first = 0; first < order.size();) {
      const int grade = found_[order[first]].grade;
      const double lowest = wavenumber(order[first]) * (1 - kSameWave);
      double sum = 0;
      std::vector<int> modes;
      for (; first < order.size() && found_[order[first]].grade == grade && wavenumber(order[first]) >= lowest;
           ++first) {
        modes.push_back(order[first]);
        sum += wavenumber(order[first]);
      }
      const double mean = sum / static_cast<double>(modes.size());
      const bool joins = !tasks.empty() && tasks.back().grade == grade &&
                         (tasks.back().questions.front().wavenumber_rad_m - mean) * radius_ <= kSharedSpan;
      if (!joins) tasks.push_back({.questions = {}, .grade = grade});
      tasks.back().questions.push_back(question(mean, std::move(modes)));
    }
    return tasks;
  }

  // Adds wavenumbers half an octave apart, each with the modes within range. A level has no direction, so a skin with
  // two thirds of the nodes per wave is enough, or the skin for the mode's pattern if that is finer.
  void add_levels_to(std::vector<Task>& tasks) const {
    if (options_.range_octaves <= 0) return;
    double lowest = wavenumber(0), highest = lowest;
    int finest = 1;
    for (int m = 0; m < modes_; ++m) {
      lowest = std::min(lowest, wavenumber(m));
      highest = std::max(highest, wavenumber(m));
      finest = std::max(finest, found_[m].grade);
    }
    std::vector<Task> levels;
    for (double k = highest; k > lowest * std::exp2(-options_.range_octaves - 0.5); k /= std::numbers::sqrt2) {
      const int for_wave = grade_for(1.5 * side_for_wave(k), finest);
      std::map<int, std::vector<int>> modes;  // modes by grade
      for (int m = 0; m < modes_; ++m) {
        if (std::abs(std::log2(wavenumber(m) / k)) > options_.range_octaves + 0.5) continue;
        modes[std::max(for_wave, found_[m].shape_grade)].push_back(m);
      }
      for (auto& [grade, own] : modes) {
        levels.push_back({.questions = {question(k, std::move(own))}, .grade = grade, .levels = true});
      }
    }
    std::stable_sort(levels.begin(), levels.end(), [](const Task& a, const Task& b) { return a.grade > b.grade; });
    tasks.insert(tasks.end(), levels.begin(), levels.end());
  }

  // Makes the skins before the threads begin, because the threads share them.
  Result<void> prepare(std::span<const Task> tasks) {
    for (const Task& task : tasks) {
      for (const int grade : {task.grade, task.grade - 1}) {
        if (const auto made = make_skin(grade); !made) return fail(made);
      }
      if (!task.levels && !continuations_.contains(task.grade)) {
        continuations_.emplace(task.grade, continuation_of(skins_.at(task.grade), skins_.at(task.grade - 1)));
      }
    }
    return {};
  }

  // The first tasks whose matrices come from one band; for levels, all tasks.
  static std::span<const Task> band_of(std::span<const Task> tasks) {
    const Task& first = tasks.front();
    const double lowest = first.questions.front().wavenumber_rad_m / kWidestBand;
    const auto end = std::find_if(tasks.begin(), tasks.end(), [&](const Task& task) {
      return task.levels != first.levels ||
             (!task.levels && (task.grade != first.grade || task.questions.back().wavenumber_rad_m < lowest));
    });
    return tasks.first(std::max<std::size_t>(1, end - tasks.begin()));
  }

  Result<void> run(std::span<const Task> tasks, int round) {
    if (const auto prepared = prepare(tasks); !prepared) return fail(prepared);
    double all = 0;
    for (const Task& task : tasks) all += cost_of(task);
    double done = 0;
    while (!tasks.empty()) {
      const auto own = band_of(tasks);
      const auto progress = [&](const Task& task) {
        done += cost_of(task);
        return go_on("radiation", (round + done / all) / kMaxRounds);
      };
      if (!run_band(own, progress)) return fail_cancelled();
      tasks = tasks.subspan(own.size());
    }
    return {};
  }

  static double cost_of(const Task& task) {
    return std::exp2(2 * task.grade) * static_cast<double>(task.questions.size());
  }

  // The number of threads for which there is memory.
  [[nodiscard]] int threads_for(const Skin& skin, double shared_bytes) const {
    return std::clamp(static_cast<int>((kMaxBytes - shared_bytes) / wave_memory_bytes(skin)), 1,
                      thread_count(options_.threads));
  }

  // Returns false when `progress` returns false.
  bool run_band(std::span<const Task> tasks, const std::function<bool(const Task&)>& progress) {
    const Task& first = tasks.front();
    const Skin& skin = skins_.at(first.grade);
    const double band_bytes = band_memory_bytes(skin);
    const bool shares = !first.levels && band_bytes + wave_memory_bytes(skin) <= kMaxBytes;
    const int threads = threads_for(skin, shares ? band_bytes : 0);
    std::optional<BandPair> bands;
    if (!first.levels) {
      const double highest = first.questions.front().wavenumber_rad_m,
                   lowest = tasks.back().questions.back().wavenumber_rad_m;
      int wavenumbers = 0;
      for (const Task& task : tasks) wavenumbers += shares ? static_cast<int>(task.questions.size()) : 0;
      bands.emplace(WaveBand(skin, lowest, highest, wavenumbers, threads),
                    WaveBand(skins_.at(first.grade - 1), lowest, highest, wavenumbers, threads),
                    continuations_.at(first.grade));
    }
    std::atomic<std::size_t> next{0};
    std::atomic<bool> stop{false};
    std::mutex mutex;
    in_parallel(std::min(threads, static_cast<int>(tasks.size())), [&](int) {
      WaveMemory memory;
      for (std::size_t t = next++; t < tasks.size() && !stop; t = next++) {
        const Task& task = tasks[t];
        if (task.levels) {
          const Eigen::VectorXd rms = rms_on(task.questions[0], skins_.at(task.grade), memory);
          const std::lock_guard lock(mutex);
          keep_levels(task.questions[0], rms);
        } else {
          answer(
              task.questions, *bands, memory, [&] { return !stop; },
              [&](const WaveQuestion& question, const WaveAnswer& found) { keep(question, found); });
        }
        const std::lock_guard lock(mutex);
        if (!progress(task)) stop = true;
      }
    });
    return !stop;
  }

  // Each task writes only to its own modes. If the degree of the harmonics is at its limit, they are scaled up to the
  // mode's whole power.
  void keep(const WaveQuestion& question, const WaveAnswer& answer) {
    for (std::size_t i = 0; i < question.modes.size(); ++i) {
      const int m = question.modes[i];
      const auto column = static_cast<Eigen::Index>(i);
      Eigen::VectorXcd values = answer.harmonics.col(column);
      const double rms = values.norm() / std::sqrt(4 * std::numbers::pi);
      if (rms > 0) values *= answer.rms[column] / rms;
      Finding& found = found_[m];
      found.rms = answer.rms[column];
      found.finer_rms = answer.finer_rms[column];
      found.source_db = answer.source_db;
      found.field.wavenumber_rad_m = wavenumber(m);
      found.field.terms = modal::terms_of(std::span(values.data(), values.size()), kMinTerm);
    }
    if (answer.eliminated) ++eliminations_;
  }
  void keep_levels(const WaveQuestion& question, const Eigen::VectorXd& rms) {
    for (std::size_t i = 0; i < question.modes.size(); ++i) {
      levels_[question.modes[i]].push_back(
          {static_cast<float>(question.wavenumber_rad_m), static_cast<float>(rms[static_cast<Eigen::Index>(i)])});
    }
  }

  // Counts the nodes of a skin and of its images; nodes on a plane count once.
  static int whole_nodes(const Panels& panels) {
    int nodes = 0;
    for (int n = 0; n < panels.node_count(); ++n) {
      nodes += panels.image_count() >> std::popcount(static_cast<unsigned>(panels.planes_at(n)));
    }
    return nodes;
  }

  [[nodiscard]] double relative_db(int mode, double power) const {
    const auto flow = original_.body->flow.flow.col(mode).cast<double>();
    const double squares = (flow.array().square() / original_.body->flow.areas.array()).sum();
    const double ka = wavenumber(mode) * std::sqrt(original_.panels->area() / (4 * std::numbers::pi));
    const double sphere = ka * ka / (1 + ka * ka) * air_.density_kg_m3 * air_.sound_speed_m_s * squares / 2;
    return power > 0 && sphere > 0 ? 10 * std::log10(power / sphere) : -300;
  }

  static bool misses(const RadiatedMode& mode) { return mode.error_db > wanted_error_db(mode.relative_db); }

  [[nodiscard]] RadiatedMode report_of(int m) const {
    const Finding& found = found_[m];
    RadiatedMode mode;
    const double omega = 2 * std::numbers::pi * original_.body->frequency_hz[m];
    mode.power_w = modal::radiated_power(found.rms, omega, air_);
    mode.decay_per_s = modal::radiation_decay_per_s(found.rms, omega, air_);
    mode.relative_db = relative_db(m, mode.power_w);
    mode.source_db = found.source_db;
    mode.coarser_db = std::abs(20 * std::log10(std::max(found.rms, 1e-30) / std::max(found.finer_rms, 1e-30)));
    mode.error_db = std::max(mode.source_db, mode.coarser_db);
    if (misses(mode)) {
      mode.reason = mode.source_db >= mode.coarser_db ? "a source inside of the body is off"
                                                      : "a coarser surface gives another power";
    }
    return mode;
  }

  Radiation report() {
    Radiation radiation;
    const Eigen::Vector3d origin = symmetry_.turn.transpose() * (origin_ + symmetry_.shift);
    radiation.maps.origin_m = {origin[0], origin[1], origin[2]};
    for (int m = 0; m < modes_; ++m) {
      radiation.modes.push_back(report_of(m));
      add_levels(m);
      radiation.maps.modes.push_back(std::move(found_[m].field));
    }
    for (const auto& [grade, skin] : skins_) {
      radiation.largest_unknowns = std::max(radiation.largest_unknowns, whole_nodes(skin.panels));
    }
    radiation.mirrors = symmetry_.mirrors;
    radiation.eliminations = eliminations_;
    return radiation;
  }

  // Sets the mode's levels in ascending order. The mode's own level replaces any level close to it.
  void add_levels(int mode) {
    modal::FarField& field = found_[mode].field;
    auto& levels = levels_[mode];
    if (levels.empty() || !(found_[mode].rms > 0)) return;
    std::erase_if(levels, [&](const auto& level) {
      return std::abs(std::log2(level.wavenumber_rad_m / field.wavenumber_rad_m)) < 0.05 || !(level.rms > 0);
    });
    levels.push_back({static_cast<float>(field.wavenumber_rad_m), static_cast<float>(found_[mode].rms)});
    std::sort(levels.begin(), levels.end(),
              [](const auto& a, const auto& b) { return a.wavenumber_rad_m < b.wavenumber_rad_m; });
    field.levels = levels;
  }

  bool go_on(std::string_view stage, double fraction) const {
    return !options_.progress || options_.progress(stage, fraction);
  }

  static constexpr double kMinTerm = 1e-4;

  const Original& original_;
  const Symmetry symmetry_;
  const modal::Air air_;
  const Options& options_;
  const int modes_;
  Eigen::Vector3d origin_;
  double radius_ = 0;
  std::vector<Eigen::Vector3d> places_;
  std::map<int, Skin> skins_;                                // skins by grade
  std::map<int, Continuation> continuations_;                // continuations by the finer skin's grade
  std::vector<Finding> found_;                               // M
  std::vector<std::vector<modal::FarField::Level>> levels_;  // M
  std::atomic<int> eliminations_{0};
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

// Solves without mirror planes if the part of the surface between them cannot be tiled.
Result<Radiation> solve(const Body& body, const modal::Air& air, const Options& options) {
  if (const auto sound = check(body); !sound) return fail(sound);
  if (const Symmetry symmetry = options.symmetry ? symmetry_of(body.surface) : Symmetry{}; symmetry.mirrors > 0) {
    const Body turned = moved(body, symmetry);
    const auto original = Original::of(turned, symmetry.mirrors);
    if (!original) return fail(original);
    auto solved = Solver(*original, symmetry, air, options).solve();
    if (solved || solved.error().kind != ErrorKind::bad_input) return solved;
  }
  const auto original = Original::of(body);
  if (!original) return fail(original);
  return Solver(*original, Symmetry{}, air, options).solve();
}

}  // namespace ringdown::radiate
