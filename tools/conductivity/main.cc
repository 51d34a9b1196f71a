// Computes the corrections of the heat conductivity, and the gaps of closed chains, and prints them
// with their convergence: the tables of docs/research/conductivity.md. README.md describes the
// arguments.
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>

#include <cstddef>
#include <iostream>
#include <string_view>
#include <vector>

#include "tools/conductivity/chain_gap.h"
#include "tools/conductivity/conductivity.h"

namespace ballpiston {
namespace {

void PrintCorrection(std::string_view name, const SiteLattice& lattice, bool is_quick) {
  const ConductivityRatio ratio =
      RefineConductivity(lattice, is_quick ? QuickPlan(lattice) : FinePlan(lattice));
  std::cout << absl::StrFormat("%s: %.9f +- %.1e, at most %.9f\n", name, ratio.correction,
                               ratio.error, ratio.upper_bound);
  for (const ComputedBound& row : ratio.table) {
    std::cout << absl::StrFormat("  extent %2d, sites %2d, degree %2d: %.9f\n", row.size.extent,
                                 row.size.sites, row.degree, row.correction);
  }
  std::cout << std::endl;  // std::endl flushes: a reader gets each table at once
}

void PrintGap(const std::vector<int>& dimensions, std::vector<int> degrees, bool is_quick) {
  if (is_quick) degrees.resize(2);
  const auto [gap, bounds] = ChainGap(dimensions, degrees);
  std::cout << absl::StrFormat("%s: %.13f +- %.1e\n", absl::StrJoin(dimensions, ""), gap.value,
                               gap.error);
  for (size_t i = 0; i < degrees.size(); ++i) {
    std::cout << absl::StrFormat("  degree %2d: %.13f\n", degrees[i], bounds[i]);
  }
  std::cout << std::endl;
}

void PrintAll(bool is_quick) {
  std::cout << "kappa/kappa_0 - 1\n\n";
  PrintCorrection("chain of balls and pistons", BallPistonChain(), is_quick);
  PrintCorrection("square lattice of balls and pistons", BallPistonLattice(), is_quick);
  PrintCorrection("chain of discs", EqualSitesChain(2), is_quick);
  PrintCorrection("chain of spheres", EqualSitesChain(3), is_quick);
  std::cout << "gaps of closed chains: 2 is a ball, 1 a piston\n\n";
  PrintGap({2, 1}, {20, 24, 30, 36}, is_quick);
  PrintGap({2, 1, 2}, {12, 14, 16, 18, 20}, is_quick);
  PrintGap({1, 2, 1}, {12, 14, 16, 18, 20}, is_quick);
  PrintGap({2, 1, 2, 1}, {8, 10, 12, 14}, is_quick);
  PrintGap({2, 1, 2, 1, 2}, {6, 8, 10}, is_quick);
  PrintGap({1, 2, 1, 2, 1}, {6, 8, 10}, is_quick);
  PrintGap({2, 1, 2, 1, 2, 1}, {4, 6, 8}, is_quick);
}

}  // namespace
}  // namespace ballpiston

int main(int argc, char** argv) {
  const bool is_quick = argc == 2 && std::string_view(argv[1]) == "--quick";
  if (argc > 1 && !is_quick) {
    std::cerr << "conductivity: the only argument is --quick\n";
    return 2;
  }
  ballpiston::PrintAll(is_quick);
  return std::cout.good() ? 0 : 1;
}
