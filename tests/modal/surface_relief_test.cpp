// Tracks of heights, against sines, whose slopes and means are known.
#include "engine/modal/surface_relief.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace ringdown::modal {
namespace {

constexpr double kSpacing_m = 5e-6;
constexpr std::size_t kCount = 4000;

// `waves` whole waves around the track.
SurfaceTrack sine(int waves, double height_m) {
  std::vector<float> heights;
  for (std::size_t k = 0; k < kCount; ++k) {
    const double turn = 2 * std::numbers::pi * waves * static_cast<double>(k) / kCount;
    heights.push_back(static_cast<float>(height_m * std::sin(turn)));
  }
  return SurfaceTrack::make(heights, kSpacing_m).value();
}

double rms(const SurfaceTrack& track, SurfaceTrack::Blend blend) {
  double sum = 0;
  constexpr int kPlaces = 20011;
  for (int k = 0; k < kPlaces; ++k) {
    const double slope = track.slope_at(track.length_m() * k / kPlaces, blend);
    sum += slope * slope;
  }
  return std::sqrt(sum / kPlaces);
}

TEST(SurfaceTrack, TheSlopeIsThatOfTheHeightsAndGoesRound) {
  const SurfaceTrack track = sine(40, 1e-6);
  const double length_m = kSpacing_m * kCount, q = 2 * std::numbers::pi * 40 / length_m;
  EXPECT_DOUBLE_EQ(track.length_m(), length_m);
  for (const double at_m : {0.0, 1.234e-4, 0.7 * length_m, 5.3 * length_m, -2.1 * length_m}) {
    // With 100 heights a wave, a cubic's slope is low by (2 pi / 100)^2 / 6 of it.
    EXPECT_NEAR(track.slope_at(at_m, {}), 1e-6 * q * std::cos(q * at_m), 7e-4 * 1e-6 * q) << at_m;
  }
  EXPECT_NEAR(track.rms_slope(), 1e-6 * q / std::sqrt(2.0), 1e-3 * 1e-6 * q);
}

TEST(SurfaceTrack, WavesShorterThanTheWidthAreSmoothedAway) {
  const double length_m = kSpacing_m * kCount;
  for (const int waves : {2, 20, 200}) {
    const SurfaceTrack track = sine(waves, 1e-6);
    const double wave_m = length_m / waves, whole = rms(track, {});
    EXPECT_GT(rms(track, track.blend(0.1 * wave_m, 0)), 0.9 * whole) << waves;
    EXPECT_LT(rms(track, track.blend(3 * wave_m, 0)), 0.25 * whole) << waves;
    EXPECT_LT(rms(track, track.blend(10 * wave_m, 0)), 0.02 * whole) << waves;
    double before = whole * 1.0001;
    for (double width_m = 0.05 * wave_m; width_m < 20 * wave_m; width_m *= 1.3) {
      const double now = rms(track, track.blend(width_m, 0));
      EXPECT_LE(now, before * 1.02) << waves << " " << width_m;
      before = now;
    }
  }
}

TEST(SurfaceTrack, WhatPassesFasterThanFramesIsSmoothedAway) {
  const SurfaceTrack track = sine(200, 1e-6);
  const double wave_m = kSpacing_m * kCount / 200;
  EXPECT_LT(rms(track, track.blend(0, 2 * wave_m)), 0.25 * rms(track, {}));
  EXPECT_GT(rms(track, track.blend(0, 0.05 * wave_m)), 0.9 * rms(track, {}));
}

TEST(SurfaceTrack, TracksThatAreNoneAreRefused) {
  const std::vector<float> one{0}, two{0, 1e-6F}, broken{0, std::numeric_limits<float>::infinity()};
  EXPECT_FALSE(SurfaceTrack::make(one, 1e-6));
  EXPECT_FALSE(SurfaceTrack::make(two, 0));
  EXPECT_FALSE(SurfaceTrack::make(two, std::nan("")));
  EXPECT_FALSE(SurfaceTrack::make(broken, 1e-6));
  const auto track = SurfaceTrack::make(two, 1e-6);
  ASSERT_TRUE(track);
  EXPECT_NEAR(track->length_m(), 4e-6, 1e-18);
  EXPECT_TRUE(std::isfinite(track->slope_at(1e6, track->blend(1, 1))));
}

}  // namespace
}  // namespace ringdown::modal
