#include "tests/bench/modal/plan.h"

namespace ringdown::bench {
namespace {

std::string place(const Measurement& m) {
  return m.spec.body + ", " + std::to_string(m.unknowns) + " unknowns, " + std::to_string(m.modes) + " modes: ";
}

Promise not_measured(const std::string& what, const Measurement* m) {
  if (m == nullptr) return {what + ": not measured", Promise::kNotMeasured};
  if (m->status == Status::kNotInstalled) return {what + ": not installed", Promise::kNotMeasured};
  return {what + (m->status == Status::kOverLimit ? ": took too long" : ": failed: " + m->complaint), Promise::kMissed};
}

// Peers over their limit were at least so slow.
bool has_time(const Measurement* m) {
  return m != nullptr && (m->status == Status::kDone || m->status == Status::kOverLimit);
}

Promise ratio(const std::string& name, const Measurement* peer, const Measurement* ours, double min) {
  const std::string what = "times as fast as " + name;
  if (ours == nullptr || ours->status != Status::kDone) return not_measured("ours beside " + name, ours);
  if (!has_time(peer)) return not_measured(place(*ours) + what, peer);
  return at_least(place(*ours) + what, peer->seconds / ours->seconds, min, peer->status == Status::kOverLimit);
}

// Two programs that share no code, on one mesh: the frequencies are those of the mesh.
void add_agreement(std::vector<Promise>& list, const Measurement* peer) {
  if (peer == nullptr) return;
  if (peer->status == Status::kOverLimit) {  // a peer's slowness is not a promise of ours
    return list.push_back({peer->spec.body + ": " + peer->spec.method + ": took too long", Promise::kNotMeasured});
  }
  if (peer->status != Status::kDone)
    return list.push_back(not_measured(peer->spec.body + ": " + peer->spec.method, peer));
  const std::string what = place(*peer) + "largest relative difference from " + peer->spec.method;
  if (peer->difference < 0) return list.push_back({what + ": other numbers of modes", Promise::kMissed});
  list.push_back(at_most(what, peer->difference, 1e-5, ""));
}

void add_agreements(std::vector<Promise>& list, const Measurements& all, const Spec& ours) {
  for (const char* peer : {"spectra-cholmod", "slepc-cholmod", "slepc-mumps", "slepc-petsc"}) {
    add_agreement(list, find(all, ours.by(peer)));
  }
}

void add_peers(std::vector<Promise>& list, const Measurements& all, const Spec& ours) {
  const Measurement* one = find(all, ours);
  list.push_back(ratio("Spectra over CHOLMOD", find(all, ours.by("spectra-cholmod")), one, 3));
  const Measurement* slepc = fastest_slepc(all, ours);
  const std::string way = slepc ? " (" + slepc->spec.method.substr(6) + ", its fastest)" : "";
  list.push_back(ratio("SLEPc" + way, slepc ? slepc : find(all, ours.by("slepc-cholmod")), one, 3));
  list.push_back(ratio("CalculiX", find(all, ours.by("ccx")), one, 5));
}

void add_threads(std::vector<Promise>& list, const Measurements& all, const Spec& two) {
  const Measurement *with_one = find(all, two.by("ours", 1)), *with_two = find(all, two);
  if (!has_time(with_one) || !has_time(with_two))
    return list.push_back(not_measured(two.body + ", 2 threads", with_two));
  list.push_back(at_least(place(*with_two) + "2 threads over 1", with_one->seconds / with_two->seconds, 1.6));
}

void add_errors(std::vector<Promise>& list, const Measurement* m, const Spec& spec) {
  if (m == nullptr || m->status != Status::kDone) {
    return list.push_back(not_measured(spec.body + " with default settings", m));
  }
  const std::string what = place(*m) + "with default settings, worst error of the first ";
  const auto add = [&](const char* count, double error, double max) {
    if (error < 0) return list.push_back({what + count + ": fewer modes were found", Promise::kMissed});
    list.push_back(at_most(what + count, error, max, " %"));
  };
  add("10", m->error_10, 0.02);
  add("50", m->error_50, 0.1);
}

}  // namespace

std::vector<Promise> promises(const std::vector<Spec>& plan, const Measurements& all, bool quick) {
  std::vector<Promise> list;
  for (const Spec& spec : plan) {
    const std::string& part = spec.part;
    const Measurement* m = find(all, spec);
    if (part == "agreement" && spec.method == "ccx") add_agreement(list, m);
    if (part == "peers" && spec.method == "ours") add_agreements(list, all, spec);
    if (quick) continue;
    if (part == "default") add_errors(list, m, spec);
    if (part == "peers" && spec.method == "ours") add_peers(list, all, spec);
    if (part == "threads") add_threads(list, all, spec);
    if (part == "many" && spec.method == "spectra-cholmod")
      list.push_back(ratio("Spectra over CHOLMOD", m, find(all, spec.by("ours")), 4));
    if (part != "memory") continue;
    if (m == nullptr || m->status != Status::kDone) list.push_back(not_measured("memory", m));
    if (m != nullptr && m->status == Status::kDone)
      list.push_back(at_most(place(*m) + "peak memory", m->peak_mib, 4096, " MiB"));
  }
  return list;
}

}  // namespace ringdown::bench
