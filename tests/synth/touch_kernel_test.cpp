// The free and the pushed motion of places of an object against recurrences in long double.
#include "engine/synth/kernels/aligned_array.h"
#include "engine/synth/kernels/drive_kernel.h"
#include "tests/synth/every_instruction_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

namespace ringdown::synth {
namespace {

using Complex = std::complex<long double>;

constexpr std::size_t kColumns = 5 * kModePadding, kPlaces = 3, kSteps = 64;

// Modes from a fraction of a hertz to Nyquist.
struct Touched {
  AlignedArray<double> z = aligned_zeros<double>(2 * kColumns), p = aligned_zeros<double>(2 * kColumns),
                       weight = aligned_zeros<double>(kPlaces * kColumns);

  Touched() {
    std::mt19937 random(3);
    const auto uniform = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
    for (std::size_t c = 0; c < kColumns; ++c) {
      const double omega = 1e-5 * std::pow(3.1e5, static_cast<double>(c) / (kColumns - 1));
      const auto pole = std::exp(std::complex<double>(-1e-4 * static_cast<double>(c % 7), omega));
      p[c] = pole.real(), p[kColumns + c] = pole.imag();
      z[c] = uniform(), z[kColumns + c] = uniform();
      for (std::size_t k = 0; k < kPlaces; ++k) weight[k * kColumns + c] = uniform();
    }
  }
  [[nodiscard]] Complex at(const AlignedArray<double>& rows, std::size_t c) const {
    return {rows[c], rows[kColumns + c]};
  }
  [[nodiscard]] ModeArrays modes(double* states) const {
    return {.z_re = states, .z_im = states + kColumns, .pole_re = p.get(), .pole_im = p.get() + kColumns};
  }
};

TEST(TouchKernel, FreeMotionFollowsTheRecurrenceOnEveryInstructionSet) {
  const Touched touched;
  constexpr std::size_t kPoints = kSteps + 1;
  for (std::size_t places = 1; places <= 5; ++places) {
    test::on_every_instruction_set([&](const char* name) {
      alignas(64) std::array<std::array<double, kSteps + 8>, 5> room{};
      std::vector<const double*> weights;
      std::vector<double*> out;
      for (std::size_t k = 0; k < places; ++k) {
        weights.push_back(touched.weight.get() + k % kPlaces * kColumns);
        out.push_back(room[k].data());
      }
      free_motion(touched.modes(touched.z.get()), kColumns, weights, out, kPoints);
      for (std::size_t k = 0; k < places; ++k) {
        std::vector<long double> exact(kPoints);
        for (std::size_t c = 0; c < kColumns; ++c) {
          Complex z = touched.at(touched.z, c);
          for (long double& sum : exact) sum += weights[k][c] * z.real(), z *= touched.at(touched.p, c);
        }
        for (std::size_t n = 0; n < kPoints; ++n) {
          EXPECT_NEAR(room[k][n], static_cast<double>(exact[n]), 1e-11) << name << ", place " << k << ", step " << n;
        }
      }
    });
  }
}

// Forces at five places push modes: the states against a recurrence in long double, which a place of any weight hears.
TEST(TouchKernel, PushesMoveStatesByTheRecurrenceOnEveryInstructionSet) {
  const Touched touched;
  std::mt19937 random(5);
  const auto uniform = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
  AlignedArray<double> response = aligned_zeros<double>(2 * kColumns);
  for (std::size_t c = 0; c < 2 * kColumns; ++c) response[c] = uniform();
  std::array<std::array<double, kSteps>, 5> force{};
  for (auto& samples : force) {
    for (double& sample : samples) sample = uniform();
  }
  for (const std::size_t steps : {std::size_t{1}, std::size_t{37}, kSteps}) {
    for (std::size_t count = 0; count <= force.size(); ++count) {
      std::vector<PortForce> ports;
      for (std::size_t k = 0; k < count; ++k)
        ports.push_back({touched.weight.get() + k % kPlaces * kColumns, force[k].data()});
      std::vector<Complex> exact(kColumns);
      double energy = 0;
      for (std::size_t c = 0; c < kColumns; ++c) {
        exact[c] = touched.at(touched.z, c);
        for (std::size_t n = 0; n < steps; ++n) {
          long double push = 0;
          for (std::size_t k = 0; k < count; ++k) push += ports[k].weight[c] * force[k][n];
          exact[c] = exact[c] * touched.at(touched.p, c) + push * touched.at(response, c);
        }
        energy += static_cast<double>(std::norm(exact[c]));
      }
      test::on_every_instruction_set([&](const char* name) {
        AlignedArray<double> z = aligned_zeros<double>(2 * kColumns);
        std::copy_n(touched.z.get(), 2 * kColumns, z.get());
        const PortForces pushed{response.get(), response.get() + kColumns, ports};
        EXPECT_NEAR(drive_touched(touched.modes(z.get()), kColumns, {}, pushed, nullptr, steps, 1) / energy, 1, 1e-12)
            << name;
        for (std::size_t c = 0; c < kColumns; ++c) {
          EXPECT_NEAR(static_cast<double>(std::abs(touched.at(z, c) - exact[c])), 0, 1e-11)
              << name << ", mode " << c << ", " << count << " ports, " << steps << " steps";
        }
      });
    }
  }
}

TEST(TouchKernel, AnswersAddUpToAConvolutionOnEveryInstructionSet) {
  std::mt19937 random(7);
  const auto uniform = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
  std::array<double, kSteps> force{}, before{};
  std::array<double, kAnswerPadding + kSteps> answer{};
  for (std::size_t n = 0; n < kSteps; ++n) force[n] = uniform(), before[n] = uniform();
  for (std::size_t n = 0; n < kSteps; ++n) answer[kAnswerPadding + n] = uniform();
  for (const std::size_t count : {kAnswerPadding, kSteps}) {
    test::on_every_instruction_set([&](const char* name) {
      std::array<double, kSteps> out = before;
      add_answer(force.data(), answer.data() + kAnswerPadding, out.data(), count);
      for (std::size_t n = 0; n < kSteps; ++n) {
        double exact = before[n];
        for (std::size_t m = 0; m < n && n < count; ++m) exact += force[m] * answer[kAnswerPadding + n - 1 - m];
        EXPECT_NEAR(out[n], exact, 1e-13) << name << ", sample " << n;
      }
    });
  }
}

}  // namespace
}  // namespace ringdown::synth
