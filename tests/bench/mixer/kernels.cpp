#include "tests/bench/mixer/kernels.h"

#include "tests/synth/mode_bundle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

namespace ringdown::bench {
namespace {

std::complex<double> exponent_of(const Sinusoid& mode) {
  return {-mode.decay_per_s / kRate, 2 * std::numbers::pi * mode.frequency_hz / kRate};
}

// exp(-d t) sin(omega t) for every mode and sample.
class ClosedForm : public Kernel {
 public:
  explicit ClosedForm(const std::vector<Sinusoid>& modes) : modes_(modes) {}
  void render(std::span<double> out) override {
    std::fill(out.begin(), out.end(), 0.0);
    for (const Sinusoid& mode : modes_) {
      const double omega = 2 * std::numbers::pi * mode.frequency_hz;
      for (std::size_t n = 0; n < out.size(); ++n) {
        const double t = (frame_ + static_cast<double>(n)) / kRate;
        out[n] += mode.amplitude * std::exp(-mode.decay_per_s * t) * std::sin(omega * t);
      }
    }
    frame_ += static_cast<double>(out.size());
  }

 private:
  std::vector<Sinusoid> modes_;
  double frame_ = 0;
};

// y[n] = 2 Re(p) y[n-1] - |p|^2 y[n-2], mode by mode.
class TwoPoleFilters : public Kernel {
 public:
  explicit TwoPoleFilters(const std::vector<Sinusoid>& modes) {
    for (const Sinusoid& mode : modes) {
      const std::complex<double> pole = std::exp(exponent_of(mode)), before = mode.amplitude / pole;
      filters_.push_back({2 * pole.real(), std::norm(pole), before.imag(), (before / pole).imag()});
    }
  }
  void render(std::span<double> out) override {
    std::fill(out.begin(), out.end(), 0.0);
    for (Filter& filter : filters_) {
      Filter f = filter;  // in registers: the compiler cannot know that `out` is elsewhere, and would be 3 times slower
      for (double& sample : out) {
        const double y = f.a * f.y1 - f.b * f.y2;
        f.y2 = f.y1;
        f.y1 = y;
        sample += y;
      }
      filter = f;
    }
  }

 private:
  struct Filter {
    double a, b, y1, y2;
  };
  std::vector<Filter> filters_;
};

// 64 bytes of T: the compiler cuts it to the registers there are.
template <class T>
struct Lanes {
  using Vector [[gnu::vector_size(64)]] = T;
  static constexpr std::size_t kCount = 64 / sizeof(T);
  Vector v;
  void set(std::size_t lane, double value) { v[lane] = static_cast<T>(value); }
};

template <class T>
struct TwoPole {
  Lanes<T> a{}, b{}, y1{}, y2{};
  void set(std::size_t lane, const Sinusoid& mode) {
    const std::complex<double> pole = std::exp(exponent_of(mode)), before = mode.amplitude / pole;
    a.set(lane, 2 * pole.real()), b.set(lane, std::norm(pole));
    y1.set(lane, before.imag()), y2.set(lane, (before / pole).imag());
  }
  void next_into(Lanes<T>& sum) {
    const auto y = a.v * y1.v - b.v * y2.v;
    y2.v = y1.v;
    y1.v = y;
    sum.v += y;
  }
};

template <class T>
struct Phasor {
  Lanes<T> z_re{}, z_im{}, pole_re{}, pole_im{};
  void set(std::size_t lane, const Sinusoid& mode) {
    const std::complex<double> pole = std::exp(exponent_of(mode));
    z_im.set(lane, -mode.amplitude);
    pole_re.set(lane, pole.real()), pole_im.set(lane, pole.imag());
  }
  void next_into(Lanes<T>& sum) {
    sum.v += z_re.v;
    const auto re = z_re.v * pole_re.v - z_im.v * pole_im.v;
    z_im.v = z_re.v * pole_im.v + z_im.v * pole_re.v;
    z_re.v = re;
  }
};

// A recurrence with modes in lanes, four vectors at once to hide its latency.
template <template <class> class Recurrence, class T>
class InLanes : public Kernel {
 public:
  explicit InLanes(const std::vector<Sinusoid>& modes)
      : groups_((modes.size() + kGroup * Lanes<T>::kCount - 1) / (kGroup * Lanes<T>::kCount)) {
    for (std::size_t m = 0; m < modes.size(); ++m) {
      const std::size_t vector = m / Lanes<T>::kCount;
      groups_[vector / kGroup][vector % kGroup].set(m % Lanes<T>::kCount, modes[m]);
    }
  }
  void render(std::span<double> out) override {
    std::array<Lanes<T>, kMaxFrames> sums{};
    for (Group& group : groups_) {
      Recurrence<T> a = group[0], b = group[1], c = group[2], d = group[3];
      for (std::size_t n = 0; n < out.size(); ++n) {
        Lanes<T> sum = sums[n];
        a.next_into(sum), b.next_into(sum), c.next_into(sum), d.next_into(sum);
        sums[n] = sum;
      }
      group = {a, b, c, d};
    }
    for (std::size_t n = 0; n < out.size(); ++n) {
      out[n] = 0;
      for (std::size_t lane = 0; lane < Lanes<T>::kCount; ++lane) out[n] += static_cast<double>(sums[n].v[lane]);
    }
  }

 private:
  static constexpr std::size_t kGroup = 4;
  using Group = std::array<Recurrence<T>, kGroup>;
  std::vector<Group> groups_;
};

// What the mixer is made of: tables where modes are few, moments where they are many.
template <synth::test::Kernel kKernel>
class Ours : public Kernel {
 public:
  explicit Ours(const std::vector<Sinusoid>& modes) : bundle_(modes_of(modes), kRate, kKernel) {}
  void render(std::span<double> out) override {
    std::fill(out.begin(), out.end(), 0.0);
    for (std::size_t done = 0; done < out.size(); done += synth::kChunkFrames) {
      bundle_.add(out.data() + done, std::min(synth::kChunkFrames, out.size() - done));
    }
  }

 private:
  static std::vector<synth::test::Mode> modes_of(const std::vector<Sinusoid>& sinusoids) {
    std::vector<synth::test::Mode> modes;
    for (const Sinusoid& s : sinusoids)
      modes.push_back({s.frequency_hz, std::log(1000.0) / s.decay_per_s, {0, -s.amplitude}});
    return modes;
  }

  synth::test::Bundle bundle_;
};

template <class K>
std::unique_ptr<Kernel> make(const std::vector<Sinusoid>& modes) {
  return std::make_unique<K>(modes);
}

}  // namespace

const std::vector<KernelMaker>& kernels() {
  static const std::vector<KernelMaker> list = {
      {"closed form", false, make<ClosedForm>},
      {"two-pole", false, make<TwoPoleFilters>},
      {"two-pole float SIMD", false, make<InLanes<TwoPole, float>>},
      {"two-pole double SIMD", true, make<InLanes<TwoPole, double>>},
      {"phasor float SIMD", false, make<InLanes<Phasor, float>>},
      {"phasor double SIMD", true, make<InLanes<Phasor, double>>},
      {"ours: tables", true, make<Ours<synth::test::Kernel::direct>>},
  };
  return list;
}

const KernelMaker& kernel(const std::string& name) {
  return *std::find_if(kernels().begin(), kernels().end(), [&](const KernelMaker& k) { return k.name == name; });
}

}  // namespace ringdown::bench
