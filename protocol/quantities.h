// Ranges and units of what the tables' rows carry. Private to protocol/.
#pragma once

#include "protocol/fields.h"

#include <cstdint>
#include <limits>

namespace ringdown::protocol {

inline constexpr Quantity kPosition{"m", -1e4, 1e4};
inline constexpr Quantity kVelocity{"m/s", -1e3, 1e3};
inline constexpr Quantity kSize{"m", 0, 1e3};
inline constexpr Quantity kDensity{"kg/m3", 0, 1e5};
inline constexpr Quantity kImpulse{"N s", -1e4, 1e4};
inline constexpr Quantity kForce{"N", -1e6, 1e6};
inline constexpr Quantity kDamping{"N s/m", 0, 1e6};
inline constexpr Quantity kDirection{"", -1e3, 1e3};
inline constexpr Quantity kSpeed{"m/s", 0, 1e3};
inline constexpr Quantity kBowSpeed{"m/s", -100, 100};
inline constexpr Quantity kPress{"N", 0, 1e5};
inline constexpr Quantity kWidth{"m", 0, 1};
inline constexpr Quantity kFriction{"", 0, 5};
inline constexpr Quantity kMalletMass{"kg", 1e-5, 100};
inline constexpr Quantity kRestingMass{"kg", 0, 1e5};
inline constexpr Quantity kStiffness{"N/m^1.5", 0, 1e14};
inline constexpr Quantity kHardness{"N/m^1.5", 1, 1e14};
inline constexpr Quantity kBounce{"", 0.01, 1};
inline constexpr Quantity kGap{"m", -0.01, 0.1};
inline constexpr Quantity kRoughness{"m", 0, 0.1};
inline constexpr Quantity kCorrelation{"m", 1e-7, 10};
inline constexpr Quantity kSpectralSlope{"", -10, 0};
inline constexpr Quantity kDamperNumber{"", 0, modal::kMaxDampers - 1};
inline constexpr Quantity kInput{"", 1, kMaxInputs};
inline constexpr Quantity kPickup{"", 1, kMaxPickups};
inline constexpr Quantity kMotion{"", 0, 2};
inline constexpr Quantity kSensitivity{"", -1e12, 1e12};
inline constexpr Quantity kContactTime{"s", 0, 0.1};
inline constexpr Quantity kGain{"", 0, 100};
inline constexpr Quantity kPressure{"Pa", 1e-6, 1e6};
inline constexpr Quantity kBreath{"Pa", 0, 1e5};
inline constexpr Quantity kLost{"s", 0, 1e9};
inline constexpr Quantity kModalVelocity{"kg^1/2 m/s", -1e6, 1e6};
inline constexpr Quantity kPhase{"rad", -1e3, 1e3};
inline constexpr Quantity kRamp{"s", 0, 60};
inline constexpr Quantity kPan{"", -1, 1};
inline constexpr Quantity kFanRate{"Hz", synth::verb::Fan::kRate_hz.low, synth::verb::Fan::kRate_hz.high};
inline constexpr Quantity kShare{"", 0, 1};
inline constexpr Quantity kDetune{"cents", modal::kTubeDetune_cents.low, modal::kTubeDetune_cents.high};
inline constexpr Quantity kScale{"", 1e-3, 1e3};
inline constexpr Quantity kDampingScale{"", 0, 1e3};
inline constexpr Quantity kSizeScale{"", 1e-2, 1e2};
inline constexpr Quantity kPattern{"", -1, 1023};
inline constexpr Quantity kObjectOrNone{"", -1, kMaxNumber};
inline constexpr Quantity kStress{"Pa", 0, 1e12};
inline constexpr Quantity kEnergy{"J", 0, 1e30};
inline constexpr Quantity kIndex{"", 0, kMaxNumber};
inline constexpr Quantity kCount{"", 0, std::numeric_limits<std::int32_t>::max()};
inline constexpr Quantity kId{"", std::numeric_limits<std::int32_t>::min(), kCount.max};
inline constexpr Quantity kLoad{"", 0, 1e6};
inline constexpr Quantity kSignedRatio{"", -1e6, 1e6};
inline constexpr Quantity kRate{"Hz", 0, 1e7};
inline constexpr Quantity kNoticeRate{"Hz", 0.1, 200};
inline constexpr Quantity kUnit{"", -1.001, 1.001};  // rounding to float may pass 1
inline constexpr Quantity kTemperature{"degrees C", -50, 60};
inline constexpr Quantity kHumidity{"percent", 0, 100};
inline constexpr Quantity kPieceMass{"kg", 0, 1e30};
inline constexpr Quantity kInertia{"kg m2", 0, 1e30};
inline constexpr Quantity kAnyPosition{"m", -1e30, 1e30};
inline constexpr Quantity kAnyVelocity{"m/s", -1e30, 1e30};
inline constexpr Quantity kAnySpin{"rad/s", -1e30, 1e30};
inline constexpr Quantity kAnyImpulse{"N s", -1e30, 1e30};
inline constexpr Quantity kFrequency{"Hz", 1, 1e5};
inline constexpr Quantity kAmplitude{"", 0, 1};
inline constexpr Quantity kDuration{"s", 0, 1e9};
inline constexpr Quantity kAngle{"degrees", 0, 180};
inline constexpr Quantity kBankBytes{"", 1, kMaxBankBytes};
inline constexpr Quantity kPeak{"", 0, 1e30};

}  // namespace ringdown::protocol
