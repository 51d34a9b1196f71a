// NumPy's format .npy, version 1.0: a header that describes an array, and its elements.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace ballpiston::client {

// The bytes of a file. `shape` has the length of each axis; without axes the array has one element.
// There are as many elements as the shape says, the last axis varies fastest.
std::string NpyBytes(const std::vector<double>& elements, const std::vector<size_t>& shape);
std::string NpyBytes(const std::vector<int64_t>& elements, const std::vector<size_t>& shape);
// The same for an array of ASCII texts.
std::string NpyBytes(const std::vector<std::string>& elements, const std::vector<size_t>& shape);

}  // namespace ballpiston::client
