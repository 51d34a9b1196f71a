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
    {"reference, equilibrium", 0x97bac2f0844011eb},
    {"reference, conditional-mean-free-time", 0xdf7a22f2a6daa20b},
    {"reference, first-hit 5", 0x988ea430e8909ad7},
    {"reference, first-hit 2.5", 0x1703b9b5b90356db},
    {"lanes, equilibrium", 0xf5a4c480c242fcdf},
    {"lanes, conditional-mean-free-time", 0x3e86063914dd7f26},
    {"lanes, first-hit 5", 0xbdffd7df815b582b},
    {"lanes, first-hit 2.5", 0xc125ad1f1fad4012},
    {"lanes single, equilibrium", 0xcfb14dc253925a8b},
    {"lanes single, conditional-mean-free-time", 0x2febd7dc1430ea90},
    {"lanes single, first-hit 5", 0x7ca830b8fb34c44d},
    {"lanes single, first-hit 2.5", 0xf583f2cff66f26d6},
    {"reference, energy-relaxation", 0x9fbcbd3b01d8a91c},
    {"reference, energy-relaxation from 0.01", 0x4a1ef1a02690dc9e},
    {"reference, markov-property", 0xb482a913f75d0dd5},
    {"reference, lyapunov", 0x3a6d0c8366f0d408},
    {"lanes, energy-relaxation", 0x5c7dffed1c302d39},
    {"lanes, energy-relaxation from 0.01", 0x5cf1cc696e684c4f},
    {"lanes, markov-property", 0x2d11509d51e21446},
    {"lanes, lyapunov", 0x239da10844851903},
    {"lanes single, energy-relaxation", 0x6567f040396591a5},
    {"lanes single, energy-relaxation from 0.01", 0xe2116a8df8fb6b82},
    {"lanes single, markov-property", 0x6dc62f198d3df760},
    {"lanes single, lyapunov", 0x0b67982b9a4f6800},
    {"markov, energy-relaxation", 0x9b32dcb6558ab628},
    {"markov, energy-relaxation from 0.01", 0x45339149d3e23c29},
    {"markov, markov-property", 0xd0fe5bad12fb7f40},
    {"markov, gas-equilibrium of 3 cells", 0x39a98c9ecdbd66b1},
    {"markov, gas-equilibrium of 2x2 cells", 0x945dc9823229690c},
    {"markov, gas-conduction of 3 cells", 0x39b7b41f5ec6b09d},
    {"markov, gas-conduction of 2x2 cells", 0xa81894fbf3d78dd0},
    {"reference, gas-equilibrium of 3 cells", 0x37ef8064bf531e90},
    {"reference, gas-equilibrium of 2x2 cells", 0xf5e5094fa6431022},
    {"reference, gas-conduction of 3 cells", 0x7c2cd02db1b1c13c},
    {"reference, gas-conduction of 2x2 cells", 0x60b9b2616bb25533},
    {"reference, gas-lyapunov of 3 cells", 0xf26830e8d257a0dd},
    {"reference, gas-lyapunov of 2x2 cells", 0x114348ed613dc11a},
    {"lanes, gas-equilibrium of 3 cells", 0x143762689baea53e},
    {"lanes, gas-equilibrium of 2x2 cells", 0x19b9d9d354c168bf},
    {"lanes, gas-conduction of 3 cells", 0x16f739b6d1d07bfb},
    {"lanes, gas-conduction of 2x2 cells", 0x752f629f653b800a},
    {"lanes, gas-lyapunov of 3 cells", 0xf26830e8d257a0dd},
    {"lanes, gas-lyapunov of 2x2 cells", 0x114348ed613dc11a},
    {"jump process, walkers after 1 jumps", 0x0049c16fa40bbb71},
    {"jump process, walkers after 10 jumps", 0x52df7e3171c109d0},
};

}  // namespace ballpiston
