#include "engine/shatter/part_graph.h"

#include "engine/base/groups.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <utility>

namespace ringdown::shatter {
namespace {

// Numbers arbitrary part names from 0 in the order of the first bits.
Parts renumbered(const std::vector<std::int32_t>& names) {
  std::map<std::int32_t, std::int32_t> number_of;
  Parts parts;
  for (const std::int32_t name : names) {
    parts.push_back(number_of.try_emplace(name, static_cast<std::int32_t>(number_of.size())).first->second);
  }
  return parts;
}

}  // namespace

std::int32_t count_of(const Parts& parts) {
  return parts.empty() ? 0 : *std::max_element(parts.begin(), parts.end()) + 1;
}

Parts connected_parts(const PartGraph& graph, const std::vector<std::int32_t>& labels) {
  Groups<> groups(labels.size());
  for (const auto& [a, b, area_m2] : graph.joints) {
    if (labels[a] == labels[b]) groups.join(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
  }
  std::vector<std::int32_t> names;
  for (std::size_t bit = 0; bit < labels.size(); ++bit) names.push_back(static_cast<std::int32_t>(groups.root(bit)));
  return renumbered(names);
}

std::vector<double> volumes_of(const PartGraph& graph, const Parts& parts) {
  std::vector<double> volumes_m3(static_cast<std::size_t>(count_of(parts)), 0);
  for (std::size_t bit = 0; bit < parts.size(); ++bit) volumes_m3[parts[bit]] += graph.volumes_m3[bit];
  return volumes_m3;
}

std::vector<std::int32_t> main_labels(const PartGraph& graph, const Parts& parts,
                                      const std::vector<std::int32_t>& labels) {
  std::vector<std::map<std::int32_t, double>> shares(static_cast<std::size_t>(count_of(parts)));
  for (std::size_t bit = 0; bit < parts.size(); ++bit) shares[parts[bit]][labels[bit]] += graph.volumes_m3[bit];
  std::vector<std::int32_t> main;
  main.reserve(shares.size());
  for (const auto& share : shares) {
    main.push_back(std::max_element(share.begin(), share.end(), [](const auto& a, const auto& b) {
                     return a.second < b.second;
                   })->first);
  }
  return main;
}

PartGraph merged(const PartGraph& graph, const Parts& parts) {
  PartGraph merged{volumes_of(graph, parts), {}, {}};
  merged.places.assign(merged.volumes_m3.size(), Eigen::Vector3d::Zero());
  for (std::size_t bit = 0; bit < parts.size(); ++bit) {
    merged.places[parts[bit]] += graph.volumes_m3[bit] / merged.volumes_m3[parts[bit]] * graph.places[bit];
  }
  std::map<std::pair<std::int32_t, std::int32_t>, double> areas_m2;
  for (const auto& [a, b, area_m2] : graph.joints) {
    if (parts[a] != parts[b]) areas_m2[std::minmax(parts[a], parts[b])] += area_m2;
  }
  for (const auto& [pair, area_m2] : areas_m2) merged.joints.push_back({pair.first, pair.second, area_m2});
  return merged;
}

Parts joined_small(const PartGraph& graph, const Parts& parts, const std::vector<std::int32_t>& families,
                   double least_m3) {
  const PartGraph whole = merged(graph, parts);
  const std::size_t count = whole.volumes_m3.size();
  std::vector<double> volumes_m3 = whole.volumes_m3;
  std::vector<std::int32_t> family = main_labels(graph, parts, families), joined_to(count);
  std::vector<std::map<std::int32_t, double>> neighbours(count);
  for (const auto& [a, b, area_m2] : whole.joints) neighbours[a][b] = neighbours[b][a] = area_m2;
  std::vector<bool> is_small(count);
  for (std::size_t part = 0; part < count; ++part) {
    joined_to[part] = static_cast<std::int32_t>(part);
    is_small[part] = volumes_m3[part] < least_m3 && !neighbours[part].empty();
  }
  for (;;) {
    std::int32_t small = -1;
    for (std::size_t part = 0; part < count; ++part) {
      if (is_small[part] && (small < 0 || volumes_m3[part] < volumes_m3[small]))
        small = static_cast<std::int32_t>(part);
    }
    if (small < 0) break;
    const auto better = [&](const auto& a, const auto& b) {
      const bool a_kin = family[a.first] == family[small], b_kin = family[b.first] == family[small];
      return a_kin != b_kin ? b_kin : a.second < b.second;
    };
    const auto& own = neighbours[small];
    const std::int32_t into = std::max_element(own.begin(), own.end(), better)->first;
    for (const auto& [other, area_m2] : own) {
      neighbours[other].erase(small);
      if (other != into) neighbours[into][other] = neighbours[other][into] += area_m2;
    }
    neighbours[small].clear();
    if (volumes_m3[small] > volumes_m3[into]) family[into] = family[small];
    volumes_m3[into] += volumes_m3[small];
    joined_to[small] = into;
    is_small[small] = false;
    is_small[into] = volumes_m3[into] < least_m3 && !neighbours[into].empty();
  }
  std::vector<std::int32_t> names;
  for (std::int32_t part : parts) {
    while (joined_to[part] != part) part = joined_to[part];
    names.push_back(part);
  }
  return renumbered(names);
}

// Necks
//
// The minimum cut between two sets of bits is found by the maximum flow between them (Dinic, Soviet Math. Doklady 11,
// 1970), each joint carrying as much as its area. The far ends of a part are found by shortest paths along joints.
namespace {

struct Arc {
  std::int32_t to;
  double length_m, free_m2;
  std::size_t back;  // position of the opposite arc at `to`
};

class Neck {
 public:
  Neck(const PartGraph& graph, const std::vector<std::int32_t>& bits, const std::vector<std::vector<Arc>>& arcs)
      : graph_(graph), arcs_(arcs) {
    for (const std::int32_t bit : bits) volume_m3_ += graph.volumes_m3[bit];
  }

  // Returns the bits on one side of the neck; none if there is no neck. A fifth of the volume finds the narrowest place
  // in the middle, a twentieth finds small ends.
  std::vector<std::int32_t> find(std::int32_t any) {
    const std::vector<std::int32_t> from_any = by_distance(any);
    const std::vector<std::int32_t> forth = by_distance(from_any.back()), back = by_distance(forth.back());
    const std::vector<std::vector<Arc>> arcs = arcs_;
    for (const double share : {0.2, 0.05}) {
      arcs_ = arcs;
      if (std::vector<std::int32_t> side = find_between(forth, back, share); !side.empty()) return side;
    }
    return {};
  }

 private:
  enum End : std::int8_t { kBetween, kSource, kSink };

  std::vector<std::int32_t> find_between(const std::vector<std::int32_t>& forth, const std::vector<std::int32_t>& back,
                                         double share) {
    ends_.assign(graph_.volumes_m3.size(), kBetween);
    sources_.clear();
    mark(forth, share, kSource);
    if (!mark(back, share, kSink)) return {};
    const std::optional<double> area_m2 = flow();
    if (!area_m2) return {};
    std::vector<std::int32_t> side;
    double side_m3 = 0;
    for (const std::int32_t bit : forth) {
      if (layer_[bit] >= 0) side.push_back(bit), side_m3 += graph_.volumes_m3[bit];
    }
    if (*area_m2 >= limit_m2(std::min(side_m3, volume_m3_ - side_m3))) return {};
    return side;
  }

  static double limit_m2(double volume_m3) { return kNarrow * std::cbrt(volume_m3 * volume_m3); }

  // All bits of the part, by ascending length of the path to `from`.
  std::vector<std::int32_t> by_distance(std::int32_t from) const {
    std::vector<std::int32_t> order;
    std::vector<double> distance_m(graph_.volumes_m3.size(), std::numeric_limits<double>::max());
    using Entry = std::pair<double, std::int32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
    waiting.emplace(distance_m[from] = 0, from);
    while (!waiting.empty()) {
      const auto [reached_m, bit] = waiting.top();
      waiting.pop();
      if (reached_m > distance_m[bit]) continue;
      order.push_back(bit);
      for (const Arc& arc : arcs_[bit]) {
        if (const double next_m = reached_m + arc.length_m; next_m < distance_m[arc.to]) {
          waiting.emplace(distance_m[arc.to] = next_m, arc.to);
        }
      }
    }
    return order;
  }

  // Marks bits up to a share of the volume, and always the first. Returns false if they meet the other end.
  bool mark(const std::vector<std::int32_t>& order, double share, End end) {
    double marked_m3 = 0;
    for (const std::int32_t bit : order) {
      if (marked_m3 > 0 && marked_m3 + graph_.volumes_m3[bit] > share * volume_m3_) break;
      if (ends_[bit] != kBetween) return false;
      ends_[bit] = end;
      if (end == kSource) sources_.push_back(bit);
      marked_m3 += graph_.volumes_m3[bit];
    }
    return true;
  }

  // Returns the maximum flow; none as soon as it is more than any neck of the part can carry.
  std::optional<double> flow() {
    double flow_m2 = 0;
    while (find_layers()) {
      next_.assign(arcs_.size(), 0);
      for (const std::int32_t source : sources_) {
        for (double more = 1; more > 0;) flow_m2 += more = push(source, std::numeric_limits<double>::max());
      }
      if (flow_m2 > limit_m2(0.5 * volume_m3_)) return std::nullopt;
    }
    return flow_m2;
  }

  bool find_layers() {
    layer_.assign(arcs_.size(), -1);
    std::vector<std::int32_t> reached = sources_;
    for (const std::int32_t source : sources_) layer_[source] = 0;
    bool at_sink = false;
    for (std::size_t k = 0; k < reached.size(); ++k) {
      if (ends_[reached[k]] == kSink) {
        at_sink = true;
        continue;
      }
      for (const Arc& arc : arcs_[reached[k]]) {
        if (arc.free_m2 <= 0 || layer_[arc.to] >= 0) continue;
        layer_[arc.to] = layer_[reached[k]] + 1;
        reached.push_back(arc.to);
      }
    }
    return at_sink;
  }

  double push(std::int32_t bit, double at_most_m2) {
    if (ends_[bit] == kSink) return at_most_m2;
    for (std::size_t& k = next_[bit]; k < arcs_[bit].size(); ++k) {
      Arc& arc = arcs_[bit][k];
      if (arc.free_m2 <= 0 || layer_[arc.to] != layer_[bit] + 1) continue;
      const double pushed = push(arc.to, std::min(at_most_m2, arc.free_m2));
      if (pushed <= 0) continue;
      arc.free_m2 -= pushed;
      arcs_[arc.to][arc.back].free_m2 += pushed;
      return pushed;
    }
    return 0;
  }

  const PartGraph& graph_;
  std::vector<std::vector<Arc>> arcs_;
  double volume_m3_ = 0;
  std::vector<End> ends_;
  std::vector<std::int32_t> sources_, layer_;
  std::vector<std::size_t> next_;
};

}  // namespace

// A part that is divided goes back to the end of the queue as two labels, which may fall into several connected parts.
Parts parted_at_necks(const PartGraph& graph, const Parts& parts) {
  Parts now = parts;
  std::vector<bool> is_done;  // by the first bit of a part, once no neck was found in it
  is_done.assign(parts.size(), false);
  for (bool again = true; again;) {
    again = false;
    std::vector<std::vector<std::int32_t>> bits(static_cast<std::size_t>(count_of(now)));
    for (std::size_t bit = 0; bit < now.size(); ++bit) bits[now[bit]].push_back(static_cast<std::int32_t>(bit));
    // Local copies: each part is a small graph of its own, so that a search costs what its part does.
    std::vector<std::int32_t> place(now.size());
    for (const auto& own : bits) {
      for (std::size_t k = 0; k < own.size(); ++k) place[own[k]] = static_cast<std::int32_t>(k);
    }
    std::vector<std::vector<std::vector<Arc>>> arcs(bits.size());
    for (std::size_t part = 0; part < bits.size(); ++part) arcs[part].resize(bits[part].size());
    for (const auto& [a, b, area_m2] : graph.joints) {
      if (now[a] != now[b]) continue;
      auto &from = arcs[now[a]][place[a]], &to = arcs[now[a]][place[b]];
      const double length_m = (graph.places[a] - graph.places[b]).norm();
      from.push_back({place[b], length_m, area_m2, to.size()});
      to.push_back({place[a], length_m, area_m2, from.size() - 1});
    }
    std::vector<std::int32_t> labels = now;
    std::int32_t next = count_of(now);
    for (std::size_t part = 0; part < bits.size(); ++part) {
      if (bits[part].size() < 2 || is_done[bits[part][0]]) continue;
      PartGraph own;
      std::vector<std::int32_t> numbers;
      for (const std::int32_t bit : bits[part]) {
        own.volumes_m3.push_back(graph.volumes_m3[bit]);
        numbers.push_back(place[bit]);
      }
      const std::vector<std::int32_t> side = Neck(own, numbers, arcs[part]).find(0);
      if (side.empty()) is_done[bits[part][0]] = true;
      for (const std::int32_t bit : side) labels[bits[part][bit]] = next;
      if (!side.empty()) {
        ++next;
        again = true;
      }
    }
    if (again) now = connected_parts(graph, labels);
  }
  return now;
}

}  // namespace ringdown::shatter
