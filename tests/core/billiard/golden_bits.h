// What the orbits and experiments of golden_test.cc gave when their bits were last meant to change.
// The lines are what `core_test --gtest_filter='*Golden*' | grep '^{'` prints after a difference.
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
    {"lanes, orbits, rho 0.501", 0x058354e6d575c49c},
    {"lanes, orbits, rho 0.529561", 0x56e561af130a75dd},
    {"lanes, orbits, rho 0.7", 0xe327731df770fea4},
    {"lanes single, orbits, rho 0.501", 0x74aeb7d7a9af1221},
    {"lanes single, orbits, rho 0.529561", 0xb8a7bcb7a7192840},
    {"lanes single, orbits, rho 0.7", 0x6b890230d14af405},
    {"reference, equilibrium", 0x9f1198407e8d4c56},
    {"reference, conditional-mean-free-time", 0x08bcb451f50e2b38},
    {"reference, first-hit 5", 0x8382491041614576},
    {"reference, first-hit 2.5", 0x94e9dbc7f9234ea1},
    {"lanes, equilibrium", 0x5c39b4036636276d},
    {"lanes, conditional-mean-free-time", 0x42a329420f14a5a1},
    {"lanes, first-hit 5", 0xfe1c9cad4ac48e05},
    {"lanes, first-hit 2.5", 0x24ff52053093404b},
    {"lanes single, equilibrium", 0x3f3b552e5fe44f91},
    {"lanes single, conditional-mean-free-time", 0x4c15e20d0eccb652},
    {"lanes single, first-hit 5", 0x9874151d03c99261},
    {"lanes single, first-hit 2.5", 0x723a3f338a09d175},
};

}  // namespace ballpiston

#endif  // BALLPISTON_TESTS_CORE_BILLIARD_GOLDEN_BITS_H_
