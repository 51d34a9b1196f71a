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
    {"reference, equilibrium", 0x9f1198407e8d4c56},
    {"reference, conditional-mean-free-time", 0x08bcb451f50e2b38},
    {"reference, first-hit 5", 0x8382491041614576},
    {"reference, first-hit 2.5", 0x94e9dbc7f9234ea1},
    {"lanes, equilibrium", 0xb6ee6575bf30ded3},
    {"lanes, conditional-mean-free-time", 0x6be5e3e9fe9723d5},
    {"lanes, first-hit 5", 0x1c604972e6db25ba},
    {"lanes, first-hit 2.5", 0x547a9b5b7e7de208},
    {"lanes single, equilibrium", 0x466697675c142b75},
    {"lanes single, conditional-mean-free-time", 0xe957f844043b4de7},
    {"lanes single, first-hit 5", 0xec84b8fda30413a4},
    {"lanes single, first-hit 2.5", 0xbf56119549d237da},
    {"reference, energy-relaxation", 0xa4487dc2314e05b7},
    {"reference, energy-relaxation from 0.01", 0x84a27d6005e19fa7},
    {"reference, markov-property", 0x803951f8e303cda7},
    {"lanes, energy-relaxation", 0x3dfc65b1e49a6294},
    {"lanes, energy-relaxation from 0.01", 0x911ffcc583a5e15e},
    {"lanes, markov-property", 0x66ad6dc0a33f85f4},
    {"lanes single, energy-relaxation", 0xb18fe541ec36166f},
    {"lanes single, energy-relaxation from 0.01", 0xf91d2dad9558a40d},
    {"lanes single, markov-property", 0xeb27f7869f58a360},
    {"markov, energy-relaxation", 0x397072960d7ce8ad},
    {"markov, energy-relaxation from 0.01", 0x52563b68a7fd77ac},
    {"markov, markov-property", 0x90a80d9d694dfc20},
};

}  // namespace ballpiston

#endif  // BALLPISTON_TESTS_CORE_BILLIARD_GOLDEN_BITS_H_
