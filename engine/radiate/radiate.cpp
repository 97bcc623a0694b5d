#include "engine/radiate/radiate.h"

#include "engine/base/in_parallel.h"
#include "engine/radiate/skin.h"
#include "engine/radiate/wave_pair.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

namespace ringdown::radiate {
namespace {

constexpr double kSameWave = 0.004;   // modes whose wavenumbers differ by less are solved at their mean
constexpr int kFewestUnknowns = 500;  // a skin of fewer does not show the body's form
constexpr int kMostForShapes = 3000;  // unknowns of a skin that a pattern asks for and no wave in the air
constexpr double kCoarser = std::numbers::sqrt2;
constexpr int kMostRounds = 4;                  // of solving what missed on finer skins
constexpr double kMostBytes = 3.5 * (1 << 30);  // of all threads' matrices together
// The power's error falls with the square of the side or faster, and so halves or better from one grade to the next:
// when half of the last step is added, no more than half a step is left.
constexpr double kExtrapolation = 0.5;  // of the step from the coarser skin to the finer

// A task is what is solved at one wavenumber: modes on one skin and the next coarser one, or levels of modes on one
// skin.
struct Task {
  WaveQuestion question;
  int grade = 0;
  bool levels = false;
};

// A finding is what is known of one mode so far.
struct Finding {
  int grade = 0;  // of the skin on which the mode is solved
  double rms = 0, finer_rms = 0, source_db = 0;
  modal::FarField field;
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
    found_.resize(modes_);
    levels_.resize(modes_);
    places_ = inner_places(original);
  }

  Result<Radiation> solve() {
    if (const auto chosen = choose_skins(); !chosen) return fail(chosen.error());
    std::vector<int> wanted(modes_);
    std::iota(wanted.begin(), wanted.end(), 0);
    for (int round = 0; round < kMostRounds && !wanted.empty(); ++round) {
      if (const auto done = run(tasks_for(wanted, round == 0), round); !done) return fail(done.error());
      std::erase_if(wanted, [&](int m) { return !misses(report_of(m)) || !may_be_finer(found_[m].grade); });
      for (const int m : wanted) ++found_[m].grade;
    }
    return report();
  }

 private:
  [[nodiscard]] double wavenumber(int mode) const {
    return 2 * std::numbers::pi * original_.body->frequency_hz[mode] / air_.sound_speed_m_s;
  }
  [[nodiscard]] double side_for_wave(double k) const { return 2 * std::numbers::pi / (k * options_.panels_per_wave); }

  // Skins of grade 1 have kFewestUnknowns nodes, those of the next grade twice as many; grade 0 is only compared with.
  [[nodiscard]] double side_of(int grade) const {
    const double coarsest = std::sqrt(original_.panels->area() / kFewestUnknowns * 2 / std::sqrt(3.0));
    return coarsest * std::pow(kCoarser, 1 - grade);
  }
  [[nodiscard]] int finest_grade(int most_unknowns) const {
    return 1 + std::max(0, static_cast<int>(std::log2(static_cast<double>(most_unknowns) / kFewestUnknowns)));
  }
  [[nodiscard]] bool may_be_finer(int grade) const { return grade < finest_grade(options_.most_unknowns); }
  // The grade whose sides are nearest to the given one.
  [[nodiscard]] int grade_for(double side, int finest) const {
    const double steps = std::log(side_of(1) / side) / std::log(kCoarser);
    return std::clamp(1 + static_cast<int>(std::lround(steps)), 1, finest);
  }
  Result<void> make_skin(int grade) {
    if (skins_.contains(grade)) return {};
    auto skin = skin_of(original_, side_of(grade));
    if (!skin) return fail(skin.error());
    skins_.emplace(grade, std::move(*skin));
    return {};
  }

  // Each mode's skin: by the wave in the air, then finer while its own pattern asks for it.
  Result<void> choose_skins() {
    const int finest = finest_grade(options_.most_unknowns),
              for_shapes = finest_grade(std::min(options_.most_unknowns, kMostForShapes));
    for (int m = 0; m < modes_; ++m) found_[m].grade = grade_for(side_for_wave(wavenumber(m)), finest);
    for (int grade = 1; grade <= finest; ++grade) {
      if (std::none_of(found_.begin(), found_.end(), [&](const Finding& f) { return f.grade == grade; })) continue;
      if (!go_on("radiation: surfaces", static_cast<double>(grade) / (finest + 1))) return fail_cancelled();
      if (const auto made = make_skin(grade); !made) return fail(made.error());
      const std::vector<double> shape = shape_wavenumbers(skins_.at(grade));
      for (int m = 0; m < modes_; ++m) {
        if (found_[m].grade != grade || shape[m] <= 0) continue;
        const double side = 2 * std::numbers::pi / (options_.panels_per_shape * shape[m]);
        found_[m].grade = std::max(grade, grade_for(side, std::max(grade, for_shapes)));
      }
    }
    return {};
  }

  [[nodiscard]] Task task(double k, int grade, std::vector<int> modes) const {
    return {
        {.wavenumber_rad_m = k, .modes = std::move(modes), .sources = places_, .origin = origin_, .radius_m = radius_},
        grade};
  }

  // The modes by skins and wavenumbers, the finest skins first, so that no thread begins the longest task when the
  // others end.
  [[nodiscard]] std::vector<Task> tasks_for(std::vector<int> order, bool with_levels) const {
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
      tasks.push_back(task(mean, grade, std::move(modes)));
    }
    if (with_levels) add_levels_to(tasks);
    return tasks;
  }

  // Wavenumbers half an octave apart, at each the modes within range. A level needs no direction: the skin for two
  // thirds of the nodes per wave.
  void add_levels_to(std::vector<Task>& tasks) const {
    if (options_.range_octaves <= 0) return;
    double lowest = wavenumber(0), highest = lowest;
    int finest = 1;
    for (int m = 0; m < modes_; ++m) {
      lowest = std::min(lowest, wavenumber(m));
      highest = std::max(highest, wavenumber(m));
      finest = std::max(finest, found_[m].grade);
    }
    for (double k = highest; k > lowest * std::exp2(-options_.range_octaves - 0.5); k /= std::numbers::sqrt2) {
      std::vector<int> modes;
      for (int m = 0; m < modes_; ++m) {
        if (std::abs(std::log2(wavenumber(m) / k)) <= options_.range_octaves + 0.5) modes.push_back(m);
      }
      if (modes.empty()) continue;
      tasks.push_back(task(k, grade_for(1.5 * side_for_wave(k), finest), std::move(modes)));
      tasks.back().levels = true;
    }
  }

  // Skins and pairs are made before the threads begin, which share them.
  Result<void> prepare(const std::vector<Task>& tasks) {
    for (const Task& task : tasks) {
      for (const int grade : {task.grade, task.grade - 1}) {
        if (const auto made = make_skin(grade); !made) return fail(made.error());
      }
      if (!pairs_.contains(task.grade)) {
        pairs_.emplace(task.grade, pair_of(skins_.at(task.grade), skins_.at(task.grade - 1)));
      }
    }
    return {};
  }

  Result<void> run(const std::vector<Task>& tasks, int round) {
    if (const auto prepared = prepare(tasks); !prepared) return fail(prepared.error());
    const int largest = skins_.at(tasks.front().grade).panels.node_count();
    const int threads = std::clamp(static_cast<int>(kMostBytes / wave_memory_bytes(largest)), 1,
                                   std::min(thread_count(options_.threads), static_cast<int>(tasks.size())));
    std::atomic<std::size_t> next{0};
    std::atomic<bool> stop{false};
    std::mutex mutex;
    double done = 0, all = 0;
    const auto cost = [&](const Task& task) { return std::exp2(2 * task.grade); };
    for (const Task& task : tasks) all += cost(task);
    in_parallel(threads, [&](int) {
      WaveMemory memory;
      for (std::size_t t = next++; t < tasks.size() && !stop; t = next++) {
        const Task& task = tasks[t];
        if (task.levels) {
          const Eigen::MatrixXcd harmonics = answer_on(task.question, skins_.at(task.grade), memory);
          const std::lock_guard lock(mutex);
          keep_levels(task.question, harmonics);
        } else if (const auto found = answer(task.question, pairs_.at(task.grade), memory, [&] { return !stop; })) {
          keep(task.question, *found);
        }
        const std::lock_guard lock(mutex);
        done += cost(task);
        if (!go_on("radiation", (round + done / all) / kMostRounds)) stop = true;
      }
    });
    if (stop) return fail_cancelled();
    return {};
  }

  static double rms_of(const Eigen::VectorXcd& harmonics) { return harmonics.norm() / std::sqrt(4 * std::numbers::pi); }

  // Each task writes for modes of its own.
  void keep(const WaveQuestion& question, const WaveAnswer& answer) {
    for (std::size_t i = 0; i < question.modes.size(); ++i) {
      const int m = question.modes[i];
      const auto column = static_cast<Eigen::Index>(i);
      const Eigen::VectorXcd finer = answer.fine.col(column);
      const Eigen::VectorXcd values = finer + kExtrapolation * (finer - answer.coarse.col(column));
      Finding& found = found_[m];
      found.rms = rms_of(values);
      found.finer_rms = rms_of(finer);
      found.source_db = answer.source_db;
      found.field.wavenumber_rad_m = wavenumber(m);
      found.field.terms = modal::terms_of(std::span(values.data(), values.size()), kSmallestTerm);
    }
    if (answer.eliminated) ++eliminations_;
  }
  void keep_levels(const WaveQuestion& question, const Eigen::MatrixXcd& harmonics) {
    for (std::size_t i = 0; i < question.modes.size(); ++i) {
      levels_[question.modes[i]].push_back({static_cast<float>(question.wavenumber_rad_m),
                                            static_cast<float>(rms_of(harmonics.col(static_cast<Eigen::Index>(i))))});
    }
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
    radiation.maps.origin_m = {origin_[0], origin_[1], origin_[2]};
    for (int m = 0; m < modes_; ++m) {
      radiation.modes.push_back(report_of(m));
      add_levels(m);
      radiation.maps.modes.push_back(std::move(found_[m].field));
    }
    for (const auto& [grade, skin] : skins_) {
      radiation.largest_unknowns = std::max(radiation.largest_unknowns, skin.panels.node_count());
    }
    radiation.eliminations = eliminations_;
    return radiation;
  }

  // Levels in ascending order, and the mode's own among them, unless one lies beside it.
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

  static constexpr double kSmallestTerm = 1e-4;

  const Original& original_;
  const modal::Air air_;
  const Options& options_;
  const int modes_;
  Eigen::Vector3d origin_;
  double radius_ = 0;
  std::vector<Eigen::Vector3d> places_;
  std::map<int, Skin> skins_;                                // by grade
  std::map<int, SkinPair> pairs_;                            // by the finer skin's grade
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

Result<Radiation> solve(const Body& body, const modal::Air& air, const Options& options) {
  if (const auto sound = check(body); !sound) return fail(sound.error());
  const auto original = Original::of(body);
  if (!original) return fail(original.error());
  return Solver(*original, air, options).solve();
}

}  // namespace ringdown::radiate
