// What panels of errors against work have in common: ranges of logarithmic axes, and labels that
// keep clear of each other.
#ifndef BALLPISTON_CLIENT_FIGURE_PLOT_MARKS_H_
#define BALLPISTON_CLIENT_FIGURE_PLOT_MARKS_H_

#include <limits>
#include <string>
#include <vector>

namespace ballpiston::client {

// Room around the data of a logarithmic axis, as factors.
inline constexpr double kBelow = 0.4;
inline constexpr double kAbove = 3;

inline constexpr double kLineOfText = 0.06;  // as a part of an axis

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = 0;

  void Take(double x);  // what a logarithmic axis cannot show is passed over
};

struct Label {
  double x = 0;
  double y = 0;
  std::string text = {};
};

// Sorted from the highest down, each at least a line of text below the one before, on an axis that
// shows `range`.
void Spread(std::vector<Label>& labels, const Range& range);

// As lines of a gnuplot data block, which begins with the columns' names.
std::string Text(const std::vector<Label>& labels);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_FIGURE_PLOT_MARKS_H_
