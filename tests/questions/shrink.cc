#include "tests/questions/shrink.h"

#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_format.h"
#include "tests/questions/question.h"

namespace ballpiston::questions {
namespace {

using Specs = std::vector<v1::EnsembleSpec>;
using List = google::protobuf::RepeatedField<double>;

template <typename Values>
void KeepOne(Values* values, int kept) {
  values->SwapElements(0, kept);
  while (values->size() > 1) values->RemoveLast();
}

// The lists of numbers of a grid.
std::vector<List*> ListsOf(v1::EnsembleSpec& spec) {
  v1::Grid& grid = *spec.mutable_grid();
  return {grid.mutable_rho(),      grid.mutable_delta(),       grid.mutable_epsilon(),
          grid.mutable_exponent(), grid.mutable_temperature(), grid.mutable_hot(),
          grid.mutable_cold()};
}

void AddShorterLists(const v1::EnsembleSpec& spec, Specs& simpler) {
  v1::EnsembleSpec copy = spec;
  for (size_t list = 0; list < ListsOf(copy).size(); ++list) {
    const int size = ListsOf(copy)[list]->size();
    for (int i = 0; size > 1 && i < size; ++i) {
      simpler.push_back(spec);
      KeepOne(ListsOf(simpler.back())[list], i);
    }
  }
  const int shapes = spec.grid().cells_size();
  for (int i = 0; shapes > 1 && i < shapes; ++i) {
    simpler.push_back(spec);
    KeepOne(simpler.back().mutable_grid()->mutable_cells(), i);
  }
}

void AddSimplerMethods(const v1::EnsembleSpec& spec, Specs& simpler) {
  const auto add = [&](auto change) {
    simpler.push_back(spec);
    change(simpler.back());
  };
  add([](v1::EnsembleSpec& s) { s.clear_seed(); });
  add([](v1::EnsembleSpec& s) { s.clear_precision(); });
  add([](v1::EnsembleSpec& s) { s.clear_verify(); });
  add([](v1::EnsembleSpec& s) { s.mutable_target()->clear_estimate(); });
  add([](v1::EnsembleSpec& s) { s.mutable_target()->clear_budget(); });
  add([](v1::EnsembleSpec& s) { s.mutable_target()->clear_kind(); });
  add([](v1::EnsembleSpec& s) { s.clear_model(); });
  for (const int count : {1, 2, 64, 1000}) {
    if (spec.target().has_samples()) {
      add([&](v1::EnsembleSpec& s) { s.mutable_target()->set_samples(count); });
    }
    if (spec.target().has_collisions()) {
      add([&](v1::EnsembleSpec& s) { s.mutable_target()->set_collisions(count); });
    }
  }
}

double WithDigits(double x, int digits) {
  double rounded = x;
  return absl::SimpleAtod(absl::StrFormat("%.*g", digits, x), &rounded) ? rounded : x;
}

void AddRounded(const v1::EnsembleSpec& spec, int digits, Specs& simpler) {
  v1::EnsembleSpec copy = spec;
  const std::vector<List*> lists = ListsOf(copy);
  for (size_t list = 0; list < lists.size(); ++list) {
    for (int i = 0; i < lists[list]->size(); ++i) {
      simpler.push_back(spec);
      ListsOf(simpler.back())[list]->Set(i, WithDigits(lists[list]->Get(i), digits));
    }
  }
  if (!spec.target().has_tolerance()) return;
  simpler.push_back(spec);
  simpler.back().mutable_target()->set_tolerance(WithDigits(spec.target().tolerance(), digits));
}

void AddSmallerGases(const v1::EnsembleSpec& spec, Specs& simpler) {
  for (int i = 0; i < spec.grid().cells_size(); ++i) {
    for (const char* const shape : {"1", "2", "3", "1x1", "10", "100"}) {
      simpler.push_back(spec);
      simpler.back().mutable_grid()->set_cells(i, shape);
    }
  }
}

// The most radical first.
Specs SimplerThan(const v1::EnsembleSpec& spec) {
  Specs simpler;
  AddShorterLists(spec, simpler);
  AddSimplerMethods(spec, simpler);
  AddSmallerGases(spec, simpler);
  for (const int digits : {1, 2, 4, 8, 12}) AddRounded(spec, digits, simpler);
  return simpler;
}

}  // namespace

v1::EnsembleSpec Shrink(v1::EnsembleSpec spec, const Fails& fails, int most) {
  for (bool found = true; found;) {
    found = false;
    const size_t length = Command(spec).size();
    for (v1::EnsembleSpec& simpler : SimplerThan(spec)) {
      if (Command(simpler).size() >= length) continue;
      if (most-- <= 0) return spec;
      if (!fails(simpler)) continue;
      spec = std::move(simpler);
      found = true;
      break;
    }
  }
  return spec;
}

}  // namespace ballpiston::questions
