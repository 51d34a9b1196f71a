// What the orbits and experiments of golden_test.cc gave when their bits were last meant to change.
// If the bits differ, this command prints the new lines:
//   statistical_test --gtest_filter='*Golden*' | grep '^{'
#ifndef BALLPISTON_TESTS_CORE_BILLIARD_GOLDEN_BITS_H_
#define BALLPISTON_TESTS_CORE_BILLIARD_GOLDEN_BITS_H_

#include <cstdint>
#include <map>
#include <string_view>

namespace ballpiston {

inline const std::map<std::string_view, uint64_t> kGoldenBits = {
    {"reference, orbits, rho 0.501", 0x6e7b1dec71aa11d8},
    {"reference, orbits, rho 0.529561", 0x5318b9846758d9df},
    {"reference, orbits, rho 0.7", 0x1ce0aa90fef1b484},
    {"lanes, orbits, rho 0.501", 0x2c3cc9920e5aa1d7},
    {"lanes, orbits, rho 0.529561", 0x0d3e4e27bba7125b},
    {"lanes, orbits, rho 0.7", 0x94de15e5bbe567d9},
    {"lanes single, orbits, rho 0.501", 0x4226cb31d1915908},
    {"lanes single, orbits, rho 0.529561", 0xa056537a1ae232fa},
    {"lanes single, orbits, rho 0.7", 0x6a5a1f06a2ca4177},
    {"reference, equilibrium", 0x97bac2f0844011eb},
    {"reference, conditional-mean-free-time", 0xdf7a22f2a6daa20b},
    {"reference, first-hit 5", 0xf91148a77e50d6cd},
    {"reference, first-hit 2.5", 0x9cad2a102588a372},
    {"lanes, equilibrium", 0x8e96a1d4a1ca5a27},
    {"lanes, conditional-mean-free-time", 0xc60c6f9e8af12741},
    {"lanes, first-hit 5", 0x470b87e281ddd317},
    {"lanes, first-hit 2.5", 0x4fd942a22d3a8289},
    {"lanes single, equilibrium", 0xaf44b225ccd7d45f},
    {"lanes single, conditional-mean-free-time", 0xe96ac784d04af099},
    {"lanes single, first-hit 5", 0x9548968b73f01376},
    {"lanes single, first-hit 2.5", 0xca0241cc45b0af0a},
    {"reference, energy-relaxation", 0x9fbcbd3b01d8a91c},
    {"reference, energy-relaxation from 0.01", 0xc8e1d8219b63d29a},
    {"reference, markov-property", 0x369a26337a8d69fd},
    {"lanes, energy-relaxation", 0x276349e8c4793a8d},
    {"lanes, energy-relaxation from 0.01", 0x701873ce0ceab2ea},
    {"lanes, markov-property", 0xc06aa004316e4848},
    {"lanes single, energy-relaxation", 0x336e8809be8c1d6d},
    {"lanes single, energy-relaxation from 0.01", 0xfe7164fba8ac8f4f},
    {"lanes single, markov-property", 0xdea754326edfbd04},
    {"markov, energy-relaxation", 0x9b32dcb6558ab628},
    {"markov, energy-relaxation from 0.01", 0x66eae74172f24c0d},
    {"markov, markov-property", 0xa1259aafb70fc568},
};

}  // namespace ballpiston

#endif  // BALLPISTON_TESTS_CORE_BILLIARD_GOLDEN_BITS_H_
