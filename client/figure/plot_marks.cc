#include "client/figure/plot_marks.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "client/output/number_text.h"

namespace ballpiston::client {

void Range::Take(double x) {
  if (!(x > 0 && std::isfinite(x))) return;
  low = std::min(low, x);
  high = std::max(high, x);
}

void Spread(std::vector<Label>& labels, const Range& range) {
  const double gap = std::pow(range.high / range.low, kLineOfText);
  std::stable_sort(labels.begin(), labels.end(),
                   [](const Label& a, const Label& b) { return a.y > b.y; });
  for (size_t i = 1; i < labels.size(); ++i) {
    labels[i].y = std::min(labels[i].y, labels[i - 1].y / gap);
  }
}

std::string Text(const std::vector<Label>& labels) {
  std::string text = "x,y,text\n";
  for (const Label& label : labels) {
    absl::StrAppend(&text, ExactText(label.x), ",", ExactText(label.y), ",", label.text, "\n");
  }
  return text;
}

}  // namespace ballpiston::client
