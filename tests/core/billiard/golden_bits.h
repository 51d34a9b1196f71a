// The fingerprints of the orbits and experiments of golden_test.cc, from the last intended change.
// If the bits differ, this command prints the new lines:
//   statistical_test --gtest_filter='*Golden*' | grep '^{'
#pragma once

#include <cstdint>
#include <map>
#include <string_view>

namespace ballpiston {

inline const std::map<std::string_view, uint64_t> kGoldenBits = {
    {"reference, orbits, rho 0.501", 0x6e7b1dec71aa11d8},
    {"reference, orbits, rho 0.529561", 0x5318b9846758d9df},
    {"reference, orbits, rho 0.7", 0x1ce0aa90fef1b484},
    {"lanes, orbits, rho 0.501", 0xc15cd37104b349c2},
    {"lanes, orbits, rho 0.529561", 0x4f9f598edb455c9e},
    {"lanes, orbits, rho 0.7", 0x3b4057b5ec3647c2},
    {"lanes single, orbits, rho 0.501", 0x8b2c0d028eae91cb},
    {"lanes single, orbits, rho 0.529561", 0xf2ce8f1a99522b57},
    {"lanes single, orbits, rho 0.7", 0x432d11302664b49f},
    {"reference, equilibrium", 0x97ebc10cec40fa7c},
    {"reference, conditional-mean-free-time", 0x49cb7294958ce7d4},
    {"reference, first-hit 5", 0x57eabef92a6461f1},
    {"reference, first-hit 2.5", 0x5f62f3fd37b0971b},
    {"lanes, equilibrium", 0xb6e191223bd4a066},
    {"lanes, conditional-mean-free-time", 0x96a533bbc39a0729},
    {"lanes, first-hit 5", 0x1b39bbf2827f8652},
    {"lanes, first-hit 2.5", 0x19fccbf4133f1924},
    {"lanes single, equilibrium", 0x5c04a84cd85e1ad6},
    {"lanes single, conditional-mean-free-time", 0x9f719db84bcbc2a8},
    {"lanes single, first-hit 5", 0x0bf70499890538e2},
    {"lanes single, first-hit 2.5", 0xd4f710565a38d1cb},
    {"reference, energy-relaxation", 0x9fbcbd3b01d8a91c},
    {"reference, energy-relaxation from 0.01", 0x4a1ef1a02690dc9e},
    {"reference, markov-property", 0x9b72007817c4ce77},
    {"reference, lyapunov", 0xc5ca00bf3cc40660},
    {"lanes, energy-relaxation", 0x5c7dffed1c302d39},
    {"lanes, energy-relaxation from 0.01", 0x5cf1cc696e684c4f},
    {"lanes, markov-property", 0x0464df93c85775e0},
    {"lanes, lyapunov", 0x109a2c543fb4c24d},
    {"lanes single, energy-relaxation", 0x6567f040396591a5},
    {"lanes single, energy-relaxation from 0.01", 0xe2116a8df8fb6b82},
    {"lanes single, markov-property", 0x407fb5ef917bc912},
    {"lanes single, lyapunov", 0x54f9b2999592b876},
    {"markov, energy-relaxation", 0x9b32dcb6558ab628},
    {"markov, energy-relaxation from 0.01", 0x45339149d3e23c29},
    {"markov, markov-property", 0x8bed29311401fa56},
    {"markov, gas-equilibrium of 3 cells", 0xbcf97546c75a7df0},
    {"markov, gas-equilibrium of 2x2 cells", 0x1fcc7eb4ea8fd658},
    {"markov, gas-conduction of 3 cells", 0x39b7b41f5ec6b09d},
    {"markov, gas-conduction of 2x2 cells", 0xa81894fbf3d78dd0},
    {"reference, gas-equilibrium of 3 cells", 0x75595d3212d56e6d},
    {"reference, gas-equilibrium of 2x2 cells", 0x11145363b8792edb},
    {"reference, gas-conduction of 3 cells", 0x7c2cd02db1b1c13c},
    {"reference, gas-conduction of 2x2 cells", 0x60b9b2616bb25533},
    {"reference, gas-lyapunov of 3 cells", 0x7f7d4e37578c04df},
    {"reference, gas-lyapunov of 2x2 cells", 0x0b8efd19017a1093},
    {"lanes, gas-equilibrium of 3 cells", 0x66608a0967576fef},
    {"lanes, gas-equilibrium of 2x2 cells", 0x32fc89017231061a},
    {"lanes, gas-conduction of 3 cells", 0x16f739b6d1d07bfb},
    {"lanes, gas-conduction of 2x2 cells", 0x752f629f653b800a},
    {"lanes, gas-lyapunov of 3 cells", 0x7f7d4e37578c04df},
    {"lanes, gas-lyapunov of 2x2 cells", 0x0b8efd19017a1093},
    {"jump process, walkers after 1 jumps", 0x0049c16fa40bbb71},
    {"jump process, walkers after 10 jumps", 0x52df7e3171c109d0},
};

}  // namespace ballpiston
