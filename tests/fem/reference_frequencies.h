// Exact frequencies of free bodies: E = 200 GPa, nu = 0.3 unless said otherwise, rho = 7850 kg/m^3, without the six
// rigid motions [Hz].
//
// Boxes: Rayleigh-Ritz with orthonormal Legendre products (Visscher et al., J. Acoust. Soc. Am. 90, 1991; Ohno, J.
// Phys. Earth 24, 1976), converged in degree to better than 1e-7. Sphere: roots of Lamb's frequency equations (Proc.
// London Math. Soc. 13, 1882), to 25 digits. No finite element had a part in them.
#pragma once

#include <array>

namespace ringdown::reference {

// 0.1 x 0.08 x 0.06 m
inline constexpr std::array kBlock = {13412.89996, 17502.49021, 19488.76243, 21949.04566, 23612.2375,
                                      23798.34622, 24818.02297, 24934.72954, 25272.67156, 26667.42912};

// the same block, nearly incompressible: nu = 0.49
inline constexpr std::array kSoftBlock = {12530.9499,  16924.39566, 19002.57233, 20607.36814, 22073.86316,
                                          22495.73571, 23712.82732, 23736.42607, 25310.62945, 25631.20564};

// 0.2 x 0.01 x 0.01 m
inline constexpr std::array kBar = {1285.679222, 1285.679223, 3488.017589, 3488.017591, 6687.532316,
                                    6687.532318, 7187.283581, 10751.90979, 10751.90979, 12616.52315};

// 0.2 x 0.2 x 0.004 m
inline constexpr std::array kPlate = {324.611704,  475.675823,  588.909824,  838.022941,  838.022948,
                                      1478.222161, 1478.222163, 1527.497666, 1665.170145, 1858.889831};

// radius 0.1 m
inline constexpr std::array kSphere = {12460.92688, 12460.92688, 12460.92688, 12460.92688, 12460.92688,
                                       13183.75391, 13183.75391, 13183.75391, 13183.75391, 13183.75391,
                                       17586.79779, 17586.79779, 17586.79779};

}  // namespace ringdown::reference
