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
    {"reference, first-hit 5", 0xedbf29d708c21669},
    {"reference, first-hit 2.5", 0x6d58b9176537ba4c},
    {"lanes, equilibrium", 0xf5a4c480c242fcdf},
    {"lanes, conditional-mean-free-time", 0x3e86063914dd7f26},
    {"lanes, first-hit 5", 0x7f733981c62d1b77},
    {"lanes, first-hit 2.5", 0xa9202b71f99895f6},
    {"lanes single, equilibrium", 0xcfb14dc253925a8b},
    {"lanes single, conditional-mean-free-time", 0x2febd7dc1430ea90},
    {"lanes single, first-hit 5", 0xfeaefcdf4a4b58ec},
    {"lanes single, first-hit 2.5", 0x98f07d6ffc747e18},
    {"reference, energy-relaxation", 0x9fbcbd3b01d8a91c},
    {"reference, energy-relaxation from 0.01", 0x4a1ef1a02690dc9e},
    {"reference, markov-property", 0xcad29ba652cc930b},
    {"reference, lyapunov", 0x548ec97a018281cb},
    {"lanes, energy-relaxation", 0x5c7dffed1c302d39},
    {"lanes, energy-relaxation from 0.01", 0x5cf1cc696e684c4f},
    {"lanes, markov-property", 0xe823cfcbd0ce17ce},
    {"lanes, lyapunov", 0xe48e6c19a7175e0c},
    {"lanes single, energy-relaxation", 0x6567f040396591a5},
    {"lanes single, energy-relaxation from 0.01", 0xe2116a8df8fb6b82},
    {"lanes single, markov-property", 0xc62548b03759232f},
    {"lanes single, lyapunov", 0x0b67982b9a4f6800},
    {"markov, energy-relaxation", 0x9b32dcb6558ab628},
    {"markov, energy-relaxation from 0.01", 0x45339149d3e23c29},
    {"markov, markov-property", 0xd20b4ff45e88d23e},
    {"markov, gas-equilibrium of 3 cells", 0x43243a3c1c11fb96},
    {"markov, gas-equilibrium of 2x2 cells", 0xce321d7d71994fad},
    {"markov, gas-conduction of 3 cells", 0x9dab38c114cc4c9c},
    {"markov, gas-conduction of 2x2 cells", 0xa1e26a26e7d908d4},
    {"reference, gas-equilibrium of 3 cells", 0xd3811b1e94f5e4d7},
    {"reference, gas-equilibrium of 2x2 cells", 0x75b9f712e0942cc1},
    {"reference, gas-conduction of 3 cells", 0x3d60a4a9231adb76},
    {"reference, gas-conduction of 2x2 cells", 0x23598c1565914545},
    {"reference, gas-lyapunov of 3 cells", 0x03cdee6b4169bb90},
    {"reference, gas-lyapunov of 2x2 cells", 0x8e3539463dd77930},
    {"lanes, gas-equilibrium of 3 cells", 0xf2a68b94289186b9},
    {"lanes, gas-equilibrium of 2x2 cells", 0x2282da06ff67d8db},
    {"lanes, gas-conduction of 3 cells", 0x75f3dfd6b0ecc012},
    {"lanes, gas-conduction of 2x2 cells", 0x6152e74972e04caa},
    {"lanes, gas-lyapunov of 3 cells", 0x03cdee6b4169bb90},
    {"lanes, gas-lyapunov of 2x2 cells", 0x8e3539463dd77930},
    {"jump process, walkers after 1 jumps", 0x0049c16fa40bbb71},
    {"jump process, walkers after 10 jumps", 0x52df7e3171c109d0},
};

}  // namespace ballpiston
