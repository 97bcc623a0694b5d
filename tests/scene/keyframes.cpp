#include "tests/scene/keyframes.h"

#include "engine/modal/bank_file.h"
#include "engine/scene/contact/contact_life.h"
#include "engine/scene/recording.h"
#include "engine/scene/scene_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <utility>

namespace ringdown::test {

using namespace scene;
namespace {

// The times in which a pair slides or rolls. Interruptions that are shorter than `bridge_s` are none.
struct Stretch {
  double begin_s = 0, end_s = 0;
};
std::map<BodyPair, std::vector<Stretch>> stretches_of(const std::vector<HeardContact>& contacts, double bridge_s) {
  std::map<BodyPair, std::vector<Stretch>> found;
  std::map<BodyPair, bool> open;
  for (const HeardContact& c : contacts) {
    if (c.kind == HeardContact::blow) continue;
    std::vector<Stretch>& all = found[c.pair];
    if (c.kind == HeardContact::lasting && !open[c.pair] && (all.empty() || c.time_s - all.back().end_s > bridge_s)) {
      all.push_back({c.time_s, c.time_s});
    }
    if (!all.empty()) all.back().end_s = c.time_s;
    open[c.pair] = c.kind == HeardContact::lasting;
  }
  return found;
}

double db(double ratio) { return 20 * std::log10(ratio); }

double median(std::vector<double> values, double share = 0.5) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

}  // namespace

Played simulate(const SceneDescription& scene, const std::vector<SoundingObject>& objects, double fps) {
  auto recording = record(scene, objects, fps);
  if (!recording) {
    std::printf("%s\n", recording.error().message.c_str());
    return {};
  }
  recording->scene.foley.emplace();
  return {std::move(recording->contacts), std::move(recording->scene)};
}

Preset preset_scene(const std::string& name) {
  const std::filesystem::path presets = std::filesystem::path(RINGDOWN_SOURCE_DIR) / "presets";
  Preset preset{.scene = read_scene(presets / "scenes" / (name + ".toml"), presets).value()};
  for (const ObjectDescription& object : preset.scene.objects) {
    auto bank = modal::read_bank(object.bank).value();
    preset.objects.push_back({object.name, static_cast<synth::ObjectNumber>(preset.objects.size()),
                              std::make_shared<const modal::Bank>(std::move(bank))});
  }
  return preset;
}

std::vector<HeardContact> play(const SceneDescription& animated, const std::vector<SoundingObject>& objects) {
  std::vector<HeardContact> contacts;
  auto world = World::create(animated, objects, 48000);
  if (!world) std::printf("%s\n", world.error().message.c_str());
  while (world && world->time_s() < animated.duration_s) {
    const StepReport report = world->step();
    contacts.insert(contacts.end(), report.contacts.begin(), report.contacts.end());
    for (const std::string& notice : report.notices) std::printf("%s\n", notice.c_str());
  }
  return contacts;
}

Comparison compare(const std::vector<HeardContact>& truth, const std::vector<HeardContact>& recovered, double fps,
                   bool verbose) {
  std::map<BodyPair, std::vector<HeardContact>> real, found;
  double loudest = 0;
  for (const HeardContact& c : truth) {
    if (c.kind != HeardContact::blow) continue;
    real[c.pair].push_back(c);
    loudest = std::max(loudest, length(c.push));
  }
  for (const HeardContact& c : recovered)
    if (c.kind == HeardContact::blow) found[c.pair].push_back(c);
  Comparison result;
  std::vector<double> times, impulses, sums;
  const double frame_s = 1 / fps;
  for (const auto& [pair, blows] : real) {
    const auto& mine = found[pair];
    for (std::size_t k = 0; k < blows.size();) {
      std::size_t end = k + 1;
      while (end < blows.size() && blows[end].time_s - blows[end - 1].time_s < 2 * frame_s) ++end;
      if (end == k + 1) {
        const HeardContact& blow = blows[k];
        if (db(length(blow.push) / loudest) > -30 && blow.time_s > 2 * frame_s) {
          ++result.alone;
          const HeardContact* best = nullptr;
          for (const HeardContact& other : mine) {
            const double off = std::abs(other.time_s - blow.time_s);
            if (off < frame_s && (!best || off < std::abs(best->time_s - blow.time_s))) best = &other;
          }
          if (best) {
            ++result.found;
            times.push_back(1000 * std::abs(best->time_s - blow.time_s));
            impulses.push_back(std::abs(db(length(best->push) / length(blow.push))));
          }
          if (verbose)
            std::printf("%u-%u at %.4f s, %.1f dB, %.2f m/s: %s %+.2f ms %+.2f dB\n", pair.first, pair.second & 0xffff,
                        blow.time_s, db(length(blow.push) / loudest), blow.speed_m_s, best ? "found" : "missed",
                        best ? 1000 * (best->time_s - blow.time_s) : 0,
                        best ? db(length(best->push) / length(blow.push)) : 0);
        }
      } else {
        double real_sum = 0, found_sum = 0;
        for (std::size_t n = k; n < end; ++n) real_sum += length(blows[n].push);
        for (const HeardContact& other : mine) {
          if (other.time_s > blows[k].time_s - frame_s && other.time_s < blows[end - 1].time_s + frame_s)
            found_sum += length(other.push);
        }
        if (db(real_sum / loudest) > -30) {
          ++result.groups;
          sums.push_back(std::abs(db(std::max(found_sum, 1e-9) / real_sum)));
          if (verbose)
            std::printf("%u-%u at %.4f s: %zu blows, sum %.1f dB: %+.2f dB\n", pair.first, pair.second & 0xffff,
                        blows[k].time_s, end - k, db(real_sum / loudest), db(std::max(found_sum, 1e-9) / real_sum));
        }
      }
      k = end;
    }
  }
  for (const auto& [pair, blows] : found) {
    for (const HeardContact& blow : blows) {
      if (!(db(length(blow.push) / loudest) > -40)) continue;
      const auto& all = real[pair];
      const bool known = std::ranges::any_of(
          all, [&](const HeardContact& c) { return std::abs(c.time_s - blow.time_s) < 2 * frame_s; });
      if (known) continue;
      ++result.false_ones;
      // The simulation has a push in place of a blow where a pair that touches is pressed together from outside.
      double pushed_ns = 0;
      for (const HeardContact& c : truth) {
        if (c.kind == HeardContact::lasting && c.pair == pair && std::abs(c.time_s - blow.time_s) < 2 * frame_s)
          pushed_ns += kReportEvery_s * length(c.push);
      }
      if (pushed_ns > 0.5 * length(blow.push)) ++result.pushes;
      if (verbose)
        std::printf("%u-%u at %.4f s: false, %.1f dB, %.2f m/s; a push of %.1f dB\n", pair.first, pair.second & 0xffff,
                    blow.time_s, db(length(blow.push) / loudest), blow.speed_m_s,
                    db(std::max(pushed_ns, 1e-9) / loudest));
    }
  }
  const auto real_stretches = stretches_of(truth, 2 * frame_s);
  auto found_stretches = stretches_of(recovered, 2 * frame_s);
  for (const auto& [pair, stretches] : real_stretches) {
    const std::vector<Stretch>& mine = found_stretches[pair];
    for (const Stretch& stretch : stretches) {
      if (stretch.end_s - stretch.begin_s < 4 * frame_s) continue;
      const auto begins = [&](const Stretch& s) { return std::abs(s.begin_s - stretch.begin_s) < 2 * frame_s; };
      const auto ends = [&](const Stretch& s) { return std::abs(s.end_s - stretch.end_s) < 2 * frame_s; };
      result.ends += 2;
      const bool begins_here = std::ranges::any_of(mine, begins), ends_here = std::ranges::any_of(mine, ends);
      result.ends_found += (begins_here ? 1 : 0) + (ends_here ? 1 : 0);
      if (!verbose) continue;
      std::printf("%u-%u slides from %.3f s (%s) to %.3f s (%s); found:", pair.first, pair.second & 0xffff,
                  stretch.begin_s, begins_here ? "found" : "missed", stretch.end_s, ends_here ? "found" : "missed");
      for (const Stretch& other : mine) std::printf(" %.3f-%.3f", other.begin_s, other.end_s);
      std::printf("\n");
    }
  }
  result.time_ms = median(times, 0.9);
  result.worst_ms = median(times, 1);
  result.impulse_db = median(impulses);
  result.group_db = median(sums);
  return result;
}

std::string sentence_of(const Comparison& result) {
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(),
                "found %zu of %zu, %zu false, of which %zu are pushes, 90%% within %.2f ms, all within %.2f ms, median "
                "%.2f dB; %zu groups, "
                "median %.2f dB; %zu of %zu ends of slides within two frames",
                result.found, result.alone, result.false_ones, result.pushes, result.time_ms, result.worst_ms,
                result.impulse_db, result.groups, result.group_db, result.ends_found, result.ends);
  return text.data();
}

}  // namespace ringdown::test
