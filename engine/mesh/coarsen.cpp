#include "engine/mesh/coarsen.h"

#include "engine/base/triangle.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <queue>
#include <utility>

// The cheapest point first
//
// For every point the cheapest collapse is stored: the neighbour it moves onto, and the increase of the cost of the
// samples around it. A queue returns the point with the least increase. A collapse changes the increases of the points
// around it. Those are marked as outdated and computed again only when they reach the front of the queue, which saves
// most of the work, because increases mostly grow. The increase of points at narrow triangles is divided by ten, so
// that such triangles are removed first.
namespace ringdown::mesh {
namespace {

using Facet = std::array<std::uint32_t, 3>;

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kNarrowShare = 0.1;  // factor on the increase of a move that makes triangles less narrow
constexpr double kMinTurn = 0.2;      // cosine of the largest angle by which a move may turn a triangle
constexpr double kWider = 0.01;  // least gain, in the cosine of an angle, for which an edge is flipped or a point moved
constexpr double kSlack = 0.0113;       // narrowness of 20.2 degrees, allowed if no other move is left: regular grids
constexpr double kMinTurnCosine = 0.9;  // cosine of the largest angle by which flips and moves may turn a triangle
constexpr double kMendingLimit = 3;     // largest increase for a wider angle, in units of the mean cost of a point
constexpr double kFragment =
    0.1;  // longest side, in distance units, of a detail that may be removed although it has sharp edges
constexpr double kMinBend = 0.5;  // cosine of the largest angle by which a sharp edge may bend at a removed point
const double kEdgeCosine = std::cos(kSharpEdge_deg / 180 * std::numbers::pi);
const double kNarrowCosine = std::cos(kMinAngle_deg / 180 * std::numbers::pi);

Vec3 row(const Points& list, Eigen::Index i) { return {list(i, 0), list(i, 1), list(i, 2)}; }

double cosine_between(Vec3 a, Vec3 b) { return dot(a, b) / std::max(length(a) * length(b), 1e-300); }

// The cosine of the least angle.
double min_angle_cosine(const std::array<Vec3, 3>& v) {
  const Vec3 a = v[1] - v[0], b = v[2] - v[1], c = v[0] - v[2];
  return std::max({-cosine_between(a, c), -cosine_between(b, a), -cosine_between(c, b)});
}

bool has(const Facet& facet, std::uint32_t point) {
  return std::find(facet.begin(), facet.end(), point) != facet.end();
}

// The point of a facet that a sample is projected onto, and the cost of the sample there.
struct Projection {
  std::uint32_t facet = 0;
  std::array<double, 3> weights{};
  double cost = kInfinite;
};

// Facets that replace others, and the new projections of the samples.
struct Change {
  std::vector<std::uint32_t> old;
  std::vector<std::pair<std::uint32_t, Facet>> made;  // numbers, reused from old facets, and new facets
  std::vector<std::pair<std::uint32_t, Projection>> projections;
  double increase = 0;
};

struct Candidate {
  double increase = 0;
  std::uint32_t point = 0, version = 0;
  bool operator<(const Candidate& other) const {  // the cheapest first; among equals, the lowest number
    return std::pair(increase, point) > std::pair(other.increase, other.point);
  }
};

}  // namespace

class Coarsening::Mesh {
 public:
  Mesh(const Points& points, std::vector<Facet> facets, Eigen::MatrixXf fields, SurfaceSamples samples, double unit_m)
      : fields_(std::move(fields)),
        samples_(std::move(samples)),
        unit_m_(unit_m),
        facets_(std::move(facets)),
        around_(points.rows()),
        sharp_(points.rows()),
        on_(facets_.size()),
        origins_(points.rows()),
        projections_(samples_.areas.size()),
        targets_(points.rows(), kNone),
        versions_(points.rows(), 0),
        outdated_(points.rows(), 1) {
    assert(!facets_.empty() && projections_.size() % facets_.size() == 0);
    for (Eigen::Index p = 0; p < points.rows(); ++p) points_.push_back(row(points, p));
    const std::size_t share = projections_.size() / facets_.size();
    for (std::uint32_t f = 0; f < facets_.size(); ++f) {
      for (const std::uint32_t p : facets_[f]) around_[p].push_back(f);
      for (std::size_t s = f * share; s < (f + 1) * share; ++s) {
        on_[f].push_back(static_cast<std::uint32_t>(s));
        projections_[s] = project(static_cast<std::uint32_t>(s), {{f, facets_[f]}}, false);
      }
    }
    for (const auto& facets_there : around_) left_ += facets_there.empty() ? 0 : 1;
    find_sharp_edges();
    std::iota(origins_.begin(), origins_.end(), Eigen::Index{0});
    for (const Projection& projection : projections_) cost_ += projection.cost;
    queue_all();
  }

  [[nodiscard]] std::size_t left() const { return left_; }
  [[nodiscard]] const std::vector<Facet>& facets() const { return facets_; }
  [[nodiscard]] const std::vector<Projection>& projections() const { return projections_; }
  [[nodiscard]] const std::vector<Eigen::Index>& origins() const { return origins_; }

  bool reduce_to(std::size_t wanted, bool any_angle) {
    if (any_angle && !std::exchange(any_angle_, true)) queue_all();
    std::size_t mended = left_ + 1;  // how many points were left when the queue ran empty
    while (left_ > wanted) {
      if (queue_.empty() && (std::exchange(mended, left_) == left_ || !mend())) {
        if (std::exchange(slack_, kSlack) > 0) return false;
        queue_all();
      }
      const Candidate candidate = queue_.top();
      queue_.pop();
      const std::uint32_t p = candidate.point;
      if (candidate.version != versions_[p] || around_[p].empty()) continue;
      if (std::exchange(outdated_[p], 0) != 0 || !may_move(p, ring(p), targets_[p])) {
        find_target(p);
      } else {
        front_increase_ = candidate.increase;
        remove(p);
      }
    }
    (void)mend();
    return true;
  }

 private:
  [[nodiscard]] Vec3 position(std::uint32_t sample) const { return row(samples_.positions, sample); }
  [[nodiscard]] std::array<Vec3, 3> corners(const Facet& f) const {
    return {points_[f[0]], points_[f[1]], points_[f[2]]};
  }
  [[nodiscard]] Vec3 normal(const Facet& f) const {
    return cross(points_[f[1]] - points_[f[0]], points_[f[2]] - points_[f[0]]);
  }
  [[nodiscard]] double min_cosine(const Facet& f) const { return min_angle_cosine(corners(f)); }

  // The excess of the cosine of the least angle over the cosine of kMinAngle_deg; 0 for facets that are wide enough.
  [[nodiscard]] double narrowness(const Facet& f) const { return std::max(0.0, min_cosine(f) - kNarrowCosine); }

  // Projects the sample onto the nearest of the facets that face its way; the cost is infinite when none does.
  [[nodiscard]] Projection project(std::uint32_t s, const std::vector<std::pair<std::uint32_t, Facet>>& facets,
                                   bool facing = true) const {
    const Vec3 from = position(s), outward = row(samples_.normals, s);
    Projection best;
    double nearest = kInfinite;
    const Facet* chosen = nullptr;
    for (const auto& [number, facet] : facets) {
      if (facing && dot(normal(facet), outward) <= 0) continue;
      const auto weights = nearest_on_triangle(from, corners(facet));
      const Vec3 away = at_weights(corners(facet), weights) - from;
      if (dot(away, away) < nearest) {
        nearest = dot(away, away);
        best.facet = number;
        best.weights = weights;
        chosen = &facet;
      }
    }
    if (chosen == nullptr) return best;
    const auto& [a, b, c] = *chosen;
    const auto w = [&best](int i) { return static_cast<float>(best.weights[i]); };
    const float lost =
        (samples_.fields.col(s) - w(0) * fields_.col(a) - w(1) * fields_.col(b) - w(2) * fields_.col(c)).squaredNorm();
    best.cost = samples_.areas[s] * (lost + nearest / (unit_m_ * unit_m_));
    return best;
  }

  // Projects the samples of the old facets onto the new ones, and sums the increases of their costs.
  void evaluate(Change& change) const {
    for (const std::uint32_t f : change.old) {
      for (const std::uint32_t s : on_[f]) {
        change.projections.emplace_back(s, project(s, change.made));
        change.increase += change.projections.back().second.cost - projections_[s].cost;
      }
    }
  }

  void apply(const Change& change) {
    for (const std::uint32_t f : change.old) {
      for (const std::uint32_t p : facets_[f]) std::erase(around_[p], f);
      facets_[f].fill(kNone);
      on_[f].clear();
    }
    for (const auto& [f, facet] : change.made) {
      facets_[f] = facet;
      for (const std::uint32_t p : facet) around_[p].push_back(f);
    }
    for (const auto& [s, projection] : change.projections) {
      cost_ += projection.cost - projections_[s].cost;
      projections_[s] = projection;
      on_[projection.facet].push_back(s);
    }
  }

  // Every edge between facets that meet at more than kSharpEdge_deg joins its two ends in `sharp_`.
  void find_sharp_edges() {
    for (std::uint32_t p = 0; p < around_.size(); ++p) {
      for (const std::uint32_t f : around_[p]) {
        for (const std::uint32_t g : around_[p]) {
          if (f >= g || cosine_between(normal(facets_[f]), normal(facets_[g])) > kEdgeCosine) continue;
          for (const std::uint32_t q : facets_[f]) {
            if (q > p && has(facets_[g], q)) {
              sharp_[p].push_back(q);
              sharp_[q].push_back(p);
            }
          }
        }
      }
    }
  }

  [[nodiscard]] bool is_sharp(std::uint32_t p, std::uint32_t q) const {
    return std::find(sharp_[p].begin(), sharp_[p].end(), q) != sharp_[p].end();
  }

  // Returns true if p and q are close neighbours beside a narrow facet; they then belong to a step or spike of the
  // original triangles.
  [[nodiscard]] bool is_fragment(std::uint32_t p, std::uint32_t q) const {
    if (length(points_[p] - points_[q]) > kFragment * unit_m_) return false;
    return std::any_of(around_[p].begin(), around_[p].end(),
                       [&](std::uint32_t f) { return has(facets_[f], q) && narrowness(facets_[f]) > 0; });
  }

  // Returns true if sharp edges allow p to move onto its neighbour q: points of a sharp edge move along the edge,
  // corners do not move.
  [[nodiscard]] bool keeps_edges(std::uint32_t p, std::uint32_t q) const {
    if (sharp_[p].empty() || any_angle_ || is_fragment(p, q)) return true;
    if (sharp_[p].size() > 2 || !is_sharp(p, q)) return false;
    const std::uint32_t other = sharp_[p].front() == q ? sharp_[p].back() : sharp_[p].front();
    return other == q ||
           (!is_sharp(other, q) && cosine_between(points_[q] - points_[p], points_[p] - points_[other]) > kMinBend);
  }

  // Gives the sharp edges of p to q, onto which p moves.
  void hand_on_edges(std::uint32_t p, std::uint32_t q) {
    std::erase(sharp_[q], p);
    for (const std::uint32_t other : std::exchange(sharp_[p], {})) {
      std::erase(sharp_[other], p);
      if (other == q || is_sharp(other, q)) continue;
      sharp_[other].push_back(q);
      sharp_[q].push_back(other);
    }
  }

  // Returns the points around p, ascending; none if the facets there are not one closed fan.
  [[nodiscard]] std::vector<std::uint32_t> ring(std::uint32_t p) const {
    std::vector<std::uint32_t> points;  // each twice, where the surface is sound
    for (const std::uint32_t f : around_[p]) {
      for (const std::uint32_t q : facets_[f]) {
        if (q != p) points.push_back(q);
      }
    }
    std::sort(points.begin(), points.end());
    for (std::size_t i = 0; i < points.size(); i += 2) {
      const bool twice = points[i] == points[i + 1] && (i + 2 == points.size() || points[i + 2] != points[i]);
      if (!twice) return {};
    }
    points.erase(std::unique(points.begin(), points.end()), points.end());
    return points;
  }

  // Returns true if the facets still form a closed surface with its sharp edges after p moves onto its neighbour q (the
  // link condition). `ring_p` is ring(p).
  [[nodiscard]] bool may_move(std::uint32_t p, const std::vector<std::uint32_t>& ring_p, std::uint32_t q) const {
    if (!keeps_edges(p, q)) return false;
    const std::vector<std::uint32_t> ring_q = ring(q);
    std::vector<std::uint32_t> common;
    std::set_intersection(ring_p.begin(), ring_p.end(), ring_q.begin(), ring_q.end(), std::back_inserter(common));
    return common.size() == 2 && around_[common[0]].size() > 3 && around_[common[1]].size() > 3;
  }

  // Returns the facets around p after p moves to q; nothing if their total narrowness grows or one of them turns over.
  [[nodiscard]] std::optional<Change> moved(std::uint32_t p, std::uint32_t q) const {
    Change change{.old = around_[p]};
    double before = 0, after = 0, worst = 0;
    for (const std::uint32_t f : around_[p]) {
      before += narrowness(facets_[f]);
      Facet facet = facets_[f];
      if (has(facet, q)) continue;
      std::replace(facet.begin(), facet.end(), p, q);
      if (cosine_between(normal(facet), normal(facets_[f])) <= kMinTurn) return std::nullopt;
      after += narrowness(facet);
      worst = std::max(worst, narrowness(facet));
      change.made.emplace_back(f, facet);
    }
    if (after > before && worst > slack_ && !any_angle_) return std::nullopt;
    evaluate(change);
    if (after < before && change.increase > 0) change.increase *= kNarrowShare;
    return change;
  }

  void find_target(std::uint32_t p) {
    double best = kInfinite;
    const std::vector<std::uint32_t> neighbours = ring(p);
    for (const std::uint32_t q : neighbours) {
      if (!may_move(p, neighbours, q)) continue;
      const std::optional<Change> change = moved(p, q);
      if (change && change->increase < best) {
        best = change->increase;
        targets_[p] = q;
      }
    }
    if (std::isfinite(best)) queue_.push({best, p, ++versions_[p]});
  }

  // Marks the increase of a point as outdated and puts the point at the front of the queue.
  void renew(std::uint32_t p) {
    outdated_[p] = 1;
    queue_.push({front_increase_, p, ++versions_[p]});
  }

  void queue_all() {
    for (std::uint32_t p = 0; p < around_.size(); ++p) {
      if (!around_[p].empty()) renew(p);
    }
  }

  void remove(std::uint32_t p) {
    const std::vector<std::uint32_t> neighbours = ring(p);
    apply(*moved(p, targets_[p]));
    hand_on_edges(p, targets_[p]);
    --left_;
    for (const std::uint32_t q : neighbours) renew(q);
  }

  // Flips the edge between a and b, if that widens the least angle of its two facets and is cheap or repairs a narrow
  // facet.
  bool flip(std::uint32_t a, std::uint32_t b) {
    std::vector<std::uint32_t> beside;
    for (const std::uint32_t f : around_[a]) {
      if (has(facets_[f], b)) beside.push_back(f);
    }
    if (is_sharp(a, b) || beside.size() != 2 || around_[a].size() < 4 || around_[b].size() < 4) return false;
    const auto third = [&](const Facet& f) { return f[0] + f[1] + f[2] - a - b; };
    std::uint32_t c = third(facets_[beside[0]]), d = third(facets_[beside[1]]);
    const auto joined = [&](std::uint32_t f) { return has(facets_[f], d); };
    if (c == d || std::any_of(around_[c].begin(), around_[c].end(), joined)) return false;
    const Facet& first = facets_[beside[0]];
    for (int i = 0; i < 3; ++i) {
      if (first[i] == b && first[(i + 1) % 3] == a) std::swap(c, d);  // now a, b, c turn as the surface does
    }
    Change change{.old = beside, .made = {{beside[0], {a, d, c}}, {beside[1], {d, b, c}}}};
    double before = -1, after = -1, turn = 1;
    for (int i = 0; i < 2; ++i) {
      before = std::max(before, min_cosine(facets_[beside[i]]));
      after = std::max(after, min_cosine(change.made[i].second));
      for (const std::uint32_t f : beside)
        turn = std::min(turn, cosine_between(normal(change.made[i].second), normal(facets_[f])));
    }
    if (after > before - kWider || turn < kMinTurnCosine) return false;
    evaluate(change);
    if (change.increase > (before > kNarrowCosine ? mending_limit() : 0)) return false;
    apply(change);
    for (const std::uint32_t p : {a, b, c, d}) renew(p);
    return true;
  }

  // Moves p to the nearby sample that widens the least angle around p most, if that is cheap.
  bool shift(std::uint32_t p) {
    const std::vector<std::uint32_t> neighbours = ring(p);
    if (neighbours.empty() || !sharp_[p].empty()) return false;
    const Vec3 home = points_[p];
    double widest = 0;
    std::vector<Vec3> turned;
    std::vector<std::uint32_t> samples;
    for (const std::uint32_t f : around_[p]) {
      widest = std::max(widest, min_cosine(facets_[f]));
      turned.push_back(normal(facets_[f]));
      samples.insert(samples.end(), on_[f].begin(), on_[f].end());
    }
    std::uint32_t best = kNone;
    for (const std::uint32_t s : samples) {
      points_[p] = position(s);
      double narrowest = -1, turn = 1;
      for (std::size_t i = 0; i < turned.size(); ++i) {
        const Facet& facet = facets_[around_[p][i]];
        narrowest = std::max(narrowest, min_cosine(facet));
        turn = std::min(turn, cosine_between(normal(facet), turned[i]));
      }
      if (turn < kMinTurnCosine || narrowest > widest - kWider) continue;
      widest = narrowest;
      best = s;
    }
    points_[p] = home;
    if (best == kNone) return false;
    const Eigen::VectorXf fields = fields_.col(p);
    points_[p] = position(best);
    fields_.col(p) = samples_.fields.col(best);
    Change change{.old = around_[p]};
    for (const std::uint32_t f : around_[p]) change.made.emplace_back(f, facets_[f]);
    evaluate(change);
    if (change.increase > mending_limit()) {
      points_[p] = home;
      fields_.col(p) = fields;
      return false;
    }
    apply(change);
    origins_[p] = static_cast<Eigen::Index>(around_.size() + best);
    renew(p);
    for (const std::uint32_t q : neighbours) renew(q);
    return true;
  }

  [[nodiscard]] double mending_limit() const { return kMendingLimit * cost_ / static_cast<double>(left_); }

  // Flips edges and shifts the points of narrow triangles until nothing improves, a few rounds at most. Returns true if
  // anything changed.
  bool mend() {
    constexpr int kMaxRounds = 5;
    bool any = false, changed = true;
    for (int round = 0; round < kMaxRounds && changed; ++round) {
      changed = false;
      for (std::uint32_t p = 0; p < around_.size(); ++p) {
        for (const std::uint32_t q : ring(p)) changed = (p < q && flip(p, q)) || changed;
      }
      for (std::uint32_t f = 0; f < facets_.size(); ++f) {
        for (int i = 0; i < 3 && facets_[f][0] != kNone && min_cosine(facets_[f]) > kNarrowCosine; ++i) {
          changed = shift(facets_[f][i]) || changed;
        }
      }
      any = any || changed;
    }
    return any;
  }

  std::vector<Vec3> points_;
  Eigen::MatrixXf fields_;
  SurfaceSamples samples_;
  double unit_m_;
  std::vector<Facet> facets_;                       // removed facets consist of kNone
  std::vector<std::vector<std::uint32_t>> around_;  // facets at each point; none if the point was removed
  std::vector<std::vector<std::uint32_t>> sharp_;   // neighbours of each point along sharp edges
  std::vector<std::vector<std::uint32_t>> on_;      // samples on each facet
  std::vector<Eigen::Index> origins_;               // place of each point, as origins() returns it
  std::vector<Projection> projections_;             // projection of each sample
  std::vector<std::uint32_t> targets_,
      versions_;                // for each point: the neighbour it would move onto; the number of its valid candidate
  std::vector<char> outdated_;  // whether the target and the increase of a point must be computed again
  std::priority_queue<Candidate> queue_;
  std::size_t left_ = 0;
  double front_increase_ = 0, cost_ = 0, slack_ = 0;
  bool any_angle_ = false;
};

Coarsening::Coarsening(const Points& points, std::vector<Facet> triangles, Eigen::MatrixXf fields,
                       SurfaceSamples samples, double distance_unit_m)
    : mesh_(std::make_unique<Mesh>(points, std::move(triangles), std::move(fields), std::move(samples),
                                   distance_unit_m)) {}
Coarsening::~Coarsening() = default;
Coarsening::Coarsening(const Coarsening& other) : mesh_(std::make_unique<Mesh>(*other.mesh_)) {}
Coarsening& Coarsening::operator=(Coarsening&&) noexcept = default;

bool Coarsening::reduce_to(std::size_t points, bool any_angle) { return mesh_->reduce_to(points, any_angle); }
std::size_t Coarsening::point_count() const { return mesh_->left(); }

std::vector<Facet> Coarsening::triangles() const {
  std::vector<Facet> found = mesh_->facets();
  std::erase_if(found, [](const Facet& f) { return f[0] == kNone; });
  return found;
}

const std::vector<Eigen::Index>& Coarsening::origins() const { return mesh_->origins(); }

std::vector<SurfacePlace> Coarsening::places() const {
  std::vector<std::uint32_t> number;  // number of each facet among the remaining ones
  std::uint32_t next = 0;
  for (const Facet& f : mesh_->facets()) number.push_back(f[0] == kNone ? kNone : next++);
  std::vector<SurfacePlace> found;
  for (const Projection& projection : mesh_->projections())
    found.push_back({number[projection.facet], projection.weights});
  return found;
}

}  // namespace ringdown::mesh
