// The cells of the ingoing law, eq. kld: bins of alpha over the interval that is permitted for each
// sign of the piston's velocity. sigma = -1 comes first, then +1, which occurs only for
// epsilon < 1/4.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/closed_form/ingoing_law.h"
#include "core/experiment/return_orbits.h"
#include "core/statistics/histogram.h"

namespace ballpiston {

inline constexpr size_t kIngoingBins = 1000;                   // of each sigma
inline constexpr std::array<int, 2> kIngoingSigmas = {-1, 1};  // by index of the histogram

std::vector<Histogram> EmptyIngoingHistograms(const IngoingLaw& law);

// Exact probabilities of each histogram's bins.
std::vector<std::vector<double>> IngoingBinProbabilities(const IngoingLaw& law);

void CountIngoing(const Return& hit, std::span<Histogram> histograms);

}  // namespace ballpiston
