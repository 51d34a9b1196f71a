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
    {"lanes, orbits, rho 0.501", 0x9cb36ccaf56966e8},
    {"lanes, orbits, rho 0.529561", 0x00d183919ff3f4f5},
    {"lanes, orbits, rho 0.7", 0x65730a1cc9b3f76b},
    {"lanes single, orbits, rho 0.501", 0x3dd496dbe4e3c383},
    {"lanes single, orbits, rho 0.529561", 0x734a83844f08c83a},
    {"lanes single, orbits, rho 0.7", 0x6aa72eb842e6bc88},
    {"reference, equilibrium", 0x9f1198407e8d4c56},
    {"reference, conditional-mean-free-time", 0x08bcb451f50e2b38},
    {"reference, first-hit 5", 0x8382491041614576},
    {"reference, first-hit 2.5", 0x94e9dbc7f9234ea1},
    {"lanes, equilibrium", 0xb18bed850d8f9b77},
    {"lanes, conditional-mean-free-time", 0xc88f329b3f808b19},
    {"lanes, first-hit 5", 0xbdbc0c839ddc33d1},
    {"lanes, first-hit 2.5", 0x06cfb61ea9922fbb},
    {"lanes single, equilibrium", 0xe0caca819e47caca},
    {"lanes single, conditional-mean-free-time", 0x14bcd552952ffb4f},
    {"lanes single, first-hit 5", 0xc0e96157f9d35dcb},
    {"lanes single, first-hit 2.5", 0x91b58d282dbd5cde},
};

}  // namespace ballpiston

#endif  // BALLPISTON_TESTS_CORE_BILLIARD_GOLDEN_BITS_H_
