// The gnuplot script of the mean free time figure. It reads the CSV files beside it and writes
// mean-free-time.svg, so that it can be changed and run again by hand.
#ifndef BALLPISTON_CLIENT_FIGURE_MEAN_FREE_TIME_SCRIPT_H_
#define BALLPISTON_CLIENT_FIGURE_MEAN_FREE_TIME_SCRIPT_H_

#include <string>
#include <vector>

namespace ballpiston::client {

std::string MeanFreeTimeScript(const std::vector<double>& delta);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_FIGURE_MEAN_FREE_TIME_SCRIPT_H_
