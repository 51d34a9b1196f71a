// The fingerprints of the experiments and walkers of golden_test.cc, from the last intended change.
// If the bits differ, this command prints the new lines:
//   statistical_test --gtest_filter='*Golden*' | grep '^{'
#pragma once

#include <cstdint>
#include <map>
#include <string_view>

namespace ballpiston {

inline const std::map<std::string_view, uint64_t> kGoldenBits = {
    {"markov, energy-relaxation", 0x181b7b919340ebea},
    {"markov, gas-conduction", 0x63322949768fc7b8},
    {"markov, gas-equilibrium", 0x0baf195a0cce6a1b},
    {"markov, markov-property", 0xd1e1b9f31e1b197e},
    {"reference, conditional-mean-free-time", 0x016997aa5342f5ec},
    {"reference, energy-relaxation", 0x715f8d30f5d8e8d5},
    {"reference, equilibrium", 0xb8705a21d330bc21},
    {"reference, first-hit", 0x09c6d69b0234d43f},
    {"reference, gas-conduction", 0x448108566ef79f4c},
    {"reference, gas-equilibrium", 0xe88645b591880723},
    {"reference, gas-lyapunov", 0x85e1d4cb17620059},
    {"reference, lyapunov", 0xa9e332ccec9fbef4},
    {"reference, markov-property", 0x61a3f3407f44c8b7},
    {"lanes, conditional-mean-free-time", 0x125bca451c9b5919},
    {"lanes, energy-relaxation", 0x6b14200c84371d7b},
    {"lanes, equilibrium", 0x02fa3a8d876b7ef4},
    {"lanes, first-hit", 0x68e3b0222deb3e69},
    {"lanes, gas-conduction", 0x578b29e5b5d20a04},
    {"lanes, gas-equilibrium", 0x03a26b381467f9c0},
    {"lanes, gas-lyapunov", 0x85e1d4cb17620059},
    {"lanes, lyapunov", 0xf9800a4e4e12ecd3},
    {"lanes, markov-property", 0x1f9e3efb4888a488},
    {"lanes single, conditional-mean-free-time", 0xb3aa8432cdd69bf8},
    {"lanes single, energy-relaxation", 0xff1cc66d7748f57a},
    {"lanes single, equilibrium", 0xd28b245038f9f3b3},
    {"lanes single, first-hit", 0x5543c1ba4b0a0a8e},
    {"lanes single, lyapunov", 0x5f89c14acd3606c1},
    {"lanes single, markov-property", 0x347f9ef3dd66da1a},
    {"jump process, walkers after 1 jumps", 0x0049c16fa40bbb71},
    {"jump process, walkers after 10 jumps", 0x52df7e3171c109d0},
};

}  // namespace ballpiston
